"""One branch of cycles, from the Hopf point or the symmetry breaking where it is born to where it ends."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import nan

import numpy as np
from scipy.optimize import brentq

from ..cycle.cycle_errors import CycleErrors
from ..cycle.measures import Measures
from ..cycle.neighbour import coordinate_of, value_of
from ..cycle.orbit_mesh import mesh_of
from ..cycle.refinement import MULTIPLIER_FACTOR, matrix_distance
from ..point import Unsolvable
from .arc import SHORTEST, ArcPoint, Passed, arc_point, measured, next_point, point_at, tangent_at
from .beginning import HopfBirth, beginning
from .bordered import Condition
from .special_points import (
    EndReason,
    Segment,
    SpecialKind,
    SpecialPoint,
    arc_between,
    located,
    special_points,
    stretch_at,
)
from .symmetry import Breaking, beginning_without_symmetry, mirrored, symmetric_end

PARAMETER = np.array([0.0, 0.0, 1.0])
SMALL = 0.06
"""Largest tip y in L from which a branch may step to the Hopf point where it ends."""
WITHIN, WITHIN_PERIOD = 0.3, 1e-3
"""Distance of a Hopf point from where cycles shrink to nothing, in units of the last cycle's distance, and of
its period, relative."""
EXACT = 1e-15
"""Relative error of an end of the range."""
CLOSE = 1e-6
"""Distance from a Hopf point, relative, that need not be less."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchPoint:
    """A cycle of a branch. at: the parameter; multiplier: the largest nontrivial one's modulus; unstable: how
    many lie outside the circle, -1 where one is on it within its error."""

    at: float
    measures: Measures
    errors: CycleErrors
    multiplier: float
    unstable: int

    @classmethod
    def of(cls, point: ArcPoint) -> "BranchPoint":
        """The numbers of a cycle."""
        cycle = point.cycle
        sizes = np.abs(cycle.multipliers)
        beyond = sizes - 1
        undecided = bool((np.abs(beyond) <= _margin(point)).any())
        return cls(
            at=value_of(point.orbit.form, point.scale.name),
            measures=cycle.measures,
            errors=cycle.errors,
            multiplier=cycle.largest_multiplier,
            unstable=-1 if undecided else int((beyond > 0).sum()),
        )


def _margin(point: ArcPoint) -> float:
    """How far a multiplier's modulus near 1 must be from it to be told from it.

    The errors of others are as small as they are, in units of the largest one's; that of the trivial one is
    known.
    """
    cycle = point.cycle
    relative = cycle.errors.multiplier_error / max(cycle.largest_multiplier, 1.0)
    return relative + MULTIPLIER_FACTOR * cycle.trivial_error


@dataclass(kw_only=True, slots=True)
class BranchCurve:
    """A branch: its cycles and its special points, both in order, from the Hopf point of a number, or -1.

    arrives: the number of the Hopf point at which it ends, -1 for none. breaking: the symmetry breaking where
    a branch without symmetry is born; meets: that at which it ends. complete: whether it was followed to
    an end that is one. explained: whether the special points explain all multipliers that cross the circle.
    """

    hopf: int
    points: list[BranchPoint] = field(default_factory=list)
    special: list[SpecialPoint] = field(default_factory=list)
    arrives: int = -1
    breaking: Breaking | None = None
    meets: Breaking | None = None
    complete: bool = False
    full: bool = False
    explained: bool = True

    def add(self, special: SpecialPoint) -> None:
        """A special point behind the last cycle."""
        self.special.append(replace(special, after=len(self.points) - 1))

    def end(self, special: SpecialPoint, complete: bool) -> None:
        """The special point at which it ends."""
        self.add(special)
        self.complete = complete


