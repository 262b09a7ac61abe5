"""Continuation of one branch of cycles, from a Hopf point or a symmetry breaking to the end of the branch."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import nan

from ...model.parameters import PARAMETERS
from ...solve_progress import SolvePosition, report
from ...wording import counted
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.orbit_mesh import mesh_of
from ..unsolvable import Unsolvable
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, arc_length_between, cycle_at_length, next_cycle
from .bordered.scale import deflection_of
from .branch_curve import BranchCurve, BranchEnd
from .branch_record import BranchRecord, branch_end_point, reason_of_failure
from .branch_start import HopfBranchStart, first_cycle, hopf_as_special_point
from .computing_time import fraction_done
from .mesh_choice import is_measurement_due
from .range_end import cycle_within_range, range_end_condition
from .special.detection import special_points_between
from .special.least_stretch import least_stretch_of_cycle
from .special.locating import special_point_between
from .special.special_point import EndReason, SpecialKind, SpecialPoint
from .symmetry import (
    BRANCH_END_SETTINGS,
    SymmetryBreaking,
    first_asymmetric_cycle,
    reaches_symmetric_cycle,
    symmetry_breaking_between,
)


@dataclass(frozen=True, slots=True)
class BranchLimits:
    """Range, number of cycles, and possible ends of branches of a rod; relative accuracy of the cycles."""

    hopfs: Sequence[HopfBranchStart]
    """Hopf points of the rod within the range."""
    coordinate_range: tuple[float, float]
    """Smallest and largest coordinate of the continuation parameter, at which branches end."""
    end_reasons: tuple[EndReason, EndReason]
    """Reasons for the end of a branch at the smallest and at the largest coordinate."""
    accuracy: float
    max_cycles: int
    """Maximum number of cycles of one branch."""
    workspace: NewtonWorkspace
    """Memory of Newton's matrices."""
    breakings: Sequence[SymmetryBreaking] = ()
    """Symmetry breakings found so far on the branches of the rod."""


def follow_branch(number: int, limits: BranchLimits) -> BranchCurve:
    """The branch from the Hopf point `limits.hopfs[number]`; the last special point stores a failure."""
    hopf = limits.hopfs[number]
    curve = BranchCurve(start_hopf=number)
    curve.add_special_point(hopf_as_special_point(hopf))
    return _follow_to_end(curve, limits, lambda: first_cycle(hopf, limits.accuracy, limits.workspace))


def follow_asymmetric_branch(which: int, name: str, limits: BranchLimits) -> BranchCurve:
    """The branch of asymmetric cycles along the parameter `name` from the symmetry breaking
    `limits.breakings[which]`; a failure is stored in the last special point."""
    breaking = limits.breakings[which]
    curve = BranchCurve(start_hopf=-1, start_breaking=breaking)
    curve.add_special_point(replace(breaking.special_point, message="", orbit=None))

    def first() -> BranchCycle:
        return first_asymmetric_cycle(breaking, name, limits.accuracy, limits.workspace)

    return _follow_to_end(curve, limits, first)


def _follow_to_end(curve: BranchCurve, limits: BranchLimits, first: Callable[[], BranchCycle]) -> BranchCurve:
    """The branch `curve`, which has only its first special point, followed to its end. first: function that
    solves the first cycle."""
    if limits.max_cycles < 1:
        curve.end(BranchEnd(_end_without_cycle(curve, EndReason.list_full), complete=False, list_full=True))
        return curve
    try:
        start = first()
    except Unsolvable as why:
        curve.end(BranchEnd(_end_without_cycle(curve, reason_of_failure(why), str(why)), complete=False))
        return curve
    outside = _index_of_passed_range_end(start, limits)
    if outside >= 0:
        curve.end(BranchEnd(_end_without_cycle(curve, limits.end_reasons[outside]), complete=True))
        return curve
    return follow_from_cycle(curve, start, limits)


def follow_from_cycle(curve: BranchCurve, first: BranchCycle, limits: BranchLimits) -> BranchCurve:
    """The branch `curve`, followed to its end from its first cycle `first`, which has measured errors."""
    trail = BranchRecord(curve, limits.accuracy, first)
    going: BranchCycle | BranchEnd = first
    while isinstance(going, BranchCycle):
        report(partial(_branch_progress, curve, going, limits))
        going = _append_next_cycle(trail, going, limits)
    trail.end(going)
    return curve


