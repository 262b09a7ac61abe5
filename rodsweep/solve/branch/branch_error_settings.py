"""Settings for the error estimates of the cycles of a branch (`branch_errors`)."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchErrorSettings:
    """Settings for the error estimates of the cycles of a branch."""

    max_tip_y_sensitivity: float = 120.0
    """Limit of the sensitivity |(p/y) dy/dp| of the largest tip y to the parameter p. At larger
    sensitivities, as near a Hopf point or a fold, the allowed errors at equal p are larger than the accuracy
    by the factor sensitivity/limit. A fifth above the documented limit, because a user estimates the
    sensitivity from cycles."""
    min_deflection_rate_ratio: float = 0.1
    """Lower limit of |d(deflection)/ds| in the parameter error at equal deflection, divided by
    |d(parameter)/ds|, s: arc length. Without this limit the error would be infinite where the deflection is
    stationary."""
    interpolation_safety_factor: float = 2.0
    """Safety factor on interpolated errors."""
    min_error: float = 1e-16
    """Lower limit of an error before its logarithm is taken; smaller errors are rounding errors."""
    max_error_ratio: float = 30.0
    """Largest ratio of two measured errors between which errors are interpolated. If the ratio is larger, the
    smaller error is small only because errors change their sign near its cycle, and is replaced."""
    newton_tolerance_ratio: float = 1e-4
    """Tolerance of Newton's method for a cycle of a branch, also on the two finer meshes of an error
    measurement, divided by the accuracy. Near a fold or a Hopf point this tolerance over the derivative of
    the parameter is an error at equal parameter, and with 0.01 measured errors were mostly of this kind."""
    min_newton_tolerance: float = 1e-11
    """Lower limit of this tolerance, unless a single cycle of the same accuracy has a smaller one: cycles of
    strongly unstable branches have larger rounding errors."""
    min_rate_near_zero_parameter: float = 0.1
    """Close to the parameter coordinate 0, cycles on finer meshes are solved at an equal parameter, not at an
    equal arc length, if the modulus of the derivative of the scaled parameter coordinate with respect to arc
    length exceeds this number, far from a fold."""
    sensitivity_arc_length: float = 1e-4
    """Arc length of the difference quotient for the sensitivity of the largest tip y."""


BRANCH_ERROR_SETTINGS = BranchErrorSettings()
