"""An arm in its own units in `rodsweep show`: quantities, results of every task, and thresholds.

Loads and lengths are in the units typed by the user, frequencies in Hz, and all powers of an answer in a
single unit.
"""

import textwrap
from collections.abc import Mapping, Sequence

import numpy as np

from ....model.arm.drag import DRAGS
from ....model.arm.quantities import ALL_QUANTITIES, ARM_UNITS, RELATIVE, SCALE_OF, UNITS
from ....model.parameters import OPTIONAL_PARAMETERS
from ....model.units import compact, written_in
from ....results.file.view import View
from ....results.layouts import LAYOUTS
from ....results.layouts.arm import HERTZ, si_variables_of
from ....results.layouts.thresholds import CROSSING_KINDS, CROSSING_MEANINGS
from ...hopf_points import LocatedChange
from ...tables.rows import quantities_at_points
from ..errors import errors_of, is_known
from ..ranges import RANGE_DIGITS, rounded, span

WIDTH = 80
"""Width of lines in SI units, in characters."""
FEW_ITEMS = 4
"""Largest number of values of a table listed individually for a single rod."""
TYPED_AS = {"m": ("length",), "Pa": ("pressure", "young"), "N": ("force",)}
"""Quantities whose typed unit is used for all numbers with an SI unit; the first typed quantity decides."""
PREFIXED = ("J", "W")
"""Units with a prefix, such as mW."""
SHORT_TIME = 0.1
"""Time, in s, below which times are given in ms or smaller units."""
AXIS_DIGITS = 3
"""Number of digits of a quantity that identifies a point."""
WORDS = {"young": "Young's modulus", "poisson": "Poisson's ratio"}
"""Words for quantities with an unclear name."""
THRESHOLD_SENTENCES = {
    "hopf": "flutters at {load}{rate}",
    "restabilization": "is straight again from {load} on",
    "onset": "a disturbance swings as it dies away from {load} on",
}
"""Sentences on the loads at which the straight arm changes, by kind of change."""


def word(name: str) -> str:
    """Name of a quantity in words."""
    return WORDS.get(name, name.replace("_", " "))


def own_unit(view: View, si: str, largest: float) -> tuple[float, str]:
    """(factor, unit) for numbers in an SI unit that are at most `largest`."""
    typed = next((view.typed[name] for name in TYPED_AS.get(si, ()) if name in view.typed), si)
    if typed != si:
        return written_in(1.0, typed, si), typed
    if si == "s" and largest < SHORT_TIME or si in PREFIXED:
        return compact(largest, si)
    return 1.0, si


def in_own_unit(
    view: View,
    values: np.ndarray,
    si: str,
    errors: np.ndarray | float = 0.0,
    most: int = RANGE_DIGITS,
) -> str:
    """Range of numbers in an SI unit, of any shape, in the arm's own unit.

    errors: absolute errors of the same shape, or 0; they limit the number of digits, at most `most`.
    """
    factor, unit = own_unit(view, si, _largest(values))
    return f"{span(factor * values, np.broadcast_to(factor * errors, values.shape), most)} {unit}"


def _largest(values: np.ndarray) -> float:
    """Largest modulus of the finite values; 0 without a finite value."""
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def given_columns(view: View) -> dict[str, np.ndarray]:
    """Quantities of an arm that vary among the points of a file, at every point, each (points,)."""
    given = {name: column for name, column in quantities_at_points(view).items() if name not in ARM_UNITS}
    return {name: column for name, column in given.items() if len(np.unique(column[~np.isnan(column)])) > 1}


def region_of_arms(view: View, mask: np.ndarray) -> str:
    """Ranges of varied quantities and tapers over points, a mask of their shape; empty for a single arm."""
    chosen = mask.ravel()
    ranges = [quantity_range(view, name, column, chosen) for name, column in given_columns(view).items()]
    for name in OPTIONAL_PARAMETERS:
        column = view.listed.point_columns.get(name, np.ones(1)).ravel()
        if len(np.unique(column)) > 1:
            ends = sorted({float(column[chosen].min()), float(column[chosen].max())})
            ranges.append(f"{name} {' to '.join(f'{end:.{AXIS_DIGITS + 1}g}' for end in ends)}")
    return ", ".join(filter(None, ranges))


def quantity_range(view: View, name: str, column: np.ndarray, chosen: np.ndarray) -> str:
    """Range of a quantity, (points,), over chosen points, a mask; empty if they have all drags."""
    values = column[chosen]
    if name == "drag":
        names = [DRAGS[int(place)] for place in np.unique(values)]
        return "" if len(names) == len(np.unique(column)) else f"drag {' and '.join(names)}".replace("_", " ")
    unit = _unit(view, name)
    factor = written_in(1.0, unit, ALL_QUANTITIES[name].unit) if unit else 1.0
    ends = [float(f"{factor * end:.{AXIS_DIGITS}g}") for end in (values.min(), values.max())]
    extent = " to ".join(f"{end:.{AXIS_DIGITS + 1}g}" for end in sorted(set(ends)))
    if name in RELATIVE:
        return f"{extent} of flutter"
    return f"{word(name)} {extent} {unit}".rstrip()


