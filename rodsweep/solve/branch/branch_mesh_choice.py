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
from ..orbit.mesh_choice import finer_mesh
from ..orbit.newton import ConvergedOrbit, multipliers_and_trivial_error
from ..orbit.orbit_mesh import OrbitMesh, mesh_limit, mesh_of
from ..unsolvable import MeshLimitReached
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, branch_derivatives, tangent_at
from .bordered.condition import BorderCondition
from .bordered.matrix import bordered_matrix_of
from .bordered.scale import ArcLengthScale
from .branch_error_measurement import measured_branch_calibration, tip_y_sensitivity
from .branch_errors import BranchCalibration


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchMeshSettings:
    """Settings for the choice of meshes on a branch, and of the cycles whose errors are measured."""

    max_meshes: int = 8
    """Maximum number of meshes tried for one cycle."""
    max_cheaper_cost_ratio: float = 0.5
    """A sufficient mesh is replaced by a cheaper mesh only if the ratio of the new cost to the present cost
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
    found: ConvergedOrbit, scale: ArcLengthScale, side: Array, arc_from_start: float, accuracy: float
) -> BranchCycle:
    """The solved orbit `found` as the first cycle of a branch, with measured errors within the accuracy, on
    another mesh if necessary; raises Unsolvable.

    scale: units of arc length. side: direction of the branch in components (deflection, log period,
    parameter), (3,). arc_from_start: arc length from the special point where the branch starts; parameter and
    multipliers are quadratic in this arc length.
    """
    derivatives = branch_derivatives(
        found, scale, tangent_at(found.orbit, scale, side, bordered_matrix_of(found))
    )
    multipliers = multipliers_and_trivial_error(found)[0]
    lost = abs(multipliers[0] - 1) if len(multipliers) else 0.0
    # At the Hopf point the derivative of the parameter is 0 and a second multiplier is 1. Near the Hopf point
    # this derivative is linear, and the multiplier is quadratic, in the deflection.
    derivatives = replace(
        derivatives,
        parameter_curvature=derivatives.parameter_rate / arc_from_start,
        multiplier_rate=2 * lost / arc_from_start,
    )
    calibration = measured_branch_calibration(found, derivatives, accuracy, None)
    cycle = cycle_with_calibrated_errors(calibration.at_equal_parameter, found, accuracy)
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
    before = point.calibration.at_equal_parameter
    return with_calibration(
        point,
        measured_branch_calibration(point.cycle.converged_orbit, point.derivatives, accuracy, before),
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
        known = point.calibration
        enough = known.largest_weighted_error(accuracy) <= accuracy
        planned = known.cheapest_mesh(BRANCH_MESH_SETTINGS.planned_error_ratio * accuracy)
        # A sufficient mesh is replaced only by a much cheaper mesh, and never after an insufficient mesh.
        if enough and (
            finest or planned.cost > BRANCH_MESH_SETTINGS.max_cheaper_cost_ratio * known.mesh.cost
        ):
            return point
        if not enough:
            finest = True
            planned = finer_mesh(known.mesh, planned)
        if not planned.is_allowed:
            raise mesh_limit()
        point = solved_on_mesh(point, planned, condition, accuracy)
    raise MeshLimitReached(
        f"none of {BRANCH_MESH_SETTINGS.max_meshes} finer and finer meshes reaches the requested accuracy"
    )


def solved_on_mesh(
    point: BranchCycle, mesh: OrbitMesh, condition: BorderCondition, accuracy: float
) -> BranchCycle:
    """The cycle `point` solved on the mesh `mesh` to a relative accuracy; its errors are estimated from the
    calibration of `point`. Raises Unsolvable. condition: equation that defines the same cycle on every mesh.
    """
    found = condition.solve_on_mesh(
        mesh, point.cycle.converged_orbit, newton_tolerance(accuracy), allowed_matrix_distance(accuracy)
    )
    tangent = tangent_at(found.orbit, point.scale, point.unit_tangent, bordered_matrix_of(found))
    known = point.derivatives
    derivatives = replace(
        branch_derivatives(found, point.scale, tangent),
        parameter_curvature=known.parameter_curvature,
        multiplier_rate=known.multiplier_rate,
    )
    return replace(
        point,
        cycle=cycle_with_calibrated_errors(point.calibration.at_equal_parameter, found, accuracy),
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
    whole = end.arc_since_measured
    end = with_measured_errors(end, accuracy)
    known = [
        _with_interpolated_errors(measured, point, end, point.arc_since_measured / whole, accuracy)
        for point in between
    ]
    # Only after the interpolation, because the interpolated errors belong to the old mesh.
    end = solve_on_sufficient_mesh(end, accuracy, condition)
    again = [
        point
        if point.calibration.largest_weighted_error(accuracy) <= accuracy
        else _cycle_on_mesh_of(end, point, accuracy)
        for point in known
    ]
    return [*again, end]


def _cycle_on_mesh_of(end: BranchCycle, point: BranchCycle, accuracy: float) -> BranchCycle:
    """The cycle `point` solved again on the mesh of the later cycle `end`, with the errors of `end`, and on a
    sufficient mesh if these errors are too large; raises Unsolvable."""
    solved = solved_on_mesh(point, mesh_of(end.orbit), point.arc_length_condition(0.0), accuracy)
    # With share 1 the errors are the errors of `end`, because the cycle now has the mesh of `end`.
    solved = _with_interpolated_errors(end, solved, end, 1.0, accuracy)
    return solve_on_sufficient_mesh(solved, accuracy)


def _with_interpolated_errors(
    last: BranchCycle, point: BranchCycle, end: BranchCycle, share: float, accuracy: float
) -> BranchCycle:
    """The cycle `point` with errors interpolated between the measured cycles `last` and `end`, all on the
    same mesh; raises Unsolvable.

    share: fraction of the arc length from `last` to `end` at which `point` lies. accuracy: relative accuracy
    of the cycles. The errors of `point` are measured instead if its coefficient tails are much larger than at
    `last` and `end`, or if the parameter changes more slowly than at `last` and `end`, as near a fold: the
    errors at `last` and `end` are then no bound.
    """
    ends = (last, end)
    slow = abs(point.parameter_rate) < BRANCH_MESH_SETTINGS.min_parameter_rate_ratio * min(
        abs(one.parameter_rate) for one in ends
    )
    grown = min(
        one.calibration.at_equal_parameter.scaled_on_branch(point.orbit).error_growth.max() for one in ends
    )
    if slow or float(grown) > BRANCH_MESH_SETTINGS.max_tail_growth:
        return with_measured_errors(point, accuracy)
    known = last.calibration.interpolate(
        end.calibration, share, tip_y_sensitivity(point.cycle.path, point.derivatives)
    )
    return with_calibration(point, known, accuracy)
