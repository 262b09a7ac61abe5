"""What two meshes tell of the errors of a cycle.

What the coarse one differs by from the fine one is its own error, measured; the error that the fine one
leaves is this times the ratio of what the two are expected to leave.
"""

from dataclasses import dataclass
from math import nan

import numpy as np

from .measures import CyclePath
from .orbit import Orbit
from .orbit_mesh import COARSER_ORDER, space_decay
from .path_differences import path_differences

ROUNDING = 2e-14
"""Relative error that is left of period and extrema however fine the mesh."""
LEAST_RATIO, LARGEST_RATIO = 1e-3, 0.5
"""Bounds of the ratio of the fine mesh's error to the coarse one's."""
SPACE_POWER = 1.5
"""Power of the decay of coefficients with which errors in space fall: ideally 2, far beyond the Hopf point
so slowly."""
SAFETY = 5.5
PATH_SHARE, HEIGHT_SHARE, PERIOD_SHARE = 0.4, 0.006, 0.1
"""What the coarse mesh's errors of period and extrema are multiplied with; the shares of the largest distance
between the tip's paths that count at least as an error of any extremum and of the largest y, and the share of
this one that counts as an error of the period: a number may happen to agree on both meshes."""
LEAST_CLAIM = 0.1
"""Share of the accuracy asked for that an error is never said to be below, for it may be by such luck."""
EXTREMA_SLACK = 100.0
"""How much less accurate than period and largest y, which are met by a node in time and converge fastest, the
tip's other extrema may be."""


@dataclass(frozen=True, slots=True)
class CycleErrors:
    """Estimates, relative: of the period, of the tip's largest y, and of its other extrema in units of it.

    multiplier_error: absolute, of the largest nontrivial multiplier.
    """

    period_error: float
    amplitude_error: float
    extrema_error: float
    multiplier_error: float

    @property
    def largest(self) -> float:
        """What must not exceed the accuracy asked for."""
        return max(self.period_error, self.amplitude_error, self.extrema_error / EXTREMA_SLACK)


UNKNOWN_ERRORS = CycleErrors(nan, nan, nan, nan)


def coarse_errors(coarse: CyclePath, fine: CyclePath) -> CycleErrors:
    """The errors of the coarse of two paths; multiplier_error: none is known.

    An extremum may happen to agree on both: the whole paths of the tip are compared too.
    """
    period, height, others, apart = path_differences(coarse, fine).tolist()
    height = max(SAFETY * height, HEIGHT_SHARE * apart)
    period = max(SAFETY * period, PERIOD_SHARE * height)
    return CycleErrors(period, height, max(SAFETY * others, PATH_SHARE * apart), nan)


def fine_errors(coarse: CyclePath, fine: CyclePath, accuracy: float) -> CycleErrors:
    """The errors that the fine of two paths leaves; multiplier_error: none is known."""
    rough, ratio = coarse_errors(coarse, fine), error_ratio(coarse.orbit, fine.orbit)
    least = max(LEAST_CLAIM * accuracy, ROUNDING)
    return CycleErrors(
        max(ratio * rough.period_error, least),
        max(ratio * rough.amplitude_error, least),
        max(ratio * rough.extrema_error, least),
        nan,
    )


def error_ratio(coarse: Orbit, fine: Orbit) -> float:
    """The error that the fine mesh leaves in units of that of the coarse one.

    In time of order s + 1, what stiffness leaves at least of the 2 s - 1. Which of space and time the error
    comes from is not known: the larger ratio counts.
    """
    in_time = ((coarse.intervals - 1) / (fine.intervals - 1)) ** (fine.stages + 1)
    return min(max(space_ratio(fine), in_time, LEAST_RATIO), LARGEST_RATIO)


def space_ratio(fine: Orbit) -> float:
    """The ratio of the errors in space of a mesh and its coarser one."""
    return float(np.exp(-SPACE_POWER * COARSER_ORDER * space_decay(fine)))
