"""Square-root law of the amplitude near a Hopf point F**: y = a sqrt(|F - F**|/|F**|).

The coefficient a is fitted to the cycles in a file; no cycle is computed. There is no law if the amplitudes
do not tend to zero at the Hopf point, as on the far side of a fold.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from .....arrays import Array
from ....hopf_points import LocatedChange

FARTHEST_FITTED = 0.1
"""Largest |F - F**|/|F**| of a cycle used for the coefficient; farther cycles obey higher-order terms."""
LARGEST_DEPARTURE = 0.2
"""Largest relative difference between an amplitude and the law over the range in which the law is drawn."""
SAFETY = 2.0
"""Error of a coefficient, in units of the change by a further cycle."""
MIN_ERRORS_AWAY = 100
"""Least distance of a cycle from F**, in errors of F**, so that the distance is known to a percent."""


@dataclass(frozen=True, slots=True)
class SquareRootLaw:
    """Law on one side of a Hopf point."""

    hopf: float
    """F**, in k3/L^2."""
    coefficient: float
    """a, in L."""
    above: bool
    """Whether the cycles lie at F > F**."""
    end: float
    """Last F at which the amplitude follows the law."""
    error: float
    """Error of a, in L: twice the change by a third cycle, or without one by the extrapolation to F**."""

    def curve(self, points: int = 100) -> tuple[Array, Array]:
        """(F, amplitude) from the Hopf point to the end, (points,) each; F is dense near the Hopf point."""
        step = np.linspace(0, 1, points, dtype=np.float64) ** 2
        F = self.hopf + (self.end - self.hopf) * step
        return F, self.coefficient * np.sqrt(np.abs(F - self.hopf) / abs(self.hopf))


def square_root_laws(F: Array, amplitude: Array, points: Sequence[LocatedChange]) -> list[SquareRootLaw]:
    """Laws that the amplitudes follow, at most one on each side of a Hopf point.

    F, amplitude: shape (n,), in any order; amplitude is NaN or 0 without a cycle.
    """
    laws = (_law(F, amplitude, point, side) for point in points for side in (1, -1) if point.position)
    return [law for law in laws if law]


def _law(F: Array, amplitude: Array, point: LocatedChange, side: int) -> SquareRootLaw | None:
    """The law above (side 1) or below (-1) the Hopf point; None if the amplitudes disagree.

    amplitude^2/distance is linear in the distance to leading order. The value at distance 0 is extrapolated
    from the nearest two cycles.
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
    if len(size) < 2 or distance[1] > FARTHEST_FITTED:
        return None
    q = size[:2] ** 2 / distance[:2]
    square = q[0] - distance[0] * (q[1] - q[0]) / (distance[1] - distance[0])
    if square <= 0:
        return None
    follows = np.abs(np.sqrt(square * distance) / size - 1) <= LARGEST_DEPARTURE
    if not follows[:2].all():
        return None
    last = len(size) if follows.all() else int(np.argmin(follows))
    end = point.position + side * abs(point.position) * float(distance[last - 1])
    third = size[:3] ** 2 / distance[:3]
    better = _at_zero(distance[:3], third) if len(third) > 2 and distance[2] <= FARTHEST_FITTED else q[0]
    error = SAFETY * abs(sqrt(max(better, 0.0)) - sqrt(square))
    return SquareRootLaw(point.position, sqrt(square), side > 0, end, error)


def _at_zero(x: Array, values: Array) -> float:
    """Value at x = 0 of the parabola through three points (x, value), both (3,)."""
    a, b, c = x
    weights = [b * c / ((a - b) * (a - c)), a * c / ((b - a) * (b - c)), a * b / ((c - a) * (c - b))]
    return float(np.dot(weights, values))
