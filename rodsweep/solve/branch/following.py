"""One branch of cycles, from the Hopf point or the symmetry breaking where it is born to where it ends."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import nan

import numpy as np

from ...model.parameters import PARAMETERS
from ...watch import SolvePosition, report
from ...wording import counted
from ..continuation.follower import zero_along
from ..cycle.accuracy.refinement import matrix_distance, newton_tolerance
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.orbit_mesh import mesh_of
from ..point import Unsolvable
from .arc import STEPS, ArcPoint, arc_between, next_point, point_at, tangent_at, there_from
from .beginning import HopfBirth, beginning, special_hopf
from .bordered import Condition, bordered
from .branch_curve import BranchCurve, BranchEnd
from .settling import due
from .special.least_stretch import stretch_at
from .special.locating import Segment, located
from .special.point import EndReason, SpecialKind, SpecialPoint
from .special.points import special_points
from .symmetry import Breaking, beginning_without_symmetry, mirrored, symmetric_end
from .trail import Trail, end_at
from .work import share_done

PARAMETER = np.array([0.0, 0.0, 1.0])
SMALL = 0.06
"""Largest tip y in L from which a branch may step to the Hopf point where it ends."""
WITHIN, WITHIN_PERIOD = 0.3, 1e-3
"""Distance of a Hopf point from where cycles shrink to nothing, in units of the last cycle's distance, and of
its period, relative."""
LANDING = 1e-6
"""Share of a step to which the place of an end of the range is predicted; Newton's method then has it."""
EXACT = 1e-15
"""Relative error of an end of the range."""
CLOSE = 1e-6
"""Distance from a Hopf point, relative, that need not be less; nor need it be below the accuracy asked for,
to which the branch knows its own end."""


@dataclass(frozen=True, slots=True)
class Course:
    """What a branch is followed through: all Hopf points of the rod, the parameter's coordinates between
    which it lies with why it ends there, an accuracy, and how many cycles are kept.

    breakings: known symmetry breakings of the rod. workspace: memory of all matrices on the way.
    """

    hopfs: Sequence[HopfBirth]
    ends: tuple[float, float]
    reasons: tuple[EndReason, EndReason]
    accuracy: float
    most: int
    workspace: NewtonWorkspace
    breakings: Sequence[Breaking] = ()


def follow_branch(number: int, course: Course) -> BranchCurve:
    """The branch from a Hopf point, of a number among all; what stops it is its last special point."""
    hopf = course.hopfs[number]
    curve = BranchCurve(hopf=number)
    curve.add(special_hopf(hopf))
    return _followed(curve, course, lambda: beginning(hopf, course.accuracy, course.workspace))


def follow_without_symmetry(which: int, name: str, course: Course) -> BranchCurve:
    """The branch from a symmetry breaking, of a number among the known ones, along a parameter."""
    breaking = course.breakings[which]
    curve = BranchCurve(hopf=-1, breaking=breaking)
    curve.add(replace(breaking.point, message="", orbit=None))

    def first() -> ArcPoint:
        return beginning_without_symmetry(breaking, name, course.accuracy, course.workspace)

    return _followed(curve, course, first)


def _followed(curve: BranchCurve, course: Course, first: Callable[[], ArcPoint]) -> BranchCurve:
    """A branch that begins at a special point, and what gives its first cycle or raises Unsolvable."""
    if course.most < 1:
        curve.end(BranchEnd(_end_beside(curve, EndReason.list_full), complete=False, full=True))
        return curve
    try:
        here = first()
    except Unsolvable as why:
        curve.end(BranchEnd(_end_beside(curve, EndReason.no_cycle_found, str(why)), complete=False))
        return curve
    outside = _beyond(here, course)
    if outside >= 0:
        curve.end(BranchEnd(_end_beside(curve, course.reasons[outside]), complete=True))
        return curve
    return followed_from(curve, here, course)


def followed_from(curve: BranchCurve, first: ArcPoint, course: Course) -> BranchCurve:
    """A branch from its first cycle, whose errors are measured, to its end."""
    trail = Trail(curve, course.accuracy, first)
    going: ArcPoint | BranchEnd = first
    while isinstance(going, ArcPoint):
        report(partial(_place_on, curve, going, course))
        going = _next(trail, going, course)
    trail.end(going)
    return curve


def _place_on(curve: BranchCurve, here: ArcPoint, course: Course) -> SolvePosition:
    """Where on a branch its last cycle is, and the share of the branch's work that is done there."""
    name = here.scale.name
    aim = course.ends[1 if here.ahead[-1] > 0 else 0]
    there, end = PARAMETERS[name].value(here.at), PARAMETERS[name].value(aim)
    words = f"{name} = {there:.5g} on the way to {end:.5g}, {counted(len(curve.points), 'cycle')}"
    return SolvePosition(words, share_done(PARAMETERS[name].coordinate(curve.special[0].at), here.at, aim))


def _end_beside(curve: BranchCurve, reason: EndReason, message: str = "") -> SpecialPoint:
    """The end of a branch that has no cycles, where it begins."""
    born = curve.special[0]
    return replace(
        born,
        kind=SpecialKind.end,
        reason=reason,
        message=message,
        amplitude_coefficient=nan,
        coefficient_error=nan,
    )


def _beyond(point: ArcPoint, course: Course) -> int:
    """Which of the two ends of the range a cycle lies beyond, -1 for none."""
    low, high = course.ends
    return 0 if point.at < low else 1 if point.at > high else -1


