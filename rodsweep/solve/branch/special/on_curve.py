"""A point of a curve of special points: its cycle, its error, and derivatives of cycles across the curve."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, nan

import numpy as np

from ....arrays import Array
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of
from ...orbit.tails import lasting_tails
from ...point import Unsolvable
from ..bordered.scale import Scale


@dataclass(frozen=True, slots=True, kw_only=True)
class AcrossCurveSettings:
    """Settings of the corrections across a curve of special points, and of the errors of its points."""

    accuracy: float = 1e-7
    """Relative accuracy of the line's parameter at the points of a curve. Special points on rows are solved
    to 1e-9."""
    max_unmeasured: int = 3
    """The error is measured at least at every third point."""
    small_fold_cycle: float = 0.05
    """Largest tip y, in L, of cycles whose fold function is divided by the deflection, since it vanishes at
    the Hopf point too."""
    first_secant: float = 1e-3
    """First step of the secant method across a curve if the derivatives are unknown."""
    longest_secant: float = 0.1
    """A longer step of the secant method has left the curve."""
    max_secants: int = 12
    """Maximum number of secant steps for one point."""
    max_linear_product: float = 1e-9
    """The last secant step is taken without solving at its end if its length times the distance of the last
    two cycles is below this limit; the test function is known to about 1e-8."""
    max_linear_step: float = 1e-6
    """Limit of the last step with derivatives from earlier cycles at the same point, with errors of 1e-3."""
    max_carried_step: float = 1e-7
    """The limit of the last step with derivatives from the previous point, which are known to a tenth."""
    min_cosine: float = 0.9
    """Smallest cosine of the angle between two directions across the curve for which derivatives are
    reused."""
    min_cycle_distance: float = 1e-6
    """Smallest distance of two cycles whose difference gives the derivatives: the test function is known to
    1e-8."""
    error_factor: float = 3.0
    """Safety factor on the difference of two meshes."""
    secant_error: float = 3e-9
    """Relative error of the line's value that the secant method leaves."""
    more_orders: int = 2
    """Increase of the order on the next finer mesh."""
    more_intervals: float = 1.2
    """Factor on the number of intervals on the next finer mesh."""
    max_finer_meshes: int = 5
    """Maximum number of finer meshes for one point."""


ACROSS_CURVE = AcrossCurveSettings()


@dataclass(frozen=True, eq=False)
class NormalDerivatives:
    """Derivatives of a family's cycles with respect to the length normal to its curve."""

    direction: Array
    """Unit direction normal to the curve: its components along the branch and along the rows, (2,)."""
    test: float
    """Derivative of the test function."""
    orbit: Array
    """Derivative of the orbit's values and the line's coordinate, (N + 1,)."""
    mesh: OrbitMesh
    """Mesh of the orbit."""
    span: float
    """Length between the two cycles of the difference quotient."""
    contraction: float = inf
    """Contraction of corrections, as in `NearbyCycles`."""

    def on(self, orbit: Orbit) -> Array:
        """Derivative of an orbit across its curve, on the orbit's own mesh, (N + 1,)."""
        mesh = mesh_of(orbit)
        if mesh == self.mesh:
            return self.orbit
        derivative = replace(self.mesh.carry(orbit), values=self.orbit[:-1])
        return np.append(mesh.carry(derivative).values, self.orbit[-1])


