"""Hopf points in a figure against F: vertical lines, and square-root laws of the amplitudes near Hopf points,
y = a sqrt(|F - F**|/|F**|).

The coefficient a is fitted to the cycles in a file; nothing is solved. No law is fitted to amplitudes that do
not tend to zero at the Hopf point, such as the amplitudes of large cycles beyond a fold.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from .....arrays import Array
from ....located_thresholds import LocatedThreshold
from ....summary.number_texts import rounded_text
from ...style import TEX_SYMBOLS

MAX_FITTED_RELATIVE_HOPF_DISTANCE = 0.1
"""Largest |F - F**|/|F**| of a cycle to which a law is fitted. At larger distances higher-order terms
matter."""
MAX_RELATIVE_LAW_DEVIATION = 0.2
"""A law is drawn over the range in which it differs from the amplitudes by at most this relative amount."""
COEFFICIENT_ERROR_FACTOR = 2.0
"""The error estimate of a coefficient is this factor times the change of the coefficient when one more cycle
is fitted."""
MIN_FITTED_DISTANCE_IN_HOPF_ERRORS = 100
"""Only cycles whose distance from F** exceeds this multiple of the error of F** are fitted. The distance of
such cycles is known to one percent."""


@dataclass(frozen=True, slots=True)
class SquareRootLaw:
    """Square-root law y = a sqrt(|F - F**|/|F**|) on one side of a Hopf point F**."""

    hopf_force: float
    """Force F** of the Hopf point, in k3/L^2."""
    coefficient: float
    """Coefficient a of the law y = a sqrt(|F - F**|/|F**|), in L."""
    is_above: bool
    """Whether the law holds at F > F**; otherwise at F < F**."""
    end_force: float
    """Force F farthest from F** up to which the amplitudes follow the law, see MAX_RELATIVE_LAW_DEVIATION."""
    coefficient_error: float
    """Error estimate of a, in L: COEFFICIENT_ERROR_FACTOR times the change of a when a third cycle is fitted;
    if there are only two cycles, times the change of a by the extrapolation to F**."""

    def curve(self, point_count: int = 100) -> tuple[Array, Array]:
        """Returns (F, amplitude) on the law from F** to `end_force`, (points,) each, dense near F**."""
        step = np.linspace(0, 1, point_count, dtype=np.float64) ** 2
        F = self.hopf_force + (self.end_force - self.hopf_force) * step
        return F, self.coefficient * np.sqrt(np.abs(F - self.hopf_force) / abs(self.hopf_force))


def square_root_laws(F: Array, amplitude: Array, points: Sequence[LocatedThreshold]) -> list[SquareRootLaw]:
    """Square-root laws that the amplitudes follow, at most one on each side of each of the Hopf points
    `points`.

    F, amplitude: force and amplitude of n cycles, (n,) each, in any order; an amplitude is NaN or 0 if there
    is no cycle.
    """
    laws = (_law_on_side(F, amplitude, point, side) for point in points for side in (1, -1) if point.position)
    return [law for law in laws if law]


def _law_on_side(F: Array, amplitude: Array, point: LocatedThreshold, side: int) -> SquareRootLaw | None:
    """Law above (side 1) or below (side -1) a Hopf point; None if the amplitudes do not follow a law. To
    leading order amplitude^2/distance is linear in the distance from the Hopf point. The value of this ratio
    at distance 0 is extrapolated from the two nearest cycles. F, amplitude: force and amplitude of n cycles,
    (n,) each, in any order; an amplitude is NaN or 0 if there is no cycle."""
    distance = side * (F - point.position) / abs(point.position)
    # If two cycles exist at one F, only the smaller cycle can shrink to zero at the Hopf point.
    order = np.lexsort((np.where(amplitude > 0, amplitude, np.inf), distance))
    distance, indices = np.unique(distance[order], return_index=True)
    amplitudes = amplitude[order][indices]
    is_certain = distance > MIN_FITTED_DISTANCE_IN_HOPF_ERRORS * point.position_error / abs(point.position)
    distance = distance[is_certain]
    amplitudes = amplitudes[is_certain]
    zero_indices = np.flatnonzero(~(amplitudes > 0))  # another branch begins behind a gap
    distance = distance[: zero_indices[0] if zero_indices.size else None]
    amplitudes = amplitudes[: zero_indices[0] if zero_indices.size else None]
    if len(amplitudes) < 2 or distance[1] > MAX_FITTED_RELATIVE_HOPF_DISTANCE:
        return None
    square_over_distance = amplitudes[:2] ** 2 / distance[:2]
    coefficient_square = square_over_distance[0] - distance[0] * (
        square_over_distance[1] - square_over_distance[0]
    ) / (distance[1] - distance[0])
    if coefficient_square <= 0:
        return None
    is_on_law = np.abs(np.sqrt(coefficient_square * distance) / amplitudes - 1) <= MAX_RELATIVE_LAW_DEVIATION
    if not is_on_law[:2].all():
        return None
    law_end = len(amplitudes) if is_on_law.all() else int(np.argmin(is_on_law))
    law_end_position = point.position + side * abs(point.position) * float(distance[law_end - 1])
    three_quotients = amplitudes[:3] ** 2 / distance[:3]
    extrapolated_square = (
        _parabola_at_zero(distance[:3], three_quotients)
        if len(three_quotients) > 2 and distance[2] <= MAX_FITTED_RELATIVE_HOPF_DISTANCE
        else square_over_distance[0]
    )
    error = COEFFICIENT_ERROR_FACTOR * abs(sqrt(max(extrapolated_square, 0.0)) - sqrt(coefficient_square))
    return SquareRootLaw(point.position, sqrt(coefficient_square), side > 0, law_end_position, error)


def _parabola_at_zero(x: Array, values: Array) -> float:
    """Value at x = 0 of the parabola through three points (x, values), (3,) each."""
    a, b, c = x
    weights = [b * c / ((a - b) * (a - c)), a * c / ((b - a) * (b - c)), a * b / ((c - a) * (c - b))]
    return float(np.dot(weights, values))


HOPF_SYMBOL = rf"{TEX_SYMBOLS['F']}_{{**}}"
"""Symbol F** in TeX, without dollar signs."""
HOPF_LEGEND_ENTRIES = {"hopf": f"${HOPF_SYMBOL}$", "restabilization": "restabilization"}
"""Legend entry of a Hopf point by kind: as F grows, the straight rod becomes unstable, or stable again."""
HOPF_DIGITS = 6
"""Number of significant digits of a Hopf point in a legend."""
HOPF_LINE_LOOK: dict[str, Any] = {"ls": ":", "lw": 1.1}
"""Matplotlib style of a vertical line at a Hopf point."""
SHARED_HOPF_POINT_COLOUR = "0.3"
"""Colour of a Hopf point that belongs to several lines."""
SQUARE_ROOT_LAW_LOOK: dict[str, Any] = {"color": "0.45", "lw": 1.0, "ls": (0, (5, 2.5))}
"""Matplotlib style of a square-root law."""
COEFFICIENT_DIGITS = 3
"""Largest number of significant digits of a coefficient in a legend."""
MAX_LEGEND_COEFFICIENTS = 3
"""A legend entry lists up to this number of coefficients; for more coefficients the range is printed."""


def mark_hopf_points(panels: Sequence[Axes], marks: Sequence[tuple[LocatedThreshold, str]]) -> None:
    """Draws a dotted vertical line at each Hopf point. marks: (Hopf point, colour).

    A Hopf point that belongs to several lines is drawn once, in grey. The legend gives the position of a Hopf
    point that is the only Hopf point of its kind.
    """
    for kind, word in HOPF_LEGEND_ENTRIES.items():
        colours_of_points: dict[LocatedThreshold, set[str]] = {}
        for point, colour in marks:
            if point.kind == kind:
                known = (known for known in colours_of_points if known.equals_within_errors(point))
                colours_of_points.setdefault(next(known, point), set()).add(colour)
        label = None
        if len(colours_of_points) == 1:
            (point,) = colours_of_points
            prefix = f"{word} = " if kind == "hopf" else rf"{word} at $\tilde F$ = "
            label = f"{prefix}{point.position:.{HOPF_DIGITS}g}"
        elif colours_of_points:
            panels[0].plot([], [], color=SHARED_HOPF_POINT_COLOUR, label=word, **HOPF_LINE_LOOK)
        for point, colours in colours_of_points.items():
            colour = colours.pop() if len(colours) == 1 else SHARED_HOPF_POINT_COLOUR
            for axes in panels:
                axes.axvline(point.position, color=colour, zorder=0.5, label=label, **HOPF_LINE_LOOK)


def draw_square_root_laws(axes: Axes, laws: Sequence[SquareRootLaw], unit: str = "") -> None:
    """Draws square-root laws as dashed curves, with formula and coefficients in the legend. unit: unit of the
    amplitude; empty for amplitudes in L."""
    for is_above, difference in ((True, rf"\tilde F - {HOPF_SYMBOL}"), (False, rf"{HOPF_SYMBOL} - \tilde F")):
        chosen_laws = [law for law in laws if law.is_above == is_above]
        coefficients = f"$a$ = {_coefficients_text(chosen_laws)} {unit}".rstrip()
        label = rf"$a\sqrt{{({difference})/{HOPF_SYMBOL}}}$, {coefficients}"
        for law in chosen_laws:
            axes.plot(*law.curve(), zorder=1.5, label=label, **SQUARE_ROOT_LAW_LOOK)


def _coefficients_text(laws: Sequence[SquareRootLaw]) -> str:
    """Distinct coefficients of the laws as text; the range if there are more than MAX_LEGEND_COEFFICIENTS."""
    sorted_laws = sorted(laws, key=lambda law: law.coefficient)
    coefficient_texts = {
        law: rounded_text(law.coefficient, law.coefficient_error, COEFFICIENT_DIGITS) for law in laws
    }
    texts = list(dict.fromkeys(coefficient_texts.values()))
    if len(texts) > MAX_LEGEND_COEFFICIENTS:
        return f"{coefficient_texts[sorted_laws[0]]} to {coefficient_texts[sorted_laws[-1]]}"
    return ", ".join(texts)
