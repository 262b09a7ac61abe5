"""Curves of generalised Hopf points over three parameters.

On a plane of two of three parameters generalised Hopf points, D(i eta) = 0 and Re c = 0, are points; when the
third moves they make a curve. It is followed with that of the three held that changes fastest, so that it may
turn back in any of them. In the plane of the other two the secant method finds the point, at a place
along the Hopf curve beside what the last two points predict.
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import partial

import numpy as np

from ...arrays import Array
from ...determinant.boundary import Boundary
from ...determinant.parameter_plane import Plane, PlaneAxis
from ...model.rod import Rod
from ...watch import Whereabouts, report
from ..point import FAILURES, Unsolvable
from .generalised import FINEST, GeneralisedHopfPoint, HopfCurve

FIRST, LONGEST, SHORTEST = 0.01, 0.1, 1e-4
"""Steps, in units of the ranges."""
GROWTH, OFF = 1.5, 0.2
"""Of a step after one that succeeded; distance from the prediction, in units of the step, that is too far."""
MOST_SECANTS, PROBE, SETTLED = 10, 1e-3, 1e-12
MOST_POINTS = 2000
SAME_POINT = 1e-6
"""Distance of two points, in units of the ranges, that are one."""


class BautinEnd(IntEnum):
    """Where a curve of generalised Hopf points ends."""

    none = 0
    range_end = 1
    plane_edge = 2
    not_found = 3
    list_full = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class BautinCurvePoint:
    """A generalised Hopf point. values, errors: of the plane's two parameters and the third, (3,)."""

    values: Array
    errors: Array
    frequency: float
    landau_imag: float


@dataclass(frozen=True, slots=True)
class BautinCurve:
    """Its points in order, and why it ends where it begins and where it ends."""

    points: tuple[BautinCurvePoint, ...]
    ends: tuple[BautinEnd, BautinEnd]


@dataclass(frozen=True, slots=True)
class _Place:
    """A point of a curve. v: scaled values of the three parameters and log eta, (4,)."""

    v: Array
    point: BautinCurvePoint


@dataclass(frozen=True, slots=True)
class BautinSpace:
    """Three parameters in their ranges, the third with the values asked for.

    rod: for the parameters that do not vary; accuracy: of c, relative.
    """

    rod: Rod
    axes: tuple[PlaneAxis, PlaneAxis, PlaneAxis]
    asked: Array
    accuracy: float

    def scaled(self, values: Array, frequency: float) -> Array:
        """(x, y, z, log eta) of three values, (3,), and a frequency."""
        places = [axis.scaled(float(value)) for axis, value in zip(self.axes, values, strict=True)]
        return np.array([*places, np.log(frequency)])

    def solved(self, guess: Array, held: int) -> _Place:
        """The point near a guess, (4,), with one of its three places held; raises Unsolvable."""
        free = [i for i in range(3) if i != held]
        values = {axis.name: axis.value(float(x)) for axis, x in zip(self.axes, guess[:3], strict=True)}
        plane = Plane(self.rod.changed(**values), (self.axes[free[0]], self.axes[free[1]]))
        boundary = Boundary(plane, 0.0)
        hopf = HopfCurve(boundary, np.empty((0, 3)), min(self.accuracy, FINEST))
        start = guess[[*free, 3]]
        way = boundary.tangent(start)
        point = self._zero(hopf, start, way)
        values_there = np.empty(3)
        errors = np.zeros(3)
        values_there[free], errors[free] = point.values, point.errors
        values_there[held] = values[self.axes[held].name]
        found = BautinCurvePoint(
            values=values_there, errors=errors, frequency=point.frequency, landau_imag=point.landau_imag
        )
        return _Place(self.scaled(values_there, point.frequency), found)

    @staticmethod
    def _zero(hopf: HopfCurve, start: Array, way: Array) -> GeneralisedHopfPoint:
        """Where Re c vanishes along a Hopf curve near a start, (3,), in its direction; raises Unsolvable."""
        s, before = PROBE, 0.0
        last = hopf.at(start, way, hopf.accuracy).share
        for _ in range(MOST_SECANTS):
            here = hopf.at(start + s * way, way, hopf.accuracy)
            if here.share == last:
                break
            slope = (here.share - last) / (s - before)
            step = -here.share / slope
            if not abs(s + step) < LONGEST:
                break
            along = here.coefficients.landau_error / abs(slope)
            if abs(step) <= max(SETTLED, along):
                return hopf.as_point(here, 0, way * (along + abs(step)))
            last, before, s = here.share, s, s + step
        raise Unsolvable("no generalised Hopf point is found near")


