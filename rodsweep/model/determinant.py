"""The characteristic determinant D(w) of the transverse problem, in closed form.

With the state (y, theta, s, m = theta') the eigenproblem of Sec. VI reads

    y' = nu theta + c2 s,   theta' = m,   s' = w y + F m,   m' = gamma3 w theta - g s,

and D(w) is the determinant of the (s, m) x (s, m) block of its propagator over [0, 1]: entire in w,
real on the real axis, D(0) = 1, with the transverse eigenvalues as its zeros. The squares z of the
sum and the difference of the two roots q of the dispersion relation (Sec. VI) are

    z+- = (c2 + gamma3) w - F g +- 2 P,   P^2 = w (g nu + c2 gamma3 w),

and, worked out from the determinant, all of Appendix C collapses to

    D(w) = 1 + (w/2) [ z+' E(z+) + z-' E(z-) ],   E(z) = (cosh sqrt(z) - 1)/z,   ' = d/dw.

E is entire and the sum is even in P, so nothing is singular where roots q coincide, and every limit
(k1, k2 = inf, gamma3 = 0) is a regular value of the same formula. D is returned times exp(-S), with
S = max Re sqrt(z+-), because it spans hundreds of decades.
"""

import cmath
import math

from .compilation import compiled
from .rod import Coefficients

ROUND_OFF = 2.220446049250313e-16
TYPICAL_NOISE = 0.02
"""The usual rounding error of D in units of `noise`, the median against 40 digits; the worst is 0.5."""
SERIES_BELOW = 0.1
"""abs(z) below which E is summed as a series: the closed form of dE/dz would cancel there."""


@compiled
def entire_cosh(z: complex, root: complex, scale: float) -> tuple[complex, complex]:
    """E(z) = (cosh sqrt(z) - 1)/z and dE/dz, both times exp(-scale); root = sqrt(z)."""
    if abs(z) < SERIES_BELOW:
        value = 1 + z / 30 * (1 + z / 56 * (1 + z / 90 * (1 + z / 132 * (1 + z / 182))))
        slope = 1 + 3 * z / 112 * (1 + 4 * z / 270 * (1 + 5 * z / 528 * (1 + 6 * z / 910)))
        size = math.exp(-scale)
        return size * (0.5 + z / 24 * value), size * (1 + z / 15 * slope) / 24
    grow = cmath.exp((root - scale) / 2)
    decay = cmath.exp((-root - scale) / 2)
    value = (grow - decay) ** 2 / (2 * z)
    return value, ((grow**2 - decay**2) / (4 * root) - value) / z


@compiled
def branches(w: complex, coefficients: Coefficients) -> tuple[complex, complex, complex, complex, complex]:
    """(P, P', P'', z+, z-) at w != 0; the smaller z comes from the product, which does not cancel."""
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    gn = g * nu
    cg = c2 * gamma3
    P = cmath.sqrt(w * (gn + cg * w))
    P1 = 0j
    P2 = 0j
    if P != 0:  # it is zero for every w where g = gamma3 = 0: then z+ = z- has no branch point
        P1 = (gn + 2 * cg * w) / (2 * P)
        P2 = (cg - P1 * P1) / P
    total = (c2 + gamma3) * w - F * g
    plus = total + 2 * P
    minus = total - 2 * P
    product = ((c2 - gamma3) * w) ** 2 - 2 * g * w * ((c2 + gamma3) * F + 2 * nu) + (F * g) ** 2
    if abs(plus) >= abs(minus):
        if plus != 0:
            minus = product / plus
    else:
        plus = product / minus  # not zero, being the larger
    return P, P1, P2, plus, minus


@compiled
def exponentials(
    w: complex, coefficients: Coefficients
) -> tuple[float, float, complex, complex, complex, complex, complex, complex, complex, complex, complex]:
    """(S, noise, P, P', P'', z+, z-, E(z+), E'(z+), E(z-), E'(z-)) at w != 0, the E times exp(-S).

    `noise` adds up what rounding does to each term of D: an error of |sqrt z| units in the exponent,
    and an error of z itself in units of the terms that cancel in it, both through moduli that do not
    vanish where E does.
    """
    F, nu, c2, gamma3 = coefficients
    P, P1, P2, plus, minus = branches(w, coefficients)
    root_plus = cmath.sqrt(plus)
    root_minus = cmath.sqrt(minus)
    scale = max(root_plus.real, root_minus.real)
    E_plus, E1_plus = entire_cosh(plus, root_plus, scale)
    E_minus, E1_minus = entire_cosh(minus, root_minus, scale)
    g = abs(nu + F * c2)
    terms = (c2 + gamma3) * abs(w) + abs(F) * g + 2 * abs(P)
    product_terms = ((c2 - gamma3) * abs(w)) ** 2 + 2 * g * abs(w) * ((c2 + gamma3) * abs(F) + 2 * nu)
    terms += (product_terms + (F * g) ** 2) / max(abs(plus), abs(minus), 1e-300)
    noise = 0.0
    for root in (root_plus, root_minus):
        q = abs(root)
        modulus = math.exp(root.real - scale) / 2 * min(1.0, 4 / max(q * q, 1e-300))
        noise += modulus * (1 + q + terms / max(1.0, q))
    noise = ROUND_OFF * (math.exp(-scale) + abs(w) / 2 * (c2 + gamma3 + 2 * abs(P1)) * noise)
    return scale, noise, P, P1, P2, plus, minus, E_plus, E1_plus, E_minus, E1_minus


@compiled
def scaled_determinant(w: complex, coefficients: Coefficients) -> tuple[complex, complex, float, float]:
    """(D, dD/dw, S, noise): D and dD/dw times exp(-S); the rounding error of D is of order noise."""
    if w == 0:
        w = complex(1e-200, 0.0)
    scale, noise, _, P1, P2, _, _, E_plus, E1_plus, E_minus, E1_minus = exponentials(w, coefficients)
    drag = coefficients[2] + coefficients[3]
    slope_plus = drag + 2 * P1
    slope_minus = drag - 2 * P1
    first = slope_plus * E_plus + slope_minus * E_minus
    second = 2 * P2 * (E_plus - E_minus) + slope_plus**2 * E1_plus + slope_minus**2 * E1_minus
    return math.exp(-scale) + w / 2 * first, (first + w * second) / 2, scale, noise


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
    _, P1, _, plus, minus = branches(w, coefficients)
    root_plus, root_minus = math.sqrt(abs(plus)), math.sqrt(abs(minus))
    drag = coefficients[2] + coefficients[3]
    fast = max(abs(drag + 2 * P1) / max(1.0, root_plus), abs(drag - 2 * P1) / max(1.0, root_minus))
    return error, 2 / max(fast, 1e-300), (root_plus + root_minus) / 2
