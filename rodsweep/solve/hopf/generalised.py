"""Generalised Hopf (Bautin) points: where the side on which cycles are born changes along a Hopf curve.

At every stored point of a curve the sign of Re c is that of its normal form. Between two neighbours of
opposite signs D(i eta) = 0 and Re c = 0 hold together once: Newton's method on D finds the Hopf point at
each place between them, and Brent's the place where Re c vanishes. Two changes between the same neighbours
are not seen.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...determinant.boundary import Boundary, OnBoundary
from ...determinant.parameter_path import determinant_along
from ...determinant.parameter_plane import Plane
from ...watch import Whereabouts, report
from ..changes.boundary_curves import BoundaryCurve
from ..changes.unstable_modes import Crossing, Kind
from ..point import FAILURES, Unsolvable
from .hopf_coefficients import HopfCoefficients, hopf_coefficients

FINEST = 1e-10
"""Relative accuracy of c, unless a better one is asked for: points are located to 1e-9."""
ROUGH = 1e-5
"""That is enough for most signs; one that it leaves undecided is looked at again."""
PLACE = 1e-13
"""Of the distance between two neighbours, to which Brent's method goes."""
BESIDE = 1e-3
"""Of the distance between two neighbours, to either side of the point, for the slope of Re c."""
VANISHES = 1e-6
"""Re c/|c| at the place found, beyond which it changes sign there without being 0."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GeneralisedHopfPoint:
    """A point of a Hopf curve with Re c = 0.

    values, errors: of both parameters of the plane. frequency in 1/tau2, growth_slope = dw/dF in
    L^2/(k3 tau2), landau_imag = Im c in 1/(tau2 L^2). after: the point of the curve behind which it lies.
    """

    after: int
    values: tuple[float, float]
    errors: tuple[float, float]
    frequency: float
    growth_slope: complex
    landau_imag: float


@dataclass(frozen=True, slots=True)
class CurveCriticality:
    """What the normal form says along one Hopf curve.

    criticality: -1, 1 or 0 where undecided, NaN where there is no normal form, shape (points,). unlocated:
    changes of sign that no point was found for.
    """

    criticality: Array
    points: tuple[GeneralisedHopfPoint, ...]
    unlocated: int


@dataclass(frozen=True, slots=True)
class _At:
    """A Hopf point of the plane with its normal form."""

    there: OnBoundary
    coefficients: HopfCoefficients

    @property
    def share(self) -> float:
        """Re c/|c|, which has the zeros of Re c and no scale."""
        return self.coefficients.landau.real / abs(self.coefficients.landau)


def curve_criticality(plane: Plane, curve: BoundaryCurve, accuracy: float) -> CurveCriticality:
    """The sign of Re c at every point of a Hopf curve, and the generalised Hopf points between them.

    accuracy: of c, relative; at least FINEST is asked for. Points where the normal form
    fails have none, and cost no other its own.
    """
    hopf = HopfCurve(Boundary(plane, curve.sign), curve.scaled, min(accuracy, FINEST))
    signs = np.array([hopf.sign(i) for i in range(len(curve.scaled))])
    points, unlocated = [], 0
    decided = np.flatnonzero(signs != 0)  # a change may lie within the error of a point
    for a, b in zip(decided[:-1], decided[1:], strict=True):
        if signs[a] * signs[b] < 0:
            found = hopf.located(int(a), int(b))
            points += [found] if found else []
            unlocated += found is None
    return CurveCriticality(signs, tuple(points), unlocated)


@dataclass(frozen=True, slots=True)
class HopfCurve:
    """The points (x, y, h) of a Hopf curve, shape (points, 3), and what computes normal forms on it."""

    boundary: Boundary
    scaled: Array
    accuracy: float

    def sign(self, i: int) -> float:
        """That of Re c at a point: -1, 1, 0 undecided, NaN where there is no normal form."""
        points = len(self.scaled)
        report(lambda: Whereabouts(f"criticality of a Hopf curve, point {i + 1} of {points}", i / points))
        try:
            v = self.scaled[i]
            normal = self.boundary.tangent(v)
            rough = self.at(v, normal, ROUGH).coefficients.criticality
            return rough or self.at(v, normal, self.accuracy).coefficients.criticality
        except FAILURES:
            return math.nan

    def at(self, guess: Array, normal: Array, accuracy: float) -> _At:
        """The Hopf point in the plane through a guess with that normal, both (3,); raises Unsolvable."""
        there = self.boundary.corrected(guess, normal)
        if there is None:
            raise Unsolvable("no Hopf point is found between two of a curve")
        x, y, h = map(float, there.v)
        rod, w = self.boundary.plane.at(x, y), complex(0.0, math.exp(h))
        along = determinant_along(w, rod.coefficients, rod.direction("F"))
        value = self.boundary.plane.determinant(w, x, y)
        # An error of the point is one of the force, the other parameters as they are.
        error = there.error * (abs(value.D_x) + abs(value.D_y)) / abs(along.D_p)
        hopf = Crossing(rod.F, Kind.hopf, w.imag, 0.0, error, frequency_error=there.error * w.imag)
        return _At(there, hopf_coefficients(rod, hopf, accuracy))

    def located(self, first: int, last: int) -> GeneralisedHopfPoint | None:
        """The point with Re c = 0 between two of opposite signs, or None where it is not found."""
        from scipy.optimize import brentq  # a tenth of a second of every start

        start, chord = self.scaled[first], self.scaled[last] - self.scaled[first]
        normal = chord / np.linalg.norm(chord)

        def on_chord(s: float) -> _At:
            return self.at(start + s * chord, normal, self.accuracy)

        try:
            s = float(brentq(lambda s: on_chord(s).share, 0.0, 1.0, xtol=PLACE))
            here, before, beyond = (on_chord(s + side * BESIDE) for side in (0, -1, 1))
        except (*FAILURES, ValueError):
            return None
        slope = (beyond.share - before.share) / (2 * BESIDE)
        if abs(here.share) > VANISHES or slope == 0:
            return None
        passed = (self.scaled[first + 1 : last] - start) @ chord <= s * (chord @ chord)
        along = here.coefficients.landau_error / abs(slope) + PLACE
        return self.as_point(here, first + int(passed.sum()), chord * along)

    def as_point(self, here: _At, after: int, moved: Array) -> GeneralisedHopfPoint:
        """The point of its normal form; moved: by how much it may be off along the chord, (3,)."""
        there, axes = here.there, self.boundary.plane.axes
        tangent = there.tangent
        way = tangent * float(np.linalg.norm(moved) ** 2 / (tangent @ moved))
        values = [axis.value(float(x)) for axis, x in zip(axes, there.v[:2], strict=True)]
        errors = [
            abs(axis.stretch(value)) * (abs(float(off)) + there.error)
            for axis, value, off in zip(axes, values, way[:2], strict=True)
        ]
        return GeneralisedHopfPoint(
            after=after,
            values=(values[0], values[1]),
            errors=(errors[0], errors[1]),
            frequency=math.exp(float(there.v[2])),
            growth_slope=here.coefficients.growth_slope,
            landau_imag=here.coefficients.landau.imag,
        )
