"""Error estimates of a cycle by two integrations of its motion, the second with more accuracy."""

from math import nan

from ...orbit.measures import CyclePath
from ..marching_settings import MARCHING
from .cycle_errors import CycleErrors


def errors_of_pair(one: CyclePath, other: CyclePath, share: float) -> CycleErrors:
    """Errors by the difference of two integrations, plus `share`, the distance left of a settled motion."""
    a = one.extrema
    b = other.extrema
    size = abs(b["tip_y_max"])
    period = abs(one.orbit.period / other.orbit.period - 1)
    height = abs(a["tip_y_max"] - b["tip_y_max"]) / size
    worst = max(abs(a[name] - b[name]) for name in a) / size
    # The distance left is relative to each extremum, of which theta may be several times y.
    left = share * max(1.0, abs(b["tip_theta_max"]) / size)
    return CycleErrors(
        float(MARCHING.pair_factor * period + share),
        float(MARCHING.pair_factor * height + share),
        float(MARCHING.pair_factor * worst + left),
        nan,
    )
