"""Rows of a phase diagram with cycles: the stable states of the rod at each parameter value of a row.

The special points divide a branch into sections, and each section covers an interval of the parameter. If the
multipliers of a section lie inside the unit circle, a stable cycle exists at every parameter value of its
interval. The ends of an interval are located special points, not parameter values of the row.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.rod import Rod
from ...wording import counted
from ..changes.diagram.rows import DiagramRow, RowRequest, StabilityClass, crushed_row, solve_row
from ..changes.status import ThresholdStatus
from ..orbit.matrix.workspace import NewtonWorkspace
from .branch_curve import BranchCurve
from .branch_limits import BranchRequest
from .branches import BRANCH_SETTINGS, BranchesOfRod, solve_branches
from .special.special_point import SpecialPoint
from .status import BranchEndReason, BranchStatus, CoexistenceStatus


class StableStates(IntEnum):
    """Stable states of a rod at one parameter value: straight state, cycle, or both. neither_known: the
    straight rod is unstable and no branch has a stable cycle. undecided: the stability of the straight rod or
    the existence of a stable cycle is not known. crushed: the force crushes the rod."""

    neither_known = 0
    straight = 1
    cycle = 2
    both = 3
    undecided = 4
    crushed = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class CoexistenceRow:
    """Outcome for a row of a phase diagram. straight_rod_row: outcome for the straight rod. stable_states:
    `StableStates` at each parameter value, (values,). special_points: special points of all branches. status:
    status of the search for thresholds of the straight rod if this search has a problem, otherwise status of
    the branches. followed_range: smallest and largest parameter value to which branches are followed, NaN if
    none are. message: for the user, or "". seconds: computing time, in s."""

    straight_rod_row: DiagramRow
    stable_states: NDArray[np.int8]
    special_points: tuple[SpecialPoint, ...] = ()
    status: CoexistenceStatus
    followed_range: tuple[float, float] = (math.nan, math.nan)
    folds_beyond_range: tuple[SpecialPoint, ...] = ()
    """Located folds of the branches followed beyond the range of the row."""
    message: str = ""
    seconds: float = 0.0


def solve_coexistence(
    rod: Rod,
    request: RowRequest,
    workspace: NewtonWorkspace | None = None,
    starts: Sequence[SpecialPoint] = (),
) -> CoexistenceRow:
    """Stable states along the row `request` of a phase diagram, whose rods differ from `rod` in one
    parameter; a failure becomes a status, never an exception. workspace: memory of Newton's matrices. starts:
    special points from which further branches are followed."""
    values = request.parameter_values
    row = solve_row(rod, request)
    start = _first_searched_value(row, request)
    branches = solve_branches(rod, _branch_request(start, request), workspace, starts)
    cycles = existence_of_stable_cycle(values, branches, request.certify)
    cycles[values < start] = -1
    forces = values if request.parameter_name == "F" else np.full(len(values), rod.F)
    # Without a force the elastic energy decreases until the rod is straight: there is no cycle.
    cycles[forces == 0] = 0
    states = stable_states(row.stability_class, cycles)
    undecided = values[(states == StableStates.undecided) & (row.stability_class != StabilityClass.undecided)]
    status, message = _status_and_message_of_row(row, branches, request.max_special_points, undecided)
    return CoexistenceRow(
        straight_rod_row=row,
        stable_states=states,
        special_points=special_points_of(branches),
        status=status,
        followed_range=branches.followed_range,
        folds_beyond_range=branches.folds_beyond_range,
        message="; ".join(filter(None, [message, _undecided_values_text(request.parameter_name, undecided)])),
        seconds=row.seconds + branches.seconds,
    )


def crushed_coexistence_row(values: Array) -> CoexistenceRow:
    """A row in which the force crushes the rod at all parameter values `values`, (values,): it has no
    cycles."""
    states = np.full(len(values), StableStates.crushed, dtype=np.int8)
    return CoexistenceRow(
        straight_rod_row=crushed_row(values), stable_states=states, status=CoexistenceStatus.ok
    )


def row_branches(
    rod: Rod,
    request: RowRequest,
    workspace: NewtonWorkspace | None = None,
    starts: Sequence[SpecialPoint] = (),
) -> BranchesOfRod:
    """All branches of cycles that start at Hopf points of a row, and the branches through the special points
    `starts`. workspace: memory of Newton's matrices."""
    start = float(request.parameter_values[0])
    if request.parameter_name == "F" and start < 0:
        start = _first_searched_value(solve_row(rod, request), request)
    return solve_branches(rod, _branch_request(start, request), workspace, starts)


def _first_searched_value(row: DiagramRow, request: RowRequest) -> float:
    """Parameter value from which the row was searched for thresholds: the first value of `request`; a later
    value if no a-priori bound or no mesh is available for the strongly pulled rods before it."""
    result = row.thresholds.search_result
    values = request.parameter_values
    first = result.searched_interval[0]
    starts_late = result.ended_early and values[0] < first < values[-1]
    return float(first if starts_late else values[0])


def _branch_request(start: float, request: RowRequest) -> BranchRequest:
    """Request for the branches of a row between the parameter value `start` and the row's last value."""
    return BranchRequest(
        along=request.parameter_name,
        start=start,
        stop=float(request.parameter_values[-1]),
        accuracy=request.cycle_accuracy,
        certify=request.certify,
        cycles=BRANCH_SETTINGS.max_cycles_per_diagram_row,
        special=request.max_special_points,
    )


def special_points_of(branches: BranchesOfRod) -> tuple[SpecialPoint, ...]:
    """Special points of all branches of a rod, in one tuple, branch after branch, each only once."""
    return tuple(
        point
        for curve in branches.curves
        for point in curve.special_points[: -1 if curve.is_closed else None]
    )


