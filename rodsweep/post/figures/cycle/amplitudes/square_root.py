"""The square-root law of the amplitude next to a Hopf point F**: y = a sqrt(|F - F**|/|F**|).

The coefficient comes from the cycles that a file holds, none is computed; where those do not shrink towards
the Hopf point as the law says, as on the far side of a fold, there is no law to draw.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from .....arrays import Array
from ....hopf_points import Located

NEAR = 0.1
"""|F - F**|/|F**| up to which a cycle is near enough to tell the coefficient."""
DEPARTURE = 0.2
"""Relative difference from the law up to which an amplitude follows it."""
SAFETY = 2.0
"""Error of a coefficient in units of what one more cycle changes."""
CERTAIN = 100
"""Errors of F** by which a point must lie away from it, so that its distance is known to a percent."""


@dataclass(frozen=True, slots=True)
class SquareRootLaw:
    """The law on one side of a Hopf point."""

    hopf: float
    """F**, in k3/L^2."""
    coefficient: float
    """a, in L."""
    above: bool
    """Whether the cycles lie at F > F**."""
    end: float
    """The last F whose amplitude still follows it."""
    error: float
    """Of a, in L: twice what a third cycle changes, or what the extrapolation changes where there is none."""

    def curve(self, points: int = 100) -> tuple[Array, Array]:
        """(F, amplitude) from the Hopf point to the end, each of shape (points,), close where it is steep."""
        step = np.linspace(0, 1, points, dtype=np.float64) ** 2
        F = self.hopf + (self.end - self.hopf) * step
        return F, self.coefficient * np.sqrt(np.abs(F - self.hopf) / abs(self.hopf))


def square_root_laws(F: Array, amplitude: Array, points: Sequence[Located]) -> list[SquareRootLaw]:
    """The laws that the amplitudes follow, at most one for each side of a Hopf point.

    F and amplitude have the shape (n,), in any order; amplitude is NaN or 0 where there is no cycle.
    """
    laws = (_law(F, amplitude, point, side) for point in points for side in (1, -1) if point.position)
    return [law for law in laws if law]


def _law(F: Array, amplitude: Array, point: Located, side: int) -> SquareRootLaw | None:
    """The law above (side 1) or below (-1) the Hopf point; None where the amplitudes follow none.

    Towards the Hopf point amplitude^2/distance is linear in the distance: its value there is extrapolated
    from the nearest two cycles.
    """
    distance = side * (F - point.position) / abs(point.position)
    # Of two cycles at one F the smaller comes first: the larger is not the one that shrinks to nothing.
    order = np.lexsort((np.where(amplitude > 0, amplitude, np.inf), distance))
    distance, first = np.unique(distance[order], return_index=True)
    size = amplitude[order][first]
    there = distance > CERTAIN * point.error / abs(point.position)
    distance, size = distance[there], size[there]
    gap = np.flatnonzero(~(size > 0))  # behind it begins another branch
    distance, size = distance[: gap[0] if gap.size else None], size[: gap[0] if gap.size else None]
    if len(size) < 2 or distance[1] > NEAR:
        return None
    q = size[:2] ** 2 / distance[:2]
    square = q[0] - distance[0] * (q[1] - q[0]) / (distance[1] - distance[0])
    if square <= 0:
        return None
    follows = np.abs(np.sqrt(square * distance) / size - 1) <= DEPARTURE
    if not follows[:2].all():
        return None
    last = len(size) if follows.all() else int(np.argmin(follows))
    end = point.position + side * abs(point.position) * float(distance[last - 1])
    third = size[:3] ** 2 / distance[:3]
    better = _at_zero(distance[:3], third) if len(third) > 2 and distance[2] <= NEAR else q[0]
    error = SAFETY * abs(sqrt(max(better, 0.0)) - sqrt(square))
    return SquareRootLaw(point.position, sqrt(square), side > 0, end, error)


def _at_zero(x: Array, values: Array) -> float:
    """The polynomial through values at three places x, both (3,), at 0."""
    a, b, c = x
    weights = [b * c / ((a - b) * (a - c)), a * c / ((b - a) * (b - c)), a * b / ((c - a) * (c - b))]
    return float(np.dot(weights, values))