def bautin_curve(space: BautinSpace, start: BautinCurvePoint) -> BautinCurve:
    """The curve through a generalised Hopf point, both ways to where it ends."""
    here = _Place(space.scaled(start.values, start.frequency), start)
    (back, first), (on, last) = (_followed(space, here, way) for way in (-1.0, 1.0))
    return BautinCurve(
        (*(place.point for place in back[::-1]), start, *(place.point for place in on)), (first, last)
    )


def on_curve(point: GeneralisedHopfPoint, third: float) -> BautinCurvePoint:
    """A point of a plane at the plane's value of the third parameter."""
    return BautinCurvePoint(
        values=np.array([*point.values, third]),
        errors=np.array([*point.errors, 0.0]),
        frequency=point.frequency,
        landau_imag=point.landau_imag,
    )


def lies_on(space: BautinSpace, point: BautinCurvePoint, curve: BautinCurve) -> bool:
    """Whether a point whose third value is one of those asked for is one of a curve."""
    v = space.scaled(point.values, point.frequency)
    others = [space.scaled(other.values, other.frequency) for other in curve.points]
    return any(float(np.abs(v - other).max()) < SAME_POINT for other in others)


def _followed(space: BautinSpace, start: _Place, way: float) -> tuple[list[_Place], BautinEnd]:
    """The points beyond the start with the third value rising or falling at first, and why they end."""
    places: list[_Place] = []
    here, step, tangent = start, FIRST, np.array([0.0, 0.0, way, 0.0])
    if not 0 < start.v[2] + way * SHORTEST < 1:
        return places, BautinEnd.range_end
    while len(places) < MOST_POINTS:
        report(partial(Whereabouts, f"curve of generalised Hopf points, {len(places)} points"))
        predicted = here.v + step * tangent
        try:
            there, edge = _within(space, predicted, here)
            missed = np.abs(there.v[:3] - predicted[:3]).max()
            if places and edge is BautinEnd.none and missed > OFF * step:
                raise Unsolvable("the curve bends")
        except (*FAILURES, ValueError):
            step /= 2
            if step < SHORTEST:
                return places, BautinEnd.not_found
            continue
        places += [*_asked_between(space, here, there), there]
        if edge is not BautinEnd.none:
            return places, edge
        change = there.v - here.v
        here, tangent = there, change / np.abs(change[:3]).max()
        step = min(step * GROWTH, LONGEST)
    return places, BautinEnd.list_full


def _within(space: BautinSpace, predicted: Array, here: _Place) -> tuple[_Place, BautinEnd]:
    """The point that is predicted, (4,), or where the curve leaves the ranges; raises Unsolvable."""
    change = predicted - here.v
    beyond = np.where(predicted[:3] > 1, 1.0, np.where(predicted[:3] < 0, 0.0, np.nan))
    shares = (beyond - here.v[:3]) / np.where(change[:3] == 0, 1.0, change[:3])
    if np.isnan(shares).all():
        return space.solved(predicted, int(np.argmax(np.abs(change[:3])))), BautinEnd.none
    which = int(np.nanargmin(shares))
    guess = here.v + shares[which] * change
    guess[which] = beyond[which]
    return space.solved(guess, which), BautinEnd.range_end if which == 2 else BautinEnd.plane_edge


def _asked_between(space: BautinSpace, here: _Place, there: _Place) -> list[_Place]:
    """The points at the values asked for between two of a curve; raises Unsolvable."""
    a, b = here.v[2], there.v[2]
    inner = [z for z in map(space.axes[2].scaled, space.asked) if min(a, b) < z < max(a, b)]
    found = []
    for z in sorted(inner, reverse=bool(a > b)):
        if min(abs(z - a), abs(z - b)) > SAME_POINT:
            guess = here.v + (z - a) / (b - a) * (there.v - here.v)
            guess[2] = z
            found.append(space.solved(guess, 2))
    return found
