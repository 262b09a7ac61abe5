"""What D(w) is made of, free of the branch point P = 0: functions even in P.

With the names of `rodsweep.determinant.value`, D = 1 + (w/2) [z+' E(z+) + z-' E(z-)], where z+-' is
infinite at P = 0 and the sum is not:

    z+' E(z+) + z-' E(z-) = T s + 4 N d,   s = E(z+) + E(z-),   d = (E(z+) - E(z-))/(z+ - z-),

N = g nu + 2 X w. Both s and d are entire in M and P^2. With s' = ds/dM, d' = dd/dM and d* = (dd/dP^2)/4 every
derivative of D is at hand, because ds/dP^2 = 4 d'. There are three ways to them: a series where z+ and z- are
small, closed forms in the roots q where neither is, and z+ and z- themselves where only one is.
"""

import cmath
import math
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients
from .exponents import Hyperbolic, entire_cosh, exponents, hyperbolic, modulus

UNIT = 4.440892098500626e-16
"""Unit of the noise of what D is made of, two roundings."""
SERIES_BELOW = 1.5
"""abs(M) + 2 abs(P) below which all is summed as a series in z+ and z-."""
MOST_TERMS = 13
SQUARES_BELOW = 0.1
"""abs(z+ z-), in units of abs(M)^2 + 4 abs(P)^2, below which each of them is taken alone."""


class EvenFunctions(NamedTuple):
    """s, d, s' = s_M, d' = d_M and d* = d_P, all times exp(-S)."""

    S: float
    s: complex
    d: complex
    s_M: complex
    d_M: complex
    d_P: complex


EvenSum = tuple[EvenFunctions, complex, float]
"""(the functions, the sum of z' E(z) times exp(-S), noise)."""


@compiled
def _noise_by_roots(
    squares: tuple[complex, complex, complex, complex],
    apart: complex,
    of_u: Hyperbolic,
    of_v: Hyperbolic,
    results: tuple[complex, complex],
    blurs: tuple[float, float, float],
) -> tuple[float, float]:
    """What rounding does to s and d of `by_roots`, to first order: blurs = (exp(-S), of M, of P^2)."""
    M, square, u, v = modulus(squares[0]), modulus(squares[1]), modulus(squares[2]), modulus(squares[3])
    s, d = modulus(results[0]), modulus(results[1])
    one, blur_M, blur_square = blurs
    c1, f1, g1 = modulus(of_u.cosh), modulus(of_u.sinhc), modulus(of_u.slope)
    c2, f2, g2 = modulus(of_v.cosh), modulus(of_v.sinhc), modulus(of_v.slope)
    per_root = 1 / modulus(apart)
    blur_u = (u * blur_M + blur_square) * per_root + u
    blur_v = (v * blur_M + blur_square) * per_root + v
    C, H = c1 * c2 + one, f1 * f2
    blur_C = (f1 * c2 * blur_u + c1 * f2 * blur_v) / 2 + C
    blur_H = (g1 * f2 * blur_u + f1 * g2 * blur_v) / 2 + H
    blur_R = 2 * M * (blur_M + M) + 4 * (blur_square + square)
    noise_s = 2 * (blur_M * C + M * blur_C + 2 * (blur_square * H + square * blur_H)) + s * blur_R
    noise_d = (blur_M * H + M * blur_H) / 2 + blur_C + d * blur_R
    return noise_s * per_root * per_root, noise_d * per_root * per_root


