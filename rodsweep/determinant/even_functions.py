"""The functions s(M, P^2) and d(M, P^2) that give D, computed by a series for small z+- or from the roots q
of the dispersion relation (`rodsweep.determinant.value`), z+- = (q1 +- q2)^2.

With the squares z+- of the exponents of D, s = E(z+) + E(z-) and d = (E(z+) - E(z-))/(z+ - z-) are even in P,
and entire in M = (z+ + z-)/2 and P^2. All derivatives of D follow from s, d, s' = ds/dM, d' = dd/dM and d* =
(dd/dP^2)/4, because ds/dP^2 = 4 d'. Both methods also return the rounding errors of s and d. Every rounding
error here is in units of `exponents.TWO_MACHINE_EPSILONS`.
"""

import cmath
import math
from dataclasses import dataclass
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.compiled.kernel_constants import KernelConstants
from .exponents import MACHINE_EPSILON, ScaledHyperbolicFunctions, modulus, scaled_hyperbolic_functions


@dataclass(frozen=True, slots=True, kw_only=True)
class EvenFunctionSettings(KernelConstants):
    """Thresholds that select the formula for the even functions s and d (see the module docstring)."""

    series_term_count: int = 13
    """Number of terms of the series of s and d."""
    max_size_for_series: float = 1.5
    """If |M| + 2 |P| is below this number, `even_functions_by_series` computes s and d."""
    max_product_ratio_for_squares: float = 0.1
    """If the series is not used (see `max_size_for_series`) and |z+ z-| / (|M|^2 + 4 |P|^2) is at most this
    number, `even_sum_by_squares` computes s and d; else `even_functions_by_roots` does."""
    log_scale_rounding_in_epsilons: float = 3.0
    """Bound of the relative rounding error of S, the logarithm of the scale, divided by
    TWO_MACHINE_EPSILONS."""
    max_log_scale_without_rounding: float = 8.0
    """S is the logarithm of the scale of D. Up to this S, the rounding error of exp(-S) is smaller than the
    other rounding errors of D, and is not counted. At a larger S only the exponentially small eigenvalues of
    strongly pulled rods depend on exp(-S)."""

    def __post_init__(self) -> None:
        n = self.series_term_count
        if self.max_size_for_series**n > MACHINE_EPSILON * math.factorial(2 * n + 2):
            raise ValueError(
                f"series_term_count = {n} is too small at |M| + 2 |P| = {self.max_size_for_series}: "
                "the sum is not accurate to rounding"
            )


EVEN_FUNCTION_SETTINGS = EvenFunctionSettings()


class EvenFunctionValues(NamedTuple):
    """The functions s(M, P^2) and d(M, P^2) of this module with their derivatives, all times exp(-S), S =
    `log_scale`. ds_dM = ds/dM, dd_dM = dd/dM, quarter_of_dd_dP_squared = (dd/dP^2)/4."""

    log_scale: float
    s: complex
    d: complex
    ds_dM: complex
    dd_dM: complex
    quarter_of_dd_dP_squared: complex


@compiled
def _rounding_errors_by_roots(
    squares: tuple[complex, complex, complex, complex],
    difference: complex,
    functions_of_u: ScaledHyperbolicFunctions,
    functions_of_v: ScaledHyperbolicFunctions,
    results: tuple[complex, complex],
    roundings: tuple[float, float, float],
) -> tuple[float, float]:
    """Returns (rounding error of s, rounding error of d) as computed by `even_functions_by_roots`, to first
    order. squares: (M, P^2, u, v), u = q1^2 and v = q2^2. difference: u - v. functions_of_u, functions_of_v:
    hyperbolic functions of sqrt(u) and sqrt(v). results: (s, d). roundings: (exp(-S), rounding error of M,
    rounding error of P^2)."""
    M = modulus(squares[0])
    square = modulus(squares[1])
    u = modulus(squares[2])
    v = modulus(squares[3])
    s = modulus(results[0])
    d = modulus(results[1])
    scaled_one, rounding_M, rounding_square = roundings
    c1 = modulus(functions_of_u.cosh)
    f1 = modulus(functions_of_u.sinhc)
    g1 = modulus(functions_of_u.sinhc_slope_over_q)
    c2 = modulus(functions_of_v.cosh)
    f2 = modulus(functions_of_v.sinhc)
    g2 = modulus(functions_of_v.sinhc_slope_over_q)
    per_root = 1 / modulus(difference)
    rounding_u = (u * rounding_M + rounding_square) * per_root + u
    rounding_v = (v * rounding_M + rounding_square) * per_root + v
    C = c1 * c2 + scaled_one
    H = f1 * f2
    rounding_C = (f1 * c2 * rounding_u + c1 * f2 * rounding_v) / 2 + C
    rounding_H = (g1 * f2 * rounding_u + f1 * g2 * rounding_v) / 2 + H
    rounding_R = 2 * M * (rounding_M + M) + 4 * (rounding_square + square)
    error_of_s = (
        2 * (rounding_M * C + M * rounding_C + 2 * (rounding_square * H + square * rounding_H))
        + s * rounding_R
    )
    error_of_d = (rounding_M * H + M * rounding_H) / 2 + rounding_C + d * rounding_R
    return error_of_s * per_root * per_root, error_of_d * per_root * per_root


