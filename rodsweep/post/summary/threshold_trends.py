"""How the first thresholds of a grid change with each parameter, in `rodsweep show`."""

from enum import IntEnum
from itertools import product

import numpy as np

from ...results.file.view import ResultView
from ...wording import count_of_total
from .selection import in_brackets

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
    known_forces = forces[np.isfinite(forces)]
    steps = np.diff(known_forces)
    if not steps.size:
        return Trend.unknown
    rounding = TREND_ROUNDING * np.abs(known_forces).max()
    has_rise = bool((steps > rounding).any())
    has_fall = bool((steps < -rounding).any())
    if has_rise and has_fall:
        return Trend.rises_and_falls
    return Trend.rises if has_rise else Trend.falls if has_fall else Trend.constant


def monotonicity_lines(view: ResultView) -> list[str]:
    """Lines on whether the first thresholds rise or fall with each parameter that has more than two values
    (for gamma3: with 1/gamma3); empty for a list of points."""
    lines = []
    varied_names = (
        [name for name, values in view.parameter_values.items() if len(values) > 2] if view.is_grid else []
    )
    for name, force in product(varied_names, ("F_onset", "F_hopf")):
        forces = np.moveaxis(view.variables[force], list(view.parameter_values).index(name), -1)
        label = name
        if name == "gamma3":
            forces = forces[..., ::-1]
            label = "1/gamma3"
        trend_of_lines = np.apply_along_axis(_trend, -1, forces)
        is_known = trend_of_lines != Trend.unknown
        if not is_known.any():
            continue
        rising_count = int((trend_of_lines == Trend.rises).sum())
        text = f"{force} rises with {label} on {count_of_total(rising_count, is_known.sum(), 'line')} of rods"
        for trend, phrase in ((Trend.falls, "falls"), (Trend.constant, "is constant")):
            if number := int((trend_of_lines == trend).sum()):
                text += f", {phrase} on {number}"
        is_mixed = trend_of_lines == Trend.rises_and_falls
        other_names = [axis_name for axis_name in view.parameter_values if axis_name != name]
        positions = []
        for axis, axis_indices in zip(other_names, np.argwhere(is_mixed).T, strict=True):
            if len(view.parameter_values[axis]) > 1 and axis_indices.size:
                values = view.parameter_values[axis][axis_indices]
                low = values.min()
                high = values.max()
                positions.append(f"{axis} = {low:.6g}" + (f" to {high:.6g}" if high > low else ""))
        if is_mixed.any():
            text += f", is not monotone on {int(is_mixed.sum())}{in_brackets(', '.join(positions))}"
        lines.append(text)
    return lines
