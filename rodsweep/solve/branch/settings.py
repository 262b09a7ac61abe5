"""Settings for branches of cycles."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchStartSettings:
    """Settings for the first cycle of a branch near its Hopf point."""

    first_amplitudes: tuple[float, ...] = (0.02, 0.008, 0.003)
    """Amplitudes (largest tip y, in L) of the first cycle, tried in this order."""
    max_amplitude_per_amplitude_coefficient: float = 0.05
    """Upper limit of the amplitude of the first cycle, divided by
    |`HopfBranchStart.amplitude_coefficient`|. At larger amplitudes the third-order normal form is too
    inaccurate."""
    max_first_to_largest_amplitude_ratio: float = 0.5
    """Upper limit of the amplitude of the first cycle on a branch between two Hopf points close together,
    divided by the largest amplitude on this branch: the parameter then changes by a fifteenth of the distance
    between both points."""
    last_cycle_amplitude_per_half_axis: float = 0.2
    """The amplitudes of the cycles between two Hopf points close together form an ellipse or a hyperbola over
    the parameter. The last cycle of a branch is moved towards its Hopf point, down to this fraction of the
    semi-axis of this curve in the direction of the amplitude. There the square-root law of one Hopf point
    alone misses the parameter by 4 % of the distance from the Hopf point."""
    amplitude_of_min_deflection_unit: float = 0.1
    """The unit of deflection of an `ArcLengthScale` is at least the deflection that a cycle of this amplitude
    (largest tip y, in L) has by linear theory."""
    allowed_amplitude_to_prediction_ratios: tuple[float, float] = 0.5, 2.0
    """Smallest and largest allowed ratio of the solved amplitude of the first cycle to the amplitude
    predicted by the normal form."""
    min_amplitude_before_fold: float = 5e-4
    """If the branch has a fold between its Hopf point and its first cycle, the first cycle is moved towards
    the Hopf point, down to this amplitude (largest tip y, in L); likewise the last cycle of a branch that
    ends at a Hopf point."""
    max_nondegenerate_amplitude_coefficient: float = 3.0
    """Largest amplitude coefficient |a| of a Hopf point, in L, that does not affect the accuracy of the
    cycles. A larger |a| means that a generalised Hopf point is close; a coarse mesh then displaces folds, or
    has folds that the rod does not have."""
    max_accuracy_if_degenerate: float = 5e-7
    """Largest relative accuracy of the cycles of a rod with a Hopf point whose amplitude coefficient a has
    the modulus `max_nondegenerate_amplitude_coefficient`. For larger |a| the largest accuracy is proportional
    to 1/a^2, like the distance of the fold from the Hopf point."""
    finest_accuracy_if_degenerate: float = 1e-8
    """Lower limit of the accuracy that is required because of a large amplitude coefficient |a| of the Hopf
    point. With this limit, for ten rods at distances of 1e-7 to 1e-3 from a generalised Hopf point, no false
    fold was found, and all folds farther than 1e-11 F from the Hopf point were found."""
    landau_coefficient_accuracies: tuple[float, ...] = (1e-8, 1e-3)
    """Relative accuracies of the Landau coefficient of a Hopf point, tried in this order. The accuracy 1e-8
    costs as much as 1e-3 (1.9 s for 88 Hopf points of random rods); if the mesh for 1e-8 misses the
    eigenvalue, the mesh for 1e-3 may identify it."""
    relative_frequency_rounding_error: float = 1e-14
    """Relative rounding error of the frequency at a Hopf point, which is computed as a root of the
    determinant D."""


BRANCH_START_SETTINGS = BranchStartSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchErrorSettings:
    """Settings for the error estimates of the cycles of a branch."""

    max_tip_y_sensitivity: float = 120.0
    """Limit of the sensitivity |(p/y) dy/dp| of the largest tip y to the parameter p. At larger
    sensitivities, as near a Hopf point or a fold, the allowed errors at equal p are larger than the accuracy
    by the factor sensitivity/limit. This number is a fifth above the documented limit, because a user
    estimates the sensitivity from cycles."""
    min_deflection_per_parameter_change: float = 0.1
    """The parameter error at equal deflection is the distance between the branches on two meshes, divided by
    |d(deflection)/ds|, s: arc length. The divisor is at least this number times |d(parameter)/ds|; otherwise
    the error would be infinite where the deflection is stationary."""
    interpolation_safety_factor: float = 2.0
    """Safety factor on interpolated errors."""
    min_error_for_logarithm: float = 1e-16
    """Lower limit of an error before its logarithm is taken; smaller errors are rounding errors."""
    max_error_ratio_for_interpolation: float = 30.0
    """Largest ratio of two measured errors between which errors are interpolated. If the ratio is larger, the
    smaller error is small only because errors change their sign near its cycle, and is raised to the larger
    error divided by this ratio."""
    newton_tolerance_per_accuracy: float = 1e-4
    """Tolerance of Newton's method for a cycle of a branch, also on the two finer meshes of an error
    measurement, divided by the accuracy. At equal parameter, a cycle within this tolerance may have an error
    of the tolerance divided by |d(parameter)/ds|, s: arc length, which is large near a fold or a Hopf point.
    With a ratio of 0.01, measured errors were mostly of this kind."""
    min_newton_tolerance: float = 1e-11
    """Lower limit of the tolerance of Newton's method along a branch, because cycles of strongly unstable
    branches have larger rounding errors. If a cycle that is solved alone with the same accuracy has a smaller
    tolerance, the smaller tolerance is used."""
    min_slope_for_equal_parameter_near_zero: float = 0.1
    """Close to the parameter coordinate 0, cycles on finer meshes are solved at an equal parameter, not at an
    equal arc length, if the modulus of the derivative of the scaled parameter coordinate with respect to arc
    length exceeds this number, as it does far from a fold."""
    sensitivity_arc_length: float = 1e-4
    """Arc length of the difference quotient for the sensitivity of the largest tip y."""


BRANCH_ERROR_SETTINGS = BranchErrorSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchMeshSettings:
    """Settings for the choice of meshes on a branch, and of the cycles whose errors are measured."""

    max_meshes_per_cycle: int = 8
    """Maximum number of meshes tried for one cycle."""
    max_cost_ratio_of_cheaper_mesh: float = 0.7
    """A mesh that is expected to suffice is replaced by a cheaper mesh only if the ratio of the new cost to
    the current cost is at most this number."""
    planned_error_per_accuracy: float = 0.5
    """Error for which a mesh is chosen, divided by the accuracy; below 1, so that the mesh suffices for the
    next cycles too."""
    planned_error_per_accuracy_if_cheaper: float = 0.25
    """Predicted error, divided by the accuracy, up to which a cheaper mesh may replace a sufficient mesh: a
    mesh that turns out not to suffice costs several solutions."""
    min_slope_ratio_for_interpolation: float = 0.2
    """Errors are interpolated at a cycle only if |d(parameter)/ds|, s: arc length, is at least this number
    times the smaller of the two values at the measured cycles. Near a fold the derivative tends to 0, and
    errors measured far from the fold are not a bound."""
    max_uncorrected_tail_growth: float = 2.0
    """Interpolated errors are multiplied by the growth that the coefficient tails predict if this growth
    exceeds this factor since each of the two measured cycles. If the growth exceeds
    `max_error_growth_since_measurement`, the errors are measured."""
    max_steps_between_measurements: int = 3
    """Maximum number of steps between two cycles with measured errors."""
    max_unmeasured_steps_if_errors_small: int = 4
    """Maximum number of steps between two cycles with measured errors if the last measured errors are so
    small that they stay within the accuracy when they grow by `max_error_growth_since_measurement`. With 6 or
    8 steps errors that change their sign between two measured cycles exceeded their estimates, by up to 4
    times."""
    max_planned_error_growth: float = 4.0
    """A mesh is chosen for the errors expected at the next cycle whose errors are measured. The growth factor
    of the errors up to this cycle is limited to this number."""
    max_error_growth_since_measurement: float = 4.0
    """Errors are measured again if the coefficient tails predict that the errors have grown by more than this
    factor since the last measurement."""


BRANCH_MESH_SETTINGS = BranchMeshSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchEndSettings:
    """Settings for the ends of a branch at a Hopf point, at a symmetry breaking, or at an end of the
    parameter range."""

    max_amplitude_before_extrapolation: float = 0.06
    """The Hopf point at the end of a branch is extrapolated only from a cycle whose largest tip y, in L, is
    at most this number; otherwise the step is shortened."""
    max_asymmetry_before_extrapolation: float = 0.2
    """The symmetric cycle at the end of a branch is extrapolated only from a cycle whose asymmetry, divided
    by its largest bending moment, is at most this number; otherwise the step is shortened."""
    min_asymmetry_per_moment: float = 0.02
    """If the asymmetry, divided by the largest bending moment, is at most this number, the step is not
    shortened: a shorter step would not improve the extrapolation to the symmetric cycle."""
    lost_asymmetry_ratio: float = 0.1
    """A step has reached or passed a symmetric cycle if the ratio of the asymmetry at the end of the step to
    the asymmetry at its start is less than this number."""
    allowed_asymmetry_to_prediction_ratios: tuple[float, float] = 0.5, 2.0
    """Smallest and largest allowed ratio of the solved to the predicted asymmetry of the first asymmetric
    cycle."""
    relative_extrapolation_tolerance: float = 0.3
    """Tolerance of the extrapolated parameter and period of a Hopf point or a symmetry breaking, divided by
    the difference between their values at the last cycle and at this point."""
    extrapolated_parameter_tolerance: float = 1e-6
    """Relative tolerance of the extrapolated parameter, added to the tolerance by
    `relative_extrapolation_tolerance`; the larger of this number and the accuracy is used."""
    extrapolated_period_tolerance: float = 1e-3
    """Relative tolerance of the extrapolated period, added to the tolerance by
    `relative_extrapolation_tolerance`; the larger of this number and the accuracy is used."""
    range_end_step_tolerance: float = 1e-6
    """Tolerance of the predicted arc length to the end of the parameter range, divided by the step. Newton's
    method then solves the cycle exactly at this end."""
    normal_form_safety_factor: float = 2.0
    """The deviation of a Hopf point's normal form at the end of a range is extrapolated linearly from cycles
    near the Hopf point. This is the safety factor on the part due to higher powers of the distance from the
    Hopf point. The errors of the cycles themselves enter without a factor: the errors at the ends of ranges
    of 84 cycles of random rods reached 0.997 times their estimates."""
    relative_parameter_error_at_range_end: float = 1e-15
    """Relative error of the parameter at an end of the range."""
    max_peak_shift_in_periods: float = 0.05
    """If the times of the largest tip y of two successive cycles differ by more than this fraction of the
    period, the largest tip y is attained at different maxima of y(t)."""
    max_step_with_amplitude_corner: float = 0.02
    """Longest last step, in arc length, if the curve of the largest tip y has a corner on this step; a longer
    step is halved."""


BRANCH_END_SETTINGS = BranchEndSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class BeyondRangeSettings:
    """Settings for the continuation of branches beyond the range."""

    extent_over_largest_coordinate: float = 0.5
    """Branches are followed up to (1 + this number) times the largest coordinate of the range and down to its
    smallest coordinate divided by (1 + this number); along F down to 0, because there is no cycle without
    force."""
    max_cycles: int = 200
    """Maximum number of cycles on all branches beyond one end of the range."""
    work_limit_per_work_within_range: float = 1.0
    """Limit of the work beyond one end of the range, divided by the work on the branches within the range."""
    min_work_limit: float = 100.0
    """Smallest limit of the work beyond one end of the range, in `MULTIPLICATIONS_PER_WORK_UNIT`: some
    seconds, ten times the work on a usual branch. It applies to a range without a Hopf point, which has no
    branches of its own."""
    min_asymmetric_work_limit: float = 400.0
    """Smallest limit of the work on the branches of asymmetric cycles beyond one end of the range, in
    `MULTIPLICATIONS_PER_WORK_UNIT`: their cycles are solved over the whole period, more accurately beside a
    fold."""


BEYOND_RANGE_SETTINGS = BeyondRangeSettings()