@compiled
def even_functions_by_roots(
    M: complex, square: complex, rounding_M: float, rounding_square: float
) -> tuple[EvenFunctionValues, float, float]:
    """Returns (s and d with derivatives, rounding error of s, rounding error of d), from the roots q1 and q2
    of the dispersion relation; for z+ and z- that are not small.

    square: P^2. rounding_M, rounding_square: rounding errors of M and P^2. u = q1^2 and v = q2^2 solve t^2 -
    M t + P^2 = 0. With C = cosh q1 cosh q2 - 1, H = sinh q1 sinh q2/(q1 q2) and R = z+ z- = M^2 - 4 P^2 = (u
    - v)^2,

        s = 2 (M C - 2 P^2 H)/R,   d = (M H/2 - C)/R.
    """
    R = M * M - 4 * square
    difference = cmath.sqrt(R)
    # The sign without cancellation in M + difference; the smaller root follows from the product.
    if (M.conjugate() * difference).real < 0:
        difference = -difference
    u = (M + difference) / 2
    v = square / u
    q1 = cmath.sqrt(u)
    q2 = cmath.sqrt(v)
    S = q1.real + q2.real
    # The 1 that is subtracted from cosh q1 cosh q2, scaled by exp(-S) like the product.
    scaled_one = math.exp(-S)
    functions_of_u = scaled_hyperbolic_functions(u, q1)
    functions_of_v = scaled_hyperbolic_functions(v, q2)
    cosh1, first1, second1 = functions_of_u
    cosh2, first2, second2 = functions_of_v
    # With z+- = (q1 +- q2)^2 the even functions of P are symmetric functions of q1^2 and q2^2.
    C = cosh1 * cosh2 - scaled_one
    H = first1 * first2
    per_R = 1 / R
    half_inverse = 1 / (2 * difference)
    C_M = (first1 * cosh2 * u - cosh1 * first2 * v) * half_inverse
    H_M = (second1 * first2 * u - first1 * second2 * v) * half_inverse
    C_square = (cosh1 * first2 - first1 * cosh2) * half_inverse
    H_square = (first1 * second2 - second1 * first2) * half_inverse
    s = 2 * (M * C - 2 * square * H) * per_R
    d = (M * H / 2 - C) * per_R
    s1 = 2 * (C + M * (C_M - s) - 2 * square * H_M) * per_R
    d1 = (H / 2 + M * (H_M / 2 - 2 * d) - C_M) * per_R
    dd = (M * H_square / 2 - C_square + 4 * d) * per_R / 4
    squares = (M, square, u, v)
    roundings = (scaled_one, rounding_M, rounding_square)
    error_of_s, error_of_d = _rounding_errors_by_roots(
        squares, difference, functions_of_u, functions_of_v, (s, d), roundings
    )
    return EvenFunctionValues(S, s, d, s1, d1, dd), error_of_s, error_of_d


@compiled
def even_functions_by_series(
    M: complex, P: complex, rounding_M: float, rounding_square: float
) -> tuple[EvenFunctionValues, float, float]:
    """Returns (s and d with derivatives, rounding error of s, rounding error of d), by the series E(z) = sum
    z^n/(2n + 2)!; for small z+ and z-. rounding_M, rounding_square: rounding errors of M and P^2."""
    plus = M + 2 * P
    minus = M - 2 * P
    S = max(cmath.sqrt(plus).real, cmath.sqrt(minus).real)
    size = math.exp(-S)
    s = complex(size)
    s1 = 0j
    d = 0j
    d1 = 0j
    dd = 0j
    power_plus = 1 + 0j
    power_minus = 1 + 0j
    # Complete homogeneous symmetric polynomials, without factorials.
    pair_sum = 1 + 0j  # of (z+, z-), degree n - 1
    previous_pair_sum = 0j  # of (z+, z-), degree n - 2
    triple_sum = 0j  # of (z+, z+, z-)
    quadruple_sum = 0j  # of (z+, z+, z-, z-)
    factor = size / 2
    for n in range(1, EVEN_FUNCTION_SETTINGS.series_term_count):
        # 1/(2n + 2)!, updated from term to term.
        factor /= (2 * n + 1) * (2 * n + 2)
        s1 += n * factor * (power_plus + power_minus)
        d += factor * pair_sum
        d1 += n * factor * previous_pair_sum
        dd += factor * quadruple_sum
        triple_sum = plus * triple_sum + previous_pair_sum
        quadruple_sum = minus * quadruple_sum + triple_sum
        previous_pair_sum = pair_sum
        power_plus = plus * power_plus
        power_minus = minus * power_minus
        pair_sum = minus * pair_sum + power_plus
        s += factor * (power_plus + power_minus)
    # Bounds of the first terms of the series, times the rounding errors of M and P^2.
    error_of_s = size * (1 + rounding_M / 10 + rounding_square / 80)
    error_of_d = size * (0.1 + rounding_M / 300 + rounding_square / 8000)
    return EvenFunctionValues(S, s, d, s1, d1, dd), error_of_s, error_of_d
