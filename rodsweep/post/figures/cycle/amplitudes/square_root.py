"""Square-root law of the amplitude near a Hopf point F**: y = a sqrt(|F - F**|/|F**|).

The coefficient a is fitted to the cycles in a file; nothing is solved. No law is fitted if the amplitudes do
not tend to zero at the Hopf point, such as those of large cycles beyond a fold.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from .....arrays import Array
from ....hopf_points import LocatedChange

MAX_FITTED_DISTANCE = 0.1
"""Largest |F - F**|/|F**| of a cycle to which a law is fitted. Farther away higher-order terms matter."""
MAX_LAW_DEVIATION = 0.2
"""Largest relative difference between the amplitudes and a law in the range in which the law is drawn."""
ERROR_SAFETY_FACTOR = 2.0
"""Factor from the change of a coefficient by one more cycle to its error estimate."""
MIN_ERRORS_AWAY = 100
"""Least distance of a fitted cycle from F**, in units of the error of F**; the distance is then known to one
percent."""


@dataclass(frozen=True, slots=True)
class SquareRootLaw:
    """Square-root law y = a sqrt(|F - F**|/|F**|) on one side of a Hopf point F**."""

    hopf: float
    """Force F** of the Hopf point, in k3/L^2."""
    coefficient: float
    """Coefficient a, in L."""
    above: bool
    """Whether the law holds at F > F**; otherwise at F < F**."""
    end: float
    """F farthest from F** at which the amplitude follows the law."""
    error: float
    """Error estimate of a, in L: ERROR_SAFETY_FACTOR times the change of a by a third cycle; with two cycles,
    times its change by extrapolation to F**."""

    def curve(self, points: int = 100) -> tuple[Array, Array]:
        """(F, amplitude) of the law from F** to `end`, (points,) each; dense near F**."""
        step = np.linspace(0, 1, points, dtype=np.float64) ** 2
        F = self.hopf + (self.end - self.hopf) * step
        return F, self.coefficient * np.sqrt(np.abs(F - self.hopf) / abs(self.hopf))


def square_root_laws(F: Array, amplitude: Array, points: Sequence[LocatedChange]) -> list[SquareRootLaw]:
    """Square-root laws that the amplitudes follow, at most one on each side of a Hopf point.

    F, amplitude: of the cycles, (n,), in any order; amplitude is NaN or 0 where there is no cycle. points:
    Hopf points.
    """
    laws = (_law(F, amplitude, point, side) for point in points for side in (1, -1) if point.position)
    return [law for law in laws if law]


def _law(F: Array, amplitude: Array, point: LocatedChange, side: int) -> SquareRootLaw | None:
    """Law above (side 1) or below (side -1) a Hopf point; None if the amplitudes do not follow it.

    To leading order amplitude^2/distance is linear in the distance from the Hopf point. The two nearest
    cycles give its value at distance 0.
    """
    distance = side * (F - point.position) / abs(point.position)
    # If two cycles exist at one F, only the smaller one can shrink to zero at the Hopf point.
    order = np.lexsort((np.where(amplitude > 0, amplitude, np.inf), distance))
    distance, first = np.unique(distance[order], return_index=True)
    size = amplitude[order][first]
    is_certain = distance > MIN_ERRORS_AWAY * point.error / abs(point.position)
    distance = distance[is_certain]
    size = size[is_certain]
    gap = np.flatnonzero(~(size > 0))  # another branch begins behind a gap
    distance = distance[: gap[0] if gap.size else None]
    size = size[: gap[0] if gap.size else None]
    if len(size) < 2 or distance[1] > MAX_FITTED_DISTANCE:
        return None
    q = size[:2] ** 2 / distance[:2]
    square = q[0] - distance[0] * (q[1] - q[0]) / (distance[1] - distance[0])
    if square <= 0:
        return None
    follows = np.abs(np.sqrt(square * distance) / size - 1) <= MAX_LAW_DEVIATION
    if not follows[:2].all():
        return None
    last = len(size) if follows.all() else int(np.argmin(follows))
    end = point.position + side * abs(point.position) * float(distance[last - 1])
    third = size[:3] ** 2 / distance[:3]
    better = _at_zero(distance[:3], third) if len(third) > 2 and distance[2] <= MAX_FITTED_DISTANCE else q[0]
    error = ERROR_SAFETY_FACTOR * abs(sqrt(max(better, 0.0)) - sqrt(square))
    return SquareRootLaw(point.position, sqrt(square), side > 0, end, error)


def _at_zero(x: Array, values: Array) -> float:
    """Value at x = 0 of the parabola through three points (x, values), (3,) each."""
    a, b, c = x
    weights = [b * c / ((a - b) * (a - c)), a * c / ((b - a) * (b - c)), a * b / ((c - a) * (c - b))]
    return float(np.dot(weights, values))
