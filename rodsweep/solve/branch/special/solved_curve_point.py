"""A solved point of a curve of special points: its cycle, its error, and derivatives of nearby cycles with
respect to their distance from the curve."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, nan
from typing import ClassVar, NamedTuple

import numpy as np

from ....arrays import Array
from ....model.compiled.kernel_constants import KernelConstants
from ...cycle.cycles_along_parameter import interpolated_change
from ...orbit.coefficient_tails import smooth_space_and_time_tails
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of_orbit
from ..bordered.scale import ArcLengthScale


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveSecantSettings(KernelConstants):
    """Settings for the secant method across a curve of special points, and for the errors of its points."""

    relative_parameter_accuracy: float = 1e-7
    """Relative accuracy of the parameter along a row at the points of a curve. Special points on rows are
    solved to 1e-9."""
    max_points_per_error_measurement: int = 3
    """Maximum number of successive points of a curve that share one measured error."""
    max_tip_y_of_small_cycle: float = 0.05
    """Below this largest tip y, in L, the test function of a fold is divided by the deflection of the cycle;
    without the division the function vanishes at a Hopf point too."""
    first_secant_step: float = 1e-4
    """First secant step, in arc length, if no derivatives are known. Cycles near a symmetry breaking change
    by 40 times the arc length; Newton's method fails after 1e-3 (`tests/hard/test_curve_errors.py`)."""
    max_secant_step: float = 0.1
    """Longest step of the secant method across a curve, in arc length; a longer step is a failure."""
    max_secant_steps: int = 12
    """Maximum number of secant steps for one point."""
    max_distance_from_curve: float = 1e-8
    """Largest distance, in arc length, of a point from the curve after the last, linear secant step."""
    max_secant_error_per_accuracy: float = 0.1
    """The distance of a point from the curve may cause at most this fraction of `relative_parameter_accuracy`
    as relative error of the parameter along a row."""
    relative_slope_error: float = 1e-3
    """Relative error of derivatives that were computed at the same point on another mesh or at an earlier
    step of the same search, in addition to the effect of the curvature."""
    relative_error_of_previous_slope: float = 0.1
    """Assumed relative error of derivatives that were computed at the previous point of the curve, before it
    is multiplied by max(1, assumed relative curvature of the test function)."""
    curvature_growth_factor: float = 4.0
    """Assumed growth of the relative curvature of the test function from one point of the curve to the
    next."""
    min_cosine_for_derivative_reuse: float = 0.9
    """Derivatives along one direction across the curve serve for another direction only if the cosine of the
    angle between the two directions is at least this number."""
    min_cycle_distance_for_derivatives: float = 1e-6
    """Derivatives are computed from two cycles only if their distance, in arc length, is at least this
    number, because the test function has an error of 1e-8."""
    error_per_mesh_difference: float = 3.0
    """Factor from the difference between the points on two meshes to the error estimate."""
    min_relative_error: float = 3e-9
    """Smallest relative error estimate of the parameter along a row."""
    element_order_increase: int = 2
    """Increase of the order of the elements on the next finer mesh."""
    time_interval_count_ratio: float = 1.2
    """Ratio of the number of time intervals of the next finer mesh to the number of the current mesh."""
    max_finer_meshes: int = 5
    """Maximum number of meshes tried for one point after the first mesh, each finer than the mesh before."""
    field_ranges: ClassVar = {"time_interval_count_ratio": (1.0, inf)}
    """Exclusive bounds (lower, upper) of settings by name, as in `KernelConstants`."""


CURVE_SECANT_SETTINGS = CurveSecantSettings()


class SearchLine(NamedTuple):
    """Line across a curve of special points, on which a point of the curve is searched. direction: unit
    vector, (2,), in components (arc length along the branch, `row_coordinate`). chord_slope: change of the
    parameter along a row per `row_coordinate` along the curve, for error estimates."""

    direction: Array
    chord_slope: float = 0.0


SEARCH_LINE_ALONG_BRANCH = SearchLine(np.array([1.0, 0.0]))
"""Search at a fixed row, along the branch."""


