"""The result file: created whole at the start, replaced whole when points are folded in.

The file is netCDF-4-compatible HDF5 and is only ever exchanged by a rename, so it opens at any
instant. What ranks finish goes to the journal beside it (`rodsweep.results.journal`) and is folded
in at the end of a run, or at the start of the next one where a run was killed.
"""

import fcntl
import json
import os
import shutil
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from itertools import chain
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ..errors import EnvironmentLacks, InputError
from .journal import journal_directory, read_journals
from .schema import MISSING, PARAMETER_NAMES, Layout, Variable

BLOCK = 1 << 20
"""Values read at once where a whole variable is scanned."""
LOCK_PATIENCE = 5.0
"""Seconds to wait for the lock: ranks whose launcher was killed live on for a moment."""
SPACE_FACTOR, SPACE_FIXED = 3, 300_000
"""Room that a run needs: the file, the journals and the copy in units of the file, and bytes besides."""
SIGNATURE = "rodsweep"


@dataclass(frozen=True, slots=True)
class Plan:
    """What makes a file: the points, the layout, and the config that it answers."""

    columns: Sequence[NDArray[np.float64]]
    is_grid: bool
    layout: Layout
    coordinates: dict[str, NDArray[np.float64]]
    """Values of extra dimensions that have some, such as u."""
    constants: tuple[tuple[Variable, NDArray[np.float64]], ...]
    """Variables known without solving, with their values: (k1, mode) on a grid, (point, mode) else."""
    config: dict[str, Any]
    """The resolved config."""
    attributes: dict[str, Any]
    flags: tuple[tuple[int, str], ...]
    """Values and meanings of `status`, beside MISSING."""

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(c) for c in self.columns) if self.is_grid else (len(self.columns[0]),)

    @property
    def fingerprint(self) -> str:
        """What two files must share for the one to continue the other."""
        digest = sha256(json.dumps(self.config, sort_keys=True).encode())
        for column in self.columns:
            digest.update(np.ascontiguousarray(column).tobytes())
        return digest.hexdigest()


