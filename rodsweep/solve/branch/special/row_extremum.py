"""Extrema of the row parameter (the parameter that differs between the rows of a phase diagram) along a curve
of folds. At an extremum a closed branch of cycles shrinks to a single cycle and vanishes, or two branches of
cycles meet and are connected differently on the two sides."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan, sqrt

from ...point_outcome import FAILURE_EXCEPTIONS
from .curve_point_solver import CurvePointSolver
from .solved_curve_point import CURVE_SECANT_SETTINGS, SEARCH_LINE_ALONG_BRANCH, SolvedCurvePoint


@dataclass(frozen=True, slots=True, kw_only=True)
class RowExtremumSettings:
    """Settings for locating an extremum, along a curve of folds, of the parameter that differs between
    rows."""

    relative_slope_tolerance: float = 1e-7
    """Largest slope dy/dx of the curve at a located extremum of the row parameter y, divided by the change of
    the slope between the two points beside the extremum. Errors of the fold, 1e-9, change the slope by about
    as much."""


ROW_EXTREMUM_SETTINGS = RowExtremumSettings()


@dataclass(frozen=True, eq=False, slots=True)
class _PointWithSlope:
    """A point of a curve with exchanged roles, see `ParameterRoles`. slope: dy/dx along the curve, y: row
    parameter, x: parameter along a row, each scaled to 0 ... 1 over its axis."""

    point: SolvedCurvePoint
    slope: float


def points_with_row_parameter_extrema(
    problem: CurvePointSolver, points: Sequence[SolvedCurvePoint]
) -> list[SolvedCurvePoint]:
    """The points of a curve, in order, all with unexchanged roles, and further points at the extrema of the
    row parameter. points: points with errors, with or without exchanged roles. An extremum that cannot be
    located is omitted; the point after it has a `row_parameter_error_at_extremum` of NaN."""
    sloped_points = {}
    for i, point in enumerate(points):
        # The chords to and from points with exchanged roles.
        if any(map(problem.are_exchanged_at, points[max(i - 1, 0) : i + 2])):
            exchanged = problem.with_roles(point, exchanged=True)
            sloped_points[i] = _PointWithSlope(exchanged, problem.axis_slope_at(exchanged, problem.workspace))
    result: list[SolvedCurvePoint] = []
    extremum_error = 0.0
    for i, point in enumerate(points):
        # The stored error belongs to the branch parameter, which is another one with exchanged roles.
        has_plane_error = not problem.are_exchanged_at(point)
        error = (
            point.branch_parameter_error
            if has_plane_error
            else _parameter_error_along_row(problem, sloped_points, i)
        )
        result.append(
            replace(
                problem.with_unexchanged_roles(point),
                branch_parameter_error=error,
                row_parameter_error_at_extremum=extremum_error,
            )
        )
        extremum_error = 0.0
        if (
            i in sloped_points
            and i + 1 in sloped_points
            and sloped_points[i].slope * sloped_points[i + 1].slope < 0
        ):
            try:
                result.append(_located_extremum(problem, sloped_points[i], sloped_points[i + 1]))
            except FAILURE_EXCEPTIONS:
                # An extremum that exists but is not located leaves the range of rows with a branch unknown.
                extremum_error = nan
    return result


def _parameter_error_along_row(
    problem: CurvePointSolver, sloped_points: Mapping[int, _PointWithSlope], i: int
) -> float:
    """Absolute error of the parameter along a row at point i of `sloped_points`. Only the error of the row
    parameter is known there; slope and curvature of the curve convert it."""
    sloped_point = sloped_points[i]
    line_axis = problem.axis_along_row
    row_axis = problem.row_parameter_axis
    error = sloped_point.point.branch_parameter_error / abs(
        row_axis.parameter_per_scaled_coordinate(sloped_point.point.branch_parameter_value)
    )
    # Near the extremum the slope alone would give an infinite error, so the curvature limits it.
    curvature = max(
        abs(_slope_change_rate(sloped_point, sloped_points[j])) for j in (i - 1, i + 1) if j in sloped_points
    )
    # The distance d along the row at which |slope| d + curvature d^2 / 2 is the error of the row coordinate.
    distance = 2 * error / (abs(sloped_point.slope) + sqrt(sloped_point.slope**2 + 2 * curvature * error))
    return distance * abs(line_axis.parameter_per_scaled_coordinate(sloped_point.point.row_parameter_value))


def _slope_change_rate(first: _PointWithSlope, second: _PointWithSlope) -> float:
    """Second derivative of the curve y(x) of `_PointWithSlope`: change of the slope from `first` to `second`,
    divided by the change of x."""
    return (second.slope - first.slope) / (second.point.row_coordinate - first.point.row_coordinate)


def _located_extremum(
    problem: CurvePointSolver, first: _PointWithSlope, second: _PointWithSlope
) -> SolvedCurvePoint:
    """The extremum of the row parameter between the successive points `first` and `second` of a curve, with
    the errors of both parameters; raises Unsolvable. problem: solver for points of the curve."""
    slopes = first.slope, second.slope
    tolerance = ROW_EXTREMUM_SETTINGS.relative_slope_tolerance * abs(second.slope - first.slope)

    def slope(point: SolvedCurvePoint) -> float:
        return problem.axis_slope_at(point, problem.workspace)

    point = problem.point_at_zero_between(first.point, second.point, slope, slopes, tolerance)
    family = problem.cycle_family_at(point)
    finer_mesh = family.finer_mesh_than(point)
    # The row on the finer mesh is compared at the same place along the row, where it is stationary.
    fine = family.corrected_point(
        finer_mesh.interpolated_orbit(point.orbit), point.row_coordinate, SEARCH_LINE_ALONG_BRANCH
    )
    slope_error = (
        CURVE_SECANT_SETTINGS.error_per_mesh_difference * abs(slope(fine) - slope(point)) + tolerance
    )
    line_axis = problem.axis_along_row
    # An extremum is displaced by the error of the slope over its rate of change.
    distance = slope_error / abs(_slope_change_rate(first, second))
    # With exchanged roles `branch_parameter_value` is the row parameter.
    difference = CURVE_SECANT_SETTINGS.error_per_mesh_difference * abs(
        fine.branch_parameter_value - point.branch_parameter_value
    )
    return replace(
        problem.with_unexchanged_roles(point),
        branch_parameter_error=distance
        * abs(line_axis.parameter_per_scaled_coordinate(point.row_parameter_value)),
        row_parameter_error_at_extremum=difference
        + CURVE_SECANT_SETTINGS.min_relative_error * abs(point.branch_parameter_value),
    )
