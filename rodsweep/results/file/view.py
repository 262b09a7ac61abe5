"""A result file with what its journals add to it, read only: what `show` and `plot` work on."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ...model.arm.quantities import ALL_QUANTITIES
from ...model.parameters import NONLINEAR_PARAMETERS
from ..layouts.variables import TYPED
from .content import is_users
from .recent import journalled_points, put_in, unfolded
from .validation import cleaned, open_whole, reading, refuse_absent

CHECKED_WHOLE = 10**9
"""Bytes up to which the numbers are checked too, not only HDF5's structures, before a file is shown."""


class Variables(Mapping[str, np.ndarray]):
    """The variables of an open file as NumPy arrays, each read when it is first asked for."""

    def __init__(self, path: Path, file: h5py.File, recent: np.ndarray):
        """`recent`: records, (n,), of points that belong into the file and are not in it yet."""
        self.path, self.file, self.recent = path, file, recent
        self.read: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.read:
            with reading(self.path):
                values = self.file[name][...]
                if len(self.recent) and name in self.recent.dtype.fields:
                    put_in(values, name, self.recent)
                self.read[name] = values
        return self.read[name]

    def __contains__(self, name: object) -> bool:
        with reading(self.path):
            return name in self.file and not is_users(str(name))

    def __iter__(self) -> Iterator[str]:
        return (name for name in self.file if not is_users(name))

    def __len__(self) -> int:
        return sum(1 for _ in self)


@dataclass(frozen=True, slots=True)
class View:
    """A file's attributes and its variables as NumPy arrays."""

    path: Path
    attributes: dict[str, Any]
    variables: Mapping[str, np.ndarray]
    parameters: tuple[str, ...]
    """What makes a point: the dimensions of a grid, or what is given along `point`."""
    flags: dict[int, str]
    journalled: int
    """Finished points that are shown and still in the journal: of a run that goes on, or was interrupted."""
    over: tuple[str, ...] = ()
    """The dimensions of a grid over an arm's quantities."""
    typed: dict[str, str] = field(default_factory=dict)
    """The units in which an arm's quantities were typed."""

    @property
    def task(self) -> str:
        """The task whose results these are."""
        return str(self.attributes["task"])

    @property
    def is_grid(self) -> bool:
        """Whether the points are a grid of parameters."""
        return "point" not in self.variables and not self.over

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """The parameters that the file knows: axes of a grid, or columns of a list, each (n,)."""
        return {name: self.variables[name] for name in NONLINEAR_PARAMETERS if name in self.variables}

    @property
    def quantities(self) -> dict[str, np.ndarray]:
        """Those of an arm in SI units; none without one.

        Each is of shape () or along a parameter, along `point`, or of a grid over them along their own.
        """
        return {name: self.variables[name] for name in ALL_QUANTITIES if name in self.variables}

    @property
    def listed(self) -> "View":
        """A grid over an arm's quantities as the list of its points; itself where it is of another kind."""
        if not self.over:
            return self
        shape = self.variables["status"].shape
        found = {name: self._listed(name, shape) for name in self.variables}
        found["point"] = np.arange(1, self.variables["status"].size + 1)
        return replace(self, variables=found, over=())

    def _listed(self, name: str, shape: tuple[int, ...]) -> np.ndarray:
        """A variable along the list of points, where it is along axes of their grid."""
        values = self.variables[name]
        if name in self.over:
            along = [-1 if axis == name else 1 for axis in self.over]
            return np.broadcast_to(values.reshape(along), shape).ravel()
        n = len(shape)
        return values.reshape(-1, *values.shape[n:]) if values.shape[:n] == shape else values

    def by_point(self, name: str) -> np.ndarray:
        """A variable with all points along its first dimension, (points, ...)."""
        values = self.variables[name]
        return values.reshape(-1, *values.shape[self.variables["status"].ndim :])

    def of_point(self, index: int) -> dict[str, np.ndarray]:
        """The variables of the point at a flat index, each in its shape there."""
        shape = self.variables["status"].shape
        names = (name for name, values in self.variables.items() if values.shape[: len(shape)] == shape)
        return {name: self.by_point(name)[index] for name in names}

    @property
    def point_columns(self) -> dict[str, np.ndarray]:
        """Every parameter at every point, shape (points,); in a grid the last axis is the fastest."""
        columns = [self.variables[name] for name in self.parameters]
        if self.is_grid:
            columns = [table.ravel() for table in np.meshgrid(*columns, indexing="ij")]
        return dict(zip(self.parameters, columns, strict=True))


def read_view(path: Path) -> View:
    """The file, which stays open, with what its journals add to it; InputError if it is no result."""
    return unfolded(path, lambda: _view(path))


def _view(path: Path) -> View:
    refuse_absent(path)
    # Opened once: a run may exchange the file at any instant.
    file, header = open_whole(path, values=path.stat().st_size <= CHECKED_WHOLE)
    with reading(path):
        status = file["status"]
        words = str(cleaned(status.attrs["flag_meanings"])).split()
        flags = dict(zip((int(v) for v in status.attrs["flag_values"]), words, strict=True))
        recent = journalled_points(header, status[...].ravel())
        variables = Variables(path, file, recent)
        typed = {name: str(file[name].attrs[TYPED]) for name in ALL_QUANTITIES if is_typed(file, name)}
    layout = header.layout
    return View(path, header.attributes, variables, layout.parameters, flags, len(recent), layout.over, typed)


def is_typed(file: h5py.File, name: str) -> bool:
    """Whether a file says in which unit a quantity was typed."""
    return name in file and TYPED in file[name].attrs
