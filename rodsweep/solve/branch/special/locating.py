"""Location of special points on a branch: the zero of a test function, with a cycle solved at each place.

The zero is bracketed on the branch's own mesh, then found by the secant method on two finer meshes; their
difference is the error.
"""

from dataclasses import replace
from math import ceil, nan

import numpy as np

from ....arrays import Array
from ...continuation.follower import zero_along
from ...orbit.measures import CyclePath
from ...orbit.newton import Converged
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_of, stages_for
from ...point import Unsolvable
from ..arc import ArcPoint, arc_between, tangent_at
from ..bordered import BorderedMatrix, bordered, moved
from .least_stretch import least_stretch
from .point import SpecialKind, SpecialPoint

REAL_MULTIPLIER = 1e-7
"""Largest imaginary part of a real multiplier, relative to its modulus."""
LOCATION_ACCURACY = 1e-9
"""Relative accuracy of the parameter at a special point; the accuracy of the branch if that is smaller."""
FIRST_MESH_SHARE = 0.1
"""Accuracy for which the first of the two meshes is planned, in units of LOCATION_ACCURACY."""
CYCLE_TOLERANCE = 1e-10
"""Tolerance of the last Newton step for a cycle on the way; convergence is quadratic, so its square is
left."""
MAX_SECANTS = 12
"""Maximum number of secant steps."""
STALLED_SECANT = 1e-6
"""A secant step this small, in units of the step of the branch, that did not halve is rounding error."""
SECANT_END = 1e-9
"""Length of the last secant step, in units of the step of the branch."""
SECANT_END_AT_FOLD = 1e-5
"""The same at a fold, where the parameter is quadratic in arc length."""
MATRIX_STEP_SHARE = 1e-2
"""Relative distance of a matrix from its cycle, in units of the last secant step: the test function then
gives the next step to two digits."""
ENCLOSURE_SHARE = 1e-3
"""Tolerance of the bracketing: test function in units of its values at the ends, bracket in units of the
step."""
MAX_MESH_PAIRS = 4
"""Maximum number of pairs of meshes that are compared."""
LOCATION_MORE_ORDERS = 4
"""Increase of the order on the next finer mesh."""
LOCATION_MORE_INTERVALS = 1.3
"""Factor on the number of intervals on the next finer mesh."""
LOCATION_ERROR_FACTOR = 3.0
"""Safety factor on the difference of two meshes."""
LOCATION_ROUNDING = 1e-13
"""Relative rounding error of the parameter, the period and the size."""


def through_minus_one(orbit: Orbit) -> SpecialKind:
    """Kind of special point where a multiplier over the solved interval passes -1."""
    return SpecialKind.symmetry_breaking if orbit.symmetric else SpecialKind.period_doubling


class Segment:
    """The part of a branch from one cycle to the next, solved on any mesh."""

    def __init__(self, start: ArcPoint, end: ArcPoint) -> None:
        self.start = start
        self.end = end
        self.length = arc_between(start, end)
        self._back = float(end.ahead @ (end.scale.place(end.orbit) - end.scale.place(start.orbit)))
        self._known: tuple[float, Orbit, Array] | None = None

    def predicted(self, length: float) -> Orbit:
        """Orbit at a length from `start`, on the cubic through both cycles and on the mesh of `end`."""
        return self.end.predicted(-self._back * (1 - length / self.length))

    def start_on(self, mesh: OrbitMesh) -> None:
        """Continues on another mesh, without a cycle to start from."""
        self.mesh, self._known = mesh, None

    def at(self, length: float, distance: float = CYCLE_TOLERANCE) -> Converged:
        """The cycle at a length from `start`, with a matrix within a relative distance; raises Unsolvable."""
        scale, name = self.start.scale, self.start.scale.name
        if self._known is None:
            start = self.mesh.carry(self.predicted(length))
        else:
            last, orbit, tangent = self._known
            start = moved(orbit, name, (length - last) * tangent)
        found = self.start.condition(length).solved(start, CYCLE_TOLERANCE, self.start.workspace, distance)
        tangent = tangent_at(found.orbit, scale, self.start.ahead, bordered(found))
        rate = float(scale.moved(found.orbit, tangent) @ self.start.ahead)
        self._known = length, found.orbit, tangent / rate
        return found

    def rises(self) -> float:
        """Derivative of the parameter along the branch at the last cycle found."""
        if self._known is None:
            raise ValueError("nothing is found yet")
        return float(self._known[2][-1]) / self.start.scale.coordinate


def test_function(kind: SpecialKind, segment: Segment, found: Converged) -> float:
    """The test function of a kind, zero at its special points, at the cycle just found; raises Unsolvable."""
    if kind == SpecialKind.fold:
        return segment.rises()
    if kind == SpecialKind.left_the_model:
        return least_stretch(CyclePath(found.orbit))
    h = BorderedMatrix(found.orbit, segment.start.scale, found.workspace).returns
    real = np.abs(h.imag) <= REAL_MULTIPLIER * np.abs(h)
    if kind == through_minus_one(found.orbit):
        # The sign of det(h + 1) changes only when a multiplier crosses -1, whichever multiplier is nearest.
        return float((-1) ** (h[real].real < -1).sum() * np.abs(h + 1).min())
    if kind == SpecialKind.torus and not real.all():
        beyond = np.abs(h[~real]) - 1
        return float(beyond[np.argmin(np.abs(beyond))])
    raise Unsolvable("the multiplier that crosses the unit circle is lost")


