"""Correction of a predicted point of a curve of folds or torus points over two parameters.

Cycles near a special point form a family with two variables: arc length along the branch (`bordered`), and
the second parameter. In this family the special points form a smooth curve, also at a cusp, where both
parameters turn back: the zeros of a test function. The secant method finds a zero across the curve
(`secant_method_across_curve`). The error is the difference between two meshes, measured at about every third
point, plus the error of the secant method.
"""

from dataclasses import dataclass, replace
from math import ceil

from ....arrays import Array
from ....determinant.parameter_plane import PlaneAxis
from ...orbit.coefficient_tails import smooth_space_and_time_tails
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_limit_error, mesh_of_orbit
from ...unsolvable import Unsolvable
from ..bordered.matrix import BorderedMatrix
from ..bordered.scale import ArcLengthScale
from .augmented.fold_and_torus_test_functions import FoldTestFunction, TorusTestFunction
from .curve_prediction import orbit_with_parameters
from .secant_method_across_curve import SecantSearch
from .solved_curve_point import (
    CURVE_SECANT_SETTINGS,
    CurveErrorCalibration,
    NormalDerivatives,
    SearchLine,
    SolvedCurvePoint,
)
from .special_point import SpecialPointKind


@dataclass(frozen=True, slots=True)
class CycleFamily:
    """Two-parameter family of the cycles near a point of a curve of special points.

    kind: fold or torus. row_parameter_axis: axis of the second parameter, whose value is fixed along a
    branch. scale: units of arc length. branch_direction: direction of the branch in components (deflection,
    log period, parameter), (3,). has_small_cycles: whether the fold test function is divided by the
    deflection, because a Hopf point is near. workspace: memory of Newton's matrices.
    """

    kind: SpecialPointKind
    row_parameter_axis: PlaneAxis
    scale: ArcLengthScale
    branch_direction: Array
    has_small_cycles: bool
    workspace: NewtonWorkspace

    @classmethod
    def near_point(
        cls, kind: SpecialPointKind, row_axis: PlaneAxis, point: SolvedCurvePoint, workspace: NewtonWorkspace
    ) -> "CycleFamily":
        """The family of the cycles near `point` of a curve of special points of the kind `kind`. row_axis:
        axis of the second parameter, whose value is fixed along a branch. workspace: memory of Newton's
        matrices."""
        has_small_cycles = (
            kind == SpecialPointKind.fold and point.tip_y_max < CURVE_SECANT_SETTINGS.max_tip_y_of_small_cycle
        )
        return cls(kind, row_axis, point.scale, point.branch_direction, has_small_cycles, workspace)

    def unsolved_orbit_at_row(self, orbit: Orbit, row_coordinate: float) -> Orbit:
        """The orbit with unchanged values, for the rod whose second parameter has the position
        `row_coordinate`, from 0 to 1, on its axis; raises Unsolvable."""
        return orbit_with_parameters(
            orbit, {self.row_parameter_axis.parameter_name: self.row_parameter_axis.value(row_coordinate)}
        )

    def test_function(self, matrix: BorderedMatrix) -> FoldTestFunction | TorusTestFunction:
        """The test function of this kind of special points, for cycles near the orbit of `matrix`."""
        if self.kind == SpecialPointKind.fold:
            return FoldTestFunction(matrix, self.branch_direction, self.has_small_cycles)
        return TorusTestFunction(matrix)

    def corrected_point(
        self,
        start: Orbit,
        row_coordinate: float,
        line: SearchLine,
        derivatives: NormalDerivatives | None = None,
        is_other_mesh: bool = False,
    ) -> SolvedCurvePoint:
        """The point of the curve near the orbit `start`, found by the secant method across the curve; raises
        Unsolvable.

        row_coordinate: position of the second parameter of `start` on its axis, from 0 to 1. line: line of
        the search. derivatives: derivatives from an earlier search, used if their direction is close to the
        direction of `line`. is_other_mesh: whether `derivatives` were computed at the same point on another
        mesh.
        """
        # Derivatives along another direction across the curve would mislead the secant method.
        is_usable = (
            derivatives
            and derivatives.direction @ line.direction
            >= CURVE_SECANT_SETTINGS.min_cosine_for_derivative_reuse
        )
        start_derivatives = derivatives if is_usable else None
        search = SecantSearch(self, start, row_coordinate, line, start_derivatives, is_other_mesh)
        for _ in range(CURVE_SECANT_SETTINGS.max_secant_steps):
            point = search.make_step()
            if point is not None:
                return point
        raise Unsolvable("the secant method across the curve does not converge")

    def corrected_point_with_error(
        self,
        start: Orbit,
        row_coordinate: float,
        line: SearchLine,
        derivatives: NormalDerivatives | None = None,
        previous: SolvedCurvePoint | None = None,
    ) -> SolvedCurvePoint:
        """The point of the curve near `start` with an error estimate, on a finer mesh if necessary; raises
        Unsolvable.

        previous: previous point of the curve, whose measured error is used if it still applies.
        row_coordinate: position of the second parameter of `start` on its axis, from 0 to 1. line: line of
        the search. derivatives: derivatives from an earlier search.
        """
        coarser_point = self.corrected_point(start, row_coordinate, line, derivatives)
        if previous and previous.measured_error and previous.measured_error.applies_at(coarser_point):
            return replace(coarser_point, measured_error=previous.measured_error.for_next_point)
        # Each finer mesh is used twice: for the error of the point on the coarser mesh, then as the coarser
        # mesh.
        for _ in range(CURVE_SECANT_SETTINGS.max_finer_meshes):
            mesh = mesh_of_orbit(coarser_point.orbit)
            finer_mesh = self.finer_mesh_than(coarser_point)
            normal_derivatives = coarser_point.normal_derivatives
            start = finer_mesh.interpolated_orbit(coarser_point.orbit)
            fine_point = self.corrected_point(
                start, coarser_point.row_coordinate, line, normal_derivatives, is_other_mesh=True
            )
            # The solutions on both meshes may be displaced along the curve; the slope removes this
            # displacement from the error.
            chord_change = line.chord_slope * (fine_point.row_coordinate - coarser_point.row_coordinate)
            parameter_difference = abs(
                fine_point.branch_parameter_value - coarser_point.branch_parameter_value - chord_change
            )
            error = (
                CURVE_SECANT_SETTINGS.error_per_mesh_difference * parameter_difference
                + CURVE_SECANT_SETTINGS.min_relative_error * abs(fine_point.branch_parameter_value)
            )
            if error <= CURVE_SECANT_SETTINGS.relative_parameter_accuracy * abs(
                fine_point.branch_parameter_value
            ):
                errors = CurveErrorCalibration(
                    error / abs(coarser_point.branch_parameter_value),
                    smooth_space_and_time_tails(coarser_point.orbit),
                    mesh,
                )
                return replace(coarser_point, measured_error=errors)
            coarser_point = fine_point
        raise mesh_limit_error()

    def finer_mesh_than(self, point: SolvedCurvePoint) -> OrbitMesh:
        """A mesh finer than the mesh of `point` in space and time; raises Unsolvable if it is not allowed."""
        mesh = mesh_of_orbit(point.orbit)
        interval_count = ceil(CURVE_SECANT_SETTINGS.time_interval_count_ratio * mesh.interval_count)
        mesh_of_higher_order = mesh.with_order(mesh.order + CURVE_SECANT_SETTINGS.element_order_increase)
        finer_mesh = replace(mesh_of_higher_order, interval_count=interval_count)
        if not finer_mesh.is_allowed:
            raise mesh_limit_error()
        return finer_mesh
