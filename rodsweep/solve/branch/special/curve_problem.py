"""Continuation of a curve of folds or torus points over two parameters, from a row to an end of the curve."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import PlaneAxis
from ....solve_progress import SolvePosition, report
from ....wording import counted
from ...continuation.curve import Curve, StepControl, StepResult, StopReason, follow_curve, zero_along_step
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.measures import least_stretch_of_orbit
from ...orbit.newton import relative_change
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of
from ..bordered.matrix import BorderedMatrix
from .augmented.fold_and_torus_functions import pair_nearest_unit_circle
from .curve_start import first_point_of_curve
from .cycle_family import CycleFamily
from .solved_curve_point import (
    ALONG_BRANCH,
    SolvedPoint,
    arc_lengths,
    line_across,
    orbit_with_parameters,
    with_parameter_errors,
)
from .special_curves import CURVE_IDENTITY_SETTINGS, CurveEndReason, lagrange_weights
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


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveEndSettings:
    """Settings for the ends of a curve of special points."""

    min_loop_points: int = 5
    """Whether a curve closes is tested only after more than this number of points."""
    max_edge_distance: float = 1e-8
    """Points at most this far from an edge of the plane lie on the edge; each axis has length 1."""
    margin_tolerance: float = 1e-10
    """Tolerance of a margin, and of the position at which it becomes 0 (divided by the step length)."""
    crushing_margin: float = 1e-3
    """A curve ends where the relative distance of F from the force that crushes the arm is this number."""
    crushing_tolerance: float = 1e-6
    """Relative tolerance of the length of a step that is shortened to end at half of `crushing_margin`."""
    min_amplitude: float = 0.01
    """A curve ends, at an extrapolated Hopf point, where the largest tip y, in L, is below this number."""
    min_sine_at_resonance: float = 0.2
    """A lost curve of torus points has ended at a resonance (the complex pair becomes real) if the sine of
    the angle between multiplier and real axis is below this number."""


END_SETTINGS = CurveEndSettings()
ROW_EDGE_MARGINS = (2, 3)
"""Indices, in `SpecialCurveProblem.margins`, of the two edges that are parallel to the rows."""
END_BY_MARGIN = (
    *4 * (CurveEndReason.edge,),
    CurveEndReason.crushed,
    CurveEndReason.left_the_model,
    CurveEndReason.hopf,
)
"""Reason for the end of a curve, by the index of the margin that becomes 0; four are distances from edges."""


@dataclass(frozen=True, slots=True)
class SpecialCurveProblem:
    """Curves of folds or torus points in a plane, as a problem of `follow_curve`. line_axis, row_axis: axes
    of the parameter along a row and of the row parameter. row_direction: 1 or -1, sign of the first step in
    the row parameter."""

    kind: SpecialKind
    line_axis: PlaneAxis
    row_axis: PlaneAxis
    workspace: NewtonWorkspace
    row_direction: float = 1.0

    def follow_from(self, special: SpecialPoint, row: float) -> tuple[list[SolvedPoint], CurveEndReason]:
        """(points of the curve from `special` on row `row`, reason for its end); raises Unsolvable."""
        first = first_point_of_curve(special, self.line_axis.name, self.row_axis, row, self.workspace)
        curve = follow_curve(self, first, CURVE_STEP_CONTROL, self._report)
        return with_parameter_errors(curve.solutions), self._end_reason(curve)

    def _end_reason(self, curve: Curve[SolvedPoint]) -> CurveEndReason:
        """Reason for the end of the curve `curve`, as stored in the result file."""
        if curve.end_reason is StopReason.zero_margin:
            return END_BY_MARGIN[curve.margin_index]
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
        last = previous[-1]
        if len(previous) == 1:
            start = last.orbit
            row = last.row_coordinate + self.row_direction * length
            line = ALONG_BRANCH
            rates = None
        else:
            start, row = self._predicted_orbit(previous, self._step_before_crushing(previous, length))
            change = last.scale.components(start) - last.scale.components(last.orbit)
            line = line_across(np.append(change, row - last.row_coordinate), *previous[-2:])
            rates = last.normal_derivatives
        point = self._family(last).corrected_point_with_error(start, row, line, rates, last)
        mesh = mesh_of(point.orbit)
        predicted = start if mesh == mesh_of(start) else mesh.interpolated_orbit(start)
        error = relative_change(predicted, point.orbit.values - predicted.values)
        if len(previous) == 1:  # the prediction was the cycle of another row
            return StepResult(point, min(error, CURVE_STEP_CONTROL.max_error), 1.0)
        old = last.step_from(previous[-2])
        new = point.step_from(last)
        return StepResult(point, error, float(old @ new / np.linalg.norm(old) / np.linalg.norm(new)))

    def _family(self, point: SolvedPoint) -> CycleFamily:
        return CycleFamily.near_point(self.kind, self.row_axis, point, self.workspace)

    def _predicted_orbit(self, points: Sequence[SolvedPoint], step: float) -> tuple[Orbit, float]:
        """(orbit, row coordinate) predicted an arc length `step` beyond the last point; raises Unsolvable."""
        tail = points[-CURVE_IDENTITY_SETTINGS.max_interpolated_points :]
        return self._weighted_sum(tail, lagrange_weights(arc_lengths(tail), step), mesh_of(tail[-1].orbit))

    def _step_before_crushing(self, points: Sequence[SolvedPoint], step: float) -> float:
        """The arc length `step`, shortened so that the rod predicted beyond `points` keeps half of the
        crushing margin; unchanged if the last point has less than half of this margin."""
        from scipy.optimize import brentq  # slow import: 0.1 s, for few runs

        known = points[-CURVE_IDENTITY_SETTINGS.max_interpolated_points :]
        lengths = arc_lengths(known)

        def distance(step: float) -> float:
            weights = lagrange_weights(lengths, step)
            rod = known[-1].orbit.form.rod
            value = float(np.dot(weights, [point.parameter for point in known]))
            row = float(np.dot(weights, [point.row_coordinate for point in known]))
            values = {**rod.values, self.line_axis.name: value, self.row_axis.name: self.row_axis.value(row)}
            load = rod.build.crushing_ratio(values["F"], values["k1"], values["taper"])
            return 1 - END_SETTINGS.crushing_margin / 2 - load

        if distance(step) >= 0 or distance(0.0) <= 0:
            return step
        return float(brentq(distance, 0.0, step, rtol=END_SETTINGS.crushing_tolerance))

    def _weighted_sum(
        self, points: Sequence[SolvedPoint], weights: Sequence[float] | Array, mesh: OrbitMesh
    ) -> tuple[Orbit, float]:
        """(orbit on `mesh`, row coordinate): sums of `points` with weights, (points,); raises Unsolvable."""
        values = np.dot(weights, [mesh.interpolated_orbit(point.orbit).values for point in points])
        row = float(np.dot(weights, [point.row_coordinate for point in points]))
        value = float(np.dot(weights, [point.parameter for point in points]))
        orbit = replace(mesh.interpolated_orbit(points[-1].orbit), values=values)
        parameters = {self.line_axis.name: value, self.row_axis.name: self.row_axis.value(row)}
        return orbit_with_parameters(orbit, parameters), row

    def margins(self, point: SolvedPoint) -> Array:
        """Margins, (7,); the curve ends where a margin becomes 0: distances from the four edges, 1 -
        `Build.crushing_ratio` - `crushing_margin`, smallest h1, largest tip y minus `min_amplitude`."""
        x = self.line_axis.coordinate(point.parameter)
        y = point.row_coordinate
        rod = point.orbit.form.rod
        crushing = 1 - END_SETTINGS.crushing_margin - rod.build.crushing_ratio(rod.F, rod.k1, rod.taper)
        stretch = least_stretch_of_orbit(point.orbit)
        return np.array([x, 1 - x, y, 1 - y, crushing, stretch, point.tip_y_max - END_SETTINGS.min_amplitude])

    def located_zero(
        self, previous: Sequence[SolvedPoint], outer: SolvedPoint, margin: int
    ) -> SolvedPoint | None:
        """The point between `previous[-1]` and `outer` at which the margin with index `margin` is 0; None if
        this point is `previous[-1]` itself. For the margin of the amplitude: `outer`. Raises Unsolvable."""
        inner = previous[-1]
        if END_BY_MARGIN[margin] is CurveEndReason.hopf:
            return outer  # no cycle exists at the Hopf point itself: the curve's end is extrapolated
        ends = float(self.margins(inner)[margin]), float(self.margins(outer)[margin])
        if ends[0] <= END_SETTINGS.max_edge_distance:
            return None
        if margin in ROW_EDGE_MARGINS:
            point = self.point_on_row(inner, outer, float(margin - ROW_EDGE_MARGINS[0]))
        else:
            point = self._zero_of_margin(inner, outer, margin, ends)
        return replace(point, measured_error=outer.measured_error and outer.measured_error.for_next_point)

    def _zero_of_margin(
        self, inner: SolvedPoint, outer: SolvedPoint, margin: int, margins: tuple[float, float]
    ) -> SolvedPoint:
        """The point between `inner` and `outer` at which the margin with index `margin` is 0; raises
        Unsolvable. margins: values of this margin at `inner` and `outer`."""
        points: dict[float, SolvedPoint] = {1.0: outer}

        def value(fraction: float) -> float:
            points[fraction] = self.point_near_chord(inner, outer, fraction)
            return float(self.margins(points[fraction])[margin])

        return points[
            zero_along_step(value, margins, 1.0, END_SETTINGS.margin_tolerance, END_SETTINGS.margin_tolerance)
        ]

    def is_closed_by(self, previous: Sequence[SolvedPoint], point: SolvedPoint) -> bool:
        """Whether a curve of over `min_loop_points` points passes its first point on the step to `point`."""
        last = previous[-1]
        step = point.step_from(last)
        step_from_first = point.step_from(previous[0])
        projection = float(step_from_first @ step) / float(step @ step)
        is_near = float(np.linalg.norm(step_from_first)) <= float(np.linalg.norm(step))
        return len(previous) > END_SETTINGS.min_loop_points and 0 <= projection <= 1 and is_near

    def point_near_chord(self, first: SolvedPoint, second: SolvedPoint, fraction: float) -> SolvedPoint:
        """Point of the curve near the fraction of the chord from `first` to `second`; raises Unsolvable."""
        start, row = self._weighted_sum((first, second), (1 - fraction, fraction), mesh_of(second.orbit))
        line = line_across(second.step_from(first), first, second)
        return self._family(second).corrected_point(start, row, line, second.normal_derivatives)

    def point_on_row(self, first: SolvedPoint, second: SolvedPoint, row: float) -> SolvedPoint:
        """Point of the curve between `first` and `second`. row: its row coordinate. Raises Unsolvable."""
        length = second.row_coordinate - first.row_coordinate
        fraction = (row - first.row_coordinate) / length if length else 0.0
        start, _ = self._weighted_sum((first, second), (1 - fraction, fraction), mesh_of(second.orbit))
        return self._family(second).corrected_point(start, row, ALONG_BRANCH, second.normal_derivatives)

    def _reason_for_loss(self, last: SolvedPoint) -> CurveEndReason:
        """Reason why a curve was lost beyond its last point: `resonance`, or `not_followed` if unknown."""
        if self.kind == SpecialKind.torus:
            pair = pair_nearest_unit_circle(BorderedMatrix(last.orbit, last.scale, self.workspace))
            if pair is None or abs(pair.imag) < END_SETTINGS.min_sine_at_resonance * abs(pair):
                return CurveEndReason.resonance
        return CurveEndReason.not_followed
