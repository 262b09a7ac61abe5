"""Read-only view of a result file together with the points in its journals, for `show` and `plot`."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ...model.arm.quantities import ARM_FILE_VARIABLES
from ...model.parameters import PARAMETERS
from ..layouts.si_units import load_kind_of
from ..layouts.variables import TYPED_UNIT_ATTRIBUTE
from .content_digests import is_user_added
from .current_state import (
    failure_reasons_with_journals,
    insert_records,
    read_file_and_journals,
    records_only_in_journals,
)
from .validation import damage_as_refusals, escape_control_characters, open_checked, refuse_absent

MAX_CHECKED_BYTES = 10**9
"""Size of a file, in bytes, up to which its numbers are compared with the seal before use. In a larger file
only HDF5's structures are checked, because the comparison of the numbers takes a second for each GB."""


class FileVariables(Mapping[str, np.ndarray]):
    """Variables of an open file as NumPy arrays, each read on first access."""

    def __init__(self, path: Path, file: h5py.File, recent: np.ndarray):
        """recent: records, (n,), of points that are still in the journals."""
        self.path = path
        self.file = file
        self.recent = recent
        self.values_read: dict[str, np.ndarray] = {}
        """Arrays that were already read, by name of the variable."""

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.values_read:
            with damage_as_refusals(self.path):
                values = self.file[name][...]
                if len(self.recent) and name in (self.recent.dtype.names or ()):
                    insert_records(values, name, self.recent)
                self.values_read[name] = values
        return self.values_read[name]

    def __contains__(self, name: object) -> bool:
        with damage_as_refusals(self.path):
            return name in self.file and not is_user_added(str(name))

    def __iter__(self) -> Iterator[str]:
        return (name for name in self.file if not is_user_added(name))

    def __len__(self) -> int:
        return sum(1 for _ in self)


