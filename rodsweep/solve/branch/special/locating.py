"""Special points located on a branch: the zero of a test function, with a cycle solved at each place.

The zero is enclosed on the mesh of the branch and found by the secant method on two fine meshes: what they
differ by is the error.
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

REAL = 1e-7
"""Imaginary part of a multiplier, relative, below which it is real."""
ACCURACY = 1e-9
"""Relative, to which the parameter at a special point is located, where the branch is no more accurate."""
MESH_SHARE = 0.1
"""Share of it that the first of the two meshes is chosen for."""
TOLERANCE = 1e-10
"""To which a cycle is solved on the way: the square of it is left."""
MOST_SECANTS, STALLED = 12, 1e-6
"""Steps of the secant method, and the length, in units of the step of the branch, from which a step that is
no shorter than half of the one before is rounding."""
ZERO, ZERO_OF_A_FOLD = 1e-9, 1e-5
"""Last step of the secant method in units of the step of the branch: beside a fold the parameter changes with
the square of the distance."""
MATRIX_SHARE = 1e-2
"""Relative distance of a matrix from its cycle, in units of the step that led there, for a test function that
tells the next step to two digits."""
ROUGHLY = 1e-3
"""Where a zero is known roughly: value in units of those at the ends, bracket in units of the step."""
MOST_PAIRS, MORE_ORDERS, MORE_INTERVALS, SAFETY = 4, 4, 1.3, 3.0
ROUNDING = 1e-13


def through_minus_one(orbit: Orbit) -> SpecialKind:
    """What a multiplier of the map over what is solved means that passes -1."""
    return SpecialKind.symmetry_breaking if orbit.symmetric else SpecialKind.period_doubling


class Segment:
    """The branch from one cycle to the next, on any mesh."""

    def __init__(self, here: ArcPoint, there: ArcPoint) -> None:
        self.here, self.there = here, there
        self.length = arc_between(here, there)
        self._back = float(there.ahead @ (there.scale.place(there.orbit) - there.scale.place(here.orbit)))
        self._known: tuple[float, Orbit, Array] | None = None

    def predicted(self, length: float) -> Orbit:
        """What the cubic through both predicts at a length from `here`, on the mesh of `there`."""
        return self.there.predicted(-self._back * (1 - length / self.length))

    def start_on(self, mesh: OrbitMesh) -> None:
        """What follows is on a mesh, from what was found last."""
        self.mesh, self._known = mesh, None

    def at(self, length: float, distance: float = TOLERANCE) -> Converged:
        """The cycle at a length from `here`, with a matrix at a relative distance; raises Unsolvable."""
        scale, name = self.here.scale, self.here.scale.name
        if self._known is None:
            start = self.mesh.carry(self.predicted(length))
        else:
            last, orbit, tangent = self._known
            start = moved(orbit, name, (length - last) * tangent)
        found = self.here.condition(length).solved(start, TOLERANCE, self.here.workspace, distance)
        tangent = tangent_at(found.orbit, scale, self.here.ahead, bordered(found))
        rate = float(scale.moved(found.orbit, tangent) @ self.here.ahead)
        self._known = length, found.orbit, tangent / rate
        return found

    def rises(self) -> float:
        """How fast the parameter grows at the cycle that was found last."""
        if self._known is None:
            raise ValueError("nothing is found yet")
        return float(self._known[2][-1]) / self.here.scale.coordinate


def test_function(kind: SpecialKind, segment: Segment, found: Converged) -> float:
    """What is zero at a special point of a kind, at a cycle that was just found; raises Unsolvable."""
    if kind == SpecialKind.fold:
        return segment.rises()
    if kind == SpecialKind.left_the_model:
        return least_stretch(CyclePath(found.orbit))
    h = BorderedMatrix(found.orbit, segment.here.scale, found.workspace).returns
    real = np.abs(h.imag) <= REAL * np.abs(h)
    if kind == through_minus_one(found.orbit):
        # Its sign is that of det(h + 1): it tells the one that crosses from others that are nearer elsewhere.
        return float((-1) ** (h[real].real < -1).sum() * np.abs(h + 1).min())
    if kind == SpecialKind.torus and not real.all():
        beyond = np.abs(h[~real]) - 1
        return float(beyond[np.argmin(np.abs(beyond))])
    raise Unsolvable("the multiplier that crosses the circle is lost")


def located(kind: SpecialKind, here: ArcPoint, there: ArcPoint, accuracy: float) -> SpecialPoint:
    """The special point of a kind between two cycles; where it is not found, the error says between which."""
    aim = min(accuracy, ACCURACY)
    try:
        segment = Segment(here, there)
        segment.start_on(mesh_of(there.orbit))
        length, slope = _enclosed(kind, segment)
        mesh = there.calibration.planned_for_parameter(MESH_SHARE * aim)
        mesh = replace(mesh, stages=max(mesh.stages, stages_for(aim)))
        last, point = None, None
        for _ in range(MOST_PAIRS + 1):
            segment.start_on(mesh)
            length, found, slope = _zero(kind, segment, length, slope)
            last, point = point, _point_at(kind, found)
            if last is not None:
                point = _with_errors(point, last, here, there)
                if point.error <= aim * abs(point.at):
                    break
            mesh = replace(
                mesh, order=mesh.order + MORE_ORDERS, intervals=ceil(MORE_INTERVALS * mesh.intervals)
            )
            if not mesh.allowed:
                break
        if point is None or np.isnan(point.error):
            raise Unsolvable("no mesh is fine enough")
    except Unsolvable as why:
        return _between(kind, here, there, f"the {kind.name} is not located: {why}")
    return point


def _with_errors(point: SpecialPoint, last: SpecialPoint, here: ArcPoint, there: ArcPoint) -> SpecialPoint:
    """A special point with its errors: by how much it differs from that on a coarser mesh.

    The place on the branch is known to the last step of the secant method, and period and size as well.
    """
    place = ZERO_OF_A_FOLD if point.kind is SpecialKind.fold else ZERO
    one, other = here.cycle.measures, there.cycle.measures
    period = SAFETY * abs(point.period - last.period) + place * abs(one.period - other.period)
    size = SAFETY * abs(point.tip_y_max - last.tip_y_max) + place * abs(one.tip_y_max - other.tip_y_max)
    return replace(
        point,
        error=SAFETY * abs(point.at - last.at) + ROUNDING * abs(point.at),
        period_error=period / point.period + ROUNDING,
        size_error=size / point.tip_y_max + ROUNDING,
    )


def _point_at(kind: SpecialKind, found: Converged) -> SpecialPoint:
    path, name = CyclePath(found.orbit), bordered(found).scale.name
    return SpecialPoint(
        kind=kind,
        at=getattr(found.orbit.form.rod, name),
        period=found.orbit.period,
        tip_y_max=path.extrema["tip_y_max"],
        error=nan,
        orbit=found.orbit,
    )


def _between(kind: SpecialKind, here: ArcPoint, there: ArcPoint, message: str) -> SpecialPoint:
    """A special point of which only is known between which cycles it lies."""
    name, measures, before = here.scale.name, there.cycle.measures, here.cycle.measures
    at, other = (getattr(point.orbit.form.rod, name) for point in (there, here))
    return SpecialPoint(
        kind=kind,
        at=at,
        period=measures.period,
        tip_y_max=measures.tip_y_max,
        error=max(abs(at - other), ACCURACY * abs(at)),
        period_error=abs(before.period / measures.period - 1),
        size_error=abs(before.tip_y_max / measures.tip_y_max - 1),
        message=message,
    )


def _enclosed(kind: SpecialKind, segment: Segment) -> tuple[float, float]:
    """Where the test function of a kind is about zero, enclosed by the ends, and its slope.

    Raises Unsolvable.
    """
    rough = MATRIX_SHARE * ROUGHLY * segment.length

    def value(length: float) -> float:
        return test_function(kind, segment, segment.at(length, rough))

    values = {at: value(at) for at in (segment.length, 0.0)}

    def kept(length: float) -> float:
        values[length] = value(length)
        return values[length]

    ends = values[0.0], values[segment.length]
    least = ROUGHLY * min(map(abs, ends))
    at = zero_along(kept, ends, segment.length, least, ROUGHLY)
    # The nearest other place tells the slope with this one.
    other = min((x for x in values if x != at), key=lambda x: abs(x - at))
    return at, (values[at] - values[other]) / (at - other)


def _zero(kind: SpecialKind, segment: Segment, guess: float, slope: float) -> tuple[float, Converged, float]:
    """Where the test function of a kind is zero near a guess, the cycle there, and the function's slope.

    slope: about its slope, as a coarser mesh has it. Raises Unsolvable.
    """
    enough = segment.length * (ZERO_OF_A_FOLD if kind == SpecialKind.fold else ZERO)
    at, step, before = guess, ROUGHLY * segment.length, None
    for _ in range(MOST_SECANTS):
        found = segment.at(at, max(TOLERANCE, MATRIX_SHARE * abs(step)))
        f = test_function(kind, segment, found)
        if before is not None and f != before[1]:
            slope = (f - before[1]) / (at - before[0])
        last, step = abs(step), -f / slope
        if not abs(step) < segment.length:
            raise Unsolvable("the secant method leaves the step")
        if abs(step) <= enough or last / 2 < abs(step) <= STALLED * segment.length:
            return at, found, slope
        before = at, f
        at += step
    raise Unsolvable("the secant method does not settle")
