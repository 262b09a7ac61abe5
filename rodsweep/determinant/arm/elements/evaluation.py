"""Propagators of elements at one z = w/W, from polynomials in z, and their products with minors.

The minors are the 2 x 2 determinants of rows of two solutions of the eigenproblem (compound matrix method,
see `minor_rates`); a propagator is the matrix that multiplies them from one end of an element to the other. A
propagator has the MINOR_COUNT^2 entries of its columns one after the other, and then zeros up to
PROPAGATOR_LENGTH: loops over PROPAGATOR_LENGTH entries are whole vector instructions. Real and imaginary
parts are separate rows, so that a sum over powers of z is a vector instruction over the entries. Arrays at
real z have no imaginary parts.

powers: result of `powers_and_derivatives`, (terms, 4). polynomial: coefficients of an element, (at least as
many terms, PROPAGATOR_LENGTH). Minors: (2, MINOR_COUNT), real and imaginary parts.
"""

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_with_reordered_sums
from .minor_rates import PROPAGATOR_LENGTH
from .settings import ARM_ELEMENT_SETTINGS, MINOR_COUNT

RE, IM, RE_SLOPE, IM_SLOPE = range(4)
"""Indices, in arrays of powers and of propagators, of the real and imaginary parts of the value and of its
derivative with respect to z."""


@compiled
def _non_negligible_power_count(size: float, terms: int) -> int:
    """Number of powers of z that are not negligible in C and dC/dz at |z| = `size`; at most `terms`, the
    number of powers in the polynomials."""
    count = terms
    while count > 2 and size <= ARM_ELEMENT_SETTINGS.largest_z_by_term_count[count - 1]:
        count -= 1
    return count


