"""How the first thresholds of a grid change with each parameter, in `rodsweep show`."""

from itertools import product

import numpy as np

from ...results.file.view import ResultView
from ...wording import count_of_total
from .number_texts import axis_values_text
from .selection import in_brackets

TREND_ROUNDING = 1e-12
"""Differences between neighbouring thresholds on a line of rods count as rounding errors if their ratio to
the largest threshold of the line is at most this number."""
UNKNOWN, RISES, FALLS, IS_CONSTANT, IS_NOT_MONOTONE = range(-1, 4)
"""Changes of a threshold along a line of rods; unknown with fewer than two known values."""


def _trend(forces: np.ndarray) -> int:
    """How the thresholds `forces`, (n,), change along a line of rods: UNKNOWN, RISES, FALLS, IS_CONSTANT or
    IS_NOT_MONOTONE. NaN: unknown threshold. Steps of at most TREND_ROUNDING times the largest threshold count
    as 0."""
    known_forces = forces[np.isfinite(forces)]
    steps = np.diff(known_forces)
    if not steps.size:
        return UNKNOWN
    rounding = TREND_ROUNDING * np.abs(known_forces).max()
    rises = bool((steps > rounding).any())
    falls = bool((steps < -rounding).any())
    if rises and falls:
        return IS_NOT_MONOTONE
    return RISES if rises else FALLS if falls else IS_CONSTANT


def monotonicity_lines(view: ResultView) -> list[str]:
    """Lines on whether the first thresholds rise or fall with each parameter that has more than two values
    (for gamma3: with 1/gamma3); empty for a list of points."""
    lines = []
    axes = view.parameter_values if view.is_grid else {}
    varied_names = [name for name, values in axes.items() if len(values) > 2]
    for name, force in product(varied_names, ("F_onset", "F_hopf")):
        forces = np.moveaxis(view.variables[force], list(axes).index(name), -1)
        trends = np.apply_along_axis(_trend, -1, forces[..., ::-1] if name == "gamma3" else forces)
        rising, falling, constant, mixed = ((trends == trend).sum() for trend in range(4))
        if (trends == UNKNOWN).all():
            continue
        lines_text = count_of_total(rising, (trends != UNKNOWN).sum(), "line")
        text = f"{force} rises with {'1/gamma3' if name == 'gamma3' else name} on {lines_text} of rods"
        text += f", falls on {falling}" if falling else ""
        text += f", is constant on {constant}" if constant else ""
        if mixed:
            other_axes = [axis for axis in axes if axis != name]
            indices = zip(other_axes, np.nonzero(trends == IS_NOT_MONOTONE), strict=True)
            places = [
                f"{axis} = {axis_values_text(axes[axis][axis_indices])}"
                for axis, axis_indices in indices
                if len(axes[axis]) > 1
            ]
            text += f", is not monotone on {mixed}{in_brackets(', '.join(places))}"
        lines.append(text)
    return lines
