"""Minimal period of an orbit, from the harmonics of its bending strain.

An orbit that closes after T has the minimal period T/g, where g is the greatest common divisor of the numbers
of all nonzero harmonics. A harmonic larger than the error of the orbit is certainly nonzero; if these
harmonics give g = 1, T is proved minimal. If all large harmonics give g > 1, the orbit is solved again over
T/g. If only small harmonics, which may be errors, give g = 1, the minimal period is undecided.
"""

from dataclasses import dataclass, replace
from math import gcd

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled
from ...orbit.measures import CycleMotion
from ...orbit.orbit import Orbit, node_time_fractions
from ...orbit.time_grading import UNIFORM_TIME_GRADING


@dataclass(frozen=True, slots=True, kw_only=True)
class MinimalPeriodSettings:
    """Settings for the test whether a harmonic is nonzero."""

    min_harmonic_ratio: float = 1e-3
    """While the error of the orbit is not known, a harmonic is treated as nonzero if its size divided by the
    size of the largest harmonic exceeds this number."""
    min_certain_harmonic_per_extrema_error: float = 10.0
    """A harmonic is certainly nonzero if its size divided by the size of the largest harmonic exceeds this
    number times the relative error of the extrema."""
    min_certain_harmonic_ratio: float = 1e-6
    """A harmonic is not certainly nonzero if its size divided by the size of the largest harmonic is at most
    this number: the error estimate applies to the tip, and the bending strain may have a larger error."""


MINIMAL_PERIOD_SETTINGS = MinimalPeriodSettings()


def common_harmonic_divisor(motion: CycleMotion, min_ratio: float) -> int:
    """Greatest common divisor of the numbers of all harmonics of the bending strain larger than `min_ratio`
    times the largest harmonic; 0 if all harmonics are 0. If the harmonics of the tip's angle alone give 1,
    the harmonics of the strain are not computed: a motion whose tip does not repeat within the period does
    not repeat either."""
    if _divisor_from_harmonic_sizes(motion.tip_angle_harmonic_sizes, min_ratio) == 1:
        return 1
    return int(_divisor_from_harmonic_sizes(motion.curvature_harmonic_sizes, min_ratio))


@compiled
def _divisor_from_harmonic_sizes(sizes: Array, min_ratio: float) -> int:
    """Greatest common divisor of the numbers k of all harmonics whose size exceeds `min_ratio` times the
    largest size; 0 if all sizes are 0. sizes: sizes of the harmonics 1, 2, ..., (harmonics,)."""
    divisor = 0
    min_size = min_ratio * sizes.max()
    for k in range(len(sizes)):
        if sizes[k] > min_size:
            # A motion whose nonzero harmonics are all multiples of g repeats g times within the period.
            divisor = gcd(divisor, k + 1)
    return divisor


def possible_period_divisor(motion: CycleMotion, extrema_error: float) -> int:
    """Number g such that the minimal period may be 1/g of the period of the motion `motion`; g = 1 proves the
    period minimal, and g = 0 means that all harmonics are 0.

    extrema_error: relative error of the extrema.
    """
    return common_harmonic_divisor(
        motion,
        max(
            MINIMAL_PERIOD_SETTINGS.min_certain_harmonic_per_extrema_error * extrema_error,
            MINIMAL_PERIOD_SETTINGS.min_certain_harmonic_ratio,
        ),
    )


def restricted_to_minimal_period(orbit: Orbit) -> Orbit:
    """The part of `orbit` over the minimal period that its large harmonics show, as a start for Newton's
    method; `orbit` itself if its period is minimal."""
    divisor = common_harmonic_divisor(CycleMotion(orbit), MINIMAL_PERIOD_SETTINGS.min_harmonic_ratio)
    if divisor == 1:
        return orbit
    times = node_time_fractions(orbit.interval_count, orbit.stage_count)
    # A symmetric orbit bends in odd harmonics only, so its divisor is odd and the shorter orbit is symmetric.
    values = np.append(orbit.states_at_time_fractions(times / divisor), orbit.period / divisor)
    # The grading was fitted to several minimal periods, so the shorter orbit starts with a uniform one.
    return replace(orbit, values=values, grading=UNIFORM_TIME_GRADING)
