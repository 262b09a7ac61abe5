"""Creation of a result file, which is netCDF-4-compatible HDF5 with space for all variables, and later
addition of variables."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...sweep.points.chains import Chains
from ...sweep.points.groups import PointGroups
from ...sweep.points.points import Points
from ..layouts.dimensions import dimension_attributes
from ..layouts.variables import MISSING_STATUS, FilledVariable, Layout, Variable, flag_attributes
from .combination.config_comparison import fingerprint_of
from .validation import FORMAT_NUMBER, PROGRAM_NAME


@dataclass(frozen=True, slots=True)
class FilePlan:
    """Plan of a result file: points, layout, resolved config, and the variables that do not belong to single
    points."""

    points: Points
    layout: Layout
    coordinates: dict[str, Array]
    """Coordinates, (n,) each, of extra dimensions such as u, by name of the dimension. All other extra
    dimensions have the coordinates 1, 2, ..."""
    variables_from_config: Callable[[], tuple[FilledVariable, ...]]
    """Returns the variables known before any point is solved; called once, when a file is created."""
    config: dict[str, Any]
    """The resolved config."""
    attributes: dict[str, Any]
    """Attributes of the file, in addition to the attributes that every result file has."""
    status_flags: tuple[tuple[int, str], ...]
    """(value, name) of every status except MISSING_STATUS."""
    quantity_variables: tuple[FilledVariable, ...] = ()
    """Quantities of an arm, with values: axes of a grid over these quantities, or additional coordinates of
    the points."""
    chains: Chains | None = None
    """Chains of points; None if no point starts from the state of another point."""
    groups: PointGroups | None = None
    """Groups of points that are solved together; None if no points are solved together."""
    variables_from_points: Callable[[Mapping[str, Any]], tuple[FilledVariable, ...]] = lambda values: ()
    """Returns variables computed from the variables of all points; called when no point is missing."""

    @property
    def point_dimension_names(self) -> tuple[str, ...]:
        """Names of the dimensions of the points."""
        return self.layout.dimensions(is_list=not self.points.axes)

    @property
    def fingerprint(self) -> str:
        """Fingerprint of config and points; a run can continue a file with an equal fingerprint."""
        return fingerprint_of(self.config, self.points.identifying_arrays)


@dataclass(frozen=True, slots=True)
class FinalAdditions:
    """Contents that complete a file with all points. sweep_wide_variables: variables that do not belong to
    single points. changed_points: by flat index of a point, new values of its variables by name.
    failure_reasons: lines that say why some of these points failed."""

    sweep_wide_variables: Sequence[FilledVariable] = ()
    changed_points: Mapping[int, Mapping[str, NDArray[Any]]] = field(default_factory=dict)
    failure_reasons: Sequence[str] = ()


NO_FINAL_VARIABLES = FinalAdditions()


def create_file(path: Path, plan: FilePlan) -> None:
    """Creates the file of a plan at `path`; all points are missing."""
    # Constants may need a solve: a process that MPI starts would inherit the open file with its lock.
    constants = plan.variables_from_config()
    with h5py.File(path, "w") as file:
        _write_parameters(file, plan)
        for name, length in plan.layout.extents.items():
            _write_dimension_scale(file, name, plan.coordinates.get(name, np.arange(1, length + 1)))
        for variable in plan.layout.variables:
            dataset = _new_dataset(file, variable, plan.points.shape + plan.layout.point_shape(variable))
            _write_attributes(
                file, dataset, variable, (*plan.point_dimension_names, *variable.extra_dimensions)
            )
        add_variables(file, constants)
        add_variables(
            file,
            [quantity for quantity in plan.quantity_variables if not is_dimension_coordinate(quantity[0])],
        )
        file["status"].attrs.update(flag_attributes(((MISSING_STATUS, "missing"), *plan.status_flags)))
        file.attrs["program"] = PROGRAM_NAME
        file.attrs["format"] = FORMAT_NUMBER
        file.attrs["fingerprint"] = plan.fingerprint
        file.attrs["config_resolved"] = json.dumps(plan.config)
        file.attrs.update(plan.attributes)


def add_variables(file: h5py.File, variables: Sequence[FilledVariable]) -> None:
    """Adds variables with their values to an open file, and coordinates 1, 2, ... of new dimensions.
    variables: (variable, values) pairs."""
    for variable, values in variables:
        for name, length in zip(variable.extra_dimensions, values.shape, strict=True):
            if name not in file:
                _write_dimension_scale(file, name, np.arange(1, length + 1))
        dataset = file.create_dataset(variable.name, data=values.astype(variable.dtype))
        _write_attributes(file, dataset, variable, variable.extra_dimensions)


def _write_parameters(file: h5py.File, plan: FilePlan) -> None:
    """Writes the coordinates of the points: axes of a grid, or all parameters along `point`."""
    names = plan.layout.parameters
    points = plan.points
    for variable, values in plan.quantity_variables:
        if is_dimension_coordinate(variable):
            _write_dimension_scale(file, variable.name, values, variable)
    dependent_names = [
        variable.name for variable, _ in plan.quantity_variables if not is_dimension_coordinate(variable)
    ]
    if dependent_names or not points.axes:
        file.attrs["coordinates"] = " ".join([*(() if points.axes else names), *dependent_names])
    if points.arm_axes:
        return
    if not points.is_grid:
        _write_dimension_scale(file, "point", np.arange(1, points.count + 1, dtype="<i4"))
    for name, column in zip(names, points.columns, strict=True):
        if points.is_grid:
            _write_dimension_scale(file, name, column)
        else:
            dataset = file.create_dataset(name, data=column)
            dataset.attrs.update(dimension_attributes(name))
            dataset.dims[0].attach_scale(file["point"])


def is_dimension_coordinate(variable: Variable) -> bool:
    """Whether a variable is the coordinate of a dimension with the same name."""
    return variable.extra_dimensions == (variable.name,)


def _write_dimension_scale(
    file: h5py.File, name: str, values: NDArray[Any], variable: Variable | None = None
) -> None:
    """Writes the coordinate `values`, (n,), of the dimension `name`. variable: description of a dimension
    that is not in DIMENSIONS."""
    dataset = file.create_dataset(name, data=values)
    dataset.make_scale(name)
    dataset.attrs.update(dimension_attributes(name) if variable is None else variable.attributes)


def _new_dataset(file: h5py.File, variable: Variable, shape: tuple[int, ...]) -> h5py.Dataset:
    """New contiguous dataset of `variable`, of the shape `shape`, allocated and filled when it is created, so
    that its offset in the file is final: `rodsweep.results.file.points` reads and writes points at this
    offset."""
    creation = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    creation.set_layout(h5py.h5d.CONTIGUOUS)
    # By default HDF5 allocates at the first write, and no offset would exist before.
    creation.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    # A point is recognised as missing by its fill values, so they must be on disk from the start.
    creation.set_fill_value(np.array(variable.fill_value, variable.dtype))
    hdf5_type = h5py.h5t.py_create(np.dtype(variable.dtype), logical=True)
    space = h5py.h5s.create_simple(shape)
    return h5py.Dataset(h5py.h5d.create(file.id, variable.name.encode(), hdf5_type, space, creation))


def _write_attributes(
    file: h5py.File, dataset: h5py.Dataset, variable: Variable, dimensions: Sequence[str]
) -> None:
    """Adds unit, long name, flags and dimensions of `variable` to its `dataset`."""
    dataset.attrs.update(variable.attributes)
    for axis, name in enumerate(dimensions):
        dataset.dims[axis].attach_scale(file[name])
    if "point" in dimensions:
        dataset.attrs["coordinates"] = file.attrs["coordinates"]
