"""Error estimates of a cycle."""

from dataclasses import dataclass
from math import nan

import numpy as np

from ....arrays import Array

ROUNDING = 2e-14
"""Smallest stated relative error of period and extrema: rounding errors on any mesh."""
LEAST_CLAIM = 0.1
"""Smallest stated error in units of the accuracy: a smaller estimate may be small by coincidence."""
EXTREMA_SLACK = 100.0
"""Ratio of the tolerances of the tip's other extrema and of period and largest y. Period and largest y, at
which a time node lies, converge fastest."""


@dataclass(frozen=True, slots=True)
class CycleErrors:
    """Relative error estimates of period and of the tip's largest y, and of its other extrema in units of it.

    multiplier_error: absolute error estimate of the largest nontrivial multiplier.
    """

    period_error: float
    amplitude_error: float
    extrema_error: float
    multiplier_error: float

    @property
    def largest(self) -> float:
        """Error that is compared with the requested accuracy."""
        return float(largest_error(self.period_error, self.amplitude_error, self.extrema_error))


def largest_error(period: Array | float, amplitude: Array | float, extrema: Array | float) -> Array:
    """`CycleErrors.largest` of errors that are numbers or arrays of one shape."""
    largest: Array = np.maximum(np.maximum(period, amplitude), np.asarray(extrema) / EXTREMA_SLACK)
    return largest


UNKNOWN_ERRORS = CycleErrors(nan, nan, nan, nan)
