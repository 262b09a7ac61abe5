"""The curves through the special points of all rows: each followed once, every point then found on one.

As `changes.boundaries` does with the changes of the straight rod. A curve is followed in two halves, each a
unit of work that depends on nothing but the special points. Which halves make up the curves follows from
their results alone, not from who computed them, when, or what else was computed.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ....determinant.parameter_plane import PlaneAxis
from ...continuation.boundaries import Boundaries, BoundarySearch, boundary_search
from ...orbit.matrix.workspace import NewtonWorkspace
from ...point import FAILURES, Unsolvable
from .curves import VANISHING, CurveCourse
from .cycle_curves import Arrays, CurveEnd, CurvePoint, CycleCurve, HalfCurve, TracedHalf
from .on_curve import OnCurve
from .point import SpecialKind, SpecialPoint

CURVE_KINDS = (SpecialKind.fold, SpecialKind.torus)
"""Special points that are followed as curves."""
AGREE = 1e-6
"""Distance, in units of the line's axis, within which a special point of a row lies on a curve."""
NEAR, SAME_CYCLE = 0.1, 0.1
"""Distance from the chord of a curve, in units of the line's axis, and of the period from its, relative,
beyond which a special point is of another curve."""
SAME_PERIOD = 1e-4
"""Relative distance of the periods of one cycle."""
SAME_ENDS = 1e-4
"""Distance of both ends, scaled, within which two curves are one."""
ON_CHORD = 1e-3
"""Distance, in units of the line's axis, from the last part of a curve, where cycles vanish."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RowSpecial:
    """A special point of a row: the row's number and value, and what the file holds of it."""

    number: int
    row: float
    kind: SpecialKind
    at: float
    period: float
    tip_y_max: float