def _branch_progress(curve: BranchCurve, start: BranchCycle, limits: BranchLimits) -> SolvePosition:
    """Progress along a branch: text with the parameter at the last cycle `start`, and fraction of work."""
    name = start.scale.parameter_name
    # The end of the range towards which the parameter moves at present.
    aim = limits.coordinate_range[1 if start.unit_tangent[-1] > 0 else 0]
    value = PARAMETERS[name].value(start.parameter_coordinate)
    aim_value = PARAMETERS[name].value(aim)
    words = f"{name} = {value:.5g} on the way to {aim_value:.5g}, {counted(len(curve.points), 'cycle')}"
    return SolvePosition(
        words,
        fraction_done(
            PARAMETERS[name].coordinate(curve.special_points[0].at), start.parameter_coordinate, aim
        ),
    )


def _end_without_cycle(curve: BranchCurve, reason: EndReason, message: str = "") -> SpecialPoint:
    """The end of a branch without cycles, at its first special point. message: cause of a failure."""
    born = curve.special_points[0]
    return replace(
        born,
        kind=SpecialKind.end,
        reason=reason,
        message=message,
        amplitude_coefficient=nan,
        coefficient_error=nan,
    )


def _index_of_passed_range_end(point: BranchCycle, limits: BranchLimits) -> int:
    """Index of the range end that a cycle has passed: 0 below the range, 1 above, -1 within the range."""
    low, high = limits.coordinate_range
    if point.parameter_coordinate < low:
        return 0
    return 1 if point.parameter_coordinate > high else -1


def _append_next_cycle(
    record: BranchRecord, start: BranchCycle, limits: BranchLimits
) -> BranchCycle | BranchEnd:
    """Appends the next cycle after `start`, and the special points before this cycle, to the branch. Returns
    the last cycle, from which the branch continues, or the end of the branch; if a step to the mirror image
    is too long, `start` with half the step length, without a new cycle."""
    curve = record.curve
    if len(curve.points) >= limits.max_cycles:
        return BranchEnd(branch_end_point(start, EndReason.list_full), complete=False, list_full=True)
    try:
        end = next_cycle(start, limits.accuracy)
        if _passed_mirror_image(start, end, limits):
            # Beyond this point the branch continues through the mirror images of its cycles.
            return (_end_at_hopf if start.orbit.is_symmetric else _end_at_breaking)(start, end, limits)
        end, outside = cycle_within_range(start, end, limits.coordinate_range, limits.accuracy)
        range_end = range_end_condition(start, limits.coordinate_range[outside]) if outside >= 0 else None
        if range_end is not None and _step_hides_corner(start, end):
            range_end = None  # first a cycle at half the step
            end = cycle_at_length(start, arc_length_between(start, end) / 2, limits.accuracy)
        # h1 = 0: the model is not valid beyond, even if the discrete equations have solutions.
        if least_stretch_of_cycle(end) <= 0:
            return BranchEnd(
                special_point_between(SpecialKind.left_the_model, start, end, limits.accuracy), complete=True
            )
        _add_special_points(curve, start, end, limits)
        record.append(end)
        last = record.assign_errors(range_end) if range_end is not None or is_measurement_due(end) else end
    except Unsolvable as why:
        message = f"no further cycle of the branch is found: {why}"
        return BranchEnd(branch_end_point(start, reason_of_failure(why), message), complete=False)
    if range_end is None:
        return last
    at = getattr(last.orbit.form.rod, last.scale.parameter_name)
    error = BRANCH_END_SETTINGS.range_end_error * abs(at)
    return BranchEnd(replace(branch_end_point(last, limits.end_reasons[outside]), error=error), complete=True)


def _add_special_points(
    curve: BranchCurve, start: BranchCycle, end: BranchCycle, limits: BranchLimits
) -> None:
    """Appends the special points between the last cycle `start` and the next cycle `end` to a branch."""
    step = partial(cycle_at_length, accuracy=limits.accuracy)
    curve.add_special_points(*special_points_between(start, end, step, limits.accuracy))


