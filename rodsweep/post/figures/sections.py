"""Sections of a grid or a list: the points with chosen values of some parameters."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...config.arm.axes import STORED_ALONG
from ...config.document.refusals import nearest
from ...config.values import short
from ...errors import InputError
from ...model.arm.drag import DRAGS
from ...model.arm.quantities import ALL_QUANTITIES
from ...model.parameters import NONLINEAR_PARAMETERS
from ...model.units import in_si
from ...results.file.view import View
from .lists import BESIDE_POINTS

TYPED_TOLERANCE = 1e-6
"""Largest relative difference between a typed value and the value in the file, which has all digits."""
MAX_NAMED = 8
"""Largest number of values that a refusal lists."""


def section(view: View, at: Mapping[str, float | str]) -> View:
    """Points of a file with these values of parameters, or of an arm's quantities.

    Quantities are numbers in SI units, or text with a unit. Raises InputError, with the values in the file,
    if no point has the chosen value.
    """
    for name, value in at.items():
        view = _cut(view, name, _number(name, value))
    return view


def _number(name: str, value: float | str) -> float:
    """A value as a number, in SI units for a quantity; raises InputError for anything else."""
    if name == "drag" and value in DRAGS:
        return float(DRAGS.index(str(value)))
    try:
        return float(value)
    except ValueError:
        if name == "drag":
            raise InputError(f"--at drag={value} is none of {', '.join(DRAGS)}") from None
        if name in ALL_QUANTITIES:
            return in_si(f"--at {name}", value, ALL_QUANTITIES[name].unit, "12 cm")
        raise InputError(f"--at {name}={value} must be a parameter with a number, such as k1=150") from None


def _cut(view: View, name: str, value: float) -> View:
    """Points at a value of a parameter or quantity; raises InputError if no point has the value."""
    listed = {} if view.is_grid else {n: v for n, v in view.quantities.items() if np.ndim(v)}
    axes = view.over or (*view.parameters, *listed)
    if name not in axes:
        known = ", ".join(axes)
        close = nearest(name, list(axes))
        hint = f"did you mean {close[0]}?" if close else f"the points differ in {known}"
        followed = f"; {name} is not an axis of points in this file" if name in NONLINEAR_PARAMETERS else ""
        raise InputError(f"--at {name}={value:.15g}: {view.path} has no such axis{followed}; {hint}")
    values = view.variables[name]
    chosen = np.isclose(values, value, rtol=TYPED_TOLERANCE, atol=0.0)
    if not chosen.any():
        unique = np.unique(values)
        named = [f"{one:.15g}" for one in unique[:MAX_NAMED]]
        more = f", ... {unique[-1]:.15g}" if len(unique) > MAX_NAMED else ""
        raise InputError(
            f"--at {name}={value:.15g}: {view.path} has no point there; it has {name} = "
            f"{', '.join(named)}{more}"
        )
    if view.is_grid or view.over:
        return _grid_at(view, name, chosen)
    variables = {
        key: data[chosen] if data.shape[:1] == chosen.shape and key not in BESIDE_POINTS else data
        for key, data in view.variables.items()
    }
    return replace(view, variables=variables)


def _grid_at(view: View, name: str, chosen: np.ndarray) -> View:
    """A grid restricted to the chosen places of an axis, a mask of the axis."""
    names = view.over or view.parameters
    shape = view.variables["status"].shape
    axis = names.index(name)
    along = {name, *(quantity for quantity, moved in STORED_ALONG.items() if moved == name)}
    variables = {}
    for key, data in view.variables.items():
        if key in along and np.ndim(data):
            variables[key] = data[chosen]
        elif data.shape[: len(shape)] == shape and key not in (*names, *BESIDE_POINTS):
            variables[key] = np.compress(chosen, data, axis=axis)
        else:
            variables[key] = data
    return replace(view, variables=variables)


def without_infinite(view: View) -> View:
    """A grid without infinite values of its axes, which have no place in a figure."""
    for name, values in view.axes.items():
        finite = np.isfinite(values)
        if len(values) > 1 and not finite.all():
            view = _grid_at(view, name, finite)
    return view


def choices_of(given: Mapping[str, float | str]) -> dict[str, float | str]:
    """Values by parameter, given in Python; raises InputError for a value that is neither number nor text."""
    try:
        return {str(n): value if isinstance(value, str) else float(value) for n, value in given.items()}
    except (AttributeError, TypeError, ValueError):
        shown = short(given)
        raise InputError(
            f"at = {shown} is not allowed; give numbers by parameter, as at={{'k1': 150}}"
        ) from None
