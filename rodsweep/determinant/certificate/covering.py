"""All crossings of the imaginary axis along a path of rods, with a proof that none is missed.

Along a path p -> rod a pair crosses where D(i eta; p) = 0, two real equations in (eta, p). The part of
the (eta, p) plane that the a-priori bounds leave is divided into boxes until each is

* empty: with its centre c and half-widths (h_w, h_p), f = D exp(-L dw - K dp) is at most M in the
  bidisc of radii (h_w, h_p)/t, so that by Cauchy's estimate on complex lines

      |f - f(c) - f'(c)(dw, dp)| <= M t^2/(1 - t)   in the box,

  and that is less than the distance of the parallelogram f(c) + f'(c)(box) from zero; or
* regular: Cauchy's estimate of the second derivatives shows that the box, doubled, holds at most one
  zero, and Newton's method finds it; or
* open: as small as rounding allows, which happens where two crossings are about to meet.

(L, K) is the logarithmic derivative of D, which makes f'(c) vanish, or the mean growth rate of its
exponentials, which stays bounded near a zero of D.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.rod import Coefficients
from ..newton import FAILED, Zero, crossing_newton
from ..parameter_path import Path, changes, coefficients_at, determinant_along
from .box import MARGIN, quiet_radius, squared_amplification_over
from .discs import CLEARANCE, ROUNDING_OF_D, Centre, Pair, bound_on_bidisc, centre_at

SLABS = 8
"""Least number of intervals of p to start from."""
FIRST_RATIO = 4.0
"""Ratio of the ends of the boxes in eta to start from."""
LARGEST_SHARE, NEXT_SHARE, MOST_SHARES = 0.45, 0.6, 30
"""Share t of the bidisc that a box takes up: the largest tried, the ratio to the next, how many."""
SMALLEST_BOX = 1e-9
"""Half-widths in units of eta and p below which a box is left open."""
MOST_BOXES = 1_000_000
SAME_ZERO = 1.5
"""Distance from the centre of a regular box, in half-widths, within which a zero known before is the same."""
EMPTY, REGULAR, UNDECIDED = 0, 1, 2
"""What is known of a box."""


class Box(NamedTuple):
    """A rectangle of the (eta, p) plane."""

    eta_from: float
    eta_to: float
    p_from: float
    p_to: float


@compiled
def distance(value: complex, a: complex, b: complex) -> float:
    """A lower bound of |value + x a + y b| over |x|, |y| <= 1, sharp where it is not zero."""
    best = 0.0
    for normal in (value, 1j * a, 1j * b):
        size = abs(normal)
        if size > 0:
            u = normal.conjugate() / size
            best = max(best, abs((u * value).real) - abs((u * a).real) - abs((u * b).real))
    return best


@compiled
def mean_rates(centre: Centre) -> Pair:
    """(L, K): d sqrt(z)/dw and d sqrt(z)/dp, averaged with the sizes of the two exponentials."""
    root_plus, root_minus = cmath.sqrt(centre.plus), cmath.sqrt(centre.minus)
    a, b = math.exp(root_plus.real - centre.S), math.exp(root_minus.real - centre.S)
    a, b = a / (a + b), b / (a + b)
    in_w = a * centre.slopes_plus[0] / (2 * root_plus) + b * centre.slopes_minus[0] / (2 * root_minus)
    return in_w, a * centre.slopes_plus[1] / (2 * root_plus) + b * centre.slopes_minus[1] / (2 * root_minus)


@compiled
def remainder(centre: Centre, rates: Pair, half: tuple[float, float], room: float, power: int) -> bool:
    """Whether M t^2/(1 - t)^power < room for some bidisc about the box."""
    t, last = LARGEST_SHARE, math.inf
    for _ in range(MOST_SHARES):
        M = bound_on_bidisc(centre, rates, (half[0] / t, half[1] / t))
        rest = M * t * t / (1 - t) ** power
        if rest < room:
            return True
        if rest > last:
            return False
        last = rest
        t *= NEXT_SHARE
    return False


@compiled
def examine(
    w: complex, coefficients: Coefficients, direction: Coefficients, half: tuple[float, float]
) -> tuple[int, float, float]:
    """(kind, cost in eta, cost in p) of the box about w.

    The costs say how much the exponents change over the box in either variable.
    """
    D, D_w, D_p, S, noise = determinant_along(w, coefficients, direction)
    centre = centre_at(w, coefficients, changes(coefficients, direction), S)
    mean = mean_rates(centre)
    rounding = ROUNDING_OF_D * noise
    if abs(D) > 2 * rounding:
        for rates in ((D_w / D, D_p / D), mean):
            a, b = 1j * (D_w - rates[0] * D) * half[0], (D_p - rates[1] * D) * half[1]
            room = CLEARANCE * distance(D, a, b) - rounding
            if room > 0 and remainder(centre, rates, half, room, 1):
                return EMPTY, 0.0, 0.0
    # In the doubled box the derivatives of f change by at most 3 M t^2/(1 - t)^2 each.
    a, b = 2j * (D_w - mean[0] * D) * half[0], 2 * (D_p - mean[1] * D) * half[1]
    if abs(D) < 2 * (abs(a) + abs(b)):
        least = abs((a * b.conjugate()).imag) / (abs(a) + abs(b))
        room = (CLEARANCE * least - rounding) / 3
        double = (2 * half[0], 2 * half[1])
        if room > 0 and remainder(centre, mean, double, room, 2):
            return REGULAR, 0.0, 0.0
    in_eta, in_p = costs(centre, half)
    return UNDECIDED, in_eta, in_p


@compiled
def costs(centre: Centre, half: tuple[float, float]) -> tuple[float, float]:
    """How much the exponents change over a box in eta and in p."""
    F, nu, c2, gamma3 = centre.coefficients
    size = abs(centre.w)
    root_plus, root_minus = math.sqrt(max(abs(centre.plus), 1.0)), math.sqrt(max(abs(centre.minus), 1.0))
    plus, minus = centre.slopes_plus, centre.slopes_minus
    in_w = max(abs(plus[0]) / root_plus, abs(minus[0]) / root_minus) * half[0] / 2
    in_p = max(abs(plus[1]) / root_plus, abs(minus[1]) / root_minus) * half[1] / 2
    stiffness = abs((nu + F * c2) * nu) + c2 * gamma3 * size
    factor = abs(centre.changes.G1) + abs(centre.changes.X1) * size
    return max(in_w, half[0] / size), max(in_p, factor * half[1] / max(stiffness, 1e-300))


@compiled
def cover(first: Array, origin: Coefficients, direction: Coefficients) -> tuple[list[Zero], list[Box], int]:
    """(zeros, open boxes, boxes examined) of D(i eta; p) in the boxes `first`, shape (n, 4)."""
    stack = [Box(first[i, 0], first[i, 1], first[i, 2], first[i, 3]) for i in range(len(first))]
    zeros = [FAILED for _ in range(0)]
    left = [Box(0.0, 0.0, 0.0, 0.0) for _ in range(0)]
    examined = 0
    while len(stack) > 0:
        box = stack.pop()
        eta, p = (box.eta_from + box.eta_to) / 2, (box.p_from + box.p_to) / 2
        half = (box.eta_to - box.eta_from) / 2, (box.p_to - box.p_from) / 2
        examined += 1
        coefficients = coefficients_at(p, origin, direction)
        kind, cost_w, cost_p = examine(complex(0.0, eta), coefficients, direction, half)
        if kind == EMPTY:
            continue
        if kind == REGULAR:
            zero = crossing_newton(eta, p, origin, direction, half)
            away = _away(zero, eta, p, half)
            if away <= 2:  # false where Newton's method failed, which returns nan
                seen = away > 1.01  # then a neighbouring box finds it too
                for other in zeros:  # the doubled box holds one zero at most
                    seen = seen or _away(other, eta, p, half) <= SAME_ZERO
                if not seen:
                    zeros.append(zero)
                continue
        if examined > MOST_BOXES or (half[0] < SMALLEST_BOX * eta and half[1] < SMALLEST_BOX * abs(p)):
            left.append(box)
        elif cost_w >= cost_p:
            stack.append(Box(box.eta_from, eta, box.p_from, box.p_to))
            stack.append(Box(eta, box.eta_to, box.p_from, box.p_to))
        else:
            stack.append(Box(box.eta_from, box.eta_to, box.p_from, p))
            stack.append(Box(box.eta_from, box.eta_to, p, box.p_to))
    return zeros, left, examined


@compiled
def _away(zero: Zero, eta: float, p: float, half: tuple[float, float]) -> float:
    """How far a zero is from the centre of a box, in half-widths."""
    return max(abs(zero.eta_or_x - eta) / half[0], abs(zero.p - p) / half[1])


def slabs(path: Path, start: float, stop: float) -> list[tuple[float, float]]:
    """Intervals of p from start to stop over which the rod changes by a factor of order one at most."""
    edges = [start]
    width = (stop - start) / SLABS
    while edges[-1] < stop:
        p = edges[-1]
        step = width
        nu, slope = coefficients_at(p, path.origin, path.direction).nu, path.direction.nu
        if slope < 0:  # the rod is crushed where nu = 0
            step = min(step, 0.5 * nu / -slope)
        if path.name != "F":  # drag and compliances over decades
            step = min(step, max(p, 1e-6 * width))
        end = p + step
        edges.append(stop if stop - end < 1e-3 * step else end)
    return list(zip(edges[:-1], edges[1:], strict=True))


def first_boxes(path: Path, start: float, stop: float) -> Array | None:
    """Boxes that hold every crossing with p from start to stop, shape (n, 4); None without a bound."""
    boxes = []
    for a, b in slabs(path, start, stop):
        top = MARGIN * squared_amplification_over(path, a, b) + 1e-6
        if not math.isfinite(top):
            return None
        low = quiet_radius(path, a, b, top)
        if low == 0.0:
            return None
        count = max(1, math.ceil(math.log(top / low) / math.log(FIRST_RATIO)))
        edges = np.geomspace(low, top, count + 1)
        boxes += [(edges[i], edges[i + 1], a, b) for i in range(count)]
    return np.array(boxes).reshape(-1, 4)
