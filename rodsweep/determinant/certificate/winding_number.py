"""How many transverse eigenvalues lie right of a vertical line: a count without mesh or shift.

All eigenvalues with Re w >= -depth lie in the box of `rodsweep.determinant.certificate.box`, so their number
is the winding number of the entire function D around it. D is real on the real axis, so the upper half
of the box suffices: count = (change of arg D along it)/pi.

The change of phase is proved, not presumed: where one exponential of D outweighs the others in long strides
(`rodsweep.determinant.certificate.dominance`), elsewhere from node to node. About a node c the function
f(w) = D(w) exp(-L (w - c)), L = D'(c)/D(c), has f'(c) = 0, so by Cauchy's estimate on the disc of
radius rho, where |f| <= M,

    |f(w) - f(c)| <= M r^2/(rho (rho - r)),   r = |w - c|.

While that stays below 0.9 |D(c)|, less the rounding error of D, no zero lies within r and the phase
of f changes by less than pi/2. (The tenth that is left covers that the computed L, and with it f'(c),
is off by rounding.) A node `reaches` that far; a step is taken only where one of its two
ends reaches the other. Where no reach is left, a zero of D is closer to the line than the rounding
of D can tell, and the count is refused instead of guessed.
"""

import cmath
import math
from dataclasses import dataclass
from typing import NamedTuple

from ...model.compiled.compilation import compiled
from ...model.rod import Coefficients, Rod
from ..parameter_path import Changes
from ..value import branches, scaled_determinant
from .box import eigenvalue_box, quiet_radius_of
from .discs import CLEARANCE, ROUNDING_OF_D, bound_on_bidisc, centre_at
from .dominance import dominated_stretch

