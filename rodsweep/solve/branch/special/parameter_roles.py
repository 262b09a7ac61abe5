"""Roles of the two parameters of a plane along a curve of folds.

The matrix of the cycle's equations with the branch parameter as a further unknown has full rank at a fold. It
loses rank where the other parameter is extremal on the curve, as where a closed branch shrinks to one cycle.
There the matrix with the other parameter as the unknown has full rank. A fold does not depend on which of the
two parameters varies along the branch. Near such an extremum the parameters therefore exchange their roles.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....determinant.parameter_plane import PlaneAxis
from ....model.parameters import PARAMETERS
from ....model.rod import Rod
from ...orbit.matrix.workspace import NewtonWorkspace
from ..bordered.matrix import BorderedMatrix
from ..bordered.scale import ArcLengthScale
from .solved_curve_point import SolvedCurvePoint, arc_lengths_from_last_point
from .special_curves import CURVE_IDENTITY_SETTINGS, lagrange_weights
from .special_point import SpecialPointKind


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRoleSettings:
    """Settings for the choice of the parameter along the branch."""

    max_row_parameter_slope_to_exchange: float = 0.02
    """The parameters exchange their roles where the relative change of the row parameter (constant on a row
    of the diagram) along the curve is at most this number times the relative change of the parameter along a
    row. With larger slopes the errors of the parameter along a row are smaller without the exchange."""
    min_coordinate_unit_per_axis_length: float = 0.01
    """Lower limit of the unit of a parameter coordinate (1/k for a stiffness k) in arc lengths, divided by
    the length of its axis in this coordinate. The usual unit, the modulus of the coordinate, may be 0."""


PARAMETER_ROLE_SETTINGS = ParameterRoleSettings()


@dataclass(frozen=True, slots=True)
class ParameterRoles:
    """The two axes of a plane, and the choice of the parameter that is the branch parameter at points of a
    curve of special points. axis_along_row, row_parameter_axis: axes of the parameter along a row and of the
    row parameter. In a point with exchanged roles `branch_parameter_value` is a value of the row parameter,
    and `row_coordinate` a position on `axis_along_row`."""

    kind: SpecialPointKind
    """Kind of the points of the curve; parameters exchange their roles only along curves of folds."""
    axis_along_row: PlaneAxis
    row_parameter_axis: PlaneAxis

    def are_exchanged_at(self, point: SolvedCurvePoint) -> bool:
        """Whether the roles are exchanged at `point`: the branch through the point is followed along the row
        parameter, which is constant on a row of the diagram."""
        return point.scale.parameter_name != self.axis_along_row.parameter_name

    def axes_of(self, point: SolvedCurvePoint) -> tuple[PlaneAxis, PlaneAxis]:
        """(axis of the branch parameter, axis of the other parameter) of `point`."""
        axes = self.axis_along_row, self.row_parameter_axis
        return axes[::-1] if self.are_exchanged_at(point) else axes

    def with_roles(self, point: SolvedCurvePoint, exchanged: bool) -> SolvedCurvePoint:
        """The point `point` with the row parameter (if `exchanged`) or the parameter along a row as the
        branch parameter. If the roles change, the derivatives and the measured error of the point are
        unknown."""
        if self.are_exchanged_at(point) == exchanged:
            return point
        other_axis, branch_axis = self.axes_of(point)
        # The row parameter may be 0 on the curve, where its own size cannot be a unit.
        unit = self._min_coordinate_unit(branch_axis) if exchanged else 0.0
        return replace(
            point,
            # At a fold the branches along both parameters have the same direction.
            scale=ArcLengthScale.at_orbit(
                point.orbit, branch_axis.parameter_name, point.scale.min_deflection_unit, unit
            ),
            row_coordinate=other_axis.scaled_coordinate(point.branch_parameter_value),
            branch_parameter_value=point.row_parameter_value,
            row_parameter_value=point.branch_parameter_value,
            measured_error=None,
            secant_parameter_error=0.0,
            normal_derivatives=None,
        )

    def with_unexchanged_roles(self, point: SolvedCurvePoint) -> SolvedCurvePoint:
        """The point `point` with the parameter along a row as the branch parameter."""
        return self.with_roles(point, exchanged=False)

    def need_exchange_between(self, first: SolvedCurvePoint, second: SolvedCurvePoint) -> bool:
        """Whether the parameters exchange their roles on the chord between the points `first` and `second` of
        a curve."""
        changes = (
            second.orbit.form.rod.coordinate(axis.parameter_name)
            - first.orbit.form.rod.coordinate(axis.parameter_name)
            for axis in (self.axis_along_row, self.row_parameter_axis)
        )
        return self._is_row_parameter_almost_constant(second.orbit.form.rod, *changes)

    def need_exchange_beyond(self, points: Sequence[SolvedCurvePoint], length: float) -> bool:
        """Whether the parameters exchange their roles on the step of the arc length `length` beyond the last
        of `points`: on the last chord or on the predicted chord the row parameter hardly changes, or the row
        parameter turns back between these chords and the parameter along a row does not."""
        last_points = [
            self.with_unexchanged_roles(point)
            for point in points[-CURVE_IDENTITY_SETTINGS.max_extrapolation_points :]
        ]
        # Roles are compared in the plane, because earlier points may have exchanged roles.
        if self.need_exchange_between(*last_points[-2:]):
            return True
        rods = [point.orbit.form.rod for point in last_points]
        names = self.axis_along_row.parameter_name, self.row_parameter_axis.parameter_name
        coordinates = np.array([[rod.coordinate(name) for name in names] for rod in rods])
        predicted_change = (
            lagrange_weights(arc_lengths_from_last_point(last_points), length) @ coordinates - coordinates[-1]
        )
        # A parameter that turns within the step is flat somewhere in it, even if neither chord is.
        turns = predicted_change * (coordinates[-1] - coordinates[-2]) < 0
        # If both turn, as at a cusp, the exchange gains nothing.
        return bool(turns[1] and not turns[0]) or self._is_row_parameter_almost_constant(
            rods[-1], *predicted_change
        )

    def need_exchange_at(self, point: SolvedCurvePoint, slope: float) -> bool:
        """Whether the parameters exchange their roles on the first step from `point`, whose branch parameter
        is the parameter along a row. slope: derivative of the position on the axis of this parameter with
        respect to the position on the other axis, along the curve."""
        rod = point.orbit.form.rod
        changes = (
            axis.path_variable_per_scaled_coordinate(getattr(rod, axis.parameter_name))
            for axis in (self.axis_along_row, self.row_parameter_axis)
        )
        # At the first point no chord exists yet, so the slope of the curve comes from the matrix.
        line_change, row_change = changes
        return self._is_row_parameter_almost_constant(rod, slope * line_change, row_change)

    def axis_slope_at(self, point: SolvedCurvePoint, workspace: NewtonWorkspace) -> float:
        """Derivative of the position on the axis of the branch parameter of `point` with respect to the
        position on the other axis, along the curve. workspace: memory of Newton's matrices."""
        matrix = BorderedMatrix(point.orbit, point.scale, workspace)
        rod = point.orbit.form.rod
        branch_change, other_change = (
            axis.path_variable_per_scaled_coordinate(getattr(rod, axis.parameter_name))
            for axis in self.axes_of(point)
        )
        # At a fold the parameter is stationary along the branch, so only the other parameter moves the fold.
        response = matrix.parameter_derivative_by_other_parameter(
            self.axes_of(point)[1].parameter_name, point.branch_direction
        )
        return response * other_change / branch_change

    def _is_row_parameter_almost_constant(self, rod: Rod, line_change: float, row_change: float) -> bool:
        """Whether a step along a curve of folds changes the row parameter, relatively, much less than the
        parameter along a row; False for other curves. rod: rod by whose parameters the changes are divided.
        line_change, row_change: change of the coordinate of the parameter along a row, and of the row
        parameter."""
        if self.kind != SpecialPointKind.fold:
            return False
        # Relative changes, because the two parameters may have ranges of very different size.
        line_ratio, row_ratio = (
            abs(change) / max(abs(rod.coordinate(axis.parameter_name)), self._min_coordinate_unit(axis))
            for axis, change in ((self.axis_along_row, line_change), (self.row_parameter_axis, row_change))
        )
        return row_ratio <= PARAMETER_ROLE_SETTINGS.max_row_parameter_slope_to_exchange * line_ratio

    def _min_coordinate_unit(self, axis: PlaneAxis) -> float:
        """Lower limit of the unit of arc length in which the coordinate of the parameter of `axis` is
        measured (`min_coordinate_unit` of an `ArcLengthScale`)."""
        parameter = PARAMETERS[axis.parameter_name]
        # The limits may be values of a stiffness, whose coordinate is its inverse.
        length = abs(parameter.coordinate(axis.stop) - parameter.coordinate(axis.start))
        return PARAMETER_ROLE_SETTINGS.min_coordinate_unit_per_axis_length * float(length)
