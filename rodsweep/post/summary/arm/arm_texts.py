"""Results about an arm for `rodsweep show`: quantities, variables in SI units of every task, thresholds.

Loads and lengths are in the units typed by the user, frequencies in Hz. All powers of an answer are in the
same unit, such as mW.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from ....model.arm.drag import DRAG_ESTIMATE_NAMES
from ....model.arm.quantities import (
    ARM_FILE_VARIABLES,
    ARM_SCALES,
    LOAD_NAME_BY_RELATIVE_LOAD,
    LOAD_SCALE_NAME_BY_LOAD,
    UNITS_AND_EXAMPLES,
)
from ....model.parameters import OPTIONAL_PARAMETER_NAMES
from ....model.units import value_in_unit, with_si_prefix
from ....results.file.view import ResultView
from ....results.layouts import LAYOUT_MAKERS
from ....results.layouts.si_units import HERTZ
from ....results.layouts.si_variables import si_variables_of
from ....results.layouts.thresholds import CROSSING_KINDS, CROSSING_MEANINGS
from ....results.layouts.variables import Variable
from ...located_thresholds import LocatedThreshold
from ...tables.rows_and_columns import arm_quantities_at_points
from ..number_texts import MAX_RANGE_END_DIGITS, rounded_text, value_range_text
from ..selection import PointSelection
from ..variable_errors import absolute_errors, known_values_mask

MAX_VALUES_LISTED_ONE_BY_ONE = 4
"""Up to this number of values of an array are listed one by one; more values are printed as a range."""
QUANTITIES_BY_SI_UNIT = {"m": ("length",), "Pa": ("pressure", "young"), "N": ("force",)}
"""Quantities of the arm, by SI unit. All numbers with this SI unit are printed in the unit of the
first of these quantities for which the user typed a unit."""
UNITS_WITH_PREFIX = ("J", "W")
"""SI units that get a prefix, such as mW."""
MAX_PREFIXED_TIME_IN_SECONDS = 0.1
"""Times are printed with a prefix, such as ms, if all are shorter than this time, in s."""
POINT_QUANTITY_DIGITS = 3
"""Number of significant digits of a quantity in the description of a point of the file."""
QUANTITY_WORDS = {"young": "Young's modulus", "poisson": "Poisson's ratio"}
"""Printed names of quantities of an arm, if different from the key of the config."""
THRESHOLD_SENTENCES = {
    "hopf": "flutter begins at {load}{rate}",
    "restabilization": "the straight arm is stable again from {load} on",
    "onset": "decaying disturbances start to oscillate at {load}",
}
"""Sentence on the load at a threshold of the straight arm, by kind of threshold."""


def printed_quantity_name(name: str) -> str:
    """Printed name of a quantity of an arm. name: key of the config."""
    return QUANTITY_WORDS.get(name, name.replace("_", " "))


def factor_and_printing_unit(view: ResultView, si: str, largest: float) -> tuple[float, str]:
    """Returns (factor, unit): the factor that converts numbers in the SI unit `si` to the unit in which they
    are printed, and this unit. The unit is the unit that the user typed, if any, otherwise `si`; for
    energies, powers and short times, with a prefix suitable for numbers up to `largest`."""
    names = (name for name in QUANTITIES_BY_SI_UNIT.get(si, ()) if name in view.typed_units)
    unit = next((view.typed_units[name] for name in names), si)
    if unit != si:
        return value_in_unit(1.0, unit, si), unit
    if si == "s" and largest < MAX_PREFIXED_TIME_IN_SECONDS or si in UNITS_WITH_PREFIX:
        return with_si_prefix(largest, si)
    return 1.0, si


def range_text_in_printing_unit(
    view: ResultView,
    values: np.ndarray,
    si: str,
    errors: np.ndarray | float = 0.0,
    max_digits: int = MAX_RANGE_END_DIGITS,
) -> str:
    """Range of `values`, in the SI unit `si`, as text in the unit of `factor_and_printing_unit`.

    errors: absolute errors, of the shape of the values, or 0, which limit the number of digits.
    """
    factor, unit = factor_and_printing_unit(view, si, _largest_absolute(values))
    errors_in_unit = np.broadcast_to(factor * errors, values.shape)
    return f"{value_range_text(factor * values, errors_in_unit, max_digits)} {unit}"


def _largest_absolute(values: np.ndarray) -> float:
    """Largest absolute value among finite `values`; 0 if no value is finite."""
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def varied_arm_quantities(view: ResultView) -> dict[str, np.ndarray]:
    """Given quantities of an arm that differ between points of a file, in SI units, by name: values at all
    points, (points,)."""
    columns = arm_quantities_at_points(view).items()
    given = {name: column for name, column in columns if name not in ARM_SCALES}
    return {name: column for name, column in given.items() if len(np.unique(column[~np.isnan(column)])) > 1}


def arm_quantity_ranges_text(points: PointSelection) -> str:
    """Ranges of an arm's quantities and of the taper over the points, as text; empty if all points of the
    file have the same arm."""
    view = points.view
    flat_mask = points.mask.ravel()
    range_texts = [
        quantity_range_text(view, name, column, flat_mask)
        for name, column in varied_arm_quantities(view).items()
    ]
    for name in OPTIONAL_PARAMETER_NAMES:
        column = view.as_list.point_columns.get(name, np.ones(1)).ravel()
        if len(np.unique(column)) > 1:
            ends = sorted({float(column[flat_mask].min()), float(column[flat_mask].max())})
            range_texts.append(
                f"{name} {' to '.join(f'{end:.{POINT_QUANTITY_DIGITS + 1}g}' for end in ends)}"
            )
    return ", ".join(filter(None, range_texts))


def quantity_range_text(view: ResultView, name: str, column: np.ndarray, mask: np.ndarray) -> str:
    """Range of the quantity `name` over the points in the mask `mask`, as text. column: values at all points,
    (points,). Empty for the quantity "drag" if the chosen points include all drags."""
    values = column[mask]
    if name == "drag":
        names = [DRAG_ESTIMATE_NAMES[int(index)] for index in np.unique(values)]
        return "" if len(names) == len(np.unique(column)) else f"drag {' and '.join(names)}".replace("_", " ")
    si = ARM_FILE_VARIABLES[name].unit
    unit = "" if si == "1" else view.typed_units.get(name, factor_and_printing_unit(view, si, 1.0)[1])
    factor = value_in_unit(1.0, unit, si) if unit else 1.0
    ends = [float(f"{factor * end:.{POINT_QUANTITY_DIGITS}g}") for end in (values.min(), values.max())]
    range_text = " to ".join(f"{end:.{POINT_QUANTITY_DIGITS + 1}g}" for end in sorted(set(ends)))
    if name in LOAD_NAME_BY_RELATIVE_LOAD:
        return f"{range_text} of flutter"
    return f"{printed_quantity_name(name)} {range_text} {unit}".rstrip()


def arm_variable_lines(points: PointSelection) -> list[str]:
    """List with a line on the ranges of an arm's variables, in the units of `factor_and_printing_unit`.
    Errors and crossings are left out; for several points all lists are left out, too. Empty list for a
    rod."""
    view = points.view
    if not view.quantities:
        return []
    values: dict[tuple[str, Variable], np.ndarray] = {}
    largest: dict[str, float] = {}
    for name, variable in si_variables_of(LAYOUT_MAKERS[view.task](view.config), view.config).items():
        is_printed_list = points.mask.size == 1 and variable.extra_dimensions != ("crossing",)
        if "error" in variable.name or (variable.extra_dimensions and not is_printed_list):
            continue
        known = known_values_mask(view.variables, name)[points.mask]
        column = np.where(known, points.values(variable.name), np.nan)
        if np.isfinite(column).any():
            values[name, variable] = column
            largest[variable.units] = max(largest.get(variable.units, 0.0), _largest_absolute(column))
    rows = []
    for (name, variable), column in values.items():
        factor, unit = factor_and_printing_unit(view, variable.units, largest[variable.units])
        errors = errors_in_si(view.variables, name, variable.name)[points.mask]
        numbers_text = _values_or_range_text(factor * column, factor * errors)
        rows.append(f"{variable.name.removesuffix('_si').removesuffix('_hz')} = {numbers_text} {unit}")
    return [f"in the arm's units: {'; '.join(rows)}"] if rows else []


def _values_or_range_text(values: np.ndarray, errors: np.ndarray) -> str:
    """Values as text: a few values one by one, more values as a range. errors: absolute errors, of the shape
    of the values, which limit the number of digits."""
    is_finite = np.isfinite(values)
    finite = values[is_finite]
    finite_errors = errors[is_finite]
    if values.ndim > 1 and 1 < finite.size <= MAX_VALUES_LISTED_ONE_BY_ONE:
        return ", ".join(map(rounded_text, finite, np.nan_to_num(finite_errors)))
    return value_range_text(finite, finite_errors)


def errors_in_si(variables: Mapping[str, np.ndarray], name: str, si_name: str) -> np.ndarray:
    """Absolute errors of the variable `si_name`, in SI units, from the errors of the dimensionless variable
    `name`; 0 where `name` is 0 or infinite. The errors have the shape of the two variables."""
    is_nonzero = np.isfinite(variables[name]) & (variables[name] != 0)
    scale = np.divide(
        variables[si_name], variables[name], out=np.zeros_like(variables[si_name]), where=is_nonzero
    )
    return np.asarray(np.abs(scale) * absolute_errors(variables, name))


def load_range_text(view: ResultView, F: np.ndarray, points: np.ndarray) -> str:
    """Range of the loads for the dimensionless forces F, (n,), as text. points: index of the point of each
    force, (n,)."""
    load = view.load_kind
    scale = _values_at_points(view.quantities[LOAD_SCALE_NAME_BY_LOAD[load]], points)
    return range_text_in_printing_unit(view, F * scale, UNITS_AND_EXAMPLES[load][0])


def single_arm_threshold_lines(view: ResultView) -> list[str]:
    """One line for each threshold of the only arm in a file, with kind, load, meaning and frequency; an empty
    list for a rod."""
    if not view.quantities:
        return []
    variables = view.variables
    rod = np.zeros(1, int)
    kinds, forces, frequencies = (
        variables[f"crossing_{name}"].ravel() for name in ("kind", "F", "frequency")
    )
    lines = []
    for i in np.flatnonzero(kinds > 0):
        kind = CROSSING_KINDS[int(kinds[i])]
        text = f"{kind} at {load_range_text(view, forces[i : i + 1], rod)}: {CROSSING_MEANINGS[kind]}"
        if frequencies[i]:
            text += f"; frequency {_frequency_range_text_in_hertz(view, frequencies[i : i + 1], rod)}"
        lines.append(text)
    return lines


def arm_threshold_sentences(
    view: ResultView, kind: str, thresholds: Sequence[tuple[LocatedThreshold, np.ndarray]]
) -> list[str]:
    """List with a sentence on the thresholds of the given kind, with load and frequency; empty for a rod, or
    if `thresholds` is empty. thresholds: pairs of a threshold and the indices, (points,), of the points along
    whose line it was found; these points differ in F only."""
    if not view.quantities or not thresholds:
        return []
    points = np.concatenate([points for _, points in thresholds])
    counts = [len(points) for _, points in thresholds]
    load_text = load_range_text(view, np.repeat([point.position for point, _ in thresholds], counts), points)
    frequency = np.repeat([point.frequency for point, _ in thresholds], counts)
    rate_clause = ""
    if np.isfinite(frequency).any():
        rate_text = _frequency_range_text_in_hertz(view, frequency, points)
        rate_clause = f", where the arm begins to beat at {rate_text}"
    return [THRESHOLD_SENTENCES[kind].format(load=load_text, rate=rate_clause)]


def _frequency_range_text_in_hertz(view: ResultView, frequency: np.ndarray, points: np.ndarray) -> str:
    """Range of the frequencies in Hz as text. frequency: angular frequencies in rad/tau2, (n,). points: index
    of the point of each frequency, (n,)."""
    tau2 = _values_at_points(view.quantities["tau2"], points)
    return range_text_in_printing_unit(view, frequency / (2 * np.pi * tau2), HERTZ)


def _values_at_points(values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Values of a quantity at the points with the indices `points`. values: (all points,), or () for a
    quantity with the same value at all points."""
    return values[points] if values.ndim else values
