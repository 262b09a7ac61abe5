"""Ends of a branch of cycles at a Hopf point or at a symmetry breaking.

Beyond such a point the branch continues through the mirror images of its cycles.
"""

from dataclasses import replace

from ..orbit.orbit_mesh import mesh_of_orbit
from ..unsolvable import Unsolvable
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, arc_length_between
from .bordered.scale import deflection_at_time_zero
from .branch_curve import BranchEnd
from .branch_limits import BranchLimits
from .branch_record import branch_end_point
from .range_end import index_of_passed_range_end
from .range_end_near_hopf import (
    end_at_range_end_near_hopf,
    expected_errors_of_solved_cycle,
    has_accurate_range_end,
)
from .settings import BRANCH_END_SETTINGS
from .start.hopf_point import HopfBranchStart, hopf_as_special_point
from .start.neighbouring_hopf_points import min_last_amplitude
from .status import BranchEndReason
from .symmetry_breaking import (
    ends_within_extrapolation_tolerances,
    reaches_symmetric_cycle,
    symmetry_breaking_index_between,
)


def passes_hopf_point(start: BranchCycle, end: BranchCycle) -> bool:
    """Whether a Hopf point lies between the cycles `start` and `end`: the bending moments at t = 0 then have
    opposite signs. The sign of the tip's y is not a criterion: on a large cycle an extremum of y may pass
    through 0."""
    mesh = mesh_of_orbit(end.orbit)
    layout = end.orbit.form.layout
    # Moments can be multiplied only at the same nodes.
    start_moment = layout.stress_field(mesh.interpolated_orbit(start.orbit).start_state, "m3")
    return float(start_moment @ layout.stress_field(end.orbit.start_state, "m3")) < 0


def end_or_shorter_step_at_mirror_image(
    start: BranchCycle, end: BranchCycle, limits: BranchLimits
) -> BranchCycle | BranchEnd | None:
    """The end of a branch that reaches its mirror image between the cycles `start` and `end`: at a Hopf point
    (symmetric cycles) or at a symmetric cycle (asymmetric cycles). If `start` is too far from this point for
    an extrapolation, the result is `start` with half the step. The end is a failure if no known Hopf point or
    symmetry breaking is near. None if the branch does not reach its mirror image. Raises Unsolvable if no
    shorter step is allowed."""
    if start.orbit.is_symmetric:
        return _end_at_hopf_or_shorter_step(start, end, limits) if passes_hopf_point(start, end) else None
    if reaches_symmetric_cycle(start, end, limits.breakings, limits.accuracy):
        return _end_at_breaking_or_shorter_step(start, end, limits)
    return None


def accurate_end_before_hopf(start: BranchCycle, end: BranchCycle, limits: BranchLimits) -> BranchEnd | None:
    """The end of a branch that leaves the range between the cycles `start` and `end`, and shrinks to a Hopf
    point just beyond the range. The cycle at the end of the range follows from the normal form of this Hopf
    point. None unless the normal form is accurate at the end of the range and a cycle solved there would not
    be accurate."""
    index = index_of_passed_range_end(end, limits.coordinate_range)
    is_large = start.cycle.measures.tip_y_max > BRANCH_END_SETTINGS.max_amplitude_before_extrapolation
    if index < 0 or is_large or not start.orbit.is_symmetric:
        return None
    range_end = limits.coordinate_range[index]
    for hopf in limits.hopfs_beyond_range:
        if _shrinks_to_hopf_point(start, hopf, limits.accuracy) and not _has_fold_before_hopf_end(
            start, hopf, limits
        ):
            solved_errors = expected_errors_of_solved_cycle(start, range_end, hopf)
            branch_end = end_at_range_end_near_hopf(start, hopf, limits)
            is_accurate = has_accurate_range_end(branch_end, start, hopf, limits)
            return branch_end if is_accurate and max(solved_errors) > limits.accuracy else None
    return None


def _end_at_hopf_or_shorter_step(
    start: BranchCycle, end: BranchCycle, limits: BranchLimits
) -> BranchCycle | BranchEnd:
    """The end of a branch of cycles that shrink to a Hopf point between `start` and `end`: at this Hopf
    point, at the end of the range before it, or a failure if no known Hopf point is near. If `start` is too
    large for an extrapolation, the result is `start` with half the step. Raises Unsolvable."""
    half_length = arc_length_between(start, end) / 2
    shorter = (
        replace(start, next_step_length=half_length) if half_length >= ARC_STEP_CONTROL.min_length else None
    )
    if start.cycle.measures.tip_y_max > BRANCH_END_SETTINGS.max_amplitude_before_extrapolation:
        if shorter is None:
            raise Unsolvable(
                "the branch jumps to its mirror image, and no shorter step along the branch is allowed"
            )
        return shorter
    if (known_end := _known_hopf_end_or_shorter_step(start, shorter, limits)) is not None:
        return known_end
    if shorter is not None and not _is_smallest_to_solve(start, limits):
        return shorter  # the parabola through a smaller cycle is closer to the Hopf point
    reason = "the cycles shrink to zero amplitude, but no Hopf point is known there"
    return BranchEnd(branch_end_point(start, BranchEndReason.no_cycle_found, reason), is_complete=False)