class Store:
    """A result file under one run; only the first rank has one, and only one run at a time."""

    def __init__(self, path: Path, plan: Plan, fresh: bool = False):
        """Opens the file that continues `plan`, or creates it; InputError if it is another's."""
        self.path, self.plan = path, plan
        self.journals = journal_directory(path)
        with self._on_disk():
            path.parent.mkdir(parents=True, exist_ok=True)
            self.lock = self._locked()
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
        self._create()

    def _need_room(self) -> None:
        """EnvironmentLacks unless the file, its journals and the copy that replaces it have room."""
        size = SPACE_FACTOR * int(np.prod(self.plan.shape)) * (self.plan.layout.bytes_per_point + 12)
        size += SPACE_FIXED
        free = shutil.disk_usage(self.path.parent).free
        if free < size:
            raise EnvironmentLacks(
                f"{self.path} needs {size / 1e6:.3g} MB on its disk while it is computed, and "
                f"{free / 1e6:.3g} MB are free"
            )

    def finished(self) -> bool:
        """Whether the file says when its run ended."""
        with h5py.File(self.path, "r") as file:
            return "finished" in file.attrs

    def missing(self) -> list[tuple[int, int]]:
        """Ranges of flat indices that are not computed yet, in order."""
        ranges: list[tuple[int, int]] = []
        with h5py.File(self.path, "r") as file:
            for start, status in _blocks(file["status"]):
                edge = np.flatnonzero(np.diff(np.concatenate([[0], status == MISSING, [0]])))
                for a, b in zip(edge[::2] + start, edge[1::2] + start, strict=True):
                    if ranges and ranges[-1][1] == a:
                        ranges[-1] = (ranges[-1][0], int(b))
                    else:
                        ranges.append((int(a), int(b)))
        return ranges

    def fold(self, attributes: dict[str, Any]) -> None:
        """Puts all journalled points and the attributes into the file, then drops the journals."""
        with self._on_disk():
            self._fold(attributes)

    def _fold(self, attributes: dict[str, Any]) -> None:
        blocks = read_journals(self.journals, self.plan.layout, self.plan.fingerprint)
        first = next(blocks, None)
        if first is not None or attributes:
            copy = self._temporary()
            shutil.copyfile(self.path, copy)
            if first is not None:
                write_points(copy, chain([first], blocks), self.plan.layout)
            if attributes:
                with h5py.File(copy, "r+") as file:
                    file.attrs.update(attributes)
            self._replace(copy)
        self._drop_journals()

    def status_counts(self) -> dict[str, int]:
        """How many points have each status, by the name of the status."""
        names = {MISSING: "missing", **dict(self.plan.flags)}
        counts: dict[str, int] = {}
        with h5py.File(self.path, "r") as file:
            for _, status in _blocks(file["status"]):
                for value, n in zip(*np.unique(status, return_counts=True), strict=True):
                    counts[names[int(value)]] = counts.get(names[int(value)], 0) + int(n)
        return counts

    def close(self) -> None:
        """Gives the lock back and removes the journal directory where nothing is left in it."""
        (self.journals / "next.h5").unlink(missing_ok=True)
        (self.journals / "lock").unlink(missing_ok=True)
        if not any(self.journals.iterdir()):
            self.journals.rmdir()
        os.close(self.lock)

    def _locked(self) -> int:
        """The lock of this file; InputError if another run keeps it."""
        patience = time.monotonic() + LOCK_PATIENCE
        while True:
            self.journals.mkdir(exist_ok=True)
            try:
                handle = os.open(self.journals / "lock", os.O_RDWR | os.O_CREAT, 0o644)
            except FileNotFoundError:  # a run that ended just now took the directory away
                continue
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if os.fstat(handle).st_nlink:
                    return handle
            except BlockingIOError:
                os.close(handle)
                if time.monotonic() < patience:
                    time.sleep(0.1)
                    continue
                raise InputError(
                    f"{self.path} is being written by another run; wait for it, or choose another file with "
                    "-o (several ranks that each say this were started without MPI between them)"
                ) from None
            os.close(handle)  # the run that ended just now took this lock file away: take a new one

    def _drop_journals(self) -> None:
        for path in self.journals.glob("rank-*"):
            path.unlink()

    def _temporary(self) -> Path:
        return self.journals / "next.h5"

    def _replace(self, copy: Path) -> None:
        with copy.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(copy, self.path)
        directory = os.open(self.path.parent, os.O_RDONLY)
        os.fsync(directory)
        os.close(directory)

    def _refuse_another(self) -> None:
        """InputError unless the existing file answers the same config."""
        try:
            with h5py.File(self.path, "r") as file:
                theirs = json.loads(file.attrs["config_resolved"])
                fingerprint = file.attrs["fingerprint"]
        except (OSError, KeyError, ValueError, TypeError, RuntimeError):
            raise InputError(
                f"{self.path} exists and is not a whole rodsweep result; it is left as it is: choose another "
                "file with -o, or replace it with --fresh"
            ) from None
        if fingerprint != self.plan.fingerprint:
            change = difference(theirs, self.plan.config) or "the points listed in parameters.points differ"
            raise InputError(
                f"{self.path} was made from another config ({change}); choose another file with -o, or "
                "replace it with --fresh"
            )

    def _create(self) -> None:
        plan = self.plan
        copy = self._temporary()
        with h5py.File(copy, "w") as file:
            dims = self._dimensions(file)
            for variable in plan.layout.variables:
                shape = plan.shape + tuple(plan.layout.extents[d] for d in variable.extra)
                data = _contiguous(file, variable, shape)
                _describe(file, data, variable, (*dims, *variable.extra))
            for variable, values in plan.constants:
                data = file.create_dataset(variable.name, data=values)
                _describe(file, data, variable, variable.extra)
            status = file["status"]
            status.attrs["flag_values"] = np.array([MISSING, *(v for v, _ in plan.flags)], dtype="i1")
            status.attrs["flag_meanings"] = " ".join(["missing", *(m for _, m in plan.flags)])
            file.attrs["program"] = SIGNATURE
            file.attrs["fingerprint"] = plan.fingerprint
            file.attrs["config_resolved"] = json.dumps(plan.config)
            file.attrs.update(plan.attributes)
        self._replace(copy)

    def _dimensions(self, file: h5py.File) -> tuple[str, ...]:
        """Dimension scales: the four parameters, or `point` with the parameters along it."""
        plan = self.plan
        names = tuple(PARAMETER_NAMES)
        dims: tuple[str, ...] = names if plan.is_grid else ("point",)
        for name, column in zip(names, plan.columns, strict=True):
            data = file.create_dataset(name, data=column)
            if plan.is_grid:
                data.make_scale(name)
        scales: dict[str, np.ndarray] = {} if plan.is_grid else {"point": np.arange(plan.shape[0])}
        for name, extent in plan.layout.extents.items():
            scales[name] = plan.coordinates.get(name, np.arange(1, extent + 1))
        for name, values in scales.items():
            file.create_dataset(name, data=values).make_scale(name)
        for name, (units, long_name) in PARAMETER_NAMES.items():
            if not plan.is_grid:
                file[name].dims[0].attach_scale(file["point"])
            file[name].attrs.update(units=units, long_name=long_name)
        extra = {"mode": "leading first: descending growth rate, of a pair the positive frequency first"}
        extra |= {"u": "material coordinate along the rod", "point": "row of the point list, from 0"}
        for name in scales:
            file[name].attrs.update(units="1", long_name=extra[name])
        if not plan.is_grid:
            file.attrs["coordinates"] = " ".join(names)
        return dims


