"""The characteristic determinant D(w) of the transverse problem, in closed form.

With the state (y, theta, s, m = theta') the eigenproblem of Sec. VI reads

    y' = nu theta + c2 s,   theta' = m,   s' = w y + F m,   m' = gamma3 w theta - g s,

and D(w) is the determinant of the (s, m) x (s, m) block of the propagator over [0, 1]. D is entire in w and
real on the real axis, D(0) = 1, and the zeros of D are the transverse eigenvalues. The squares z+- of the
sum and the difference of the two roots q of the dispersion relation (Sec. VI) are

    z+- = M +- 2 P,   M = T w - F g,   P^2 = w (g nu + X w),   T = c2 + gamma3,   X = c2 gamma3,

and the determinant, Appendix C, simplifies to

    D(w) = 1 + (w/2) [ z+' E(z+) + z-' E(z-) ],   E(z) = (cosh sqrt(z) - 1)/z,   ' = d/dw.

E is entire and the sum is even in P, so the formula is regular where roots q coincide, and in every limit
(k1, k2 = inf, gamma3 = 0). `rodsweep.determinant.even_sum` evaluates the sum. D spans hundreds of decades,
so functions return D exp(-S) with S = max Re sqrt(z+-).
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.compiled.kernel_constants import KernelConstants
from ..model.rod import Coefficients
from .even_sum import EvenSum, even_sum
from .exponents import EXPONENT_SETTINGS, P_and_squared_exponents


@dataclass(frozen=True, slots=True, kw_only=True)
class DeterminantSettings(KernelConstants):
    """Settings for values of D and for differences of its derivatives."""

    typical_rounding_error_over_bound: float = 0.1
    """The rounding error of D is estimated by this fraction of its bound `rounding_error`. Measured fractions
    have the median 0.05, the upper quartile 0.1 and the maximum 0.7."""
    replacement_of_zero_w: float = 1e-200
    """D(0) is computed at this w, in 1/tau2, so that no formula divides by 0; |D - 1| is then a rounding
    error."""
    second_derivative_step_over_w: float = 1e-4
    """Step of the central difference of D' for D'', divided by |w|. The relative error of D'' is about the
    square of this number: enough to distinguish a double root from two close roots."""


DETERMINANT_SETTINGS = DeterminantSettings()


class DeterminantValue(NamedTuple):
    """D and D_w = dD/dw, both times exp(-S), S = `log_scale`. rounding_error: bound of the rounding error of
    D exp(-S)."""

    D: complex
    D_w: complex
    log_scale: float
    rounding_error: float


class ExponentDerivatives(NamedTuple):
    """P = (z+ - z-)/4, its derivatives P_w and P_ww by w, z+ (`z_plus`) and z- (`z_minus`)."""

    P: complex
    P_w: complex
    P_ww: complex
    z_plus: complex
    z_minus: complex


@compiled
def exponent_derivatives(w: complex, coefficients: Coefficients) -> ExponentDerivatives:
    """P with its first two derivatives by w, z+ and z- of a uniform rod at w != 0."""
    F, nu, c2, gamma3 = coefficients
    P, plus, minus = P_and_squared_exponents(w, coefficients)
    P1 = 0j
    P2 = 0j
    if P != 0:  # P is zero for every w if g = gamma3 = 0; then z+ = z- has no branch point
        P1 = ((nu + F * c2) * nu + 2 * c2 * gamma3 * w) / (2 * P)
        P2 = (c2 * gamma3 - P1 * P1) / P
    return ExponentDerivatives(P, P1, P2, plus, minus)


@compiled
def scaled_determinant(w: complex, coefficients: Coefficients) -> DeterminantValue:
    """D and dD/dw of a uniform rod at w, times exp(-S), S = `log_scale` of the result. w = 0 is replaced by
    `DETERMINANT_SETTINGS.replacement_of_zero_w`, where D equals D(0) = 1 within rounding."""
    if w == 0:
        w = complex(DETERMINANT_SETTINGS.replacement_of_zero_w, 0.0)
    return determinant_from_even_sum(w, coefficients, even_sum(w, coefficients))


@compiled
def determinant_from_even_sum(w: complex, coefficients: Coefficients, parts: EvenSum) -> DeterminantValue:
    """D and dD/dw at w, times exp(-S), S = `log_scale` of the result. parts: result of `even_sum` at w."""
    even, even_sum, rounding_error = parts
    F, nu, c2, gamma3 = coefficients
    T = c2 + gamma3
    X = c2 * gamma3
    # d(P^2)/dw.
    N = (nu + F * c2) * nu + 2 * X * w
    slope = (
        T * (T * even.ds_dM + 8 * N * even.dd_dM)
        + 8 * X * even.d
        + 16 * N * N * even.quarter_of_dd_dP_squared
    )
    return DeterminantValue(
        math.exp(-even.log_scale) + w / 2 * even_sum,
        (even_sum + w * slope) / 2,
        even.log_scale,
        rounding_error,
    )


@compiled
def scaled_second_derivative_between(
    value_after: DeterminantValue, value_before: DeterminantValue, S: float, h: float
) -> complex:
    """D'' exp(-S) by a central difference of D' between w + h (`value_after`) and w - h (`value_before`). S:
    logarithm of the scale of the result."""
    # Each value has its own scale exp(-S); the difference needs one common scale.
    return (
        value_after.D_w * math.exp(value_after.log_scale - S)
        - value_before.D_w * math.exp(value_before.log_scale - S)
    ) / (2 * h)


@compiled
def second_derivative(w: complex, S: float, coefficients: Coefficients) -> complex:
    """D'' exp(-S) of a uniform rod at w, by a central difference of D'; real for real w."""
    h = DETERMINANT_SETTINGS.second_derivative_step_over_w * abs(w)
    value_after = scaled_determinant(w + h, coefficients)
    value_before = scaled_determinant(w - h, coefficients)
    D_ww = scaled_second_derivative_between(value_after, value_before, S, h)
    return complex(D_ww.real, 0.0) if w.imag == 0 else D_ww


