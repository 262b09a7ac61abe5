"""Sums of the moduli of products of propagators and minors, for rounding errors of D.

The shapes are those of `rodsweep.determinant.arm.elements.evaluation`."""

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_for_vectors
from .evaluation import IM, RE
from .minor_rates import SM
from .settings import MINORS


@compiled_for_vectors
def modulus_sum_of_form_at_real_w(a: Array, C: Array, x: Array) -> float:
    """The sum of |a_i| |C_ij| |x_j| for a real propagator C, (PADDED,), and real vectors a and x,
    (MINORS,)."""
    total = 0.0
    for j in range(MINORS):
        column = 0.0
        for i in range(MINORS):
            column += abs(C[MINORS * j + i]) * abs(a[i])
        total += column * abs(x[j])
    return total


@compiled_for_vectors
def modulus_sum_of_form(a: Array, C: Array, x: Array) -> float:
    """The sum of |a_i| |C_ij| |x_j| for a propagator C, (2 or more, PADDED), and vectors a and x, (2,
    MINORS). |real| + |imaginary part| replaces each modulus: up to 2 sqrt(2) times too large."""
    total = 0.0
    for j in range(MINORS):
        column = 0.0
        for i in range(MINORS):
            k = MINORS * j + i
            column += (abs(C[RE, k]) + abs(C[IM, k])) * (abs(a[0, i]) + abs(a[1, i]))
        total += column * (abs(x[0, j]) + abs(x[1, j]))
    return total


@compiled_for_vectors
def modulus_sum_of_real_form(a: Array, sizes: Array, t: float, x: Array) -> float:
    """The sum of |a_i| (sizes_0 + t sizes_1)_ij |x_j| for sizes of propagator entries, (2, PADDED), and
    vectors a and x, (2, MINORS). |real part| + |imaginary part| replaces the moduli of a_i and x_j."""
    total = 0.0
    for j in range(MINORS):
        column = 0.0
        for i in range(MINORS):
            k = MINORS * j + i
            column += (sizes[0, k] + t * sizes[1, k]) * (abs(a[0, i]) + abs(a[1, i]))
        total += column * (abs(x[0, j]) + abs(x[1, j]))
    return total


@compiled
def minor_sm_modulus_sum(C: Array, x: Array) -> float:
    """Sum of the moduli of all terms of C x that add up to the minor s^m at the end of an element. C:
    propagator, (2 or more, PADDED). x: minors, (2, MINORS). Near a root of D the terms cancel, and the
    rounding error of D is relative to their moduli, not to s^m."""
    total = 0.0
    for j in range(MINORS):
        entry = complex(C[RE, MINORS * j + SM], C[IM, MINORS * j + SM])
        total += abs(entry * complex(x[RE, j], x[IM, j]))
    return total


@compiled_for_vectors
def real_minor_sm_modulus_sum(C: Array, x: Array) -> float:
    """`minor_sm_modulus_sum` for a real propagator C, (PADDED,), and real minors x, (MINORS,)."""
    total = 0.0
    for j in range(MINORS):
        total += abs(C[MINORS * j + SM] * x[j])
    return total