def is_ours(path: Path) -> bool:
    """Whether a file is a rodsweep result, or HDF5 that is too damaged to say whose it is."""
    with path.open("rb") as stream:
        if stream.read(8) != b"\x89HDF\r\n\x1a\n":
            return False
    try:
        with h5py.File(path, "r") as file:
            return bool(file.attrs.get("program") == SIGNATURE)
    except OSError:
        return True


def write_points(path: Path, blocks: Iterable[np.ndarray], layout: Layout) -> None:
    """Writes records, in any order, into the variables of a closed file.

    The variables are contiguous in the file, so a record goes to its place by arithmetic, whatever
    the shape of the grid and without holding a variable in memory.
    """
    places = {}
    with h5py.File(path, "r") as file:
        for variable in layout.variables:
            data = file[variable.name]
            inner = tuple(layout.extents[d] for d in variable.extra)
            points = data.size // int(np.prod(inner))
            places[variable.name] = (data.id.get_offset(), data.dtype, (points, *inner))
    arrays = {
        name: np.memmap(path, dtype, "r+", offset, shape) for name, (offset, dtype, shape) in places.items()
    }
    for records in blocks:
        for name, array in arrays.items():
            array[records["index"]] = records[name]
    for array in arrays.values():
        array.flush()


def _blocks(data: h5py.Dataset) -> Iterable[tuple[int, np.ndarray]]:
    """(flat index, values) of a point variable, a block at a time along its first dimension."""
    step = max(1, BLOCK // max(1, int(np.prod(data.shape[1:]))))
    for first in range(0, data.shape[0], step):
        block = data[first : first + step]
        yield first * int(np.prod(data.shape[1:])), block.ravel()


def _contiguous(file: h5py.File, variable: Variable, shape: tuple[int, ...]) -> h5py.Dataset:
    """A dataset in one piece that has its place in the file, filled, from the start."""
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_layout(h5py.h5d.CONTIGUOUS)
    creation.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    creation.set_fill_value(np.array(variable.fill, variable.dtype))
    kind = h5py.h5t.py_create(np.dtype(variable.dtype), logical=True)
    space = h5py.h5s.create_simple(shape)
    return h5py.Dataset(h5py.h5d.create(file.id, variable.name.encode(), kind, space, creation))


def _describe(file: h5py.File, data: h5py.Dataset, variable: Variable, dims: Sequence[str]) -> None:
    for axis, name in enumerate(dims):
        data.dims[axis].attach_scale(file[name])
    data.attrs.update(units=variable.units, long_name=variable.long_name)
    if dims and dims[0] == "point":
        data.attrs["coordinates"] = " ".join(PARAMETER_NAMES)


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
