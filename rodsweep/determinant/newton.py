"""Newton's method for the points of a path of rods where the spectrum changes its character.

A crossing of the imaginary axis is D(i eta; p) = 0 in (eta, p); a double real eigenvalue, where two real
ones become a pair, is D = D_w = 0 in (x, p): there the eigenvalues themselves lose half of the digits,
and p does not.
"""

import math

from ..model.compilation import compiled
from ..model.rod import Coefficients
from .path import coefficients_at, determinant_along
from .value import ROUND_OFF

MOST_STEPS = 15
FARTHEST = 20.0
"""A step in units of the given scale beyond which Newton's method has failed."""
SETTLED = 4.0
"""A last step in units of the rounding error that ends the iteration."""
DIFFERENCE = 1e-5
"""Relative step of the differences in the Jacobian, which need not be accurate."""

Point = tuple[float, float, float, float]
"""(eta or x, p, error of the first, error of p); nan where the method failed."""


@compiled
def crossing_newton(
    eta: float, p: float, origin: Coefficients, direction: Coefficients, scale: tuple[float, float]
) -> Point:
    """The zero of D(i eta; p) near (eta, p), with an error estimate from rounding and the last step."""
    failed = (math.nan, math.nan, math.nan, math.nan)
    last = math.inf
    for _ in range(MOST_STEPS):
        coefficients = coefficients_at(p, origin, direction)
        D, D_w, D_p, _, noise = determinant_along(complex(0.0, eta), coefficients, direction)
        a = 1j * D_w
        cross = (a * D_p.conjugate()).imag
        if cross == 0:
            return failed
        in_eta = -(D * D_p.conjugate()).imag / cross
        in_p = (D * a.conjugate()).imag / cross
        # p itself is a rounded number: D cannot tell p from its neighbours.
        blur = noise + ROUND_OFF * (abs(p * D_p) + abs(eta * D_w))
        e_eta, e_p = blur * abs(D_p) / abs(cross), blur * abs(a) / abs(cross)
        step = max(abs(in_eta) / scale[0], abs(in_p) / scale[1])
        if not step < FARTHEST or not eta + in_eta > 0:
            return failed
        eta += in_eta
        p += in_p
        if (abs(in_eta) <= SETTLED * e_eta and abs(in_p) <= SETTLED * e_p) or (
            step > last / 2 and step * scale[1] < 1e-9 * abs(p)
        ):
            return eta, p, max(e_eta, abs(in_eta)), max(e_p, abs(in_p))
        last = step
    return failed


@compiled
def double_newton(x: float, p: float, origin: Coefficients, direction: Coefficients, reach: float) -> Point:
    """The double real eigenvalue near (x, p): D = D_w = 0, p at most `reach` away."""
    failed = (math.nan, math.nan, math.nan, math.nan)
    start, first, last = x, p, math.inf
    for _ in range(2 * MOST_STEPS):
        D, D_w, D_p, S, noise = _real(x, p, origin, direction)
        h, k = DIFFERENCE * abs(x), DIFFERENCE * reach
        _, right, _, S_right, _ = _real(x + h, p, origin, direction)
        _, left, _, S_left, _ = _real(x - h, p, origin, direction)
        _, after, _, S_after, _ = _real(x, p + k, origin, direction)
        _, before, _, S_before, _ = _real(x, p - k, origin, direction)
        D_ww = (right * math.exp(S_right - S) - left * math.exp(S_left - S)) / (2 * h)
        D_wp = (after * math.exp(S_after - S) - before * math.exp(S_before - S)) / (2 * k)
        cross = D_w * D_wp - D_p * D_ww
        if cross == 0 or not math.isfinite(cross):
            return failed
        in_x = (D_p * D_w - D_wp * D) / cross
        in_p = (D_ww * D - D_w * D_w) / cross
        blur = noise + ROUND_OFF * abs(p * D_p)
        e_p = blur * abs(D_ww) / abs(cross)
        e_x = (blur * abs(D_wp) + noise / max(abs(x), 1e-300) * abs(D_p)) / abs(cross)
        x += in_x
        p += in_p
        if not abs(p - first) <= 2 * reach or not x * start > 0:
            return failed
        if abs(in_p) <= SETTLED * e_p and (abs(in_x) <= SETTLED * e_x or abs(in_x) > last / 2):
            return x, p, max(e_x, abs(in_x)), max(e_p, abs(in_p))
        last = abs(in_x)
    return failed


@compiled
def _real(
    x: float, p: float, origin: Coefficients, direction: Coefficients
) -> tuple[float, float, float, float, float]:
    """`determinant_along` at real w = x, where D is real."""
    D, D_w, D_p, S, noise = determinant_along(
        complex(x, 0.0), coefficients_at(p, origin, direction), direction
    )
    return D.real, D_w.real, D_p.real, S, noise


@compiled
def eigenvalue_newton(
    w: complex, coefficients: Coefficients, direction: Coefficients
) -> tuple[complex, complex, float]:
    """(w, dw/dp, error of w): a simple eigenvalue from a close guess; a real guess stays real."""
    real = w.imag == 0
    D, D_w, D_p, _, noise = determinant_along(w, coefficients, direction)
    step = math.inf
    for _ in range(MOST_STEPS):
        move = -D / D_w
        if real:
            move = complex(move.real, 0.0)
        if not abs(move) < step / 2:  # it no longer converges: rounding
            break
        step = abs(move)
        w += move
        D, D_w, D_p, _, noise = determinant_along(w, coefficients, direction)
    return w, -D_p / D_w, max(abs(D), noise) / abs(D_w)
