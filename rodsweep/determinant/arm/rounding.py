"""Rounding and interpolation errors of an arm's D(w), from the propagators of its elements and the
sensitivities of D.

D = a_e . C_e x_e for every element e: x_e are the minors at the start of the element, C_e is its propagator,
and a_e are the derivatives of D by the minors at its end. Rounding changes each product C_ij x_j by a
relative error of about the spacing of doubles at 1. The rounding error of D is therefore at most this spacing
times the sum over elements of |a_e| . |C_e| |x_e|. The products at the tip alone are not enough: close to
crushing, minors are large in the middle of an arm, and their errors exceed the errors at the tip.

Propagators that are interpolated in a path variable p have errors relative to their largest entries on the
interval of p, which |C_e| then contains. At the low end of a long interval of forces the interpolation errors
exceed the rounding errors.
"""

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ..exponents import MACHINE_EPSILON
from .elements.evaluation import (
    apply_propagator,
    apply_real_propagator,
    apply_transposed_propagator,
    apply_transposed_real_propagator,
    fill_propagator_value,
    fill_real_propagator_value,
    powers_and_derivatives,
)
from .elements.minor_rates import PROPAGATOR_LENGTH, SM
from .elements.modulus_sums import (
    modulus_sum_of_form,
    modulus_sum_of_form_at_real_w,
    modulus_sum_of_form_from_sizes,
)
from .elements.settings import MINOR_COUNT
from .value import divide_by_norm, divide_real_by_norm


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmRoundingSettings(KernelConstants):
    """Settings for the rounding error of D."""

    error_per_product_in_epsilons: float = 1.5
    """Relative rounding error of a product of propagator and minor, divided by the spacing of doubles at 1.
    Measured for 700 eigenvalues of random arms, half of them close to crushing, each with four divisions of
    the arm into elements: with the factor 1.5 the resulting bound is at most 1 % below 1.5 times the
    difference between divisions."""
    error_per_entry_in_epsilons: float = 1.0
    """Error of an entry of a propagator that is interpolated on an interval of a path variable, in units of
    the largest modulus of the entry on the interval times the spacing of doubles at 1. Measured: 1300
    eigenvalues from interpolated propagators of random arms, on intervals of F, k1, gamma3 and taper, have
    errors of at most half of the resulting bound."""


ARM_ROUNDING_SETTINGS = ArmRoundingSettings()


@compiled
def rounding_error_from_propagators(w: complex, W: float, polynomials: Array, S: float) -> float:
    """Bound of the rounding error of D exp(-S) at w, to first order. polynomials: propagators valid for |w|
    <= W, (elements, terms, PROPAGATOR_LENGTH). S: logarithm of the scale of the result."""
    if w.imag == 0:
        return _rounding_error_from_real_propagators(w.real, W, polynomials, S)
    return error_from_interpolated_propagators(w, W, polynomials, S, np.empty((0, 2, PROPAGATOR_LENGTH)))


@compiled
def _rounding_error_from_real_propagators(w: float, W: float, polynomials: Array, S: float) -> float:
    """`rounding_error_from_propagators` at real w, where all minors are real."""
    elements, terms, _ = polynomials.shape
    powers = powers_and_derivatives(complex(w / W, 0.0), terms)
    C = np.empty((elements, PROPAGATOR_LENGTH))
    x = np.zeros((elements + 1, MINOR_COUNT))
    x[0, SM] = 1.0
    scale = np.zeros(elements + 1)
    for e in range(elements):
        fill_real_propagator_value(polynomials[e], powers, C[e])
        apply_real_propagator(C[e], x[e], x[e + 1])
        scale[e + 1] = scale[e] + divide_real_by_norm(x[e + 1])
    next_moduli = np.zeros(MINOR_COUNT)
    next_moduli[SM] = 1.0
    moduli = np.empty(MINOR_COUNT)
    scale_after = -S
    total = 0.0
    # From tip to clamp, as in `error_from_interpolated_propagators`.
    for e in range(elements - 1, -1, -1):
        errors = modulus_sum_of_form_at_real_w(next_moduli, C[e], x[e])
        total += math.exp(scale[e] + scale_after) * errors
        apply_transposed_real_propagator(C[e], next_moduli, moduli)
        scale_after += divide_real_by_norm(moduli)
        next_moduli, moduli = moduli, next_moduli
    return MACHINE_EPSILON * ARM_ROUNDING_SETTINGS.error_per_product_in_epsilons * total


@compiled
def error_from_interpolated_propagators(
    w: complex, W: float, polynomials: Array, S: float, reference_entry_sizes: Array
) -> float:
    """Bound of the rounding and interpolation error of D exp(-S) at w, to first order.

    polynomials: interpolated propagators valid for |w| <= W, (elements, terms, PROPAGATOR_LENGTH). S:
    logarithm of the scale of the result. reference_entry_sizes: sizes to which the interpolation errors of
    propagator entries are relative, (elements, 2, PROPAGATOR_LENGTH); no elements if nothing is interpolated.
    """
    elements, terms, _ = polynomials.shape
    powers = powers_and_derivatives(w / W, terms)
    C = np.empty((elements, 2, PROPAGATOR_LENGTH))
    x = np.zeros((elements + 1, 2, MINOR_COUNT))
    x[0, 0, SM] = 1.0
    scale = np.zeros(elements + 1)
    for e in range(elements):
        fill_propagator_value(polynomials[e], powers, C[e])
        apply_propagator(C[e], x[e], x[e + 1])
        scale[e + 1] = scale[e] + divide_by_norm(x[e + 1])
    next_moduli = np.zeros((2, MINOR_COUNT))
    next_moduli[0, SM] = 1.0
    moduli = np.empty((2, MINOR_COUNT))
    scale_after = -S
    total = 0.0
    # `next_moduli` holds a_e of the module docstring, so the elements are visited from tip to clamp.
    for e in range(elements - 1, -1, -1):
        errors = ARM_ROUNDING_SETTINGS.error_per_product_in_epsilons * modulus_sum_of_form(
            next_moduli, C[e], x[e]
        )
        if len(reference_entry_sizes):
            sizes = modulus_sum_of_form_from_sizes(next_moduli, reference_entry_sizes[e], abs(w / W), x[e])
            errors += ARM_ROUNDING_SETTINGS.error_per_entry_in_epsilons * sizes
        total += math.exp(scale[e] + scale_after) * errors
        apply_transposed_propagator(C[e], next_moduli, moduli)
        scale_after += divide_by_norm(moduli)
        next_moduli, moduli = moduli, next_moduli
    return MACHINE_EPSILON * total