def located(kind: SpecialKind, start: ArcPoint, end: ArcPoint, accuracy: float) -> SpecialPoint:
    """The special point of a kind between two cycles; if it is not found, its error is the distance of the
    two."""
    aim = min(accuracy, LOCATION_ACCURACY)
    try:
        segment = Segment(start, end)
        segment.start_on(mesh_of(end.orbit))
        length, slope = _enclosed(kind, segment)
        mesh = end.calibration.planned_for_parameter(FIRST_MESH_SHARE * aim)
        mesh = replace(mesh, stages=max(mesh.stages, stages_for(aim)))
        last, point = None, None
        for _ in range(MAX_MESH_PAIRS + 1):
            segment.start_on(mesh)
            length, found, slope = _zero(kind, segment, length, slope)
            last, point = point, _point_at(kind, found)
            if last is not None:
                point = _with_errors(point, last, start, end)
                if point.error <= aim * abs(point.at):
                    break
            mesh = replace(
                mesh,
                order=mesh.order + LOCATION_MORE_ORDERS,
                intervals=ceil(LOCATION_MORE_INTERVALS * mesh.intervals),
            )
            if not mesh.allowed:
                break
        if point is None or np.isnan(point.error):
            raise Unsolvable("no allowed mesh reaches the accuracy")
    except Unsolvable as why:
        return _between(kind, start, end, f"the {kind.name} is not located: {why}")
    return point


def _with_errors(point: SpecialPoint, last: SpecialPoint, start: ArcPoint, end: ArcPoint) -> SpecialPoint:
    """A special point with errors: the differences from the same point on a coarser mesh, with a safety
    factor.

    Period and size also have the error of the last secant step in arc length.
    """
    place = SECANT_END_AT_FOLD if point.kind is SpecialKind.fold else SECANT_END
    one = start.cycle.measures
    other = end.cycle.measures
    period = LOCATION_ERROR_FACTOR * abs(point.period - last.period) + place * abs(one.period - other.period)
    size = LOCATION_ERROR_FACTOR * abs(point.tip_y_max - last.tip_y_max) + place * abs(
        one.tip_y_max - other.tip_y_max
    )
    return replace(
        point,
        error=LOCATION_ERROR_FACTOR * abs(point.at - last.at) + LOCATION_ROUNDING * abs(point.at),
        period_error=period / point.period + LOCATION_ROUNDING,
        size_error=size / point.tip_y_max + LOCATION_ROUNDING,
    )


def _point_at(kind: SpecialKind, found: Converged) -> SpecialPoint:
    path = CyclePath(found.orbit)
    name = bordered(found).scale.name
    return SpecialPoint(
        kind=kind,
        at=getattr(found.orbit.form.rod, name),
        period=found.orbit.period,
        tip_y_max=path.extrema["tip_y_max"],
        error=nan,
        orbit=found.orbit,
    )


def _between(kind: SpecialKind, start: ArcPoint, end: ArcPoint, message: str) -> SpecialPoint:
    """A special point that is known only to lie between two cycles."""
    name = start.scale.name
    measures = end.cycle.measures
    before = start.cycle.measures
    at, other = (getattr(point.orbit.form.rod, name) for point in (end, start))
    return SpecialPoint(
        kind=kind,
        at=at,
        period=measures.period,
        tip_y_max=measures.tip_y_max,
        error=max(abs(at - other), LOCATION_ACCURACY * abs(at)),
        period_error=abs(before.period / measures.period - 1),
        size_error=abs(before.tip_y_max / measures.tip_y_max - 1),
        message=message,
    )


def _enclosed(kind: SpecialKind, segment: Segment) -> tuple[float, float]:
    """(approximate zero of the test function, its slope), bracketed by the ends of the segment.

    Raises Unsolvable.
    """
    rough = MATRIX_STEP_SHARE * ENCLOSURE_SHARE * segment.length

    def value(length: float) -> float:
        return test_function(kind, segment, segment.at(length, rough))

    values = {at: value(at) for at in (segment.length, 0.0)}

    def kept(length: float) -> float:
        values[length] = value(length)
        return values[length]

    ends = values[0.0], values[segment.length]
    least = ENCLOSURE_SHARE * min(map(abs, ends))
    at = zero_along(kept, ends, segment.length, least, ENCLOSURE_SHARE)
    # The nearest other place and this zero give the slope.
    other = min((x for x in values if x != at), key=lambda x: abs(x - at))
    return at, (values[at] - values[other]) / (at - other)


def _zero(kind: SpecialKind, segment: Segment, guess: float, slope: float) -> tuple[float, Converged, float]:
    """(zero of the test function near a guess, the cycle there, the slope of the test function).

    slope: approximate, as on a coarser mesh. Raises Unsolvable.
    """
    enough = segment.length * (SECANT_END_AT_FOLD if kind == SpecialKind.fold else SECANT_END)
    at = guess
    step = ENCLOSURE_SHARE * segment.length
    before = None
    for _ in range(MAX_SECANTS):
        found = segment.at(at, max(CYCLE_TOLERANCE, MATRIX_STEP_SHARE * abs(step)))
        f = test_function(kind, segment, found)
        if before is not None and f != before[1]:
            slope = (f - before[1]) / (at - before[0])
        last, step = abs(step), -f / slope
        if not abs(step) < segment.length:
            raise Unsolvable("the secant method leaves the step between the two cycles")
        if abs(step) <= enough or last / 2 < abs(step) <= STALLED_SECANT * segment.length:
            return at, found, slope
        before = at, f
        at += step
    raise Unsolvable("the secant method does not converge")
