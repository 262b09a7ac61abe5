"""Rows of a phase diagram with their cycles: the stable states at each value along the row.

A branch is divided at its special points. A stable cycle exists at a value that lies within a part of a
branch whose multipliers are inside the unit circle. The ends of a part are located special points, not values
of the row.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.rod import Rod
from ...wording import counted
from ..changes.diagram.rows import DiagramRow, Motion, RowRequest, solve_row
from ..changes.thresholds import ThresholdStatus
from ..orbit.matrix.workspace import NewtonWorkspace
from ..status import PointStatus
from .branch_curve import BranchCurve
from .branches import BRANCHES, BranchesOfRod, BranchRequest, BranchStatus, solve_branches
from .special.point import EndReason, SpecialPoint


def _shared_status(status: ThresholdStatus) -> tuple[int, str, bool]:
    """(value, sentence, success) of the status of a row without cycles."""
    return int(status), status.sentence, status.succeeded


class CoexistenceStatus(PointStatus):
    """Outcome of a row with cycles: of the stability changes if they failed, else of the branches."""

    ok = _shared_status(ThresholdStatus.ok)
    not_certified = _shared_status(ThresholdStatus.not_certified)
    window_open = _shared_status(ThresholdStatus.window_open)
    accuracy_not_reached = _shared_status(ThresholdStatus.accuracy_not_reached)
    list_full = _shared_status(ThresholdStatus.list_full)
    failed = _shared_status(ThresholdStatus.failed)
    ended_early = _shared_status(ThresholdStatus.ended_early)
    branches_stopped = (
        6,
        "the changes are found, but a branch of cycles is incomplete or a Hopf point may be missing: the "
        "stable states are undecided where no stable cycle is known; the message says where the branch "
        "stopped",
    )
    special_undecided = (
        7,
        "the branches are complete, but a special point misses the requested accuracy, or a stable state is "
        "undecided because the multipliers of cycles disagree between two special points or are 1 within "
        "their errors; a smaller number for the accuracy may decide it",
    )
    special_full = 8, "there are more special points on the branches of the row than the file holds"


class StableStates(IntEnum):
    """Stable states. neither_known: the straight rod is unstable and no branch has a stable cycle."""

    neither_known = 0
    straight = 1
    cycle = 2
    both = 3
    undecided = 4
    crushed = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class CoexistenceRow:
    """A row: stable states at each value, (values,), and the special points of all branches."""

    row: DiagramRow
    stable_states: NDArray[np.int8]
    special: tuple[SpecialPoint, ...]
    status: CoexistenceStatus
    message: str = ""
    seconds: float = 0.0


def solve_coexistence(
    rod: Rod, request: RowRequest, special: int, workspace: NewtonWorkspace | None = None
) -> CoexistenceRow:
    """A row with its cycles; a failure is a status, never an exception.

    special: maximum number of special points. workspace: as in `solve_branches`.
    """
    row = solve_row(rod, request)
    branches = row_branches(rod, request, special, workspace)
    cycles = cycles_at(request.values, branches, request.certify)
    forces = request.values if request.name == "F" else np.full(len(request.values), rod.F)
    # Without a force the elastic energy decreases until the rod is straight: there is no cycle.
    cycles[forces == 0] = 0
    states = stable_states(row.motion, cycles)
    undecided = request.values[(states == StableStates.undecided) & (row.motion != Motion.undecided)]
    status, message = _judged(row, branches, special, undecided)
    return CoexistenceRow(
        row=row,
        stable_states=states,
        special=special_of(branches),
        status=status,
        message="; ".join(filter(None, [message, _undecided(request.name, undecided)])),
        seconds=row.seconds + branches.seconds,
    )


def row_branches(
    rod: Rod, request: RowRequest, special: int, workspace: NewtonWorkspace | None = None
) -> BranchesOfRod:
    """Branches of cycles from the Hopf points of a row; other arguments as in `solve_coexistence`."""
    asked = BranchRequest(
        along=request.name,
        start=float(request.values[0]),
        stop=float(request.values[-1]),
        accuracy=request.cycle_accuracy,
        certify=request.certify,
        cycles=BRANCHES.max_row_cycles,
        special=special,
    )
    return solve_branches(rod, asked, workspace)


def special_of(branches: BranchesOfRod) -> tuple[SpecialPoint, ...]:
    """All special points of the branches of a row."""
    return tuple(point for curve in branches.curves for point in curve.special)


def _undecided(name: str, values: Array) -> str:
    """Message on values at which the cycles leave the stable states undecided; may be empty. values: (n,)."""
    if not len(values):
        return ""
    places = counted(len(values), "place")
    return f"the stable states are undecided at {places}, {name} = {values[0]:.9g} to {values[-1]:.9g}"


def _judged(
    row: DiagramRow, branches: BranchesOfRod, special: int, undecided: Array
) -> tuple[CoexistenceStatus, str]:
    """(status, message); problems of the stability changes take precedence.

    undecided: values of the parameter whose stable states the cycles leave undecided, (n,).
    """
    message = "; ".join(filter(None, [row.message, branches.message]))
    # The gravest first: without the changes of the straight rod, branches may be missing.
    if row.status is not ThresholdStatus.ok:
        return CoexistenceStatus[row.status.name], message
    if len(special_of(branches)) > special:
        return CoexistenceStatus.special_full, message
    if branches.status is BranchStatus.special_undecided:
        return CoexistenceStatus.special_undecided, message
    if branches.status is not BranchStatus.ok:
        return CoexistenceStatus.branches_stopped, message
    return (CoexistenceStatus.special_undecided if len(undecided) else CoexistenceStatus.ok), message


@dataclass(frozen=True, slots=True)
class BranchStretch:
    """Part of a branch between two neighbouring special points.

    within: range of the parameter surely covered by the part. about: range possibly covered. stable: 1 if its
    cycles are stable, 0 if unstable, -1 if not known.
    """

    within: tuple[float, float]
    about: tuple[float, float]
    stable: int


def cycles_at(values: Array, branches: BranchesOfRod, certify: bool) -> NDArray[np.int8]:
    """Stable cycles at each value, (values,): 1 if one exists, 0 if no branch has one, -1 if unknown."""
    complete = branches.status in (BranchStatus.ok, BranchStatus.special_undecided)
    known = complete and (branches.proved or not certify)
    found = np.full(len(values), 0 if known else -1, dtype=np.int8)
    stretches = [stretch for curve in branches.curves for stretch in stretches_of(curve)]
    # No stable cycle is claimed where the stability is unknown or within the error of the end of a part.
    for stretch in stretches:
        if stretch.stable:
            found[(values >= stretch.about[0]) & (values <= stretch.about[1])] = -1
    for stretch in stretches:
        if stretch.stable > 0:
            found[(values > stretch.within[0]) & (values < stretch.within[1])] = 1
    return found


def stretches_of(curve: BranchCurve) -> list[BranchStretch]:
    """Parts of a branch between consecutive special points."""
    stretches = []
    for one, other in zip(curve.special[:-1], curve.special[1:], strict=True):
        signs = {
            point.min_unstable_multipliers for point in curve.points[one.after + 1 : other.after + 1]
        } - {-1}
        # Stability can change at special points only; cycles that disagree between two of them leave it open.
        stable = -1
        if signs == {0}:
            stable = 1
        elif signs and 0 not in signs:
            stable = 0
        low, high = sorted((one, other), key=lambda point: point.at)
        within = low.at + _closed(low) * low.error, high.at - _closed(high) * high.error
        about = low.at - low.error, high.at + high.error
        stretches.append(BranchStretch(within, about, stable))
    return stretches


def _closed(point: SpecialPoint) -> int:
    """Sign of an end's error in the range surely covered: -1 at an end of the parameter's range, where the
    branch itself has a cycle, else 1.
    """
    return -1 if point.reason is EndReason.range_end else 1


def stable_states(motion: NDArray[np.int8], cycles: NDArray[np.int8]) -> NDArray[np.int8]:
    """Stable states, (values,), from the straight rod's classes and the stable cycles, both (values,)."""
    straight = (motion == Motion.monotone) | (motion == Motion.oscillatory)
    states = np.where(straight, StableStates.straight, StableStates.neither_known).astype(np.int8)
    # 1 for a straight rod plus 2 for a cycle is 3, both.
    states[cycles > 0] += StableStates.cycle
    states[(cycles < 0) | (motion == Motion.undecided)] = StableStates.undecided
    states[motion == Motion.crushed] = StableStates.crushed
    return states
