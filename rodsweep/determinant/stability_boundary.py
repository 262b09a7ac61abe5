"""Stability boundaries in a plane of rods: curves of Hopf points and of double real eigenvalues.

Hopf points satisfy D(i eta; x, y) = 0, with h = log eta. Double real eigenvalues satisfy D(w; x, y) = 0 and
D_w = 0, with h = log |w|; the sign of w is constant on a curve because D(0) = 1. In either case there are two
real equations for v = (x, y, h). Newton's method solves these with a third equation, of a plane in v.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .exponents import EXPONENT_SETTINGS
from .parameter_plane import FOURTH_ORDER_CENTRAL_STENCIL, PLANE_DIFFERENCE_SETTINGS, ParameterPlane


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundaryPointSettings:
    """Settings of Newton's method for a point on a stability boundary."""

    max_steps: int = 12
    """Newton's method fails if it has not converged after this number of steps."""
    max_step: float = 0.5
    """Newton's method fails if a step changes a coordinate of v by more than this. v = (x, y, h): scaled
    parameters x and y, from 0 to 1, and h = log |w|."""
    converged_step_in_rounding_errors: float = 4.0
    """Newton's method has converged if |step| <= this number times the rounding error of the point."""
    min_jacobian_determinant: float = EXPONENT_SETTINGS.min_divisor
    """Newton's method fails if |determinant| of the 3 x 3 matrix of a step is below this number; the
    determinants of regular matrices are far larger."""
    min_stagnant_step_ratio: float = 0.5
    """A step shorter than `max_stagnant_step` is rounding error if it exceeds this number times the previous
    step."""
    max_stagnant_step: float = 1e-10
    """Newton's method has also converged if |step| is below this number and more than
    `min_stagnant_step_ratio` times the previous |step|."""


BOUNDARY_POINT_SETTINGS = BoundaryPointSettings()


class BoundarySolution(NamedTuple):
    """A point v = (x, y, h) on a stability boundary, h = log |w|; Jacobian of the equations at v, (2, 3);
    error: largest error of a coordinate of v."""

    v: Array
    jacobian: Array
    """Derivatives of the two equations of the boundary by x, y and h, (2, 3)."""
    error: float

    @property
    def tangent(self) -> Array:
        """Unit tangent of the boundary: the null vector of the Jacobian, (3,)."""
        t: Array = np.cross(self.jacobian[0], self.jacobian[1])
        return t / np.linalg.norm(t)


