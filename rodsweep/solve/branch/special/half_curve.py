"""One half of a curve of folds or torus points: its points, and its crossings with the rows of a diagram."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

from ...point_outcome import FAILURES
from ...unsolvable import Unsolvable
from .curve_problem import SpecialCurveProblem
from .row_crossing import RowCrossing
from .solved_curve_point import SolvedPoint
from .special_curves import CURVE_IDENTITY_SETTINGS, CurvePoint, HalfCurve, TracedHalfCurve
from .special_point import RowSpecialPoint, SpecialPoint


def trace_half_curve(
    problem: SpecialCurveProblem,
    one: RowSpecialPoint,
    located: Iterable[SpecialPoint],
    special: Sequence[RowSpecialPoint],
    complete_rows: Mapping[int, float],
) -> TracedHalfCurve:
    """One half of a curve, from the point in `located` that agrees with special point `one`; `half` is None
    if no point agrees or after a failure. located: points of the row, with cycles. special: all points.
    complete_rows: value of the row parameter, by index, of the rows whose branches are all known."""
    width = abs(problem.line_axis.parameter_per_coordinate(one.at))
    same = [
        point
        for point in located
        if point.kind == one.kind
        and abs(point.at - one.at) <= CURVE_IDENTITY_SETTINGS.max_row_distance * width
        and abs(point.period / one.period - 1) <= CURVE_IDENTITY_SETTINGS.max_period_difference
    ]
    if not same:
        return TracedHalfCurve(None)
    try:
        points, end = problem.follow_from(same[0], one.row_value)
    except (*FAILURES, ValueError):  # a logarithmic axis refuses a value that is not positive
        return TracedHalfCurve(None)
    near, crossings = _crossings_with_rows(problem, points, special, complete_rows)
    return TracedHalfCurve(HalfCurve(tuple(map(CurvePoint.from_solved_point, points)), end), near, crossings)


def _crossings_with_rows(
    problem: SpecialCurveProblem,
    points: Sequence[SolvedPoint],
    special: Sequence[RowSpecialPoint],
    complete_rows: Mapping[int, float],
) -> tuple[dict[int, float], tuple[RowCrossing, ...]]:
    """Returns (distances, crossings). distances: distance along the row, in row lengths, of each special
    point that lies on the curve through `points`, by its index. crossings: crossings with complete rows at
    which no special point lies. Other arguments as in `trace_half_curve`."""
    by_row: dict[int, list[int]] = {}
    for i, one in enumerate(special):
        if one.kind == problem.kind:
            by_row.setdefault(one.row_index, []).append(i)
    rows = dict(complete_rows) | {special[i[0]].row_index: special[i[0]].row_value for i in by_row.values()}
    distances: dict[int, float] = {}
    crossings = []
    for a, b in pairwise(points):
        low, high = sorted((a.row_coordinate, b.row_coordinate))
        for index, value in rows.items():
            row_coordinate = problem.row_axis.coordinate(value)
            near = [i for i in by_row.get(index, ()) if _may_be_near(problem, a, b, special[i])]
            if not low <= row_coordinate <= high or not (near or index in complete_rows):
                continue
            try:
                crossing = problem.point_on_row(a, b, row_coordinate)
            except Unsolvable:
                continue
            found = _distances(problem, crossing, {i: special[i] for i in near})
            for i, distance in found.items():
                distances[i] = min(distance, distances.get(i, distance))
            if not found and index in complete_rows:
                crossings.append(RowCrossing.from_solved_point(index, problem.kind, crossing))
    return dict(sorted(distances.items())), tuple(crossings)


def _distances(
    problem: SpecialCurveProblem, crossing: SolvedPoint, special: Mapping[int, RowSpecialPoint]
) -> dict[int, float]:
    """Distance along the row, in row lengths, of each point of `special` that agrees with the point
    `crossing` of a curve on the same row."""
    at = problem.line_axis.coordinate(crossing.parameter)
    distances = {
        i: abs(at - problem.line_axis.coordinate(one.at))
        for i, one in special.items()
        if abs(crossing.orbit.period / one.period - 1) <= CURVE_IDENTITY_SETTINGS.max_period_difference
    }
    return {
        i: distance
        for i, distance in distances.items()
        if distance <= CURVE_IDENTITY_SETTINGS.max_row_distance
    }


def _may_be_near(problem: SpecialCurveProblem, a: SolvedPoint, b: SolvedPoint, one: RowSpecialPoint) -> bool:
    """Whether the special point `one` may lie on a curve between its successive points `a` and `b`."""
    x = problem.line_axis.coordinate(one.at)
    ends = sorted(problem.line_axis.coordinate(p.parameter) for p in (a, b))
    periods = sorted(p.orbit.period for p in (a, b))
    margin = CURVE_IDENTITY_SETTINGS.max_chord_distance
    on_line = ends[0] - margin <= x <= ends[1] + margin
    ratio = 1 + CURVE_IDENTITY_SETTINGS.max_period_change
    return on_line and periods[0] / ratio <= one.period <= periods[1] * ratio
