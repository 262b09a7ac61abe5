"""Error estimates of a cycle by two time integrations of different accuracy."""

from math import nan

from ...orbit.measures import CyclePath
from ..marching_settings import MARCHING_SETTINGS
from .cycle_errors import CycleErrors


def errors_of_two_integrations(one: CyclePath, other: CyclePath, distance: float) -> CycleErrors:
    """Error estimates from the differences between the cycles `one` and `other` of two time integrations,
    relative to the largest y and the period of `other`; NaN for the multiplier. distance: relative distance
    of the settled motions from the cycle, which is added to the error estimates."""
    a = one.extrema
    b = other.extrema
    size = abs(b["tip_y_max"])
    period = abs(one.orbit.period / other.orbit.period - 1)
    height = abs(a["tip_y_max"] - b["tip_y_max"]) / size
    worst = max(abs(a[name] - b[name]) for name in a) / size
    # Errors of extrema are divided by the largest y; theta may be several times as large as y.
    left = distance * max(1.0, abs(b["tip_theta_max"]) / size)
    return CycleErrors(
        float(MARCHING_SETTINGS.difference_safety_factor * period + distance),
        float(MARCHING_SETTINGS.difference_safety_factor * height + distance),
        float(MARCHING_SETTINGS.difference_safety_factor * worst + left),
        nan,
    )
