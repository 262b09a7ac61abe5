"""The boundaries of a phase diagram: the curves on which the changes of its rows lie.

The curves are traced from the changes of all rows (`rodsweep.solve.changes.boundary_curves`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...determinant.boundary import Boundary
from ...determinant.parameter_plane import Plane
from ..continuation.boundaries import Boundaries, boundary_search
from .boundary_curves import BoundaryCurve, trace
from .unstable_modes import Kind

SAME_COORDINATE = 1e-12
"""Difference of two coordinates that is none."""
ON_CURVE = 1e-3
"""Relative distance of the eigenvalue below which a change may lie on a curve beside it."""
MOST_SECANTS = 20
SAME_ENDS = 1e-6
"""Distance of two ends, eigenvalues included, below which their curves are one: curves do not cross."""
AGREE = 1e-7
"""Distance, in units of the axis, below which a change lies on a curve."""


@dataclass(frozen=True, slots=True)
class Seed:
    """A change on a row, as a start for a curve: values of both parameters and the eigenvalue there."""

    values: tuple[float, float]
    sign: float
    """0 for a Hopf point, else the sign of the double eigenvalue."""
    eigenvalue: float
    """The frequency of a Hopf point, or the double eigenvalue."""


def seed_of(values: tuple[float, float], kind: int, frequency: float, growth_rate: float) -> Seed | None:
    """The seed of a change, or None for an overtaking, which lies on neither kind of curve."""
    if kind in (Kind.hopf, Kind.hopf_reverse, Kind.restabilization):
        return Seed(values, 0.0, frequency)
    if kind in (Kind.onset, Kind.real_again):
        return Seed(values, math.copysign(1.0, growth_rate), growth_rate)
    return None


@dataclass(frozen=True, slots=True)
class _ChangeBoundaries:
    """The curves through the changes of all rows of a plane."""

    plane: Plane
    seeds: list[Seed]

    def next_seed(self, left: Sequence[int]) -> int:
        """The first."""
        return left[0]

    def lacking(self, seed: int) -> list[int]:
        """None: a curve takes milliseconds."""
        return []

    def curve(self, seed: int) -> BoundaryCurve | None:
        """The curve from a change."""
        one = self.seeds[seed]
        x, y = (a.scaled(v) for a, v in zip(self.plane.axes, one.values, strict=True))
        return trace(one.sign, self.plane, (x, y), one.eigenvalue)

    def distance(self, curve: BoundaryCurve, seed: int) -> float:
        """How far along the first axis a change lies from a curve, at its place on the second axis."""
        return _distance(self.plane, curve, self.seeds[seed])

    def same(self, one: BoundaryCurve, other: BoundaryCurve) -> bool:
        """Whether they share an end: beside a crushed rod a change may not be found on its own curve."""
        ends = one.scaled[[0, -1], None] - other.scaled[None, [0, -1]]
        return one.sign == other.sign and float(np.abs(ends).max(axis=-1).min()) < SAME_ENDS


def curves_through(plane: Plane, seeds: list[Seed]) -> Boundaries[BoundaryCurve]:
    """The curves through all changes; each is followed once, and every change is then found on one."""
    problem = _ChangeBoundaries(plane, seeds)
    return boundary_search(problem, range(len(seeds)), AGREE).boundaries


def _distance(plane: Plane, curve: BoundaryCurve, seed: Seed) -> float:
    """How far along the first axis a change lies from the curve, at its place on the second axis."""
    if curve.sign != seed.sign:
        return math.inf
    x, y = (a.scaled(v) for a, v in zip(plane.axes, seed.values, strict=True))
    points = curve.scaled
    side = points[:, 1] - y
    side[np.abs(side) < SAME_COORDINATE] = 0.0
    if len(points) == 1:
        return float(abs(points[0, 0] - x)) if abs(side[0]) < AGREE else math.inf
    best = math.inf
    for i in np.flatnonzero(side[:-1] * side[1:] <= 0):
        a, b = points[i], points[i + 1]
        if not min(a[0], b[0]) - 0.1 <= x <= max(a[0], b[0]) + 0.1:
            continue
        there = _at_height(Boundary(plane, curve.sign), a, b, y)
        if there is not None and abs(there[2] - math.log(abs(seed.eigenvalue))) < ON_CURVE:
            best = min(best, float(abs(there[0] - x)))
    return best


def _at_height(boundary: Boundary, a: Array, b: Array, y: float) -> Array | None:
    """The point (x, y, h) of a curve at the height y between two of its points, or None.

    First at once from the chord; where that guess is too far, by secants along the curve.
    """
    share = (y - a[1]) / (b[1] - a[1]) if a[1] != b[1] else 0.0
    for _ in range(MOST_SECANTS):
        guess = a + share * (b - a)
        level = guess.copy()
        level[1] = y
        there = boundary.corrected(level, np.eye(3)[1])
        if there is not None:
            return there.v
        there = boundary.corrected(guess, (b - a) / np.linalg.norm(b - a))
        if there is None:
            return None
        a, b = (there.v, b) if (there.v[1] - y) * (b[1] - y) <= 0 else (a, there.v)
        share = (y - a[1]) / (b[1] - a[1]) if a[1] != b[1] else 0.0
    return None