@dataclass(frozen=True, eq=False)
class CurveErrors:
    """Relative error of the line's parameter at a point of a curve; it scales with the squared coefficient
    tails.

    tails: tails of the orbit whose error was measured, in space and time, (2,). mesh: mesh of that orbit.
    age: number of points since that orbit.
    """

    measured: float
    tails: Array
    mesh: OrbitMesh
    age: int = 0

    def at(self, point: "OnCurve") -> float:
        """Absolute error of a neighbouring point on the same mesh."""
        # Errors are of second order in the tails.
        growth = float((lasting_tails(point.orbit) / self.tails).max()) ** 2
        return max(growth, 1.0) * self.measured * abs(point.at)

    def hold_at(self, point: "OnCurve") -> bool:
        """Whether the measured error still applies to the next point and is within the accuracy."""
        recent = self.age < ACROSS_CURVE.max_unmeasured - 1 and mesh_of(point.orbit) == self.mesh
        return recent and self.at(point) <= ACROSS_CURVE.accuracy * abs(point.at)

    @property
    def carried(self) -> "CurveErrors":
        """The measured error, for the next point along the curve."""
        return replace(self, age=self.age + 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class OnCurve:
    """A point of a curve: a cycle with its values of the line's and the rows' parameter."""

    orbit: Orbit
    scale: Scale
    ahead: Array
    """Direction of the cycle's branch in the coordinates of `Scale.place`, (3,)."""
    place: float
    """Coordinate of the rows' parameter on its axis, scaled to [0, 1]."""
    at: float
    """Value of the line's parameter."""
    row: float
    """Value of the rows' parameter."""
    error: float = nan
    """Absolute error of `at`."""
    errors: CurveErrors | None = None
    """Errors that apply to the point, measured here or at an earlier point of the curve."""
    rates: NormalDerivatives | None = None
    """Derivatives across the curve, if known."""

    @property
    def tip_y_max(self) -> float:
        """Modulus of the tip y at t = 0, in L."""
        return abs(float(self.orbit.form.tip(self.orbit.start)[1]))

    def step_from(self, other: "OnCurve") -> Array:
        """Step from another point to this one, (4,): three coordinates of `Scale.place`, then `place`."""
        moved = self.scale.place(self.orbit) - self.scale.place(other.orbit)
        return np.append(moved, self.place - other.place)

    def across(self, step: Array) -> Array:
        """Unit direction perpendicular to a step, (4,), in the plane (along the branch, along the rows),
        (2,)."""
        way = np.array([float(self.ahead @ step[:3]), step[3]])
        # Turned by a right angle: the correction must not slide along the curve.
        return np.array([-way[1], way[0]]) / np.linalg.norm(way)


def errors_between(points: Sequence[OnCurve]) -> list[OnCurve]:
    """Points of a curve in order. The error of each point is the larger of the errors measured before and
    behind."""
    found: list[OnCurve] = []
    behind: CurveErrors | None = None
    # Backwards, so that every point knows the measurement behind it as well as the one before it.
    for point in reversed(points):
        if point.errors is None:
            raise ValueError("the point has no error estimate")
        candidates = [point.errors]
        if point.errors.age == 0:
            behind = point.errors
        elif behind and behind.mesh == mesh_of(point.orbit):
            candidates.append(behind)
        found.append(replace(point, error=max(errors.at(point) for errors in candidates)))
    return found[::-1]


def with_parameters(orbit: Orbit, changed: dict[str, float]) -> Orbit:
    """The values of an orbit for the rod with other values of some parameters; raises Unsolvable."""
    try:
        form = replace(orbit.form, rod=orbit.form.rod.changed(**changed))
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the curve leaves the allowed range of the parameters: {error}") from error
    if form.omega_unknown != orbit.form.omega_unknown:
        raise Unsolvable(
            f"at gamma3 = {form.rod.gamma3:.3g} Omega becomes an unknown or is eliminated, and cycles cannot "
            "be followed across"
        )
    return replace(orbit, form=form)


def lengths_of(points: Sequence[OnCurve]) -> Array:
    """Arc lengths of points relative to the last, (points,), none positive."""
    steps = [float(np.linalg.norm(b.step_from(a))) for a, b in zip(points[:-1], points[1:], strict=True)]
    # Counted from the last point, so that a prediction is at a positive length.
    lengths: Array = np.cumsum([0.0, *steps]) - sum(steps)
    return lengths


def slope_of(one: OnCurve, other: OnCurve) -> float:
    """d(line's value)/d(place) between two points; 0 at equal places."""
    apart = other.place - one.place
    return (other.at - one.at) / apart if apart else 0.0
