"""Nodes of a count: the direction of D at a point, and how far its tangent is valid.

The tangent of log D at w is log D(w) + L (v - w), L = D'/D. Outside the hull of the spectrum its validity is
proved from D'/D alone. D is entire of order 1/2, so that D = prod (1 - w/w_n), and with the distance d of w
from the hull and the unit normal n towards w

    Re(n L) = sum <n, w - w_n>/|w - w_n|^2 >= d S,   S = sum 1/|w - w_n|^2,
    |log D(v) - log D(w) - L (v - w)| <= S r^2/2/(1 - r/d)^2,   r = |v - w|.

Inside the hull, f(v) = D(v) exp(-L (v - w)) has f'(w) = 0, and Cauchy's estimate with the maximum of |f| on a
circle bounds the change of f. The maximum is estimated from `CIRCLE` points and a safety factor.
"""

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Complex
from ...model.compiled.compilation import compiled
from ..value import Value
from .determinant import Level
from .region import Hull, clearance
from .value import chain_size, chain_value

LARGEST_TURN = 1.5
"""Largest allowed error of a tangent's phase, in radians. The errors of two tangents then sum to less than
pi."""
CIRCLE = 8
"""Points of a circle about a node inside the hull."""
BETWEEN_POINTS = 1.5
"""Safety factor on the maximum of |f| over the points of a circle, for larger values between the points."""
CLEARANCE = 0.9
"""Largest allowed change of f, in units of |D|."""
ROUNDING_OF_ARM_D = 100.0
"""Bound of the rounding error of D, in units of its noise; a node needs a larger |D|."""
FIRST_RADIUS, SMALLEST_RADIUS, LARGEST_RADIUS = 12.0, 0.75, 48.0
"""Radii of circles to try, in units of the length over which D changes: the first at the first node of a
side, and the smallest and largest at any node. Every trial halves the radius."""
STEEPEST = 1.0
"""Largest |L| times the unit of the radii, so that circles shrink with the distance to a zero of D."""
GIVEN_UP = 0.2
"""A circle is given up for the next smaller one once its reach is below this fraction of its radius: the
smaller one may reach 0.27 of the radius."""
UNIT_CIRCLE: Complex = np.exp(2j * np.pi * (np.array([0, 2, 1, 3, 4, 6, 5, 7]) + 0.5) / CIRCLE)
"""Directions of the points; the first four differ most in (v - w)^2, so that most circles too large for f are
given up after one or two points."""


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
    if not abs(value.D) > ROUNDING_OF_ARM_D * value.noise:
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
        reach = 1 / (1 / distance + math.sqrt(S / (2 * LARGEST_TURN)))
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

    tangent: (w, L). For the other arguments see `_node`.
    """
    w, L = tangent
    unit = min(trial[0], STEEPEST / max(abs(L), 1e-300))
    room = CLEARANCE - ROUNDING_OF_ARM_D * value.noise / abs(value.D)
    here = math.log(abs(value.D)) + value.S - _log_of_known(w, known)
    best = 0.0
    best_radius = 0.0
    radius = max(trial[1], SMALLEST_RADIUS)
    while radius >= SMALLEST_RADIUS:
        rho = radius * unit
        # No smaller circle reaches farther than half of this one could.
        enough = max(best, _reach_of_circle(rho / 2, BETWEEN_POINTS, room))
        last = radius / 2 < SMALLEST_RADIUS
        reach = math.inf
        size = -math.inf  # log of the largest |f| of the points of the circle
        for direction in UNIT_CIRCLE:
            v = w + rho * direction
            log = chain_size(v, level[0], level[1]) - _log_of_known(v, known)
            size = max(size, log - (L * (v - w)).real)
            M = BETWEEN_POINTS * math.exp(min(size - here, 700.0))
            reach = _reach_of_circle(rho, M, room)
            if reach <= best or (reach < GIVEN_UP * rho and not last):
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
        total += math.log(max(abs(v - known[n]), 1e-300))
    return total
