"""Rows of a phase diagram with their cycles: which states are stable at each value along the row.

A stable cycle exists where the value lies in a stretch of a branch, between special points, whose
multipliers lie inside the circle. The stretches end at located special points, not at values of the row.
"""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.rod import Rod
from ...wording import counted
from ..changes.rows import DiagramRow, Motion, RowRequest, solve_row
from ..changes.thresholds import ThresholdStatus
from ..orbit.matrix.workspace import NewtonWorkspace
from ..status import PointStatus
from .branch_curve import BranchCurve
from .branches import BranchesOfRod, BranchRequest, BranchStatus, solve_branches
from .special.point import EndReason, SpecialPoint

MOST_CYCLES = 500
"""Of the branches of one row."""


def _as(status: ThresholdStatus) -> tuple[int, str, bool]:
    """A status of the rows without cycles."""
    return int(status), status.sentence, status.succeeded


class CoexistenceStatus(PointStatus):
    """Outcome of a row whose cycles are followed: of its changes first, then of its branches."""

    ok = _as(ThresholdStatus.ok)
    not_certified = _as(ThresholdStatus.not_certified)
    window_open = _as(ThresholdStatus.window_open)
    accuracy_not_reached = _as(ThresholdStatus.accuracy_not_reached)
    list_full = _as(ThresholdStatus.list_full)
    failed = _as(ThresholdStatus.failed)
    branches_stopped = (
        6,
        "the changes are found, but a branch of cycles is incomplete or a Hopf point may be missing: where "
        "no stable cycle is known the stable states are undecided; the log says where it stopped",
    )
    special_undecided = (
        7,
        "the branches are complete, but a special point is located less accurately than asked for, or a "
        "stable state is undecided, because the multipliers of cycles disagree between two special points or "
        "are 1 within their errors; a smaller number for the accuracy may decide it",
    )
    special_full = 8, "there are more special points on the branches of the row than the file holds"


class Stable(IntEnum):
    """Which states are stable. neither_known: the straight rod is not and no stable cycle is on a branch."""

    neither_known = 0
    straight = 1
    cycle = 2
    both = 3
    undecided = 4
    crushed = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class CoexistenceRow:
    """A row, its stable states at each value, shape (values,), and all special points of its branches."""

    row: DiagramRow
    stable_states: NDArray[np.int8]
    special: tuple[SpecialPoint, ...]
    status: CoexistenceStatus
    message: str = ""
    seconds: float = 0.0


def solve_coexistence(
    rod: Rod, request: RowRequest, special: int, workspace: NewtonWorkspace | None = None
) -> CoexistenceRow:
    """The row with its cycles; failures are a status, never an exception.

    special: the most points kept. workspace: as in `solve_branches`.
    """
    row = solve_row(rod, request)
    branches = row_branches(rod, request, special, workspace)
    cycles = cycles_at(request.values, branches, request.certify)
    forces = request.values if request.name == "F" else np.full(len(request.values), rod.F)
    # Without a force nothing feeds a motion: the elastic energy of the rod falls until it is straight.
    cycles[forces == 0] = 0
    states = stable_states(row.motion, cycles)
    undecided = request.values[(states == Stable.undecided) & (row.motion != Motion.undecided)]
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
    """The branches of cycles from the Hopf points of a row; other arguments as in `solve_coexistence`."""
    asked = BranchRequest(
        along=request.name,
        start=float(request.values[0]),
        stop=float(request.values[-1]),
        accuracy=request.cycle_accuracy,
        certify=request.certify,
        cycles=MOST_CYCLES,
        special=special,
    )
    return solve_branches(rod, asked, workspace)


def special_of(branches: BranchesOfRod) -> tuple[SpecialPoint, ...]:
    """All special points of the branches of a row."""
    return tuple(point for curve in branches.curves for point in curve.special)


def _undecided(name: str, values: Array) -> str:
    """Where the cycles leave the stable states of a row undecided, as text; may be empty. values: (n,)."""
    if not len(values):
        return ""
    places = counted(len(values), "place")
    return f"the stable states are undecided at {places}, {name} = {values[0]:.9g} to {values[-1]:.9g}"


def _judged(
    row: DiagramRow, branches: BranchesOfRod, special: int, undecided: Array
) -> tuple[CoexistenceStatus, str]:
    """(status, message): the changes along the row are said first. undecided: values whose stable states the
    cycles leave undecided, (n,).
    """
    message = "; ".join(filter(None, [row.message, branches.message]))
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
    """A part of a branch between special points: for sure from the first to the second of `within`, at most
    from the first to the second of `about`; stable: 1 yes, 0 no, -1 not known."""

    within: tuple[float, float]
    about: tuple[float, float]
    stable: int


def cycles_at(values: Array, branches: BranchesOfRod, certify: bool) -> NDArray[np.int8]:
    """At each value whether a stable cycle exists: 1 yes, 0 none on the branches, -1 not known; (values,)."""
    complete = branches.status in (BranchStatus.ok, BranchStatus.special_undecided)
    known = complete and (branches.proved or not certify)
    found = np.full(len(values), 0 if known else -1, dtype=np.int8)
    stretches = [stretch for curve in branches.curves for stretch in stretches_of(curve)]
    # Where stability is not known, or an end of a stable stretch is within its error, none is claimed.
    for stretch in stretches:
        if stretch.stable:
            found[(values >= stretch.about[0]) & (values <= stretch.about[1])] = -1
    for stretch in stretches:
        if stretch.stable > 0:
            found[(values > stretch.within[0]) & (values < stretch.within[1])] = 1
    return found


def stretches_of(curve: BranchCurve) -> list[BranchStretch]:
    """The parts of a branch between its special points."""
    stretches = []
    for one, other in zip(curve.special[:-1], curve.special[1:], strict=True):
        signs = {point.least_outside for point in curve.points[one.after + 1 : other.after + 1]} - {-1}
        stable = 1 if signs == {0} else 0 if signs and 0 not in signs else -1
        low, high = sorted((one, other), key=lambda point: point.at)
        within = low.at + _closed(low) * low.error, high.at - _closed(high) * high.error
        about = low.at - low.error, high.at + high.error
        stretches.append(BranchStretch(within, about, stable))
    return stretches


def _closed(point: SpecialPoint) -> int:
    """-1 at an end of the range, which has a cycle itself, else 1."""
    return -1 if point.reason is EndReason.range_end else 1


def stable_states(motion: NDArray[np.int8], cycles: NDArray[np.int8]) -> NDArray[np.int8]:
    """The stable states, (values,), of the straight rod's classes and the stable cycles at the values."""
    straight = (motion == Motion.monotone) | (motion == Motion.oscillatory)
    states = np.where(straight, Stable.straight, Stable.neither_known).astype(np.int8)
    states[cycles > 0] += Stable.cycle
    states[(cycles < 0) | (motion == Motion.undecided)] = Stable.undecided
    states[motion == Motion.crushed] = Stable.crushed
    return states
