"""Sums of the moduli of products of propagators and minors, for rounding errors of D.

The shapes are those of `rodsweep.determinant.arm.elements.evaluation`."""

from ....arrays import Array
from ....model.compiled.compilation import compiled, compiled_with_reordered_sums
from .evaluation import IM, RE
from .minor_rates import SM
from .settings import MINOR_COUNT


@compiled_with_reordered_sums
def modulus_sum_of_form_at_real_w(a: Array, C: Array, x: Array) -> float:
    """The sum of |a_i| |C_ij| |x_j| over i and j. C: real propagator, (PROPAGATOR_LENGTH,). a, x: real
    vectors, (MINOR_COUNT,)."""
    total = 0.0
    for j in range(MINOR_COUNT):
        column = 0.0
        for i in range(MINOR_COUNT):
            column += abs(C[MINOR_COUNT * j + i]) * abs(a[i])
        total += column * abs(x[j])
    return total


@compiled_with_reordered_sums
def modulus_sum_of_form(a: Array, C: Array, x: Array) -> float:
    """Upper bound of the sum of |a_i| |C_ij| |x_j| for a propagator C, (2 or more, PROPAGATOR_LENGTH), and
    vectors a and x, (2, MINOR_COUNT): |real part| + |imaginary part| replaces each modulus, so the bound is
    at most 2 sqrt(2) times too large."""
    total = 0.0
    for j in range(MINOR_COUNT):
        column = 0.0
        for i in range(MINOR_COUNT):
            k = MINOR_COUNT * j + i
            column += (abs(C[RE, k]) + abs(C[IM, k])) * (abs(a[0, i]) + abs(a[1, i]))
        total += column * (abs(x[0, j]) + abs(x[1, j]))
    return total


@compiled_with_reordered_sums
def modulus_sum_of_form_from_sizes(a: Array, sizes: Array, t: float, x: Array) -> float:
    """Upper bound of the sum of |a_i| B_ij |x_j| with bounds B = sizes[0] + t sizes[1] of the moduli of the
    entries of a propagator; sizes: (2, PROPAGATOR_LENGTH). a, x: vectors, (2, MINOR_COUNT); |real part| +
    |imaginary part| replaces the moduli of their entries."""
    total = 0.0
    for j in range(MINOR_COUNT):
        column = 0.0
        for i in range(MINOR_COUNT):
            k = MINOR_COUNT * j + i
            column += (sizes[0, k] + t * sizes[1, k]) * (abs(a[0, i]) + abs(a[1, i]))
        total += column * (abs(x[0, j]) + abs(x[1, j]))
    return total


@compiled
def minor_sm_modulus_sum(C: Array, x: Array) -> float:
    """Sum of the moduli of the products of entries of C and x that add up to the minor s^m at the end of an
    element. Near a root of D these products cancel, and the rounding error of D is relative to this sum, not
    to |s^m|. C: propagator, (2 or more, PROPAGATOR_LENGTH), with rows RE and IM. x: minors at the start of
    the element, real and imaginary parts, (2, MINOR_COUNT)."""
    total = 0.0
    for j in range(MINOR_COUNT):
        entry = complex(C[RE, MINOR_COUNT * j + SM], C[IM, MINOR_COUNT * j + SM])
        total += abs(entry * complex(x[RE, j], x[IM, j]))
    return total


@compiled_with_reordered_sums
def real_minor_sm_modulus_sum(C: Array, x: Array) -> float:
    """`minor_sm_modulus_sum` for a real propagator C, (PROPAGATOR_LENGTH,), and real minors x,
    (MINOR_COUNT,)."""
    total = 0.0
    for j in range(MINOR_COUNT):
        total += abs(C[MINOR_COUNT * j + SM] * x[j])
    return total
