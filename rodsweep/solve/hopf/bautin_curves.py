"""Curves of generalised Hopf points over three parameters.

Generalised Hopf points, D(i eta) = 0 and Re c = 0 (D: determinant, c: Landau coefficient), form a curve over
three parameters. Each step prescribes the parameter that changes fastest, so folds in all parameters are
possible. The predictor is the line through the last two points; the corrector moves along the Hopf curve.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from itertools import pairwise

import numpy as np

from ...arrays import Array
from ...determinant.parameter_plane import ParameterPlane, PlaneAxis
from ...determinant.stability_boundary import StabilityBoundary
from ...model.rod import Rod
from ...solve_progress import SolvePosition, report
from ..continuation.curve import StepResult, StopReason, follow_curve
from ..point_outcome import FAILURE_EXCEPTIONS
from ..unsolvable import Unsolvable
from .bautin_points import BAUTIN_POINT_SETTINGS, BautinPoint, HopfNormalForms
from .bautin_settings import BAUTIN_SETTINGS, BAUTIN_STEP_CONTROL


class BautinEndReason(IntEnum):
    """Reason why a curve ends. none: the point is not an end. range_end: end of the third parameter's range.
    plane_edge: end of the range of another parameter. not_found: no further point was found. list_full:
    maximum number of points. closed: the curve returns to its first point."""

    none = 0
    range_end = 1
    plane_edge = 2
    not_found = 3
    list_full = 4
    closed = 5


END_BY_STOP_REASON = {
    StopReason.closed: BautinEndReason.closed,
    StopReason.no_further_solution: BautinEndReason.not_found,
    StopReason.max_solutions: BautinEndReason.list_full,
}
"""`BautinEndReason` by `StopReason`, without `zero_margin`, which means an end of a parameter's range."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BautinCurvePoint:
    """A generalised Hopf point over three parameters. scaled_point: continuation coordinates, (4,): three
    scaled parameters, log frequency. parameter_values, parameter_errors: both parameters of the plane, then
    the third parameter, (3,). frequency in 1/tau2, landau_imag = Im c in 1/(tau2 L^2)."""

    scaled_point: Array
    parameter_values: Array
    parameter_errors: Array
    frequency: float
    landau_imag: float


@dataclass(frozen=True, slots=True)
class BautinCurve:
    """Points of a curve in order, and the reasons for its two ends."""

    points: tuple[BautinCurvePoint, ...]
    """Points of the curve from its first to its last end, with the points at the requested values."""
    end_reasons: tuple[BautinEndReason, BautinEndReason]
    """Reasons for the ends at the first and at the last point."""


