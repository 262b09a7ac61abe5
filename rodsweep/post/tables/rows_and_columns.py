"""Rows and columns of the tables of a result: one row for each item of a list, with the parameters of
the point of the item."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...config.arm.axes import FILE_AXIS_OF_QUANTITY
from ...model.arm.drag import DRAG_ESTIMATE_NAMES
from ...model.arm.quantities import ARM_FILE_VARIABLES
from ...results.file.view import ResultView
from ...results.layouts.dimensions import UNIT_AND_LONG_NAME_OF_DIMENSION
from ...results.layouts.si_variables import si_name_of, si_unit_of, si_variable_and_values
from ...results.layouts.variables import MISSING_STATUS, STATUS_VARIABLE, Variable
from .column import Column, column_of, coordinate_column, marks_missing_items, missing_values_mask

ItemIndices = tuple[NDArray[np.int64], ...]
"""Indices of the items of a list, (rows,) each: index of the point, then index along each dimension of the
list."""


def indices_of_items(view: ResultView, variables: Sequence[Variable], is_sweep_wide: bool) -> ItemIndices:
    """Indices of all items of the list with the variables `variables` that are not missing. is_sweep_wide:
    whether the list belongs to the whole file, not to single points."""
    point_count = 1 if is_sweep_wide else view.variables["status"].size
    is_present: NDArray[np.bool_] = np.zeros((), bool)
    for variable in variables:
        if marks_missing_items(variable) and (_is_stored_per_point(view, variable) or is_sweep_wide):
            values = view.variables[variable.name]
            inner_dimensions = len(variable.extra_dimensions)
            values = values.reshape(point_count, *values.shape[values.ndim - inner_dimensions :])
            is_present = is_present | ~missing_values_mask(variable, values)
    return np.nonzero(is_present)


def point_columns(
    view: ResultView, variables: Sequence[Variable], points: NDArray[np.int64]
) -> Iterator[Column]:
    """Yields the columns of points: parameters, quantities of an arm, then the variables `variables`. points:
    index of the point of each row, (rows,)."""
    for name, values in view.point_columns.items():
        yield coordinate_column(name, *UNIT_AND_LONG_NAME_OF_DIMENSION[name], values[points])
    for name, values in arm_quantities_at_points(view).items():
        yield quantity_column(name, values[points])
    is_missing = view.variables[STATUS_VARIABLE.name].reshape(-1)[points] == MISSING_STATUS
    for variable in variables:
        values = view.variables[variable.name].reshape(-1)[points]
        if variable.name == STATUS_VARIABLE.name:
            yield replace(
                column_of(variable, values, view.status_flags), missing_mask=np.zeros(len(points), bool)
            )
        else:
            column = column_of(variable, values)
            yield replace(column, missing_mask=column.missing_mask | is_missing)


def list_columns(
    view: ResultView, variables: Sequence[Variable], rows: ItemIndices, is_sweep_wide: bool
) -> Iterator[Column]:
    """Yields the columns of a list: coordinates of the items, then the variables. rows: result of
    `indices_of_items`. is_sweep_wide: as in `indices_of_items`."""
    names = variables[0].extra_dimensions
    for name, item_indices in zip(names, rows[1:], strict=True):
        yield coordinate_column(
            name, *UNIT_AND_LONG_NAME_OF_DIMENSION[name], view.variables[name][item_indices]
        )
    for variable in variables:
        values = view.variables[variable.name]
        if is_sweep_wide:
            yield column_of(variable, values[rows[1:]])
        elif _is_stored_per_point(view, variable):
            inner_shape = values.shape[values.ndim - len(names) :]
            yield column_of(variable, values.reshape(-1, *inner_shape)[rows])
        else:  # the variable is stored with dimensions for some parameters, or for the point
            dimensions = variable.extra_dimensions[: -len(names)]
            indices = [
                rows[0] if name == "point" else _axis_indices(view, name)[rows[0]] for name in dimensions
            ]
            yield column_of(variable, values[(*indices, *rows[1:])])


def si_columns(
    view: ResultView,
    variables: Sequence[Variable],
    columns: Sequence[Column],
    points: NDArray[np.int64] | None,
) -> Iterator[Column]:
    """Yields columns in SI units for the `variables` of a list (such as the crossings) that the file stores
    only in dimensionless form; nothing for a rod.

    points: index of the point of each row, (rows,); None if the list belongs to the whole file: then only
    quantities that are equal at all points are used.
    """
    if not view.quantities:
        return
    quantities = arm_quantities_at_points(view)
    if points is not None:
        quantities = {name: values[points] for name, values in quantities.items()}
    else:
        quantities = {name: values[0] for name, values in quantities.items() if np.ptp(values) == 0}
    by_name = {column.name: column for column in columns}
    is_force_load = view.load_kind == "force"
    for entry in variables:
        column = by_name[entry.name]
        # The position of a crossing along a row over F is a force.
        is_force = entry.name == "crossing_at" and "F" not in view.parameters
        variable = replace(entry, name="crossing_F") if is_force else entry
        si = si_unit_of(variable, is_force_load)
        is_convertible = {*si.factors, *si.divisors} <= quantities.keys()
        if si.unit and is_convertible and si_name_of(variable.name, si.unit) not in view.variables:
            si_values, values = si_variable_and_values(variable, column.values, quantities, is_force_load)
            yield replace(column_of(si_values, values), missing_mask=column.missing_mask)


def varying_quantity_columns(view: ResultView, rows: ItemIndices) -> Iterator[Column]:
    """Yields columns of the quantities of an arm that vary along a row of a diagram, such as the pressure if
    F varies."""
    for name, values in view.quantities.items():
        if values.size > 1 and view.is_grid and FILE_AXIS_OF_QUANTITY.get(name, "") not in view.parameters:
            yield quantity_column(name, values[rows[1]])


def quantity_column(name: str, values: NDArray) -> Column:
    """Column of an arm's quantity `name`. values: in SI units, (rows,)."""
    column = coordinate_column(name, *ARM_FILE_VARIABLES[name][:2], values)
    return replace(column, flag_meanings=dict(enumerate(DRAG_ESTIMATE_NAMES))) if name == "drag" else column


def _is_stored_per_point(view: ResultView, variable: Variable) -> bool:
    """Whether a variable of a list is stored for each point. The declaration of such a variable omits the
    dimensions of the points."""
    return variable.extra_dimensions[0] not in ("point", *view.parameters)


def _axis_indices(view: ResultView, parameter_name: str) -> NDArray[np.int64]:
    """Index of each point along the axis of `parameter_name`, (points,)."""
    return np.searchsorted(view.parameter_values[parameter_name], view.point_columns[parameter_name])


def arm_quantities_at_points(view: ResultView) -> dict[str, NDArray]:
    """Quantities of an arm at all points, in SI units, (points,) each, by name, except quantities that vary
    along a row of a diagram."""
    point_count = view.variables["status"].size
    columns = {}
    for name, values in view.quantities.items():
        dimension = FILE_AXIS_OF_QUANTITY.get(name, "")
        if values.size == 1 or not view.is_grid:
            columns[name] = np.broadcast_to(values, point_count)
        elif dimension in view.parameters:
            columns[name] = values[_axis_indices(view, dimension)]
    return columns
