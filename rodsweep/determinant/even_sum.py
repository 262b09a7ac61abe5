"""The sum z+' E(z+) + z-' E(z-) of D(w), regular at the branch point P = 0 where each term is infinite.

In the notation of `rodsweep.determinant.value`, D = 1 + (w/2) [z+' E(z+) + z-' E(z-)], and

    z+' E(z+) + z-' E(z-) = T s + 4 N d,   s = E(z+) + E(z-),   d = (E(z+) - E(z-))/(z+ - z-),

with N = g nu + 2 X w. Three methods evaluate s and d: a series if z+ and z- are small; closed forms in the
roots q if neither z+ nor z- is small (both methods are in `even_functions`); and, if only one of z+ and z- is
small, closed forms in z+ and z-, which give the sum directly.
"""

import cmath
import math

from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients
from .even_functions import (
    EVEN_FUNCTION_SETTINGS,
    EvenFunctionValues,
    even_functions_by_roots,
    even_functions_by_series,
)
from .exponents import (
    EXPONENT_SETTINGS,
    TWO_MACHINE_EPSILONS,
    P_and_squared_exponents,
    cosh_sqrt_minus_one_over_z,
    modulus,
    modulus_without_underflow,
)

EvenSum = tuple[EvenFunctionValues, complex, float]
"""(s and d with derivatives, sum z+' E(z+) + z-' E(z-) times exp(-S), rounding error). `even_sum` returns
the rounding error of D exp(-S), `even_sum_by_squares` the rounding error of the sum."""


@compiled
def _rounding_error_by_squares(
    sizes: tuple[float, float],
    coefficients: Coefficients,
    roots: tuple[complex, complex],
    slopes: tuple[complex, complex],
    roundings: tuple[float, float],
) -> float:
    """Rounding error of the sum z+' E(z+) + z-' E(z-) as computed by `even_sum_by_squares`, in units of
    `TWO_MACHINE_EPSILONS`, like all rounding errors of the arguments.

    sizes: (|w|, |P|). roots: (sqrt z+, sqrt z-). slopes: (z+', z-'). roundings: rounding errors of M and P^2.
    The error of z follows from the terms that cancel in z; the error of an exponent q = sqrt z is half the
    error of z divided by |q|, plus |q|/4.
    """
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    T = c2 + gamma3
    X = c2 * gamma3
    size, size_P = sizes
    rounding_M, rounding_square = roundings
    S = max(roots[0].real, roots[1].real)
    soft = abs(g) + abs(F) * c2 / 2
    contrast = abs(c2 - gamma3) * (abs(c2 - gamma3) + c2 / 2)
    max_z = max(modulus(roots[0]), modulus(roots[1])) ** 2
    rounding_P = rounding_square / size_P
    rounding_large = rounding_M + 2 * rounding_P
    rounding_product = contrast * size * size + 2 * soft * size * (T * abs(F) + 2 * nu) + (F * soft) ** 2
    max_slope = T + (nu * soft + 2 * X * size) / size_P * (1 + rounding_P / size_P / 2)
    error = 0.0
    for i in range(2):
        root = roots[i]
        slope = slopes[i]
        q = modulus(root)
        z = q * q
        error_of_z = rounding_large
        dz = modulus(slope)
        rounding_slope = max_slope
        # The smaller z was computed as product over larger z, and inherits both of their errors.
        if z < max_z / 2:
            error_of_z = (rounding_product + z * rounding_large) / max_z
            rounding_slope = 2 * contrast * size + 2 * soft * (T * abs(F) + 2 * nu) + z * max_slope
            rounding_slope = rounding_slope / max_z + dz * rounding_large / max_z
        bound = math.exp(root.real - S) / 2 * min(1.0, 2 / max(z, EXPONENT_SETTINGS.min_divisor))
        error += bound * (rounding_slope + dz * (1 + q / 4 + error_of_z / 2 / max(1.0, q)))
    return error


