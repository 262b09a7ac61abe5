"""A solved point of a curve of special points: cycle, error, and derivatives with respect to the distance
from the curve."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, nan
from typing import ClassVar, NamedTuple

import numpy as np

from ....arrays import Array
from ....model.compiled.kernel_constants import KernelConstants
from ...cycle.cycles_along_parameter import interpolated_change
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of
from ...orbit.tails import smooth_space_and_time_tails
from ..bordered.scale import ArcLengthScale


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveSecantSettings(KernelConstants):
    """Settings for the secant method across a curve of special points, and for the errors of its points."""

    accuracy: float = 1e-7
    """Relative accuracy of the parameter along a row at the points of a curve. Special points on rows are
    solved to 1e-9."""
    max_points_per_measurement: int = 3
    """Maximum number of successive points of a curve that share one measured error."""
    max_small_cycle_y: float = 0.05
    """If the largest tip y, in L, is smaller than this number, the fold test function is divided by the
    deflection; without this division the function vanishes at a Hopf point too."""
    first_secant_step: float = 1e-3
    """First step of the secant method across a curve, in arc length, if no derivatives are known."""
    max_secant_step: float = 0.1
    """Longest step of the secant method across a curve, in arc length; a longer step is a failure."""
    max_secant_steps: int = 12
    """Maximum number of secant steps for one point."""
    max_distance_error: float = 1e-8
    """Largest distance, in arc length, of a point from the curve after the last step of the secant method,
    which is linear."""
    max_secant_error_ratio: float = 0.1
    """Largest relative error of the parameter along a row that the distance of a point from the curve may
    cause, divided by `accuracy`."""
    slope_error: float = 1e-3
    """Relative error of derivatives that were computed at the same point on another mesh or at an earlier
    step of the same search, in addition to the effect of the curvature."""
    previous_point_slope_error: float = 0.1
    """Relative error of derivatives that were computed at the previous point of the curve; increased if the
    curvature exceeds 1."""
    curvature_growth_factor: float = 4.0
    """Assumed curvature of the test function at a point, divided by the curvature at the previous point."""
    min_cosine_for_reuse: float = 0.9
    """Derivatives along one direction across the curve are used for another direction only if the cosine of
    the angle between the two directions is at least this number."""
    min_cycle_distance: float = 1e-6
    """Derivatives are computed from two cycles only if their distance, in arc length, is at least this
    number, because the test function has an error of 1e-8."""
    error_factor: float = 3.0
    """The error estimate is the difference between the points on two meshes, times this factor."""
    min_error: float = 3e-9
    """Smallest relative error estimate of the parameter along a row."""
    order_increase: int = 2
    """Increase of the order of the elements on the next finer mesh."""
    interval_ratio: float = 1.2
    """Ratio of the number of time intervals of the next finer mesh to the number of the current mesh."""
    max_finer_meshes: int = 5
    """Maximum number of meshes tried for one point after the first mesh, each finer than the mesh before."""
    field_ranges: ClassVar = {"interval_ratio": (1.0, inf)}


CURVE_SECANT_SETTINGS = CurveSecantSettings()


class SearchLine(NamedTuple):
    """Line across a curve of special points, on which a point of the curve is searched.

    direction: unit vector, (2,), in components (along the branch, row coordinate). chord_slope: `chord_slope`
    of the curve, which gives the error of the parameter at a fixed row.
    """

    direction: Array
    chord_slope: float = 0.0


ALONG_BRANCH = SearchLine(np.array([1.0, 0.0]))
"""Search at a fixed row, along the branch."""


@dataclass(frozen=True, eq=False)
class NormalDerivatives:
    """Derivatives of cycles near a curve of special points with respect to the distance from the curve."""

    direction: Array
    """Unit direction across the curve, (2,), in components (along the branch, row coordinate)."""
    test_slope: float
    """Derivative of the test function, which is 0 on the curve."""
    orbit_derivative: Array
    """Derivative of the orbit values and of the coordinate of the parameter along a row, (N + 1,)."""
    mesh: OrbitMesh
    """Mesh of the derivative `orbit_derivative`."""
    cycle_distance: float
    """Distance between the two cycles of the difference quotient."""
    contraction_rate: float = inf
    """Ratio of successive corrections, divided by the relative distance from the matrix; inf if unknown."""
    relative_curvature: float = inf
    """Modulus of the second derivative of the test function, divided by the first; inf if unknown."""

    def orbit_derivative_on_mesh_of(self, orbit: Orbit) -> Array:
        """The derivative `orbit_derivative`, (N + 1,), interpolated to the mesh of `orbit`."""
        mesh = mesh_of(orbit)
        if mesh == self.mesh:
            return self.orbit_derivative
        interpolated_orbit = self.mesh.interpolated_orbit(orbit)
        change = interpolated_change(interpolated_orbit, self.orbit_derivative[:-1], mesh)
        return np.append(change, self.orbit_derivative[-1])


@dataclass(frozen=True, eq=False)
class MeasuredCurveError:
    """Measured error of a point of a curve. At the next points the error is used again, scaled with the
    squared coefficient tails.

    relative_error: relative error of the parameter along a row at the measured point. tails, mesh:
    coefficient tails in space and time, (2,), and mesh of the orbit at the measured point.
    reuse_count: number of points since the measurement."""

    relative_error: float
    tails: Array
    mesh: OrbitMesh
    reuse_count: int = 0

    def error_at(self, point: "SolvedPoint") -> float:
        """Absolute error of the parameter along a row at a neighbouring point with the same mesh: the
        measured relative error, increased by the squared growth of the tails, times the parameter."""
        # Errors are of second order in the tails.
        growth = float((smooth_space_and_time_tails(point.orbit) / self.tails).max()) ** 2
        return max(growth, 1.0) * self.relative_error * abs(point.parameter)

    def applies_at(self, point: "SolvedPoint") -> bool:
        """Whether the measured error may be used at the later point `point` of the curve: the measurement is
        recent, the mesh is the same, and the scaled error is within the accuracy."""
        max_reuses = CURVE_SECANT_SETTINGS.max_points_per_measurement - 1
        is_recent = self.reuse_count < max_reuses and mesh_of(point.orbit) == self.mesh
        return is_recent and self.error_at(point) <= CURVE_SECANT_SETTINGS.accuracy * abs(point.parameter)

    @property
    def for_next_point(self) -> "MeasuredCurveError":
        """The same measured error for the next point of the curve, with `reuse_count` increased by 1."""
        return replace(self, reuse_count=self.reuse_count + 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedPoint:
    """A solved point of a curve of special points: cycle, and values of the two parameters of the plane."""

    orbit: Orbit
    scale: ArcLengthScale
    """Units of arc length, from the orbit of this point."""
    branch_direction: Array
    """Direction of the branch along the row, (3,), a unit vector in components (deflection, log period,
    parameter)."""
    row_coordinate: float
    """Position on the axis of the row parameter, from 0 to 1."""
    parameter: float
    """Value of the parameter along a row."""
    row_parameter: float
    """Value of the row parameter."""
    error: float = nan
    """Absolute error of `parameter`; NaN before `with_parameter_errors` sets it."""
    row_extremum_error: float = 0.0
    """Absolute error of `row_parameter` where it is extremal along the curve; 0 at other points."""
    measured_error: MeasuredCurveError | None = None
    """Error measured at this point or at an earlier point of the curve; None if unknown."""
    secant_error: float = 0.0
    """Absolute error of `parameter` at fixed row parameter, by the tolerance of the secant method."""
    normal_derivatives: NormalDerivatives | None = None
    """Derivatives across the curve; None if unknown."""

    @property
    def tip_y_max(self) -> float:
        """Largest tip y of the cycle, in L: the modulus of the tip's y at t = 0."""
        return abs(float(self.orbit.form.tip_coordinates(self.orbit.start_state)[1]))

    def has_mesh_and_roles_of(self, other: "SolvedPoint") -> bool:
        """Whether mesh and branch parameter of this point and of the point `other` agree."""
        has_same_roles = self.scale.parameter_name == other.scale.parameter_name
        return has_same_roles and mesh_of(self.orbit) == mesh_of(other.orbit)

    def step_from(self, other: "SolvedPoint") -> Array:
        """Step from the point `other` to this point, (4,), in components (deflection, log period, parameter
        along a row, row coordinate)."""
        difference = self.scale.components(self.orbit) - self.scale.components(other.orbit)
        return np.append(difference, self.row_coordinate - other.row_coordinate)

    def unit_normal(self, step: Array) -> Array:
        """Unit normal of the curve, (2,), in components (along the branch, row coordinate); perpendicular to
        `step`, (4,), a step along the curve."""
        tangent = np.array([float(self.branch_direction @ step[:3]), step[3]])
        # Rotated by a right angle, so that the correction does not move along the curve.
        return np.array([-tangent[1], tangent[0]]) / np.linalg.norm(tangent)


