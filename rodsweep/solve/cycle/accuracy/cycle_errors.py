"""The errors that a cycle states."""

from dataclasses import dataclass
from math import nan

import numpy as np

from ....arrays import Array

ROUNDING = 2e-14
"""Relative error that is left of period and extrema however fine the mesh."""
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
        return float(largest_error(self.period_error, self.amplitude_error, self.extrema_error))


def largest_error(period: Array | float, amplitude: Array | float, extrema: Array | float) -> Array:
    """The same of numbers or arrays of one shape."""
    largest: Array = np.maximum(np.maximum(period, amplitude), np.asarray(extrema) / EXTREMA_SLACK)
    return largest


UNKNOWN_ERRORS = CycleErrors(nan, nan, nan, nan)
