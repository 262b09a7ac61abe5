"""Choice of the mesh for the cycles of a branch, from measured errors.

Errors are measured at every third or fourth cycle (`branch_errors`) and interpolated at the cycles between.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...arrays import Array
from ..cycle.accuracy.newton_tolerances import allowed_distance_from_matrix_orbit
from ..cycle.accuracy.refined_cycle import RefinedCycle
from ..cycle.accuracy.refinement import cycle_with_calibrated_errors
from ..orbit.measures import CycleMotion
from ..orbit.mesh_choice import coarser_regraded_mesh, finer_orbit_mesh
from ..orbit.newton import ConvergedOrbit, nontrivial_multipliers_and_error
from ..orbit.orbit_mesh import OrbitMesh, mesh_limit_error, mesh_of_orbit
from ..unsolvable import MeshLimitReached
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, branch_derivatives, tangent_at
from .bordered.border_condition import BorderCondition
from .bordered.corrected_linearisation import linearisation_of
from .bordered.scale import ArcLengthScale
from .branch_error_measurement import measured_branch_error_calibration, parameter_sensitivities
from .branch_errors import BranchErrorCalibration, branch_newton_tolerance
from .branch_mesh_ahead import expected_error_growth, mesh_for_next_cycles
from .multiplier_sensitivity import MultiplierErrorAmplification
from .settings import BRANCH_MESH_SETTINGS


def first_cycle_with_measured_errors(
    solved: ConvergedOrbit, scale: ArcLengthScale, side: Array, arc_from_start: float, accuracy: float
) -> BranchCycle:
    """The solved orbit `solved` as the first cycle of a branch, with measured errors within the accuracy, on
    another mesh if necessary; raises Unsolvable.

    scale: units of arc length. side: direction of the branch in components (deflection, log period,
    parameter), (3,). arc_from_start: arc length from the Hopf point or other special point where the branch
    starts, in which parameter and largest multiplier change quadratically near the start.
    """
    tangent = tangent_at(solved.orbit, scale, side, linearisation_of(solved))
    derivatives = branch_derivatives(solved, scale, tangent)
    multipliers = nontrivial_multipliers_and_error(solved)[0]
    trivial_error = abs(multipliers[0] - 1) if len(multipliers) else 0.0
    # At the Hopf point the derivative of the parameter is 0 and a second multiplier is 1. Near the Hopf point
    # this derivative is linear, and the multiplier is quadratic, in the deflection.
    derivatives = replace(
        derivatives,
        parameter_second_derivative=derivatives.parameter_per_arc_length / arc_from_start,
        multiplier_change_per_arc_length=2 * trivial_error / arc_from_start,
    )
    calibration = measured_branch_error_calibration(solved, derivatives, accuracy, None)
    cycle = _cycle_with_branch_errors(calibration, solved, accuracy)
    step = ARC_STEP_CONTROL.first_length
    first = BranchCycle(cycle=cycle, derivatives=derivatives, next_step_length=step, calibration=calibration)
    return solve_on_sufficient_mesh(first, accuracy)


def is_error_measurement_due(point: BranchCycle, accuracy: float) -> bool:
    """Whether the errors of the cycle `point` of a branch must be measured: too many steps follow the last
    measured cycle, or the coefficient tails have grown too much since. accuracy: relative accuracy."""
    settings = BRANCH_MESH_SETTINGS
    errors = point.calibration.errors_at_equal_parameter.with_errors_scaled_on_branch(point.orbit)
    growth = float(errors.error_growth_since_measurement.max())
    max_growth = settings.max_error_growth_since_measurement
    # Small errors stay within the accuracy, even if they grow by the largest allowed factor.
    has_small_errors = point.calibration.largest_weighted_error(accuracy) * max_growth <= accuracy
    max_steps = settings.max_steps_between_measurements
    if has_small_errors:
        max_steps = settings.max_unmeasured_steps_if_errors_small
    return point.steps_since_error_measurement >= max_steps or growth > max_growth


def with_measured_errors(point: BranchCycle, accuracy: float) -> BranchCycle:
    """The cycle `point` with its errors measured on two finer meshes; raises Unsolvable. accuracy: relative
    accuracy of the cycle."""
    previous = point.calibration.errors_at_equal_parameter
    solved = point.cycle.converged_orbit
    calibration = measured_branch_error_calibration(solved, point.derivatives, accuracy, previous)
    return with_errors_of_calibration(point, calibration, accuracy)


def with_errors_of_calibration(
    point: BranchCycle, calibration: BranchErrorCalibration, accuracy: float
) -> BranchCycle:
    """The cycle `point` with the errors of `calibration`, measured or interpolated at this cycle. The steps
    and the arc length since the last measurement are set to 0. accuracy: relative accuracy."""
    before = point.cycle
    cycle = _cycle_with_branch_errors(calibration, before.converged_orbit, accuracy, before.motion)
    return replace(
        point,
        cycle=cycle,
        calibration=calibration,
        steps_since_error_measurement=0,
        arc_length_since_error_measurement=0.0,
    )


def _cycle_with_branch_errors(
    calibration: BranchErrorCalibration,
    solved: ConvergedOrbit,
    accuracy: float,
    motion: CycleMotion | None = None,
) -> RefinedCycle:
    """The orbit `solved` as a cycle with the errors of a calibration at this orbit; the error of the period
    is the estimate for a branch, `BranchErrorCalibration.period_error`. accuracy: relative accuracy. motion:
    motion of the orbit, None if not computed yet."""
    cycle = cycle_with_calibrated_errors(calibration.errors_at_equal_parameter, solved, accuracy, motion)
    return replace(cycle, errors=replace(cycle.errors, period_error=calibration.period_error(accuracy)))


def solve_on_sufficient_mesh(
    point: BranchCycle, accuracy: float, condition: BorderCondition | None = None
) -> BranchCycle:
    """The cycle `point` with measured errors within the relative accuracy `accuracy`, on a finer mesh if
    needed; raises Unsolvable if no allowed mesh suffices, or if no cycle is found on a mesh. condition:
    equation that selects the same cycle of the branch on every mesh; by default, that its arc length is
    unchanged."""
    condition = condition or point.arc_length_condition(0.0)
    count = BRANCH_MESH_SETTINGS.max_meshes_per_cycle
    for _ in range(count):
        if point.steps_since_error_measurement:
            point = with_measured_errors(point, accuracy)
        calibration = point.calibration
        if calibration.largest_weighted_error(accuracy) <= accuracy:
            return point
        cheapest = calibration.cheapest_mesh(BRANCH_MESH_SETTINGS.planned_error_per_accuracy * accuracy)
        target = finer_orbit_mesh(calibration.mesh, coarser_regraded_mesh(cheapest, point.orbit))
        if not target.is_allowed:
            raise mesh_limit_error()
        point = solved_on_mesh(point, target, condition, accuracy)
    raise MeshLimitReached(f"none of {count} successively finer meshes reaches the requested accuracy")


def solved_on_mesh(
    point: BranchCycle, mesh: OrbitMesh, condition: BorderCondition, accuracy: float
) -> BranchCycle:
    """The cycle `point` solved on the mesh `mesh`, with errors from its calibration, which belongs to its old
    mesh; raises Unsolvable. condition: equation that selects the same cycle of the branch on every mesh.
    """
    solved = condition.solve_on_mesh(
        mesh,
        point.cycle.converged_orbit,
        branch_newton_tolerance(accuracy),
        allowed_distance_from_matrix_orbit(accuracy),
    )
    tangent = tangent_at(solved.orbit, point.scale, point.unit_tangent, linearisation_of(solved))
    old_derivatives = point.derivatives
    derivatives = replace(
        branch_derivatives(solved, point.scale, tangent),
        parameter_second_derivative=old_derivatives.parameter_second_derivative,
        multiplier_change_per_arc_length=old_derivatives.multiplier_change_per_arc_length,
    )
    return replace(
        point,
        cycle=cycle_with_calibrated_errors(point.calibration.errors_at_equal_parameter, solved, accuracy),
        derivatives=derivatives,
        steps_since_error_measurement=1,
    )


def cycles_with_errors_within_accuracy(
    measured: BranchCycle, points: Sequence[BranchCycle], accuracy: float, condition: BorderCondition | None
) -> list[BranchCycle]:
    """The successive cycles `points` of a branch, all with errors within the accuracy; raises Unsolvable.
    measured: the cycle before `points`, whose errors are measured.

    Errors are measured at the last cycle; at the other cycles they are interpolated. If the last cycle needs
    a finer mesh, it is solved on that mesh, and so is every other cycle whose errors exceed the accuracy.
    condition: equation that selects the same last cycle on all meshes; by default, that its arc length is
    unchanged.
    """
    *between, end = points
    total_length = end.arc_length_since_error_measurement
    end = with_measured_errors(end, accuracy)
    cycles = [
        _with_interpolated_errors(
            measured, point, end, point.arc_length_since_error_measurement / total_length, accuracy
        )
        for point in between
    ]
    growth = expected_error_growth(measured, points, end)
    # Solved again only after the interpolation, because the interpolated errors belong to the old mesh.
    end = solve_on_sufficient_mesh(end, accuracy, condition)
    end = replace(end, next_mesh=mesh_for_next_cycles(end, growth, accuracy))
    solved_again = [
        point
        if point.calibration.largest_weighted_error(accuracy) <= accuracy
        else _cycle_on_mesh_of(end, point, accuracy)
        for point in cycles
    ]
    return [*solved_again, end]


def _cycle_on_mesh_of(end: BranchCycle, point: BranchCycle, accuracy: float) -> BranchCycle:
    """The cycle `point`, whose estimated errors exceed the accuracy, solved again on the mesh of the later
    cycle `end`, with the errors of `end`. If both cycles have the same mesh, or if the errors of `end` are
    too large, the errors of `point` itself are measured and determine its mesh. Raises Unsolvable."""
    if mesh_of_orbit(end.orbit) == mesh_of_orbit(point.orbit):
        return solve_on_sufficient_mesh(point, accuracy)
    solved = solved_on_mesh(point, mesh_of_orbit(end.orbit), point.arc_length_condition(0.0), accuracy)
    # With the fraction 1 the errors are the errors of `end`, because the cycle now has the mesh of `end`.
    estimated = _with_interpolated_errors(end, solved, end, 1.0, accuracy)
    is_accurate = estimated.calibration.largest_weighted_error(accuracy) <= accuracy
    return estimated if is_accurate else solve_on_sufficient_mesh(solved, accuracy)


def _with_interpolated_errors(
    start: BranchCycle, point: BranchCycle, end: BranchCycle, fraction: float, accuracy: float
) -> BranchCycle:
    """The cycle `point`, which lies between the measured cycles `start` and `end`, with interpolated errors;
    `end` has the mesh of `point`. Raises Unsolvable.

    fraction: fraction of the arc length from `start` to `end` at which `point` lies. accuracy: relative
    accuracy. If `start` has another mesh, the errors of `end` are used. If the coefficient tails of `point`
    are much larger than at `start` and `end`, the interpolated errors are multiplied by the growth of the
    squared tails. The errors of `point` are measured instead if this growth is large, or if the parameter
    changes more slowly along the branch than at `start` and `end`, as near a fold.
    """
    # Errors are interpolated only between cycles on one mesh.
    if mesh_of_orbit(start.orbit) != mesh_of_orbit(point.orbit):
        start = end
        fraction = 1.0
    growth = np.array(
        [
            measured.calibration.errors_at_equal_parameter.with_errors_scaled_on_branch(
                point.orbit
            ).error_growth_since_measurement
            for measured in (start, end)
        ]
    ).min(axis=0)
    # Near a fold, errors at equal parameter grow with 1/rate; interpolation over a long step misses this.
    is_slow = abs(
        point.parameter_per_arc_length
    ) < BRANCH_MESH_SETTINGS.min_slope_ratio_for_interpolation * min(
        abs(measured.parameter_per_arc_length) for measured in (start, end)
    )
    if is_slow or growth.max() > BRANCH_MESH_SETTINGS.max_error_growth_since_measurement:
        return with_measured_errors(point, accuracy)
    calibration = start.calibration.interpolate(
        end.calibration,
        fraction,
        parameter_sensitivities(point.cycle.motion, point.derivatives),
        MultiplierErrorAmplification.of_cycle(point.cycle.converged_orbit),
    )
    if growth.max() > BRANCH_MESH_SETTINGS.max_uncorrected_tail_growth:
        calibration = calibration.with_grown_errors(growth)
    interpolated = with_errors_of_calibration(point, calibration, accuracy)
    return replace(interpolated, steps_since_error_measurement=point.steps_since_error_measurement)
