"""Curves in a plane of rods on which the spectrum changes: Hopf points, and double real eigenvalues.

A boundary (`determinant.boundary`) is followed through its folds. A fold is a point where a coordinate is
extremal on the curve, for example where a window of flutter closes: the tangent has no component along that
axis.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...determinant.boundary import Boundary, OnBoundary
from ...determinant.parameter_plane import Plane
from ...watch import report
from ..continuation.follower import Curve, CurveStop, StepControl, Stepped, follow, zero_along
from ..point import Unsolvable

BOUNDARY_STEPS = StepControl(
    first=0.01, longest=0.04, shortest=1e-9, turn=0.15, sharpest=0.3, growth=1.5, most=5000
)
"""Arc lengths of steps; each axis of the plane has length 1. They are short enough for a smooth drawn
curve."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangeCurveSettings:
    """Points, ends and folds of a boundary curve."""

    beside_an_edge: float = 1e-9
    """Largest distance beyond one edge of the plane for a point on another edge."""
    coincident_points: float = 1e-9
    """Two points of a curve at a smaller distance are one, as at a start on the border of the plane."""
    fold_accuracy: float = 1e-13
    """Convergence tolerance at a fold: component of the tangent, and bracket as a fraction of the step."""
    hopf_tangent: float = 1e-12
    """Error of the tangent to a curve of Hopf points, by rounding."""
    double_tangent: float = 1e-11
    """Error of the tangent to a curve of double eigenvalues, by differences in the Jacobian of D_w."""
    arm_tangent: float = 3e-10
    """Error of the tangent to a curve of arms, by differences of D, which deviate from the closed form by up
    to 8e-11 for uniform rods."""
    min_loop_points: int = 4
    """Fewest points of a closed curve."""


CHANGE_CURVES = ChangeCurveSettings()


class BoundaryEnd(IntEnum):
    """Reasons for the end of a boundary curve."""

    none = 0
    edge = 1
    crushed = 2
    closed = 3
    not_followed = 4
    list_full = 5


@dataclass(frozen=True, slots=True)
class Fold:
    """Extremum of coordinate `axis` (0 or 1) on a curve: both parameters with errors, eigenvalue in
    1/tau2."""

    axis: int
    values: tuple[float, float]
    frequency: float
    growth_rate: float
    errors: tuple[float, float]


@dataclass(frozen=True, slots=True)
class BoundaryCurve:
    """A curve of Hopf points (sign 0) or of double real eigenvalues with a sign (-1 or 1).

    values: of both parameters, (points, 2). frequency, growth_rate: of the eigenvalue, in 1/tau2, (points,).
    ends: reasons for the ends at the first and the last point.
    """

    sign: float
    values: Array
    frequency: Array
    growth_rate: Array
    folds: tuple[Fold, ...]
    ends: tuple[BoundaryEnd, BoundaryEnd]
    scaled: Array
    """Scaled coordinates and h = log|eigenvalue| of each point, (points, 3)."""

    @property
    def hopf(self) -> bool:
        return self.sign == 0


class _CurvePoint(NamedTuple):
    """A point v = (x, y, h) of a curve, and the unit tangent in the direction of the curve, (3,) each."""

    v: Array
    tangent: Array

    @classmethod
    def on(cls, there: OnBoundary, way: Array) -> "_CurvePoint":
        """A point of a boundary; the tangent is oriented to a side, (3,)."""
        tangent = there.tangent
        return cls(there.v, tangent if tangent @ way > 0 else -tangent)


