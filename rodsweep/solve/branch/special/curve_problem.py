"""Continuation of a curve of folds or torus points over two parameters, from a row to an end of the curve."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....arrays import Array
from ....solve_progress import SolvePosition, report
from ....wording import counted
from ...continuation.curve import Curve, StepControl, StepResult, StopReason, follow_curve, zero_along_step
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.measures import least_stretch_of_orbit
from ...orbit.newton import relative_change
from ...orbit.orbit_mesh import mesh_of
from ...unsolvable import Unsolvable, WorkLimitReached
from ..bordered.matrix import BorderedMatrix
from .augmented.fold_and_torus_functions import pair_nearest_unit_circle
from .curve_ends import END_REASON_BY_MARGIN, END_SETTINGS, ROW_EDGE_MARGIN_INDICES
from .curve_prediction import orbit_with_parameters, predicted_orbit, weighted_sum
from .curve_start import first_point_of_curve
from .cycle_family import CycleFamily
from .parameter_roles import ParameterRoles
from .row_extremum import with_row_extrema
from .solved_curve_point import ALONG_BRANCH, SolvedPoint, line_across, with_parameter_errors
from .special_curves import CURVE_IDENTITY_SETTINGS, CurveEndReason
from .special_point import SpecialKind, SpecialPoint

CURVE_STEP_CONTROL = StepControl(
    first_length=0.01,
    max_length=0.1,
    min_length=1e-4,
    target_error=3e-3,
    max_error=0.1,
    prediction_order=CURVE_IDENTITY_SETTINGS.max_interpolated_points,
    max_angle=0.55,
    max_length_ratio=2.0,
    max_solutions=400,
)
"""Step length control; a step has the three components of `ArcLengthScale` and the row coordinate, 0 to 1."""


@dataclass(frozen=True, slots=True)
class SpecialCurveProblem(ParameterRoles):
    """Curves of folds or torus points in a plane, as a problem of `follow_curve`. row_direction: 1 or -1,
    sign of the first step in the row parameter."""

    workspace: NewtonWorkspace
    row_direction: float = 1.0

    def follow_from(self, special: SpecialPoint, row: float) -> tuple[list[SolvedPoint], CurveEndReason]:
        """Returns (points of the curve from `special`, on the row with the parameter value `row`; reason for
        its end); raises Unsolvable."""
        first = first_point_of_curve(special, self.line_axis.name, self.row_axis, row, self.workspace)
        curve = follow_curve(self, first, CURVE_STEP_CONTROL, self._report)
        points = with_row_extrema(self, with_parameter_errors(curve.solutions))
        return points, self._end_reason(curve)

    def _end_reason(self, curve: Curve[SolvedPoint]) -> CurveEndReason:
        """Reason for the end of the curve `curve`, as stored in the result file."""
        if curve.end_reason is StopReason.zero_margin:
            return END_REASON_BY_MARGIN[curve.margin_index]
        if curve.end_reason is StopReason.closed:
            return CurveEndReason.closed
        return (
            self._reason_for_loss(curve.solutions[-1])
            if curve.end_reason is StopReason.no_further_solution
            else CurveEndReason.not_followed
        )

    def _report(self, points: Sequence[SolvedPoint]) -> None:
        """Reports the last point of a curve to the progress display."""
        text = f"{self.row_axis.name} = {points[-1].row_parameter:.5g}, {counted(len(points), 'point')}"
        report(lambda: SolvePosition(text))

    def step(self, previous: Sequence[SolvedPoint], length: float) -> StepResult[SolvedPoint]:
        """The next point, with prediction error and cosine of the angle between the last two steps; raises
        Unsolvable. previous: points so far. length: arc length; on the first step, change of the row
        coordinate. On the first step the cosine is 1."""
        if len(previous) == 1:
            last, direction = self._first_roles_and_direction(previous[0])
            start = last.orbit
            row = last.row_coordinate + direction * length
            line = ALONG_BRANCH
            rates = None
        else:
            points = self._points_for_prediction(previous, length)
            last = points[-1]
            start, row = predicted_orbit(self, points, length)
            change = last.scale.components(start) - last.scale.components(last.orbit)
            line = line_across(np.append(change, row - last.row_coordinate), *points[-2:])
            rates = last.normal_derivatives
        point = self.family(last).corrected_point_with_error(start, row, line, rates, last)
        mesh = mesh_of(point.orbit)
        predicted = start if mesh == mesh_of(start) else mesh.interpolated_orbit(start)
        error = relative_change(predicted, point.orbit.values - predicted.values)
        if len(previous) == 1:  # the prediction was the cycle of another row
            return StepResult(point, min(error, CURVE_STEP_CONTROL.max_error), 1.0)
        old_step = last.step_from(points[-2])
        new_step = point.step_from(last)
        return StepResult(
            point, error, float(old_step @ new_step / np.linalg.norm(old_step) / np.linalg.norm(new_step))
        )

    def family(self, point: SolvedPoint) -> CycleFamily:
        """The cycles near a point of the curve, with the roles of the parameters at this point."""
        return CycleFamily.near_point(self.kind, self.axes_of(point)[1], point, self.workspace)

    def _first_roles_and_direction(self, first: SolvedPoint) -> tuple[SolvedPoint, float]:
        """Returns (the point `first` with the roles of the first step, sign of this step)."""
        if self.kind != SpecialKind.fold:
            return first, self.row_direction
        slope = self.axis_slope_at(first, self.workspace)
        if not self.need_exchange_at(first, slope):
            return first, self.row_direction
        return self.with_roles(first, exchanged=True), self.row_direction * float(np.sign(slope))

    def _points_for_prediction(self, previous: Sequence[SolvedPoint], length: float) -> list[SolvedPoint]:
        """The last points of `previous`, with the roles of a step of the arc length `length`."""
        exchanged = self.need_exchange_beyond(previous, length)
        last_points = previous[-CURVE_IDENTITY_SETTINGS.max_interpolated_points :]
        return [self.with_roles(point, exchanged) for point in last_points]

    def margins(self, point: SolvedPoint) -> Array:
        """Margins, (7,); the curve ends where a margin becomes 0: distances from the four edges, 1 -
        `RodMaterial.crushing_ratio` - `crushing`, smallest h1, largest tip y minus `min_amplitude`."""
        # The edges belong to the plane, whichever parameter varies along the branch.
        plane_point = self.in_plane(point)
        x = self.line_axis.coordinate(plane_point.parameter)
        y = plane_point.row_coordinate
        rod = point.orbit.form.rod
        crushing = 1 - END_SETTINGS.crushing_margin - rod.material.crushing_ratio(rod.F, rod.k1, rod.taper)
        stretch = least_stretch_of_orbit(point.orbit)
        return np.array([x, 1 - x, y, 1 - y, crushing, stretch, point.tip_y_max - END_SETTINGS.min_amplitude])

    def located_zero(
        self, previous: Sequence[SolvedPoint], outer: SolvedPoint, margin: int
    ) -> SolvedPoint | None:
        """The point between `previous[-1]` and `outer` at which the margin with index `margin` is 0; None if
        this point is `previous[-1]` itself. For the margin of the amplitude: `outer`. Raises Unsolvable."""
        if END_REASON_BY_MARGIN[margin] is CurveEndReason.hopf:
            return outer  # no cycle exists at the Hopf point itself: the curve's end is extrapolated
        inner = self.with_roles(previous[-1], self.are_exchanged_at(outer))
        ends = float(self.margins(inner)[margin]), float(self.margins(outer)[margin])
        if ends[0] <= END_SETTINGS.max_edge_distance:
            return None
        if margin not in ROW_EDGE_MARGIN_INDICES:
            point = self.zero_between(inner, outer, lambda point: float(self.margins(point)[margin]), ends)
        else:
            point = self.point_on_row(inner, outer, float(margin - ROW_EDGE_MARGIN_INDICES[0]))
            if self.are_exchanged_at(outer):
                # The error measured at `outer`, of the other parameter, does not apply.
                return self.family(point).corrected_point_with_error(
                    point.orbit, point.row_coordinate, ALONG_BRANCH
                )
        return replace(point, measured_error=outer.measured_error and outer.measured_error.for_next_point)

    def zero_between(
        self,
        inner: SolvedPoint,
        outer: SolvedPoint,
        function: Callable[[SolvedPoint], float],
        end_values: tuple[float, float],
        tolerance: float = END_SETTINGS.margin_tolerance,
    ) -> SolvedPoint:
        """The point between `inner` and `outer`, with equal roles, at which `function` is 0; raises
        Unsolvable. end_values: values of the function at `inner` and `outer`. tolerance: tolerance of the
        function."""
        points: dict[float, SolvedPoint] = {0.0: inner, 1.0: outer}

        def value(fraction: float) -> float:
            points[fraction] = self.point_near_chord(inner, outer, fraction)
            return function(points[fraction])

        return points[zero_along_step(value, end_values, 1.0, tolerance, END_SETTINGS.margin_tolerance)]

    def is_closed_by(self, previous: Sequence[SolvedPoint], point: SolvedPoint) -> bool:
        """Whether a curve, with more than `min_loop_points` points, passes its first point on this step."""
        exchanged = self.are_exchanged_at(point)
        first, last = (self.with_roles(previous[i], exchanged) for i in (0, -1))
        step = point.step_from(last)
        step_from_first = point.step_from(first)
        projection = float(step_from_first @ step) / float(step @ step)
        is_near = float(np.linalg.norm(step_from_first)) <= float(np.linalg.norm(step))
        return len(previous) > END_SETTINGS.min_loop_points and 0 <= projection <= 1 and is_near

    def point_near_chord(self, first: SolvedPoint, second: SolvedPoint, fraction: float) -> SolvedPoint:
        """Point of the curve near the fraction of the chord from `first` to `second`; raises Unsolvable."""
        weights = 1 - fraction, fraction
        start, row = weighted_sum(self, (first, second), weights, mesh_of(second.orbit))
        line = line_across(second.step_from(first), first, second)
        return self.family(second).corrected_point(start, row, line, second.normal_derivatives)

    def point_on_row(self, first: SolvedPoint, second: SolvedPoint, row: float) -> SolvedPoint:
        """Point of the curve between `first` and `second`. row: its row coordinate. Raises Unsolvable."""
        inner, outer = map(self.in_plane, (first, second))
        length = outer.row_coordinate - inner.row_coordinate
        fraction = (row - inner.row_coordinate) / length if length else 0.0
        if self.need_exchange_between(inner, outer):
            near_point = self._point_near_row(inner, outer, row)
            try:
                return self.family(near_point).corrected_point(near_point.orbit, row, ALONG_BRANCH)
            except WorkLimitReached:
                raise
            except Unsolvable:
                return near_point  # the matrix of the correction is nearly singular beside an extremum
        start, _ = weighted_sum(self, (inner, outer), (1 - fraction, fraction), mesh_of(outer.orbit))
        return self.family(outer).corrected_point(start, row, ALONG_BRANCH, outer.normal_derivatives)

    def _point_near_row(self, inner: SolvedPoint, outer: SolvedPoint, row: float) -> SolvedPoint:
        """Point of the curve between `inner` and `outer` at the row coordinate `row` within a tolerance,
        found with exchanged roles; raises Unsolvable."""
        ends = [self.with_roles(point, exchanged=True) for point in (inner, outer)]

        def distance(point: SolvedPoint) -> float:
            return self.in_plane(point).row_coordinate - row

        point = self.zero_between(ends[0], ends[1], distance, (distance(ends[0]), distance(ends[1])))
        value = self.row_axis.value(row)
        orbit = orbit_with_parameters(point.orbit, {self.row_axis.name: value})
        return replace(self.in_plane(point), orbit=orbit, row_coordinate=row, row_parameter=value)

    def _reason_for_loss(self, last: SolvedPoint) -> CurveEndReason:
        """Reason why a curve was lost beyond its last point: `resonance`, or `not_followed` if unknown."""
        if self.kind == SpecialKind.torus:
            pair = pair_nearest_unit_circle(BorderedMatrix(last.orbit, last.scale, self.workspace))
            if pair is None or abs(pair.imag) < END_SETTINGS.min_sine_at_resonance * abs(pair):
                return CurveEndReason.resonance
        return CurveEndReason.not_followed
