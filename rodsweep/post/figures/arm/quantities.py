"""An arm's quantities in figures: their names as words, and values in the units typed by the user."""

from math import isclose
from typing import Any

import numpy as np

from ....arrays import Array
from ....config.arm.axes import STORED_ALONG
from ....config.arm.shape import OF_MATERIAL
from ....model.arm.arm import SlenderArm
from ....model.arm.drag import DRAGS
from ....model.arm.quantities import ALL_QUANTITIES, ARM_UNITS, RELATIVE
from ....model.units import written_in
from ....results.file.view import View
from ...summary.arm.arm import word

NO_BREAK = "\N{NO-BREAK SPACE}"
"""Space between a number and a unit, at which no line of a figure breaks."""
SAME_NUMBER = 1e-9
"""Largest relative difference between a stored parameter and the parameter computed from the arm again."""


def in_typed_unit(view: View, name: str, values: Array, si: str = "") -> tuple[Array, str]:
    """(values of a quantity, of any shape, in the unit typed by the user; this unit)."""
    si = si or ALL_QUANTITIES[name].unit
    unit = view.typed.get(name, si)
    return (values, "") if si == "1" else (values * written_in(1.0, unit, si), unit)


def quantity_text(view: View, name: str, value: float) -> str:
    """A quantity with its value in the unit typed by the user: `length 12 cm`."""
    if name == "drag":
        return f"{name}{NO_BREAK}{DRAGS[int(value)].replace('_', NO_BREAK)}"
    shown, unit = in_typed_unit(view, name, np.array([value]))
    unit = unit.replace("^3", "$^3$").replace("*", " ").replace(" ", NO_BREAK)
    return f"{word(name)}{NO_BREAK}{shown[0]:.4g}{NO_BREAK}{unit}".rstrip(NO_BREAK)


def given_quantities(view: View) -> list[str]:
    """Names of the quantities that define the arm of a file, without derived units."""
    return [name for name in view.quantities if name not in (*ARM_UNITS, *RELATIVE)]


def at_point(view: View, name: str, number: int) -> float:
    """A quantity at a point of a grid of parameters or of a list, numbered from 1."""
    values = np.asarray(view.variables[name])
    if values.size == 1:
        return float(values.ravel()[0])
    if view.is_grid:  # the quantity lies along the parameter that it changes
        shape = view.variables["status"].shape
        return float(values[np.unravel_index(number - 1, shape)[view.parameters.index(STORED_ALONG[name])]])
    return float(values.ravel()[number - 1])


def replaced(view: View, number: int) -> dict[str, float]:
    """Parameters at a point, numbered from 1, that the config gives instead of the arm's own."""
    given: dict[str, Any] = {name: at_point(view, name, number) for name in given_quantities(view)}
    if "drag" in given:
        given["drag"] = DRAGS[int(given["drag"])]
    arm = view.config.get("parameters", {}).get("arm") or {}
    own = SlenderArm(**given, **{name: arm[name] for name in OF_MATERIAL if arm.get(name) is not None})
    at = {name: float(view.point_columns[name][number - 1]) for name in view.parameters}
    if own.load:
        at.pop("F", None)
    return {
        name: value
        for name, value in at.items()
        if name == "F" or not isclose(value, getattr(own, name), rel_tol=SAME_NUMBER)
    }
