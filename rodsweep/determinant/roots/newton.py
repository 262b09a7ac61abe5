"""Newton's method for eigenvalues of a uniform rod, and for crossings and double eigenvalues along a path of
rods.

A crossing of the imaginary axis satisfies D(i eta; p) = 0, two real equations for (eta, p). A double real
eigenvalue, at which two real eigenvalues become a complex pair, satisfies D = D_w = 0 in (x, p). Near a
double eigenvalue the simple eigenvalues lose half of their digits, but the p of the double eigenvalue does
not.
"""

import math
from typing import NamedTuple

from ...model.compiled.compilation import compiled
from ...model.rod import Coefficients
from ..exponents import EXPONENT_SETTINGS, MACHINE_EPSILON
from ..parameter_path import coefficients_at, determinant_value_on_path
from ..value import scaled_determinant
from .settings import ROOT_NEWTON_SETTINGS


class LocatedEigenvalue(NamedTuple):
    """A crossing at w = i eta, or a double eigenvalue at w = x, on a path at p; all fields are nan after a
    failure. eta_or_x: eta or x. error_of_eta_or_x: error of eta_or_x. error_of_p: error of p."""

    eta_or_x: float
    p: float
    error_of_eta_or_x: float
    error_of_p: float


FAILED_EIGENVALUE = LocatedEigenvalue(math.nan, math.nan, math.nan, math.nan)
"""Returned when Newton's method fails: all fields are nan."""


@compiled
def crossing_by_newton(
    eta: float, p: float, origin: Coefficients, direction: Coefficients, scale: tuple[float, float]
) -> LocatedEigenvalue:
    """The zero of D(i eta; p) near the guess (eta, p), with errors from rounding and the last Newton step.

    origin, direction: coefficients at p = 0 and their derivative by p. scale: expected sizes of eta and p.
    Returns `FAILED_EIGENVALUE` if a step exceeds `ROOT_NEWTON_SETTINGS.max_step_over_expected_value`, if eta
    <= 0, if the Jacobian is singular, or if the method does not converge."""
    last = math.inf
    for _ in range(ROOT_NEWTON_SETTINGS.max_steps_to_crossing):
        coefficients = coefficients_at(p, origin, direction)
        D, D_w, D_p, _, rounding_error = determinant_value_on_path(complex(0.0, eta), coefficients, direction)
        # D is complex, the unknowns eta and p are real: d/d(eta) of D(i eta) is i D_w.
        a = 1j * D_w
        # The determinant of the real 2 x 2 system (Re, Im), written with complex products.
        cross = (a * D_p.conjugate()).imag
        if cross == 0:
            return FAILED_EIGENVALUE
        eta_step = -(D * D_p.conjugate()).imag / cross
        p_step = (D * a.conjugate()).imag / cross
        # The rounding errors of p and eta add to the rounding error of D.
        rounding = rounding_error + MACHINE_EPSILON * (abs(p * D_p) + abs(eta * D_w))
        e_eta = rounding * abs(D_p) / abs(cross)
        e_p = rounding * abs(a) / abs(cross)
        step = max(abs(eta_step) / scale[0], abs(p_step) / scale[1])
        # Negated comparisons are also true for NaN.
        if not step < ROOT_NEWTON_SETTINGS.max_step_over_expected_value or not eta + eta_step > 0:
            return FAILED_EIGENVALUE
        eta += eta_step
        p += p_step
        if (
            abs(eta_step) <= ROOT_NEWTON_SETTINGS.converged_step_in_rounding_errors * e_eta
            and abs(p_step) <= ROOT_NEWTON_SETTINGS.converged_step_in_rounding_errors * e_p
        ) or (
            # Small steps that stop halving are rounding errors above their estimate.
            step > ROOT_NEWTON_SETTINGS.min_stagnant_step_ratio * last
            and step * scale[1] < ROOT_NEWTON_SETTINGS.max_stagnant_step_over_p * abs(p)
        ):
            return LocatedEigenvalue(eta, p, max(e_eta, abs(eta_step)), max(e_p, abs(p_step)))
        last = step
    return FAILED_EIGENVALUE


