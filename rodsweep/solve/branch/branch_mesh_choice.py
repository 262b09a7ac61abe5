"""Choice of the mesh for the cycles of a branch, from measured errors.

Errors are measured at about every third cycle (`branch_errors`) and interpolated at the cycles between.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from ...arrays import Array
from ..cycle.accuracy.refinement import (
    allowed_matrix_distance,
    cycle_with_calibrated_errors,
    newton_tolerance,
)
from ..orbit.mesh_choice import finer_mesh, regraded
from ..orbit.newton import ConvergedOrbit, multipliers_and_trivial_error
from ..orbit.orbit_mesh import OrbitMesh, mesh_limit_error, mesh_of
from ..unsolvable import MeshLimitReached
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, branch_derivatives, tangent_at
from .bordered.condition import BorderCondition
from .bordered.matrix import bordered_matrix_of
from .bordered.scale import ArcLengthScale
from .branch_error_measurement import measured_branch_calibration, relative_tip_y_sensitivity
from .branch_errors import BranchCalibration


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchMeshSettings:
    """Settings for the choice of meshes on a branch, and of the cycles whose errors are measured."""

    max_meshes: int = 8
    """Maximum number of meshes tried for one cycle."""
    max_cheaper_cost_ratio: float = 0.5
    """A sufficient mesh is replaced by a cheaper mesh only if the ratio of the new cost to the current cost
    is at most this number."""
    planned_error_ratio: float = 0.5
    """Error for which a mesh is chosen, divided by the accuracy; below 1, so that the mesh suffices for the
    next cycles too."""
    min_parameter_rate_ratio: float = 0.7
    """Errors are interpolated at a cycle only if |d(parameter)/ds|, s: arc length, is at least this number
    times the smaller of the two values at the measured cycles. Near a fold the derivative tends to 0, and
    errors measured away from the fold are no bound."""
    max_tail_growth: float = 2.0
    """Errors are measured, not interpolated, if the coefficient tails predict that the errors have grown by
    more than this factor since each of the two measured cycles."""
    max_steps_between_measurements: int = 3
    """Maximum number of steps between two cycles with measured errors."""
    max_growth_since_measurement: float = 4.0
    """Errors are measured again if the coefficient tails predict that the errors have grown by more than this
    factor since the last measurement."""


BRANCH_MESH_SETTINGS = BranchMeshSettings()


def first_measured_cycle(
    solved: ConvergedOrbit, scale: ArcLengthScale, side: Array, arc_from_start: float, accuracy: float
) -> BranchCycle:
    """The solved orbit `solved` as the first cycle of a branch, with measured errors within the accuracy, on
    another mesh if necessary; raises Unsolvable.

    scale: units of arc length. side: direction of the branch in components (deflection, log period,
    parameter), (3,). arc_from_start: arc length from the special point where the branch starts; parameter and
    multipliers are quadratic in this arc length.
    """
    derivatives = branch_derivatives(
        solved, scale, tangent_at(solved.orbit, scale, side, bordered_matrix_of(solved))
    )
    multipliers = multipliers_and_trivial_error(solved)[0]
    trivial_error = abs(multipliers[0] - 1) if len(multipliers) else 0.0
    # At the Hopf point the derivative of the parameter is 0 and a second multiplier is 1. Near the Hopf point
    # this derivative is linear, and the multiplier is quadratic, in the deflection.
    derivatives = replace(
        derivatives,
        parameter_second_derivative=derivatives.parameter_rate / arc_from_start,
        multiplier_rate=2 * trivial_error / arc_from_start,
    )
    calibration = measured_branch_calibration(solved, derivatives, accuracy, None)
    cycle = cycle_with_calibrated_errors(calibration.at_equal_parameter, solved, accuracy)
    return solve_on_sufficient_mesh(
        BranchCycle(
            cycle=cycle,
            derivatives=derivatives,
            next_arc_length=ARC_STEP_CONTROL.first_length,
            calibration=calibration,
        ),
        accuracy,
    )


def is_measurement_due(point: BranchCycle) -> bool:
    """Whether the errors of a cycle must be measured: the last measured cycle is too many steps away, or the
    errors have grown too much since that cycle."""
    growth = float(point.calibration.at_equal_parameter.scaled_on_branch(point.orbit).error_growth.max())
    return (
        point.steps_since_measured >= BRANCH_MESH_SETTINGS.max_steps_between_measurements
        or growth > BRANCH_MESH_SETTINGS.max_growth_since_measurement
    )


def with_measured_errors(point: BranchCycle, accuracy: float) -> BranchCycle:
    """The cycle `point` with its errors measured on two finer meshes; raises Unsolvable. accuracy: relative
    accuracy of the cycle."""
    previous = point.calibration.at_equal_parameter
    return with_calibration(
        point,
        measured_branch_calibration(point.cycle.converged_orbit, point.derivatives, accuracy, previous),
        accuracy,
    )


def with_calibration(point: BranchCycle, calibration: BranchCalibration, accuracy: float) -> BranchCycle:
    """The cycle `point`, solved to a relative accuracy, with the errors of `calibration`, which was measured
    or interpolated at this cycle. In the result the number of unmeasured steps is 0."""
    present = point.cycle
    cycle = cycle_with_calibrated_errors(
        calibration.at_equal_parameter, present.converged_orbit, accuracy, present.path
    )
    return replace(
        point, cycle=cycle, calibration=calibration, steps_since_measured=0, arc_since_measured=0.0
    )


def solve_on_sufficient_mesh(
    point: BranchCycle, accuracy: float, condition: BorderCondition | None = None
) -> BranchCycle:
    """The cycle `point` with measured errors within the relative accuracy, on a mesh chosen for this
    accuracy; raises Unsolvable if no allowed mesh suffices, or if no cycle is found on a mesh. A sufficient
    mesh is replaced only by a much cheaper mesh. condition: equation that defines the same cycle on every
    mesh; by default the condition that its arc length is unchanged."""
    condition = condition or point.arc_length_condition(0.0)
    finest = False
    for _ in range(BRANCH_MESH_SETTINGS.max_meshes):
        if point.steps_since_measured:
            point = with_measured_errors(point, accuracy)
        calibration = point.calibration
        is_accurate = calibration.largest_weighted_error(accuracy) <= accuracy
        cheapest = calibration.cheapest_mesh(BRANCH_MESH_SETTINGS.planned_error_ratio * accuracy)
        target = regraded(cheapest, point.orbit)
        # A sufficient mesh is replaced only by a much cheaper mesh, and never after an insufficient mesh.
        if is_accurate and (
            finest or target.cost > BRANCH_MESH_SETTINGS.max_cheaper_cost_ratio * calibration.mesh.cost
        ):
            return point
        if not is_accurate:
            finest = True
            target = finer_mesh(calibration.mesh, target)
        if not target.is_allowed:
            raise mesh_limit_error()
        point = solved_on_mesh(point, target, condition, accuracy)
    raise MeshLimitReached(
        f"none of {BRANCH_MESH_SETTINGS.max_meshes} finer and finer meshes reaches the requested accuracy"
    )


def solved_on_mesh(
    point: BranchCycle, mesh: OrbitMesh, condition: BorderCondition, accuracy: float
) -> BranchCycle:
    """The cycle `point` solved on the mesh `mesh` to a relative accuracy; its errors are estimated from the
    calibration of `point`. Raises Unsolvable. condition: equation that defines the same cycle on every mesh.
    """
    solved = condition.solve_on_mesh(
        mesh, point.cycle.converged_orbit, newton_tolerance(accuracy), allowed_matrix_distance(accuracy)
    )
    tangent = tangent_at(solved.orbit, point.scale, point.unit_tangent, bordered_matrix_of(solved))
    old_derivatives = point.derivatives
    derivatives = replace(
        branch_derivatives(solved, point.scale, tangent),
        parameter_second_derivative=old_derivatives.parameter_second_derivative,
        multiplier_rate=old_derivatives.multiplier_rate,
    )
    return replace(
        point,
        cycle=cycle_with_calibrated_errors(point.calibration.at_equal_parameter, solved, accuracy),
        derivatives=derivatives,
        steps_since_measured=1,
    )


def with_errors_within_accuracy(
    measured: BranchCycle, points: Sequence[BranchCycle], accuracy: float, condition: BorderCondition | None
) -> list[BranchCycle]:
    """The cycles `points` of a branch, all with errors within the accuracy; raises Unsolvable. measured: the
    cycle before `points`, whose errors were measured.

    Errors are measured at the last cycle of `points`, and interpolated at the other cycles between `measured`
    and this cycle. A cycle that is too inaccurate is solved again on the mesh of the last cycle. condition:
    equation that defines the last cycle on every mesh; by default the condition that its arc length is
    unchanged.
    """
    *between, end = points
    total_length = end.arc_since_measured
    end = with_measured_errors(end, accuracy)
    cycles = [
        _with_interpolated_errors(measured, point, end, point.arc_since_measured / total_length, accuracy)
        for point in between
    ]
    # Only after the interpolation, because the interpolated errors belong to the old mesh.
    end = solve_on_sufficient_mesh(end, accuracy, condition)
    solved_again = [
        point
        if point.calibration.largest_weighted_error(accuracy) <= accuracy
        else _cycle_on_mesh_of(end, point, accuracy)
        for point in cycles
    ]
    return [*solved_again, end]


def _cycle_on_mesh_of(end: BranchCycle, point: BranchCycle, accuracy: float) -> BranchCycle:
    """The cycle `point` solved again on the mesh of the later cycle `end`, with the errors of `end`, and on a
    sufficient mesh if these errors are too large; raises Unsolvable."""
    solved = solved_on_mesh(point, mesh_of(end.orbit), point.arc_length_condition(0.0), accuracy)
    # With share 1 the errors are the errors of `end`, because the cycle now has the mesh of `end`.
    solved = _with_interpolated_errors(end, solved, end, 1.0, accuracy)
    return solve_on_sufficient_mesh(solved, accuracy)


def _with_interpolated_errors(
    start: BranchCycle, point: BranchCycle, end: BranchCycle, fraction: float, accuracy: float
) -> BranchCycle:
    """The cycle `point` with errors interpolated between the measured cycles `start` and `end`, all on the
    same mesh; raises Unsolvable.

    fraction: fraction of the arc length from `start` to `end` at which `point` lies. accuracy: relative
    accuracy of the cycles. The errors of `point` are measured instead if its coefficient tails are much
    larger than at `start` and `end`, or if the parameter changes more slowly than at `start` and `end`, as
    near a fold: the errors at `start` and `end` are then no bound.
    """
    ends = (start, end)
    is_slow = abs(point.parameter_rate) < BRANCH_MESH_SETTINGS.min_parameter_rate_ratio * min(
        abs(measured.parameter_rate) for measured in ends
    )
    error_growth = min(
        measured.calibration.at_equal_parameter.scaled_on_branch(point.orbit).error_growth.max()
        for measured in ends
    )
    if is_slow or float(error_growth) > BRANCH_MESH_SETTINGS.max_tail_growth:
        return with_measured_errors(point, accuracy)
    calibration = start.calibration.interpolate(
        end.calibration, fraction, relative_tip_y_sensitivity(point.cycle.path, point.derivatives)
    )
    return with_calibration(point, calibration, accuracy)
