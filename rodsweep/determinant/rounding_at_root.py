"""The rounding error of D(w) at a root, by the derivatives of D with respect to the intermediate results of
its evaluation.

`rodsweep.determinant.even_sum` bounds the same error by moduli of single terms, which is cheap and safe
everywhere. At high eigenvalues of pulled rods the effects of one rounding error on several terms cancel, and
that bound is up to a hundred times too large. Here the effects are summed with their signs, as D = 1 + (w/2)
[T s + 4 N d] is evaluated, N = d(P^2)/dw. The notation is defined in `rodsweep.determinant.value` and
`rodsweep.determinant.even_functions`; all errors but the result are in units of
`exponents.TWO_MACHINE_EPSILONS`."""

import cmath
import math
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients
from .even_functions import EVEN_FUNCTION_SETTINGS
from .even_sum import even_sum
from .exponents import (
    EXPONENT_SETTINGS,
    TWO_MACHINE_EPSILONS,
    P_and_squared_exponents,
    cosh_sqrt_minus_one_over_z,
    modulus,
    modulus_without_underflow,
    scaled_hyperbolic_functions,
)


class _DispersionTerms(NamedTuple):
    """T, N = d(P^2)/dw (`P_squared_w`), M and P^2 (`P_squared`) of a rod at w, as in
    `rodsweep.determinant.value`; rounding errors of M, of P^2 and of N."""

    T: float
    P_squared_w: complex
    M: complex
    P_squared: complex
    error_of_M: float
    """Rounding error of M, in units of `TWO_MACHINE_EPSILONS`."""
    error_of_P_squared: float
    """Rounding error of P^2, in units of `TWO_MACHINE_EPSILONS`."""
    error_of_P_squared_w: float
    """Rounding error of N = dP^2/dw, in units of `TWO_MACHINE_EPSILONS`."""


class _SquaredExponentProduct(NamedTuple):
    """dz+/dw z- + z+ dz-/dw = d(z+ z-)/dw (`slope`), and rounding errors of z+ z- (`error_of_product`) and of
    `slope` (`error_of_slope`)."""

    slope: complex
    error_of_product: float
    error_of_slope: float


@compiled
def rounding_error_at_root(w: complex, coefficients: Coefficients, log_scale: float) -> float:
    """Bound, to first order, of the rounding error of D exp(-S) of a uniform rod at a root w != 0 of D. S:
    `log_scale`."""
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    T = c2 + gamma3
    X = c2 * gamma3
    M = T * w - F * g
    square = w * (g * nu + X * w)
    size = modulus_without_underflow(w)
    soft = abs(g) + abs(F) * c2 / 2  # includes the rounding errors of c2 and F c2, since nu may cancel F c2
    stiffness = nu * soft + X * size
    terms = _DispersionTerms(
        T,
        g * nu + 2 * X * w,
        M,
        square,
        T * size + abs(F) * soft,
        size * stiffness,
        stiffness + X * size,
    )
    size_M = modulus(M)
    size_square = modulus(square)
    # The same three formulas as in `even_sum`.
    if size_M + 2 * math.sqrt(size_square) < EVEN_FUNCTION_SETTINGS.max_size_for_series:
        even, _, rounding_error = even_sum(w, coefficients)
        return rounding_error * math.exp(even.log_scale - log_scale)
    max_discriminant = EVEN_FUNCTION_SETTINGS.max_product_ratio_for_squares * (
        size_M * size_M + 4 * size_square
    )
    if modulus(M * M - 4 * square) > max_discriminant:
        error, S = _error_and_log_scale_by_roots(terms)
    else:
        contrast = abs(c2 - gamma3) * (abs(c2 - gamma3) + c2 / 2)
        drag = 2 * soft * (T * abs(F) + 2 * nu)
        product = _SquaredExponentProduct(
            2 * (c2 - gamma3) ** 2 * w - 2 * g * (T * F + 2 * nu),
            contrast * size * size + drag * size + (F * soft) ** 2,
            2 * contrast * size + drag,
        )
        error, S = _error_and_log_scale_by_squares(P_and_squared_exponents(w, coefficients), terms, product)
    return TWO_MACHINE_EPSILONS * (math.exp(-log_scale) + size / 2 * error * math.exp(S - log_scale))


