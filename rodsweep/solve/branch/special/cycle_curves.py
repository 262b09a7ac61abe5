"""Stored form of a curve of folds or torus points: points, reasons for both ends, Hopf points where cycles
vanish."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum

import numpy as np

from ....arrays import Array
from ....determinant.parameter_plane import Plane
from ...hopf.generalised import GeneralisedHopfPoint
from ...orbit.normalised import polynomial_weights
from .on_curve import SolvedPoint
from .point import SpecialKind


@dataclass(frozen=True, slots=True, kw_only=True)
class CurveIdentitySettings:
    """Tolerances for deciding whether a special point lies on a known curve, and whether two curves are
    identical."""

    max_distance: float = 1e-6
    """Largest distance from a curve at which a special point of a row lies on the curve, in units of the
    length of a row."""
    max_chord_distance: float = 0.1
    """Distance of a special point from a chord between two points of a curve, beyond which the special point
    cannot lie on the arc of this chord; in units of the length of a row."""
    max_period_change: float = 0.1
    """Relative difference from the periods at two points of a curve, beyond which a special point cannot lie
    on the arc between."""
    max_period_difference: float = 1e-4
    """Largest relative difference between the periods of two solutions for the same cycle."""
    max_end_distance: float = 1e-4
    """Largest distance between the ends of two identical curves; each axis has length 1."""
    max_last_chord_distance: float = 1e-3
    """Largest distance of a special point of a curve from the chord between the curve's last cycle and the
    Hopf point where the cycles vanish; in units of the length of a row."""
    max_interpolated_points: int = 4
    """Maximum number of points of the polynomial that predicts the next point or the vanishing point of a
    curve."""
    extrapolation_factor: float = 10.0
    """Safety factor on the error of an extrapolated Hopf point: the mesh displaces the Hopf point along the
    curve, and the errors of the points do not include this displacement."""
    max_hopf_distance: float = 0.01
    """Largest distance of an extrapolated Hopf point from the identical generalised Hopf point of a Hopf
    curve; each axis has length 1."""


CURVE_IDENTITY = CurveIdentitySettings()


Arrays = dict[str, Array]
"""Stored result of a unit of work: arrays by name."""


class CurveEnd(IntEnum):
    """Reason for the end of a curve of special points; the result file stores the value, `none` (0) for inner
    points."""

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
    """A Hopf point at which a curve of special points ends because the cycles vanish.

    at: value of the parameter along a row, with the absolute error `error`. row: value of the rows'
    parameter. period: in tau2.
    """

    at: float
    row: float
    error: float
    period: float


@dataclass(frozen=True, slots=True)
class CurvePoint:
    """Stored quantities of a point of a curve of special points.

    at: value of the parameter along a row, with the absolute error `error`. row: value of the rows'
    parameter; place: its axis coordinate, from 0 to 1. period: in tau2. tip_y_max: in L.
    """

    at: float
    row: float
    place: float
    error: float
    period: float
    tip_y_max: float

    @classmethod
    def of(cls, point: SolvedPoint) -> "CurvePoint":
        """The stored quantities of a solved point of a curve."""
        period = point.orbit.period
        return cls(point.at, point.row, point.place, point.error, period, point.tip_y_max)


@dataclass(frozen=True, slots=True)
class HalfCurve:
    """One half of a curve of special points: points in order from a special point of a row to an end of the
    curve."""

    points: tuple[CurvePoint, ...]
    end: CurveEnd


@dataclass(frozen=True, slots=True)
class TracedHalfCurve:
    """Result of following one half of a curve of special points. half: None if the half could not be
    followed.

    distances: distance of nearby special points from this half, in units of the length of a row, by index in
    the list of all special points.
    """

    half: HalfCurve | None
    distances: dict[int, float] = field(default_factory=dict)

    def arrays(self) -> Arrays:
        """The result as named arrays: points (points, 6), end (1,), distances (near, 2) with index and
        distance."""
        points = [] if self.half is None else [_numbers(point) for point in self.half.points]
        return {
            "points": np.array(points, dtype=float).reshape(-1, len(CurvePoint.__slots__)),
            "end": np.array([0.0 if self.half is None else float(self.half.end)]),
            "distances": np.array(list(self.distances.items()), dtype=float).reshape(-1, 2),
        }

    @classmethod
    def of(cls, arrays: Arrays) -> "TracedHalfCurve":
        """The result from its named arrays, as `arrays` makes them."""
        points = tuple(CurvePoint(*map(float, row)) for row in arrays["points"])
        half = HalfCurve(points, CurveEnd(int(arrays["end"][0]))) if points else None
        return cls(half, {int(place): float(distance) for place, distance in arrays["distances"]})


def _numbers(point: CurvePoint) -> list[float]:
    return [getattr(point, name) for name in CurvePoint.__slots__]


@dataclass(frozen=True, slots=True)
class CycleCurve:
    """A whole curve of folds or torus points: points in order, and the reasons for both ends.

    vanishing: the Hopf point at each end where the cycles vanish; None for an end of another kind.
    """

    kind: SpecialKind
    points: tuple[CurvePoint, ...]
    ends: tuple[CurveEnd, CurveEnd]
    vanishing: tuple[VanishingPoint | None, VanishingPoint | None]

    @classmethod
    def joined(cls, kind: SpecialKind, ahead: HalfCurve, behind: HalfCurve | None) -> "CycleCurve":
        """The curve joined from its two halves, which start at the same point; a closed curve has only the
        half `ahead`."""
        before = behind or HalfCurve(ahead.points[:1], ahead.end)
        points = (*before.points[:0:-1], *ahead.points)
        vanishing = [
            vanishing_point(side) if end is CurveEnd.hopf else None
            for end, side in ((before.end, points[::-1]), (ahead.end, points))
        ]
        return cls(kind, points, (before.end, ahead.end), (vanishing[0], vanishing[1]))


def with_located_ends(curve: CycleCurve, plane: Plane, known: Sequence[GeneralisedHopfPoint]) -> CycleCurve:
    """The curve with extrapolated ends replaced by the generalised Hopf points `known`, which are more
    accurate; a curve of torus points is unchanged."""

    def located(end: VanishingPoint | None) -> VanishingPoint | None:
        if end is None or curve.kind != SpecialKind.fold:
            return end
        for point in known:
            pairs = zip(plane.axes, point.values, (end.at, end.row), strict=True)
            if all(
                abs(axis.scaled(a) - axis.scaled(b)) <= CURVE_IDENTITY.max_hopf_distance
                for axis, a, b in pairs
            ):
                return VanishingPoint(*point.values, point.errors[0], 2 * np.pi / point.frequency)
        return end

    first, last = map(located, curve.vanishing)
    return replace(curve, vanishing=(first, last))


def lagrange_weights(places: Array, at: float) -> Array:
    """Lagrange weights, (n,): the polynomial through n > 1 values at the abscissas `places`, (n,), has at the
    abscissa `at` the weighted sum of these values."""
    apart = places[:-1] - places[-1]
    weights = polynomial_weights(apart, np.zeros(len(apart)), at - places[-1])
    return np.append(weights, 1 - weights.sum())


def vanishing_point(points: Sequence[CurvePoint]) -> VanishingPoint | None:
    """The Hopf point where cycles vanish beyond the last of `points`, extrapolated by polynomials in the
    squared amplitude; None for too few points."""
    known = points[-CURVE_IDENTITY.max_interpolated_points :]
    if len(known) < CURVE_IDENTITY.max_interpolated_points:
        return None
    squares = np.array([point.tip_y_max**2 for point in known])
    table = np.array([[point.at, point.row, point.period] for point in known])
    # The difference of the polynomials with and without the first point is the error estimate.
    best, other = (np.dot(lagrange_weights(squares[i:], 0.0), table[i:]) for i in (0, 1))
    difference = abs(best[0] - other[0]) + max(point.error for point in known)
    error = CURVE_IDENTITY.extrapolation_factor * difference
    return VanishingPoint(float(best[0]), float(best[1]), float(error), float(best[2]))
