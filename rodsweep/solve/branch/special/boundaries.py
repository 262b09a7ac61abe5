"""The curves through the special points of all rows: each followed once, every point then found on one.

As `changes.boundaries` does with the changes of the straight rod. A curve is followed in two halves, each a
unit of work that depends on nothing but the special points. Which halves make up the curves follows from
their results alone, not from who computed them, when, or what else was computed.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import PlaneAxis
from ...point import FAILURES, Unsolvable
from .curves import VANISHING, CurveCourse
from .cycle_curves import CurveEnd, CurvePoint, CycleCurve, HalfCurve
from .family import OnCurve
from .point import SpecialKind, SpecialPoint

Arrays = dict[str, Array]
"""What a unit of work gives, as it is stored."""
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
class CycleCurves:
    """All curves of a diagram; how far the special points of rows lie from them, in units of the line's axis.

    untraced: special points through which no curve could be followed.
    """

    curves: tuple[CycleCurve, ...]
    agreement: float
    untraced: int


@dataclass(frozen=True, slots=True)
class TracedHalf:
    """What came of following a half: None where no curve is found; how far special points lie from it.

    distances: in units of the line's axis, by the special point's place in the list of all; those near only.
    """

    half: HalfCurve | None
    distances: dict[int, float] = field(default_factory=dict)

    def arrays(self) -> Arrays:
        """The same as arrays."""
        points = [] if self.half is None else [_numbers(point) for point in self.half.points]
        return {
            "points": np.array(points, dtype=float).reshape(-1, len(CurvePoint.__slots__)),
            "end": np.array([0.0 if self.half is None else float(self.half.end)]),
            "distances": np.array(list(self.distances.items()), dtype=float).reshape(-1, 2),
        }

    @classmethod
    def of(cls, arrays: Arrays) -> "TracedHalf":
        """The inverse of `arrays`."""
        points = tuple(CurvePoint(*map(float, row)) for row in arrays["points"])
        half = HalfCurve(points, CurveEnd(int(arrays["end"][0]))) if points else None
        return cls(half, {int(place): float(distance) for place, distance in arrays["distances"]})


def _numbers(point: CurvePoint) -> list[float]:
    return [getattr(point, name) for name in CurvePoint.__slots__]


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
        for kind in CURVE_KINDS:
            search = _Search(self, kind, results)
            search.run()
            needed += search.needed
            likely += search.likely
        return needed + likely if needed else []

    def curves(self, results: Mapping[int, Arrays]) -> CycleCurves:
        """All curves, once nothing is wanted any more."""
        searches = [_Search(self, kind, results) for kind in CURVE_KINDS]
        for search in searches:
            search.run()
        distances = [distance for search in searches for distance in search.distances.values()]
        found = [distance for distance in distances if distance <= AGREE]
        curves = tuple(curve for search in searches for curve in search.curves)
        return CycleCurves(curves, max(found, default=0.0), len(distances) - len(found))

    def solve(self, unit: int, located: Callable[[int], Iterable[SpecialPoint]]) -> Arrays:
        """The result of a unit. located: the special points of a row of a number, solved anew."""
        place, behind = divmod(unit, 2)
        one = self.special[place]
        course = CurveCourse(one.kind, self.line, self.rows, -1.0 if behind else 1.0)
        return _traced(course, one, located(one.number), self.special).arrays()

    def row_of(self, unit: int) -> int:
        """The number of the row on which a unit starts."""
        return self.special[unit // 2].number

    def where(self, unit: int) -> str:
        """Which half of which curve a unit is, in words."""
        place, behind = divmod(unit, 2)
        one, way = self.special[place], "down" if behind else "up"
        return f"curve of {one.kind.name}s from {self.rows.name} = {one.row:.5g} {way}"


class _Search:
    """The curves of one kind, as far as the results go.

    The next curve starts from the special point in the middle of those that lie on none: its halves are then
    of about equal length.
    """

    def __init__(self, boundaries: SpecialBoundaries, kind: SpecialKind, results: Mapping[int, Arrays]):
        self.special, self.results = boundaries.special, results
        self.course = CurveCourse(kind, boundaries.line, boundaries.rows)
        self.curves: list[CycleCurve] = []
        self.distances = {i: math.inf for i, one in enumerate(self.special) if one.kind == kind}
        """Of each special point from the nearest curve."""
        self.needed: list[int] = []
        """Units without which the search cannot go on."""
        self.likely: list[int] = []
        """Units from which other curves may start: of special points of the same row."""

    def run(self) -> None:
        """Goes on until all special points have been tried or a result is lacking."""
        tried: set[int] = set()
        while left := [i for i, distance in self.distances.items() if distance > AGREE and i not in tried]:
            left.sort(key=lambda i: (self.special[i].row, self.special[i].at))
            seed = left[len(left) // 2]
            self.needed = list(self._lacking(seed))
            if self.needed:
                row = self.special[seed].row
                beside = (i for i in left if i != seed and self.special[i].row == row)
                self.likely = [unit for i in beside for unit in self._lacking(i)]
                return
            tried.add(seed)
            self._take(seed)

    def _lacking(self, place: int) -> Iterator[int]:
        """The units of a special point whose results are needed and not there."""
        ahead, behind = 2 * place, 2 * place + 1
        if ahead not in self.results:
            yield from (unit for unit in (ahead, behind) if unit not in self.results)
            return
        half = TracedHalf.of(self.results[ahead]).half
        if half is not None and half.end is not CurveEnd.closed and behind not in self.results:
            yield behind

    def _take(self, place: int) -> None:
        """Takes in the curve from a special point."""
        ahead = TracedHalf.of(self.results[2 * place])
        if ahead.half is None:
            return
        closed = ahead.half.end is CurveEnd.closed
        behind = TracedHalf(None) if closed else TracedHalf.of(self.results[2 * place + 1])
        if behind.half is None and not closed:
            return
        curve = CycleCurve.joined(self.course.kind, ahead.half, behind.half)
        for i, known in self.distances.items():
            near = min(part.distances.get(i, math.inf) for part in (ahead, behind))
            if near > AGREE and _vanishes(self.course, curve, self.special[i]):
                near = 0.0
            self.distances[i] = min(known, near)
        if not any(_same(self.course, curve, other) for other in self.curves):
            self.curves.append(curve)


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


def _vanishes(course: CurveCourse, curve: CycleCurve, one: RowSpecial) -> bool:
    """Whether a special point lies on the last part of a curve, where cycles vanish at a Hopf point."""
    if one.tip_y_max >= VANISHING:
        return False
    for end, last in zip(curve.vanishing, (curve.points[0], curve.points[-1]), strict=True):
        if end is None:
            continue
        x, y = course.line.scaled(end.at), course.rows.scaled(end.row)
        share = (course.rows.scaled(one.row) - y) / (last.place - y)
        chord = x + share * (course.line.scaled(last.at) - x)
        if 0 <= share <= 1 and abs(chord - course.line.scaled(one.at)) <= ON_CHORD:
            return True
    return False


def _same(course: CurveCourse, one: CycleCurve, other: CycleCurve) -> bool:
    """Whether two curves share both ends."""
    if one.kind != other.kind:
        return False

    def ends(curve: CycleCurve) -> list[tuple[float, float]]:
        return sorted((p.place, course.line.scaled(p.at)) for p in (curve.points[0], curve.points[-1]))

    pairs = zip(ends(one), ends(other), strict=True)
    return all(abs(a - b) <= SAME_ENDS for p, q in pairs for a, b in zip(p, q, strict=True))
