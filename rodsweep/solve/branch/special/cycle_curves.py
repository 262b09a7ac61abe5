"""Numbers of a curve of folds or torus points: points, reasons for the ends, vanishing cycles."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import Plane
from ...hopf.generalised import GeneralisedHopfPoint
from ...orbit.normalised import polynomial_weights
from .on_curve import OnCurve
from .point import SpecialKind


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveIdentitySettings:
    """Tolerances for deciding whether a special point or Hopf point lies on a known curve, and whether two
    curves are one.
    """

    on_curve: float = 1e-6
    """A special point of a row this close to a curve lies on it; in units of the line's axis."""
    near_chord: float = 0.1
    """Distance from a chord of a curve, in units of the line's axis, beyond which a special point is not on
    the part of the curve that the chord spans."""
    near_period: float = 0.1
    """Relative difference of the period beyond which a special point is not on a part of a curve."""
    equal_period: float = 1e-4
    """Largest relative difference of the periods of two solutions for one cycle."""
    equal_ends: float = 1e-4
    """Scaled distance of both ends within which two curves are identical."""
    on_last_chord: float = 1e-3
    """Largest distance of a special point on the last chord of a curve, where cycles vanish; in units of the
    line's axis."""
    max_interpolated: int = 4
    """Maximum number of points through which a prediction is interpolated."""
    extrapolation_factor: float = 10.0
    """Safety factor of the extrapolation: a mesh displaces the Hopf point along the curve, which the points'
    errors do not include."""
    at_hopf: float = 0.01
    """Scaled distance within which an extrapolated Hopf point is a generalised Hopf point of a Hopf curve."""


CURVE_IDENTITY = CurveIdentitySettings()


Arrays = dict[str, Array]
"""Result of a unit of work, as it is stored."""


class CurveEnd(IntEnum):
    """Reason for the end of a curve of special points; `none` marks points within a curve."""

    none = 0
    edge = 1
    crushed = 2
    hopf = 3
    left_the_model = 4
    resonance = 5
    closed = 6
    not_followed = 7


@dataclass(frozen=True, slots=True)
class VanishingPoint:
    """A Hopf point at which a curve ends: both parameters, error of the line's parameter, period in tau2."""

    at: float
    row: float
    error: float
    period: float


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """Numbers of a point of a curve: both parameters, and the scaled place on the rows' axis, from 0 to 1.

    error: absolute, of the line's parameter. period: in tau2. tip_y_max: in L.
    """

    at: float
    row: float
    place: float
    error: float
    period: float
    tip_y_max: float

    @classmethod
    def of(cls, point: OnCurve) -> "CurvePoint":
        """The numbers of a cycle on a curve."""
        period = point.orbit.period
        return cls(point.at, point.row, point.place, point.error, period, point.tip_y_max)


@dataclass(frozen=True, slots=True)
class HalfCurve:
    """Half a curve: from a special point of a row to an end."""

    points: tuple[CurvePoint, ...]
    end: CurveEnd


@dataclass(frozen=True, slots=True)
class TracedHalf:
    """Result of following a half; half: None if no curve is found.

    distances: of nearby special points from the half, in units of the line's axis, by index in the list of
    all.
    """

    half: HalfCurve | None
    distances: dict[int, float] = field(default_factory=dict)

    def arrays(self) -> Arrays:
        """The half as arrays: points (points, 6), end (1,), distances (near, 2)."""
        points = [] if self.half is None else [_numbers(point) for point in self.half.points]
        return {
            "points": np.array(points, dtype=float).reshape(-1, len(CurvePoint.__slots__)),
            "end": np.array([0.0 if self.half is None else float(self.half.end)]),
            "distances": np.array(list(self.distances.items()), dtype=float).reshape(-1, 2),
        }

    @classmethod
    def of(cls, arrays: Arrays) -> "TracedHalf":
        """The inverse of `arrays`."""
        points = tuple(CurvePoint(*map(float, row)) for row in arrays["points"])
        half = HalfCurve(points, CurveEnd(int(arrays["end"][0]))) if points else None
        return cls(half, {int(place): float(distance) for place, distance in arrays["distances"]})


def _numbers(point: CurvePoint) -> list[float]:
    return [getattr(point, name) for name in CurvePoint.__slots__]


@dataclass(frozen=True, slots=True)
class CycleCurve:
    """A curve of folds or torus points: points in order, and the reasons for both ends.

    vanishing: for each end the Hopf point at which the cycles vanish, or None.
    """

    kind: SpecialKind
    points: tuple[CurvePoint, ...]
    ends: tuple[CurveEnd, CurveEnd]
    vanishing: tuple[VanishingPoint | None, VanishingPoint | None]

    @classmethod
    def joined(cls, kind: SpecialKind, ahead: HalfCurve, behind: HalfCurve | None) -> "CycleCurve":
        """The curve of its two halves from one point; for a closed curve `ahead` is the whole curve."""
        before = behind or HalfCurve(ahead.points[:1], ahead.end)
        points = (*before.points[:0:-1], *ahead.points)
        vanishing = [
            vanishing_point(side) if end is CurveEnd.hopf else None
            for end, side in ((before.end, points[::-1]), (ahead.end, points))
        ]
        return cls(kind, points, (before.end, ahead.end), (vanishing[0], vanishing[1]))


def ending_at(curve: CycleCurve, plane: Plane, known: Sequence[GeneralisedHopfPoint]) -> CycleCurve:
    """A curve of folds with its ends replaced by the generalised Hopf points located on Hopf curves."""

    def located(end: VanishingPoint | None) -> VanishingPoint | None:
        if end is None or curve.kind != SpecialKind.fold:
            return end
        for point in known:
            pairs = zip(plane.axes, point.values, (end.at, end.row), strict=True)
            if all(abs(axis.scaled(a) - axis.scaled(b)) <= CURVE_IDENTITY.at_hopf for axis, a, b in pairs):
                return VanishingPoint(*point.values, point.errors[0], 2 * np.pi / point.frequency)
        return end

    first, last = map(located, curve.vanishing)
    return replace(curve, vanishing=(first, last))


def weights_at(places: Array, at: float) -> Array:
    """Lagrange weights, (n,), that evaluate the polynomial through values at n > 1 places, (n,), at one
    place."""
    apart = places[:-1] - places[-1]
    weights = polynomial_weights(apart, np.zeros(len(apart)), at - places[-1])
    return np.append(weights, 1 - weights.sum())


def vanishing_point(points: Sequence[CurvePoint]) -> VanishingPoint | None:
    """Extrapolation to amplitude 0 beyond the last point, by polynomials in the squared amplitude."""
    known = points[-CURVE_IDENTITY.max_interpolated :]
    if len(known) < CURVE_IDENTITY.max_interpolated:
        return None
    squares = np.array([point.tip_y_max**2 for point in known])
    table = np.array([[point.at, point.row, point.period] for point in known])
    # The difference of the polynomials with and without the first point is the error estimate.
    best, other = (np.dot(weights_at(squares[i:], 0.0), table[i:]) for i in (0, 1))
    difference = abs(best[0] - other[0]) + max(point.error for point in known)
    error = CURVE_IDENTITY.extrapolation_factor * difference
    return VanishingPoint(float(best[0]), float(best[1]), float(error), float(best[2]))