def _undecided_values_text(name: str, values: Array) -> str:
    """Message about the values of the parameter `name`, (n,), in increasing order, at which the stable states
    are undecided because of the cycles, not of the straight rod; empty for n = 0."""
    if not len(values):
        return ""
    count = counted(len(values), "value")
    return f"the stable states are undecided at {count} of {name}, from {values[0]:.9g} to {values[-1]:.9g}"


def _status_and_message_of_row(
    row: DiagramRow, branches: BranchesOfRod, max_special_points: int, undecided: Array
) -> tuple[CoexistenceStatus, str]:
    """Returns (status, message) of a row of a phase diagram. The status is that of the search for thresholds
    if this search has a problem, otherwise that of the branches. max_special_points: maximum number of stored
    special points. undecided: parameter values, (n,), at which the stable states are undecided because of the
    cycles."""
    message = "; ".join(filter(None, [row.message, branches.message]))
    # The most serious problem first: without all thresholds of the straight rod, branches may be missing.
    if row.status is not ThresholdStatus.ok:
        return CoexistenceStatus[row.status.name], message
    if len(special_points_of(branches)) > max_special_points:
        return CoexistenceStatus.special_full, message
    if branches.status is BranchStatus.special_undecided:
        return CoexistenceStatus.special_undecided, message
    if branches.status is not BranchStatus.ok:
        return CoexistenceStatus.branches_stopped, message
    return (CoexistenceStatus.special_undecided if len(undecided) else CoexistenceStatus.ok), message


@dataclass(frozen=True, slots=True)
class StabilityInterval:
    """Interval of the parameter that a branch covers between two successive special points, with the
    stability of the cycles. range_shortened_by_errors, range_extended_by_errors: the interval, shortened and
    extended by the errors of the special points. stability: 1 if the cycles are stable, 0 if unstable, -1 if
    undecided."""

    range_shortened_by_errors: tuple[float, float]
    range_extended_by_errors: tuple[float, float]
    stability: int


def existence_of_stable_cycle(values: Array, branches: BranchesOfRod, certify: bool) -> NDArray[np.int8]:
    """Existence of a stable cycle at each parameter value, (values,): 1 if a stable cycle exists, 0 if no
    branch has one, -1 if undecided. branches: all branches of the row. certify: whether 0 requires a proof
    that the list of Hopf points, from which the branches start, is complete."""
    is_complete = branches.status in (BranchStatus.ok, BranchStatus.special_undecided)
    is_known = is_complete and (branches.are_crossings_proved_complete or not certify)
    existence = np.full(len(values), 0 if is_known else -1, dtype=np.int8)
    intervals = [interval for curve in branches.curves for interval in stability_intervals(curve)]
    # No stable cycle is claimed where the stability is undecided, or within the error of an interval's end.
    for interval in intervals:
        if interval.stability:
            low, high = interval.range_extended_by_errors
            existence[(values >= low) & (values <= high)] = -1
    for interval in intervals:
        if interval.stability > 0:
            low, high = interval.range_shortened_by_errors
            existence[(values > low) & (values < high)] = 1
    return existence


def stability_intervals(curve: BranchCurve) -> list[StabilityInterval]:
    """Intervals of the parameter between successive special points of the branch `curve`, in the order of the
    branch, with the stability of the cycles in each interval."""
    intervals = []
    for first, second in zip(curve.special_points[:-1], curve.special_points[1:], strict=True):
        cycles = curve.stored_cycles[first.index_of_cycle_before + 1 : second.index_of_cycle_before + 1]
        stabilities = {cycle.min_unstable_multiplier_count for cycle in cycles} - {-1}
        # Stability changes at special points only; if cycles between two of them disagree, it is undecided.
        stability = -1
        if stabilities == {0}:
            stability = 1
        elif stabilities and 0 not in stabilities:
            stability = 0
        low, high = sorted((first, second), key=lambda point: point.parameter_value)
        inner_interval = (
            low.parameter_value + _sign_of_range_shortening(low) * low.error,
            high.parameter_value - _sign_of_range_shortening(high) * high.error,
        )
        outer_interval = low.parameter_value - low.error, high.parameter_value + high.error
        intervals.append(StabilityInterval(inner_interval, outer_interval, stability))
    return intervals


def _sign_of_range_shortening(point: SpecialPoint) -> int:
    """Sign of the error of a special point at an end of an interval in `range_shortened_by_errors`: 1, the
    interval is shortened by the error. -1 at an end of the parameter range: the interval is extended by the
    error, because the branch has a cycle exactly at the end."""
    return -1 if point.end_reason is BranchEndReason.range_end else 1


def stable_states(rod_classes: NDArray[np.int8], cycles: NDArray[np.int8]) -> NDArray[np.int8]:
    """`StableStates` at each parameter value, (values,). rod_classes: `StabilityClass` of the straight rod at
    each parameter value, (values,). cycles: 1 if a stable cycle exists at the parameter value, 0 if none
    exists, -1 if undecided, (values,)."""
    straight = (rod_classes == StabilityClass.monotone) | (rod_classes == StabilityClass.oscillatory)
    states = np.where(straight, StableStates.straight, StableStates.neither_known).astype(np.int8)
    # 1 for a straight rod plus 2 for a cycle is 3, both.
    states[cycles > 0] += StableStates.cycle
    states[(cycles < 0) | (rod_classes == StabilityClass.undecided)] = StableStates.undecided
    states[rod_classes == StabilityClass.crushed] = StableStates.crushed
    return states
