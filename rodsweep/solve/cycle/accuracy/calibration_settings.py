"""Numbers of the calibration of a mesh (`calibration`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationSettings:
    """Settings for measured errors of a mesh: safety factors, rates, reuse, and bounds of planned meshes."""

    safety: float = 3.0
    """Safety factor on measured errors of period, extrema and multiplier."""
    height_share: float = 0.16
    """Smallest error of the largest y, in units of the distance in space between the tip's paths on two
    meshes: a number may agree on two meshes by coincidence, a path does not."""
    period_share: float = 0.16
    """Smallest error of the period, in the same units."""
    others_share: float = 1.6
    """Smallest error of the other extrema, in units of the distance in space and in time."""
    share_in_time: float = 0.004
    """Smallest errors of largest y and period, in units of the distance in time. That distance is largest in
    theta, where the rod is stiff and errors matter least."""
    mutual_bound: float = 2.0
    """Smallest error of period and of largest y, in units of the larger error of the two. The two errors fall
    as the squares of the tails and rarely change sign near the same mesh. Without this bound, one cycle in a
    thousand was off by more than the estimate, by up to 4.5 times."""
    planned_error: float = 0.5
    """Error for which a mesh is chosen, in units of the accuracy."""
    fall_by_decay: float = 1.6
    """Decay of errors in space per order, in units of the decay of the coefficients, whose squares the errors
    follow: 1.4 to 2 were measured."""
    min_fall: float = 0.5
    """Smallest decay of errors in space per order, natural logarithm."""
    max_fall: float = 2.2
    """Largest decay of errors in space per order, natural logarithm."""
    power_by_stages: float = 1.5
    """Order in time in units of the stages, where it was not measured."""
    max_power_ratio: float = 2.0
    """Largest measured order in time, in units of the smallest, stages + 1."""
    max_fewer_orders: int = 3
    """Largest decrease of the order on a planned mesh."""
    min_interval_ratio: float = 0.6
    """Smallest ratio of the intervals of a planned mesh and the present mesh."""
    max_more_orders: int = 12
    """Largest increase of the order on a planned mesh: rates are not known further away."""
    max_interval_ratio: int = 4
    """Largest ratio of the intervals, for the same reason."""
    max_reach: float = 0.2
    """Relative change of the parameter beyond which the mesh is calibrated again."""
    max_growth: float = 4.0
    """Growth of the errors beyond which the mesh is calibrated again."""
    min_size_ratio: float = 0.75
    """Size of the orbit, in units of its size at the calibration, below which the mesh is calibrated again.
    Near the Hopf point at which cycles end, the error of the largest y grows fast beyond a change of sign."""
    min_repeated_share: float = 0.5
    """Smallest error of a repeated calibration, in units of the previous error scaled with the tails. Near a
    change of sign an error is small at one cycle, and has the old size three cycles later."""
    min_tail: float = 1e-15
    """Smallest tail of coefficients by which errors are scaled: smaller tails are rounding errors."""


CALIBRATION = CalibrationSettings()
