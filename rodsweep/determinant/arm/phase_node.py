"""Nodes of a count: the direction of D at a point, and how far its tangent is valid.

The tangent of log D at w is log D(w) + L (v - w), L = D'/D. Outside the hull of the spectrum its validity is
proved from D'/D alone. D is entire of order 1/2, so that D = prod (1 - w/w_n), and with the distance d of w
from the hull and the unit normal n towards w

    Re(n L) = sum <n, w - w_n>/|w - w_n|^2 >= d S,   S = sum 1/|w - w_n|^2,
    |log D(v) - log D(w) - L (v - w)| <= S r^2/2/(1 - r/d)^2,   r = |v - w|.

Inside the hull, f(v) = D(v) exp(-L (v - w)) has f'(w) = 0, and Cauchy's estimate with the maximum of |f| on a
circle bounds the change of f. The maximum is estimated from some points and a safety factor.
"""

import math
from typing import NamedTuple

from ...arrays import Complex
from ...model.compiled.compilation import compiled
from ..exponents import EXPONENTS
from ..value import Value
from .count_settings import ARM_COUNT
from .determinant import Level
from .region import Hull, clearance
from .value import chain_size, chain_value


class PhaseNode(NamedTuple):
    """A point w with the direction of D, L = D'/D, both without known eigenvalues, and the validity of the
    tangent.

    reach: distance within which the tangent is valid. radius: radius of the best circle, in units of the
    length over which D changes, or 0.
    """

    w: complex
    direction: complex
    L: complex
    reach: float
    radius: float


@compiled
def phase_node(w: complex, known: Complex, trial: tuple[float, float], hull: Hull, level: Level) -> PhaseNode:
    """The node about w.

    trial: (length over which D changes, largest radius in units of it). level: (W, propagators) for |v| <= W,
    which hold the largest circle about w.
    """
    value = chain_value(w, level[0], level[1])
    if not abs(value.D) > ARM_COUNT.rounding * value.noise:
        return PhaseNode(w, value.D, 0j, 0.0, 0.0)
    direction = value.D / abs(value.D)
    L = value.D_w / value.D
    for n in range(len(known)):
        away = w - known[n]
        direction *= away.conjugate() / abs(away)
        L -= 1 / away
    distance, normal = clearance(complex(w.real, abs(w.imag)), hull.a, hull.c)
    reach = 0.0
    radius = 0.0
    if distance > 0:
        S = max((normal * L).real, 0.0) / distance
        reach = 1 / (1 / distance + math.sqrt(S / (2 * ARM_COUNT.largest_turn)))
    if not reach > trial[0]:
        inside, radius = _reach_inside(value, (w, L), known, trial, level)
        reach = max(reach, inside)
    return PhaseNode(w, direction, L, reach, radius)


@compiled
def _reach_inside(
    value: Value,
    tangent: tuple[complex, complex],
    known: Complex,
    trial: tuple[float, float],
    level: Level,
) -> tuple[float, float]:
    """(reach of a node inside the hull, best radius), from the largest |f| on circles.

    tangent: (w, L). For the other arguments see `phase_node`.
    """
    w, L = tangent
    unit = min(trial[0], ARM_COUNT.steepest / max(abs(L), EXPONENTS.least_divisor))
    room = ARM_COUNT.clearance - ARM_COUNT.rounding * value.noise / abs(value.D)
    here = math.log(abs(value.D)) + value.S - _log_of_known(w, known)
    best = 0.0
    best_radius = 0.0
    radius = max(trial[1], ARM_COUNT.smallest_radius)
    while radius >= ARM_COUNT.smallest_radius:
        rho = radius * unit
        # No smaller circle reaches farther than half of this one could.
        enough = max(best, _reach_of_circle(rho / 2, ARM_COUNT.between_points, room))
        last = radius / 2 < ARM_COUNT.smallest_radius
        reach = math.inf
        size = -math.inf  # log of the largest |f| of the points of the circle
        for direction in ARM_COUNT.directions:
            v = w + rho * direction
            log = chain_size(v, level[0], level[1]) - _log_of_known(v, known)
            size = max(size, log - (L * (v - w)).real)
            M = ARM_COUNT.between_points * math.exp(min(size - here, EXPONENTS.largest_exponent))
            reach = _reach_of_circle(rho, M, room)
            if reach <= best or (reach < ARM_COUNT.given_up * rho and not last):
                reach = 0.0
                break
        if reach > best:
            best = reach
            best_radius = radius
        elif best > 0:
            break
        if best >= enough:
            break
        radius /= 2
    return best, best_radius


@compiled
def _reach_of_circle(rho: float, M: float, room: float) -> float:
    """Distance within which f changes by less than `room`, in units of |D|, if |f| is at most M at rho."""
    q = room / M
    return rho * (math.sqrt(q * q + 4 * q) - q) / 2 if q > 0 else 0.0


@compiled
def _log_of_known(v: complex, known: Complex) -> float:
    """log prod |v - w_n| over known eigenvalues."""
    total = 0.0
    for n in range(len(known)):
        total += math.log(max(abs(v - known[n]), EXPONENTS.least_divisor))
    return total