@dataclass(frozen=True, slots=True)
class ResultView:
    """Contents of a result file and its journals. path: the file. attributes: its attributes. variables: its
    variables as NumPy arrays, by name."""

    path: Path
    attributes: dict[str, Any]
    variables: Mapping[str, np.ndarray]
    parameters: tuple[str, ...]
    """Names of the parameters of a point: dimensions of a grid, or variables along the dimension `point`."""
    status_flags: dict[int, str]
    """Name of the status, by value of the variable `status`."""
    journalled_count: int
    """Number of points that are still in the journals of a running or interrupted run."""
    arm_axes: tuple[str, ...] = ()
    """Names of the dimensions of a grid over an arm's quantities; empty for a grid of parameters or a
    list."""
    typed_units: dict[str, str] = field(default_factory=dict)
    """Unit in which the user typed a quantity of an arm, by name of the quantity."""

    @property
    def task(self) -> str:
        """Name of the task that computed the results."""
        return str(self.attributes["task"])

    @property
    def config(self) -> dict[str, Any]:
        """The resolved config; empty if the file has none."""
        tree: dict[str, Any] = json.loads(self.attributes.get("config_resolved", "{}"))
        return tree

    @property
    def is_grid(self) -> bool:
        """Whether the points are a grid of parameters."""
        return "point" not in self.variables and not self.arm_axes

    @property
    def parameter_values(self) -> dict[str, np.ndarray]:
        """Values of each parameter by name: an axis of a grid, (n,); a column of a list, (n,); or an array
        over a grid over an arm's quantities."""
        return {name: self.variables[name] for name in PARAMETERS if name in self.variables}

    @property
    def quantities(self) -> dict[str, np.ndarray]:
        """Quantities of an arm in SI units by name; empty if the file has no arm.

        The shape of a quantity is (); (n,) along a parameter or the dimension `point`; or (...,) along axes
        of a grid over quantities.
        """
        return {name: self.variables[name] for name in ARM_FILE_VARIABLES if name in self.variables}

    @property
    def load_kind(self) -> str:
        """Kind of the loads of an arm in the file: "force" or "pressure"."""
        return load_kind_of(self.config.get("parameters", {}).get("arm") or {})

    @property
    def as_list(self) -> "ResultView":
        """This view with a grid over an arm's quantities turned into a list of points; for all other points,
        this view unchanged."""
        if not self.arm_axes:
            return self
        shape = self.variables["status"].shape
        variables = {name: self._flattened_to_list(name, shape) for name in self.variables}
        variables["point"] = np.arange(1, self.variables["status"].size + 1)
        return replace(self, variables=variables, arm_axes=())

    def _flattened_to_list(self, name: str, shape: tuple[int, ...]) -> np.ndarray:
        """Variable `name` with the axes of a grid, of the shape `shape`, flattened to the list of points.
        Variables without these axes are unchanged."""
        values = self.variables[name]
        if name in self.arm_axes:
            axes_shape = [-1 if axis == name else 1 for axis in self.arm_axes]
            return np.broadcast_to(values.reshape(axes_shape), shape).ravel()
        dimension_count = len(shape)
        return (
            values.reshape(-1, *values.shape[dimension_count:])
            if values.shape[:dimension_count] == shape
            else values
        )

    @property
    def status_names(self) -> NDArray[np.str_]:
        """Name of the status of every point, (points,)."""
        return np.array(
            [self.status_flags.get(int(value), "missing") for value in self.variables["status"].ravel()]
        )

    def has_status(self, *statuses: str) -> NDArray[np.bool_]:
        """Mask of the points whose status has one of the names `statuses`, with the shape of `status`."""
        values = [value for value, word in self.status_flags.items() if word in statuses]
        return np.isin(self.variables["status"], values)

    @property
    def status_sentences(self) -> dict[str, str]:
        """Meaning of every status as a sentence, by name of the status."""
        return status_sentences_in(self.attributes)

    def flattened_by_point(self, name: str) -> np.ndarray:
        """Variable `name` as an array (points, ...), with all dimensions of the points flattened to the first
        dimension."""
        values = self.variables[name]
        return values.reshape(-1, *values.shape[self.variables["status"].ndim :])

    def point_values(self, index: int) -> dict[str, np.ndarray]:
        """Values at the point with the flat index `index`, by name, of every variable that has a value at
        each point; the shape is that of the variable's other dimensions."""
        shape = self.variables["status"].shape
        names = (name for name, values in self.variables.items() if values.shape[: len(shape)] == shape)
        return {name: self.flattened_by_point(name)[index] for name in names}

    @property
    def point_columns(self) -> dict[str, np.ndarray]:
        """Value of each parameter at every point, by name, (points,) each; in a grid the last axis is
        fastest."""
        columns = [self.variables[name] for name in self.parameters]
        if self.is_grid:
            columns = [table.ravel() for table in np.meshgrid(*columns, indexing="ij")]
        return dict(zip(self.parameters, columns, strict=True))


def status_sentences_in(attributes: Mapping[str, Any]) -> dict[str, str]:
    """Meaning of every status as a sentence, by name of the status, from the attributes of a file."""
    lines = str(attributes.get("status_sentences", "")).splitlines()
    return dict(line.split(": ", 1) for line in lines if ": " in line)


def read_view(path: Path) -> ResultView:
    """View of the result file at `path`, which stays open, with journalled points.

    Raises InputError if the file is not a result.
    """
    return read_file_and_journals(path, lambda: _view(path))


def _view(path: Path) -> ResultView:
    """View from reading the file and its journals once; see `read_view`."""
    refuse_absent(path)
    # Opened only once, because a run may replace the file at any instant.
    file, header = open_checked(path, checks_values=path.stat().st_size <= MAX_CHECKED_BYTES)
    with damage_as_refusals(path):
        status = file["status"]
        words = str(escape_control_characters(status.attrs["flag_meanings"])).split()
        flags = dict(zip((int(value) for value in status.attrs["flag_values"]), words, strict=True))
        recent = records_only_in_journals(header, status[...].ravel())
        variables = FileVariables(path, file, recent)
        stored = (name for name in ARM_FILE_VARIABLES if name in file)
        units = {
            name: str(file[name].attrs[TYPED_UNIT_ATTRIBUTE])
            for name in stored
            if TYPED_UNIT_ATTRIBUTE in file[name].attrs
        }
    layout = header.layout
    attributes = header.attributes | failure_reasons_with_journals(header)
    return ResultView(
        path, attributes, variables, layout.parameters, flags, len(recent), layout.arm_axes, units
    )
