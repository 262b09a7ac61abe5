"""The curves through the special points of all rows: each followed once, every point then found on one.

As `changes.boundaries` does with the changes of the straight rod.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from ...determinant.parameter_plane import PlaneAxis
from ..point import FAILURES, Unsolvable
from .special_curves import VANISHING, CurveCourse, CycleCurve
from .special_family import OnCurve
from .special_points import SpecialKind, SpecialPoint

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


def cycle_curves(
    line: PlaneAxis,
    rows: PlaneAxis,
    special: Sequence[RowSpecial],
    located: Callable[[int], Iterable[SpecialPoint]],
) -> CycleCurves:
    """The curves through the folds and torus points of all rows.

    located: the special points of a row of a number with their cycles, solved anew.
    """
    curves: list[CycleCurve] = []
    worst, untraced = 0.0, 0
    for one in special:
        course = CurveCourse(one.kind, line, rows)
        distance = min((_distance(course, curve, one) for curve in curves), default=math.inf)
        if distance > AGREE:
            curve = _traced(course, one, located(one.number))
            if curve is not None:
                distance = _distance(course, curve, one)
                if not any(_same(course, curve, other) for other in curves):
                    curves.append(curve)
        if distance > AGREE:
            untraced += 1
        else:
            worst = max(worst, distance)
    return CycleCurves(tuple(curves), worst, untraced)


def _traced(course: CurveCourse, one: RowSpecial, located: Iterable[SpecialPoint]) -> CycleCurve | None:
    """The curve through a special point of a row, or None where it cannot be followed."""
    width = abs(course.line.stretch(one.at))
    same = [
        point
        for point in located
        if point.kind == one.kind
        and abs(point.at - one.at) <= AGREE * width
        and abs(point.period / one.period - 1) <= SAME_PERIOD
    ]
    try:
        return course.trace(same[0], one.row) if same else None
    except (*FAILURES, ValueError):  # an axis of ratios has no place for what is not positive
        return None


def _distance(course: CurveCourse, curve: CycleCurve, one: RowSpecial) -> float:
    """How far a special point lies from a curve on its row, in units of the line's axis."""
    if curve.kind != one.kind:
        return math.inf
    place, best = course.rows.scaled(one.row), math.inf
    at = course.line.scaled(one.at)
    for a, b in zip(curve.points[:-1], curve.points[1:], strict=True):
        if not min(a.place, b.place) <= place <= max(a.place, b.place) or not _near(course, a, b, one):
            continue
        try:
            there = course.on_row(a, b, place)
        except Unsolvable:
            continue
        if abs(there.orbit.period / one.period - 1) <= SAME_PERIOD:
            best = min(best, abs(course.line.scaled(there.at) - at))
    return 0.0 if best > AGREE and _vanishes(course, curve, one) else best


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
