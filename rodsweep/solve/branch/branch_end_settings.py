"""Settings for the ends of a branch: at a Hopf point, at a symmetry breaking, or at an end of the parameter
range.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchEndSettings:
    """Settings for the ends of a branch at a Hopf point, at a symmetry breaking, or at an end of the
    parameter range."""

    max_last_amplitude: float = 0.06
    """The Hopf point at the end of a branch is extrapolated only from a cycle whose largest tip y, in L, is
    at most this number; otherwise the step is shortened."""
    max_last_asymmetry_per_moment: float = 0.2
    """The symmetric cycle at the end of a branch is extrapolated only from a cycle whose asymmetry, divided
    by its largest bending moment, is at most this number; otherwise the step is shortened."""
    min_asymmetry_per_moment: float = 0.02
    """If the asymmetry, divided by the largest bending moment, is at most this number, the step is not
    shortened: the extrapolation to the symmetric cycle would not improve."""
    lost_asymmetry_ratio: float = 0.1
    """A step has reached or passed a symmetric cycle if the ratio of the asymmetry at its end to the
    asymmetry at its start is less than this number."""
    allowed_asymmetry_ratios: tuple[float, float] = 0.5, 2.0
    """Smallest and largest allowed ratio of the solved to the predicted asymmetry of the first asymmetric
    cycle."""
    extrapolation_tolerance: float = 0.3
    """Tolerance of the extrapolated parameter and period of a Hopf point or a symmetry breaking, divided by
    the difference between their values at the last cycle and at this point."""
    extrapolated_parameter_tolerance: float = 1e-6
    """Relative tolerance of the extrapolated parameter, added to the tolerance by `extrapolation_tolerance`;
    the larger of this number and the accuracy is used."""
    extrapolated_period_tolerance: float = 1e-3
    """Relative tolerance of the extrapolated period, added to the tolerance by `extrapolation_tolerance`; the
    larger of this number and the accuracy is used."""
    range_end_step_tolerance: float = 1e-6
    """Tolerance of the predicted arc length to the end of the parameter range, divided by the step. Newton's
    method then solves the cycle exactly at this end."""
    normal_form_safety_factor: float = 2.0
    """Safety factor on the measured errors of the normal form of a Hopf point, and on the effect of higher
    powers of the distance from this point on them. The measured errors are close to the true ones: without
    the factor on them, the errors of 84 cycles of random rods at ends of ranges reached 0.997 times their
    estimates."""
    relative_parameter_error_at_range_end: float = 1e-15
    """Relative error of the parameter at an end of the range."""
    max_peak_shift_fraction: float = 0.05
    """If the times of the largest tip y of two successive cycles differ by more than this fraction of the
    period, the largest tip y is attained at different maxima of y(t)."""
    max_step_with_corner: float = 0.02
    """Longest last step, in arc length, if the curve of the largest tip y has a corner on this step; a longer
    step is halved."""


BRANCH_END_SETTINGS = BranchEndSettings()


def is_extrapolated_to(
    extrapolated: tuple[float, float], last: tuple[float, float], end: tuple[float, float], accuracy: float
) -> bool:
    """Whether a branch ends at a Hopf point or a symmetry breaking, within tolerances.

    Each point is (parameter coordinate, period): extrapolated along the branch from its last cycle, of this
    cycle, and at the end. accuracy: relative accuracy of the branch.
    """
    settings = BRANCH_END_SETTINGS
    # The extrapolation is exact at the end, where only the errors of the last cycle and of the end remain.
    tolerances = settings.extrapolated_parameter_tolerance, settings.extrapolated_period_tolerance
    return all(
        abs(value - end_value)
        <= settings.extrapolation_tolerance * abs(last_value - end_value)
        + max(tolerance, accuracy) * abs(end_value)
        for value, last_value, end_value, tolerance in zip(extrapolated, last, end, tolerances, strict=True)
    )
