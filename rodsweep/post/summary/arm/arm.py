"""What `rodsweep show` says of an arm in its own units: quantities, the numbers of every task, thresholds.

Loads and lengths are told in the unit that was typed, frequencies in Hz, all powers of an answer in one unit.
"""

import json
import textwrap
from collections.abc import Mapping, Sequence

import numpy as np

from ....model.arm.drag import DRAGS
from ....model.arm.quantities import ALL_QUANTITIES, ARM_UNITS, RELATIVE, SCALE_OF, UNITS
from ....model.units import compact, written_in
from ....results.file.view import View
from ....results.layouts import LAYOUTS
from ....results.layouts.arm import HERTZ, si_variables_of
from ....results.layouts.thresholds import CROSSING_KINDS, CROSSING_MEANINGS
from ...hopf_points import Located
from ...tables.rows import quantities_at_points
from ..errors import errors_of, is_known
from ..ranges import rounded, span

WIDTH = 80
"""Columns of a line in SI units."""
ITEMS_FEW = 4
"""Values of a table of one rod that are told one by one."""
TYPED_AS = {"m": ("length",), "Pa": ("pressure", "young"), "N": ("force",)}
"""The quantities in whose unit others of their kind are told, where they were typed in one."""
PREFIXED = ("J", "W")
"""Units that are told with a prefix, as mW."""
SHORT_TIME = 0.1
"""Seconds below which times are told in ms."""
DIGITS = 3
"""Digits of a quantity that says where something is."""
WORDS = {"young": "Young's modulus", "poisson": "Poisson's ratio"}
"""What quantities are called, where that is not their name."""
OF_THRESHOLDS = {
    "hopf": "flutters at {load}{rate}",
    "restabilization": "is straight again from {load} on",
    "onset": "a disturbance swings as it dies away from {load} on",
}
"""What is said of the loads at which the straight arm changes, by their kind."""


def word(name: str) -> str:
    """A quantity in words."""
    return WORDS.get(name, name.replace("_", " "))


def own_unit(view: View, si: str, largest: float) -> tuple[float, str]:
    """(factor, unit) in which numbers in an SI unit up to `largest` are told."""
    typed = next((view.typed[name] for name in TYPED_AS.get(si, ()) if name in view.typed), si)
    if typed != si:
        return written_in(1.0, typed, si), typed
    if si == "s" and largest < SHORT_TIME or si in PREFIXED:
        return compact(largest, si)
    return 1.0, si


def in_own_unit(view: View, values: np.ndarray, si: str) -> str:
    """The range of numbers in an SI unit, of any shape, in the arm's own."""
    factor, unit = own_unit(view, si, _largest(values))
    return f"{span(factor * values)} {unit}"


def _largest(values: np.ndarray) -> float:
    """The largest modulus of the finite values, 0 without one."""
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if finite.size else 0.0


def given_columns(view: View) -> dict[str, np.ndarray]:
    """The quantities of an arm that differ among the points of a file, at every point, each (points,)."""
    columns = quantities_at_points(view)
    given = {name: column for name, column in columns.items() if name not in ARM_UNITS}
    return {name: column for name, column in given.items() if len(np.unique(column[~np.isnan(column)])) > 1}


def region_of_arms(view: View, there: np.ndarray) -> str:
    """The ranges of the quantities that differ among points, a mask of their shape; empty for one arm."""
    told = (quantity_range(view, name, column, there.ravel()) for name, column in given_columns(view).items())
    return ", ".join(filter(None, told))


def quantity_range(view: View, name: str, column: np.ndarray, chosen: np.ndarray) -> str:
    """The range of a quantity, (points,), over chosen points, a mask; empty where they have all drags."""
    values = column[chosen]
    if name == "drag":
        names = [DRAGS[int(place)] for place in np.unique(values)]
        return "" if len(names) == len(np.unique(column)) else f"drag {' and '.join(names)}".replace("_", " ")
    unit, si = _unit(view, name), ALL_QUANTITIES[name].unit
    factor = written_in(1.0, unit, si) if unit else 1.0
    ends = [float(f"{factor * end:.{DIGITS}g}") for end in (values.min(), values.max())]
    extent = " to ".join(f"{end:.{DIGITS + 1}g}" for end in sorted(set(ends)))
    if name in RELATIVE:
        return f"{extent} of flutter"
    return f"{word(name)} {extent} {unit}".rstrip()


def _unit(view: View, name: str) -> str:
    """The unit of a quantity as it is told; empty of a ratio."""
    si = ALL_QUANTITIES[name].unit
    return "" if si == "1" else view.typed.get(name, own_unit(view, si, 1.0)[1])


