"""D(w) of an arm from the propagators of its elements: five minors, multiplied from clamp to tip.

The minors are defined in `rodsweep.determinant.arm.elements.collocation`: at the clamp s^m = 1 and all other
minors are 0; at the tip D = s^m. D spans hundreds of decades, so the minors are divided by their norm between
elements, and the logarithms of these norms are summed. Derivatives of the minors by w and along a path of
arms are computed too. At real w every minor is real.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled, compiled_with_reordered_sums
from ...model.compiled.kernel_constants import KernelConstants
from ..exponents import TWO_MACHINE_EPSILONS
from ..parameter_path import PathDeterminantValue
from ..value import DeterminantValue
from .elements.evaluation import (
    apply_propagator,
    apply_real_propagator,
    fill_propagator_and_derivative,
    fill_propagator_value,
    fill_real_propagator_and_derivative,
    fill_real_propagator_value,
    powers_and_derivatives,
    propagate_real_tangent,
    propagate_tangent,
)
from .elements.minor_rates import PROPAGATOR_LENGTH, SM
from .elements.modulus_sums import minor_sm_modulus_sum, real_minor_sm_modulus_sum
from .elements.settings import MINOR_COUNT


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmDeterminantSettings(KernelConstants):
    """Settings for D from propagators."""

    max_minor_norm: float = 1e100
    """Minors are divided by their norm if the norm is not between 1/max_minor_norm and max_minor_norm."""


ARM_DETERMINANT_SETTINGS = ArmDeterminantSettings()


@compiled_with_reordered_sums
def _norm(x: Array) -> float:
    """Euclidean norm of the minors x, (2, MINOR_COUNT)."""
    total = 0.0
    for i in range(MINOR_COUNT):
        total += x[0, i] * x[0, i] + x[1, i] * x[1, i]
    return math.sqrt(total)


@compiled_with_reordered_sums
def _norm_of_real_minors(x: Array) -> float:
    """Euclidean norm of the real minors x, (MINOR_COUNT,)."""
    total = 0.0
    for i in range(MINOR_COUNT):
        total += x[i] * x[i]
    return math.sqrt(total)


@compiled
def _needs_rescaling(size: float) -> bool:
    """Whether minors of the norm `size` must be divided by it."""
    return not 1 / ARM_DETERMINANT_SETTINGS.max_minor_norm < size < ARM_DETERMINANT_SETTINGS.max_minor_norm


@compiled
def divide_by_norm(x: Array) -> float:
    """Divides the minors x, (2, MINOR_COUNT), by their norm if it is not between 1/`max_minor_norm` and
    `max_minor_norm`. Returns the logarithm of the divisor."""
    size = _norm(x)
    if not _needs_rescaling(size):
        return 0.0
    x /= size
    return math.log(size)


@compiled
def divide_real_by_norm(x: Array) -> float:
    """`divide_by_norm` for real minors x, (MINOR_COUNT,)."""
    size = _norm_of_real_minors(x)
    if not _needs_rescaling(size):
        return 0.0
    x /= size
    return math.log(size)


@compiled
def _multiply_propagators(
    z: complex, W: float, polynomials: Array, p_derivatives: Array
) -> tuple[complex, complex, complex, float]:
    """Returns (D exp(-S), dD/dw exp(-S), dD/dp exp(-S), S) at w = z W, as `path_value_from_propagators` does
    for w; dD/dp is 0 if `p_derivatives` is empty. polynomials, p_derivatives: propagators and their
    derivatives by p, (elements, terms, PROPAGATOR_LENGTH)."""
    elements, terms, _ = polynomials.shape
    has_p_derivative = len(p_derivatives) > 0
    powers = powers_and_derivatives(z, terms)
    C = np.empty((4, PROPAGATOR_LENGTH))
    C_p = np.empty((2, PROPAGATOR_LENGTH))
    # minors and their derivatives by w and p, here and at the end of the element
    minors = np.zeros((3, 2, MINOR_COUNT))
    next_minors = np.zeros((3, 2, MINOR_COUNT))
    minors[0, 0, SM] = 1.0
    S = 0.0
    for e in range(elements):
        fill_propagator_and_derivative(polynomials[e], powers, C)
        apply_propagator(C, minors[0], next_minors[0])
        propagate_tangent(C, minors[1], C[2:], minors[0], next_minors[1])
        if has_p_derivative:
            fill_propagator_value(p_derivatives[e], powers, C_p)
            propagate_tangent(C, minors[2], C_p, minors[0], next_minors[2])
        size = _norm(next_minors[0])
        # At the tip D is scaled by its terms, because its rounding error is relative to them, not to D.
        if e == elements - 1:
            size = max(size, minor_sm_modulus_sum(C, minors[0]))
        if _needs_rescaling(size) or e == elements - 1:
            next_minors /= size
            S += math.log(size)
        minors, next_minors = next_minors, minors
    D = complex(minors[0, 0, SM], minors[0, 1, SM])
    D_w = complex(minors[1, 0, SM], minors[1, 1, SM]) / W
    return D, D_w, complex(minors[2, 0, SM], minors[2, 1, SM]), S


@compiled
def _multiply_real_propagators(
    z: float, W: float, polynomials: Array, p_derivatives: Array
) -> tuple[complex, complex, complex, float]:
    """`_multiply_propagators` at real z, where D and its derivatives are real."""
    elements, terms, _ = polynomials.shape
    has_p_derivative = len(p_derivatives) > 0
    powers = powers_and_derivatives(complex(z, 0.0), terms)
    C = np.empty((2, PROPAGATOR_LENGTH))
    C_p = np.empty(PROPAGATOR_LENGTH)
    minors = np.zeros((3, MINOR_COUNT))
    next_minors = np.zeros((3, MINOR_COUNT))
    minors[0, SM] = 1.0
    S = 0.0
    for e in range(elements):
        fill_real_propagator_and_derivative(polynomials[e], powers, C)
        apply_real_propagator(C[0], minors[0], next_minors[0])
        propagate_real_tangent(C[0], minors[1], C[1], minors[0], next_minors[1])
        if has_p_derivative:
            fill_real_propagator_value(p_derivatives[e], powers, C_p)
            propagate_real_tangent(C[0], minors[2], C_p, minors[0], next_minors[2])
        size = _norm_of_real_minors(next_minors[0])
        if e == elements - 1:
            size = max(size, real_minor_sm_modulus_sum(C[0], minors[0]))
        if _needs_rescaling(size) or e == elements - 1:
            next_minors /= size
            S += math.log(size)
        minors, next_minors = next_minors, minors
    return complex(minors[0, SM]), complex(minors[1, SM] / W), complex(minors[2, SM]), S


@compiled
def scaled_determinant_from_propagators(w: complex, W: float, polynomials: Array) -> tuple[complex, float]:
    """Returns (D exp(-S), S) at w, without derivatives; S: logarithm of the scale that keeps the numbers
    finite. polynomials: propagators for |w| <= W, (elements, terms, PROPAGATOR_LENGTH)."""
    powers = powers_and_derivatives(w / W, polynomials.shape[1])
    C = np.empty((2, PROPAGATOR_LENGTH))
    minors = np.zeros((2, MINOR_COUNT))
    next_minors = np.empty((2, MINOR_COUNT))
    minors[0, SM] = 1.0
    S = 0.0
    for e in range(len(polynomials)):
        fill_propagator_value(polynomials[e], powers, C)
        apply_propagator(C, minors, next_minors)
        S += divide_by_norm(next_minors)
        minors, next_minors = next_minors, minors
    return complex(minors[0, SM], minors[1, SM]), S


@compiled
def log_modulus_from_propagators(w: complex, W: float, polynomials: Array) -> float:
    """log |D| at w; -inf if D = 0. polynomials: propagators for |w| <= W, (elements, terms,
    PROPAGATOR_LENGTH)."""
    D, S = scaled_determinant_from_propagators(w, W, polynomials)
    return S + math.log(abs(D)) if D != 0 else -math.inf


@compiled
def path_value_from_propagators(
    w: complex, W: float, polynomials: Array, p_derivatives: Array
) -> PathDeterminantValue:
    """D, dD/dw and dD/dp at w, times exp(-S), S = `log_scale` of the result. At real w every value is real.

    polynomials, p_derivatives: propagators valid for |w| <= W and their derivatives by p, (elements, terms,
    PROPAGATOR_LENGTH). dD/dp is 0 if `p_derivatives` is empty. The rounding error is the error of the
    products at the tip; the bound of the whole error is
    `rodsweep.determinant.arm.rounding.rounding_error_from_propagators`.
    """
    if w.imag == 0:
        D, D_w, D_p, S = _multiply_real_propagators(w.real / W, W, polynomials, p_derivatives)
    else:
        D, D_w, D_p, S = _multiply_propagators(w / W, W, polynomials, p_derivatives)
    return PathDeterminantValue(D, D_w, D_p, S, (len(polynomials) + 2) * TWO_MACHINE_EPSILONS)


@compiled
def determinant_from_propagators(w: complex, W: float, polynomials: Array) -> DeterminantValue:
    """D and dD/dw at w, times exp(-S), S = `log_scale` of the result. polynomials: propagators for |w| <= W,
    (elements, terms, PROPAGATOR_LENGTH)."""
    D, D_w, _, S, rounding_error = path_value_from_propagators(w, W, polynomials, polynomials[:0])
    return DeterminantValue(D, D_w, S, rounding_error)
