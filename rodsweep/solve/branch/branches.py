"""The task branch for one rod: the cycles born at its Hopf points along a parameter, followed to their ends.

The Hopf points are those of `task: thresholds`, found by the same covering. A branch that arrives at another
Hopf point of the rod is that one's too. Where the symmetry of cycles breaks on one of them, the branch of
cycles without it is followed as well. Cycles that no such branch contains are not found.
"""

from dataclasses import dataclass, field, replace

from ...determinant.parameter_path import Path
from ...model.rod import Rod
from ...watch import part
from ..changes.along_path import Transitions, pair_crossings
from ..changes.unstable_modes import Crossing
from ..orbit.matrix.workspace import NewtonWorkspace
from ..point import FAILURES, cause_of, solved
from ..status import PointStatus
from .beginning import hopf_point
from .branch_curve import BranchCurve
from .following import Course, follow_branch, follow_without_symmetry
from .special.point import EndReason
from .symmetry import Breaking, breakings_of
from .work import shares_of_branches

SHORT_OF_CRUSHED = 1e-4
"""How far below k1 a branch along F ends, relatively: beyond, the rod is all but crushed at rest."""
TAPER_DIGITS = 1e-9
"""Relative accuracy of the smallest taper whose tip is not crushed."""


class BranchStatus(PointStatus):
    """Outcome of one rod: of the search for its Hopf points, and of the branches from them."""

    ok = (
        0,
        "every branch that is born at a Hopf point within the range, or where the symmetry of one breaks, is "
        "followed to its end, as accurately as asked for, and what changes on it is located",
        True,
    )
    stopped = (
        1,
        "a branch stops short where no further cycle was found, the others are complete; the message says "
        "where; a smaller or a larger number for the accuracy may lead on, or shorten the range",
    )
    list_full = 2, "there are more cycles or special points than are kept; raise cycles or special"
    special_undecided = (
        3,
        "a special point is located less accurately than asked for, as its error says, or multipliers cross "
        "the circle for which none was found; a smaller number for the accuracy may decide it",
    )
    search_open = (
        4,
        "the branches are complete, but it is not proved that no Hopf point is missing: within an open range "
        "two may be about to meet, or a count does not agree; `certify: false` accepts the latter",
    )
    failed = 5, "the search for Hopf points failed and nothing is stored; the message says why"


@dataclass(frozen=True, slots=True)
class BranchRequest:
    """What is asked of every rod: the parameter that is followed, its range, a relative accuracy, a proof.

    cycles, special: the most cycles and special points that are kept.
    """

    along: str
    start: float
    stop: float
    accuracy: float
    certify: bool
    cycles: int
    special: int


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchesOfRod:
    """The branches of a rod. crossings: its Hopf points within the range, by the parameter.

    unstable_at_start: unstable modes of the straight rod where the range starts, -1 where that is not known.
    """

    status: BranchStatus
    message: str = ""
    seconds: float = 0.0
    crossings: tuple[Crossing, ...] = ()
    unstable_at_start: int = -1
    proved: bool = False
    curves: tuple[BranchCurve, ...] = field(default_factory=tuple)


def solve_branches(
    rod: Rod, request: BranchRequest, workspace: NewtonWorkspace | None = None
) -> BranchesOfRod:
    """All branches born at Hopf points of rods along a parameter; failures are a status, never an exception.

    rod: with any value of that parameter. workspace: memory of Newton's matrices that rods share; without it
    the rod has its own.
    """
    memory = workspace or NewtonWorkspace()
    try:
        return solved(
            lambda: _solve(rod, request, memory),
            lambda cause: BranchesOfRod(status=BranchStatus.failed, message=cause),
        )
    finally:
        memory.release()


def warm_up() -> None:
    """Loads what is compiled and created at first use, so that no point pays for it."""
    solve_branches(
        Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4), BranchRequest("F", 0.0, 40.0, 1e-5, False, 100, 10)
    )