STILL = Changes(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""The changes along no path: a bound for one rod."""
WIDTH_FACTOR, WIDTH_ADDED, LEAST_HEIGHT = 4.0, 50.0, 0.5
"""Factor on the width of the box, width added to it, and its least height in units of the line's distance:
farther out one exponential of D outweighs the rest, and larger is cheaper."""
PATIENCE = 0.25
"""Length, in units of |w|, of what is walked node by node before larger discs are tried again; doubled where
they fail again."""
SMALLEST_REACH = 1e-13
"""Reach in units of |w| below which the line is taken to run through a zero of D."""
MOST_NODES = 20_000
"""Nodes on one edge before the count is given up; the paper's rods need about 30 in all."""


@dataclass(frozen=True, slots=True)
class Count:
    """Number of eigenvalues with Re w > line, or why there is none (`number` is None)."""

    number: int | None
    nodes: int
    why_not: str = ""


class Node(NamedTuple):
    """A point w: D exp(-S) there, L = D'/D, and how far it reaches: no zero of D is as near."""

    w: complex
    D: complex
    L: complex
    reach: float


@compiled
def radius(w: complex, coefficients: Coefficients, L: complex, S: float) -> float:
    """Largest disc about w that keeps off the branch points and keeps the exponents of order one."""
    F, nu, c2, gamma3 = coefficients
    _, P1, P2, plus, minus = branches(w, coefficients)
    stiffness = abs((nu + F * c2) * nu + c2 * gamma3 * w)
    rho = abs(w) / 3
    if c2 * gamma3 > 0:
        rho = min(rho, stiffness / (3 * c2 * gamma3))
    rho = min(rho, (S + 1) / max(abs(L), 1e-300))
    for sign, z in ((1.0, plus), (-1.0, minus)):
        slope = c2 + gamma3 + sign * 2 * P1
        root = cmath.sqrt(z)
        slack = S - root.real + 1
        rho = min(rho, 0.4 * max(abs(z), 2.0) / max(abs(slope), 1e-300))
        if abs(z) > 1e-3:
            rate = slope / (2 * root)
            rho = min(rho, slack / max(abs(rate - L), 1e-300))
            rho = min(rho, math.sqrt(2 * slack * abs(root) / (abs(P2) + abs(rate) ** 2)))
    return rho


@compiled
def node_at(w: complex, coefficients: Coefficients) -> Node:
    """The node about w; up to its reach f turns by less than pi/2."""
    D, D_w, S, noise = scaled_determinant(w, coefficients)
    room = CLEARANCE * abs(D) - ROUNDING_OF_D * noise
    if not room > 0:
        return Node(w, D, 0j, 0.0)
    L = D_w / D
    centre = centre_at(w, coefficients, STILL, S)
    best = 0.0
    rho = radius(w, coefficients, L, S)
    for _ in range(2):
        M = bound_on_bidisc(centre, (L, 0j), (rho, 0.0))
        q = room / M
        best = max(best, rho * (math.sqrt(q * q + 4 * q) - q) / 2)
        rho /= 2
    return Node(w, D, L, best)


@compiled
def phase_change(start: complex, end: complex, coefficients: Coefficients) -> tuple[float, int]:
    """(change of arg D along the segment, nodes used); the nodes are negative where it failed."""
    length = abs(end - start)
    direction = (end - start) / length
    t, total, nodes = 0.0, 0.0, 0
    patience = PATIENCE
    while t < length:
        w = start + direction * t
        ahead, change, discs = dominated_stretch(w, direction, length - t, coefficients)
        total += change
        nodes += discs
        patience = PATIENCE if ahead > 0 else 2 * patience
        t = length if ahead == length - t else t + ahead
        if t < length:
            w = start + direction * t
            goal = min(length, t + patience * abs(w))
            to = end if goal == length else start + direction * goal
            change, used = stepped_change(w, to, coefficients)
            nodes += abs(used)
            if used < 0 or nodes > MOST_NODES:
                return 0.0, -nodes
            total += change
            t = goal
    return total, nodes


@compiled
def stepped_change(start: complex, end: complex, coefficients: Coefficients) -> tuple[float, int]:
    """(change of arg D along the segment, nodes used); the nodes are negative where it failed."""
    length = abs(end - start)
    direction = (end - start) / length
    t, total, nodes = 0.0, 0.0, 1
    here = node_at(start, coefficients)
    while t < length:
        if not here.reach > SMALLEST_REACH * abs(here.w) or nodes > MOST_NODES:
            return 0.0, -nodes
        # The next node may lie beyond this one's reach if it reaches back; otherwise step inside.
        ahead = min(1.9 * here.reach, length - t)
        while True:
            inside = ahead < here.reach
            there = node_at(start + direction * (t + ahead) if ahead < length - t else end, coefficients)
            nodes += 1
            if inside or abs(there.w - here.w) < max(here.reach, there.reach):
                break
            ahead = 0.999 * here.reach
        turn = ((here.L if here.reach >= there.reach else there.L) * (there.w - here.w)).imag
        total += turn + cmath.phase(there.D / here.D * cmath.exp(complex(0.0, -turn)))
        t = length if there.w == end else t + ahead
        here = there
    return total, nodes


@compiled
def contour_change(
    line: float, foot: float, corner: complex, coefficients: Coefficients
) -> tuple[float, int]:
    """(change of arg D, nodes used) from the real axis up to the corner, left to the line, down to its foot.

    The nodes are negative where it failed.
    """
    top = complex(line, corner.imag)
    right, nodes = phase_change(complex(corner.real, 0.0), corner, coefficients)
    if nodes < 0:
        return 0.0, nodes
    above, used = phase_change(corner, top, coefficients)
    nodes += abs(used)
    if used < 0 or foot == corner.imag:  # then D is near 1 all along the line
        return right + above, nodes if used > 0 else -nodes
    # Upwards, because steps from the top could not resolve a foot below its rounding.
    left, used = phase_change(complex(line, foot), top, coefficients)
    nodes += abs(used)
    return right + above - left, nodes if used > 0 else -nodes


def count_right_of(line: float, rod: Rod) -> Count:
    """Number of transverse eigenvalues of `rod` with Re w > line, for a line <= 0 or above.

    Raises nothing: what cannot be proved is a Count without a number.
    """
    real, imag = eigenvalue_box(rod, max(-line, 0.0))
    if not math.isfinite(imag) or not math.isfinite(real):
        return Count(None, 0, "no a-priori bound on the eigenvalues applies")
    if line >= real:
        return Count(0, 0)
    foot, total = 0.0, 0.0
    if line == 0.0:  # D = 1 at the foot of the line: the rest of it, where D is near 1, needs no nodes
        foot = quiet_radius_of(rod.coefficients, imag)
        if foot == 0.0:
            return Count(None, 0, "the pull is so strong that numbers underflow")
        total = -cmath.phase(scaled_determinant(complex(0.0, foot), rod.coefficients)[0])
    real, imag = WIDTH_FACTOR * real + WIDTH_ADDED, max(imag, LEAST_HEIGHT * abs(line))
    change, nodes = contour_change(line, foot, complex(real, imag), rod.coefficients)
    if nodes < 0:
        return Count(None, -nodes, "an eigenvalue lies too close to the line, or the box is too large")
    total += change
    number = round(total / math.pi)
    if abs(total / math.pi - number) > 1e-3:
        return Count(None, nodes, "the winding number is not an integer within rounding")
    return Count(number, nodes)
