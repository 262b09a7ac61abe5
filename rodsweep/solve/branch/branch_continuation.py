"""Continuation of one branch of cycles, from a Hopf point or a symmetry breaking to the end of the branch."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import nan

from ...model.parameters import PARAMETERS
from ...solve_progress import SolvePosition, report
from ...wording import counted
from ..unsolvable import Unsolvable
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, arc_length_between, cycle_at_length, next_cycle
from .branch_curve import BranchCurve, BranchEnd, RangeEndPassage
from .branch_limits import BranchLimits
from .branch_mesh_choice import is_error_measurement_due
from .branch_record import BranchRecord, branch_end_point
from .computing_time import fraction_done
from .mirror_image_end import accurate_end_before_hopf, end_or_shorter_step_at_mirror_image
from .range_end import (
    cycle_at_range_end_beside_zero,
    cycle_within_range_and_end_index,
    index_of_passed_range_end,
    range_end_condition,
)
from .range_end_near_hopf import end_before_first_cycle
from .settings import BRANCH_END_SETTINGS
from .special.detection import (
    fold_and_breaking_kinds_between,
    lie_on_one_branch,
    special_points_and_completeness,
)
from .special.locating import special_point_between
from .special.special_point import SpecialPoint, SpecialPointKind
from .start.first_asymmetric_cycle import ASYMMETRIC_START_SETTINGS, first_asymmetric_cycle
from .start.first_cycle import first_cycle
from .start.hopf_point import hopf_as_special_point
from .status import BranchEndReason, reason_of_failure


def follow_branch_from_hopf_point(hopf_index: int, limits: BranchLimits) -> BranchCurve:
    """The branch from the Hopf point `limits.hopfs[hopf_index]`; a failure is stored in its last special
    point."""
    hopf = limits.hopfs[hopf_index]
    curve = BranchCurve(start_hopf_index=hopf_index)
    curve.add_special_point(hopf_as_special_point(hopf))
    return _follow_to_end(
        curve,
        lambda: (first_cycle(hopf, limits.accuracy, limits.workspace, limits.all_hopfs), limits),
        limits,
    )


def follow_asymmetric_branch(breaking_index: int, name: str, limits: BranchLimits) -> BranchCurve:
    """The branch of asymmetric cycles along the parameter `name` from the symmetry breaking
    `limits.breakings[breaking_index]`, solved at least to the accuracy `max_accuracy` of asymmetric cycles; a
    failure is stored in its last special point."""
    limits = replace(limits, accuracy=min(limits.accuracy, ASYMMETRIC_START_SETTINGS.max_accuracy))
    breaking = limits.breakings[breaking_index]
    curve = BranchCurve(start_hopf_index=-1, start_breaking=breaking)
    curve.add_special_point(replace(breaking.special_point, message="", orbit=None))

    def first() -> tuple[BranchCycle, BranchLimits]:
        unit = limits.min_coordinate_unit
        start, accuracy = first_asymmetric_cycle(breaking, name, limits.accuracy, limits.workspace, unit)
        return start, replace(limits, accuracy=accuracy)

    return _follow_to_end(curve, first, limits)


def _follow_to_end(
    curve: BranchCurve,
    solve_first_cycle: Callable[[], tuple[BranchCycle, BranchLimits]],
    limits: BranchLimits,
) -> BranchCurve:
    """The branch `curve`, which has only its first special point, followed to its end. solve_first_cycle:
    function that solves the first cycle and returns it with the limits of the branch."""
    if limits.max_cycles < 1:
        end = _end_before_first_cycle(curve, BranchEndReason.list_full)
        curve.append_end(BranchEnd(end, is_complete=False, reached_max_cycles=True))
        return curve
    try:
        start, limits = solve_first_cycle()
    except Unsolvable as reason:
        end = _end_before_first_cycle(curve, reason_of_failure(reason), str(reason))
        curve.append_end(BranchEnd(end, is_complete=False))
        return curve
    passed_end = index_of_passed_range_end(start, limits.coordinate_range)
    if passed_end >= 0:
        curve.append_end(end_before_first_cycle(curve, start, limits, passed_end))
        return curve
    return follow_from_cycle(curve, start, limits)


def follow_from_cycle(curve: BranchCurve, first_cycle: BranchCycle, limits: BranchLimits) -> BranchCurve:
    """The branch `curve`, followed to its end from its first cycle `first_cycle`, which has measured
    errors."""
    record = BranchRecord(curve, limits.accuracy, first_cycle)
    last_cycle: BranchCycle | BranchEnd = first_cycle
    while isinstance(last_cycle, BranchCycle):
        report(partial(_branch_progress, curve, last_cycle, limits))
        last_cycle = _append_next_cycle(record, last_cycle, limits)
    record.append_end(last_cycle)
    return curve


def follow_from_range_end(entry: RangeEndPassage, limits: BranchLimits) -> BranchCurve:
    """The branch that enters the range at `entry`, followed to its end."""
    limits = replace(limits, accuracy=entry.accuracy)
    curve = BranchCurve(start_hopf_index=-1, start_passage=entry)
    start = entry.normal_form_end_point
    if start is None:
        errors = entry.cycle.cycle.errors
        start = replace(
            range_end_point(entry.cycle, limits.end_reasons[entry.range_end_index]),
            period_error=errors.period_error,
            tip_y_max_error=errors.amplitude_error,
        )
    curve.add_special_point(start)
    return follow_from_cycle(curve, entry.cycle, limits)


def _branch_progress(curve: BranchCurve, start: BranchCycle, limits: BranchLimits) -> SolvePosition:
    """Progress of a branch: text with the parameter at the last cycle `start`, and fraction of time."""
    name = start.scale.parameter_name
    # The end of the range towards which the parameter currently moves.
    end_coordinate = limits.coordinate_range[1 if start.unit_tangent[-1] > 0 else 0]
    value = PARAMETERS[name].value(start.parameter_coordinate)
    end_value = PARAMETERS[name].value(end_coordinate)
    text = f"{name} = {value:.5g} on the way to {end_value:.5g}, {counted(len(curve.stored_cycles), 'cycle')}"
    first_point = (curve.special_points or curve.stored_cycles)[0]
    first_coordinate = PARAMETERS[name].coordinate(first_point.parameter_value)
    return SolvePosition(text, fraction_done(first_coordinate, start.parameter_coordinate, end_coordinate))


def _end_before_first_cycle(curve: BranchCurve, reason: BranchEndReason, message: str = "") -> SpecialPoint:
    """The end of a branch without cycles, at its first special point. message: cause of a failure."""
    special_point = curve.special_points[0]
    return replace(
        special_point,
        kind=SpecialPointKind.end,
        end_reason=reason,
        message=message,
        amplitude_coefficient=nan,
        relative_amplitude_coefficient_error=nan,
    )


def _append_next_cycle(
    record: BranchRecord, start: BranchCycle, limits: BranchLimits
) -> BranchCycle | BranchEnd:
    """Appends the next cycle after `start`, and the special points before this cycle, to the branch. Returns
    the last cycle, from which the branch continues, or the end of the branch. If the step is too long and
    leads to the mirror image or to another branch, no cycle is appended, and `start` is returned with a
    shorter next step."""
    curve = record.curve
    if len(curve.stored_cycles) >= limits.max_cycles:
        return BranchEnd(
            branch_end_point(start, BranchEndReason.list_full), is_complete=False, reached_max_cycles=True
        )
    try:
        cycle_at_end = cycle_at_range_end_beside_zero(start, limits.coordinate_range[0], limits.accuracy)
        end = cycle_at_end or next_cycle(start, limits.accuracy)
        next_length = end.next_step_length
        if (replacement := _end_or_shorter_step(start, end, limits)) is not None:
            return replacement
        end, passed_end = cycle_within_range_and_end_index(
            start, end, limits.coordinate_range, limits.accuracy
        )
        range_end = (
            range_end_condition(start, limits.coordinate_range[passed_end]) if passed_end >= 0 else None
        )
        if range_end is not None and _step_has_unresolved_amplitude_corner(start, end):
            range_end = None  # first a cycle at half the step
            end = cycle_at_length(start, arc_length_between(start, end) / 2, limits.accuracy)
        if (last_cycle := _add_special_points_and_find_end(curve, start, end, limits)) is not None:
            return last_cycle
        record.append(end)
        is_measured = range_end is not None or is_error_measurement_due(end, limits.accuracy)
        last = record.bring_errors_within_accuracy(range_end) if is_measured else end
    except Unsolvable as reason:
        message = f"the next cycle is not solved: {reason}"
        return BranchEnd(branch_end_point(start, reason_of_failure(reason), message), is_complete=False)
    if range_end is None:
        return last
    passage = RangeEndPassage(replace(last, next_step_length=next_length), passed_end, limits.accuracy)
    end_point = range_end_point(last, limits.end_reasons[passed_end])
    return BranchEnd(end_point, is_complete=True, range_end_passage=passage)


def _end_or_shorter_step(
    start: BranchCycle, end: BranchCycle, limits: BranchLimits
) -> BranchCycle | BranchEnd | None:
    """The end of a branch that reaches its mirror image between `start` and `end`, or leaves the range just
    before; `start` with a shorter next step, if this step is too long to locate such an end or leads to
    another branch; None if the branch continues through `end`. Raises Unsolvable if no shorter step is
    allowed."""
    # Beyond its end the branch continues through the mirror images of its cycles.
    if (replacement := end_or_shorter_step_at_mirror_image(start, end, limits)) is not None:
        return replacement
    if lie_on_one_branch(start, end):
        return accurate_end_before_hopf(start, end, limits)
    half_length = arc_length_between(start, end) / 2
    if half_length < ARC_STEP_CONTROL.min_length:
        raise Unsolvable("two branches touch within the shortest allowed step")
    return replace(start, next_step_length=half_length)


def range_end_point(point: BranchCycle, reason: BranchEndReason) -> SpecialPoint:
    """The special point for the end of a branch at its last cycle `point`, at an end of the range. reason:
    why the branch ends there."""
    special = branch_end_point(point, reason)
    return replace(
        special,
        error=BRANCH_END_SETTINGS.relative_parameter_error_at_range_end * abs(special.parameter_value),
    )


def _add_special_points_and_find_end(
    curve: BranchCurve, start: BranchCycle, end: BranchCycle, limits: BranchLimits
) -> BranchEnd | None:
    """Appends the special points between the last cycle `start` and the next cycle `end` to a branch. Returns
    the end of the branch if it ends between the two cycles, at h1 = 0 or because it is closed; else None."""
    # h1 = 0: the model is not valid beyond, even if the discrete equations have solutions.
    if end.cycle.measures.least_stretch <= 0:
        special = special_point_between(SpecialPointKind.left_the_model, start, end, limits.accuracy)
        return BranchEnd(special, is_complete=True)
    if limits.locates_special_points:
        cycle_at = partial(cycle_at_length, accuracy=limits.accuracy)
        special_points, are_complete = special_points_and_completeness(start, end, cycle_at, limits.accuracy)
    else:
        kinds = fold_and_breaking_kinds_between(start, end)
        special_points = [special_point_between(kind, start, end, limits.accuracy) for kind in kinds]
        are_complete = True
    closing_index = curve.index_of_first_special_point(special_points)
    if closing_index < 0:
        curve.add_special_points(special_points, are_complete)
        return None
    curve.add_special_points(special_points[:closing_index], are_complete)
    return BranchEnd(special_points[closing_index], is_complete=True, is_closed=True)


def _step_has_unresolved_amplitude_corner(start: BranchCycle, end: BranchCycle) -> bool:
    """Whether the largest tip y has a corner on the last step, from `start` to `end` (a different maximum of
    y(t) becomes the largest), and the step is too long for a figure, which locates a corner from two cycles
    before and two cycles after the corner."""
    time_difference = abs(end.cycle.motion.time_of_largest_y - start.cycle.motion.time_of_largest_y)
    is_other_peak = min(time_difference, 1 - time_difference) > BRANCH_END_SETTINGS.max_peak_shift_in_periods
    return (
        is_other_peak and arc_length_between(start, end) > BRANCH_END_SETTINGS.max_step_with_amplitude_corner
    )
