"""The points of a closed result file, read and written by arithmetic: every variable lies in one piece.

Not through HDF5, whose blocks follow the axes of a grid: along the first, which may have one value only.
Nothing is mapped: pages that are touched would count as this process's memory, in the end the whole file.
"""

from collections.abc import Iterable, Iterator
from itertools import pairwise
from math import prod
from pathlib import Path

import h5py
import numpy as np

from ...sweep.ranges import IndexRange, joined
from ..layouts.variables import MISSING, Layout

POINTS_AT_ONCE = 1 << 16
BYTES_AT_ONCE = 1 << 26
"""How many points are read together, and how many bytes of them."""


def statuses(path: Path, at_once: int | None = None) -> Iterator[tuple[int, np.ndarray]]:
    """(flat index of the first, statuses) of all points, a block at a time."""
    with h5py.File(path, "r") as file:
        data = file["status"]
        offset, kind, count = data.id.get_offset(), data.dtype, data.size
    at_once = at_once or POINTS_AT_ONCE
    with path.open("rb") as stream:
        for first in range(0, count, at_once):
            stream.seek(offset + first * kind.itemsize)
            yield first, np.fromfile(stream, kind, min(at_once, count - first))


def missing_ranges(path: Path) -> list[IndexRange]:
    """Ranges of flat indices that are not computed yet, in order."""
    ranges: list[IndexRange] = []
    for start, status in statuses(path):
        edges = start + np.flatnonzero(np.diff(status == MISSING, prepend=False, append=False))
        ranges += zip(map(int, edges[::2]), map(int, edges[1::2]), strict=True)
    return joined(ranges)


def points_to_add(path: Path, other: Path, layout: Layout) -> Iterator[np.ndarray]:
    """Records, (n,) at a time, of points that `other` has and `path`, a file of that layout, misses."""
    offsets = _offsets(other, layout)
    at_once = min(POINTS_AT_ONCE, BYTES_AT_ONCE // layout.record.itemsize + 1)
    with other.open("rb") as stream:
        for (first, ours), (_, theirs) in zip(statuses(path, at_once), statuses(other, at_once), strict=True):
            wanted = (ours == MISSING) & (theirs != MISSING)
            if wanted.any():
                records = np.empty(wanted.sum(), layout.record)
                records["index"] = first + np.flatnonzero(wanted)
                for name, offset in offsets.items():
                    kind = layout.record[name]
                    stream.seek(offset + first * kind.itemsize)
                    values = np.fromfile(stream, kind.base, len(ours) * prod(kind.shape))
                    records[name] = values.reshape(len(ours), *kind.shape)[wanted]
                yield records


def write_points(path: Path, blocks: Iterable[np.ndarray], layout: Layout) -> bool:
    """Writes records, (n,) in any order, into the variables, neighbours by one call; whether any were."""
    offsets = _offsets(path, layout)
    any_written = False
    with path.open("r+b") as stream:
        for records in filter(len, blocks):
            any_written = True
            ordered = records[np.argsort(records["index"], kind="stable")]  # of a point twice, the last stays
            index = ordered["index"]
            edges = [0, *map(int, np.flatnonzero(np.diff(index) != 1) + 1), len(index)]
            runs = [(a, b, int(index[a])) for a, b in pairwise(edges)]
            for name, offset in offsets.items():
                values = np.ascontiguousarray(ordered[name])
                for a, b, first in runs:
                    stream.seek(offset + first * values[0].nbytes)
                    stream.write(values[a:b].data)
    return any_written


def _offsets(path: Path, layout: Layout) -> dict[str, int]:
    """Where in the file each variable begins."""
    with h5py.File(path, "r") as file:
        return {variable.name: file[variable.name].id.get_offset() for variable in layout.variables}