@dataclass(frozen=True, slots=True)
class BautinProblem:
    """Problem for `follow_curve`: generalised Hopf points over three parameters. axes: these parameters, with
    their ranges. rod: rod with all other parameters. third_parameter_values: values of the third parameter at
    which further points are solved, (m,). landau_accuracy: relative accuracy of c. first_step_sign: sign of
    the first step along the third parameter."""

    rod: Rod
    axes: tuple[PlaneAxis, PlaneAxis, PlaneAxis]
    third_parameter_values: Array
    landau_accuracy: float
    first_step_sign: float = 1.0

    def as_curve_point(self, point: BautinPoint, index: int, value: float) -> BautinCurvePoint:
        """`point` of a plane of two parameters as a point of a curve. index, value: index and value of the
        third parameter, which is constant in this plane."""
        values = np.insert(point.parameter_values, index, value)
        coordinates = [
            axis.scaled_coordinate(float(each)) for axis, each in zip(self.axes, values, strict=True)
        ]
        return BautinCurvePoint(
            scaled_point=np.array([*coordinates, np.log(point.frequency)]),
            parameter_values=values,
            parameter_errors=np.insert(point.parameter_errors, index, 0.0),
            frequency=point.frequency,
            landau_imag=point.landau_imag,
        )

    def solve_point(self, guess: Array, fixed_index: int) -> BautinCurvePoint:
        """The generalised Hopf point near the coordinates `guess`, (4,), with the parameter of index
        `fixed_index` fixed; raises Unsolvable."""
        free = [i for i in range(3) if i != fixed_index]
        values = {
            axis.parameter_name: axis.value(float(x)) for axis, x in zip(self.axes, guess[:3], strict=True)
        }
        plane = ParameterPlane(self.rod.with_values(**values), (self.axes[free[0]], self.axes[free[1]]))
        boundary = StabilityBoundary(plane, 0.0)
        accuracy = min(self.landau_accuracy, BAUTIN_POINT_SETTINGS.coarsest_accuracy)
        curve = HopfNormalForms(boundary, np.empty((0, 3)), accuracy)  # finds Hopf points only near a guess
        start = guess[[*free, 3]]
        point = self._zero_by_secants(curve, start, boundary.tangent(start))
        return self.as_curve_point(point, fixed_index, values[self.axes[fixed_index].parameter_name])

    def step(self, previous: Sequence[BautinCurvePoint], length: float) -> StepResult[BautinCurvePoint]:
        """The next point, predicted along the last chord, at first along the third parameter; raises
        Unsolvable. previous: points so far. length: largest parameter change divided by its range."""
        v = previous[-1].scaled_point
        tangent = np.array([0.0, 0.0, self.first_step_sign, 0.0])
        if len(previous) > 1:
            chord = v - previous[-2].scaled_point
            # Step lengths are fractions of a parameter's range; the frequency has no range.
            tangent = chord / np.abs(chord[:3]).max()
        try:
            point, is_on_end = self._point_cut_at_range_end(v, length * tangent)
        except ValueError as reason:
            raise Unsolvable(f"the step leaves the allowed range of the parameters: {reason}") from reason
        prediction_error = float(np.abs(point.scaled_point[:3] - v[:3] - length * tangent[:3]).max()) / length
        # No prediction error for the first step, which has no chord, and for a step that an edge shortened.
        return StepResult(point, 0.0 if is_on_end or len(previous) == 1 else prediction_error, 1.0)

    def _point_cut_at_range_end(self, v: Array, change: Array) -> tuple[BautinCurvePoint, bool]:
        """Returns (point near v + change, (4,), or on the end of a range that this step crosses; whether the
        point lies on such an end). The step is cut because parameters outside the ranges may not be allowed.
        Raises Unsolvable."""
        predicted = (v + change)[:3]
        range_ends = np.where(predicted > 1, 1.0, np.where(predicted < 0, 0.0, np.nan))
        fractions = (range_ends - v[:3]) / np.where(change[:3] == 0, 1.0, change[:3])
        # The parameter that changes most is fixed: at a fold in another parameter the point is unique.
        if np.isnan(fractions).all():
            return self.solve_point(v + change, int(np.argmax(np.abs(change[:3])))), False
        index = int(np.nanargmin(fractions))
        guess = v + fractions[index] * change
        guess[index] = range_ends[index]
        return self.solve_point(guess, index), True

    def margins_to_curve_end(self, point: BautinCurvePoint) -> Array:
        """Distances from both ends of ranges 1, 2 and 3, scaled to [0, 1], minus a tolerance, (6,)."""
        return (
            np.ravel([point.scaled_point[:3], 1 - point.scaled_point[:3]], order="F")
            - BAUTIN_SETTINGS.edge_tolerance
        )

    def point_at_zero_margin(
        self, previous: Sequence[BautinCurvePoint], outer: BautinCurvePoint, margin: int
    ) -> BautinCurvePoint | None:
        """The point `outer`: `_point_cut_at_range_end` has cut the step at the end of a range. The other
        arguments are not used."""
        return outer

    def is_closed_by(self, previous: Sequence[BautinCurvePoint], point: BautinCurvePoint) -> bool:
        """Whether the curve with the points `previous` has more than `BAUTIN_SETTINGS.min_loop_points`
        points, and its first point lies between its last point and `point`."""
        first = previous[0].scaled_point
        last = previous[-1].scaled_point
        step_length = float(np.linalg.norm(point.scaled_point - previous[-1].scaled_point))
        is_near = max(np.linalg.norm(first - last), np.linalg.norm(first - point.scaled_point)) < step_length
        return len(previous) > BAUTIN_SETTINGS.min_loop_points and bool(is_near)

    @staticmethod
    def _zero_by_secants(curve: HopfNormalForms, start: Array, direction: Array) -> BautinPoint:
        """The point with Re c = 0 near the line start + s direction, by secant steps of s; raises Unsolvable.
        start, direction: (3,)."""
        # Secants, because the normal form does not give the derivatives of Re c.
        previous_s = 0.0
        s = BAUTIN_SETTINGS.first_secant_step
        last_real_part = curve.hopf_point_on_plane(
            start, direction, curve.landau_accuracy
        ).relative_landau_real_part
        for _ in range(BAUTIN_SETTINGS.max_secant_steps):
            hopf_point = curve.hopf_point_on_plane(start + s * direction, direction, curve.landau_accuracy)
            if hopf_point.relative_landau_real_part == last_real_part:
                break
            slope = (hopf_point.relative_landau_real_part - last_real_part) / (s - previous_s)
            step = -hopf_point.relative_landau_real_part / slope
            if not abs(s + step) < BAUTIN_STEP_CONTROL.max_length:
                break
            position_error = hopf_point.coefficients.landau_error / abs(slope)
            if abs(step) <= max(BAUTIN_SETTINGS.secant_tolerance, position_error):
                return curve.as_bautin_point(hopf_point, 0, direction * (position_error + abs(step)))
            last_real_part = hopf_point.relative_landau_real_part
            previous_s = s
            s = s + step
        raise Unsolvable("no generalised Hopf point is found near the predicted point")


