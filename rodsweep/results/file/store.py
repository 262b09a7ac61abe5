"""The result file: created whole at the start, replaced whole when points are folded in.

The file is netCDF-4-compatible HDF5 and is only ever exchanged by a rename, so it opens at any
instant. What ranks finish goes to the journal beside it (`rodsweep.results.run.journal`) and is folded
in at the end of a run, or at the start of the next one where a run was killed.
"""

import json
import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import chain, pairwise
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...errors import EnvironmentLacks, InputError
from ..layouts.variables import MISSING, Filled, Layout
from ..run.checkpoints import drop_checkpoints
from ..run.journal import journal_directory, read_journals
from ..run.lock import Lock
from .creation import SIGNATURE, Plan, add_variables, create_file
from .replacing import replace_whole
from .seal import check
from .view import DAMAGES, reason_of, refuse_misfit

BLOCK = 1 << 16
"""Values read at once where a whole variable is scanned."""
SPACE_FACTOR, SPACE_FIXED = 3, 300_000
"""Room that a run needs: the file, the journals and the copy in units of the file, and bytes besides."""


class Store:
    """A result file under one run; only the first rank has one, and only one run at a time."""

    def __init__(self, path: Path, plan: Plan, fresh: bool = False):
        """Opens the file that continues `plan`, or creates it; InputError if it is another's."""
        self.path, self.plan = path, plan
        self.journals = journal_directory(path)
        with self._on_disk():
            path.parent.mkdir(parents=True, exist_ok=True)
            self.lock = Lock(self.journals, path)
            try:
                self._open(fresh)
            except BaseException:
                self.close()
                raise

    @contextmanager
    def _on_disk(self) -> Iterator[None]:
        """What the disk refuses in here is EnvironmentLacks; HDF5 says RuntimeError for it."""
        try:
            yield
        except (OSError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or str(error).splitlines()[0]
            raise EnvironmentLacks(
                f"{self.path} cannot be written: {reason}; what is done is kept"
            ) from error

    def _open(self, fresh: bool) -> None:
        if self.path.exists() and not fresh:
            self._refuse_another()
            self.fold({})
            return
        if self.path.exists() and not is_ours(self.path):
            raise InputError(f"{self.path} is no result file, so --fresh leaves it alone")
        self._need_room()
        self._drop_journals()
        drop_checkpoints(self.journals)
        copy = self._temporary()
        copy.unlink(missing_ok=True)
        create_file(copy, self.plan)
        replace_whole(copy, self.path)

    def _need_room(self) -> None:
        """EnvironmentLacks unless the file, its journals and the copy that replaces it have room."""
        size = SPACE_FACTOR * prod(self.plan.shape) * (self.plan.layout.bytes_per_point + 12)
        size += SPACE_FIXED
        free = shutil.disk_usage(self.path.parent).free
        if free < size:
            raise EnvironmentLacks(
                f"{self.path} needs {size / 1e6:.3g} MB on its disk while it is computed, and "
                f"{free / 1e6:.3g} MB are free"
            )

    def attributes(self) -> dict[str, Any]:
        """What the file says of itself."""
        with h5py.File(self.path, "r") as file:
            return dict(file.attrs)

    def finished(self) -> bool:
        """Whether the file says when its run ended."""
        return "finished" in self.attributes()

    def missing(self) -> list[tuple[int, int]]:
        """Ranges of flat indices that are not computed yet, in order."""
        ranges: list[tuple[int, int]] = []
        for start, status in _statuses(self.path):
            edge = start + np.flatnonzero(np.diff(status == MISSING, prepend=False, append=False))
            for a, b in zip(map(int, edge[::2]), map(int, edge[1::2]), strict=True):
                if ranges and ranges[-1][1] == a:
                    ranges[-1] = (ranges[-1][0], b)
                else:
                    ranges.append((a, b))
        return ranges

    def fold(self, attributes: dict[str, Any], additions: Sequence[Filled] = ()) -> None:
        """Puts all journalled points, the attributes and whole variables into the file; drops the journals.

        `additions` are what only all points together give, such as curves; the file changes in one instant.
        """
        with self._on_disk():
            self._fold(attributes, additions)

    def _fold(self, attributes: dict[str, Any], additions: Sequence[Filled]) -> None:
        blocks = read_journals(self.journals, self.plan.layout, self.plan.fingerprint, prod(self.plan.shape))
        first = next(blocks, None)
        if first is not None or attributes or additions:
            copy = self._temporary()
            copy.unlink(missing_ok=True)  # it may be a link
            shutil.copyfile(self.path, copy)
            if first is not None:
                write_points(copy, chain([first], blocks), self.plan.layout)
            if attributes or additions:
                with h5py.File(copy, "r+") as file:
                    add_variables(file, additions)
                    file.attrs.update(attributes)
            replace_whole(copy, self.path)
        self._drop_journals()
        if not self.missing():
            drop_checkpoints(self.journals)

    def status_counts(self) -> dict[str, int]:
        """How many points have each status, by the name of the status."""
        names = {MISSING: "missing", **dict(self.plan.flags)}
        counts: dict[str, int] = {}
        for _, status in _statuses(self.path):
            for value, n in zip(*np.unique(status, return_counts=True), strict=True):
                name = names.get(int(value), f"unknown ({value})")
                counts[name] = counts.get(name, 0) + int(n)
        return counts

    def close(self) -> None:
        """Gives the lock back and removes the journal directory where nothing is left in it."""
        self._temporary().unlink(missing_ok=True)
        self.lock.release()

    def _drop_journals(self) -> None:
        for path in self.journals.glob("rank-*"):
            if not path.is_dir():
                path.unlink()

    def _temporary(self) -> Path:
        return self.journals / "next.h5"

    def _refuse_another(self) -> None:
        """InputError unless the existing file answers the same config."""
        if not self.path.is_file():
            raise InputError(f"{self.path} is not a file; choose another with -o")
        try:
            check(self.path, values=True)
            with h5py.File(self.path, "r") as file:
                theirs = json.loads(file.attrs["config_resolved"])
                fingerprint = file.attrs["fingerprint"]
                if fingerprint == self.plan.fingerprint:
                    refuse_misfit(file, self.plan.layout)
        except DAMAGES as error:
            raise InputError(
                f"{self.path} exists and is not a whole rodsweep result ({reason_of(error)}); it is left as "
                "it is: choose another file with -o, or replace it with --fresh"
            ) from None
        if fingerprint != self.plan.fingerprint or theirs != self.plan.config:
            change = difference(theirs, self.plan.config) or "the points listed in parameters.points differ"
            raise InputError(
                f"{self.path} was made from another config ({change}); choose another file with -o, or "
                "replace it with --fresh"
            )


def is_ours(path: Path) -> bool:
    """Whether a file is a rodsweep result, or HDF5 that is too damaged to say whose it is."""
    if not path.is_file():
        return False
    with path.open("rb") as stream:
        if stream.read(8) != b"\x89HDF\r\n\x1a\n":
            return False
    try:
        check(path, values=False)
        with h5py.File(path, "r") as file:
            return bool(file.attrs.get("program") == SIGNATURE)
    except DAMAGES:
        return True


def write_points(path: Path, blocks: Iterable[np.ndarray], layout: Layout) -> None:
    """Writes records, in any order, into the variables of a closed file.

    The variables are contiguous in the file, so a record goes to its place by arithmetic, whatever
    the shape of the grid; neighbours go by one call. Nothing is mapped: pages that are touched would
    count as this process's memory, in the end the whole file.
    """
    with h5py.File(path, "r") as file:
        offsets = {variable.name: file[variable.name].id.get_offset() for variable in layout.variables}
    with path.open("r+b") as stream:
        for records in filter(len, blocks):
            ordered = records[np.argsort(records["index"], kind="stable")]  # of a point twice, the last stays
            index = ordered["index"]
            edges = [0, *map(int, np.flatnonzero(np.diff(index) != 1) + 1), len(index)]
            runs = [(a, b, int(index[a])) for a, b in pairwise(edges)]
            for name, offset in offsets.items():
                values = np.ascontiguousarray(ordered[name])
                for a, b, first in runs:
                    stream.seek(offset + first * values[0].nbytes)
                    stream.write(values[a:b].data)


def _statuses(path: Path) -> Iterator[tuple[int, np.ndarray]]:
    """(flat index of the first, statuses) of all points, a block at a time."""
    with h5py.File(path, "r") as file:
        data = file["status"]
        offset, kind, count = data.id.get_offset(), data.dtype, data.size
    # Not through HDF5, whose blocks follow the axes: along the first, which may have one value only.
    with path.open("rb") as stream:
        stream.seek(offset)
        for first in range(0, count, BLOCK):
            yield first, np.fromfile(stream, kind, min(BLOCK, count - first))


def difference(theirs: Any, ours: Any, key: str = "") -> str:
    """The first key in which two resolved configs differ, with both values; empty if none does."""
    if isinstance(theirs, dict) and isinstance(ours, dict):
        for name in [*ours, *(n for n in theirs if n not in ours)]:
            found = difference(theirs.get(name), ours.get(name), f"{key}.{name}" if key else name)
            if found:
                return found
        return ""
    if theirs == ours:
        return ""
    return f"{key} is {json.dumps(theirs)[:80]} in the file and {json.dumps(ours)[:80]} in the config"
