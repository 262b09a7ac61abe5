"""The functions even in P that D(w) consists of, which are regular at the branch point P = 0.

In the notation of `rodsweep.determinant.value`, D = 1 + (w/2) [z+' E(z+) + z-' E(z-)]. At P = 0 each z+-' is
infinite, but the sum is finite:

    z+' E(z+) + z-' E(z-) = T s + 4 N d,   s = E(z+) + E(z-),   d = (E(z+) - E(z-))/(z+ - z-),

N = g nu + 2 X w. Both s and d are entire in M and P^2. All derivatives of D follow from s, d, s' = ds/dM,
d' = dd/dM and d* = (dd/dP^2)/4, because ds/dP^2 = 4 d'. Three methods evaluate these functions: a series for
small z+ and z-, closed forms in the roots q if neither z+ nor z- is small, and closed forms in z+ and z- if
one of the two is small.
"""

import cmath
import math
from typing import NamedTuple

from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients
from .exponents import LEAST_DIVISOR, Hyperbolic, entire_cosh, exponents, hyperbolic, modulus

UNIT = 4.440892098500626e-16
"""Unit of the noise of s, d and D: two relative rounding errors."""
SERIES_BELOW = 1.5
"""abs(M) + 2 abs(P) below which `by_series` is used."""
MAX_SERIES_TERMS = 13
"""Number of terms of the series; the next term is below rounding error."""
SQUARES_BELOW = 0.1
"""abs(z+ z-), in units of abs(M)^2 + 4 abs(P)^2, below which `by_squares` is used."""


class EvenFunctions(NamedTuple):
    """s, d, s' = s_M, d' = d_M and d* = d_P, all times exp(-S)."""

    S: float
    s: complex
    d: complex
    s_M: complex
    d_M: complex
    d_P: complex


EvenSum = tuple[EvenFunctions, complex, float]
"""(the even functions, the sum z+' E(z+) + z-' E(z-) times exp(-S), rounding error: that of D from
`even_parts`, else that of the sum)."""


@compiled
def _noise_by_roots(
    squares: tuple[complex, complex, complex, complex],
    apart: complex,
    of_u: Hyperbolic,
    of_v: Hyperbolic,
    results: tuple[complex, complex],
    blurs: tuple[float, float, float],
) -> tuple[float, float]:
    """Rounding errors of s and d in `by_roots`, to first order.

    squares: (M, P^2, u, v). apart: u - v. of_u, of_v: functions of the roots. results: (s, d). blurs:
    exp(-S), rounding errors of M and P^2. Errors are in units of a relative rounding error.
    """
    M = modulus(squares[0])
    square = modulus(squares[1])
    u = modulus(squares[2])
    v = modulus(squares[3])
    s = modulus(results[0])
    d = modulus(results[1])
    one, blur_M, blur_square = blurs
    c1 = modulus(of_u.cosh)
    f1 = modulus(of_u.sinhc)
    g1 = modulus(of_u.slope)
    c2 = modulus(of_v.cosh)
    f2 = modulus(of_v.sinhc)
    g2 = modulus(of_v.slope)
    per_root = 1 / modulus(apart)
    blur_u = (u * blur_M + blur_square) * per_root + u
    blur_v = (v * blur_M + blur_square) * per_root + v
    C = c1 * c2 + one
    H = f1 * f2
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
    """(the functions, noise of s, noise of d) from the roots q, if neither z+ nor z- is small.

    square = P^2; u = q1^2 and v = q2^2 solve t^2 - M t + P^2 = 0; with C = cosh q1 cosh q2 - 1,
    H = sinh q1 sinh q2/(q1 q2) and R = z+ z- = M^2 - 4 P^2 = (u - v)^2,

        s = 2 (M C - 2 P^2 H)/R,   d = (M H/2 - C)/R.
    """
    R = M * M - 4 * square
    apart = cmath.sqrt(R)
    # The sign without cancellation in M + apart; the smaller root follows from the product.
    if (M.conjugate() * apart).real < 0:
        apart = -apart
    u = (M + apart) / 2
    v = square / u
    q1 = cmath.sqrt(u)
    q2 = cmath.sqrt(v)
    S = q1.real + q2.real
    # The 1 that is subtracted from cosh q1 cosh q2, scaled by exp(-S) like the product.
    one = math.exp(-S)
    of_u = hyperbolic(u, q1)
    of_v = hyperbolic(v, q2)
    cosh1, first1, second1 = of_u
    cosh2, first2, second2 = of_v
    # With z+- = (q1 +- q2)^2 the even functions of P are symmetric functions of q1^2 and q2^2.
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
    squares = (M, square, u, v)
    blurs = (one, blur_M, blur_square)
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
    """Rounding error of the sum z+' E(z+) + z-' E(z-) in `by_squares`, in units of a relative rounding error.

    sizes: |w| and |P|. roots: sqrt z+ and sqrt z-. slopes: z+' and z-'. blurs: rounding errors of M and P^2.
    The error of z follows from the terms that cancel in z; an exponent has half of this error over |q|, and
    a quarter of |q|.
    """
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    T = c2 + gamma3
    X = c2 * gamma3
    size, size_P = sizes
    blur_M, blur_square = blurs
    S = max(roots[0].real, roots[1].real)
    soft = abs(g) + abs(F) * c2 / 2
    unlike = abs(c2 - gamma3) * (abs(c2 - gamma3) + c2 / 2)
    large = max(modulus(roots[0]), modulus(roots[1])) ** 2
    blur_P = blur_square / size_P
    blur_large = blur_M + 2 * blur_P
    blur_product = unlike * size * size + 2 * soft * size * (T * abs(F) + 2 * nu) + (F * soft) ** 2
    steepest = T + (nu * soft + 2 * X * size) / size_P * (1 + blur_P / size_P / 2)
    noise = 0.0
    for i in range(2):
        root = roots[i]
        slope = slopes[i]
        q = modulus(root)
        z = q * q
        blur = blur_large
        steep = modulus(slope)
        blur_slope = steepest
        if z < large / 2:
            blur = (blur_product + z * blur_large) / large
            blur_slope = 2 * unlike * size + 2 * soft * (T * abs(F) + 2 * nu) + z * steepest
            blur_slope = blur_slope / large + steep * blur_large / large
        bound = math.exp(root.real - S) / 2 * min(1.0, 2 / max(z, LEAST_DIVISOR))
        noise += bound * (blur_slope + steep * (1 + q / 4 + blur / 2 / max(1.0, q)))
    return noise