@dataclass(frozen=True, eq=False)
class NormalDerivatives:
    """Derivatives of cycles near a curve of special points with respect to the distance from the curve."""

    direction: Array
    """Unit direction across the curve, (2,), in components (arc length along the branch,
    `row_coordinate`)."""
    test_function_slope: float
    """Derivative of the test function, which is 0 on the curve, by the distance from the curve."""
    orbit_derivative: Array
    """Derivative of orbit values and parameter along a row by the distance from the curve, (N + 1,)."""
    mesh: OrbitMesh
    """Mesh of the derivative `orbit_derivative`."""
    difference_quotient_distance: float
    """Distance between the two cycles whose difference quotient gives the derivatives."""
    contraction_rate: float = inf
    """Ratio of successive corrections, divided by the cycle's relative distance from the orbit of the matrix;
    inf if unknown."""
    relative_test_function_curvature: float = inf
    """Modulus of the second derivative of the test function, divided by the first; inf if unknown."""

    def orbit_derivative_on_mesh_of(self, orbit: Orbit) -> Array:
        """The derivative `orbit_derivative`, (N + 1,), interpolated to the mesh of `orbit`."""
        mesh = mesh_of_orbit(orbit)
        if mesh == self.mesh:
            return self.orbit_derivative
        interpolated_orbit = self.mesh.interpolated_orbit(orbit)
        change = interpolated_change(interpolated_orbit, self.orbit_derivative[:-1], mesh)
        return np.append(change, self.orbit_derivative[-1])


