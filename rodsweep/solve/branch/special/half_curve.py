"""One half of a curve of folds or torus points in the plane of a phase diagram: its points, and its crossings
with the rows, the lines of constant second parameter."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

from ...point_outcome import FAILURE_EXCEPTIONS
from ...unsolvable import Unsolvable
from .curve_problem import SpecialCurveProblem
from .row_crossing import RowCrossing
from .solved_curve_point import SolvedCurvePoint
from .special_curves import CURVE_IDENTITY_SETTINGS, CurvePoint, HalfCurve, TracedHalfCurve
from .special_point import RowSpecialPoint, SpecialPoint


def trace_half_curve(
    problem: SpecialCurveProblem,
    special_point: RowSpecialPoint,
    located: Iterable[SpecialPoint],
    special_points: Sequence[RowSpecialPoint],
    values_of_rows_with_known_branches: Mapping[int, float],
) -> TracedHalfCurve:
    """One half of a curve, from the point in `located` that agrees with `special_point`; in the result,
    `half_curve` is None if no point agrees or after a failure. problem: plane, kind and first direction of
    the half curve. located: special points, with cycles, of the row of `special_point`. special_points:
    special points of all rows of the diagram. values_of_rows_with_known_branches: value of the row parameter,
    by row index, for the rows whose branches are all known."""
    row_length = abs(problem.axis_along_row.parameter_per_scaled_coordinate(special_point.parameter_value))
    # The stored point has no cycle; the located point that has one is recognised by its values.
    matches = [
        point
        for point in located
        if point.kind == special_point.kind
        and abs(point.parameter_value - special_point.parameter_value)
        <= CURVE_IDENTITY_SETTINGS.max_distance_from_curve_per_row_length * row_length
        and abs(point.period / special_point.period - 1)
        <= CURVE_IDENTITY_SETTINGS.max_relative_period_difference
    ]
    if not matches:
        return TracedHalfCurve(None)
    try:
        points, end = problem.follow_from(matches[0], special_point.row_parameter_value)
    except (*FAILURE_EXCEPTIONS, ValueError):  # a logarithmic axis refuses a value that is not positive
        return TracedHalfCurve(None)
    distances, crossings = _point_distances_and_row_crossings(
        problem, points, special_points, values_of_rows_with_known_branches
    )
    return TracedHalfCurve(
        HalfCurve(tuple(map(CurvePoint.from_solved_point, points)), end), distances, crossings
    )


def _point_distances_and_row_crossings(
    problem: SpecialCurveProblem,
    points: Sequence[SolvedCurvePoint],
    special_points: Sequence[RowSpecialPoint],
    values_of_rows_with_known_branches: Mapping[int, float],
) -> tuple[dict[int, float], tuple[RowCrossing, ...]]:
    """Returns (distances, crossings). distances: for each special point that lies on the curve through
    `points`, by its index, its distance along the row from the curve, as a fraction of the parameter range of
    the row. crossings: crossings of the curve with rows whose branches are all known, if no special point of
    the row lies there. special_points: special points of all rows of the diagram.
    values_of_rows_with_known_branches: value of the row parameter, by row index, for the rows whose branches
    are all known."""
    indices_by_row: dict[int, list[int]] = {}
    for i, special_point in enumerate(special_points):
        if special_point.kind == problem.kind:
            indices_by_row.setdefault(special_point.row_index, []).append(i)
    # Rows with special points are crossed too, to recognise the points that lie on this curve.
    rows = dict(values_of_rows_with_known_branches) | {
        special_points[i[0]].row_index: special_points[i[0]].row_parameter_value
        for i in indices_by_row.values()
    }
    distances: dict[int, float] = {}
    crossings = []
    for first, second in pairwise(points):
        low, high = sorted((first.row_coordinate, second.row_coordinate))
        for index, value in rows.items():
            row_coordinate = problem.row_parameter_axis.scaled_coordinate(value)
            near_indices = [
                i
                for i in indices_by_row.get(index, ())
                if _may_lie_on_curve_between(problem, first, second, special_points[i])
            ]
            # A crossing costs a cycle, so it is solved only where a point may be found or missed.
            may_matter = near_indices or index in values_of_rows_with_known_branches
            if not low <= row_coordinate <= high or not may_matter:
                continue
            try:
                crossing = problem.point_on_row(first, second, row_coordinate)
            # Without this crossing a point may stay unmatched; then a further curve is traced through it.
            except Unsolvable:
                continue
            near_points = {i: special_points[i] for i in near_indices}
            distances_here = _distances_along_row(problem, crossing, near_points)
            for i, distance in distances_here.items():
                # A curve that turns may cross a row several times; the nearest crossing is at the point.
                distances[i] = min(distance, distances.get(i, distance))
            # Only on a complete row does a crossing without a special point prove that a branch was missed.
            if not distances_here and index in values_of_rows_with_known_branches:
                # The crossing itself has no measured error; its neighbours lie within one step of it.
                error = max(first.branch_parameter_error, second.branch_parameter_error)
                crossings.append(RowCrossing.from_solved_point(index, problem.kind, crossing, error))
    return dict(sorted(distances.items())), tuple(crossings)


def _distances_along_row(
    problem: SpecialCurveProblem, crossing: SolvedCurvePoint, special_points: Mapping[int, RowSpecialPoint]
) -> dict[int, float]:
    """Distance along the row, as a fraction of the parameter range of the row, from the point `crossing` of a
    curve to each of `special_points` on the same row that agrees with it in position and period. Keys: index
    of the special point."""
    coordinate = problem.axis_along_row.scaled_coordinate(crossing.branch_parameter_value)
    distances = {
        i: abs(coordinate - problem.axis_along_row.scaled_coordinate(special_point.parameter_value))
        for i, special_point in special_points.items()
        if abs(crossing.orbit.period / special_point.period - 1)
        <= CURVE_IDENTITY_SETTINGS.max_relative_period_difference
    }
    return {
        i: distance
        for i, distance in distances.items()
        if distance <= CURVE_IDENTITY_SETTINGS.max_distance_from_curve_per_row_length
    }


def _may_lie_on_curve_between(
    problem: SpecialCurveProblem, a: SolvedCurvePoint, b: SolvedCurvePoint, special_point: RowSpecialPoint
) -> bool:
    """Whether the special point `special_point` may lie on a curve between its successive points `a` and
    `b`."""
    x = problem.axis_along_row.scaled_coordinate(special_point.parameter_value)
    ends = sorted(problem.axis_along_row.scaled_coordinate(p.branch_parameter_value) for p in (a, b))
    periods = sorted(p.orbit.period for p in (a, b))
    margin = CURVE_IDENTITY_SETTINGS.max_chord_distance_per_row_length
    # The curve may bulge beyond its chord, hence a margin in the parameter and in the period.
    is_within = ends[0] - margin <= x <= ends[1] + margin
    period_factor = 1 + CURVE_IDENTITY_SETTINGS.period_interval_extension
    return is_within and periods[0] / period_factor <= special_point.period <= periods[1] * period_factor