@compiled
def distance_to_next_root(w: complex, coefficients: Coefficients) -> float:
    """Estimated distance 2 |D'/D''| from an eigenvalue w of a uniform rod to the nearest other eigenvalue.
    The estimate is accurate if the two eigenvalues are close."""
    value = scaled_determinant(w, coefficients)
    return (
        2
        * abs(value.D_w)
        / max(abs(second_derivative(w, value.log_scale, coefficients)), EXPONENT_SETTINGS.min_divisor)
    )


@compiled
def root_error_w_scale_and_wave_number(w: complex, coefficients: Coefficients) -> tuple[float, float, float]:
    """Returns (error, length, wave number) of a uniform rod at w.

    error: |D/D'|, in 1/tau2, the distance from w to an eigenvalue to first order, however w was computed. If
    |D| is below its rounding error, the rounding error replaces |D|. length: change of w, in 1/tau2, over
    which an exponent of D changes by 1; `error` is valid only well below `length`. wave number: bound, in
    1/L, of |q| in the exponentials exp(+-q u) of an eigenfunction at w (Sec. VI).
    """
    value, slope, _, rounding_error = scaled_determinant(w, coefficients)
    # |D| far below its rounding error is accidental and does not mean a smaller error of w.
    error = max(abs(value), DETERMINANT_SETTINGS.typical_rounding_error_over_bound * rounding_error) / max(
        abs(slope), EXPONENT_SETTINGS.min_divisor
    )
    P, P1, _, plus, minus = exponent_derivatives(w, coefficients)
    root_plus = math.sqrt(abs(plus))
    root_minus = math.sqrt(abs(minus))
    drag = coefficients.c2 + coefficients.gamma3
    # D is even in P: for z+ close to z- the branch point of P does not affect D, and P' is limited.
    P1 *= min(1.0, abs(P) / max(1.0, root_plus, root_minus))
    max_rate = max(abs(drag + 2 * P1) / max(1.0, root_plus), abs(drag - 2 * P1) / max(1.0, root_minus))
    return error, 2 / max(max_rate, EXPONENT_SETTINGS.min_divisor), (root_plus + root_minus) / 2
