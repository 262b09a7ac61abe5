"""Continuation of a curve of folds or torus points over two parameters, from a special point on a row of the
diagram to an end of the curve."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....arrays import Array
from ....solve_progress import SolvePosition, report
from ....wording import counted
from ...continuation.curve import Curve, StepControl, StepResult, StopReason, follow_curve
from ...orbit.measures import least_stretch_of_orbit
from ...orbit.newton import relative_change
from ...orbit.orbit_mesh import mesh_of_orbit
from ..bordered.matrix import BorderedMatrix
from .augmented.fold_and_torus_test_functions import multiplier_pair_nearest_unit_circle
from .curve_ends import END_REASON_BY_MARGIN, ROW_EDGE_MARGIN_INDICES, SPECIAL_CURVE_END_SETTINGS
from .curve_point_solver import CurvePointSolver
from .curve_prediction import predicted_orbit_and_row_coordinate
from .curve_start import first_point_of_curve
from .row_extremum import points_with_row_parameter_extrema
from .solved_curve_point import (
    SEARCH_LINE_ALONG_BRANCH,
    SolvedCurvePoint,
    points_with_parameter_errors,
    search_line_across_curve,
)
from .special_curves import CURVE_IDENTITY_SETTINGS, CurveEndReason
from .special_point import SpecialPoint, SpecialPointKind

CURVE_STEP_CONTROL = StepControl(
    first_length=0.01,
    max_length=0.1,
    min_length=1e-4,
    target_prediction_error=3e-3,
    max_prediction_error=0.1,
    prediction_order=CURVE_IDENTITY_SETTINGS.max_extrapolation_points,
    max_angle=0.55,
    max_successive_length_ratio=2.0,
    max_solutions=400,
)
"""Step length control along a curve of folds or torus points. Arc length has four components: the three of
`ArcLengthScale`, and `row_coordinate`, a position on an axis of the plane from 0 to 1."""


@dataclass(frozen=True, slots=True)
class SpecialCurveProblem(CurvePointSolver):
    """Curves of folds or torus points in a plane, as a problem of `follow_curve`.
    first_step_sign_in_row_parameter: 1 or -1, sign of the first step in the row parameter, which is constant
    on a row of the diagram."""

    first_step_sign_in_row_parameter: float = 1.0

    def follow_from(self, special: SpecialPoint, row: float) -> tuple[list[SolvedCurvePoint], CurveEndReason]:
        """Returns (points, reason): points of the curve from the special point `special`, which lies on the
        row with the parameter value `row`, and reason for the end of the curve; raises Unsolvable."""
        first = first_point_of_curve(
            special, self.axis_along_row.parameter_name, self.row_parameter_axis, row, self.workspace
        )
        curve = follow_curve(self, first, CURVE_STEP_CONTROL, self._report_progress)
        points = points_with_row_parameter_extrema(self, points_with_parameter_errors(curve.solutions))
        return points, self._end_reason(curve)

    def _end_reason(self, curve: Curve[SolvedCurvePoint]) -> CurveEndReason:
        """Reason for the end of the curve `curve`, as stored in the result file."""
        if curve.end_reason is StopReason.zero_margin:
            return END_REASON_BY_MARGIN[curve.margin_index]
        if curve.end_reason is StopReason.closed:
            return CurveEndReason.closed
        return (
            self._reason_for_lost_curve(curve.solutions[-1])
            if curve.end_reason is StopReason.no_further_solution
            else CurveEndReason.not_followed
        )

    def _report_progress(self, points: Sequence[SolvedCurvePoint]) -> None:
        """Reports the last point of a curve to the progress display."""
        place = f"{self.row_parameter_axis.parameter_name} = {points[-1].row_parameter_value:.5g}"
        text = f"{place}, {counted(len(points), 'point')}"
        report(lambda: SolvePosition(text))

    def step(self, previous: Sequence[SolvedCurvePoint], length: float) -> StepResult[SolvedCurvePoint]:
        """The next point, with prediction error and cosine of the angle between the last two steps; raises
        Unsolvable. previous: points solved so far. length: arc length of the step; on the first step instead
        the change of `row_coordinate`, a position on an axis of the plane from 0 to 1. On the first step the
        cosine is 1."""
        if len(previous) == 1:
            last, direction = self._first_roles_and_direction(previous[0])
            start = last.orbit
            row = last.row_coordinate + direction * length
            line = SEARCH_LINE_ALONG_BRANCH
            rates = None
        else:
            points = self._points_for_prediction(previous, length)
            last = points[-1]
            start, row = predicted_orbit_and_row_coordinate(self, points, length)
            change = last.scale.components(start) - last.scale.components(last.orbit)
            line = search_line_across_curve(np.append(change, row - last.row_coordinate), *points[-2:])
            rates = last.normal_derivatives
        point = self.cycle_family_at(last).corrected_point_with_error(start, row, line, rates, last)
        mesh = mesh_of_orbit(point.orbit)
        predicted = start if mesh == mesh_of_orbit(start) else mesh.interpolated_orbit(start)
        error = relative_change(predicted, point.orbit.values - predicted.values)
        if len(previous) == 1:  # the prediction was the cycle of another row
            return StepResult(point, min(error, CURVE_STEP_CONTROL.max_prediction_error), 1.0)
        old_step = last.step_from(points[-2])
        new_step = point.step_from(last)
        return StepResult(
            point, error, float(old_step @ new_step / np.linalg.norm(old_step) / np.linalg.norm(new_step))
        )

    def _first_roles_and_direction(self, first: SolvedCurvePoint) -> tuple[SolvedCurvePoint, float]:
        """Returns (the point `first` with the roles of the first step, sign of the change of `row_coordinate`
        on this step)."""
        if self.kind != SpecialPointKind.fold:
            return first, self.first_step_sign_in_row_parameter
        slope = self.axis_slope_at(first, self.workspace)
        if not self.need_exchange_at(first, slope):
            return first, self.first_step_sign_in_row_parameter
        return self.with_roles(first, exchanged=True), self.first_step_sign_in_row_parameter * float(
            np.sign(slope)
        )

    def _points_for_prediction(
        self, previous: Sequence[SolvedCurvePoint], length: float
    ) -> list[SolvedCurvePoint]:
        """The last points of `previous`, from which the next point is predicted; in these points the two
        parameters exchange their roles if the step of the arc length `length` requires the exchange."""
        exchanged = self.need_exchange_beyond(previous, length)
        last_points = previous[-CURVE_IDENTITY_SETTINGS.max_extrapolation_points :]
        return [self.with_roles(point, exchanged) for point in last_points]

    def margins_to_curve_end(self, point: SolvedCurvePoint) -> Array:
        """Margins of a point, (7,); the curve ends where a margin becomes 0. They are: distances from the
        four edges, 1 - `RodMaterial.force_over_crushing_force` - `crushing_margin`, smallest stretch h1,
        largest tip y minus `min_amplitude`."""
        # The edges belong to the plane, whichever parameter varies along the branch.
        plane_point = self.with_unexchanged_roles(point)
        x = self.axis_along_row.scaled_coordinate(plane_point.branch_parameter_value)
        y = plane_point.row_coordinate
        rod = point.orbit.form.rod
        crushing = (
            1
            - SPECIAL_CURVE_END_SETTINGS.crushing_margin
            - rod.material.force_over_crushing_force(rod.F, rod.k1, rod.taper)
        )
        stretch = least_stretch_of_orbit(point.orbit)
        return np.array(
            [
                x,
                1 - x,
                y,
                1 - y,
                crushing,
                stretch,
                point.tip_y_max - SPECIAL_CURVE_END_SETTINGS.min_amplitude,
            ]
        )

    def point_at_zero_margin(
        self, previous: Sequence[SolvedCurvePoint], outer: SolvedCurvePoint, margin: int
    ) -> SolvedCurvePoint | None:
        """The point between `previous[-1]` and `outer` at which the margin with index `margin` is 0; None if
        this point is `previous[-1]` itself. For the margin of the amplitude: `outer`. Raises Unsolvable."""
        if END_REASON_BY_MARGIN[margin] is CurveEndReason.hopf:
            return outer  # no cycle exists at the Hopf point itself: the curve's end is extrapolated
        inner = self.with_roles(previous[-1], self.are_exchanged_at(outer))
        ends = (
            float(self.margins_to_curve_end(inner)[margin]),
            float(self.margins_to_curve_end(outer)[margin]),
        )
        if ends[0] <= SPECIAL_CURVE_END_SETTINGS.max_distance_from_plane_edge:
            return None
        if margin not in ROW_EDGE_MARGIN_INDICES:
            point = self.point_at_zero_between(
                inner, outer, lambda point: float(self.margins_to_curve_end(point)[margin]), ends
            )
        else:
            point = self.point_on_row(inner, outer, float(margin - ROW_EDGE_MARGIN_INDICES[0]))
            if self.are_exchanged_at(outer):
                # The error measured at `outer`, of the other parameter, does not apply.
                return self.cycle_family_at(point).corrected_point_with_error(
                    point.orbit, point.row_coordinate, SEARCH_LINE_ALONG_BRANCH
                )
        return replace(point, measured_error=outer.measured_error and outer.measured_error.for_next_point)

    def is_closed_by(self, previous: Sequence[SolvedCurvePoint], point: SolvedCurvePoint) -> bool:
        """Whether a curve, with more than `min_points_of_closed_curve` points, passes its first point on the
        step from `previous[-1]` to `point`."""
        exchanged = self.are_exchanged_at(point)
        first, last = (self.with_roles(previous[i], exchanged) for i in (0, -1))
        step = point.step_from(last)
        step_from_first = point.step_from(first)
        projection = float(step_from_first @ step) / float(step @ step)
        is_near = float(np.linalg.norm(step_from_first)) <= float(np.linalg.norm(step))
        return (
            len(previous) > SPECIAL_CURVE_END_SETTINGS.min_points_of_closed_curve
            and 0 <= projection <= 1
            and is_near
        )

    def _reason_for_lost_curve(self, last: SolvedCurvePoint) -> CurveEndReason:
        """Reason why a curve could not be continued beyond its last point: `resonance`, or `not_followed` if
        unknown."""
        if self.kind == SpecialPointKind.torus:
            pair = multiplier_pair_nearest_unit_circle(BorderedMatrix(last.orbit, last.scale, self.workspace))
            if pair is None or abs(pair.imag) < SPECIAL_CURVE_END_SETTINGS.min_sine_at_resonance * abs(pair):
                return CurveEndReason.resonance
        return CurveEndReason.not_followed