@dataclass(frozen=True, eq=False)
class CurveErrorCalibration:
    """Measured error of a point of a curve, used again at the next points, scaled with the squared
    coefficient tails. relative_error: relative error of the parameter along a row at the measured point.
    coefficient_tails, mesh: coefficient tails in space and time, (2,), and mesh of the orbit at the measured
    point. reuse_count: number of points since the measurement."""

    relative_error: float
    coefficient_tails: Array
    mesh: OrbitMesh
    reuse_count: int = 0

    def error_at(self, point: "SolvedCurvePoint") -> float:
        """Absolute error of the parameter along a row at the neighbouring point `point` with the same mesh:
        measured relative error, times squared growth of the tails (at least 1), times parameter."""
        # Errors are of second order in the tails.
        growth = float((smooth_space_and_time_tails(point.orbit) / self.coefficient_tails).max()) ** 2
        return max(growth, 1.0) * self.relative_error * abs(point.branch_parameter_value)

    def applies_at(self, point: "SolvedCurvePoint") -> bool:
        """Whether the measured error may be used at the later point `point`: `reuse_count` is below its
        limit, the mesh is the same, and the scaled error is within the accuracy."""
        max_reuses = CURVE_SECANT_SETTINGS.max_points_per_error_measurement - 1
        is_recent = self.reuse_count < max_reuses and mesh_of_orbit(point.orbit) == self.mesh
        return is_recent and self.error_at(point) <= CURVE_SECANT_SETTINGS.relative_parameter_accuracy * abs(
            point.branch_parameter_value
        )

    @property
    def for_next_point(self) -> "CurveErrorCalibration":
        """The same measured error for the next point of the curve, with `reuse_count` increased by 1."""
        return replace(self, reuse_count=self.reuse_count + 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedCurvePoint:
    """A solved point of a curve of special points in the plane (parameter along a row, row parameter), see
    `ParameterRoles`. At a point with exchanged roles the two parameters change places in every field."""

    orbit: Orbit
    """The cycle at this point of the curve."""
    scale: ArcLengthScale
    """Units of arc length, from the orbit of this point."""
    branch_direction: Array
    """Direction of the branch along the row, (3,), a unit vector in components (deflection, log period,
    parameter)."""
    row_coordinate: float
    """Row parameter, the parameter that differs between rows, scaled to 0 ... 1 over its range."""
    branch_parameter_value: float
    """Value of the parameter along a row."""
    row_parameter_value: float
    """Value of the row parameter."""
    branch_parameter_error: float = nan
    """Absolute error of `branch_parameter_value`; NaN before `points_with_parameter_errors` sets it."""
    row_parameter_error_at_extremum: float = 0.0
    """Absolute error of `row_parameter_value` where it is extremal along the curve; 0 at other points."""
    measured_error: CurveErrorCalibration | None = None
    """Error measured at this point or at an earlier point of the curve; None if unknown."""
    secant_parameter_error: float = 0.0
    """Absolute error of `branch_parameter_value` at fixed row parameter, due to the secant method."""
    normal_derivatives: NormalDerivatives | None = None
    """Derivatives across the curve; None if unknown."""

    @property
    def tip_y_max(self) -> float:
        """Largest tip y of the cycle, in L: the modulus of the tip's y at t = 0."""
        return abs(float(self.orbit.form.tip_coordinates(self.orbit.start_state)[1]))

    def has_mesh_and_roles_of(self, other: "SolvedCurvePoint") -> bool:
        """Whether this point and the point `other` have equal meshes and the same branch parameter."""
        has_same_roles = self.scale.parameter_name == other.scale.parameter_name
        return has_same_roles and mesh_of_orbit(self.orbit) == mesh_of_orbit(other.orbit)

    def step_from(self, other: "SolvedCurvePoint") -> Array:
        """Step from the point `other` to this point, (4,): components (deflection, log period, parameter
        along a row) in units of `scale`, and the change of `row_coordinate`."""
        difference = self.scale.components(self.orbit) - self.scale.components(other.orbit)
        return np.append(difference, self.row_coordinate - other.row_coordinate)

    def unit_normal(self, step: Array) -> Array:
        """Unit normal of the curve, (2,), in components (arc length along the branch, `row_coordinate`).
        step: step along the curve, (4,), by `step_from`."""
        tangent = np.array([float(self.branch_direction @ step[:3]), step[3]])
        # Rotated by a right angle, so that the correction does not move along the curve.
        return np.array([-tangent[1], tangent[0]]) / np.linalg.norm(tangent)


def points_with_parameter_errors(points: Sequence[SolvedCurvePoint]) -> list[SolvedCurvePoint]:
    """The points of a curve, in order, with the field `branch_parameter_error` set: the error due to the mesh
    plus the error of the secant method.

    The error due to the mesh is the error measured last on the curve, scaled to the point; or, if larger, the
    error measured next, scaled back to the point, if that point has the same mesh. Raises ValueError if a
    point has no measured error.
    """
    points_with_errors: list[SolvedCurvePoint] = []
    measured_point: SolvedCurvePoint | None = None
    # In reverse order, so that the next measurement after each point is known.
    for point in reversed(points):
        if point.measured_error is None:
            raise ValueError("the point has no error estimate")
        candidates = [point.measured_error]
        if point.measured_error.reuse_count == 0:
            measured_point = point
        elif measured_point is not None and point.has_mesh_and_roles_of(measured_point):
            assert measured_point.measured_error is not None
            candidates.append(measured_point.measured_error)
        error = max(errors.error_at(point) for errors in candidates) + point.secant_parameter_error
        points_with_errors.append(replace(point, branch_parameter_error=error))
    return points_with_errors[::-1]


def arc_lengths_from_last_point(points: Sequence[SolvedCurvePoint]) -> Array:
    """Arc lengths, (points,), of the points of a curve: 0 at the last point, negative at earlier points."""
    steps = [float(np.linalg.norm(b.step_from(a))) for a, b in zip(points[:-1], points[1:], strict=True)]
    # Zero at the last point, so that predictions have positive lengths.
    return np.asarray(np.cumsum([0.0, *steps]) - sum(steps), float)


def chord_slope(first: SolvedCurvePoint, second: SolvedCurvePoint) -> float:
    """Slope of the chord from `first` to `second`: difference of `branch_parameter_value`, divided by the
    difference of `row_coordinate`; 0 if the row coordinates are equal."""
    difference = second.branch_parameter_value - first.branch_parameter_value
    row_difference = second.row_coordinate - first.row_coordinate
    return difference / row_difference if row_difference else 0.0


def search_line_across_curve(step: Array, first: SolvedCurvePoint, second: SolvedCurvePoint) -> SearchLine:
    """Line on which the point of the curve after the successive points `first` and `second` is searched:
    perpendicular to `step`, (4,), the predicted step from `second` along the curve."""
    return SearchLine(second.unit_normal(step), chord_slope(first, second))
