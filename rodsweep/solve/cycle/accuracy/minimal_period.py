"""Minimal period of an orbit, from the harmonics of its bending strain.

An orbit that closes after T has the minimal period T/g, where g is the greatest common divisor of the numbers
of all harmonics that are present. A harmonic larger than the orbit's error is certainly present; if the
certain harmonics have g = 1, T is proved minimal. If g > 1 among harmonics of clear size, the orbit is solved
again over T/g. If g = 1 only by harmonics that may be errors, the minimal period stays undecided.
"""

from dataclasses import dataclass, replace
from math import gcd

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled
from ...orbit.measures import CyclePath
from ...orbit.orbit import Orbit, node_times


@dataclass(frozen=True, slots=True, kw_only=True)
class MinimalPeriodSettings:
    """Settings for the harmonics that prove the period minimal."""

    present: float = 1e-3
    """Smallest size of a present harmonic, in units of the largest harmonic, as long as errors are not
    known."""
    certain: float = 10.0
    """Smallest relative size of a certainly present harmonic, in units of the extrema's relative error."""
    min_present: float = 1e-6
    """Lower bound of this size: the error estimate is the tip's, and the bending strain may have a larger
    error."""


MINIMAL_PERIOD = MinimalPeriodSettings()


def common_divisor(path: CyclePath, present: float) -> int:
    """Divisor g of the harmonics larger than `present` times the largest; 1 proves the period minimal."""
    return int(_divisor_of(path.bending_harmonics, present))


@compiled
def _divisor_of(sizes: Array, present: float) -> int:
    """`common_divisor` of harmonics of these sizes, (harmonics,), from the first; 0 if all sizes are 0."""
    divisor = 0
    least = present * sizes.max()
    for k in range(len(sizes)):
        if sizes[k] > least:
            # Harmonics that are all multiples of g repeat g times within the period.
            divisor = gcd(divisor, k + 1)
    return divisor


def undecided_divisor(path: CyclePath, error: float) -> int:
    """Factor by which the minimal period may be shorter than the orbit's; 1 proves the period minimal.

    error: relative error of the extrema.
    """
    return common_divisor(path, max(MINIMAL_PERIOD.certain * error, MINIMAL_PERIOD.min_present))


def over_minimal_period(orbit: Orbit) -> Orbit:
    """The orbit over the common period of its present harmonics, as a start for Newton's method."""
    g = common_divisor(CyclePath(orbit), MINIMAL_PERIOD.present)
    if g == 1:
        return orbit
    times = node_times(orbit.intervals, orbit.stages)
    # A symmetric orbit bends in odd harmonics only, so its divisor is odd and the shorter orbit is symmetric.
    return replace(orbit, values=np.append(orbit.at(times / g), orbit.period / g))