@compiled
def by_roots(
    M: complex, square: complex, blur_M: float, blur_square: float
) -> tuple[EvenFunctions, float, float]:
    """(the functions, noise of s, of d) by the roots q themselves, where neither z+ nor z- is small.

    square = P^2; u = q1^2 and v = q2^2 solve t^2 - M t + P^2 = 0; with C = cosh q1 cosh q2 - 1,
    H = sinh q1 sinh q2/(q1 q2) and R = z+ z- = M^2 - 4 P^2 = (u - v)^2,

        s = 2 (M C - 2 P^2 H)/R,   d = (M H/2 - C)/R.
    """
    R = M * M - 4 * square
    apart = cmath.sqrt(R)
    if (M.conjugate() * apart).real < 0:
        apart = -apart
    u = (M + apart) / 2
    v = square / u
    q1, q2 = cmath.sqrt(u), cmath.sqrt(v)
    S = q1.real + q2.real
    one = math.exp(-S)
    of_u, of_v = hyperbolic(u, q1), hyperbolic(v, q2)
    cosh1, first1, second1 = of_u
    cosh2, first2, second2 = of_v
    C = cosh1 * cosh2 - one
    H = first1 * first2
    per_R = 1 / R
    half = 1 / (2 * apart)
    C_M = (first1 * cosh2 * u - cosh1 * first2 * v) * half
    H_M = (second1 * first2 * u - first1 * second2 * v) * half
    C_square = (cosh1 * first2 - first1 * cosh2) * half
    H_square = (first1 * second2 - second1 * first2) * half
    s = 2 * (M * C - 2 * square * H) * per_R
    d = (M * H / 2 - C) * per_R
    s1 = 2 * (C + M * (C_M - s) - 2 * square * H_M) * per_R
    d1 = (H / 2 + M * (H_M / 2 - 2 * d) - C_M) * per_R
    dd = (M * H_square / 2 - C_square + 4 * d) * per_R / 4
    squares, blurs = (M, square, u, v), (one, blur_M, blur_square)
    noise_s, noise_d = _noise_by_roots(squares, apart, of_u, of_v, (s, d), blurs)
    return EvenFunctions(S, s, d, s1, d1, dd), noise_s, noise_d


@compiled
def _noise_by_squares(
    sizes: tuple[float, float],
    coefficients: Coefficients,
    roots: tuple[complex, complex],
    slopes: tuple[complex, complex],
    blurs: tuple[float, float],
) -> float:
    """What rounding does to the sum of z' E(z) in `by_squares`; sizes: |w|, |P|, roots: sqrt z, slopes: z'.

    An error of z in units of the terms that cancel in it, half of that and a quarter of |q| in each exponent.
    """
    F, nu, c2, gamma3 = coefficients
    g, T, X = nu + F * c2, c2 + gamma3, c2 * gamma3
    size, size_P = sizes
    blur_M, blur_square = blurs
    S = max(roots[0].real, roots[1].real)
    soft, unlike = abs(g) + abs(F) * c2 / 2, abs(c2 - gamma3) * (abs(c2 - gamma3) + c2 / 2)
    large, blur_P = max(modulus(roots[0]), modulus(roots[1])) ** 2, blur_square / size_P
    blur_large = blur_M + 2 * blur_P
    blur_product = unlike * size * size + 2 * soft * size * (T * abs(F) + 2 * nu) + (F * soft) ** 2
    steepest = T + (nu * soft + 2 * X * size) / size_P * (1 + blur_P / size_P / 2)
    noise = 0.0
    for i in range(2):
        root, slope = roots[i], slopes[i]
        q = modulus(root)
        z = q * q
        blur, steep, blur_slope = blur_large, modulus(slope), steepest
        if z < large / 2:
            blur = (blur_product + z * blur_large) / large
            blur_slope = 2 * unlike * size + 2 * soft * (T * abs(F) + 2 * nu) + z * steepest
            blur_slope = blur_slope / large + steep * blur_large / large
        bound = math.exp(root.real - S) / 2 * min(1.0, 2 / max(z, 1e-300))
        noise += bound * (blur_slope + steep * (1 + q / 4 + blur / 2 / max(1.0, q)))
    return noise


