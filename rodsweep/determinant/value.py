"""The characteristic determinant D(w) of the transverse problem, in closed form.

With the state (y, theta, s, m = theta') the eigenproblem of Sec. VI reads

    y' = nu theta + c2 s,   theta' = m,   s' = w y + F m,   m' = gamma3 w theta - g s,

and D(w) is the determinant of the (s, m) x (s, m) block of its propagator over [0, 1]: entire in w,
real on the real axis, D(0) = 1, with the transverse eigenvalues as its zeros. The squares z of the
sum and the difference of the two roots q of the dispersion relation (Sec. VI) are

    z+- = M +- 2 P,   M = T w - F g,   P^2 = w (g nu + X w),   T = c2 + gamma3,   X = c2 gamma3,

and, worked out from the determinant, all of Appendix C collapses to

    D(w) = 1 + (w/2) [ z+' E(z+) + z-' E(z-) ],   E(z) = (cosh sqrt(z) - 1)/z,   ' = d/dw.

E is entire and the sum is even in P, so nothing is singular where roots q coincide, and every limit
(k1, k2 = inf, gamma3 = 0) is a regular value of the same formula; `rodsweep.determinant.even_parts` evaluates
it. D is returned times exp(-S), with S = max Re sqrt(z+-), because it spans hundreds of decades.
"""

import math
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients
from .even_parts import EvenSum, even_parts
from .exponents import exponents

ROUND_OFF = 2.220446049250313e-16
TYPICAL_NOISE = 0.1
"""Rounding error of D in units of `noise`: three of four are below, the median is 0.05, the worst 0.7."""
SECOND_STEP = 1e-4
"""Step of the difference that gives D'', in units of w."""


class Value(NamedTuple):
    """D and D' = dD/dw times exp(-S), and the order of the rounding error of the former."""

    D: complex
    D_w: complex
    S: float
    noise: float


class Branches(NamedTuple):
    """P, P' and P'' with respect to w, and the squares z+- of the sum and the difference of the roots q."""

    P: complex
    P_w: complex
    P_ww: complex
    plus: complex
    minus: complex


@compiled
def branches(w: complex, coefficients: Coefficients) -> Branches:
    """P and what follows from it at w != 0."""
    F, nu, c2, gamma3 = coefficients
    P, plus, minus = exponents(w, coefficients)
    P1 = 0j
    P2 = 0j
    if P != 0:  # it is zero for every w where g = gamma3 = 0: then z+ = z- has no branch point
        P1 = ((nu + F * c2) * nu + 2 * c2 * gamma3 * w) / (2 * P)
        P2 = (c2 * gamma3 - P1 * P1) / P
    return Branches(P, P1, P2, plus, minus)


@compiled
def scaled_determinant(w: complex, coefficients: Coefficients) -> Value:
    """D at w and its derivative."""
    if w == 0:
        w = complex(1e-200, 0.0)
    return from_parts(w, coefficients, even_parts(w, coefficients))


@compiled
def from_parts(w: complex, coefficients: Coefficients, parts: EvenSum) -> Value:
    """D and its derivative from the even parts at w."""
    even, total, noise = parts
    F, nu, c2, gamma3 = coefficients
    T, X = c2 + gamma3, c2 * gamma3
    N = (nu + F * c2) * nu + 2 * X * w
    slope = T * (T * even.s_M + 8 * N * even.d_M) + 8 * X * even.d + 16 * N * N * even.d_P
    return Value(math.exp(-even.S) + w / 2 * total, (total + w * slope) / 2, even.S, noise)


@compiled
def second_derivative(w: complex, S: float, coefficients: Coefficients) -> complex:
    """D'' exp(-S) at w by a difference of D'; real where w is."""
    h = SECOND_STEP * abs(w)
    after = scaled_determinant(w + h, coefficients)
    before = scaled_determinant(w - h, coefficients)
    second = (after.D_w * math.exp(after.S - S) - before.D_w * math.exp(before.S - S)) / (2 * h)
    return complex(second.real, 0.0) if w.imag == 0 else second


@compiled
def distance_to_next(w: complex, coefficients: Coefficients) -> float:
    """About how far the eigenvalue next to the eigenvalue w is, 2 |D'/D''|: sharp where that is close."""
    here = scaled_determinant(w, coefficients)
    return 2 * abs(here.D_w) / max(abs(second_derivative(w, here.S, coefficients)), 1e-300)


@compiled
def newton_correction(w: complex, coefficients: Coefficients) -> tuple[float, float, float]:
    """(|D/D'|, length, wave number) at w: how far, to first order, an eigenvalue of the rod lies.

    The correction, in 1/tau2, does not know how w was computed, which makes it an independent error
    estimate. Where D is smaller than its rounding error, that error takes its place. It means something
    only well below `length`, over which an exponent of D changes by one. The wave number, in 1/L,
    bounds |q| of the exponents exp(+-q u) of an eigenfunction at w (Sec. VI).
    """
    value, slope, _, noise = scaled_determinant(w, coefficients)
    error = max(abs(value), TYPICAL_NOISE * noise) / max(abs(slope), 1e-300)
    P, P1, _, plus, minus = branches(w, coefficients)
    root_plus, root_minus = math.sqrt(abs(plus)), math.sqrt(abs(minus))
    drag = coefficients.c2 + coefficients.gamma3
    # Where z+ and z- are close, D depends on P^2, which has no branch point, and not on P.
    P1 *= min(1.0, abs(P) / max(1.0, root_plus, root_minus))
    fast = max(abs(drag + 2 * P1) / max(1.0, root_plus), abs(drag - 2 * P1) / max(1.0, root_minus))
    return error, 2 / max(fast, 1e-300), (root_plus + root_minus) / 2