def _solve(rod: Rod, request: BranchRequest, workspace: NewtonWorkspace) -> BranchesOfRod:
    low, high, crushed = _range(rod, request)
    if not low < high:
        why = "the force crushes the rod everywhere in the range"
        return BranchesOfRod(status=BranchStatus.ok, message=why, proved=True)
    path = Path(rod.changed(**{request.along: low}), request.along)
    found = pair_crossings(path, low, high, request.certify)
    hopfs, failures = [], []
    for crossing in found.crossings:
        try:
            hopfs.append(hopf_point(path, crossing))
        except FAILURES as error:
            failures.append(f"the Hopf point at {request.along} = {crossing.at:.12g}: {cause_of(error)}")
    ends = (path.variable(low), path.variable(high))
    reasons = [EndReason.crushed if side == crushed else EndReason.range_end for side in (0, 1)]
    if path.inverse:
        ends, reasons = ends[::-1], reasons[::-1]
    course = Course(hopfs, ends, (reasons[0], reasons[1]), request.accuracy, request.cycles, workspace)
    curves = _followed(course, request.along)
    status, message = _judged(found, curves, failures, request)
    return BranchesOfRod(
        status=status,
        message=message,
        crossings=found.crossings,
        unstable_at_start=found.unstable_at_start,
        proved=found.proved,
        curves=tuple(curves),
    )


def _range(rod: Rod, request: BranchRequest) -> tuple[float, float, int]:
    """(lowest value, highest value, which of the two is where the rod is crushed, -1 for none)."""
    low, high = request.start, request.stop
    share = rod.build.crushing_share(rod.taper)
    if request.along == "F" and high > (1 - SHORT_OF_CRUSHED) * share * rod.k1:
        return low, (1 - SHORT_OF_CRUSHED) * share * rod.k1, 1
    if request.along == "k1" and low < rod.F / share * (1 + SHORT_OF_CRUSHED):
        return rod.F / share * (1 + SHORT_OF_CRUSHED), high, 0
    if request.along == "taper":
        thinnest = _thinnest(rod, low, high)
        return thinnest, high, 0 if thinnest > low else -1
    return low, high, -1


def _thinnest(rod: Rod, low: float, high: float) -> float:
    """The smallest taper from `low` to `high` whose tip the force of a rod does not crush."""

    def holds(taper: float) -> bool:
        return (1 - SHORT_OF_CRUSHED) * rod.build.crushing_share(taper) * rod.k1 > rod.F

    if holds(low) or not holds(high):
        return low if holds(low) else high
    while high - low > TAPER_DIGITS * high:
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def _followed(course: Course, name: str) -> list[BranchCurve]:
    """The branches from all Hopf points, then those without symmetry; what ends at one another only once."""
    curves: list[BranchCurve] = []
    arrived: set[int] = set()
    left, count = course.most, len(course.hopfs)
    shares = shares_of_branches([hopf.coordinate for hopf in course.hopfs], course.ends)
    for number in range(count):
        if number in arrived:
            continue
        here = replace(course, most=left)
        with part(f"branch from Hopf point {number + 1} of {count}", (shares[number], shares[number + 1])):
            curve = follow_branch(number, here)
        arrived.add(curve.arrives)
        left -= len(curve.points)
        curves.append(curve)
    breakings = breakings_of([curve.special for curve in curves])
    met: list[Breaking] = []
    for which, breaking in enumerate(breakings):
        if breaking in met:
            continue
        with part(f"branch {len(curves) + 1}, without symmetry"):
            curve = follow_without_symmetry(which, name, replace(course, most=left, breakings=breakings))
        met += [curve.meets] if curve.meets else []
        left -= len(curve.points)
        curves.append(curve)
    return curves


def _judged(
    found: Transitions, curves: list[BranchCurve], failures: list[str], request: BranchRequest
) -> tuple[BranchStatus, str]:
    """(status, message): what matters most is said first."""
    said = [
        f"branch {number}: {special.message} at {request.along} = {special.at:.9g}"
        for number, curve in enumerate(curves, 1)
        for special in curve.special
        if special.message
    ]
    count = sum(len(curve.special) for curve in curves)
    special = [point for curve in curves for point in curve.special]
    aim = max(request.accuracy, 1e-9)
    rough = any(point.error > aim * abs(point.at) for point in special)
    if any(not curve.explained for curve in curves):
        said.append("multipliers cross the circle where no special point is found")
    verdicts = {
        BranchStatus.stopped: bool(failures)
        or any(not curve.complete and not curve.full for curve in curves),
        BranchStatus.list_full: any(curve.full for curve in curves) or count > request.special,
        BranchStatus.special_undecided: rough or any(not curve.explained for curve in curves),
        BranchStatus.search_open: request.certify and not found.proved,
    }
    status = next((status for status, holds in verdicts.items() if holds), BranchStatus.ok)
    return status, "; ".join(filter(None, [*failures, *said, found.why_not]))