@compiled
def by_squares(w: complex, coefficients: Coefficients, blur_M: float, blur_square: float) -> EvenSum:
    """The functions and their sum from z+ and z-, of which one is the smaller by far; noise of the sum.

    The slope of that one comes from the product z+ z-, too: where w is large its two terms all but cancel.
    """
    F, nu, c2, gamma3 = coefficients
    P, plus, minus = exponents(w, coefficients)
    g, T, X = nu + F * c2, c2 + gamma3, c2 * gamma3
    turn = (g * nu + 2 * X * w) / P
    slope_plus, slope_minus = T + turn, T - turn
    product_slope = 2 * (c2 - gamma3) ** 2 * w - 2 * g * (T * F + 2 * nu)
    if modulus(plus) < modulus(minus):
        slope_plus = (product_slope - plus * slope_minus) / minus
    else:
        slope_minus = (product_slope - minus * slope_plus) / plus
    root_plus, root_minus = cmath.sqrt(plus), cmath.sqrt(minus)
    S = max(root_plus.real, root_minus.real)
    E_plus, E1_plus = entire_cosh(plus, root_plus, S)
    E_minus, E1_minus = entire_cosh(minus, root_minus, S)
    difference = 1 / (4 * P)
    s, s1 = E_plus + E_minus, E1_plus + E1_minus
    d, d1 = (E_plus - E_minus) * difference, (E1_plus - E1_minus) * difference
    dd = (s1 - 2 * d) * difference * difference
    sizes, roots, slopes = (modulus(w), modulus(P)), (root_plus, root_minus), (slope_plus, slope_minus)
    noise = _noise_by_squares(sizes, coefficients, roots, slopes, (blur_M, blur_square))
    return EvenFunctions(S, s, d, s1, d1, dd), slope_plus * E_plus + slope_minus * E_minus, noise


@compiled
def by_series(
    M: complex, P: complex, blur_M: float, blur_square: float
) -> tuple[EvenFunctions, float, float]:
    """(the functions, noise of s, of d) by series where z+ and z- are small: E = sum z^n/(2n + 2)!."""
    plus, minus = M + 2 * P, M - 2 * P
    S = max(cmath.sqrt(plus).real, cmath.sqrt(minus).real)
    size = math.exp(-S)
    s, s1, d, d1, dd = complex(size), 0j, 0j, 0j, 0j
    power_plus, power_minus = 1 + 0j, 1 + 0j
    # Complete homogeneous sums: of z+ and z-, the one before, with z+ twice, with both twice.
    pair, last, three, four = 1 + 0j, 0j, 0j, 0j
    factor = size / 2
    for n in range(1, MOST_TERMS):
        factor /= (2 * n + 1) * (2 * n + 2)
        s1 += n * factor * (power_plus + power_minus)
        d += factor * pair
        d1 += n * factor * last
        dd += factor * four
        three = plus * three + last
        four = minus * four + three
        last = pair
        power_plus, power_minus = plus * power_plus, minus * power_minus
        pair = minus * pair + power_plus
        s += factor * (power_plus + power_minus)
    noise_s = size * (1 + blur_M / 10 + blur_square / 80)
    noise_d = size * (0.1 + blur_M / 300 + blur_square / 8000)
    return EvenFunctions(S, s, d, s1, d1, dd), noise_s, noise_d


@compiled
def even_parts(w: complex, coefficients: Coefficients) -> EvenSum:
    """The functions and their sum at w != 0; the noise is that of D.

    It adds up, to first order and through moduli that do not all vanish where D does, what rounding does to
    M, to P^2 and to each step from there.
    """
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    T, X, G = c2 + gamma3, c2 * gamma3, g * nu
    M = T * w - F * g
    square = w * (G + X * w)
    N = G + 2 * X * w
    size = modulus(w)
    soft = abs(g) + abs(F) * c2 / 2  # c2 is rounded, and so is F c2, which nu may all but cancel
    stiffness = nu * soft + X * size
    blur_M, blur_square = T * size + abs(F) * soft, size * stiffness
    size_M, size_square = modulus(M), modulus(square)
    small = size_M + 2 * math.sqrt(size_square) < SERIES_BELOW
    if small or modulus(M * M - 4 * square) > SQUARES_BELOW * (size_M * size_M + 4 * size_square):
        if small:
            even, noise_s, noise_d = by_series(M, cmath.sqrt(square), blur_M, blur_square)
        else:
            even, noise_s, noise_d = by_roots(M, square, blur_M, blur_square)
        total = T * even.s + 4 * N * even.d
        noise = T * noise_s + 4 * (stiffness + X * size) * noise_d
    else:
        even, total, noise = by_squares(w, coefficients, blur_M, blur_square)
    return even, total, UNIT * (math.exp(-even.S) + size / 2 * noise)