def _passed_mirror_image(start: BranchCycle, end: BranchCycle, limits: BranchLimits) -> bool:
    """Whether a branch reaches its mirror image between two cycles: at a Hopf point or a symmetric cycle."""
    if start.orbit.is_symmetric:
        return passed_hopf_point(start, end)
    return reaches_symmetric_cycle(start, end, limits.breakings, limits.accuracy)


def _step_hides_corner(start: BranchCycle, end: BranchCycle) -> bool:
    """Whether the largest tip y has a corner on the last step (a different maximum of y(t) becomes the
    largest), and the step is too long for a figure, which locates a corner from two cycles before and two
    cycles after the corner."""
    apart = abs(end.cycle.path.time_of_largest_y - start.cycle.path.time_of_largest_y)
    other = min(apart, 1 - apart) > BRANCH_END_SETTINGS.max_peak_shift
    return other and arc_length_between(start, end) > BRANCH_END_SETTINGS.max_step_with_corner


def passed_hopf_point(start: BranchCycle, end: BranchCycle) -> bool:
    """Whether a Hopf point lies between two cycles: the bending moments at t = 0 then have opposite signs.
    The sign of the tip's y is no criterion: on a large cycle an extremum of y may pass through 0."""
    mesh = mesh_of(end.orbit)
    layout = end.orbit.form.layout
    one = layout.stress_field(mesh.interpolated_orbit(start.orbit).start_state, "m3")
    return float(one @ layout.stress_field(end.orbit.start_state, "m3")) < 0


def _end_at_hopf(start: BranchCycle, end: BranchCycle, limits: BranchLimits) -> BranchCycle | BranchEnd:
    """The end of a branch at a Hopf point between two cycles (a failure if no known Hopf point is near), or
    `start` with half the step, if `start` is too large for an extrapolation. Raises Unsolvable."""
    shorter = arc_length_between(start, end) / 2
    if start.cycle.measures.tip_y_max > BRANCH_END_SETTINGS.max_last_amplitude:
        if shorter < ARC_STEP_CONTROL.min_length:
            raise Unsolvable("the bending moments of the cycle change sign within the shortest step")
        return replace(start, next_arc_length=shorter)
    # Near a Hopf point parameter and period are quadratic in the deflection.
    tangent = start.tangent
    # From d to 0 the parabola p = p0 + k d^2 changes by half as much as its tangent at d.
    share = deflection_of(start.orbit) / (2 * start.unit_tangent[0] * start.scale.deflection_unit)
    at = start.parameter_coordinate - share * tangent[-1]
    period = start.orbit.period - share * tangent[-2]
    rounding = max(BRANCH_END_SETTINGS.parameter_tolerance, limits.accuracy)
    for number, hopf in enumerate(limits.hopfs):
        tolerance = BRANCH_END_SETTINGS.extrapolation_tolerance * abs(
            start.parameter_coordinate - hopf.parameter_coordinate
        ) + rounding * abs(hopf.parameter_coordinate)
        period_tolerance = BRANCH_END_SETTINGS.extrapolation_tolerance * abs(start.orbit.period - hopf.period)
        period_tolerance += BRANCH_END_SETTINGS.period_tolerance * hopf.period
        if abs(at - hopf.parameter_coordinate) <= tolerance and abs(period - hopf.period) <= period_tolerance:
            return BranchEnd(hopf_as_special_point(hopf), complete=True, end_hopf=number)
    why = "the cycles shrink to zero amplitude, but no Hopf point is known there"
    return BranchEnd(branch_end_point(start, EndReason.no_cycle_found, why), complete=False)


def _end_at_breaking(start: BranchCycle, end: BranchCycle, limits: BranchLimits) -> BranchCycle | BranchEnd:
    """The end of an asymmetric branch at a symmetry breaking (a failure if no known symmetry breaking is
    near), or `start` with half the step, if `start` is too asymmetric. Raises Unsolvable."""
    which = symmetry_breaking_between(start, end, limits.breakings, limits.accuracy)
    if which is None:
        return replace(start, next_arc_length=arc_length_between(start, end) / 2)
    if which >= 0:
        breaking = limits.breakings[which]
        special = replace(breaking.special_point, message="", orbit=None)
        return BranchEnd(special, complete=True, end_breaking=breaking)
    why = "the cycles become symmetric, but no known symmetry breaking is near"
    return BranchEnd(branch_end_point(start, EndReason.no_cycle_found, why), complete=False)