@compiled
def double_eigenvalue_by_newton(
    x: float, p: float, origin: Coefficients, direction: Coefficients, expected_distance: float
) -> LocatedEigenvalue:
    """The double real eigenvalue, where D = D_w = 0, near the guess w = x at p.

    origin, direction: coefficients at p = 0 and their derivative by p. expected_distance: expected distance
    of p from the guess. Returns `FAILED_EIGENVALUE` if p moves by more than twice `expected_distance`, if
    the sign of x changes, if the Jacobian is singular, or without convergence.
    """
    start = x
    first = p
    last = math.inf
    for _ in range(2 * ROOT_NEWTON_SETTINGS.max_steps_to_crossing):
        D, D_w, D_p, S, rounding_error = _real_determinant(x, p, origin, direction)
        h = ROOT_NEWTON_SETTINGS.relative_jacobian_difference_step * abs(x)
        k = ROOT_NEWTON_SETTINGS.relative_jacobian_difference_step * expected_distance
        _, D_w_right, _, S_right, _ = _real_determinant(x + h, p, origin, direction)
        _, D_w_left, _, S_left, _ = _real_determinant(x - h, p, origin, direction)
        _, after, _, S_after, _ = _real_determinant(x, p + k, origin, direction)
        _, D_w_before, _, S_before, _ = _real_determinant(x, p - k, origin, direction)
        D_ww = (D_w_right * math.exp(S_right - S) - D_w_left * math.exp(S_left - S)) / (2 * h)
        D_wp = (after * math.exp(S_after - S) - D_w_before * math.exp(S_before - S)) / (2 * k)
        cross = D_w * D_wp - D_p * D_ww
        if cross == 0 or not math.isfinite(cross):
            return FAILED_EIGENVALUE
        x_step = (D_p * D_w - D_wp * D) / cross
        p_step = (D_ww * D - D_w * D_w) / cross
        rounding = rounding_error + MACHINE_EPSILON * abs(p * D_p)
        e_p = rounding * abs(D_ww) / abs(cross)
        e_x = (
            rounding * abs(D_wp) + rounding_error / max(abs(x), EXPONENT_SETTINGS.min_divisor) * abs(D_p)
        ) / abs(cross)
        x += x_step
        p += p_step
        # A double eigenvalue is never 0, since D(0) = 1: a change of sign means another root.
        if not abs(p - first) <= 2 * expected_distance or not x * start > 0:
            return FAILED_EIGENVALUE
        if abs(p_step) <= ROOT_NEWTON_SETTINGS.converged_step_in_rounding_errors * e_p and (
            abs(x_step) <= ROOT_NEWTON_SETTINGS.converged_step_in_rounding_errors * e_x
            or abs(x_step) > ROOT_NEWTON_SETTINGS.min_stagnant_step_ratio * last
        ):
            return LocatedEigenvalue(x, p, max(e_x, abs(x_step)), max(e_p, abs(p_step)))
        last = abs(x_step)
    return FAILED_EIGENVALUE


@compiled
def _real_determinant(
    x: float, p: float, origin: Coefficients, direction: Coefficients
) -> tuple[float, float, float, float, float]:
    """Returns (D, D_w, D_p, S, rounding error of D), all but S times exp(-S), at real w = x and p, where all
    five are real."""
    coefficients = coefficients_at(p, origin, direction)
    D, D_w, D_p, S, rounding_error = determinant_value_on_path(complex(x, 0.0), coefficients, direction)
    return D.real, D_w.real, D_p.real, S, rounding_error


@compiled
def refine_eigenvalue(w: complex, coefficients: Coefficients, max_first_step: float = math.inf) -> complex:
    """The eigenvalue of a uniform rod near w, by Newton's method until rounding error stops the convergence.
    A real guess w gives a real eigenvalue. max_first_step: if the first Newton step is at least this long, w
    is returned unchanged."""
    real = w.imag == 0
    # With the test below this demands a first step below max_first_step.
    last = 2 * max_first_step
    for _ in range(ROOT_NEWTON_SETTINGS.max_steps_to_eigenvalue):
        value = scaled_determinant(w, coefficients)
        if value.D_w == 0:
            break
        step = value.D / value.D_w
        if real:
            step = complex(step.real, 0.0)
        # Newton's method converges quadratically; a step that hardly decreases is rounding error.
        if not abs(step) < ROOT_NEWTON_SETTINGS.min_stagnant_step_ratio * last:
            break
        last = abs(step)
        w -= step
        # D is real on the real axis, where rounding leaves a tiny imaginary part.
        if abs(w.imag) <= ROOT_NEWTON_SETTINGS.real_axis_tolerance * abs(w):
            w = complex(w.real, 0.0)
    return w


@compiled
def eigenvalue_with_slope_and_error(
    w: complex, coefficients: Coefficients, direction: Coefficients
) -> tuple[complex, complex, float]:
    """Returns (w, dw/dp, error of w) of the simple eigenvalue w of a uniform rod near the guess w. direction:
    d(F, nu, c2, gamma3)/dp."""
    w = refine_eigenvalue(w, coefficients)
    value = determinant_value_on_path(w, coefficients, direction)
    return w, -value.D_p / value.D_w, max(abs(value.D), value.rounding_error) / abs(value.D_w)
