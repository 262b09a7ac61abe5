"""Settings for the calibration of a mesh (`calibration`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationSettings:
    """Settings for the calibration of a mesh: safety factors on measured errors, convergence rates, reuse at
    later cycles, and limits of planned meshes."""

    safety_factor: float = 3.0
    """Safety factor on measured errors of period, extrema and multiplier."""
    min_height_error_share: float = 0.16
    """Smallest error of the largest y, in units of the distance between the tip's paths on two meshes with
    different elements: one number may agree on two meshes by coincidence, a path does not."""
    min_period_error_share: float = 0.16
    """Smallest error of the period, in units of the distance between the tip's paths on two meshes with
    different elements."""
    min_extrema_error_share: float = 1.6
    """Smallest error of the other extrema, in units of the sum of the distances between the tip's paths for
    different elements and for different time intervals."""
    min_error_share_in_time: float = 0.004
    """Smallest errors of largest y and period, in units of the distance between the tip's paths on two meshes
    with different time intervals. This distance is largest in theta, whose errors matter least."""
    mutual_bound: float = 2.0
    """Smallest errors of period and of largest y, in units of the larger of both errors. Both errors decrease
    as the squares of the tails, and rarely change sign near the same mesh. Without this bound, the error of
    one cycle in a thousand exceeded its estimate, by a factor of up to 4.5."""
    planned_error: float = 0.5
    """Predicted error for which a mesh is planned, in units of the accuracy."""
    error_decay_ratio: float = 1.6
    """Decrease of the logarithm of the errors in space per order, in units of the same decrease of the
    coefficients. The errors are proportional to squared coefficients; ratios from 1.4 to 2 were measured."""
    min_space_decay: float = 0.5
    """Smallest assumed decrease of the natural logarithm of the errors in space per order."""
    max_space_decay: float = 2.2
    """Largest assumed decrease of the natural logarithm of the errors in space per order."""
    time_order_by_stages: float = 1.5
    """Assumed order of convergence in time, in units of the number of stages, if no order was measured."""
    max_time_order_ratio: float = 2.0
    """Largest order of convergence in time by a measurement, in units of the smallest order, stages + 1."""
    max_fewer_orders: int = 3
    """Largest decrease of the order of the elements from the present mesh to a planned mesh."""
    min_interval_ratio: float = 0.6
    """Smallest ratio of the numbers of time intervals of a planned mesh and the present mesh."""
    max_more_orders: int = 12
    """Largest increase of the order of the elements from the present mesh to a planned mesh; the convergence
    rates are not known for finer meshes."""
    max_interval_ratio: int = 4
    """Largest ratio of the numbers of time intervals of a planned mesh and the present mesh; the convergence
    rates are not known for finer meshes."""
    max_parameter_change: float = 0.2
    """Relative change of the parameter since a measurement, beyond which the errors are measured again."""
    max_error_growth: float = 4.0
    """Growth of the errors since a measurement, beyond which the errors are measured again."""
    min_size_ratio: float = 0.75
    """Ratio of the sizes of an orbit and of the measured orbit, below which the errors are measured
    again. Near the Hopf point where the cycles end, the error of the largest y may change sign and then
    grow fast."""
    min_repeated_share: float = 0.5
    """Lower limit of an error that is measured again on the same mesh, divided by the previous error scaled
    with the tails. Where an error changes its sign, the error is small at one cycle, and as large as before
    three cycles later."""
    min_tail: float = 1e-15
    """Smallest coefficient tail by which errors are scaled; smaller tails are rounding errors."""


CALIBRATION = CalibrationSettings()
