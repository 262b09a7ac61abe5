"""Error estimates of a cycle: of the period, of the largest y and other extrema of the tip, and of the
largest nontrivial Floquet multiplier.

Errors are measured in `finer_meshes`, as differences between the cycles on the mesh and on two finer meshes,
or predicted in `coarser_meshes`, and `calibration` scales them to later cycles. Then
`errors_with_safety_factors` applies safety factors and lower limits, with the factors of `settings`. The
errors of integrated cycles come from `errors_of_two_integrations`.
"""

from dataclasses import dataclass
from math import nan

import numpy as np

from ....arrays import Array
from ...orbit.measures import CycleMotion
from ...orbit.tip_path_differences import EXTREMUM_INDEX, PATH_INDEX, PERIOD_INDEX, Y_INDEX
from ..integration_settings import INTEGRATION_SETTINGS
from .settings import MESH_ERROR_CALIBRATION_SETTINGS

LARGEST_MULTIPLIER_ERROR_INDEX = 4
"""Index of the error of the largest nontrivial multiplier in the error arrays of a calibration."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CycleErrorSettings:
    """Settings for the smallest error estimates of a cycle (applied in `errors_with_safety_factors`), and for
    the error that is compared with the accuracy."""

    relative_rounding_error: float = 2e-14
    """Smallest relative error estimate of period and extrema: the rounding error on any mesh."""
    min_error_over_accuracy: float = 0.1
    """Lower limit of error estimates, divided by the accuracy: a smaller estimate may be a coincidence."""
    min_largest_y_error_over_accuracy: float = 0.2
    """Lower limit of the error estimate of the largest y, divided by the accuracy: this error changes its
    sign along a chain, so that a small error may be measured at one cycle and used at the next cycles. With a
    limit of 0.1, two of 1500 errors exceeded their estimates, by a factor of 1.5."""
    extrema_to_period_tolerance_ratio: float = 100.0
    """Tolerance of the tip's other extrema divided by the tolerance of period and largest y. Period and
    largest y converge fastest, because a time node lies at the largest y."""


CYCLE_ERROR_SETTINGS = CycleErrorSettings()


@dataclass(frozen=True, slots=True)
class CycleErrors:
    """Error estimates of a cycle; safety factors are included.

    period_error, amplitude_error: relative errors of the period and of the tip's largest y. extrema_error:
    largest error of the tip's other extrema, divided by the largest y. multiplier_error: absolute error of
    the largest nontrivial multiplier.
    """

    period_error: float
    amplitude_error: float
    extrema_error: float
    multiplier_error: float

    @property
    def largest_weighted_error(self) -> float:
        """The error that is compared with the requested accuracy: the largest of the error of the period, the
        error of the largest y, and the error of the other extrema divided by
        `extrema_to_period_tolerance_ratio`."""
        return float(largest_weighted_error(self.period_error, self.amplitude_error, self.extrema_error))


def largest_weighted_error(period: Array | float, amplitude: Array | float, extrema: Array | float) -> Array:
    """`CycleErrors.largest_weighted_error` for errors of the period, the largest y (`amplitude`) and the
    other extrema: numbers, or arrays of a common shape."""
    largest: Array = np.maximum(
        np.maximum(period, amplitude),
        np.asarray(extrema) / CYCLE_ERROR_SETTINGS.extrema_to_period_tolerance_ratio,
    )
    return largest


def message_of_error(errors: CycleErrors, accuracy: float) -> str:
    """Sentence part for a cycle whose errors exceed the requested relative accuracy `accuracy`."""
    largest_error = errors.largest_weighted_error
    return f"the cycle's errors, up to {largest_error:.3g}, exceed the requested accuracy of {accuracy:g}"


def errors_with_safety_factors(space_errors: Array, time_errors: Array, accuracy: float) -> Array:
    """The four errors of `CycleErrors`, (4, ...), from the errors `space_errors` due to the elements and
    `time_errors` due to the time intervals, (5, ...) each: the four errors of `tip_path_differences`, then
    the error of the multiplier. Safety factors and lower limits are applied. accuracy: requested relative
    accuracy, for a lower limit."""
    scaled_errors = MESH_ERROR_CALIBRATION_SETTINGS.error_safety_factor * (space_errors + time_errors)
    # Single quantities may agree on two meshes by chance; the whole path cannot.
    path_error = space_errors[PATH_INDEX] + time_errors[PATH_INDEX]
    time_path_error = (
        MESH_ERROR_CALIBRATION_SETTINGS.min_error_over_tip_path_distance * time_errors[PATH_INDEX]
    )
    larger_errors = [np.maximum(part[PERIOD_INDEX], part[Y_INDEX]) for part in (space_errors, time_errors)]
    # Period and largest y come from the same orbit, so neither is much more accurate than the other.
    min_errors = MESH_ERROR_CALIBRATION_SETTINGS.min_error_per_larger_error * (
        larger_errors[0] + larger_errors[1]
    )
    min_period_error = (
        MESH_ERROR_CALIBRATION_SETTINGS.min_period_error_over_path_distance * space_errors[PATH_INDEX]
        + time_path_error
    )
    min_height_error = np.maximum(
        MESH_ERROR_CALIBRATION_SETTINGS.min_largest_y_error_over_path_distance * space_errors[PATH_INDEX]
        + time_path_error,
        CYCLE_ERROR_SETTINGS.min_largest_y_error_over_accuracy * accuracy,
    )
    stated_errors = [
        np.maximum(np.maximum(scaled_errors[PERIOD_INDEX], min_period_error), min_errors),
        np.maximum(np.maximum(scaled_errors[Y_INDEX], min_height_error), min_errors),
        np.maximum(
            scaled_errors[EXTREMUM_INDEX],
            MESH_ERROR_CALIBRATION_SETTINGS.min_extrema_error_over_path_distance * path_error,
        ),
        scaled_errors[LARGEST_MULTIPLIER_ERROR_INDEX],
    ]
    min_error = max(
        CYCLE_ERROR_SETTINGS.min_error_over_accuracy * accuracy, CYCLE_ERROR_SETTINGS.relative_rounding_error
    )
    errors: Array = np.maximum(np.array(stated_errors), min_error)
    return errors


UNKNOWN_ERRORS = CycleErrors(nan, nan, nan, nan)


def errors_of_two_integrations(first: CycleMotion, second: CycleMotion, distance: float) -> CycleErrors:
    """Error estimates from the differences between the motions `first` and `second` of two time integrations,
    relative to the largest y and the period of `second`; NaN for the multiplier. distance: relative distance
    of the settled motions from the cycle, which is added to the errors."""
    first_extrema = first.tip_extrema
    second_extrema = second.tip_extrema
    largest_y = abs(second_extrema["tip_y_max"])
    period_difference = abs(first.orbit.period / second.orbit.period - 1)
    y_difference = abs(first_extrema["tip_y_max"] - second_extrema["tip_y_max"]) / largest_y
    max_extremum_difference = (
        max(abs(first_extrema[name] - second_extrema[name]) for name in first_extrema) / largest_y
    )
    # Errors of extrema are divided by the largest y; theta may be several times as large as y.
    remaining_error = distance * max(1.0, abs(second_extrema["tip_theta_max"]) / largest_y)
    return CycleErrors(
        float(INTEGRATION_SETTINGS.difference_safety_factor * period_difference + distance),
        float(INTEGRATION_SETTINGS.difference_safety_factor * y_difference + distance),
        float(INTEGRATION_SETTINGS.difference_safety_factor * max_extremum_difference + remaining_error),
        nan,
    )