@compiled
def powers_and_derivatives(z: complex, terms: int) -> Array:
    """The powers z^n that are not negligible, and their derivatives n z^(n-1): real and imaginary parts of
    both, (powers, 4), in the order RE, IM, RE_SLOPE, IM_SLOPE. terms: number of powers in the polynomials."""
    powers = np.zeros((_non_negligible_power_count(abs(z), terms), 4))
    powers[0, RE] = 1.0
    for n in range(1, len(powers)):
        # Multiplying two halves accumulates fewer rounding errors than n - 1 multiplications by z.
        half = complex(powers[n // 2, RE], powers[n // 2, IM])
        half_power = z if n == 1 else complex(powers[n - n // 2, RE], powers[n - n // 2, IM]) * half
        powers[n, RE] = half_power.real
        powers[n, IM] = half_power.imag
        powers[n, RE_SLOPE] = n * powers[n - 1, RE]
        powers[n, IM_SLOPE] = n * powers[n - 1, IM]
    return powers


@compiled_with_reordered_sums
def fill_propagator_and_derivative(polynomial: Array, powers: Array, out: Array) -> None:
    """Writes a propagator C and dC/dz into out, (4, PROPAGATOR_LENGTH). polynomial, powers: coefficients of
    the element and powers of z, see the module docstring."""
    for k in range(PROPAGATOR_LENGTH):
        out[RE, k] = polynomial[0, k]
        out[IM, k] = out[RE_SLOPE, k] = out[IM_SLOPE, k] = 0.0
    terms = len(powers)
    for n in range(1, terms - 1, 2):  # two terms at a time save passes over `out`
        a, b, c, d = powers[n, RE], powers[n, IM], powers[n, RE_SLOPE], powers[n, IM_SLOPE]
        p, q, r, s = powers[n + 1, RE], powers[n + 1, IM], powers[n + 1, RE_SLOPE], powers[n + 1, IM_SLOPE]
        for k in range(PROPAGATOR_LENGTH):
            x = polynomial[n, k]
            y = polynomial[n + 1, k]
            out[RE, k] += a * x + p * y
            out[IM, k] += b * x + q * y
            out[RE_SLOPE, k] += c * x + r * y
            out[IM_SLOPE, k] += d * x + s * y
    if terms % 2 == 0:
        for row in range(4):
            for k in range(PROPAGATOR_LENGTH):
                out[row, k] += powers[terms - 1, row] * polynomial[terms - 1, k]


@compiled_with_reordered_sums
def fill_propagator_value(polynomial: Array, powers: Array, out: Array) -> None:
    """Writes a propagator C, without dC/dz, into out, (2, PROPAGATOR_LENGTH). polynomial, powers:
    coefficients of the element and powers of z, see the module docstring."""
    _fill_power_sums(polynomial, powers, (RE, IM), out)


@compiled_with_reordered_sums
def fill_real_propagator_and_derivative(polynomial: Array, powers: Array, out: Array) -> None:
    """Writes a propagator C and dC/dz at real z into out, (2, PROPAGATOR_LENGTH). polynomial, powers:
    coefficients of the element and powers of z, see the module docstring."""
    _fill_power_sums(polynomial, powers, (RE, RE_SLOPE), out)


@compiled_with_reordered_sums
def _fill_power_sums(polynomial: Array, powers: Array, rows: tuple[int, int], out: Array) -> None:
    """Writes sum_n powers[n, i] polynomial[n] into out[k], where i = rows[k] is one of RE, IM, RE_SLOPE,
    IM_SLOPE. powers: (terms, 4). polynomial: (at least as many terms, PROPAGATOR_LENGTH). out: (2,
    PROPAGATOR_LENGTH)."""
    i, j = rows
    for k in range(PROPAGATOR_LENGTH):
        out[0, k] = powers[0, i] * polynomial[0, k]
        out[1, k] = powers[0, j] * polynomial[0, k]
    terms = len(powers)
    count = 1
    for n in range(1, terms - 3, 4):  # four terms at a time save passes over `out`
        a, b, c, d = (powers[n, i], powers[n + 1, i], powers[n + 2, i], powers[n + 3, i])
        p, q, r, s = (powers[n, j], powers[n + 1, j], powers[n + 2, j], powers[n + 3, j])
        for k in range(PROPAGATOR_LENGTH):
            x = polynomial[n, k]
            y = polynomial[n + 1, k]
            z = polynomial[n + 2, k]
            last = polynomial[n + 3, k]
            out[0, k] += a * x + b * y + c * z + d * last
            out[1, k] += p * x + q * y + r * z + s * last
        count = n + 4
    for n in range(count, terms):
        a = powers[n, i]
        p = powers[n, j]
        for k in range(PROPAGATOR_LENGTH):
            out[0, k] += a * polynomial[n, k]
            out[1, k] += p * polynomial[n, k]


@compiled_with_reordered_sums
def fill_real_propagator_value(polynomial: Array, powers: Array, out: Array) -> None:
    """Writes a propagator C at real z, without dC/dz, into out, (PROPAGATOR_LENGTH,). polynomial, powers:
    coefficients of the element and powers of z, see the module docstring."""
    for k in range(PROPAGATOR_LENGTH):
        out[k] = polynomial[0, k]
    terms = len(powers)
    count = 1
    for n in range(1, terms - 3, 4):  # as in `_fill_power_sums`
        a, b, c, d = (powers[n, RE], powers[n + 1, RE], powers[n + 2, RE], powers[n + 3, RE])
        for k in range(PROPAGATOR_LENGTH):
            out[k] += (
                a * polynomial[n, k]
                + b * polynomial[n + 1, k]
                + c * polynomial[n + 2, k]
                + d * polynomial[n + 3, k]
            )
        count = n + 4
    for n in range(count, terms):
        for k in range(PROPAGATOR_LENGTH):
            out[k] += powers[n, RE] * polynomial[n, k]


@compiled_with_reordered_sums
def apply_propagator(C: Array, x: Array, out: Array) -> None:
    """out = C x for a propagator C, (2 or more, PROPAGATOR_LENGTH). x, out: minors at the start and at the
    end of the element, (2, MINOR_COUNT)."""
    for i in range(MINOR_COUNT):
        out[0, i] = out[1, i] = 0.0
    for j in range(MINOR_COUNT):
        a = x[0, j]
        b = x[1, j]
        for i in range(MINOR_COUNT):
            out[0, i] += C[RE, MINOR_COUNT * j + i] * a - C[IM, MINOR_COUNT * j + i] * b
            out[1, i] += C[RE, MINOR_COUNT * j + i] * b + C[IM, MINOR_COUNT * j + i] * a


@compiled_with_reordered_sums
def apply_transposed_propagator(C: Array, x: Array, out: Array) -> None:
    """out = C^T x for a propagator C, (2 or more, PROPAGATOR_LENGTH), and vectors x and out, (2,
    MINOR_COUNT)."""
    for j in range(MINOR_COUNT):
        real = 0.0
        imaginary = 0.0
        for i in range(MINOR_COUNT):
            k = MINOR_COUNT * j + i
            real += C[RE, k] * x[0, i] - C[IM, k] * x[1, i]
            imaginary += C[RE, k] * x[1, i] + C[IM, k] * x[0, i]
        out[0, j] = real
        out[1, j] = imaginary


@compiled_with_reordered_sums
def apply_transposed_real_propagator(C: Array, x: Array, out: Array) -> None:
    """out = C^T x for a real propagator C, (PROPAGATOR_LENGTH,), and real vectors x and out,
    (MINOR_COUNT,)."""
    for j in range(MINOR_COUNT):
        total = 0.0
        for i in range(MINOR_COUNT):
            total += C[MINOR_COUNT * j + i] * x[i]
        out[j] = total


@compiled_with_reordered_sums
def propagate_tangent(C: Array, t: Array, change: Array, x: Array, out: Array) -> None:
    """out = C t + change x: derivative of the minors C x at the end of an element, from the minors x and
    their derivative t at its start. C, change: a propagator and its derivative, (2 or more,
    PROPAGATOR_LENGTH). t, x, out: (2, MINOR_COUNT)."""
    for i in range(MINOR_COUNT):
        out[0, i] = out[1, i] = 0.0
    for j in range(MINOR_COUNT):
        a = t[0, j]
        b = t[1, j]
        c = x[0, j]
        d = x[1, j]
        for i in range(MINOR_COUNT):
            k = MINOR_COUNT * j + i
            out[0, i] += C[RE, k] * a - C[IM, k] * b + change[RE, k] * c - change[IM, k] * d
            out[1, i] += C[RE, k] * b + C[IM, k] * a + change[RE, k] * d + change[IM, k] * c


@compiled_with_reordered_sums
def apply_real_propagator(C: Array, x: Array, out: Array) -> None:
    """out = C x for a real propagator C, (PROPAGATOR_LENGTH,). x, out: real minors at the start and at the
    end of the element, (MINOR_COUNT,)."""
    for i in range(MINOR_COUNT):
        out[i] = 0.0
    for j in range(MINOR_COUNT):
        a = x[j]
        for i in range(MINOR_COUNT):
            out[i] += C[MINOR_COUNT * j + i] * a


@compiled_with_reordered_sums
def propagate_real_tangent(C: Array, t: Array, change: Array, x: Array, out: Array) -> None:
    """As `propagate_tangent`, out = C t + change x, for real arrays. C, change: (PROPAGATOR_LENGTH,). t, x,
    out: (MINOR_COUNT,)."""
    for i in range(MINOR_COUNT):
        out[i] = 0.0
    for j in range(MINOR_COUNT):
        a = t[j]
        b = x[j]
        for i in range(MINOR_COUNT):
            out[i] += C[MINOR_COUNT * j + i] * a + change[MINOR_COUNT * j + i] * b
