"""Sections of a grid or a list of points: the points at which some parameters have given values."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from ...config.arm.axes import FILE_AXIS_OF_QUANTITY
from ...config.document.refusals import similar_keys
from ...errors import InputError, short_repr
from ...model.arm.drag import DRAG_ESTIMATE_NAMES
from ...model.arm.quantities import ARM_FILE_VARIABLES
from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES
from ...model.units import quantity_in_si
from ...results.file.view import ResultView
from .point_lists import DIMENSIONS_OTHER_THAN_POINTS

TYPED_VALUE_TOLERANCE = 1e-6
"""A value typed by the user selects the values of the file that differ by at most this relative amount."""
ARM_UNIT_VARIABLE_NAMES = ("tau2", "force_scale", "pressure_scale")
"""Names of the units of an arm, which a file stores beside the quantities of the arm; these units are no
axes."""
MAX_VALUES_LISTED_IN_ERROR = 8
"""Largest number of values that an error message lists."""


def slice_at_values(view: ResultView, typed_values: Mapping[str, float | str]) -> ResultView:
    """View of the points at which parameters, or quantities of an arm, have the values `typed_values`, by
    name.

    The value of a quantity is a number in SI units, or a text with a unit. Raises InputError if no point has
    one of the values; the message lists the values in the file.
    """
    for name, value in typed_values.items():
        view = _slice_at_value(view, name, _number_in_si(name, value))
    return view


def _number_in_si(name: str, value: float | str) -> float:
    """The value of the parameter or quantity `name` as a number; for a quantity, in SI units. Raises
    InputError for an invalid text."""
    if name == "drag" and value in DRAG_ESTIMATE_NAMES:
        return float(DRAG_ESTIMATE_NAMES.index(str(value)))
    try:
        return inf if value == ".inf" else float(value)
    except ValueError:
        if name == "drag":
            raise InputError(
                f"--at drag={value}: the drag must be one of {', '.join(DRAG_ESTIMATE_NAMES)}"
            ) from None
        if name in ARM_FILE_VARIABLES:
            return quantity_in_si(f"--at {name}", value, ARM_FILE_VARIABLES[name].unit, "12 cm")
        raise InputError(f"--at {name}={value} must be a parameter with a number, such as k1=150") from None


def _slice_at_value(view: ResultView, name: str, value: float) -> ResultView:
    """View of the points at which `name` has the given value. Raises InputError if there is no such point."""
    quantity_names = [
        quantity_name
        for quantity_name, quantity_values in view.quantities.items()
        if np.ndim(quantity_values) and quantity_name not in ARM_UNIT_VARIABLE_NAMES
    ]
    if view.is_grid:  # quantities that are stored along an axis of a parameter
        quantity_names = [
            quantity_name
            for quantity_name in quantity_names
            if FILE_AXIS_OF_QUANTITY.get(quantity_name) in view.parameters
        ]
    axes = view.arm_axes or (*view.parameters, *quantity_names)
    if name not in axes:
        raise InputError(f"--at {name}={value:.15g}: {view.path} {_not_an_axis_predicate(view, name, axes)}")
    values = view.variables[name]
    is_chosen = np.isclose(values, value, rtol=TYPED_VALUE_TOLERANCE, atol=0.0)
    if not is_chosen.any():
        raise InputError(
            f"--at {name}={value:.15g}: {view.path} has no point there; it has {name} = "
            f"{_values_text(np.unique(values), value)}"
        )
    if view.is_grid or view.arm_axes:
        axis_name = name if name in (*view.arm_axes, *view.parameters) else FILE_AXIS_OF_QUANTITY[name]
        return _grid_restricted_to_values(view, axis_name, is_chosen)
    variables = {
        key: data[is_chosen]
        if data.shape[:1] == is_chosen.shape and key not in DIMENSIONS_OTHER_THAN_POINTS
        else data
        for key, data in view.variables.items()
    }
    return replace(view, variables=variables)


def _not_an_axis_predicate(view: ResultView, name: str, axes: Sequence[str]) -> str:
    """Predicate that says that `name` is none of the axes `axes`, with a similar name, or with the names of
    the axes that have several values."""
    similar = similar_keys(name, list(axes))
    varied_axes = [axis for axis in axes if len(np.unique(view.variables[axis])) > 1]
    hint = (
        f"did you mean {similar[0]}?" if similar else f"the points differ in {', '.join(varied_axes or axes)}"
    )
    followed_clause = (
        f"; {name} is not an axis of points in this file" if name in NONLINEAR_ROD_PARAMETER_NAMES else ""
    )
    return f"has no such axis{followed_clause}; {hint}"


def _values_text(values: np.ndarray, requested: float) -> str:
    """The increasing values of an axis as text; of more than MAX_VALUES_LISTED_IN_ERROR values, the first and
    the last value and the two values around `requested`."""
    if len(values) <= MAX_VALUES_LISTED_IN_ERROR:
        return ", ".join(f"{value:.15g}" for value in values)
    next_index = int(np.clip(np.searchsorted(values, requested), 1, len(values) - 1))
    nearest_text = " and ".join(f"{value:.15g}" for value in values[next_index - 1 : next_index + 1])
    return f"{values[0]:.15g} to {values[-1]:.15g}; the nearest values are {nearest_text}"


def _grid_restricted_to_values(view: ResultView, name: str, is_chosen: np.ndarray) -> ResultView:
    """View of a grid restricted to some values of the axis `name`. is_chosen: mask of these values."""
    names = view.arm_axes or view.parameters
    shape = view.variables["status"].shape
    axis = names.index(name)
    sliced_names = {
        name,
        *(quantity for quantity, changed_name in FILE_AXIS_OF_QUANTITY.items() if changed_name == name),
    }
    variables = {}
    for key, data in view.variables.items():
        if key in sliced_names and np.ndim(data):
            variables[key] = data[is_chosen]
        elif data.shape[: len(shape)] == shape and key not in (*names, *DIMENSIONS_OTHER_THAN_POINTS):
            variables[key] = np.compress(is_chosen, data, axis=axis)
        else:
            variables[key] = data
    return replace(view, variables=variables)


def without_infinite_values(view: ResultView) -> ResultView:
    """View of a grid without the infinite values of its axes, which a figure cannot show."""
    for name, values in view.parameter_values.items():
        finite = np.isfinite(values)
        if len(values) > 1 and not finite.all():
            view = _grid_restricted_to_values(view, name, finite)
    return view


def infinite_values_clause(columns: Mapping[str, np.ndarray], names: Sequence[str]) -> str:
    """Clause on infinite values of the parameters `names`, which an axis cannot show; empty if all values are
    finite. columns: values by parameter, (n,) each."""
    omissions = [f"{name} = inf" for name in names if not np.isfinite(columns[name]).all()]
    return f"; {' and '.join(omissions)} has no place on an axis and is left out" if omissions else ""


def checked_slice_values(section_values: Mapping[str, float | str]) -> dict[str, float | str]:
    """Copy of the values that a Python caller gives, by name of the parameter: numbers as floats, texts
    unchanged. Raises InputError for a value that is neither a number nor a text."""
    try:
        return {
            str(name): value if isinstance(value, str) else float(value)
            for name, value in section_values.items()
        }
    except (AttributeError, OverflowError, TypeError, ValueError):
        given_text = short_repr(section_values)
        raise InputError(
            f"at = {given_text} is not allowed; give numbers by parameter, as at={{'k1': 150}}"
        ) from None
