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
(k1, k2 = inf, gamma3 = 0). `rodsweep.determinant.even_parts` evaluates the sum. Functions return D exp(-S),
with S = max Re sqrt(z+-), because D spans hundreds of decades.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.compiled.settings import CompiledSettings
from ..model.rod import Coefficients
from .even_parts import EvenSum, even_parts
from .exponents import EXPONENTS, squared_exponents


@dataclass(frozen=True, slots=True, kw_only=True)
class DeterminantSettings(CompiledSettings):
    """Settings for values of D and for differences of its derivatives."""

    typical_noise: float = 0.1
    """Rounding error of D in units of its bound `noise`: the upper quartile of measured errors, whose median
    is 0.05 and maximum 0.7."""
    zero_replacement: float = 1e-200
    """Value of w, in 1/tau2, at which D(0) is computed, so that no formula divides by 0. D - 1 is below
    rounding error there."""
    second_difference_step: float = 1e-4
    """Step of the difference of D' for D'', in units of |w|. The relative error of D'' is about its square,
    enough to distinguish a double root from two roots."""


DETERMINANT = DeterminantSettings()


class DeterminantValue(NamedTuple):
    """D and D' = dD/dw times exp(-S), and the magnitude `noise` of the rounding error of D exp(-S)."""

    D: complex
    D_w: complex
    S: float
    noise: float


class ExponentDerivatives(NamedTuple):
    """P, its derivatives P' and P'' by w, and z+ and z-, of the module `rodsweep.determinant.value`."""

    P: complex
    P_w: complex
    P_ww: complex
    plus: complex
    minus: complex


@compiled
def exponent_derivatives(w: complex, coefficients: Coefficients) -> ExponentDerivatives:
    """P, P', P'', z+ and z- of a uniform rod at w != 0."""
    F, nu, c2, gamma3 = coefficients
    P, plus, minus = squared_exponents(w, coefficients)
    P1 = 0j
    P2 = 0j
    if P != 0:  # P is zero for every w if g = gamma3 = 0; then z+ = z- has no branch point
        P1 = ((nu + F * c2) * nu + 2 * c2 * gamma3 * w) / (2 * P)
        P2 = (c2 * gamma3 - P1 * P1) / P
    return ExponentDerivatives(P, P1, P2, plus, minus)


@compiled
def scaled_determinant(w: complex, coefficients: Coefficients) -> DeterminantValue:
    """D and D' of a uniform rod at w, times exp(-S).

    w = 0 is replaced by `DETERMINANT.zero_replacement`, where D is 1 too.
    """
    if w == 0:
        w = complex(DETERMINANT.zero_replacement, 0.0)
    return determinant_from_parts(w, coefficients, even_parts(w, coefficients))


@compiled
def determinant_from_parts(w: complex, coefficients: Coefficients, parts: EvenSum) -> DeterminantValue:
    """D and D' times exp(-S) at w, from the functions s and d and their derivatives, as `even_parts` returns
    them.
    """
    even, total, noise = parts
    F, nu, c2, gamma3 = coefficients
    T = c2 + gamma3
    X = c2 * gamma3
    # d(P^2)/dw.
    N = (nu + F * c2) * nu + 2 * X * w
    slope = T * (T * even.s_M + 8 * N * even.d_M) + 8 * X * even.d + 16 * N * N * even.d_P
    return DeterminantValue(math.exp(-even.S) + w / 2 * total, (total + w * slope) / 2, even.S, noise)


@compiled
def second_difference(after: DeterminantValue, before: DeterminantValue, S: float, h: float) -> complex:
    """D'' exp(-S) by a central difference, from D' at w + h (`after`) and at w - h (`before`)."""
    # Each value has its own scale exp(-S); the difference needs one common scale.
    return (after.D_w * math.exp(after.S - S) - before.D_w * math.exp(before.S - S)) / (2 * h)


@compiled
def second_derivative(w: complex, S: float, coefficients: Coefficients) -> complex:
    """D'' exp(-S) of a uniform rod at w, by a central difference of D'; real for real w."""
    h = DETERMINANT.second_difference_step * abs(w)
    after = scaled_determinant(w + h, coefficients)
    before = scaled_determinant(w - h, coefficients)
    second = second_difference(after, before, S, h)
    return complex(second.real, 0.0) if w.imag == 0 else second


@compiled
def distance_to_next_root(w: complex, coefficients: Coefficients) -> float:
    """Estimated distance 2 |D'/D''| from an eigenvalue w to the nearest other one; accurate if both are
    close.
    """
    here = scaled_determinant(w, coefficients)
    return 2 * abs(here.D_w) / max(abs(second_derivative(w, here.S, coefficients)), EXPONENTS.least_divisor)


@compiled
def newton_correction(w: complex, coefficients: Coefficients) -> tuple[float, float, float]:
    """(|D/D'|, length, wave number) of a uniform rod at w.

    |D/D'|, in 1/tau2, is the distance to an eigenvalue to first order: an error estimate that does not depend
    on how w was computed. A |D| below its rounding error is replaced by this error. The estimate is valid
    only well below `length`, the change of w over which an exponent of D changes by one. The wave number, in
    1/L, bounds |q| of the exponents exp(+-q u) of an eigenfunction at w (Sec. VI).
    """
    value, slope, _, noise = scaled_determinant(w, coefficients)
    # A value that happens to be far below its rounding error proves no better root.
    error = max(abs(value), DETERMINANT.typical_noise * noise) / max(abs(slope), EXPONENTS.least_divisor)
    P, P1, _, plus, minus = exponent_derivatives(w, coefficients)
    root_plus = math.sqrt(abs(plus))
    root_minus = math.sqrt(abs(minus))
    drag = coefficients.c2 + coefficients.gamma3
    # D is even in P: for z+ close to z- the branch point of P does not affect D, and P' is limited.
    P1 *= min(1.0, abs(P) / max(1.0, root_plus, root_minus))
    fast = max(abs(drag + 2 * P1) / max(1.0, root_plus), abs(drag - 2 * P1) / max(1.0, root_minus))
    return error, 2 / max(fast, EXPONENTS.least_divisor), (root_plus + root_minus) / 2
