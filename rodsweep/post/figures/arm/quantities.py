"""Text of the quantities of an arm in figures: names, and values in the units typed by the user."""

from collections.abc import Mapping, Sequence
from math import isclose
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ....arrays import Array
from ....config.arm.axes import NON_LOAD_KEYS
from ....config.arm.shape import MATERIAL_KEYS
from ....model.arm.arm import SlenderArm
from ....model.arm.drag import DRAG_ESTIMATE_NAMES
from ....model.arm.quantities import ARM_FILE_VARIABLES, ARM_SCALES, LOAD_NAME_BY_RELATIVE_LOAD
from ....model.units import value_in_unit
from ....results.file.view import ResultView
from ...summary.arm.arm_texts import printed_quantity_name
from ...tables.rows_and_columns import arm_quantities_at_points
from ..style import heading_text

NO_BREAK_SPACE = "\N{NO-BREAK SPACE}"
"""No-break space, used between a number and its unit; a line is never broken at this character."""
EQUAL_PARAMETER_TOLERANCE = 1e-9
"""A stored parameter equals the parameter computed from the arm if the relative difference is at most this
number."""


def values_and_typed_unit(view: ResultView, name: str, values: Array, si: str = "") -> tuple[Array, str]:
    """Returns (values, unit) of the quantity `name` in the unit typed by the user. values: in the SI unit
    `si` (by default the unit of the quantity), of any shape."""
    si = si or ARM_FILE_VARIABLES[name].unit
    unit = view.typed_units.get(name, si)
    return (values, "") if si == "1" else (values * value_in_unit(1.0, unit, si), unit)


def values_and_label(view: ResultView, name: str, values: Array) -> tuple[Array, str]:
    """Returns (values in the unit typed by the user, label of an axis) of the quantity `name`. values: in SI
    units, (n,)."""
    values, unit = values_and_typed_unit(view, name, values)
    return values, printed_quantity_name(name) + (f" ({unit})" if unit else "")


def quantity_label_and_texts(view: ResultView, name: str, values: Array) -> tuple[str, list[str]]:
    """Returns (label, values as text) of the quantity `name`, in the unit typed by the user. values: in SI
    units, (n,); for a drag, indices in DRAG_ESTIMATE_NAMES."""
    if name == "drag":
        return printed_quantity_name(name), [
            DRAG_ESTIMATE_NAMES[int(value)].replace("_", " ") for value in values
        ]
    typed_values, label = values_and_label(view, name, values)
    return label, [f"{value:.4g}" for value in typed_values]


def quantity_text(view: ResultView, name: str, value: float) -> str:
    """Name and value of the quantity `name` in the unit typed by the user, such as "length 12 cm". value: in
    SI units; for a drag, index in DRAG_ESTIMATE_NAMES."""
    if name == "drag":
        return f"{name}{NO_BREAK_SPACE}{DRAG_ESTIMATE_NAMES[int(value)].replace('_', NO_BREAK_SPACE)}"
    converted, unit = values_and_typed_unit(view, name, np.array([value]))
    unit = unit.replace("^3", "$^3$").replace("*", " ").replace(" ", NO_BREAK_SPACE)
    return f"{printed_quantity_name(name)}{NO_BREAK_SPACE}{converted[0]:.4g}{NO_BREAK_SPACE}{unit}".rstrip(
        NO_BREAK_SPACE
    )


def constant_quantities_text(view: ResultView, drawn_names: Sequence[str] = ()) -> str:
    """Quantities of the arm, except `drawn_names`, with their values, as text; of an axis with several
    values, the smallest value. Empty without an arm."""
    texts = []
    for name, values in view.quantities.items():
        if name in drawn_names or name in ARM_SCALES:
            continue
        # A relative load varies with another quantity.
        if np.size(values) > 1 and name not in view.arm_axes:
            continue
        count_clause = f" (of {len(values)} values)" if np.size(values) > 1 else ""
        texts.append(quantity_text(view, name, float(np.min(values))) + count_clause)
    return ", ".join(texts)


def set_heading(figure: Figure, view: ResultView, *lines: str) -> None:
    """Writes the heading of a figure: see `heading_text`, with the constant quantities of an arm."""
    figure.suptitle(heading_text(view, constant_quantities_text(view), *lines))


def quantities_at_point(view: ResultView, number: int) -> dict[str, float]:
    """Quantities that the user gave for the arm at a point, by name, in SI units; a drag as an index in
    DRAG_ESTIMATE_NAMES. number: number of the point, from 1."""
    columns = arm_quantities_at_points(view)
    derived = (*ARM_SCALES, *LOAD_NAME_BY_RELATIVE_LOAD)
    return {name: float(column[number - 1]) for name, column in columns.items() if name not in derived}


def k2_at_poisson_ratio(view: ResultView, poisson: float) -> float:
    """The dimensionless k2 that the arm of a file has for the Poisson's ratio `poisson`. In the file only
    this ratio, a load and the drag may vary."""
    quantities: dict[str, Any] = {
        name: float(np.ravel(view.quantities[name])[0]) for name in NON_LOAD_KEYS if name in view.quantities
    }
    quantities.pop("drag", None)
    return float(_arm_of(view, quantities | {"poisson": poisson}).k2)


def _arm_of(view: ResultView, quantities: Mapping[str, Any]) -> SlenderArm:
    """The arm of a file with the quantities `quantities`, in SI units."""
    arm = view.config.get("parameters", {}).get("arm") or {}
    material = {name: arm[name] for name in MATERIAL_KEYS if arm.get(name) is not None}
    return SlenderArm(**quantities, **material)


def parameters_given_beside_arm(view: ResultView, number: int) -> dict[str, float]:
    """Parameters at a point, by name, that differ from the parameters computed from the arm, because the
    config gives them. F is included if the arm has no load, and otherwise left out. number: number of the
    point, from 1."""
    quantities: dict[str, Any] = dict(quantities_at_point(view, number))
    if "drag" in quantities:
        quantities["drag"] = DRAG_ESTIMATE_NAMES[int(quantities["drag"])]
    arm = _arm_of(view, quantities)
    stored_parameters = {name: float(view.point_columns[name][number - 1]) for name in view.parameters}
    if arm.load_name:
        stored_parameters.pop("F", None)
    return {
        name: value
        for name, value in stored_parameters.items()
        if name == "F" or not isclose(value, getattr(arm, name), rel_tol=EQUAL_PARAMETER_TOLERANCE)
    }