@dataclass(frozen=True, slots=True)
class Course:
    """What a branch is followed through: all Hopf points of the rod, the parameter's coordinates between
    which it lies with why it ends there, an accuracy, and how many cycles are kept.

    breakings: known symmetry breakings of the rod.
    """

    hopfs: Sequence[HopfBirth]
    ends: tuple[float, float]
    reasons: tuple[EndReason, EndReason]
    accuracy: float
    most: int
    breakings: Sequence[Breaking] = ()


def follow_branch(number: int, course: Course) -> BranchCurve:
    """The branch from a Hopf point, of a number among all; what stops it is its last special point."""
    hopf = course.hopfs[number]
    curve = BranchCurve(hopf=number)
    curve.add(special_hopf(hopf))
    return _followed(curve, course, lambda: beginning(hopf, course.accuracy))


def follow_without_symmetry(which: int, name: str, course: Course) -> BranchCurve:
    """The branch from a symmetry breaking, of a number among the known ones, along a parameter."""
    breaking = course.breakings[which]
    curve = BranchCurve(hopf=-1, breaking=breaking)
    curve.add(replace(breaking.point, message="", orbit=None))
    return _followed(curve, course, lambda: beginning_without_symmetry(breaking, name, course.accuracy))


def _followed(curve: BranchCurve, course: Course, first: Callable[[], ArcPoint]) -> BranchCurve:
    """A branch that begins at a special point, and what gives its first cycle or raises Unsolvable."""
    if course.most < 1:
        curve.full = True
        curve.end(_end_beside(curve, EndReason.list_full), False)
        return curve
    try:
        here = first()
    except Unsolvable as why:
        curve.end(_end_beside(curve, EndReason.no_cycle_found, str(why)), False)
        return curve
    outside = _beyond(here, course)
    if outside >= 0:
        curve.end(_end_beside(curve, course.reasons[outside]), True)
        return curve
    curve.points.append(BranchPoint.of(here))
    going: ArcPoint | None = here
    while going is not None:
        going = _next(curve, going, course)
    return curve


def special_hopf(hopf: HopfBirth) -> SpecialPoint:
    """The Hopf point as a special point."""
    return SpecialPoint(
        kind=SpecialKind.hopf,
        at=hopf.crossing.at,
        period=hopf.period,
        tip_y_max=0.0,
        error=hopf.crossing.error,
        amplitude_coefficient=hopf.amplitude_coefficient,
    )


def _end_beside(curve: BranchCurve, reason: EndReason, message: str = "") -> SpecialPoint:
    """The end of a branch that has no cycles, where it begins."""
    born = curve.special[0]
    return replace(born, kind=SpecialKind.end, reason=reason, message=message, amplitude_coefficient=nan)


def _beyond(point: ArcPoint, course: Course) -> int:
    """Which of the two ends of the range a cycle lies beyond, -1 for none."""
    low, high = course.ends
    return 0 if point.at < low else 1 if point.at > high else -1


def _end_at(point: ArcPoint, reason: EndReason, message: str = "") -> SpecialPoint:
    """The end of a branch at a cycle."""
    measures, at = point.cycle.measures, value_of(point.orbit.form, point.scale.name)
    return SpecialPoint(
        kind=SpecialKind.end,
        at=at,
        period=measures.period,
        tip_y_max=measures.tip_y_max,
        error=point.cycle.errors.largest * abs(at),
        reason=reason,
        message=message,
    )