@compiled
def even_sum_by_squares(
    w: complex, coefficients: Coefficients, rounding_M: float, rounding_square: float
) -> EvenSum:
    """Returns (s and d with derivatives, sum z+' E(z+) + z-' E(z-), rounding error of the sum), for z+ and z-
    of very different moduli.

    The derivative of the smaller of z+ and z- follows from the derivative of the product z+ z-, because
    z+-' = T +- 2 P' cancels for large w. rounding_M, rounding_square: rounding errors of M and P^2. All
    rounding errors are in units of `TWO_MACHINE_EPSILONS`.
    """
    F, nu, c2, gamma3 = coefficients
    P, plus, minus = P_and_squared_exponents(w, coefficients)
    g = nu + F * c2
    T = c2 + gamma3
    X = c2 * gamma3
    slope_difference = (g * nu + 2 * X * w) / P
    slope_plus = T + slope_difference
    slope_minus = T - slope_difference
    product_slope = 2 * (c2 - gamma3) ** 2 * w - 2 * g * (T * F + 2 * nu)
    if modulus(plus) < modulus(minus):
        # d(z+ z-)/dw is a polynomial in w; T - 2 P' or T + 2 P' would cancel for the smaller z.
        slope_plus = (product_slope - plus * slope_minus) / minus
    else:
        slope_minus = (product_slope - minus * slope_plus) / plus
    root_plus = cmath.sqrt(plus)
    root_minus = cmath.sqrt(minus)
    S = max(root_plus.real, root_minus.real)
    E_plus, E1_plus = cosh_sqrt_minus_one_over_z(plus, root_plus, S)
    E_minus, E1_minus = cosh_sqrt_minus_one_over_z(minus, root_minus, S)
    # z+ - z- is 4 P, without a subtraction.
    difference = 1 / (4 * P)
    s = E_plus + E_minus
    s1 = E1_plus + E1_minus
    d = (E_plus - E_minus) * difference
    d1 = (E1_plus - E1_minus) * difference
    dd = (s1 - 2 * d) * difference * difference
    sizes = (modulus(w), modulus(P))
    roots = (root_plus, root_minus)
    slopes = (slope_plus, slope_minus)
    rounding_error = _rounding_error_by_squares(
        sizes, coefficients, roots, slopes, (rounding_M, rounding_square)
    )
    return (
        EvenFunctionValues(S, s, d, s1, d1, dd),
        slope_plus * E_plus + slope_minus * E_minus,
        rounding_error,
    )


@compiled
def even_sum(w: complex, coefficients: Coefficients) -> EvenSum:
    """Returns (s and d with derivatives, sum z+' E(z+) + z-' E(z-), rounding error of D), all times exp(-S),
    for a uniform rod at w != 0. The rounding error sums, to first order, the rounding errors of M, of P^2 and
    of every later operation. It is a sum of moduli that do not vanish at a zero of D."""
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    T = c2 + gamma3
    X = c2 * gamma3
    G = g * nu
    M = T * w - F * g
    square = w * (G + X * w)
    N = G + 2 * X * w
    size = modulus_without_underflow(w)
    soft = abs(g) + abs(F) * c2 / 2  # includes the rounding errors of c2 and F c2, since nu may cancel F c2
    stiffness = nu * soft + X * size
    rounding_M = T * size + abs(F) * soft
    rounding_square = size * stiffness
    # Three formulas: a series for small z+ and z-, the roots q if neither z+ nor z- is small, else z+ and z-.
    size_M = modulus(M)
    size_square = modulus(square)
    is_small = size_M + 2 * math.sqrt(size_square) < EVEN_FUNCTION_SETTINGS.max_size_for_series
    max_discriminant = EVEN_FUNCTION_SETTINGS.max_product_ratio_for_squares * (
        size_M * size_M + 4 * size_square
    )
    if is_small or modulus(M * M - 4 * square) > max_discriminant:
        if is_small:
            even, error_of_s, error_of_d = even_functions_by_series(
                M, cmath.sqrt(square), rounding_M, rounding_square
            )
        else:
            even, error_of_s, error_of_d = even_functions_by_roots(M, square, rounding_M, rounding_square)
        total = T * even.s + 4 * N * even.d
        rounding_error = T * error_of_s + 4 * (stiffness + X * size) * error_of_d
    else:
        even, total, rounding_error = even_sum_by_squares(w, coefficients, rounding_M, rounding_square)
    excess = even.log_scale - EVEN_FUNCTION_SETTINGS.max_log_scale_without_rounding
    scale_error = max(1.0, EVEN_FUNCTION_SETTINGS.log_scale_rounding_in_epsilons * excess)
    return (
        even,
        total,
        TWO_MACHINE_EPSILONS * (scale_error * math.exp(-even.log_scale) + size / 2 * rounding_error),
    )
