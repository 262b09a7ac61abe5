"""Ends of a branch of cycles at a Hopf point or at a symmetry breaking.

Beyond such a point the branch continues through the mirror images of its cycles.
"""

from dataclasses import replace

from ..orbit.orbit_mesh import mesh_of
from ..unsolvable import Unsolvable
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, arc_length_between
from .bordered.scale import deflection_of
from .branch_curve import BranchEnd
from .branch_end_reason import BranchEndReason
from .branch_end_settings import BRANCH_END_SETTINGS
from .branch_limits import BranchLimits
from .branch_record import branch_end_point
from .start.branch_start_settings import BRANCH_START_SETTINGS
from .start.hopf_point import HopfBranchStart, hopf_as_special_point
from .symmetry_breaking import reaches_symmetric_cycle, symmetry_breaking_between


def reaches_mirror_image(start: BranchCycle, end: BranchCycle, limits: BranchLimits) -> bool:
    """Whether a branch reaches its mirror image between two cycles: at a Hopf point or a symmetric cycle."""
    if start.orbit.is_symmetric:
        return passes_hopf_point(start, end)
    return reaches_symmetric_cycle(start, end, limits.breakings, limits.accuracy)


def passes_hopf_point(start: BranchCycle, end: BranchCycle) -> bool:
    """Whether a Hopf point lies between two cycles: the bending moments at t = 0 then have opposite signs.
    The sign of the tip's y is no criterion: on a large cycle an extremum of y may pass through 0."""
    mesh = mesh_of(end.orbit)
    layout = end.orbit.form.layout
    start_moment = layout.stress_field(mesh.interpolated_orbit(start.orbit).start_state, "m3")
    return float(start_moment @ layout.stress_field(end.orbit.start_state, "m3")) < 0


def end_at_mirror_image(
    start: BranchCycle, end: BranchCycle, limits: BranchLimits
) -> BranchCycle | BranchEnd:
    """The end of a branch that reaches its mirror image between two cycles (a failure if no known Hopf point
    or symmetry breaking is near), or `start` with half the step, if `start` is too far from this end. Raises
    Unsolvable if no shorter step is allowed."""
    return (_end_at_hopf if start.orbit.is_symmetric else _end_at_breaking)(start, end, limits)


def _end_at_hopf(start: BranchCycle, end: BranchCycle, limits: BranchLimits) -> BranchCycle | BranchEnd:
    """The end of a branch at a Hopf point between two cycles (a failure if no known Hopf point is near), or
    `start` with half the step, if `start` is too large for an extrapolation. Raises Unsolvable."""
    half_length = arc_length_between(start, end) / 2
    if start.cycle.measures.tip_y_max > BRANCH_END_SETTINGS.max_last_amplitude:
        if half_length < ARC_STEP_CONTROL.min_length:
            raise Unsolvable("two cycles of opposite sign follow each other at the shortest allowed step")
        return replace(start, next_arc_length=half_length)
    # Near a Hopf point parameter and period are quadratic in the deflection.
    tangent = start.tangent
    # From d to 0 the parabola p = p0 + k d^2 changes by half as much as its tangent at d.
    length = deflection_of(start.orbit) / (2 * start.unit_tangent[0] * start.scale.deflection_unit)
    coordinate = start.parameter_coordinate - length * tangent[-1]
    period = start.orbit.period - length * tangent[-2]
    rounding = max(BRANCH_END_SETTINGS.parameter_tolerance, limits.accuracy)
    for number, hopf in enumerate(limits.hopfs):
        tolerance = BRANCH_END_SETTINGS.extrapolation_tolerance * abs(
            start.parameter_coordinate - hopf.parameter_coordinate
        ) + rounding * abs(hopf.parameter_coordinate)
        period_tolerance = BRANCH_END_SETTINGS.extrapolation_tolerance * abs(start.orbit.period - hopf.period)
        period_tolerance += BRANCH_END_SETTINGS.period_tolerance * hopf.period
        if (
            abs(coordinate - hopf.parameter_coordinate) <= tolerance
            and abs(period - hopf.period) <= period_tolerance
        ):
            if _has_fold_ahead(start, hopf) and half_length >= ARC_STEP_CONTROL.min_length:
                return replace(start, next_arc_length=half_length)
            return BranchEnd(hopf_as_special_point(hopf), complete=True, end_hopf=number)
    reason = "the cycles shrink to zero amplitude, but no Hopf point is known there"
    return BranchEnd(branch_end_point(start, BranchEndReason.no_cycle_found, reason), complete=False)


def _has_fold_ahead(start: BranchCycle, hopf: HopfBranchStart) -> bool:
    """Whether a branch has a fold between the cycle `start` and the Hopf point `hopf` where it ends: the
    parameter at `start` moves in the direction in which, by the normal form, it leaves the Hopf point. False
    for a cycle of the smallest amplitude, before which no fold is sought."""
    is_small = start.cycle.measures.tip_y_max <= BRANCH_START_SETTINGS.min_amplitude_before_fold
    return not is_small and start.parameter_rate * hopf.direction > 0


def _end_at_breaking(start: BranchCycle, end: BranchCycle, limits: BranchLimits) -> BranchCycle | BranchEnd:
    """The end of an asymmetric branch at a symmetry breaking (a failure if no known symmetry breaking is
    near), or `start` with half the step, if `start` is too asymmetric. Raises Unsolvable."""
    index = symmetry_breaking_between(start, end, limits.breakings, limits.accuracy)
    if index is None:
        return replace(start, next_arc_length=arc_length_between(start, end) / 2)
    if index >= 0:
        breaking = limits.breakings[index]
        special = replace(breaking.special_point, message="", orbit=None)
        return BranchEnd(special, complete=True, end_breaking=breaking)
    reason = "the cycles become symmetric, but no symmetry breaking is known there"
    return BranchEnd(branch_end_point(start, BranchEndReason.no_cycle_found, reason), complete=False)
