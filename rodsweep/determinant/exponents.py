"""The squares z+- of the exponents of D(w), and the entire functions of these squares that give D.

The notation is defined in `rodsweep.determinant.value`. Near 0, series replace closed forms, which would
cancel.
"""

import cmath
import math
import sys
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ..model.compiled.compilation import compiled
from ..model.compiled.kernel_constants import KernelConstants
from ..model.rod import Coefficients


@dataclass(frozen=True, slots=True, kw_only=True)
class ExponentSettings(KernelConstants):
    """Settings for the exponents of D and for entire functions of the exponents."""

    min_divisor: float = 1e-300
    """A divisor with a smaller modulus is replaced by this number, which is far below every nonzero number in
    the formulas of D and has a finite inverse."""
    max_exponent: float = 600.0
    """An exponent above this number is replaced by this number, since exp overflows at 709."""
    cosh_series_below: float = 0.1
    """E(z) = (cosh sqrt(z) - 1)/z and dE/dz are computed by series for |z| below this number: the closed form
    of dE/dz cancels."""
    sinh_series_below: float = 0.25
    """sinh(q)/q and (1/q) d(sinh(q)/q)/dq are computed by series for |q^2| below this number, because the
    closed form of the derivative would cancel."""
    min_modulus_from_square: float = 1e-145
    """A modulus |w| below this number is computed without |w|^2, which loses digits below 1e-308 and is 0 at
    the exponentially small eigenvalues of strongly pulled rods, |w| < 1e-162."""
    field_ranges: ClassVar = {"max_exponent": (0.0, 709.0)}
    """Exclusive bounds (lower, upper) of fields, by name; see `KernelConstants`."""


EXPONENT_SETTINGS = ExponentSettings()

MACHINE_EPSILON = sys.float_info.epsilon
"""Distance from 1 to the next larger double-precision number."""
TWO_MACHINE_EPSILONS = 2 * MACHINE_EPSILON
"""Unit of the rounding errors of the terms of D: twice the spacing of double-precision numbers at 1."""


class ScaledHyperbolicFunctions(NamedTuple):
    """cosh q, sinh(q)/q and (1/q) d(sinh(q)/q)/dq, three entire functions of q^2, all times exp(-Re q)."""

    cosh: complex
    sinhc: complex
    """sinh(q)/q times exp(-Re q)."""
    sinhc_slope_over_q: complex
    """(1/q) d(sinh(q)/q)/dq times exp(-Re q)."""


@compiled
def modulus(z: complex) -> float:
    """|z|, faster than abs(z). |z|^2 must not overflow; if |z|^2 underflows, the result is 0."""
    return math.sqrt(z.real * z.real + z.imag * z.imag)


@compiled
def modulus_without_underflow(w: complex) -> float:
    """|w|, also if |w|^2 underflows; |w|^2 must not overflow."""
    size = modulus(w)
    return abs(w) if size < EXPONENT_SETTINGS.min_modulus_from_square else size


@compiled
def P_and_squared_exponents(w: complex, coefficients: Coefficients) -> tuple[complex, complex, complex]:
    """Returns (P, z+, z-) of a uniform rod at w != 0, in the notation of `rodsweep.determinant.value`. The
    smaller of z+ and z- follows from the product z+ z-, without cancellation."""
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    P = cmath.sqrt(w * (g * nu + c2 * gamma3 * w))
    # z+- = total +- 2 P. The product z+ z- is a polynomial in w, without P.
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
def cosh_sqrt_minus_one_over_z(z: complex, root: complex, scale: float) -> tuple[complex, complex]:
    """Returns (E(z), dE/dz), both times exp(-scale), E(z) = (cosh sqrt(z) - 1)/z. root: sqrt(z)."""
    if abs(z) < EXPONENT_SETTINGS.cosh_series_below:
        value = 1 + z / 30 * (1 + z / 56 * (1 + z / 90 * (1 + z / 132 * (1 + z / 182))))
        slope = 1 + 3 * z / 112 * (1 + 4 * z / 270 * (1 + 5 * z / 528 * (1 + 6 * z / 910)))
        size = math.exp(-scale)
        return size * (0.5 + z / 24 * value), size * (1 + z / 15 * slope) / 24
    # cosh q - 1 = 2 sinh^2(q/2): no cancellation for moderate q.
    grow = cmath.exp((root - scale) / 2)
    small_factor = cmath.exp((-root - scale) / 2)
    value = (grow - small_factor) ** 2 / (2 * z)
    return value, ((grow**2 - small_factor**2) / (4 * root) - value) / z


@compiled
def scaled_hyperbolic_functions(v: complex, root: complex) -> ScaledHyperbolicFunctions:
    """cosh q, sinh(q)/q and (1/q) d(sinh(q)/q)/dq, times exp(-Re q), for q = `root`; v: q^2."""
    if modulus(v) < EXPONENT_SETTINGS.sinh_series_below:
        first = 1 + v / 6 * (1 + v / 20 * (1 + v / 42 * (1 + v / 72 * (1 + v / 110 * (1 + v / 156)))))
        series_sum = 1 + v / 28 * (1 + v / 54 * (1 + v / 88 * (1 + v / 130 * (1 + v / 180))))
        series_sum = (1 + v / 10 * series_sum) / 3
        size = math.exp(-root.real)
        return ScaledHyperbolicFunctions(size * (first + v * series_sum), size * first, size * series_sum)
    # cosh and sinh times exp(-Re q), which cannot overflow.
    squared_decay = math.exp(-2 * root.real)
    even = (1 + squared_decay) / 2
    half_difference = (1 - squared_decay) / 2
    cosine = math.cos(root.imag)
    sine = math.sin(root.imag)
    cosh = complex(even * cosine, half_difference * sine)
    first = complex(half_difference * cosine, even * sine) / root
    return ScaledHyperbolicFunctions(cosh, first, (cosh - first) / v)