def _unit(view: View, name: str) -> str:
    """Unit of a quantity in the summary; empty for a ratio."""
    si = ALL_QUANTITIES[name].unit
    return "" if si == "1" else view.typed.get(name, own_unit(view, si, 1.0)[1])


def arm_lines(view: View, done: np.ndarray) -> list[str]:
    """Ranges of the variables stored in SI units, over the points in `done`, a mask of the points' shape."""
    if not view.quantities:
        return []
    si_variables = si_variables_of(LAYOUTS[view.task](view.config), view.config)
    shown = {
        own: v
        for own, v in si_variables.items()
        if "error" not in v.name and (not v.extra or (done.size == 1 and v.extra != ("crossing",)))
    }
    known = {own: is_known(view.variables, own)[done] for own in shown}
    values = {own: np.where(known[own], view.variables[v.name][done], np.nan) for own, v in shown.items()}
    values = {own: column for own, column in values.items() if np.isfinite(column).any()}
    largest: dict[str, float] = {}
    for own, column in values.items():
        largest[shown[own].units] = max(largest.get(shown[own].units, 0.0), _largest(column))
    items = []
    for own, column in values.items():
        variable = shown[own]
        factor, unit = own_unit(view, variable.units, largest[variable.units])
        errors = errors_in_si(view.variables, own, variable.name)[done]
        numbers = _numbers(factor * column, factor * errors)
        items.append(f"{variable.name.removesuffix('_si').removesuffix('_hz')} = {numbers} {unit}")
    if not items:
        return []
    return ["in the arm's units:", *wrapped("; ".join(item.replace(" ", "\xa0") for item in items))]


def _numbers(values: np.ndarray, errors: np.ndarray) -> str:
    """Values as text: a few values of a table individually, more values as a range.

    errors: absolute errors, of the shape of the values, which limit the number of digits.
    """
    is_finite = np.isfinite(values)
    finite = values[is_finite]
    known = errors[is_finite]
    if values.ndim > 1 and 1 < finite.size <= FEW_ITEMS:
        return ", ".join(map(rounded, finite, np.nan_to_num(known)))
    return span(finite, known)


def wrapped(text: str) -> list[str]:
    """A text in indented lines of at most WIDTH characters, which do not break at no-break spaces."""
    lines = textwrap.wrap(text, WIDTH - 2, break_long_words=False, break_on_hyphens=False)
    return ["  " + line.replace("\xa0", " ") for line in lines]


def errors_in_si(v: Mapping[str, np.ndarray], own: str, si_name: str) -> np.ndarray:
    """Absolute errors of the SI variable `si_name` of the variable `own`, in SI units and of its shape."""
    known = np.isfinite(v[own]) & (v[own] != 0)
    scale = np.divide(v[si_name], v[own], out=np.zeros_like(v[si_name]), where=known)
    return np.asarray(np.abs(scale) * errors_of(v, own))


def load_of(view: View) -> str:
    """Kind of load that a follower force corresponds to: force or pressure."""
    return "force" if "force" in view.quantities else "pressure"


def loads_at(view: View, F: np.ndarray, points: np.ndarray) -> str:
    """Follower forces F, (n,), at points of an arm's file, (n,) indices, as loads in their own unit."""
    load = load_of(view)
    return in_own_unit(view, F * _at(view.quantities[SCALE_OF[load]], points), UNITS[load][0])


def crossings_of_arm(view: View) -> list[str]:
    """Line for every crossing of the single rod of a file, with load and frequency; empty without an arm."""
    if not view.quantities:
        return []
    v = view.variables
    rod = np.zeros(1, int)
    kinds, forces, frequencies = (v[f"crossing_{name}"].ravel() for name in ("kind", "F", "frequency"))
    lines = []
    for i in np.flatnonzero(kinds > 0):
        kind = CROSSING_KINDS[int(kinds[i])]
        text = f"{kind} at {loads_at(view, forces[i : i + 1], rod)}: {CROSSING_MEANINGS[kind]}"
        if frequencies[i]:
            text += f"; frequency {_in_hertz(view, frequencies[i : i + 1], rod)}"
        lines.append(text)
    return lines


def thresholds_of_arm(view: View, kind: str, found: Sequence[tuple[LocatedChange, np.ndarray]]) -> list[str]:
    """Sentence on an arm's thresholds in SI units, as a list; empty without an arm or a threshold.

    found: thresholds of a kind, each with the indices of its points, (points,).
    """
    if not view.quantities or not found:
        return []
    points = np.concatenate([points for _, points in found])
    each = [len(points) for _, points in found]
    load = loads_at(view, np.repeat([place.position for place, _ in found], each), points)
    frequency = np.repeat([place.frequency for place, _ in found], each)
    rate = ""
    if np.isfinite(frequency).any():
        rate = f", where it begins to beat at {_in_hertz(view, frequency, points)}"
    return [THRESHOLD_SENTENCES[kind].format(load=load, rate=rate)]


def _in_hertz(view: View, frequency: np.ndarray, points: np.ndarray) -> str:
    """Angular frequencies in rad/tau2, (n,), at points of an arm's file, (n,) indices, as text in Hz."""
    return in_own_unit(view, frequency / (2 * np.pi * _at(view.quantities["tau2"], points)), HERTZ)


def _at(values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Quantity at points of a file; a quantity of shape () holds at all points."""
    return values[points] if values.ndim else values