def bautin_curve(problem: BautinProblem, start: BautinCurvePoint) -> BautinCurve:
    """The curve of generalised Hopf points through `start`, followed in both directions."""
    backward, first_reason = _half_curve(replace(problem, first_step_sign=-1.0), start)
    if first_reason is BautinEndReason.closed:
        return BautinCurve(tuple(backward), (first_reason, first_reason))
    forward, reason = _half_curve(problem, start)
    # Both lists begin with the start, which is taken once.
    return BautinCurve((*backward[:0:-1], *forward), (first_reason, reason))


def lies_on_curve(point: BautinCurvePoint, curve: BautinCurve) -> bool:
    """Whether `point`, at a requested value of the third parameter, equals a point of `curve`."""
    distances = (float(np.abs(point.scaled_point - other.scaled_point).max()) for other in curve.points)
    return any(distance < BAUTIN_SETTINGS.same_point_distance for distance in distances)


def _half_curve(
    problem: BautinProblem, start: BautinCurvePoint
) -> tuple[list[BautinCurvePoint], BautinEndReason]:
    """Returns (points, end_reason). points: points of the curve from `start` on, at first in the direction
    `problem.first_step_sign` of the third parameter, including points at its requested values."""
    if not 0 < start.scaled_point[2] + problem.first_step_sign * BAUTIN_STEP_CONTROL.min_length < 1:
        return [start], BautinEndReason.range_end

    def report_progress(points: Sequence[BautinCurvePoint]) -> None:
        report(lambda: SolvePosition(f"curve of generalised Hopf points, {len(points)} points"))

    curve = follow_curve(problem, start, BAUTIN_STEP_CONTROL, report_progress)
    points = curve.solutions[:1]
    for point, next_point in pairwise(curve.solutions):
        try:
            points += [*_requested_points(problem, point, next_point), next_point]
        except (*FAILURE_EXCEPTIONS, ValueError):
            return points, BautinEndReason.not_found
    if curve.end_reason is StopReason.zero_margin:
        is_range_end = curve.margin_index // 2 == 2
        return points, BautinEndReason.range_end if is_range_end else BautinEndReason.plane_edge
    return points, END_BY_STOP_REASON[curve.end_reason]


def _requested_points(
    problem: BautinProblem, first: BautinCurvePoint, second: BautinCurvePoint
) -> list[BautinCurvePoint]:
    """Points at the requested values of the third parameter between `first` and `second`; raises Unsolvable,
    ValueError."""
    a, b = first.scaled_point[2], second.scaled_point[2]
    requested_z = map(problem.axes[2].scaled_coordinate, problem.third_parameter_values)
    inner_z = [z for z in requested_z if min(a, b) < z < max(a, b)]
    points = []
    for z in sorted(inner_z, reverse=bool(a > b)):
        if min(abs(z - a), abs(z - b)) > BAUTIN_SETTINGS.same_point_distance:
            guess = first.scaled_point + (z - a) / (b - a) * (second.scaled_point - first.scaled_point)
            guess[2] = z
            points.append(problem.solve_point(guess, 2))
    return points
