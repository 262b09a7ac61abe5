"""Curves in a plane of rods on which the spectrum changes: Hopf points, and double real eigenvalues.

With h = log eta a Hopf curve is D(i eta; x, y) = 0, and with h = log |w| a curve of double real
eigenvalues is D(w; x, y) = D_w = 0, where w keeps its sign because D(0) = 1. Both are two real equations
for (x, y, h), which pseudo-arclength continuation follows through folds. A fold is a point where one of
the coordinates is extremal on the curve, as where a window of flutter closes: there the tangent has no
component along that axis.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from .plane import Plane

Vector = NDArray[np.float64]
Equations = Callable[[Plane, Vector], tuple[Vector, NDArray[np.float64], float]]

STEP_FIRST, STEP_LARGEST, STEP_SMALLEST = 0.01, 0.04, 1e-9
"""Steps of arclength in units of the plane, in which an axis has length 1."""
TURN = 0.15
"""Largest angle between successive tangents, in radians; the step follows it."""
COINCIDENT = 1e-9
"""Distance of two points of a curve that are one, as where it starts on the border of the plane."""
MOST_NEWTON, MOST_POINTS, MOST_FOLD_STEPS = 12, 5000, 80
DIFFERENCE = 1e-3
STENCIL = ((-2, 1 / 12), (-1, -8 / 12), (1, 8 / 12), (2, -1 / 12))
ONE_SIDED = ((0, -25 / 12), (1, 4.0), (2, -3.0), (3, 4 / 3), (4, -1 / 4))
"""Step and weights of the differences, of fourth order, in the Jacobian of D_w; beside a limit, one-sided."""
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
class Curve:
    """A curve of Hopf points (sign 0) or of double real eigenvalues of a sign (-1 or 1).

    values: of both parameters, shape (points, 2).

    frequency, growth_rate: of the eigenvalue, in 1/tau2, shape (points,).
    """

    sign: float
    values: NDArray[np.float64]
    frequency: NDArray[np.float64]
    growth_rate: NDArray[np.float64]
    folds: tuple[Fold, ...]
    closed: bool
    scaled: NDArray[np.float64]
    """(x, y, h) of each point, shape (points, 3)."""

    @property
    def hopf(self) -> bool:
        return self.sign == 0


def hopf_equations(plane: Plane, v: Vector) -> tuple[Vector, NDArray[np.float64], float]:
    """(residual, Jacobian, rounding error of the residual) of D(i exp(h); x, y)."""
    w = complex(0.0, math.exp(v[2]))
    D, D_w, D_x, D_y, _, blur = plane.determinant(w, v[0], v[1])
    rows = np.array([D_x, D_y, D_w * w])
    scale = float(np.abs(rows).max())
    jacobian = np.array([rows.real, rows.imag]) / scale
    return np.array([D.real, D.imag]) / scale, jacobian, blur / scale


def double_equations(sign: float, plane: Plane, v: Vector) -> tuple[Vector, NDArray[np.float64], float]:
    """(residual, Jacobian, rounding error) of (D, w D_w) at w = sign exp(h)."""
    value, blur = _real_rows(sign, plane, v)
    jacobian = np.empty((2, 3))
    jacobian[0] = value[1], value[2], value[3]  # D_x, D_y, w D_w = dD/dh
    size = value[4]
    for i in range(3):
        h = plane.small_step(v[0], v[1], i, DIFFERENCE) if i < 2 else DIFFERENCE
        jacobian[1, i] = 0.0
        back = v.copy()
        back[i] -= 2 * h
        for places, weight in STENCIL if plane.holds(back[0], back[1]) else ONE_SIDED:
            step = np.zeros(3)
            step[i] = places * h
            there = _real_rows(sign, plane, v + step)[0]
            jacobian[1, i] += weight * there[3] * math.exp(there[4] - size) / h
    scale = np.abs(jacobian).max(axis=1)
    residual = np.array([value[0], value[3]]) / scale
    return residual, jacobian / scale[:, None], float(blur / scale.min())


def _real_rows(
    sign: float, plane: Plane, v: Vector
) -> tuple[tuple[float, float, float, float, float], float]:
    """((D, D_x, D_y, w D_w, S), rounding error) at w = sign exp(h), where D is real."""
    w = complex(sign * math.exp(v[2]), 0.0)
    D, D_w, D_x, D_y, S, blur = plane.determinant(w, v[0], v[1])
    return (D.real, D_x.real, D_y.real, (w * D_w).real, S), blur


def equations_of(sign: float) -> Equations:
    """The equations of a curve: of Hopf points for sign 0, of double eigenvalues of that sign else."""
    return partial(double_equations, sign) if sign else hopf_equations


def tangent(jacobian: NDArray[np.float64]) -> Vector:
    """The unit null vector of a 2 x 3 Jacobian."""
    t: Vector = np.cross(jacobian[0], jacobian[1])
    return t / np.linalg.norm(t)


def corrected(
    equations: Equations, plane: Plane, guess: Vector, normal: NDArray[np.floating]
) -> tuple[Vector, NDArray[np.float64], float] | None:
    """(point, Jacobian, its error) of the curve in the plane through `guess` with that normal, or None."""
    v, last = guess.copy(), math.inf
    for _ in range(MOST_NEWTON):
        try:
            residual, jacobian, blur = equations(plane, v)
        except (ValueError, ArithmeticError):
            return None
        matrix = np.vstack([jacobian, normal])
        right = np.append(-residual, -normal @ (v - guess))
        if not np.isfinite(matrix).all() or abs(np.linalg.det(matrix)) < 1e-300:
            return None
        inverse = np.linalg.inv(matrix)
        step = inverse @ right
        error = float(np.abs(inverse[:, :2]).sum(axis=1).max()) * blur
        size = float(np.abs(step).max())
        v = v + step
        if size <= 4 * error or (size < 1e-10 and size > last / 2):
            return v, jacobian, max(error, size)
        if size > 0.5 or not np.isfinite(v).all():
            return None
        last = size
    return None


def trace(sign: float, plane: Plane, start: tuple[float, float], eigenvalue: float) -> Curve | None:
    """The curve of that sign through a start (scaled coordinates) with |w| = |eigenvalue|; or None.

    It is followed in both directions until it leaves the plane, closes, or reaches a crushed rod.
    """
    equations = equations_of(sign)
    guess = np.array([*start, math.log(abs(eigenvalue))])
    try:
        first = corrected(equations, plane, guess, tangent(equations(plane, guess)[1]))
    except (ValueError, ArithmeticError):
        return None
    if first is None:
        return None
    ahead, closed = _follow(equations, plane, first[0], 1.0)
    back = [] if closed else _follow(equations, plane, first[0], -1.0)[0]
    points = np.array([*back[::-1], first[0], *ahead])
    apart = np.abs(np.diff(points, axis=0)).max(axis=1) > COINCIDENT
    return _curve(sign, plane, points[np.append(apart, True)], closed)


def _follow(equations: Equations, plane: Plane, start: Vector, sign: float) -> tuple[list[Vector], bool]:
    """(points after the start in one direction, whether the curve came back to it)."""
    v = start
    t = sign * tangent(equations(plane, v)[1])
    t0, step, points = t, STEP_FIRST, []  # type: Vector, float, list[Vector]
    while len(points) < MOST_POINTS and step >= STEP_SMALLEST:
        there = corrected(equations, plane, v + step * t, t)
        if there is None:
            step /= 2
            continue
        turned = tangent(there[1])
        turned = turned if turned @ t > 0 else -turned
        angle = math.acos(min(1.0, float(turned @ t)))
        if angle > 2 * TURN:
            step /= 2
            continue
        if not plane.inside(there[0][0], there[0][1]):
            edge = _edge(equations, plane, v, there[0])
            return points + ([] if edge is None else [edge]), False
        if len(points) > 2 and np.linalg.norm(there[0] - start) < step and turned @ t0 > 0:
            return [*points, start], True
        v, t = there[0], turned
        points.append(v)
        step = min(STEP_LARGEST, step * min(1.5, max(0.5, TURN / max(angle, 1e-3))))
    return points, False


def _edge(equations: Equations, plane: Plane, inner: Vector, outer: Vector) -> Vector | None:
    """The point where the curve leaves the plane between two points, one inside and one not."""
    for axis in (0, 1):
        for limit in (0.0, 1.0):
            if (inner[axis] - limit) * (outer[axis] - limit) < 0:
                guess = inner + (limit - inner[axis]) / (outer[axis] - inner[axis]) * (outer - inner)
                found = on_line(equations, plane, guess, axis)
                if found is not None and -1e-9 <= found[0][1 - axis] <= 1 + 1e-9:
                    return found[0]
    return None


def on_line(
    equations: Equations, plane: Plane, guess: Vector, axis: int
) -> tuple[Vector, NDArray[np.float64], float] | None:
    """(point, Jacobian, error) of the curve at the guess's coordinate of an axis."""
    return corrected(equations, plane, guess, np.eye(3)[axis])


