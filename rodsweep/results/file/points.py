"""Points of a closed result file, read and written at computed offsets, because every variable is contiguous.

HDF5 is not used for the points: HDF5 reads blocks along the axes of a grid, and the first axis may have a
single value. The file is not mapped into memory, because all pages that were read would be counted as memory
of the process.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...sweep.points.points import Points
from ...sweep.points.ranges import IndexRange, merged_ranges
from ..layouts.variables import MISSING_STATUS, Layout

MAX_READ_BLOCK_POINTS = 1 << 16
"""Maximum number of points in a block that is read at once."""
MAX_READ_BLOCK_BYTES = 1 << 26
"""Maximum size of a block that is read at once, in bytes; a block has fewer points if their records are
large."""


def iterate_statuses(path: Path, block_size: int | None = None) -> Iterator[tuple[int, np.ndarray]]:
    """Yields (flat index of the first point, statuses of n consecutive points, (n,)) until all points are
    read.

    block_size: number of points per step; MAX_READ_BLOCK_POINTS by default.
    """
    with h5py.File(path, "r") as file:
        status_dataset = file["status"]
        offset = status_dataset.id.get_offset()
        dtype = status_dataset.dtype
        point_count = status_dataset.size
    block_size = block_size or MAX_READ_BLOCK_POINTS
    with path.open("rb") as stream:
        for start in range(0, point_count, block_size):
            stream.seek(offset + start * dtype.itemsize)
            yield start, np.fromfile(stream, dtype, min(block_size, point_count - start))


def missing_ranges(path: Path) -> list[IndexRange]:
    """Ranges of the flat indices of missing points of a result file, in order."""
    ranges: list[IndexRange] = []
    for start, status in iterate_statuses(path):
        # False at both ends gives every run of missing points a start and an end.
        edges = start + np.flatnonzero(np.diff(status == MISSING_STATUS, prepend=False, append=False))
        ranges += zip(map(int, edges[::2]), map(int, edges[1::2]), strict=True)
    return merged_ranges(ranges)


def records_to_add(path: Path, other_path: Path, layout: Layout) -> Iterator[np.ndarray]:
    """Yields records, (n,), of points that the file `other_path` has and the file `path` lacks."""
    block_size = _points_per_block(layout)
    pairs = zip(iterate_statuses(path, block_size), iterate_statuses(other_path, block_size), strict=True)
    masks = (
        (start, statuses == MISSING_STATUS, other_statuses != MISSING_STATUS)
        for (start, statuses), (_, other_statuses) in pairs
    )
    blocks = ((start, is_missing & is_in_other) for start, is_missing, is_in_other in masks)
    yield from _unchanged_selected_records(other_path, layout, blocks)


def stored_records(path: Path, layout: Layout) -> Iterator[np.ndarray]:
    """Yields records, (n,), of all computed points of a file with the given layout."""
    statuses = iterate_statuses(path, _points_per_block(layout))
    blocks = ((start, status != MISSING_STATUS) for start, status in statuses)
    yield from _unchanged_selected_records(path, layout, blocks)


def _points_per_block(layout: Layout) -> int:
    """Number of points in a block that is read at once, for the record size of a layout."""
    # At least one point, however large its record.
    return min(MAX_READ_BLOCK_POINTS, MAX_READ_BLOCK_BYTES // layout.record_dtype.itemsize + 1)


def _unchanged_selected_records(
    path: Path, layout: Layout, blocks: Iterable[tuple[int, np.ndarray]]
) -> Iterator[np.ndarray]:
    """Yields records, (n,), of selected points of the file `path` that were not changed after all points were
    solved. blocks: (flat index of the first point of a block, mask of the selected points)."""
    changed = _indices_changed_after_solve(path, layout)
    offsets = _variable_offsets(path, layout)
    with path.open("rb") as stream:
        for start, mask in blocks:
            # Results that depended on all points would be wrong in a sweep with other points.
            is_selected = mask & ~np.isin(start + np.arange(len(mask)), changed)
            if is_selected.any():
                records = np.empty(is_selected.sum(), layout.record_dtype)
                records["index"] = start + np.flatnonzero(is_selected)
                for name, offset in offsets.items():
                    dtype = layout.record_dtype[name]
                    stream.seek(offset + start * dtype.itemsize)
                    # One read of the whole block is faster than a seek for every selected point.
                    values = np.fromfile(stream, dtype.base, len(is_selected) * prod(dtype.shape))
                    records[name] = values.reshape(len(is_selected), *dtype.shape)[is_selected]
                yield records


def records_at(path: Path, index: np.ndarray, layout: Layout) -> np.ndarray:
    """Records, (n,), of a file with the given layout at the flat indices `index`, (n,)."""
    records = np.empty(len(index), layout.record_dtype)
    records["index"] = index
    offsets = _variable_offsets(path, layout)
    with path.open("rb") as stream:
        for name, offset in offsets.items():
            dtype = layout.record_dtype[name]
            for i, position in enumerate(index):
                stream.seek(offset + int(position) * dtype.itemsize)
                records[name][i] = np.fromfile(stream, dtype.base, prod(dtype.shape)).reshape(dtype.shape)
    return records


def records_of_points(points: Mapping[int, Mapping[str, Any]], layout: Layout) -> np.ndarray:
    """Records, (n,), made from `points`: by flat index of the point, the values of its variables by name."""
    records = np.empty(len(points), layout.record_dtype)
    for record, (index, values) in zip(records, points.items(), strict=True):
        record["index"] = index
        for variable in layout.variables:
            record[variable.name] = values[variable.name]
    return records


def points_of_file(path: Path, layout: Layout) -> Points:
    """All points of the sweep of a result file, computed or missing."""
    with h5py.File(path, "r") as file:
        return points_of_open_file(file, layout)


def points_of_open_file(file: h5py.File, layout: Layout) -> Points:
    """All points of the sweep of an open result file, computed or missing."""
    names = layout.parameters
    axes = {name: file[name][...] for name in layout.arm_axes}
    if not axes:
        return Points(names, tuple(file[name][...] for name in names), is_grid="point" not in file)
    columns = []
    for name in names:  # a parameter has the shape of the grid or, if it is an axis, varies along it only
        shape = [-1 if axis == name else 1 for axis in layout.arm_axes]
        table = file[name][...].reshape(shape) if name in layout.arm_axes else file[name][...]
        columns.append(np.broadcast_to(table, file["status"].shape).ravel())
    return Points(names, tuple(columns), is_grid=False, arm_axes=axes)


def write_records(path: Path, blocks: Iterable[np.ndarray], layout: Layout) -> bool:
    """Writes records into a result file; returns whether there were any records. blocks: arrays of records,
    (n,) each, in any order; of several records of a point the last one counts.

    Values of a variable at consecutive points are written by a single call.
    """
    offsets = _variable_offsets(path, layout)
    any_written = False
    with path.open("r+b") as stream:
        for records in filter(len, blocks):
            any_written = True
            # Stable: the last record of a point wins.
            sorted_records = records[np.argsort(records["index"], kind="stable")]
            index = sorted_records["index"]
            # Equal indices start a new run, so that the last record of a point is written last.
            edges = [0, *map(int, np.flatnonzero(np.diff(index) != 1) + 1), len(index)]
            runs = [(run_start, run_end, int(index[run_start])) for run_start, run_end in pairwise(edges)]
            for name, offset in offsets.items():
                values = np.ascontiguousarray(sorted_records[name])
                for run_start, run_end, first in runs:
                    stream.seek(offset + first * values[0].nbytes)
                    stream.write(values[run_start:run_end].data)
    return any_written


def _indices_changed_after_solve(path: Path, layout: Layout) -> np.ndarray:
    """Flat indices of the points that were changed after all points were solved, (n,)."""
    with h5py.File(path, "r") as file:
        if layout.changed_points_variable and layout.changed_points_variable in file:
            return np.asarray(file[layout.changed_points_variable][...]) - 1
    return np.empty(0, int)


def _variable_offsets(path: Path, layout: Layout) -> dict[str, int]:
    """Offset in the file, in bytes, of the first number of each variable of the layout, by name."""
    with h5py.File(path, "r") as file:
        return {variable.name: file[variable.name].id.get_offset() for variable in layout.variables}
