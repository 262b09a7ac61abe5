"""Points of a curve of folds or torus points between two solved points: near a chord, at a value of the row
parameter, or at a zero of a function."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from ...continuation.curve import step_length_to_zero
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.orbit_mesh import mesh_of_orbit
from ...unsolvable import Unsolvable, WorkLimitReached
from .curve_ends import SPECIAL_CURVE_END_SETTINGS
from .curve_prediction import orbit_with_parameters, weighted_sum_of_curve_points
from .cycle_family import CycleFamily
from .parameter_roles import ParameterRoles
from .solved_curve_point import SEARCH_LINE_ALONG_BRANCH, SolvedCurvePoint, search_line_across_curve


@dataclass(frozen=True, slots=True)
class CurvePointSolver(ParameterRoles):
    """Solver for points of a curve of special points between two solved points of this curve. workspace:
    memory of Newton's matrices."""

    workspace: NewtonWorkspace

    def cycle_family_at(self, point: SolvedCurvePoint) -> CycleFamily:
        """The cycles near a point of the curve; `ParameterRoles` says which parameter is the branch parameter
        at this point."""
        return CycleFamily.near_point(self.kind, self.axes_of(point)[1], point, self.workspace)

    def point_at_zero_between(
        self,
        inner: SolvedCurvePoint,
        outer: SolvedCurvePoint,
        function: Callable[[SolvedCurvePoint], float],
        end_values: tuple[float, float],
        tolerance: float = SPECIAL_CURVE_END_SETTINGS.zero_margin_tolerance,
    ) -> SolvedCurvePoint:
        """The point between `inner` and `outer` at which `function` is 0; `inner` and `outer` must have the
        same branch parameter. Raises Unsolvable. end_values: values of the function at `inner` and `outer`.
        tolerance: modulus of the function that is treated as 0."""
        points: dict[float, SolvedCurvePoint] = {0.0: inner, 1.0: outer}

        def value(fraction: float) -> float:
            points[fraction] = self.point_near_chord(inner, outer, fraction)
            return function(points[fraction])

        return points[
            step_length_to_zero(
                value, end_values, 1.0, tolerance, SPECIAL_CURVE_END_SETTINGS.zero_margin_tolerance
            )
        ]

    def point_near_chord(
        self, first: SolvedCurvePoint, second: SolvedCurvePoint, fraction: float
    ) -> SolvedCurvePoint:
        """Point of the curve near the point at `fraction` of the chord from `first` to `second`; raises
        Unsolvable."""
        weights = 1 - fraction, fraction
        start, row = weighted_sum_of_curve_points(self, (first, second), weights, mesh_of_orbit(second.orbit))
        line = search_line_across_curve(second.step_from(first), first, second)
        return self.cycle_family_at(second).corrected_point(start, row, line, second.normal_derivatives)

    def point_on_row(self, first: SolvedCurvePoint, second: SolvedCurvePoint, row: float) -> SolvedCurvePoint:
        """Point of the curve between `first` and `second` at the row coordinate `row`, the scaled value of
        the row parameter, 0 to 1; raises Unsolvable."""
        inner, outer = map(self.with_unexchanged_roles, (first, second))
        length = outer.row_coordinate - inner.row_coordinate
        fraction = (row - inner.row_coordinate) / length if length else 0.0
        if self.need_exchange_between(inner, outer):
            near_point = self._point_near_row(inner, outer, row)
            try:
                return self.cycle_family_at(near_point).corrected_point(
                    near_point.orbit, row, SEARCH_LINE_ALONG_BRANCH
                )
            except WorkLimitReached:
                raise
            except Unsolvable:
                return near_point  # the matrix of the correction is nearly singular beside an extremum
        start, _ = weighted_sum_of_curve_points(
            self, (inner, outer), (1 - fraction, fraction), mesh_of_orbit(outer.orbit)
        )
        return self.cycle_family_at(outer).corrected_point(
            start, row, SEARCH_LINE_ALONG_BRANCH, outer.normal_derivatives
        )

    def _point_near_row(
        self, inner: SolvedCurvePoint, outer: SolvedCurvePoint, row: float
    ) -> SolvedCurvePoint:
        """Point of the curve between `inner` and `outer` at the row coordinate `row` within a tolerance,
        found with the row parameter as the branch parameter; raises Unsolvable."""
        ends = [self.with_roles(point, exchanged=True) for point in (inner, outer)]

        def distance(point: SolvedCurvePoint) -> float:
            return self.with_unexchanged_roles(point).row_coordinate - row

        point = self.point_at_zero_between(ends[0], ends[1], distance, (distance(ends[0]), distance(ends[1])))
        value = self.row_parameter_axis.value(row)
        orbit = orbit_with_parameters(point.orbit, {self.row_parameter_axis.parameter_name: value})
        return replace(
            self.with_unexchanged_roles(point), orbit=orbit, row_coordinate=row, row_parameter_value=value
        )
