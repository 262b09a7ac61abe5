"""Curves in a plane of rods on which the spectrum changes: Hopf points, and double real eigenvalues.

Pseudo-arclength continuation follows a boundary (`rodsweep.determinant.boundary`) through folds. A fold is a
point where one of the coordinates is extremal on the curve, as where a window of flutter closes: there the
tangent has no component along that axis.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .boundary import Boundary, OnBoundary
from .parameter_plane import Plane

STEP_FIRST, STEP_LARGEST, STEP_SMALLEST = 0.01, 0.04, 1e-9
"""Steps of arclength in units of the plane, in which an axis has length 1."""
TURN = 0.15
"""Largest angle between successive tangents, in radians; the step follows it."""
COINCIDENT = 1e-9
"""Distance of two points of a curve that are one, as where it starts on the border of the plane."""
MOST_CURVE_POINTS, MOST_FOLD_STEPS = 5000, 80
FOLD_ACCURACY = 1e-13
"""Component of the tangent, or length of the bracket, that counts as none."""
HOPF_TANGENT, DOUBLE_TANGENT = 1e-12, 1e-11
"""Uncertainty of a tangent: from rounding, and from the differences in the Jacobian of D_w."""


@dataclass(frozen=True, slots=True)
class Fold:
    """Where the coordinate of the axis `axis` (0 or 1) is extremal on a curve: values of both parameters."""

    axis: int
    values: tuple[float, float]
    frequency: float
    growth_rate: float
    errors: tuple[float, float]


@dataclass(frozen=True, slots=True)
class BoundaryCurve:
    """A curve of Hopf points (sign 0) or of double real eigenvalues of a sign (-1 or 1).

    values: of both parameters, shape (points, 2).

    frequency, growth_rate: of the eigenvalue, in 1/tau2, shape (points,).
    """

    sign: float
    values: Array
    frequency: Array
    growth_rate: Array
    folds: tuple[Fold, ...]
    scaled: Array
    """(x, y, h) of each point, shape (points, 3)."""

    @property
    def hopf(self) -> bool:
        return self.sign == 0


def trace(sign: float, plane: Plane, start: tuple[float, float], eigenvalue: float) -> BoundaryCurve | None:
    """The curve of that sign through a start (scaled coordinates) with |w| = |eigenvalue|; or None.

    It is followed in both directions until it leaves the plane, closes, or reaches a crushed rod.
    """
    boundary = Boundary(plane, sign)
    guess = np.array([*start, math.log(abs(eigenvalue))])
    try:
        first = boundary.corrected(guess, boundary.tangent(guess))
    except (ValueError, ArithmeticError):
        return None
    if first is None:
        return None
    ahead, closed = _follow(boundary, first.v, 1.0)
    back = [] if closed else _follow(boundary, first.v, -1.0)[0]
    points = np.array([*back[::-1], first.v, *ahead])
    apart = np.abs(np.diff(points, axis=0)).max(axis=1) > COINCIDENT
    return _curve(boundary, points[np.append(apart, True)])


def _follow(boundary: Boundary, start: Array, sign: float) -> tuple[list[Array], bool]:
    """(points after the start in one direction, whether the curve came back to it)."""
    v = start
    t = sign * boundary.tangent(v)
    t0, step = t, STEP_FIRST
    points: list[Array] = []
    while len(points) < MOST_CURVE_POINTS and step >= STEP_SMALLEST:
        there = boundary.corrected(v + step * t, t)
        if there is None:
            step /= 2
            continue
        turned = there.tangent
        turned = turned if turned @ t > 0 else -turned
        angle = math.acos(min(1.0, float(turned @ t)))
        if angle > 2 * TURN:
            step /= 2
            continue
        if not boundary.plane.inside(there.v[0], there.v[1]):
            edge = _edge(boundary, v, there.v)
            return points + ([] if edge is None else [edge]), False
        if len(points) > 2 and np.linalg.norm(there.v - start) < step and turned @ t0 > 0:
            return [*points, start], True
        v, t = there.v, turned
        points.append(v)
        step = min(STEP_LARGEST, step * min(1.5, max(0.5, TURN / max(angle, 1e-3))))
    return points, False


def _edge(boundary: Boundary, inner: Array, outer: Array) -> Array | None:
    """The point where the curve leaves the plane between two points, one inside and one not."""
    for axis in (0, 1):
        for limit in (0.0, 1.0):
            if (inner[axis] - limit) * (outer[axis] - limit) < 0:
                guess = inner + (limit - inner[axis]) / (outer[axis] - inner[axis]) * (outer - inner)
                found = boundary.corrected(guess, np.eye(3)[axis])
                if found is not None and -1e-9 <= found.v[1 - axis] <= 1 + 1e-9:
                    return found.v
    return None


def _curve(boundary: Boundary, points: Array) -> BoundaryCurve:
    """The curve through these points, with the folds between them."""
    folds = []
    if len(points) > 1:
        tangents = np.array([boundary.tangent(v) for v in points])
        # Each is turned along the direction from its point to the next.
        forward = np.diff(points, axis=0, append=points[-1:] + (points[-1:] - points[-2:-1]))
        tangents *= np.where((tangents * forward).sum(axis=1) < 0, -1.0, 1.0)[:, None]
        for axis in (0, 1):
            for i in np.flatnonzero(tangents[:-1, axis] * tangents[1:, axis] < 0):
                fold = _fold(boundary, (points[i], tangents[i]), (points[i + 1], tangents[i + 1]), axis)
                if fold is not None:
                    folds.append(fold)
    # One by one: NumPy's exp of an array may round an element by its place in memory.
    growth_rate, frequency = np.array([boundary.eigenvalue(h) for h in points[:, 2]]).T
    axes = boundary.plane.axes
    values = np.array([[axis.value(x) for axis, x in zip(axes, v[:2], strict=True)] for v in points])
    return BoundaryCurve(boundary.sign, values, frequency, growth_rate, tuple(folds), points)


def _fold(boundary: Boundary, a: tuple[Array, Array], b: tuple[Array, Array], axis: int) -> Fold | None:
    """The point between two of a curve, (v, tangent), where the tangent has no component along an axis."""
    noise, fold = DOUBLE_TANGENT if boundary.sign else HOPF_TANGENT, None
    for i in range(MOST_FOLD_STEPS):
        # Bisection every third step keeps the bracket shrinking from both sides.
        share = a[1][axis] / (a[1][axis] - b[1][axis]) if i % 3 else 0.5
        normal = b[0] - a[0]
        size = float(np.linalg.norm(normal))
        there = boundary.corrected(a[0] + share * normal, normal / size)
        if there is None:
            return None
        t = there.tangent
        t = t if t @ normal > 0 else -t
        along = (abs(float(t[axis])) + noise) * size / abs(float(b[1][axis] - a[1][axis]))
        fold = _as_fold(boundary, there, axis, along)
        if abs(t[axis]) < FOLD_ACCURACY or size < FOLD_ACCURACY:
            break
        a, b = ((there.v, t), b) if t[axis] * a[1][axis] > 0 else (a, (there.v, t))
    return fold


def _as_fold(boundary: Boundary, there: OnBoundary, axis: int, along: float) -> Fold:
    """The fold at a point of a boundary; `along`: its error in the direction of the curve."""
    axes = boundary.plane.axes
    first, second = (a.value(float(x)) for a, x in zip(axes, there.v[:2], strict=True))
    units = [abs(a.stretch(x)) for a, x in zip(axes, (first, second), strict=True)]
    # Across the fold the extremal coordinate does not move to first order, the other one does.
    errors = [unit * (there.error if i == axis else there.error + along) for i, unit in enumerate(units)]
    growth_rate, frequency = boundary.eigenvalue(there.v[2])
    return Fold(axis, (first, second), frequency, growth_rate, (errors[0], errors[1]))
