"""Curves in a plane of rods on which the spectrum changes: Hopf points, and double real eigenvalues.

A boundary (`determinant.boundary`) is followed through its folds (`boundary_problem`). A fold is a point
where a coordinate is extremal on the curve, for example where a flutter window closes: the tangent has no
component along the axis of this coordinate.
"""

import math
from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import ParameterPlane
from ....determinant.stability_boundary import BoundarySolution, StabilityBoundary
from ....solve_progress import report
from ...continuation.curve import StopReason, follow_curve, step_length_to_zero
from ...unsolvable import Unsolvable
from .boundary_problem import (
    BOUNDARY_CURVE_SETTINGS,
    BOUNDARY_STEP_CONTROL,
    BoundaryCurveProblem,
    BoundaryEndReason,
    BoundaryPoint,
)


@dataclass(frozen=True, slots=True)
class CurveFold:
    """Extremum of the coordinate `axis` (0 or 1) on a curve: values and absolute errors of both parameters,
    and the eigenvalue at the extremum."""

    axis: int
    parameter_values: tuple[float, float]
    frequency: float
    """Imaginary part of the eigenvalue at the extremum, in 1/tau2; 0 for a double real eigenvalue."""
    growth_rate: float
    """Real part of the eigenvalue at the extremum, in 1/tau2; 0 at a Hopf point."""
    parameter_errors: tuple[float, float]


@dataclass(frozen=True, slots=True)
class BoundaryCurve:
    """A curve of Hopf points, or of double real eigenvalues.

    double_eigenvalue_sign: 0 on a curve of Hopf points, else the sign of the double eigenvalue.

    parameter_values: both parameters of each point, (points, 2). frequency, growth_rate: Im and Re of the
    eigenvalue, in 1/tau2, (points,). end_reasons: reasons for the ends at the first and at the last point.
    """

    double_eigenvalue_sign: float
    parameter_values: Array
    frequency: Array
    growth_rate: Array
    folds: tuple[CurveFold, ...]
    """Extrema of the first parameter, then of the second, each in their order along the curve."""
    end_reasons: tuple[BoundaryEndReason, BoundaryEndReason]
    scaled_points: Array
    """Points of the curve, (points, 3), as x, y, h: both parameters, scaled to 0 and 1 at the edges of the
    plane, and h = log |eigenvalue|."""

    @property
    def consists_of_hopf_points(self) -> bool:
        return self.double_eigenvalue_sign == 0


def trace_boundary(
    double_eigenvalue_sign: float, plane: ParameterPlane, start: tuple[float, float], eigenvalue: float
) -> BoundaryCurve | None:
    """The boundary curve through the point `start`, both parameters scaled to 0 and 1 at the edges of the
    plane, with |w| = |eigenvalue|; None if no point of a curve is found there. double_eigenvalue_sign: 0 for
    a curve of Hopf points, else the sign of the double eigenvalue.

    The curve is followed in both directions until it leaves the plane, closes, reaches a crushed rod, or
    cannot be followed further.
    """
    problem = BoundaryCurveProblem(StabilityBoundary(plane, double_eigenvalue_sign))
    guess = np.array([*start, math.log(abs(eigenvalue))])
    try:
        tangent = problem.boundary.tangent(guess)
        first_point = BoundaryPoint.with_tangent_along(problem.boundary_point_near(guess, tangent), tangent)
    except (ValueError, ArithmeticError, Unsolvable):
        return None
    forward = follow_curve(problem, first_point, BOUNDARY_STEP_CONTROL, lambda _: report())
    backward = forward
    solutions = forward.solutions
    if forward.end_reason is not StopReason.closed:
        backward = follow_curve(
            problem,
            BoundaryPoint(first_point.scaled_point, -first_point.tangent),
            BOUNDARY_STEP_CONTROL,
            lambda _: report(),
        )
        # The first point is common to both directions.
        solutions = [*backward.solutions[:0:-1], *solutions]
    points = np.array([point.scaled_point for point in solutions])
    # The chord of coincident points, as on an edge, has no direction.
    are_distinct = np.abs(np.diff(points, axis=0)).max(axis=1) > BOUNDARY_CURVE_SETTINGS.max_merged_distance
    return _curve_with_folds(
        problem,
        points[np.append(are_distinct, True)],
        (problem.end_reason_of(backward), problem.end_reason_of(forward)),
    )


