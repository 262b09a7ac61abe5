"""Settings for the calibration of a mesh (`calibration`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationSettings:
    """Settings for the calibration of a mesh: safety factors on measured errors, convergence rates, reuse at
    later cycles, and limits of planned meshes."""

    safety_factor: float = 3.0
    """Safety factor on measured errors of period, extrema and multiplier."""
    min_largest_y_error_over_path_distance: float = 0.16
    """Lower limit of the error estimate of the largest y, divided by the distance between the tip's paths on
    two meshes with different elements: a single number may agree on two meshes by coincidence, a path does
    not."""
    min_period_error_over_path_distance: float = 0.16
    """Lower limit of the error estimate of the period, divided by the distance between the tip's paths on two
    meshes with different elements."""
    min_extrema_error_over_path_distance: float = 1.6
    """Lower limit of the error estimate of the other extrema, divided by the sum of the distances between the
    tip's paths for different elements and for different time intervals."""
    time_path_distance_factor: float = 0.004
    """This factor times the distance between the tip's paths for different time intervals is added to the
    lower limits of the error estimates of period and largest y. The distance is largest in theta, whose
    errors matter least."""
    extrema_error_per_last_harmonics: float = 10.0
    """Increase of the error estimate of the other extrema along a chain, divided by the increase of the last
    harmonics of the tip's path: a bound of the sum of all harmonics that are cut off, the next three being
    the largest. The remaining errors of the extrema grow no faster than those of period and largest y: in 117
    random chains the errors stayed below half of the estimates even without this increase."""
    min_ratio_to_larger_error: float = 2.0
    """Lower limit of the error estimates of period and of largest y, divided by the larger of the two
    measured errors. The two errors decrease as the squares of the tails, and rarely change sign near the same
    mesh. Without this limit, the error of one cycle in a thousand exceeded its estimate, by a factor of up to
    4.5."""
    planned_error_ratio: float = 0.5
    """A mesh is planned for predicted errors of period and largest y of at most this fraction of the
    accuracy."""
    planned_extrema_error_over_tolerance: float = 0.75
    """A mesh is planned for a predicted error of the other extrema of at most this fraction of their
    tolerance. This error changes less along a chain: it contains the distance between the tip's paths."""
    error_to_coefficient_decay_ratio: float = 1.6
    """Assumed decrease of ln(error) in space per order, divided by the decrease of ln(coefficient) per order.
    The errors are proportional to squared coefficients; ratios from 1.4 to 2 were measured."""
    min_space_decay: float = 0.5
    """Lower limit of an assumed or measured decrease of ln(error) in space per order."""
    max_space_decay: float = 2.2
    """Upper limit of an assumed or measured decrease of ln(error) in space per order."""
    time_order_per_stage: float = 1.5
    """Order of convergence in time divided by the number of stages, assumed if no order was measured."""
    max_time_order_ratio: float = 2.0
    """Upper limit of a measured order of convergence in time, divided by the smallest order, stages + 1."""
    max_order_decrease: int = 3
    """Largest decrease of the order of the elements from the current mesh to a planned mesh."""
    min_interval_ratio: float = 0.6
    """Lower limit of the ratio of the numbers of time intervals, planned mesh to current mesh."""
    max_order_increase: int = 12
    """Largest increase of the order of the elements from the current mesh to a planned mesh; the convergence
    rates are not known for finer meshes."""
    max_interval_ratio: int = 4
    """Upper limit of the ratio of the numbers of time intervals, planned mesh to current mesh; the
    convergence rates are not known for finer meshes."""
    max_relative_parameter_change: float = 0.2
    """The errors are measured again if the summed relative changes of the parameter exceed this number."""
    max_error_growth: float = 4.0
    """The errors are measured again if an error has grown by more than this factor since the measurement."""
    min_size_ratio: float = 0.75
    """The errors are measured again if (size of the orbit)/(size of the measured orbit) is less than this
    number. Near the Hopf point where the cycles end, the error of the largest y may change sign and then grow
    fast."""
    min_remeasured_ratio: float = 0.5
    """Lower limit of an error that is measured again on the same mesh, divided by the previous error scaled
    with the tails. Near a change of sign, an error is small at one cycle, and three cycles later as large as
    before."""
    min_element_tail_ratio: float = 1e-3
    """Lower limit of the tail of an element by which errors are scaled, divided by the largest tail of all
    elements. Of two elements, the one with a tail of 0.07 times the largest determined the errors, which grew
    four times as much as the square of the largest tail."""
    min_tail: float = 1e-15
    """Lower limit of the coefficient tails by which errors are scaled; smaller tails are rounding errors."""


CALIBRATION_SETTINGS = CalibrationSettings()
