"""Settings for the accuracy of a cycle."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshErrorCalibrationSettings:
    """Settings for the calibration of a mesh: safety factors on measured errors, convergence rates, reuse at
    later cycles, and limits of planned meshes."""

    error_safety_factor: float = 3.0
    """Safety factor on measured errors of period, extrema and multiplier."""
    min_largest_y_error_over_path_distance: float = 0.16
    """Lower limit of the error estimate of the largest y, divided by the largest distance between the tip's
    paths on two meshes with different elements: two values of y may agree by coincidence, two paths do
    not."""
    min_period_error_over_path_distance: float = 0.16
    """Lower limit of the error estimate of the period, divided by the largest distance between the tip's
    paths on two meshes with different elements."""
    min_extrema_error_over_path_distance: float = 1.6
    """Lower limit of the error estimate of the tip's extrema other than the largest y, divided by the sum of
    two distances between the tip's paths: for different elements, and for different time intervals."""
    min_error_over_tip_path_distance: float = 0.004
    """This factor times the distance between the tip's paths for different time intervals is added to the
    lower limits of the error estimates of period and largest y. The distance is largest in theta, whose
    errors matter least."""
    extrema_error_per_last_harmonics: float = 10.0
    """Increase of the error estimate of the tip's extrema other than the largest y along a chain, divided by
    the increase of the last three harmonics of the tip's path. The factor bounds the sum of all harmonics
    that are cut off, of which the next three are the largest. Without this increase the error of a cycle was
    1.25 times its estimate (`test_errors_of_extrema_grow_with_the_last_harmonics`), and in 140 random chains
    at most half."""
    min_error_per_larger_error: float = 2.0
    """Lower limit of the error estimates of period and of largest y, divided by the larger of the two
    measured errors. The two errors decrease as the squared coefficient tails, and rarely change sign near the
    same mesh. Without this limit, the error of one cycle in a thousand exceeded its estimate, by a factor of
    up to 4.5."""
    planned_error_per_accuracy: float = 0.5
    """A mesh is planned so that the predicted errors of period and largest y are at most this fraction of the
    accuracy."""
    planned_extrema_error_over_tolerance: float = 0.75
    """A mesh is planned so that the predicted error of the tip's extrema other than the largest y is at most
    this fraction of its tolerance. The fraction is larger than for period and largest y, because this error
    changes less along a chain: it contains the distance between the tip's paths."""
    error_to_coefficient_decay_ratio: float = 1.6
    """Assumed decrease of ln(error) in space per order, divided by the decrease of ln(coefficient) per order.
    The errors are proportional to squared coefficients; ratios from 1.4 to 2 were measured."""
    min_log_space_error_decay_per_order: float = 0.5
    """Lower limit of an assumed or measured decrease of ln(error) in space per order."""
    max_log_space_error_decay_per_order: float = 2.2
    """Upper limit of an assumed or measured decrease of ln(error) in space per order."""
    time_order_per_stage: float = 1.5
    """Order of convergence in time divided by the number of stages, assumed if no order was measured."""
    max_time_order_per_smallest_order: float = 2.0
    """Upper limit of a measured order of convergence in time, divided by stages + 1, the order for stiff
    problems."""
    max_element_order_decrease: int = 3
    """Largest decrease of the order of the elements from the current mesh to a planned mesh."""
    min_planned_over_current_intervals: float = 0.6
    """Smallest number of time intervals of a planned mesh, divided by that of the current mesh."""
    max_element_order_increase: int = 12
    """Largest increase of the order of the elements from the current mesh to a planned mesh; the convergence
    rates are not known for finer meshes."""
    max_time_interval_count_ratio: int = 4
    """Upper limit of the ratio of the numbers of time intervals, planned mesh to current mesh; the
    convergence rates are not known for finer meshes."""
    max_relative_parameter_change: float = 0.2
    """The errors are measured again if the relative changes of the parameter along the chain since the last
    measurement add up to more than this number."""
    max_error_growth: float = 4.0
    """The errors are measured again if an error has grown by more than this factor since the measurement."""
    min_orbit_size_ratio: float = 0.75
    """The errors are measured again if (size of the orbit)/(size of the measured orbit) is less than this
    number. Near the Hopf point where the cycles end, the error of the largest y may change sign and then grow
    fast."""
    min_remeasured_error_ratio: float = 0.5
    """Lower limit of an error that is newly measured on the same mesh, divided by the previous error scaled
    with the tails. An error that changes its sign along a chain is small at one cycle, and three cycles later
    as large as before."""
    min_tail_over_largest_element_tail: float = 1e-3
    """Errors are scaled with the coefficient tail of each element, or with this fraction of the largest tail
    of all elements if the tail is smaller. A smaller element may determine the errors: in a mesh of two
    elements, the one with 0.07 times the largest tail did, and the errors grew four times as much as the
    squared largest tail."""
    min_coefficient_tail: float = 1e-15
    """Lower limit of the coefficient tails by which errors are scaled; smaller tails are rounding errors."""


