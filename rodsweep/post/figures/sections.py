"""A section of a grid or of a list: the points that have chosen values of some parameters."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ...config.arm.axes import ALONG
from ...config.document.refusals import nearest
from ...errors import InputError
from ...model.arm.drag import DRAGS
from ...model.arm.quantities import ALL_QUANTITIES
from ...model.parameters import NONLINEAR_PARAMETERS
from ...model.units import in_si
from ...results.file.view import View
from .lists import BESIDE_POINTS

SAME_VALUE = 1e-6
"""Relative distance within which a value that is typed is one of the file's, which has all its digits."""
MOST_NAMED = 8
"""Values that a refusal names."""


def section(view: View, at: Mapping[str, float | str]) -> View:
    """The points of a file with these values of parameters, or with these quantities of an arm.

    Quantities are numbers in SI, or text with a unit. InputError, with the values there are, for others.
    """
    for name, value in at.items():
        view = _cut(view, name, _number(name, value))
    return view


def _number(name: str, value: float | str) -> float:
    """A value as a number, in SI where it is a quantity."""
    if name == "drag" and value in DRAGS:
        return float(DRAGS.index(str(value)))
    try:
        return float(value)
    except ValueError:
        if name == "drag":
            raise InputError(f"--at drag={value} is none of {', '.join(DRAGS)}") from None
        if name in ALL_QUANTITIES:
            return in_si(f"--at {name}", value, ALL_QUANTITIES[name].unit, "12 cm")
        raise InputError(f"--at {name}={value} is no parameter with a number, as k1=150 is") from None


def _cut(view: View, name: str, value: float) -> View:
    listed = {} if view.is_grid else {n: v for n, v in view.quantities.items() if np.ndim(v)}
    axes = view.over or (*view.parameters, *listed)
    if name not in axes:
        known = ", ".join(axes)
        close = nearest(name, list(axes))
        hint = f"did you mean {close[0]}?" if close else f"the points differ in {known}"
        followed = f"; {name} is no axis of points in this file" if name in NONLINEAR_PARAMETERS else ""
        raise InputError(f"--at {name}={value:.15g}: {view.path} has no such axis{followed}; {hint}")
    values = view.variables[name]
    there = np.isclose(values, value, rtol=SAME_VALUE, atol=0.0)
    if not there.any():
        unique = np.unique(values)
        named = [f"{one:.15g}" for one in unique[:MOST_NAMED]]
        more = f", ... {unique[-1]:.15g}" if len(unique) > MOST_NAMED else ""
        raise InputError(
            f"--at {name}={value:.15g}: {view.path} has no point there; it has {name} = "
            f"{', '.join(named)}{more}"
        )
    return _grid_at(view, name, there) if view.is_grid or view.over else _list_at(view, there)


def _grid_at(view: View, name: str, there: np.ndarray) -> View:
    """A grid with the places of one axis, a mask of its shape."""
    names = view.over or view.parameters
    shape, axis = view.variables["status"].shape, names.index(name)
    along = {name, *(quantity for quantity, moved in ALONG.items() if moved == name)}
    variables = {}
    for key, data in view.variables.items():
        if key in along and np.ndim(data):
            variables[key] = data[there]
        elif data.shape[: len(shape)] == shape and key not in (*names, *BESIDE_POINTS):
            variables[key] = np.compress(there, data, axis=axis)
        else:
            variables[key] = data
    return replace(view, variables=variables)


def _list_at(view: View, there: np.ndarray) -> View:
    """A list with some of its points, a mask."""
    variables = {
        key: data[there] if data.shape[:1] == there.shape and key not in BESIDE_POINTS else data
        for key, data in view.variables.items()
    }
    return replace(view, variables=variables)


def choices_of(given: Mapping[str, float | str]) -> dict[str, float | str]:
    """Values by parameter as Python gives them; InputError where one is neither a number nor text."""
    try:
        return {str(n): value if isinstance(value, str) else float(value) for n, value in given.items()}
    except (AttributeError, TypeError, ValueError):
        raise InputError("at is not allowed; give numbers by parameter, as at={'k1': 150}") from None
