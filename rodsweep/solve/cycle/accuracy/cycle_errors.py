"""Error estimates of a cycle."""

from dataclasses import dataclass
from math import nan

import numpy as np

from ....arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleErrorSettings:
    """Settings for the smallest stated errors, and for the error that is compared with the accuracy."""

    rounding: float = 2e-14
    """Smallest stated relative error of period and extrema: rounding errors on any mesh."""
    min_claim: float = 0.1
    """Smallest stated error in units of the accuracy: a smaller estimate may be small by coincidence."""
    extrema_slack: float = 100.0
    """Tolerance of the tip's other extrema in units of the tolerance of period and largest y. Period and
    largest y converge fastest; a time node lies at the largest y."""


CYCLE_ERRORS = CycleErrorSettings()


@dataclass(frozen=True, slots=True)
class CycleErrors:
    """Relative error estimates of the period and the tip's largest y, and of other extrema in units of the
    largest y.

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
    """`CycleErrors.largest` of numbers, or of arrays with a common shape."""
    largest: Array = np.maximum(
        np.maximum(period, amplitude), np.asarray(extrema) / CYCLE_ERRORS.extrema_slack
    )
    return largest


UNKNOWN_ERRORS = CycleErrors(nan, nan, nan, nan)
