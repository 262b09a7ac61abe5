"""Boundaries of a phase diagram: the curves through the stability changes of its rows.

The curves are traced from the changes of all rows (`rodsweep.solve.changes.diagram.boundary_curves`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ....determinant.boundary import Boundary
from ....determinant.parameter_plane import Plane
from ...continuation.boundaries import Boundaries, boundary_search
from ..unstable_modes import ChangeKind
from .boundary_curves import BoundaryCurve, trace


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeBoundarySettings:
    """Settings for the assignment of the changes on rows to curves."""

    same_coordinate: float = 1e-12
    """Two scaled coordinates with a smaller difference are equal."""
    same_eigenvalue: float = 1e-3
    """Relative difference of the eigenvalues below which a change may lie on a curve beside it."""
    max_secants: int = 20
    """Maximum number of secant steps to a point of a curve at a given height."""
    coincident_ends: float = 1e-6
    """Two curves with ends at a smaller distance, eigenvalue included, are the same: curves do not cross."""
    change_distance: float = 1e-7
    """A change at a smaller distance from a curve, in units of the axis, lies on the curve."""
    beside: float = 0.1
    """Distance beside the ends of a chord, in units of the axis, at which its curve may still have a point:
    steps are shorter."""


CHANGE_BOUNDARIES = ChangeBoundarySettings()


@dataclass(frozen=True, slots=True)
class Seed:
    """A change on a row as the start of a curve: values of both parameters, and the eigenvalue."""

    values: tuple[float, float]
    sign: float
    """0 for a Hopf point, else the sign of the double eigenvalue."""
    eigenvalue: float
    """The frequency of a Hopf point, or the double eigenvalue."""


def seed_of(values: tuple[float, float], kind: int, frequency: float, growth_rate: float) -> Seed | None:
    """The seed of a change; None for an overtaking, because no curve is made of overtakings."""
    if kind in (ChangeKind.hopf, ChangeKind.hopf_reverse, ChangeKind.restabilization):
        return Seed(values, 0.0, frequency)
    if kind in (ChangeKind.onset, ChangeKind.real_again):
        return Seed(values, math.copysign(1.0, growth_rate), growth_rate)
    return None


@dataclass(frozen=True, slots=True)
class _ChangeBoundaries:
    """The curves through the changes of all rows of a plane."""

    plane: Plane
    seeds: list[Seed]

    def next_seed(self, left: Sequence[int]) -> int:
        """The first change on no curve."""
        return left[0]

    def missing_units(self, seed: int) -> list[int]:
        """No unit of work: a curve takes milliseconds and is traced at once."""
        return []

    def curve(self, seed: int) -> BoundaryCurve | None:
        """The curve from a change."""
        one = self.seeds[seed]
        x, y = (a.scaled(v) for a, v in zip(self.plane.axes, one.values, strict=True))
        return trace(one.sign, self.plane, (x, y), one.eigenvalue)

    def distance(self, curve: BoundaryCurve, seed: int) -> float:
        """Distance along the first axis of a change from a curve, at the height of the change."""
        return _distance(self.plane, curve, self.seeds[seed])

    def same(self, one: BoundaryCurve, other: BoundaryCurve) -> bool:
        """Whether two curves share an end: beside a crushed rod a change may not be found on its own
        curve."""
        ends = one.scaled[[0, -1], None] - other.scaled[None, [0, -1]]
        return (
            one.sign == other.sign
            and float(np.abs(ends).max(axis=-1).min()) < CHANGE_BOUNDARIES.coincident_ends
        )


def curves_through(plane: Plane, seeds: list[Seed]) -> Boundaries[BoundaryCurve]:
    """Curves through all changes; each curve is followed once, and every change is then found on a curve."""
    problem = _ChangeBoundaries(plane, seeds)
    return boundary_search(problem, range(len(seeds)), CHANGE_BOUNDARIES.change_distance).boundaries


def _distance(plane: Plane, curve: BoundaryCurve, seed: Seed) -> float:
    """Distance along the first axis of a change from the curve at the height of the change; inf if not
    near."""
    if curve.sign != seed.sign:
        return math.inf
    x, y = (a.scaled(v) for a, v in zip(plane.axes, seed.values, strict=True))
    points = curve.scaled
    side = points[:, 1] - y
    # A change on a point of the curve must not fall between two pieces by rounding.
    side[np.abs(side) < CHANGE_BOUNDARIES.same_coordinate] = 0.0
    if len(points) == 1:
        return float(abs(points[0, 0] - x)) if abs(side[0]) < CHANGE_BOUNDARIES.change_distance else math.inf
    best = math.inf
    for i in np.flatnonzero(side[:-1] * side[1:] <= 0):
        a = points[i]
        b = points[i + 1]
        beside = max(min(a[0], b[0]) - x, x - max(a[0], b[0]))
        if beside > CHANGE_BOUNDARIES.beside:
            continue
        there = _at_height(Boundary(plane, curve.sign), a, b, y)
        if (
            there is not None
            and abs(there[2] - math.log(abs(seed.eigenvalue))) < CHANGE_BOUNDARIES.same_eigenvalue
        ):
            best = min(best, float(abs(there[0] - x)))
    return best


def _at_height(boundary: Boundary, a: Array, b: Array, y: float) -> Array | None:
    """The point (x, y, h) of a curve at height y between two of its points; None if not found.

    Newton's method starts from the chord; if this guess is too far, secants along the curve follow.
    """
    share = (y - a[1]) / (b[1] - a[1]) if a[1] != b[1] else 0.0
    for _ in range(CHANGE_BOUNDARIES.max_secants):
        guess = a + share * (b - a)
        level = guess.copy()
        level[1] = y
        there = boundary.point_near(level, np.eye(3)[1])
        if there is not None:
            return there.v
        there = boundary.point_near(guess, (b - a) / np.linalg.norm(b - a))
        if there is None:
            return None
        a, b = (there.v, b) if (there.v[1] - y) * (b[1] - y) <= 0 else (a, there.v)
        share = (y - a[1]) / (b[1] - a[1]) if a[1] != b[1] else 0.0
    return None
