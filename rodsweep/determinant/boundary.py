"""Boundaries in a plane of rods: where a pair crosses the imaginary axis, or two real eigenvalues meet.

With h = log eta Hopf points are D(i eta; x, y) = 0, and with h = log |w| double real eigenvalues are
D(w; x, y) = D_w = 0, where w keeps its sign because D(0) = 1. Both are two real equations for v = (x, y, h),
solved by Newton's method together with a third one.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .parameter_plane import SMALL_STEP, STENCIL, Plane

MOST_CORRECTIONS = 12


class OnBoundary(NamedTuple):
    """A point v of a boundary, the 2 x 3 Jacobian of its equations, and the error of v."""

    v: Array
    jacobian: Array
    error: float

    @property
    def tangent(self) -> Array:
        """The unit null vector of the Jacobian, shape (3,)."""
        t: Array = np.cross(self.jacobian[0], self.jacobian[1])
        return t / np.linalg.norm(t)


@dataclass(frozen=True, slots=True)
class Boundary:
    """All Hopf points of a plane (sign 0) or all double real eigenvalues of a sign (-1 or 1)."""

    plane: Plane
    sign: float

    def eigenvalue(self, h: float) -> tuple[float, float]:
        """(growth rate, frequency) of the eigenvalue of that h."""
        size = math.exp(h)
        return (self.sign * size, 0.0) if self.sign else (0.0, size)

    def equations(self, v: Array) -> tuple[Array, Array, float]:
        """(residual, Jacobian, rounding error of the residual), shapes (2,), (2, 3)."""
        return self._double_equations(v) if self.sign else self._hopf_equations(v)

    def tangent(self, v: Array) -> Array:
        """The unit tangent at v, shape (3,)."""
        _, jacobian, error = self.equations(v)
        return OnBoundary(v, jacobian, error).tangent

    def corrected(self, guess: Array, normal: NDArray[np.floating]) -> OnBoundary | None:
        """The point of the boundary in the plane through `guess` with that normal, both (3,), or None."""
        v, last = guess.copy(), math.inf
        for _ in range(MOST_CORRECTIONS):
            try:
                residual, jacobian, blur = self.equations(v)
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
                return OnBoundary(v, jacobian, max(error, size))
            if size > 0.5 or not np.isfinite(v).all():
                return None
            last = size
        return None

    def _hopf_equations(self, v: Array) -> tuple[Array, Array, float]:
        """`equations` of D(i exp(h); x, y)."""
        w = complex(0.0, math.exp(v[2]))
        D, D_w, D_x, D_y, _, blur = self.plane.determinant(w, v[0], v[1])
        rows = np.array([D_x, D_y, D_w * w])
        scale = float(np.abs(rows).max())
        jacobian = np.array([rows.real, rows.imag]) / scale
        return np.array([D.real, D.imag]) / scale, jacobian, blur / scale

    def _double_equations(self, v: Array) -> tuple[Array, Array, float]:
        """`equations` of (D, w D_w) at w = sign exp(h), where D is real."""
        w = self._real(v)
        here = self.plane.determinant(w, v[0], v[1])
        slope = (w * here.D_w).real  # w D_w = dD/dh
        jacobian = np.empty((2, 3))
        jacobian[0] = here.D_x.real, here.D_y.real, slope
        for i in range(3):
            stencil, h = self.plane.stencil(v[0], v[1], i) if i < 2 else (STENCIL, SMALL_STEP)
            jacobian[1, i] = 0.0
            for places, weight in stencil:
                step = np.zeros(3)
                step[i] = places * h
                beside = v + step
                w = self._real(beside)
                there = self.plane.value(w, beside[0], beside[1])
                jacobian[1, i] += weight * (w * there.D_w).real * math.exp(there.S - here.S) / h
        scale = np.abs(jacobian).max(axis=1)
        residual = np.array([here.D.real, slope]) / scale
        return residual, jacobian / scale[:, None], float(here.blur / scale.min())

    def _real(self, v: Array) -> complex:
        """w = sign exp(h)."""
        return complex(self.sign * math.exp(v[2]), 0.0)
