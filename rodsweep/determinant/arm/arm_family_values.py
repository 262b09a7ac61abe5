"""Propagators, D and eigenvalues of the arms of a family, by summation of its Chebyshev series.

`rodsweep.determinant.arm.arm_family` makes families.
"""

import math

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled, compiled_with_reordered_sums
from ..exponents import EXPONENT_SETTINGS, MACHINE_EPSILON
from ..roots.settings import ROOT_NEWTON_SETTINGS
from ..value import DeterminantValue
from .arm_family import LOG_SCALE_OF_LINEAR_SPACING, ArmFamily
from .newton import ARM_ROOT_SETTINGS
from .rounding import error_from_interpolated_propagators
from .value import determinant_from_propagators, path_value_from_propagators


@compiled
def write_propagators(family: ArmFamily, p: float, polynomials: Array, p_derivatives: Array) -> None:
    """Writes the propagators of the arm at p into polynomials, and their derivatives by p into p_derivatives,
    both (elements, terms, PROPAGATOR_LENGTH)."""
    half = (family.p_high - family.p_low) / 2
    t = (p - (family.p_low + family.p_high) / 2) / half
    if family.log_spacing_scale < LOG_SCALE_OF_LINEAR_SPACING:
        log_width = math.log1p(2 * half / family.log_spacing_scale)
        t = 2 * math.log1p((p - family.p_low) / family.log_spacing_scale) / log_width - 1
        # dp/dt at this p turns derivatives by the Chebyshev variable t into derivatives by p.
        half = (p - family.p_low + family.log_spacing_scale) * log_width / 2
    nodes = len(family.chebyshev_coefficients)
    T = np.empty(nodes)
    rates = np.empty(nodes)
    # T_0 and T_(-1), as T_(-1) = T_1
    polynomial = 1.0
    previous_polynomial = t
    rate = 0.0
    previous_rate = -1.0
    for k in range(nodes):
        T[k] = polynomial
        rates[k] = rate / half
        if k == 0:
            polynomial = t
            previous_polynomial = 1.0
            rate = 1.0
            previous_rate = 0.0
        else:
            rate, previous_rate = 2 * polynomial + 2 * t * rate - previous_rate, rate
            polynomial, previous_polynomial = 2 * t * polynomial - previous_polynomial, polynomial
    series = family.chebyshev_coefficients.reshape(nodes, -1)
    _sum_series(series, T, rates, polynomials.reshape(-1), p_derivatives.reshape(-1))


@compiled_with_reordered_sums
def _sum_series(series: Array, T: Array, rates: Array, values: Array, slopes: Array) -> None:
    """values = sum_k T[k] series[k] and its derivative by p, slopes = sum_k rates[k] series[k], (n,) each.
    series: (nodes, n). T, rates: Chebyshev polynomials and their derivatives at p, (nodes,)."""
    nodes, n = series.shape
    values[:] = 0.0
    slopes[:] = 0.0
    for k in range(nodes % 4):
        t = T[k]
        p = rates[k]
        for i in range(n):
            values[i] += t * series[k, i]
            slopes[i] += p * series[k, i]
    for k in range(nodes % 4, nodes, 4):  # four at a time save passes over the sums
        t, u, v, w = T[k], T[k + 1], T[k + 2], T[k + 3]
        p, q, r, s = rates[k], rates[k + 1], rates[k + 2], rates[k + 3]
        for i in range(n):
            a = series[k, i]
            b = series[k + 1, i]
            c = series[k + 2, i]
            d = series[k + 3, i]
            values[i] += t * a + u * b + v * c + w * d
            slopes[i] += p * a + q * b + r * c + s * d


@compiled
def W_and_propagators_at(family: ArmFamily, p: float) -> tuple[float, Array]:
    """Returns (W, propagators) of the arm of a family at the path variable p. W: largest |w| for which the
    propagators, (elements, terms, PROPAGATOR_LENGTH), are valid."""
    polynomials = np.empty(family.chebyshev_coefficients.shape[1:])
    write_propagators(family, p, polynomials, np.empty_like(polynomials))
    return family.largest_w, polynomials


@compiled
def determinant_of_family_arm(family: ArmFamily, w: complex, p: float) -> DeterminantValue:
    """D and dD/dw, times exp(-S), at w for the arm at p of a family; |w| <= W. S: `log_scale` of the
    result."""
    shape = family.chebyshev_coefficients.shape[1:]
    polynomials = np.empty(shape)
    p_derivatives = np.empty(shape)
    write_propagators(family, p, polynomials, p_derivatives)
    return determinant_from_propagators(w, family.largest_w, polynomials)


@compiled
def eigenvalue_of_family_arm(family: ArmFamily, guess: complex, p: float) -> tuple[complex, complex, float]:
    """Returns (w, dw/dp, error of w) of the eigenvalue near `guess`, for the arm at p of a family. Newton's
    method ends when rounding stops the decrease of the steps. A real guess gives a real w. The function is
    not for nearly double eigenvalues."""
    polynomials = np.empty(family.chebyshev_coefficients.shape[1:])
    p_derivatives = np.empty_like(polynomials)
    write_propagators(family, p, polynomials, p_derivatives)
    w = guess
    previous_step = math.inf
    for _ in range(ROOT_NEWTON_SETTINGS.max_steps_to_eigenvalue):
        value = determinant_from_propagators(w, family.largest_w, polynomials)
        step = value.D / value.D_w if value.D_w != 0 else 0j
        # D is real at real w, so an imaginary part of the step could only be rounding.
        if w.imag == 0:
            step = complex(step.real, 0.0)
        if (
            not abs(step) < ROOT_NEWTON_SETTINGS.min_stagnant_step_ratio * previous_step
            or abs(w) > family.largest_w
        ):
            break
        previous_step = abs(step)
        w -= step
    W = family.largest_w
    D, D_w, D_p, S, _ = path_value_from_propagators(w, W, polynomials, p_derivatives)
    size = max(abs(D_w), EXPONENT_SETTINGS.min_divisor)
    slope = -D_p / D_w if D_w != 0 else 0j
    if w.imag == 0:
        slope = complex(slope.real, 0.0)
    e = error_from_interpolated_propagators(w, W, polynomials, S, family.reference_entry_sizes)
    return (
        w,
        slope,
        (e + ARM_ROOT_SETTINGS.residual_factor_in_error_of_D * abs(D)) / size + MACHINE_EPSILON * abs(w),
    )