@compiled
def _error_and_log_scale_by_roots(terms: _DispersionTerms) -> tuple[float, float]:
    """Returns (rounding error of (T s + 4 N d) exp(-S), S) as computed by `even_functions_by_roots`.

    With R = M^2 - 4 P^2, C = cosh q1 cosh q2 - 1, H = sinh(q1) sinh(q2)/(q1 q2), a = (2 T M - 4 N)/R and b =
    (2 N M - 4 T P^2)/R the sum T s + 4 N d is a C + b H.
    """
    T, N, M, square, error_of_M, error_of_P_squared, _ = terms
    R = M * M - 4 * square
    difference = cmath.sqrt(R)
    if (M.conjugate() * difference).real < 0:
        difference = -difference
    u = (M + difference) / 2
    v = square / u
    q1 = cmath.sqrt(u)
    q2 = cmath.sqrt(v)
    S = q1.real + q2.real
    cosh1, first1, second1 = scaled_hyperbolic_functions(u, q1)
    cosh2, first2, second2 = scaled_hyperbolic_functions(v, q2)
    C = cosh1 * cosh2 - math.exp(-S)
    H = first1 * first2
    per_R = 1 / R
    per_difference = difference * per_R
    a = (2 * T * M - 4 * N) * per_R
    b = (2 * N * M - 4 * T * square) * per_R
    total = a * C + b * H
    # Derivatives of the sum by u and v with a and b constant, then by P^2, log u, log v, M and R.
    by_u = (a * first1 * cosh2 + b * second1 * first2) / 2
    by_v = (a * cosh1 * first2 + b * first1 * second2) / 2
    by_square = 4 * (total - T * H) * per_R + (by_v - by_u) * per_difference
    by_u *= u
    by_v *= v
    by_M = 2 * (T * C + N * H - M * total) * per_R + (by_u - by_v) * per_difference
    by_R = (by_u - by_v) * per_difference / (4 * u) - total * per_R
    error = error_of_M * modulus(by_M) + error_of_P_squared * modulus(by_square)
    error += modulus(by_R) * (modulus(M) ** 2 + 4 * modulus(square))
    # u and v are rounded once, their square roots once.
    error += modulus(by_u - by_v) + modulus(by_u) + 2 * modulus(by_v)
    # sinh q of an imaginary q cancels down to the error of cosh q.
    sizes = (modulus(cosh1), modulus(cosh2), modulus(first1), modulus(first2))
    sinh_error = sizes[0] * sizes[3] / modulus(q1) + sizes[1] * sizes[2] / modulus(q2)
    sinh_error = min(sinh_error, sizes[0] * sizes[3] + sizes[1] * sizes[2]) / 2
    error += modulus(a) * (sizes[0] * sizes[1] + math.exp(-S)) + modulus(b) * (modulus(H) + sinh_error)
    return error + modulus(per_R) * _error_of_products(terms, C, H), S


@compiled
def _error_of_products(terms: _DispersionTerms, C: complex, H: complex) -> float:
    """Rounding error, with R = M^2 - 4 P^2, of (T s + 4 N d) R = 2 T (M C - 2 P^2 H) + 2 N (M H - 2 C) by the
    errors of T and N and of the four products, which are rounded before they cancel. C, H: see
    `_error_and_log_scale_by_roots`."""
    T, N, M, square, _, _, error_of_P_squared_w = terms
    size_M = modulus(M)
    size_C = modulus(C)
    size_H = modulus(H)
    products = T * (size_M * size_C + 2 * modulus(square) * size_H) + modulus(N) * (
        size_M * size_H + 2 * size_C
    )
    return 2 * (
        products + error_of_P_squared_w * modulus(M * H - 2 * C) + T * modulus(M * C - 2 * square * H)
    )


@compiled
def _error_and_log_scale_by_squares(
    exponents: tuple[complex, complex, complex], terms: _DispersionTerms, product: _SquaredExponentProduct
) -> tuple[float, float]:
    """Returns (rounding error of (z+' E(z+) + z-' E(z-)) exp(-S), S) as computed by `even_sum_by_squares`.
    exponents: (P, z+, z-); ' is d/dw."""
    P, large, small = exponents
    slope_difference = terms.P_squared_w / P
    if modulus(large) < modulus(small):
        large, small = small, large
        slope_difference = -slope_difference
    slope = terms.T + slope_difference
    small_slope = (product.slope - small * slope) / large
    root = cmath.sqrt(large)
    small_root = cmath.sqrt(small)
    S = max(root.real, small_root.real)
    E, E1 = cosh_sqrt_minus_one_over_z(large, root, S)
    small_E, small_E1 = cosh_sqrt_minus_one_over_z(small, small_root, S)
    size_P = modulus(P)
    error_of_P = terms.error_of_P_squared / size_P / 2
    # The smaller z and its slope follow from z+ z- and its slope; they change with the larger z, too.
    ratio = small / large
    by_large = slope * E1 - ratio * small_slope * small_E1 + (ratio * slope - small_slope) * small_E / large
    by_product = (small_slope * small_E1 - slope * small_E / large) / large
    by_slope = E - ratio * small_E
    error = modulus(by_large) * (terms.error_of_M + 2 * error_of_P + size_P + modulus(large) / 2)
    error += (
        modulus(by_product) * product.error_of_product + modulus(small_E / large) * product.error_of_slope
    )
    error_of_slope = terms.T + terms.error_of_P_squared_w / size_P
    error_of_slope += modulus(slope_difference) * (1 + error_of_P / size_P)
    error += modulus(by_slope) * error_of_slope
    error += modulus(slope * E1 * large) + 2 * modulus(small_slope * small_E1 * small)
    error += modulus(small_E / large) * (modulus(product.slope) + modulus(small * slope))
    error += modulus(slope) * _error_of_cosh_minus_one_over_z(large, root, E, S)
    error += modulus(small_slope) * _error_of_cosh_minus_one_over_z(small, small_root, small_E, S)
    return error, S


@compiled
def _error_of_cosh_minus_one_over_z(z: complex, root: complex, value: complex, S: float) -> float:
    """Rounding error of `cosh_sqrt_minus_one_over_z` at z beyond the error of sqrt(z), `root`. value: E(z)
    exp(-S)."""
    error = modulus(value)
    if modulus(z) >= EXPONENT_SETTINGS.cosh_series_below:
        # E = (exp(q/2) - exp(-q/2))^2/(2 z): both exponentials are rounded before they cancel.
        terms = math.exp((root.real - S) / 2) + math.exp((-root.real - S) / 2)
        error += terms / 2 * math.sqrt(2 * modulus(value) / modulus(z))
    return error
