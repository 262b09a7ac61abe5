"""Branches of cycles that no Hopf point within the range leads to: closed branches, and branches whose ends
lie outside the range.

Such a branch is followed from a fold or torus point, which lies on a curve of special points through other
rods. The branch is followed in one direction from a cycle just before this point, through the point itself,
and then, unless it is closed, from the same cycle in the other direction.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Array
from ..cycle.accuracy.newton_tolerances import allowed_distance_from_matrix_orbit
from ..orbit.mesh_choice import cheapest_stage_count, mesh_from_coefficient_tails
from ..orbit.newton import relative_change
from ..orbit.orbit import Orbit
from ..unsolvable import Unsolvable, WorkLimitReached
from .arc_length_step import BranchCycle, tangent_at
from .bordered.border_condition import BorderCondition, moved_orbit
from .bordered.matrix import BorderedMatrix
from .bordered.scale import ArcLengthScale, deflection_at_time_zero
from .branch_continuation import follow_from_cycle
from .branch_curve import BranchCurve
from .branch_errors import branch_newton_tolerance
from .branch_limits import BranchLimits
from .branch_mesh_choice import first_cycle_with_measured_errors
from .settings import BRANCH_START_SETTINGS
from .special.special_point import SpecialPoint, SpecialPointKind
from .start.first_asymmetric_cycle import ASYMMETRIC_START_SETTINGS
from .start.first_cycle import DEFLECTION_UNIT_VECTOR


@dataclass(frozen=True, slots=True, kw_only=True)
class DetachedBranchSettings:
    """Settings for the first cycle of a detached branch."""

    first_cycle_arc_lengths: tuple[float, ...] = (0.02, 0.005, 0.001, 2e-4)
    """Arc lengths of the first cycle from the known special point, tried in this order: 0.02 is the first
    step length on all branches, and a small closed branch needs a shorter step."""
    max_prediction_error_per_step_length: float = 0.5
    """Largest difference between the first cycle and its prediction on the tangent at the special point,
    divided by the length of the step from this point to the cycle. If the difference is larger, the branch
    turns by about a right angle on the step, and the cycle may lie beyond another fold."""
    successive_accuracy_ratio: float = 0.01
    """Ratio of a relative accuracy to the previous one, tried if the previous accuracy gave no complete
    branch through the point: a mesh displaces a small closed branch, or a fold near an end of the range, by
    about the accuracy.
    """
    finest_accuracy: float = 1e-10
    """Smallest relative accuracy tried; special points are located to 1e-9."""


DETACHED_BRANCH_SETTINGS = DetachedBranchSettings()


def follow_detached_branch(start: SpecialPoint, name: str, limits: BranchLimits) -> BranchCurve:
    """The branch along the parameter `name` through the special point `start`, whose orbit need not be
    accurate, in both directions to its ends; raises Unsolvable if no cycle is found beside `start`. A later
    failure is stored in an end of the branch. The branch found may be another branch, which does not pass
    through `start`."""
    if start.orbit is None:
        raise Unsolvable(start.message or "the cycle of the special point is not known")
    if not start.orbit.is_symmetric:
        limits = replace(limits, accuracy=min(limits.accuracy, ASYMMETRIC_START_SETTINGS.max_accuracy))
    return follow_in_both_directions(_first_cycle_before_special_point(start.orbit, name, limits), limits)


def complete_branch_through(
    start: SpecialPoint, name: str, limits: BranchLimits, is_known: Callable[[BranchCurve], bool]
) -> BranchCurve | None:
    """The complete branch through `start`, found by `follow_detached_branch`, at a higher accuracy if
    necessary; an incomplete branch if no accuracy gives a complete one. None if `is_known`, a function of the
    branch found, returns True. Raises Unsolvable if no branch is found. If `start` is a fold, or if
    `limits.locates_special_points`, also raises Unsolvable if the branch found does not pass `start`."""
    must_pass_start = limits.locates_special_points or start.kind == SpecialPointKind.fold
    incomplete: BranchCurve | None = None
    reason: Unsolvable | None = None
    accuracy = limits.accuracy
    # The accuracy asked for is tried in any case, even below `finest_accuracy`.
    while accuracy == limits.accuracy or accuracy >= DETACHED_BRANCH_SETTINGS.finest_accuracy:
        try:
            curve = follow_detached_branch(start, name, replace(limits, accuracy=accuracy))
        except WorkLimitReached:
            raise
        except Unsolvable as error:
            # The first failure, at the accuracy asked for, is the one to report.
            reason = reason or error
        else:
            if is_known(curve):
                return None
            if not must_pass_start or lies_on_a_branch(start, [curve]):
                if curve.is_complete or curve.reached_max_cycles:
                    return curve
                incomplete = incomplete or curve
        accuracy *= DETACHED_BRANCH_SETTINGS.successive_accuracy_ratio
    if incomplete is None:
        raise reason or Unsolvable("the branch found does not pass this point")
    return incomplete


def follow_in_both_directions(first_cycle: BranchCycle, limits: BranchLimits) -> BranchCurve:
    """The branch through the cycle `first_cycle`, which has measured errors, to its ends in both
    directions."""
    curve = follow_from_cycle(BranchCurve(start_hopf_index=-1), first_cycle, limits)
    if not curve.is_closed:
        # The first cycle is part of both directions but counts once.
        remaining_limits = replace(limits, max_cycles=limits.max_cycles - len(curve.stored_cycles) + 1)
        backward_curve = follow_from_cycle(
            BranchCurve(start_hopf_index=-1),
            cycle_in_opposite_branch_direction(first_cycle),
            remaining_limits,
        )
        curve = backward_curve.joined_with_forward_branch(curve)
    return curve


def lies_on_a_branch(special: SpecialPoint, curves: Iterable[BranchCurve]) -> bool:
    """Whether one of the branches `curves` has the special point `special`."""
    return any(special.is_same_as(other) for curve in curves for other in curve.special_points)


def _first_cycle_before_special_point(orbit: Orbit, name: str, limits: BranchLimits) -> BranchCycle:
    """A cycle just before the special point with the orbit `orbit`, as the first cycle of a branch that leads
    through this point; raises Unsolvable."""
    tangent = _tangent_towards_larger_cycles(orbit, name, limits)
    reason: Unsolvable | None = None
    for distance in DETACHED_BRANCH_SETTINGS.first_cycle_arc_lengths:
        try:
            return _cycle_behind_orbit(tangent, distance, limits)
        except WorkLimitReached:
            raise
        except Unsolvable as error:
            reason = error
    raise Unsolvable(f"no cycle is solved near this point: {reason}") from reason


@dataclass(frozen=True, eq=False, slots=True)
class _Tangent:
    """Tangent of a branch at the orbit `orbit` with unit arc length in the units of `scale`.
    orbit_and_parameter_change: change of orbit values and parameter coordinate, (N + 1,). components: this
    change in components (deflection, log period, parameter), (3,)."""

    orbit: Orbit
    scale: ArcLengthScale
    orbit_and_parameter_change: Array
    components: Array


def _tangent_towards_larger_cycles(orbit: Orbit, name: str, limits: BranchLimits) -> _Tangent:
    """Tangent of a branch along the parameter `name` towards larger deflections, at `orbit`, which is first
    interpolated to a mesh for the accuracy of the branch."""
    mesh = mesh_from_coefficient_tails(orbit, limits.accuracy, cheapest_stage_count(limits.accuracy))
    orbit = mesh.interpolated_orbit(orbit)
    tip_y = abs(float(orbit.form.tip_coordinates(orbit.start_state)[1]))
    # The unit is given as a tip deflection; this ratio converts it to the deflection of the arc length.
    min_deflection_unit = (
        abs(deflection_at_time_zero(orbit)) * BRANCH_START_SETTINGS.amplitude_of_min_deflection_unit / tip_y
    )
    scale = ArcLengthScale.at_orbit(orbit, name, min_deflection_unit, limits.min_coordinate_unit)
    tangent = tangent_at(orbit, scale, DEFLECTION_UNIT_VECTOR, BorderedMatrix(orbit, scale, limits.workspace))
    derivative = scale.directional_derivative(orbit, tangent)
    tangent_length = float(np.linalg.norm(derivative))
    return _Tangent(orbit, scale, tangent / tangent_length, derivative / tangent_length)


def _cycle_behind_orbit(tangent: _Tangent, distance: float, limits: BranchLimits) -> BranchCycle:
    """The cycle of a branch at the arc length `distance` from the orbit of `tangent`, in the direction
    opposite to `tangent`, with measured errors; raises Unsolvable."""
    accuracy = limits.accuracy
    condition = BorderCondition.at_arc_length(tangent.scale, tangent.components, tangent.orbit, -distance)
    predicted = moved_orbit(
        tangent.orbit, tangent.scale.parameter_name, -distance * tangent.orbit_and_parameter_change
    )
    solved_orbit = condition.solve_cycle(
        predicted,
        branch_newton_tolerance(accuracy),
        limits.workspace,
        allowed_distance_from_matrix_orbit(accuracy),
    )
    step_size = relative_change(tangent.orbit, distance * tangent.orbit_and_parameter_change[:-1])
    prediction_error = relative_change(predicted, solved_orbit.orbit.values - predicted.values)
    # Newton's method may have jumped to another branch.
    if prediction_error > DETACHED_BRANCH_SETTINGS.max_prediction_error_per_step_length * step_size:
        raise Unsolvable("the cycle found is far from its prediction")
    low, high = limits.coordinate_range
    if not low < solved_orbit.orbit.form.rod.coordinate(tangent.scale.parameter_name) < high:
        raise Unsolvable("the cycle found lies outside the range")
    return first_cycle_with_measured_errors(
        solved_orbit, tangent.scale, tangent.components, distance, accuracy
    )


def cycle_in_opposite_branch_direction(cycle: BranchCycle) -> BranchCycle:
    """The cycle `cycle` of a branch, with its tangents reversed for the continuation in the opposite
    direction."""
    derivatives = cycle.derivatives
    turned_derivatives = replace(
        derivatives, tangent=-derivatives.tangent, unit_tangent=-derivatives.unit_tangent
    )
    return replace(cycle, derivatives=turned_derivatives)