def _curve(sign: float, plane: Plane, points: NDArray[np.float64], closed: bool) -> Curve:
    equations = equations_of(sign)
    folds = []
    if len(points) > 1:
        tangents = _oriented(np.array([tangent(equations(plane, v)[1]) for v in points]), points)
        for axis in (0, 1):
            for i in np.flatnonzero(tangents[:-1, axis] * tangents[1:, axis] < 0):
                fold = _fold(sign, plane, (points[i], tangents[i]), (points[i + 1], tangents[i + 1]), axis)
                if fold is not None:
                    folds.append(fold)
    # One by one: NumPy's exp of an array may round an element by its place in memory.
    size = np.array([math.exp(h) for h in points[:, 2]])
    zero = np.zeros(len(points))
    values = np.array([[axis.value(x) for axis, x in zip(plane.axes, v[:2], strict=True)] for v in points])
    frequency, growth_rate = (zero, sign * size) if sign else (size, zero)
    return Curve(sign, values, frequency, growth_rate, tuple(folds), closed, points)


def _oriented(tangents: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The tangents, each turned along the direction from its point to the next."""
    forward = np.diff(points, axis=0, append=points[-1:] + (points[-1:] - points[-2:-1]))
    return tangents * np.where((tangents * forward).sum(axis=1) < 0, -1.0, 1.0)[:, None]


def _fold(
    sign: float, plane: Plane, left: tuple[Vector, Vector], right: tuple[Vector, Vector], axis: int
) -> Fold | None:
    """The point between two points of a curve where the tangent has no component along an axis."""
    equations = equations_of(sign)
    a, b = left, right
    noise, fold = DOUBLE_TANGENT if sign else HOPF_TANGENT, None
    for i in range(MOST_FOLD_STEPS):
        # Bisection every third step keeps the bracket shrinking from both sides.
        share = a[1][axis] / (a[1][axis] - b[1][axis]) if i % 3 else 0.5
        normal = b[0] - a[0]
        size = float(np.linalg.norm(normal))
        there = corrected(equations, plane, a[0] + share * normal, normal / size)
        if there is None:
            return None
        t = tangent(there[1])
        t = t if t @ normal > 0 else -t
        along = (abs(float(t[axis])) + noise) * size / abs(float(b[1][axis] - a[1][axis]))
        fold = _as_fold(sign, plane, there, axis, along)
        if abs(t[axis]) < FOLD_ACCURACY or size < FOLD_ACCURACY:
            break
        a, b = ((there[0], t), b) if t[axis] * a[1][axis] > 0 else (a, (there[0], t))
    return fold


def _as_fold(
    sign: float, plane: Plane, there: tuple[Vector, NDArray[np.float64], float], axis: int, along: float
) -> Fold:
    v, _, error = there
    first, second = (a.value(float(x)) for a, x in zip(plane.axes, v[:2], strict=True))
    units = [abs(a.stretch(x)) for a, x in zip(plane.axes, (first, second), strict=True)]
    # Across the fold the extremal coordinate does not move to first order, the other one does.
    errors = [unit * (error if i == axis else error + along) for i, unit in enumerate(units)]
    size = math.exp(v[2])
    frequency, growth_rate = (0.0, sign * size) if sign else (size, 0.0)
    return Fold(axis, (first, second), frequency, growth_rate, (errors[0], errors[1]))
