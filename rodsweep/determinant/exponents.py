"""The exponents in D(w), and the entire functions of them that D is made of.

With the names of `rodsweep.determinant.value`; series replace closed forms where these would cancel.
"""

import cmath
import math
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients

E_SERIES_BELOW = 0.1
"""abs(z) below which E is summed as a series: the closed form of dE/dz would cancel there."""
FEW_TERMS_BELOW = 0.25
"""abs(v) below which sinh(q)/q, v = q^2, is summed as a series."""


class Hyperbolic(NamedTuple):
    """cosh q, sinh(q)/q and d(sinh(q)/q)/dq/q, all entire in q^2, times exp(-Re q)."""

    cosh: complex
    sinhc: complex
    slope: complex


@compiled
def modulus(z: complex) -> float:
    """|z|, faster than abs, where z^2 neither overflows nor matters when it underflows."""
    return math.sqrt(z.real * z.real + z.imag * z.imag)


@compiled
def exponents(w: complex, coefficients: Coefficients) -> tuple[complex, complex, complex]:
    """(P, z+, z-) at w != 0; the smaller z comes from the product, which does not cancel."""
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    P = cmath.sqrt(w * (g * nu + c2 * gamma3 * w))
    total = (c2 + gamma3) * w - F * g
    plus = total + 2 * P
    minus = total - 2 * P
    product = ((c2 - gamma3) * w) ** 2 - 2 * g * w * ((c2 + gamma3) * F + 2 * nu) + (F * g) ** 2
    if abs(plus) >= abs(minus):
        if plus != 0:
            minus = product / plus
    else:
        plus = product / minus  # not zero, being the larger
    return P, plus, minus


@compiled
def entire_cosh(z: complex, root: complex, scale: float) -> tuple[complex, complex]:
    """E(z) = (cosh sqrt(z) - 1)/z and dE/dz, both times exp(-scale); root = sqrt(z)."""
    if abs(z) < E_SERIES_BELOW:
        value = 1 + z / 30 * (1 + z / 56 * (1 + z / 90 * (1 + z / 132 * (1 + z / 182))))
        slope = 1 + 3 * z / 112 * (1 + 4 * z / 270 * (1 + 5 * z / 528 * (1 + 6 * z / 910)))
        size = math.exp(-scale)
        return size * (0.5 + z / 24 * value), size * (1 + z / 15 * slope) / 24
    grow = cmath.exp((root - scale) / 2)
    decay = cmath.exp((-root - scale) / 2)
    value = (grow - decay) ** 2 / (2 * z)
    return value, ((grow**2 - decay**2) / (4 * root) - value) / z


@compiled
def hyperbolic(v: complex, root: complex) -> Hyperbolic:
    """The functions of q = root, from v = q^2, too."""
    if modulus(v) < FEW_TERMS_BELOW:
        first = 1 + v / 6 * (1 + v / 20 * (1 + v / 42 * (1 + v / 72 * (1 + v / 110 * (1 + v / 156)))))
        second = 1 + v / 28 * (1 + v / 54 * (1 + v / 88 * (1 + v / 130 * (1 + v / 180))))
        second = (1 + v / 10 * second) / 3
        size = math.exp(-root.real)
        return Hyperbolic(size * (first + v * second), size * first, size * second)
    decay = math.exp(-2 * root.real)
    even, odd = (1 + decay) / 2, (1 - decay) / 2
    cosine, sine = math.cos(root.imag), math.sin(root.imag)
    cosh = complex(even * cosine, odd * sine)
    first = complex(odd * cosine, even * sine) / root
    return Hyperbolic(cosh, first, (cosh - first) / v)