def _known_hopf_end_or_shorter_step(
    start: BranchCycle, shorter: BranchCycle | None, limits: BranchLimits
) -> BranchCycle | BranchEnd | None:
    """The end of a branch at the known Hopf point to which its last cycle `start` leads, or at the end of the
    range before this point; `shorter` if `start` is not near enough; None if `start` leads to no known Hopf
    point. shorter: `start` with a shorter step, or None if no shorter step is allowed."""
    for number, hopf in enumerate(limits.hopfs):
        if _shrinks_to_hopf_point(start, hopf, limits.accuracy):
            # The parameter must still turn before the Hopf point, which a smaller cycle shows.
            if _has_fold_before_hopf_end(start, hopf, limits) and shorter is not None:
                return shorter
            return BranchEnd(hopf_as_special_point(hopf), is_complete=True, end_hopf_index=number)
    # Then the branch ends at the end of the range, which lies before the Hopf point.
    for hopf in limits.hopfs_beyond_range:
        if _shrinks_to_hopf_point(start, hopf, limits.accuracy):
            end_before_hopf = end_at_range_end_near_hopf(start, hopf, limits)
            is_final = _is_smallest_to_solve(start, limits) or has_accurate_range_end(
                end_before_hopf, start, hopf, limits
            )
            if shorter is not None and (_has_fold_before_hopf_end(start, hopf, limits) or not is_final):
                return shorter
            if end_before_hopf is not None:
                return end_before_hopf
    return None


def _shrinks_to_hopf_point(start: BranchCycle, hopf: HopfBranchStart, accuracy: float) -> bool:
    """Whether the branch at the cycle `start`, extrapolated to zero deflection, ends at the Hopf point
    `hopf`: parameter and period are parabolas in the deflection. accuracy: relative accuracy of the
    branch."""
    # Near a Hopf point parameter and period are quadratic in the deflection. From d to 0 the parabola
    # p = p0 + k d^2 changes by half as much as its tangent at d.
    length = deflection_at_time_zero(start.orbit) / (2 * start.unit_tangent[0] * start.scale.deflection_unit)
    coordinate = start.parameter_coordinate - length * start.tangent[-1]
    period = start.orbit.period - length * start.tangent[-2]
    return ends_within_extrapolation_tolerances(
        (coordinate, period),
        (start.parameter_coordinate, start.orbit.period),
        (hopf.parameter_coordinate, hopf.period),
        accuracy,
    )


def _has_fold_before_hopf_end(start: BranchCycle, hopf: HopfBranchStart, limits: BranchLimits) -> bool:
    """Whether a branch has a fold between the cycle `start` and its end at the Hopf point `hopf`: at `start`
    the parameter moves away from the Hopf point, to the side on which small cycles exist by the normal form.
    False for a cycle of the smallest amplitude, before which no fold is sought."""
    return (
        not _is_smallest_to_solve(start, limits)
        and start.parameter_per_arc_length * hopf.parameter_direction > 0
    )


def _is_smallest_to_solve(cycle: BranchCycle, limits: BranchLimits) -> bool:
    """Whether a cycle is so small that no smaller cycle is solved before a Hopf point."""
    return cycle.cycle.measures.tip_y_max <= min_last_amplitude(limits.all_hopfs)


def _end_at_breaking_or_shorter_step(
    start: BranchCycle, end: BranchCycle, limits: BranchLimits
) -> BranchCycle | BranchEnd:
    """The end of an asymmetric branch at a symmetry breaking between `start` and `end`; a failure if no known
    symmetry breaking is near. If `start` is too asymmetric, the result is `start` with half the step. Raises
    Unsolvable."""
    index = symmetry_breaking_index_between(start, end, limits.breakings, limits.accuracy)
    if index is None:
        return replace(start, next_step_length=arc_length_between(start, end) / 2)
    if index >= 0:
        breaking = limits.breakings[index]
        # The message and the orbit belong to the point on the symmetric branch, where they are stored.
        special = replace(breaking.special_point, message="", orbit=None)
        return BranchEnd(special, is_complete=True, end_breaking=breaking)
    message = "the cycles become symmetric, but no symmetry breaking is known there"
    return BranchEnd(branch_end_point(start, BranchEndReason.no_cycle_found, message), is_complete=False)
