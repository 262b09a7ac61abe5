"""What `rodsweep show` says of an arm: the numbers of every task that are told in SI units, and thresholds.

Forces are told as the load of the arm is given, as a pressure or a force, and frequencies in Hz.
"""

import json
import textwrap
from collections.abc import Mapping, Sequence

import numpy as np

from ...model.units import compact
from ...results.file.view import View
from ...results.layouts import LAYOUTS
from ...results.layouts.arm import FORCES, HERTZ, twins_of
from ..hopf_points import Located
from .errors import errors_of
from .ranges import rounded, span

WIDTH = 80
"""Columns of a line in SI units."""
ITEMS_FEW = 4
"""Values of a table of one rod that are told one by one."""
PREFIXED = ("Pa", "N", "s", "m", "J", "W", HERTZ)
"""Units that are told with a prefix, as kPa."""


def arm_lines(view: View, done: np.ndarray) -> list[str]:
    """The ranges of what is stored in SI units, over the points that are `done`, a mask of their shape."""
    if not view.quantities:
        return []
    config = json.loads(view.attributes["config_resolved"])
    v, told = view.variables, []
    for own, variable in twins_of(LAYOUTS[view.task](config), config).items():
        values = v[variable.name][done]
        name = variable.name.removesuffix("_si").removesuffix("_hz")
        told_here = variable.extra != ("crossing",) if done.size == 1 else not variable.extra
        if told_here and "error" not in name and np.isfinite(values).any():
            told.append(
                f"{name} = {in_unit(values, variable.units, errors_in_si(v, own, variable.name)[done])}"
            )
    return ["in SI units:", *wrapped("; ".join(item.replace(" ", "\xa0") for item in told))] if told else []


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


def in_unit(values: np.ndarray, unit: str, errors: np.ndarray | None = None) -> str:
    """Values in an SI unit, of any shape, as words: one by one where they are few, else their range.

    errors: absolute ones, of the same shape, which leave out digits that are not known.
    """
    there = np.isfinite(values)
    finite, known = values[there], np.zeros(int(there.sum())) if errors is None else errors[there]
    if unit in PREFIXED and finite.size:
        factor, unit = compact(float(np.abs(finite).max()), unit)
        finite, known = finite * factor, known * factor
    few = values.ndim > 1 and 1 < finite.size <= ITEMS_FEW
    each = ", ".join(map(rounded, finite, np.nan_to_num(known))) if few else span(finite, known)
    return f"{each} {unit}"


def loads_at(view: View, F: np.ndarray, points: np.ndarray) -> str:
    """Follower forces F, (n,), at points of a file with an arm, (n,) indices, as its load in SI units."""
    quantities = view.quantities
    unit, (scale,), _ = FORCES["force" if "force" in quantities else "pressure"]
    return in_unit(F * _at(quantities[scale], points), unit)


def crossing_line_in_si(view: View, i: int) -> list[str]:
    """The i-th crossing of the one rod of a file as load and frequency; none without arm."""
    if not view.quantities:
        return []
    F, frequency = (view.variables[f"crossing_{name}"].ravel()[i] for name in ("F", "frequency"))
    rod = np.zeros(1, int)
    text = loads_at(view, np.array([F]), rod)
    if frequency:
        text += f", frequency {_in_hertz(view, np.array([frequency]), rod)}"
    return [f"  in SI units: {text}"]


def threshold_lines_in_si(view: View, found: Sequence[tuple[Located, np.ndarray]]) -> list[str]:
    """Thresholds with the points of their lines, (points,), as load and frequency; none without arm."""
    if not view.quantities or not found:
        return []
    points = np.concatenate([points for _, points in found])
    each = [len(points) for _, points in found]
    text = loads_at(view, np.repeat([place.position for place, _ in found], each), points)
    frequency = np.repeat([getattr(place, "frequency", np.nan) for place, _ in found], each)
    if np.isfinite(frequency).any():
        text += f", frequency {_in_hertz(view, frequency, points)}"
    return [f"  in SI units: {text}"]


def _in_hertz(view: View, frequency: np.ndarray, points: np.ndarray) -> str:
    """Angular frequencies in rad/tau2, (n,), at points of a file with an arm, (n,) indices, in Hz."""
    return in_unit(frequency / (2 * np.pi * _at(view.quantities["tau2"], points)), HERTZ)


def _at(values: np.ndarray, points: np.ndarray) -> np.ndarray:
    """A quantity at points of a file, shape () where all share it."""
    return values[points] if values.ndim else values