def _next(trail: Trail, here: ArcPoint, course: Course) -> ArcPoint | BranchEnd:
    """The next cycle, which the branch gets with what lies before it, or how the branch ends."""
    curve = trail.curve
    if len(curve.points) >= course.most:
        return BranchEnd(end_at(here, EndReason.list_full), complete=False, full=True)
    try:
        there = next_point(here, course.accuracy)
        if _back(here, there, course):
            return (_arrived if here.orbit.symmetric else _symmetric_again)(here, there, course)
        outside = _beyond(there, course)
        edge = _edge(here, course, outside) if outside >= 0 else None
        if edge is not None:
            there = _on_the_edge(here, there, edge, course)
        if stretch_at(there) <= 0:
            return BranchEnd(located(SpecialKind.left_the_model, here, there, course.accuracy), complete=True)
        _add_special_points(curve, here, there, course)
        trail.append(there)
        last = trail.settle(edge) if edge is not None or due(there) else there
    except Unsolvable as why:
        message = f"no cycle is found beyond: {why}"
        return BranchEnd(end_at(here, EndReason.no_cycle_found, message), complete=False)
    if edge is None:
        return last
    at = getattr(last.orbit.form.rod, last.scale.name)
    return BranchEnd(replace(end_at(last, course.reasons[outside]), error=EXACT * abs(at)), complete=True)


def _add_special_points(curve: BranchCurve, here: ArcPoint, there: ArcPoint, course: Course) -> None:
    """The special points between two cycles, of which the second is not among the branch's yet."""

    def step(point: ArcPoint, length: float) -> ArcPoint:
        return point_at(point, length, course.accuracy)

    curve.add_found(*special_points(here, there, step, course.accuracy))


def _back(here: ArcPoint, there: ArcPoint, course: Course) -> bool:
    """Whether a branch comes to its own mirror image between two cycles."""
    if here.orbit.symmetric:
        return turned_round(here, there)
    return mirrored(here, there, course.breakings, course.accuracy)


def turned_round(here: ArcPoint, there: ArcPoint) -> bool:
    """Whether the bending moments at t = 0 have changed their sign between two cycles.

    They do beyond a Hopf point, where the branch is its own mirror image. The tip's y would not tell: an
    extremum of it may pass through 0 on a large cycle.
    """
    mesh, layout = mesh_of(there.orbit), there.orbit.form.layout
    one, other = (layout.field(orbit.start, "m3") for orbit in (mesh.carry(here.orbit), there.orbit))
    return float(one @ other) < 0


def _arrived(here: ArcPoint, there: ArcPoint, course: Course) -> ArcPoint | BranchEnd:
    """The Hopf point where cycles shrink to nothing between two; or the first of them, for a shorter step."""
    shorter = arc_between(here, there) / 2
    if here.cycle.measures.tip_y_max > SMALL:
        if shorter < STEPS.shortest:
            raise Unsolvable("the motion turns round within a step")
        return replace(here, length=shorter)
    # About a Hopf point parameter and period go with the square of the moment.
    tangent, scale = here.tangent, here.scale
    share = here.moment / (2 * here.ahead[0] * scale.moment)
    at, period = here.at - share * tangent[-1], here.orbit.period - share * tangent[-2]
    for number, hopf in enumerate(course.hopfs):
        near = WITHIN * abs(here.at - hopf.coordinate) + max(CLOSE, course.accuracy) * abs(hopf.coordinate)
        also = WITHIN * abs(here.orbit.period - hopf.period) + WITHIN_PERIOD * hopf.period
        if abs(at - hopf.coordinate) <= near and abs(period - hopf.period) <= also:
            return BranchEnd(special_hopf(hopf), complete=True, arrives=number)
    why = "cycles shrink to nothing where no Hopf point is known"
    return BranchEnd(end_at(here, EndReason.no_cycle_found, why), complete=False)


def _symmetric_again(here: ArcPoint, there: ArcPoint, course: Course) -> ArcPoint | BranchEnd:
    """The symmetry breaking where a branch ends between two; or the first of them, for a shorter step."""
    which = symmetric_end(here, there, course.breakings, course.accuracy)
    if which is None:
        return replace(here, length=arc_between(here, there) / 2)
    if which >= 0:
        breaking = course.breakings[which]
        special = replace(breaking.point, message="", orbit=None)
        return BranchEnd(special, complete=True, meets=breaking)
    why = "the cycles become symmetric at one that lies on no branch that was followed"
    return BranchEnd(end_at(here, EndReason.no_cycle_found, why), complete=False)


def _edge(here: ArcPoint, course: Course, which: int) -> Condition:
    """What holds for a cycle at an end of the range."""
    return Condition(here.scale, PARAMETER, course.ends[which] / here.scale.coordinate)


def _on_the_edge(here: ArcPoint, there: ArcPoint, edge: Condition, course: Course) -> ArcPoint:
    """The cycle at an end of the range that lies between two; raises Unsolvable."""
    scale, segment = here.scale, Segment(here, there)

    def beyond(length: float) -> float:
        return -edge.missed(segment.predicted(length))

    ends = beyond(0.0), beyond(segment.length)
    length = zero_along(beyond, ends, segment.length, 0.0, LANDING)
    tolerance, distance = newton_tolerance(course.accuracy), matrix_distance(course.accuracy)
    found = edge.solved(segment.predicted(length), tolerance, here.workspace, distance)
    tangent = tangent_at(found.orbit, scale, here.ahead, bordered(found))
    return there_from(here, found, tangent, length, length, course.accuracy)