def _curve_with_folds(
    problem: BoundaryCurveProblem, points: Array, end_reasons: tuple[BoundaryEndReason, BoundaryEndReason]
) -> BoundaryCurve:
    """The curve through `points`, (points, 3), with the folds between them. end_reasons: reasons for the ends
    at the first and at the last point."""
    boundary = problem.boundary
    folds = []
    if len(points) > 1:
        # The last point gets the direction of the last chord.
        chords = np.diff(points, axis=0, append=points[-1:] + (points[-1:] - points[-2:-1]))
        tangents = np.array([boundary.tangent(v) for v in points])
        # Tangents have no sign of their own; along the chords, a change of sign of a component is a fold.
        tangents *= np.where((tangents * chords).sum(axis=1) < 0, -1.0, 1.0)[:, None]
        curve_points = list(map(BoundaryPoint, points, tangents))
        for axis in (0, 1):
            for i in np.flatnonzero(tangents[:-1, axis] * tangents[1:, axis] < 0):
                fold = _fold_between(problem, curve_points[i], curve_points[i + 1], axis)
                if fold is not None:
                    folds.append(fold)
    # One by one: the rounding of NumPy's exp of an array depends on the position of an element in memory.
    growth_rate, frequency = np.array([boundary.growth_rate_and_frequency(h) for h in points[:, 2]]).T
    axes = boundary.plane.axes
    values = np.array([[axis.value(x) for axis, x in zip(axes, v[:2], strict=True)] for v in points])
    return BoundaryCurve(
        boundary.double_eigenvalue_sign, values, frequency, growth_rate, tuple(folds), end_reasons, points
    )


def _fold_between(
    problem: BoundaryCurveProblem, a: BoundaryPoint, b: BoundaryPoint, axis: int
) -> CurveFold | None:
    """The fold between the points a and b, where the tangent is normal to `axis`; None if not found."""
    boundary = problem.boundary
    tangent_error = _tangent_error(problem.boundary)
    chord = b.scaled_point - a.scaled_point
    solutions = dict[float, BoundarySolution]()
    size = float(np.linalg.norm(chord))

    def component(length: float) -> float:
        # Kept, so that the solution at the zero need not be computed again.
        solutions[length] = problem.boundary_point_near(a.scaled_point + length / size * chord, chord / size)
        return float(BoundaryPoint.with_tangent_along(solutions[length], chord).tangent[axis])

    end_components = float(a.tangent[axis]), float(b.tangent[axis])
    try:
        length = step_length_to_zero(
            component,
            end_components,
            size,
            BOUNDARY_CURVE_SETTINGS.fold_location_tolerance,
            BOUNDARY_CURVE_SETTINGS.fold_location_tolerance,
        )
        # Along the chord the tangent's component changes from end to end: its error moves the fold.
        curve_error = (
            (abs(component(length)) + tangent_error) * size / abs(end_components[1] - end_components[0])
        )
    except Unsolvable:
        return None
    return _fold_at(boundary, solutions[length], axis, curve_error)


def _tangent_error(boundary: StabilityBoundary) -> float:
    """Error of the components of a boundary's unit tangents."""
    settings = BOUNDARY_CURVE_SETTINGS
    if not boundary.plane.are_rods_uniform_and_linear:
        return settings.arm_tangent_error
    return (
        settings.double_eigenvalue_tangent_error
        if boundary.double_eigenvalue_sign
        else settings.hopf_tangent_rounding_error
    )


def _fold_at(
    boundary: StabilityBoundary, solution: BoundarySolution, axis: int, curve_error: float
) -> CurveFold:
    """The fold of coordinate `axis` at the point `solution` of a boundary. curve_error: error of the fold's
    position along the curve."""
    axes = boundary.plane.axes
    first, second = (a.value(float(x)) for a, x in zip(axes, solution.v[:2], strict=True))
    units = [abs(a.parameter_per_scaled_coordinate(x)) for a, x in zip(axes, (first, second), strict=True)]
    # Along the curve the extremal coordinate is stationary at the fold, the other coordinate is not.
    errors = [
        unit * (solution.error if i == axis else solution.error + curve_error) for i, unit in enumerate(units)
    ]
    growth_rate, frequency = boundary.growth_rate_and_frequency(solution.v[2])
    return CurveFold(axis, (first, second), frequency, growth_rate, (errors[0], errors[1]))
