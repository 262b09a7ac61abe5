"""D(w) of an arm from the propagators of its elements: five minors, multiplied from clamp to tip.

The minors are those of `rodsweep.determinant.arm.elements.collocation`: s^m = 1 and no other at the clamp,
D = s^m at the tip. D spans hundreds of decades, so the minors are scaled on their way; the logarithms of the
factors are summed. Derivatives by w and along a path of arms are carried along.

The propagators at one w are sums over powers of w, which all elements share. Real and imaginary parts are
rows of their own, so that a sum is a vector instruction over the entries of a propagator.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled, compiled_for_vectors
from ...model.compiled.settings import CompiledSettings
from ..exponents import NOISE_UNIT
from ..parameter_path import ValueAlong
from ..value import DeterminantValue
from .elements.minor_rates import ENTRIES, SM
from .elements.settings import MINORS


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmValueSettings(CompiledSettings):
    """Settings for D from propagators, and for the rounding errors of its roots."""

    root_noise: float = 1.5
    """Rounding error of D at a root, in units of its `noise`, besides `root_residual`. `noise` does not
    contain the rounding errors of the propagators."""
    root_residual: float = 2.0
    """Rounding error of D at a root, in units of the residual |D| that Newton's method leaves, which is
    rounding error too. Of 3800 eigenvalues and 520 crossings of random arms, compared with 34 digits, two
    then have more than the stated error, and none twice as much."""
    large: float = 1e100
    """Norm of the minors above which they are divided by their norm; below its inverse too."""


ARM_VALUE = ArmValueSettings()

RE, IM, RE_SLOPE, IM_SLOPE = range(4)
"""Row indices of powers and propagators: real and imaginary part of the value and of its derivative."""


@compiled
def _powers(z: complex, terms: int) -> Array:
    """The powers z^n and their derivatives n z^(n-1) in rows RE, IM, RE_SLOPE and IM_SLOPE: (terms, 4)."""
    powers = np.zeros((terms, 4))
    powers[0, RE] = 1.0
    for n in range(1, terms):
        # A product of two halves has a few rounding errors, n - 1 factors z would have n - 1.
        half = complex(powers[n // 2, RE], powers[n // 2, IM])
        here = z if n == 1 else complex(powers[n - n // 2, RE], powers[n - n // 2, IM]) * half
        powers[n, RE] = here.real
        powers[n, IM] = here.imag
        powers[n, RE_SLOPE] = n * powers[n - 1, RE]
        powers[n, IM_SLOPE] = n * powers[n - 1, IM]
    return powers


@compiled_for_vectors
def _propagator(polynomial: Array, powers: Array, out: Array) -> None:
    """Writes a propagator C and dC/dz at one z into out, (4, ENTRIES), from its coefficients in powers of z,
    (terms, ENTRIES).

    powers: result of `_powers` for z, (terms, 4).
    """
    for k in range(ENTRIES):
        out[RE, k] = polynomial[0, k]
        out[IM, k] = out[RE_SLOPE, k] = out[IM_SLOPE, k] = 0.0
    terms = polynomial.shape[0]
    for n in range(1, terms - 1, 2):  # two terms at a time save passes over `out`
        a, b, c, d = powers[n, RE], powers[n, IM], powers[n, RE_SLOPE], powers[n, IM_SLOPE]
        p, q, r, s = powers[n + 1, RE], powers[n + 1, IM], powers[n + 1, RE_SLOPE], powers[n + 1, IM_SLOPE]
        for k in range(ENTRIES):
            x = polynomial[n, k]
            y = polynomial[n + 1, k]
            out[RE, k] += a * x + p * y
            out[IM, k] += b * x + q * y
            out[RE_SLOPE, k] += c * x + r * y
            out[IM_SLOPE, k] += d * x + s * y
    if terms % 2 == 0:
        for row in range(4):
            for k in range(ENTRIES):
                out[row, k] += powers[terms - 1, row] * polynomial[terms - 1, k]


@compiled_for_vectors
def _propagator_alone(polynomial: Array, powers: Array, out: Array) -> None:
    """Writes a propagator C at one z into out, (2, ENTRIES), from its coefficients in powers of z, (terms,
    ENTRIES).

    powers: result of `_powers` for z, (terms, 4).
    """
    for k in range(ENTRIES):
        out[RE, k] = polynomial[0, k]
        out[IM, k] = 0.0
    terms = polynomial.shape[0]
    first = 1
    for n in range(1, terms - 3, 4):  # four terms at a time save passes over `out`
        a, b, c, d = powers[n, RE], powers[n + 1, RE], powers[n + 2, RE], powers[n + 3, RE]
        p, q, r, s = powers[n, IM], powers[n + 1, IM], powers[n + 2, IM], powers[n + 3, IM]
        for k in range(ENTRIES):
            x = polynomial[n, k]
            y = polynomial[n + 1, k]
            z = polynomial[n + 2, k]
            last = polynomial[n + 3, k]
            out[RE, k] += a * x + b * y + c * z + d * last
            out[IM, k] += p * x + q * y + r * z + s * last
        first = n + 4
    for n in range(first, terms):
        for row in range(2):
            for k in range(ENTRIES):
                out[row, k] += powers[n, row] * polynomial[n, k]


@compiled_for_vectors
def _product(C: Array, x: Array, out: Array) -> None:
    """out = C x; C: (2 or more, ENTRIES), x and out: (2, MINORS)."""
    for i in range(MINORS):
        real = 0.0
        imag = 0.0
        for j in range(MINORS):
            real += C[RE, MINORS * j + i] * x[RE, j] - C[IM, MINORS * j + i] * x[IM, j]
            imag += C[RE, MINORS * j + i] * x[IM, j] + C[IM, MINORS * j + i] * x[RE, j]
        out[RE, i] = real
        out[IM, i] = imag


@compiled_for_vectors
def _product_of_both(C: Array, t: Array, change: Array, x: Array, out: Array) -> None:
    """out = C t + change x, of propagators, (2, ENTRIES), and minors, (2, MINORS)."""
    for i in range(MINORS):
        real = 0.0
        imag = 0.0
        for j in range(MINORS):
            real += C[RE, MINORS * j + i] * t[RE, j] - C[IM, MINORS * j + i] * t[IM, j]
            imag += C[RE, MINORS * j + i] * t[IM, j] + C[IM, MINORS * j + i] * t[RE, j]
            real += change[RE, MINORS * j + i] * x[RE, j] - change[IM, MINORS * j + i] * x[IM, j]
            imag += change[RE, MINORS * j + i] * x[IM, j] + change[IM, MINORS * j + i] * x[RE, j]
        out[RE, i] = real
        out[IM, i] = imag


@compiled_for_vectors
def _size(x: Array) -> float:
    """Euclidean norm of the minors x, (2, MINORS)."""
    total = 0.0
    for i in range(MINORS):
        total += x[0, i] * x[0, i] + x[1, i] * x[1, i]
    return math.sqrt(total)


@compiled
def _size_of_parts(C: Array, x: Array) -> float:
    """Sum of the moduli of all terms of C x that add up to the minor s^m at the end of an element.

    C: propagator, (2 or more, ENTRIES). x: minors, (2, MINORS). Near a root of D the terms cancel, and the
    rounding error of D is relative to their moduli, not to s^m.
    """
    total = 0.0
    for j in range(MINORS):
        entry = complex(C[RE, MINORS * j + SM], C[IM, MINORS * j + SM])
        total += abs(entry * complex(x[RE, j], x[IM, j]))
    return total


@compiled
def _swept(
    z: complex, W: float, polynomials: Array, changes: Array
) -> tuple[complex, complex, complex, float]:
    """(D, dD/dw, dD/dp, S) of `chain_along` at w = z W; dD/dp is 0 if `changes` is empty.

    polynomials, changes: propagators and their derivatives by p, (elements, terms, ENTRIES).
    """
    elements, terms, _ = polynomials.shape
    along = len(changes) > 0
    powers = _powers(z, terms)
    C = np.empty((4, ENTRIES))
    change = np.empty((2, ENTRIES))
    # minors and their derivatives by w and p, here and at the end of the element
    here = np.zeros((3, 2, MINORS))
    ahead = np.zeros((3, 2, MINORS))
    here[0, 0, SM] = 1.0
    S = 0.0
    for e in range(elements):
        _propagator(polynomials[e], powers, C)
        _product(C, here[0], ahead[0])
        _product_of_both(C, here[1], C[2:], here[0], ahead[1])
        if along:
            _propagator_alone(changes[e], powers, change)
            _product_of_both(C, here[2], change, here[0], ahead[2])
        size = _size(ahead[0])
        if e == elements - 1:
            size = max(size, _size_of_parts(C, here[0]))
        if not 1 / ARM_VALUE.large < size < ARM_VALUE.large or e == elements - 1:
            ahead /= size
            S += math.log(size)
        here, ahead = ahead, here
    D = complex(here[0, 0, SM], here[0, 1, SM])
    D_w = complex(here[1, 0, SM], here[1, 1, SM]) / W
    return D, D_w, complex(here[2, 0, SM], here[2, 1, SM]), S


@compiled
def chain_size(w: complex, W: float, polynomials: Array) -> float:
    """log |D| at w, from propagators that hold for |w| <= W, (elements, terms, ENTRIES); -inf where D is
    0."""
    powers = _powers(w / W, polynomials.shape[1])
    C = np.empty((2, ENTRIES))
    here = np.zeros((2, MINORS))
    ahead = np.empty((2, MINORS))
    here[0, SM] = 1.0
    S = 0.0
    for e in range(len(polynomials)):
        _propagator_alone(polynomials[e], powers, C)
        _product(C, here, ahead)
        size = _size(ahead)
        if not 1 / ARM_VALUE.large < size < ARM_VALUE.large:
            ahead /= size
            S += math.log(size)
        here, ahead = ahead, here
    size = math.hypot(here[0, SM], here[1, SM])
    return S + math.log(size) if size > 0 else -math.inf


@compiled
def chain_value(w: complex, W: float, polynomials: Array) -> DeterminantValue:
    """D and D' = dD/dw times exp(-S), from propagators that hold for |w| <= W, (elements, terms, ENTRIES)."""
    D, D_w, _, S = _swept(w / W, W, polynomials, polynomials[:0])
    return DeterminantValue(D, D_w, S, (len(polynomials) + 2) * NOISE_UNIT)


@compiled
def chain_along(w: complex, W: float, polynomials: Array, changes: Array) -> ValueAlong:
    """D, dD/dw and dD/dp times exp(-S), from propagators, `polynomials`, and their derivatives by p,
    `changes`.

    Both have the shape (elements, terms, ENTRIES) and hold for |w| <= W.
    """
    D, D_w, D_p, S = _swept(w / W, W, polynomials, changes)
    return ValueAlong(D, D_w, D_p, S, (len(polynomials) + 2) * NOISE_UNIT)