@dataclass(frozen=True, slots=True)
class SpecialBoundaries:
    """The curves through all folds and torus points of the rows, over a line's parameter and the rows'.

    A unit of work is a half of a curve: 2 i from the special point of place i towards larger values of the
    rows' parameter, 2 i + 1 towards smaller ones.
    """

    line: PlaneAxis
    rows: PlaneAxis
    special: Sequence[RowSpecial]

    def wanted(self, results: Mapping[int, Arrays]) -> list[int]:
        """Units whose results the curves need next, then some that they may need; none once all are there."""
        needed: list[int] = []
        likely: list[int] = []
        for curves, search in self._searches(results):
            needed += search.needed
            likely += curves.likely(search)
        return needed + likely if needed else []

    def curves(self, results: Mapping[int, Arrays]) -> Boundaries[CycleCurve]:
        """All curves, once nothing is wanted any more."""
        found = [search.boundaries for _, search in self._searches(results)]
        curves = tuple(traced.curve for one in found for traced in one.curves)
        return Boundaries(curves, max(one.agreement for one in found), sum(one.untraced for one in found))

    def _searches(
        self, results: Mapping[int, Arrays]
    ) -> "Iterator[tuple[_CurvesOfKind, BoundarySearch[_TracedCurve]]]":
        """The curves of each kind, as far as the results go."""
        for kind in CURVE_KINDS:
            curves = _CurvesOfKind(kind, self.line, self.rows, self.special, results)
            seeds = (i for i, one in enumerate(self.special) if one.kind == kind)
            yield curves, boundary_search(curves, seeds, AGREE)

    def solve(
        self, unit: int, located: Callable[[int], Iterable[SpecialPoint]], workspace: NewtonWorkspace
    ) -> Arrays:
        """The result of a unit, arrays of the shapes that `TracedHalf` has.

        located: the special points of a row of a number, solved anew; workspace: memory of Newton's matrices.
        """
        place, behind = divmod(unit, 2)
        one = self.special[place]
        course = CurveCourse(one.kind, self.line, self.rows, workspace, -1.0 if behind else 1.0)
        return _traced(course, one, located(one.number), self.special).arrays()

    def row_of(self, unit: int) -> int:
        """The number of the row on which a unit starts."""
        return self.special[unit // 2].number

    def where(self, unit: int) -> str:
        """Which half of which curve a unit is, in words."""
        place, behind = divmod(unit, 2)
        one, way = self.special[place], "down" if behind else "up"
        return f"curve of {one.kind.name}s from {self.rows.name} = {one.row:.5g} {way}"


@dataclass(frozen=True, slots=True)
class _TracedCurve:
    """A curve of its halves, and how far special points lie from it, by their places, those near only."""

    curve: CycleCurve
    distances: Mapping[int, float]


@dataclass(frozen=True, slots=True)
class _CurvesOfKind:
    """The curves of one kind, as far as the results of units go."""

    kind: SpecialKind
    line: PlaneAxis
    rows: PlaneAxis
    special: Sequence[RowSpecial]
    results: Mapping[int, Arrays]

    def next_seed(self, left: Sequence[int]) -> int:
        """The special point in the middle: the halves of its curve are of about equal length."""
        return sorted(left, key=self._place)[len(left) // 2]

    def lacking(self, seed: int) -> list[int]:
        """The halves from a special point that are needed and not there."""
        ahead, behind = 2 * seed, 2 * seed + 1
        if ahead not in self.results:
            return [unit for unit in (ahead, behind) if unit not in self.results]
        half = TracedHalf.of(self.results[ahead]).half
        on = half is not None and half.end is not CurveEnd.closed
        return [behind] if on and behind not in self.results else []

    def likely(self, search: "BoundarySearch[_TracedCurve]") -> list[int]:
        """Units from which other curves may start: of special points on the row of the next one."""
        rows = {self.special[unit // 2].row for unit in search.needed}
        beside = sorted((i for i in search.left if self.special[i].row in rows), key=self._place)
        return [unit for i in beside for unit in self.lacking(i)]

    def curve(self, seed: int) -> _TracedCurve | None:
        """The curve from a special point, of its halves."""
        ahead = TracedHalf.of(self.results[2 * seed])
        if ahead.half is None:
            return None
        closed = ahead.half.end is CurveEnd.closed
        behind = TracedHalf(None) if closed else TracedHalf.of(self.results[2 * seed + 1])
        if behind.half is None and not closed:
            return None
        curve = CycleCurve.joined(self.kind, ahead.half, behind.half)
        near = dict(ahead.distances)
        for i, distance in behind.distances.items():
            near[i] = min(distance, near.get(i, math.inf))
        return _TracedCurve(curve, near)

    def distance(self, curve: _TracedCurve, seed: int) -> float:
        """How far a special point lies from a curve, in units of the line's axis; inf unless it is near."""
        near = curve.distances.get(seed, math.inf)
        return 0.0 if near > AGREE and self._vanishes(curve.curve, self.special[seed]) else near

    def same(self, one: _TracedCurve, other: _TracedCurve) -> bool:
        """Whether two curves share both ends."""
        pairs = zip(self._ends(one.curve), self._ends(other.curve), strict=True)
        return all(abs(a - b) <= SAME_ENDS for p, q in pairs for a, b in zip(p, q, strict=True))

    def _place(self, i: int) -> tuple[float, float]:
        """By which special points are in order."""
        return self.special[i].row, self.special[i].at

    def _ends(self, curve: CycleCurve) -> list[tuple[float, float]]:
        """Both ends of a curve, scaled, the lower first."""
        return sorted((p.place, self.line.scaled(p.at)) for p in (curve.points[0], curve.points[-1]))

    def _vanishes(self, curve: CycleCurve, one: RowSpecial) -> bool:
        """Whether a special point lies on the last part of a curve, where cycles vanish at a Hopf point."""
        if one.tip_y_max >= VANISHING:
            return False
        for end, last in zip(curve.vanishing, (curve.points[0], curve.points[-1]), strict=True):
            if end is None:
                continue
            x, y = self.line.scaled(end.at), self.rows.scaled(end.row)
            share = (self.rows.scaled(one.row) - y) / (last.place - y)
            chord = x + share * (self.line.scaled(last.at) - x)
            if 0 <= share <= 1 and abs(chord - self.line.scaled(one.at)) <= ON_CHORD:
                return True
        return False


def _traced(
    course: CurveCourse,
    one: RowSpecial,
    located: Iterable[SpecialPoint],
    special: Sequence[RowSpecial],
) -> TracedHalf:
    """The half of a curve from a special point of a row; without a curve where none is found."""
    width = abs(course.line.stretch(one.at))
    same = [
        point
        for point in located
        if point.kind == one.kind
        and abs(point.at - one.at) <= AGREE * width
        and abs(point.period / one.period - 1) <= SAME_PERIOD
    ]
    if not same:
        return TracedHalf(None)
    try:
        points, end = course.followed(same[0], one.row)
    except (*FAILURES, ValueError):  # an axis of ratios has no place for what is not positive
        return TracedHalf(None)
    distances = {i: _distance(course, points, other) for i, other in enumerate(special)}
    near = {i: distance for i, distance in distances.items() if distance <= AGREE}
    return TracedHalf(HalfCurve(tuple(map(CurvePoint.of, points)), end), near)


def _distance(course: CurveCourse, points: Sequence[OnCurve], one: RowSpecial) -> float:
    """How far a special point lies from the points of a curve on its row, in units of the line's axis."""
    if course.kind != one.kind:
        return math.inf
    place, best = course.rows.scaled(one.row), math.inf
    at = course.line.scaled(one.at)
    for a, b in zip(points[:-1], points[1:], strict=True):
        if not min(a.place, b.place) <= place <= max(a.place, b.place) or not _near(course, a, b, one):
            continue
        try:
            there = course.on_row(a, b, place)
        except Unsolvable:
            continue
        if abs(there.orbit.period / one.period - 1) <= SAME_PERIOD:
            best = min(best, abs(course.line.scaled(there.at) - at))
    return best


def _near(course: CurveCourse, a: OnCurve, b: OnCurve, one: RowSpecial) -> bool:
    """Whether a special point may lie on the part of a curve between two points."""
    x, ends = course.line.scaled(one.at), sorted(course.line.scaled(p.at) for p in (a, b))
    periods = sorted(p.orbit.period for p in (a, b))
    on_line = ends[0] - NEAR <= x <= ends[1] + NEAR
    return on_line and periods[0] / (1 + SAME_CYCLE) <= one.period <= periods[1] * (1 + SAME_CYCLE)