@dataclass(frozen=True, slots=True)
class _Trace:
    """A boundary as a problem for the follower."""

    boundary: Boundary

    def step(self, behind: Sequence[_CurvePoint], length: float) -> Stepped[_CurvePoint]:
        """The point a step along the tangent; raises Unsolvable."""
        v, tangent = behind[-1]
        there = _CurvePoint.on(self.near(v + length * tangent, tangent), tangent)
        return Stepped(there, 0.0, float(there.tangent @ tangent))

    def near(self, guess: Array, normal: Array) -> OnBoundary:
        """The point in the plane through a guess with a normal, both (3,); raises Unsolvable."""
        there = self.boundary.corrected(guess, normal)
        if there is None:
            raise Unsolvable("no point of the boundary is near")
        return there

    def margins(self, point: _CurvePoint) -> Array:
        """Distances from the four edges of the plane, and 1 for a rod that is not crushed, else -1; (5,)."""
        x, y = map(float, point.v[:2])
        on_plane = 0 <= x <= 1 and 0 <= y <= 1
        alive = 1.0 if not on_plane or self.boundary.plane.uncrushed(x, y) else -1.0
        return np.array([x, 1 - x, y, 1 - y, alive])

    def landed(self, behind: Sequence[_CurvePoint], outer: _CurvePoint, margin: int) -> _CurvePoint | None:
        """The point on the edge that a step crosses; None for a crushed rod, or if the point lies beyond a
        second edge."""
        if margin == CRUSHED_MARGIN:
            return None
        axis, limit = divmod(margin, 2)
        inner = behind[-1].v
        share = (limit - inner[axis]) / (outer.v[axis] - inner[axis])
        found = self.boundary.corrected(inner + share * (outer.v - inner), np.eye(3)[axis])
        if (
            found is None
            or not -CHANGE_CURVES.beside_an_edge <= found.v[1 - axis] <= 1 + CHANGE_CURVES.beside_an_edge
        ):
            return None
        return _CurvePoint.on(found, behind[-1].tangent)

    def closes(self, behind: Sequence[_CurvePoint], there: _CurvePoint) -> bool:
        """Whether the curve returns to its first point within the step."""
        first = behind[0]
        last = behind[-1]
        step = float(np.linalg.norm(there.v - last.v))
        near = float(np.linalg.norm(there.v - first.v)) < step
        return (
            len(behind) >= CHANGE_CURVES.min_loop_points and near and float(there.tangent @ first.tangent) > 0
        )

    def end_of(self, followed: Curve[_CurvePoint]) -> BoundaryEnd:
        """The reason for the end of a followed curve.

        No solution is found beyond a point on an edge where a parameter cannot go further, as gamma3 below 0,
        nor for a crushed rod, which may be closer than the shortest step.
        """
        if followed.end is CurveStop.closed:
            return BoundaryEnd.closed
        if followed.end is CurveStop.full:
            return BoundaryEnd.list_full
        if followed.end is CurveStop.margin:
            return BoundaryEnd.crushed if followed.margin == CRUSHED_MARGIN else BoundaryEnd.edge
        v, tangent = followed.solutions[-1]
        if self.margins(followed.solutions[-1])[:CRUSHED_MARGIN].min() <= CHANGE_CURVES.beside_an_edge:
            return BoundaryEnd.edge
        beyond = _CurvePoint(v + 2 * BOUNDARY_STEPS.shortest * tangent, tangent)
        is_crushed = self.margins(beyond)[CRUSHED_MARGIN] < 0
        return BoundaryEnd.crushed if is_crushed else BoundaryEnd.not_followed


CRUSHED_MARGIN = 4
"""Index of the margin that is negative for a crushed rod."""


def trace(sign: float, plane: Plane, start: tuple[float, float], eigenvalue: float) -> BoundaryCurve | None:
    """The curve of a sign through a start in scaled coordinates with |w| = |eigenvalue|; None if not found.

    The curve is followed in both directions until it leaves the plane, closes, or reaches a crushed rod.
    """
    curve = _Trace(Boundary(plane, sign))
    guess = np.array([*start, math.log(abs(eigenvalue))])
    try:
        tangent = curve.boundary.tangent(guess)
        first = _CurvePoint.on(curve.near(guess, tangent), tangent)
    except (ValueError, ArithmeticError, Unsolvable):
        return None
    ahead = follow(curve, first, BOUNDARY_STEPS, lambda _: report())
    back = ahead
    passed = ahead.solutions
    if ahead.end is not CurveStop.closed:
        back = follow(curve, _CurvePoint(first.v, -first.tangent), BOUNDARY_STEPS, lambda _: report())
        passed = [*back.solutions[:0:-1], *passed]
    points = np.array([point.v for point in passed])
    apart = np.abs(np.diff(points, axis=0)).max(axis=1) > CHANGE_CURVES.coincident_points
    return _curve(curve, points[np.append(apart, True)], (curve.end_of(back), curve.end_of(ahead)))