def with_parameter_errors(points: Sequence[SolvedPoint]) -> list[SolvedPoint]:
    """The points of a curve, in order, with the field `error` set: the error by the mesh plus the error of
    the secant method.

    A measured point has its measured error. A point between two measured points has the larger of the errors
    scaled from these points; the later measured point is used only if it has the same mesh. Raises ValueError
    if a point has no error estimate.
    """
    points_with_errors: list[SolvedPoint] = []
    measured_point: SolvedPoint | None = None
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
        mesh_error = max(errors.error_at(point) for errors in candidates)
        points_with_errors.append(replace(point, error=mesh_error + point.secant_error))
    return points_with_errors[::-1]


def arc_lengths(points: Sequence[SolvedPoint]) -> Array:
    """Arc lengths, (points,), of the points of a curve: 0 at the last point, negative at earlier points."""
    steps = [float(np.linalg.norm(b.step_from(a))) for a, b in zip(points[:-1], points[1:], strict=True)]
    # Zero at the last point, so that predictions have positive lengths.
    lengths: Array = np.cumsum([0.0, *steps]) - sum(steps)
    return lengths


def chord_slope(first: SolvedPoint, second: SolvedPoint) -> float:
    """Slope of the chord between two points of a curve: difference of `parameter`, divided by the difference
    of `row_coordinate`; 0 if the row coordinates are equal."""
    row_difference = second.row_coordinate - first.row_coordinate
    return (second.parameter - first.parameter) / row_difference if row_difference else 0.0


def line_across(step: Array, first: SolvedPoint, second: SolvedPoint) -> SearchLine:
    """Line on which the point of the curve after the successive points `first` and `second` is searched:
    perpendicular to `step`, (4,), the predicted step from `second` along the curve."""
    return SearchLine(second.unit_normal(step), chord_slope(first, second))