def arm_lines(view: View, done: np.ndarray) -> list[str]:
    """The ranges of what is stored in SI units, over the points that are `done`, a mask of their shape."""
    if not view.quantities:
        return []
    config = json.loads(view.attributes["config_resolved"])
    twins = si_variables_of(LAYOUTS[view.task](config), config)
    shown = {
        own: v
        for own, v in twins.items()
        if "error" not in v.name and (not v.extra or (done.size == 1 and v.extra != ("crossing",)))
    }
    known = {own: is_known(view.variables, own)[done] for own in shown}
    values = {own: np.where(known[own], view.variables[v.name][done], np.nan) for own, v in shown.items()}
    values = {own: column for own, column in values.items() if np.isfinite(column).any()}
    largest: dict[str, float] = {}
    for own, column in values.items():
        largest[shown[own].units] = max(largest.get(shown[own].units, 0.0), _largest(column))
    told = []
    for own, column in values.items():
        variable = shown[own]
        factor, unit = own_unit(view, variable.units, largest[variable.units])
        errors = errors_in_si(view.variables, own, variable.name)[done]
        numbers = _numbers(factor * column, factor * errors)
        told.append(f"{variable.name.removesuffix('_si').removesuffix('_hz')} = {numbers} {unit}")
    return (
        ["in the arm's units:", *wrapped("; ".join(item.replace(" ", "\xa0") for item in told))]
        if told
        else []
    )


def _numbers(values: np.ndarray, errors: np.ndarray) -> str:
    """Values as words: one by one where they are a few of a table, else their range.

    errors: absolute ones, of the same shape, which leave out digits that are not known.
    """
    there = np.isfinite(values)
    finite, known = values[there], errors[there]
    if values.ndim > 1 and 1 < finite.size <= ITEMS_FEW:
        return ", ".join(map(rounded, finite, np.nan_to_num(known)))
    return span(finite, known)


def wrapped(text: str) -> list[str]:
    """A text in lines of at most WIDTH columns, indented, that do not break at its hard spaces."""
    lines = textwrap.wrap(
        text,
        WIDTH,
        initial_indent="  ",
        subsequent_indent="  ",
        break_long_words=False,
        break_on_hyphens=False,
    )
    return [line.replace("\xa0", " ") for line in lines]


def errors_in_si(v: Mapping[str, np.ndarray], own: str, twin: str) -> np.ndarray:
    """The absolute errors of what stands under the name `twin` in an SI unit too, in it, of its shape."""
    known = np.isfinite(v[own]) & (v[own] != 0)
    scale = np.divide(v[twin], v[own], out=np.zeros_like(v[twin]), where=known)
    return np.asarray(np.abs(scale) * errors_of(v, own))


def load_of(view: View) -> str:
    """What a follower force is told in."""
    return "force" if "force" in view.quantities else "pressure"


def loads_at(view: View, F: np.ndarray, points: np.ndarray) -> str:
    """Follower forces F, (n,), at points of a file with an arm, (n,) indices, as its load in its own unit."""
    load = load_of(view)
    return in_own_unit(view, F * _at(view.quantities[SCALE_OF[load]], points), UNITS[load][0])


def crossings_of_arm(view: View) -> list[str]:
    """Every crossing of the one rod of a file as load and frequency; none without arm."""
    if not view.quantities:
        return []
    v, rod = view.variables, np.zeros(1, int)
    kinds, forces, frequencies = (v[f"crossing_{name}"].ravel() for name in ("kind", "F", "frequency"))
    lines = []
    for i in np.flatnonzero(kinds > 0):
        kind = CROSSING_KINDS[int(kinds[i])]
        text = f"{kind} at {loads_at(view, forces[i : i + 1], rod)}: {CROSSING_MEANINGS[kind]}"
        if frequencies[i]:
            text += f"; frequency {_in_hertz(view, frequencies[i : i + 1], rod)}"
        lines.append(text)
    return lines


def thresholds_of_arm(view: View, kind: str, found: Sequence[tuple[Located, np.ndarray]]) -> list[str]:
    """Thresholds of a kind with the points of their lines, (points,), in own units; none without arm."""
    if not view.quantities or not found:
        return []
    points = np.concatenate([points for _, points in found])
    each = [len(points) for _, points in found]
    load = loads_at(view, np.repeat([place.position for place, _ in found], each), points)
    frequency = np.repeat([place.frequency for place, _ in found], each)
    rate = ""
    if np.isfinite(frequency).any():
        rate = f", where it begins to beat at {_in_hertz(view, frequency, points)}"
    return [OF_THRESHOLDS[kind].format(load=load, rate=rate)]


def _in_hertz(view: View, frequency: np.ndarray, points: np.ndarray) -> str:
    """Angular frequencies in rad/tau2, (n,), at points of a file with an arm, (n,) indices, in Hz."""
    return in_own_unit(view, frequency / (2 * np.pi * _at(view.quantities["tau2"], points)), HERTZ)


def _at(values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """A quantity at points of a file, shape () where all share it."""
    return values[points] if values.ndim else values