@dataclass(frozen=True, slots=True)
class StabilityBoundary:
    """A stability boundary in a plane: all Hopf points, or all double real eigenvalues of one sign.
    double_eigenvalue_sign: 0 for Hopf points; -1 or 1 for double eigenvalues of this sign."""

    plane: ParameterPlane
    double_eigenvalue_sign: float

    def growth_rate_and_frequency(self, h: float) -> tuple[float, float]:
        """(growth rate, frequency), in 1/tau2, of the eigenvalue at a point whose third coordinate is h."""
        size = math.exp(h)
        return (self.double_eigenvalue_sign * size, 0.0) if self.double_eigenvalue_sign else (0.0, size)

    def residual_and_jacobian(self, v: Array) -> tuple[Array, Array, float]:
        """Returns (residual, (2,); Jacobian, (2, 3); rounding error of the residual) of the two equations of
        the boundary at v = (x, y, h)."""
        return (
            self._double_eigenvalue_equations(v) if self.double_eigenvalue_sign else self._hopf_equations(v)
        )

    def tangent(self, v: Array) -> Array:
        """Unit tangent of the boundary at v, (3,)."""
        _, jacobian, error = self.residual_and_jacobian(v)
        return BoundarySolution(v, jacobian, error).tangent

    def point_near(self, guess: Array, normal: NDArray[np.floating]) -> BoundarySolution | None:
        """The point of the boundary on the plane through `guess`, (3,), normal to `normal`, (3,); None if
        Newton's method fails. guess: start of Newton's method, coordinates as in `residual_and_jacobian`."""
        v = guess.copy()
        previous_size = math.inf
        for _ in range(BOUNDARY_POINT_SETTINGS.max_steps):
            try:
                residual, jacobian, rounding = self.residual_and_jacobian(v)
            except (ValueError, ArithmeticError):
                return None
            matrix = np.vstack([jacobian, normal])
            right_side = np.append(-residual, -normal @ (v - guess))
            if (
                not np.isfinite(matrix).all()
                or abs(np.linalg.det(matrix)) < BOUNDARY_POINT_SETTINGS.min_jacobian_determinant
            ):
                return None
            # The inverse itself is needed: its rows turn the rounding of the residual into the error of v.
            inverse = np.linalg.inv(matrix)
            step = inverse @ right_side
            # The third column belongs to the plane through the guess, an equation without rounding errors.
            error = float(np.abs(inverse[:, :2]).sum(axis=1).max()) * rounding
            step_size = float(np.abs(step).max())
            v = v + step
            if step_size <= BOUNDARY_POINT_SETTINGS.converged_step_in_rounding_errors * error or (
                step_size < BOUNDARY_POINT_SETTINGS.max_stagnant_step
                and step_size > BOUNDARY_POINT_SETTINGS.min_stagnant_step_ratio * previous_size
            ):
                return BoundarySolution(v, jacobian, max(error, step_size))
            if step_size > BOUNDARY_POINT_SETTINGS.max_step or not np.isfinite(v).all():
                return None
            previous_size = step_size
        return None

    def _hopf_equations(self, v: Array) -> tuple[Array, Array, float]:
        """`residual_and_jacobian` of Hopf points at v = (x, y, h): D(i exp(h); x, y) = 0."""
        w = complex(0.0, math.exp(v[2]))
        D, D_w, D_x, D_y, _, rounding = self.plane.determinant(w, v[0], v[1])
        # h is log eta, so that dD/dh = w dD/dw.
        rows = np.array([D_x, D_y, D_w * w])
        scale = float(np.abs(rows).max())
        jacobian = np.array([rows.real, rows.imag]) / scale
        return np.array([D.real, D.imag]) / scale, jacobian, rounding / scale

    def _double_eigenvalue_equations(self, v: Array) -> tuple[Array, Array, float]:
        """`residual_and_jacobian` of double eigenvalues at v = (x, y, h): D = 0 and w D_w = 0 at the real w =
        sign exp(h)."""
        w = self._real_eigenvalue(v)
        value = self.plane.determinant(w, v[0], v[1])
        slope = (w * value.D_w).real  # w D_w = dD/dh
        jacobian = np.empty((2, 3))
        jacobian[0] = value.D_x.real, value.D_y.real, slope
        for i in range(3):
            stencil, h = (
                self.plane.difference_stencil(v[0], v[1], i)
                if i < 2
                else (FOURTH_ORDER_CENTRAL_STENCIL, PLANE_DIFFERENCE_SETTINGS.max_difference_step)
            )
            jacobian[1, i] = 0.0
            for offset, weight in stencil:
                step = np.zeros(3)
                step[i] = offset * h
                shifted = v + step
                w = self._real_eigenvalue(shifted)
                neighbour = self.plane.determinant_value(w, shifted[0], shifted[1])
                jacobian[1, i] += (
                    weight * (w * neighbour.D_w).real * math.exp(neighbour.log_scale - value.log_scale) / h
                )
        scale = np.abs(jacobian).max(axis=1)
        residual = np.array([value.D.real, slope]) / scale
        return residual, jacobian / scale[:, None], float(value.rounding_error / scale.min())

    def _real_eigenvalue(self, v: Array) -> complex:
        """The real eigenvalue w = sign exp(h) at v = (x, y, h)."""
        return complex(self.double_eigenvalue_sign * math.exp(v[2]), 0.0)
