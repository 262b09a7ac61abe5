"""The exponents in D(w), and the entire functions of the exponents in D.

The notation is that of `rodsweep.determinant.value`. Series replace closed forms that would cancel.
"""

import cmath
import math
import sys
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ..model.compiled.compilation import compiled
from ..model.compiled.settings import CompiledSettings
from ..model.rod import Coefficients


@dataclass(frozen=True, slots=True, kw_only=True)
class ExponentSettings(CompiledSettings):
    """Settings for the entire functions of exponents."""

    least_divisor: float = 1e-300
    """Smallest modulus of a divisor: far below all numbers here that are not 0, and its inverse is finite."""
    largest_exponent: float = 600.0
    """Upper limit of exponents before exp, which would overflow at 709."""
    cosh_series_below: float = 0.1
    """abs(z) below which E is a series, because the closed form of dE/dz would cancel."""
    sinh_series_below: float = 0.25
    """abs(v) below which sinh(q)/q, v = q^2, is a series, because the closed form of its slope would
    cancel."""
    ranges: ClassVar = {"largest_exponent": (0.0, 709.0)}


EXPONENTS = ExponentSettings()

ROUND_OFF = sys.float_info.epsilon
"""Spacing of doubles at 1."""
NOISE_UNIT = 2 * ROUND_OFF
"""Unit of the noise of D and of its parts: two relative rounding errors."""


class Hyperbolic(NamedTuple):
    """cosh q, sinh(q)/q and (1/q) d(sinh(q)/q)/dq, all entire in q^2, times exp(-Re q)."""

    cosh: complex
    sinhc: complex
    slope: complex


@compiled
def modulus(z: complex) -> float:
    """|z|, faster than abs, for z whose square does not overflow and may underflow to 0."""
    return math.sqrt(z.real * z.real + z.imag * z.imag)


@compiled
def exponents(w: complex, coefficients: Coefficients) -> tuple[complex, complex, complex]:
    """(P, z+, z-) at w != 0; the smaller z follows from the product z+ z-, without cancellation."""
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    P = cmath.sqrt(w * (g * nu + c2 * gamma3 * w))
    # z+- = total +- 2 P. Their product is a polynomial in w, in which P has cancelled exactly.
    total = (c2 + gamma3) * w - F * g
    plus = total + 2 * P
    minus = total - 2 * P
    product = ((c2 - gamma3) * w) ** 2 - 2 * g * w * ((c2 + gamma3) * F + 2 * nu) + (F * g) ** 2
    if abs(plus) >= abs(minus):
        if plus != 0:
            minus = product / plus
    else:
        plus = product / minus  # minus is the larger, hence not zero
    return P, plus, minus


@compiled
def entire_cosh(z: complex, root: complex, scale: float) -> tuple[complex, complex]:
    """E(z) = (cosh sqrt(z) - 1)/z and dE/dz, both times exp(-scale); root = sqrt(z)."""
    if abs(z) < EXPONENTS.cosh_series_below:
        value = 1 + z / 30 * (1 + z / 56 * (1 + z / 90 * (1 + z / 132 * (1 + z / 182))))
        slope = 1 + 3 * z / 112 * (1 + 4 * z / 270 * (1 + 5 * z / 528 * (1 + 6 * z / 910)))
        size = math.exp(-scale)
        return size * (0.5 + z / 24 * value), size * (1 + z / 15 * slope) / 24
    # cosh q - 1 = 2 sinh^2(q/2): no cancellation for moderate q.
    grow = cmath.exp((root - scale) / 2)
    decay = cmath.exp((-root - scale) / 2)
    value = (grow - decay) ** 2 / (2 * z)
    return value, ((grow**2 - decay**2) / (4 * root) - value) / z


@compiled
def hyperbolic(v: complex, root: complex) -> Hyperbolic:
    """The hyperbolic functions of q = `root`; v = q^2."""
    if modulus(v) < EXPONENTS.sinh_series_below:
        first = 1 + v / 6 * (1 + v / 20 * (1 + v / 42 * (1 + v / 72 * (1 + v / 110 * (1 + v / 156)))))
        second = 1 + v / 28 * (1 + v / 54 * (1 + v / 88 * (1 + v / 130 * (1 + v / 180))))
        second = (1 + v / 10 * second) / 3
        size = math.exp(-root.real)
        return Hyperbolic(size * (first + v * second), size * first, size * second)
    # cosh and sinh times exp(-Re q), which cannot overflow.
    decay = math.exp(-2 * root.real)
    even = (1 + decay) / 2
    odd = (1 - decay) / 2
    cosine = math.cos(root.imag)
    sine = math.sin(root.imag)
    cosh = complex(even * cosine, odd * sine)
    first = complex(odd * cosine, even * sine) / root
    return Hyperbolic(cosh, first, (cosh - first) / v)