def _next(curve: BranchCurve, here: ArcPoint, course: Course) -> ArcPoint | None:
    """The next cycle, which the branch gets with what lies before it; None where it ends."""
    if len(curve.points) >= course.most:
        curve.full = True
        curve.end(_end_at(here, EndReason.list_full), False)
        return None
    try:
        there = next_point(here, course.accuracy)
        if _back(here, there, course):
            return (_arrived if here.orbit.symmetric else _symmetric_again)(curve, here, there, course)
        outside = _beyond(there, course)
        if outside >= 0:
            there = _on_the_edge(here, there, course, outside)
    except Unsolvable as why:
        curve.end(_end_at(here, EndReason.no_cycle_found, f"no cycle is found beyond: {why}"), False)
        return None
    if stretch_at(there) <= 0:
        curve.end(located(SpecialKind.left_the_model, here, there, course.accuracy), True)
        return None

    def step(point: ArcPoint, length: float) -> ArcPoint:
        return point_at(point, length, course.accuracy)

    between, explained = special_points(here, there, step, course.accuracy)
    curve.explained &= explained
    for special in between:
        curve.add(special)
    curve.points.append(BranchPoint.of(there))
    if outside < 0:
        return there
    edge = replace(_end_at(there, course.reasons[outside]), error=EXACT * abs(BranchPoint.of(there).at))
    curve.end(edge, True)
    return None


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
    mesh, nodes = mesh_of(there.orbit), there.orbit.form.mesh.nodes
    one, other = (orbit.start[2 * nodes : 3 * nodes] for orbit in (mesh.carry(here.orbit), there.orbit))
    return float(one @ other) < 0


def _arrived(curve: BranchCurve, here: ArcPoint, there: ArcPoint, course: Course) -> ArcPoint | None:
    """The Hopf point where cycles shrink to nothing between two; or the first of them, for a shorter step."""
    shorter = arc_between(here, there) / 2
    if here.cycle.measures.tip_y_max > SMALL:
        if shorter < SHORTEST:
            raise Unsolvable("the motion turns round within a step")
        return replace(here, length=shorter)
    # About a Hopf point parameter and period go with the square of the moment.
    tangent, scale = here.tangent, here.scale
    share = here.moment / (2 * here.ahead[0] * scale.moment)
    at, period = here.at - share * tangent[-1], here.orbit.period - share * tangent[-2]
    for number, hopf in enumerate(course.hopfs):
        near = WITHIN * abs(here.at - hopf.coordinate) + CLOSE * abs(hopf.coordinate)
        also = WITHIN * abs(here.orbit.period - hopf.period) + WITHIN_PERIOD * hopf.period
        if abs(at - hopf.coordinate) <= near and abs(period - hopf.period) <= also:
            curve.arrives = number
            curve.end(special_hopf(hopf), True)
            return None
    why = "cycles shrink to nothing where no Hopf point is known"
    curve.end(_end_at(here, EndReason.no_cycle_found, why), False)
    return None


def _symmetric_again(curve: BranchCurve, here: ArcPoint, there: ArcPoint, course: Course) -> ArcPoint | None:
    """The symmetry breaking where a branch ends between two; or the first of them, for a shorter step."""
    which = symmetric_end(here, there, course.breakings, course.accuracy)
    if which is None:
        return replace(here, length=arc_between(here, there) / 2)
    if which >= 0:
        curve.meets = course.breakings[which]
        curve.end(replace(curve.meets.point, message="", orbit=None), True)
        return None
    why = "the cycles become symmetric at one that lies on no branch that was followed"
    curve.end(_end_at(here, EndReason.no_cycle_found, why), False)
    return None


def _on_the_edge(here: ArcPoint, there: ArcPoint, course: Course, which: int) -> ArcPoint:
    """The cycle at an end of the range that lies between two; raises Unsolvable."""
    scale, edge = here.scale, course.ends[which]
    condition = Condition(scale, PARAMETER, edge / scale.coordinate)
    segment = Segment(here, there)

    def beyond(length: float) -> float:
        return coordinate_of(segment.predicted(length).form, scale.name) - edge

    if not beyond(0.0) * beyond(segment.length) <= 0:
        raise Unsolvable("the end of the range is not between two cycles")
    length = float(brentq(beyond, 0.0, segment.length, xtol=1e-6 * segment.length))
    found = condition.solved(segment.predicted(length), matrix_distance(course.accuracy))
    cycle = measured(found, here.cycle.calibration, condition, length, course.accuracy)
    tangent = tangent_at(cycle.orbit, scale, here.ahead)
    return arc_point(cycle, scale, tangent, length, Passed(here.orbit, here.tangent))
