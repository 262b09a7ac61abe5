"""How the first thresholds of a grid change with each parameter, in `rodsweep show`."""

from enum import IntEnum
from itertools import product

import numpy as np

from ...results.file.view import View
from ...wording import count_of_total
from .summary_lines import in_brackets

TREND_ROUNDING = 1e-12
"""Steps between neighbouring thresholds of at most this relative size are rounding errors."""


class Trend(IntEnum):
    """Change of a threshold along a line of rods; `unknown` with fewer than two known values."""

    unknown = 0
    rises = 1
    falls = 2
    constant = 3
    rises_and_falls = 4


def _trend(forces: np.ndarray) -> Trend:
    """Trend of thresholds along a line of rods, (n,), NaN where unknown; steps smaller than TREND_ROUNDING
    times the largest threshold count as 0. The trend is unknown if fewer than two thresholds are known."""
    known = forces[np.isfinite(forces)]
    steps = np.diff(known)
    if not steps.size:
        return Trend.unknown
    rounding = TREND_ROUNDING * np.abs(known).max()
    rises = bool((steps > rounding).any())
    falls = bool((steps < -rounding).any())
    if rises and falls:
        return Trend.rises_and_falls
    return Trend.rises if rises else Trend.falls if falls else Trend.constant


def monotony_lines(view: View) -> list[str]:
    """Lines on whether the first thresholds rise or fall with each parameter that has more than two values
    (for gamma3: with 1/gamma3); empty for a list of points."""
    lines = []
    long = [name for name, values in view.parameter_values.items() if len(values) > 2] if view.is_grid else []
    for name, force in product(long, ("F_onset", "F_hopf")):
        along = np.moveaxis(view.variables[force], list(view.parameter_values).index(name), -1)
        label = name
        if name == "gamma3":
            along = along[..., ::-1]
            label = "1/gamma3"
        trends = np.apply_along_axis(_trend, -1, along)
        known = trends != Trend.unknown
        if not known.any():
            continue
        rising = int((trends == Trend.rises).sum())
        text = f"{force} rises with {label} on {count_of_total(rising, known.sum(), 'line')} of rods"
        for trend, verb in ((Trend.falls, "falls"), (Trend.constant, "is constant")):
            if number := int((trends == trend).sum()):
                text += f", {verb} on {number}"
        mixed = trends == Trend.rises_and_falls
        others = [n for n in view.parameter_values if n != name]
        where = []
        for other, places in zip(others, np.argwhere(mixed).T, strict=True):
            if len(view.parameter_values[other]) > 1 and places.size:
                values = view.parameter_values[other][places]
                low = values.min()
                high = values.max()
                where.append(f"{other} = {low:.6g}" + (f" to {high:.6g}" if high > low else ""))
        if mixed.any():
            text += f", is not monotone on {int(mixed.sum())}{in_brackets(', '.join(where))}"
        lines.append(text)
    return lines