MESH_ERROR_CALIBRATION_SETTINGS = MeshErrorCalibrationSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class RefinementSettings:
    """Settings for meshes, tolerances and matrices of a cycle of a requested accuracy."""

    newton_tolerance_per_accuracy: float = 1e-2
    """Relative tolerance of Newton's method for a cycle, divided by the requested accuracy."""
    min_newton_tolerance: float = 1e-13
    """Smallest relative tolerance of Newton's method for a cycle: some hundred rounding errors."""
    accuracy_divisor_if_stability_undecided: float = 100.0
    """A cycle whose largest nontrivial multiplier has modulus 1 within its error is solved again with the
    accuracy divided by this number."""
    max_matrix_distance_over_accuracy: float = 3.0
    """Largest relative distance between a cycle and the orbit whose matrix gives its multipliers, divided by
    the accuracy."""
    min_distance_from_matrix_orbit: float = 1e-7
    """Lower limit of the relative distance that is allowed between a cycle and the orbit at which the matrix
    with its multipliers was assembled: multipliers need no more digits."""
    max_distance_from_matrix_orbit: float = 1e-5
    """Upper limit of the relative distance that is allowed between a cycle and the orbit at which the matrix
    with its multipliers was assembled."""
    multiplier_error_per_matrix_distance: float = 10.0
    """Relative error of the multipliers divided by the sum of two numbers: the relative distance between the
    cycle and the orbit at which the matrix was assembled, and the error of the trivial multiplier."""
    finest_accuracy_for_mesh_choice: float = 1e-12
    """Smallest relative accuracy for which a mesh is chosen; smaller errors are rounding errors."""
    min_first_mesh_accuracy: float = 1e-7
    """Smallest relative accuracy for which a first mesh is chosen from the coefficient tails of a nearby
    orbit."""
    nearby_orbit_newton_tolerance: float = 1e-3
    """Relative tolerance of Newton's method for the nearby orbit whose coefficient tails determine the first
    mesh."""
    accuracy_factor_after_mesh_without_cycle: float = 1e-3
    """If a mesh is so coarse that Newton's method finds no cycle on it, the next mesh is chosen for the
    requested accuracy times this factor."""
    max_mesh_cost_after_mesh_without_cycle: float = 1e8
    """After a mesh without a cycle, a finer mesh is tried only if (number of time intervals) (number of
    unknowns)^3 of this mesh is at most this number. Cycles near a Hopf point need fewer than 20 intervals and
    150 unknowns; without this limit, a motion that never repeats costs a minute."""
    first_mesh_accuracy_ratio: float = 0.5
    """Accuracy for which the first mesh of a single cycle is chosen, divided by the requested accuracy: a
    second mesh costs more than a finer first mesh."""
    min_time_intervals_for_prediction: int = 6
    """Smallest number of time intervals of a fine mesh whose cycle coarser meshes predict. With 5 intervals,
    the coarser meshes would have 4 and 5 intervals, where errors in time do not decrease as a power yet: the
    error of the largest y was four times its estimate."""
    max_prediction_distance_per_accuracy: float = 30.0
    """Predicted errors are accepted if the relative distance of a cycle from its prediction by coarser
    meshes, divided by the accuracy, is at most this number; the largest observed ratio was 4.4."""
    always_accepted_prediction_distance: float = 1e-9
    """Predicted errors are always accepted if the relative distance of a cycle from its prediction is at most
    this number: rounding errors may cause such a distance."""
    min_solved_to_start_size_ratio: float = 0.2
    """Smallest ratio of the size of a solved orbit to the size of the orbit from which Newton's method
    started, sizes in the energy norm; a smaller orbit is a different motion."""
    max_solved_to_start_size_ratio: float = 5.0
    """Largest ratio of the size of a solved orbit to the size of the orbit from which Newton's method
    started; a larger orbit is a different motion."""
    max_error_increase_on_finer_mesh: float = 10.0
    """Refinement ends if the error estimate increases by more than this factor from a mesh to a finer mesh;
    a smaller increase may be a coincidence."""
    max_meshes_per_cycle: int = 8
    """Maximum number of meshes tried for one cycle."""


REFINEMENT_SETTINGS = RefinementSettings()