@compiled
def by_squares(w: complex, coefficients: Coefficients, blur_M: float, blur_square: float) -> EvenSum:
    """The functions, their sum and its noise from z+ and z-, if one of the two is much smaller.

    The slope of the smaller one follows from the product z+ z-: T +- turn would cancel for large w.
    """
    F, nu, c2, gamma3 = coefficients
    P, plus, minus = exponents(w, coefficients)
    g = nu + F * c2
    T = c2 + gamma3
    X = c2 * gamma3
    turn = (g * nu + 2 * X * w) / P
    slope_plus = T + turn
    slope_minus = T - turn
    product_slope = 2 * (c2 - gamma3) ** 2 * w - 2 * g * (T * F + 2 * nu)
    if modulus(plus) < modulus(minus):
        # d(z+ z-)/dw is a polynomial; the slope of the smaller z cancels if taken from T -+ P'.
        slope_plus = (product_slope - plus * slope_minus) / minus
    else:
        slope_minus = (product_slope - minus * slope_plus) / plus
    root_plus = cmath.sqrt(plus)
    root_minus = cmath.sqrt(minus)
    S = max(root_plus.real, root_minus.real)
    E_plus, E1_plus = entire_cosh(plus, root_plus, S)
    E_minus, E1_minus = entire_cosh(minus, root_minus, S)
    difference = 1 / (4 * P)
    s = E_plus + E_minus
    s1 = E1_plus + E1_minus
    d = (E_plus - E_minus) * difference
    d1 = (E1_plus - E1_minus) * difference
    dd = (s1 - 2 * d) * difference * difference
    sizes = (modulus(w), modulus(P))
    roots = (root_plus, root_minus)
    slopes = (slope_plus, slope_minus)
    noise = _noise_by_squares(sizes, coefficients, roots, slopes, (blur_M, blur_square))
    return EvenFunctions(S, s, d, s1, d1, dd), slope_plus * E_plus + slope_minus * E_minus, noise


@compiled
def by_series(
    M: complex, P: complex, blur_M: float, blur_square: float
) -> tuple[EvenFunctions, float, float]:
    """(the functions, noise of s, noise of d) by series for small z+ and z-: E = sum z^n/(2n + 2)!."""
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
    pair = 1 + 0j  # of (z+, z-), degree n - 1
    last = 0j  # of (z+, z-), degree n - 2
    three = 0j  # of (z+, z+, z-)
    four = 0j  # of (z+, z+, z-, z-)
    factor = size / 2
    for n in range(1, MAX_SERIES_TERMS):
        # 1/(2n + 2)!, updated from term to term.
        factor /= (2 * n + 1) * (2 * n + 2)
        s1 += n * factor * (power_plus + power_minus)
        d += factor * pair
        d1 += n * factor * last
        dd += factor * four
        three = plus * three + last
        four = minus * four + three
        last = pair
        power_plus = plus * power_plus
        power_minus = minus * power_minus
        pair = minus * pair + power_plus
        s += factor * (power_plus + power_minus)
    # Bounds of the first terms of the series, times the rounding errors of M and P^2.
    noise_s = size * (1 + blur_M / 10 + blur_square / 80)
    noise_d = size * (0.1 + blur_M / 300 + blur_square / 8000)
    return EvenFunctions(S, s, d, s1, d1, dd), noise_s, noise_d


@compiled
def even_parts(w: complex, coefficients: Coefficients) -> EvenSum:
    """The functions, their sum, and the rounding error of D, at w != 0.

    The rounding error is a first-order sum over the rounding errors of M, of P^2 and of every later step. The
    sum contains moduli that do not vanish where D does.
    """
    F, nu, c2, gamma3 = coefficients
    g = nu + F * c2
    T = c2 + gamma3
    X = c2 * gamma3
    G = g * nu
    M = T * w - F * g
    square = w * (G + X * w)
    N = G + 2 * X * w
    size = modulus(w)
    soft = abs(g) + abs(F) * c2 / 2  # includes the rounding errors of c2 and F c2, since nu may cancel F c2
    stiffness = nu * soft + X * size
    blur_M = T * size + abs(F) * soft
    blur_square = size * stiffness
    # Three formulas: the series for small z, the roots q where they are well apart, else z+ and z-
    # themselves.
    size_M = modulus(M)
    size_square = modulus(square)
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