def _curve(curve: _Trace, points: Array, ends: tuple[BoundaryEnd, BoundaryEnd]) -> BoundaryCurve:
    """The curve through points, (points, 3), with the folds between them and the reasons for its ends."""
    boundary = curve.boundary
    folds = []
    if len(points) > 1:
        forward = np.diff(points, axis=0, append=points[-1:] + (points[-1:] - points[-2:-1]))
        tangents = np.array([boundary.tangent(v) for v in points])
        tangents *= np.where((tangents * forward).sum(axis=1) < 0, -1.0, 1.0)[:, None]
        passed = list(map(_CurvePoint, points, tangents))
        for axis in (0, 1):
            for i in np.flatnonzero(tangents[:-1, axis] * tangents[1:, axis] < 0):
                fold = _fold(curve, passed[i], passed[i + 1], axis)
                if fold is not None:
                    folds.append(fold)
    # One by one: the rounding of NumPy's exp of an array depends on the place of an element in memory.
    growth_rate, frequency = np.array([boundary.eigenvalue(h) for h in points[:, 2]]).T
    axes = boundary.plane.axes
    values = np.array([[axis.value(x) for axis, x in zip(axes, v[:2], strict=True)] for v in points])
    return BoundaryCurve(boundary.sign, values, frequency, growth_rate, tuple(folds), ends, points)


def _fold(curve: _Trace, a: _CurvePoint, b: _CurvePoint, axis: int) -> Fold | None:
    """The point between two where the tangent has no component along an axis; None if not found."""
    boundary = curve.boundary
    noise = _tangent_noise(curve.boundary)
    chord = b.v - a.v
    found = dict[float, OnBoundary]()
    size = float(np.linalg.norm(chord))

    def component(length: float) -> float:
        found[length] = there = curve.near(a.v + length / size * chord, chord / size)
        return float(_CurvePoint.on(there, chord).tangent[axis])

    ends = float(a.tangent[axis]), float(b.tangent[axis])
    try:
        length = zero_along(component, ends, size, CHANGE_CURVES.fold_accuracy, CHANGE_CURVES.fold_accuracy)
        along = (abs(component(length)) + noise) * size / abs(ends[1] - ends[0])
    except Unsolvable:
        return None
    return _as_fold(boundary, found[length], axis, along)


def _tangent_noise(boundary: Boundary) -> float:
    """Error of the tangents of a boundary."""
    if not boundary.plane.standard:
        return CHANGE_CURVES.arm_tangent
    return CHANGE_CURVES.double_tangent if boundary.sign else CHANGE_CURVES.hopf_tangent


def _as_fold(boundary: Boundary, there: OnBoundary, axis: int, along: float) -> Fold:
    """The fold at a point of a boundary. along: error of the point in the direction of the curve."""
    axes = boundary.plane.axes
    first, second = (a.value(float(x)) for a, x in zip(axes, there.v[:2], strict=True))
    units = [abs(a.stretch(x)) for a, x in zip(axes, (first, second), strict=True)]
    # Along the curve the extremal coordinate is stationary at the fold, the other coordinate is not.
    errors = [unit * (there.error if i == axis else there.error + along) for i, unit in enumerate(units)]
    growth_rate, frequency = boundary.eigenvalue(there.v[2])
    return Fold(axis, (first, second), frequency, growth_rate, (errors[0], errors[1]))
