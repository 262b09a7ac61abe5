"""How many transverse eigenvalues lie right of a vertical line: a count without mesh or shift.

All eigenvalues with Re w >= -depth lie in the box of `rodsweep.model.bounds`, so their number is
the winding number of the entire function D around it. D is real on the real axis, so the upper half
of the box suffices: count = (change of arg D along it)/pi.

The change of phase from one node to the next is proved, not presumed. About a node c the function
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

from ..model.bounds import eigenvalue_box
from ..model.compilation import compiled
from ..model.determinant import branches, scaled_determinant
from ..model.rod import Coefficients, Rod

ROUNDING_OF_D = 4.0
"""Rounding error of D in units of its noise: below 0.5 at 2000 values chosen to be bad, and room."""
CLEARANCE = 0.9
"""Share of |D| that the proved change may use up."""
SMALLEST_REACH = 1e-13
"""Reach in units of |w| below which the line is taken to run through a zero of D."""
MOST_NODES = 20_000
"""Nodes on one edge before the count is given up; the paper's rods need about 150."""
HUGE = 600.0
"""Exponents are cut here before exp, which would overflow at 709."""


@dataclass(frozen=True, slots=True)
class Count:
    """Number of eigenvalues with Re w > line, or why there is none (`number` is None)."""

    number: int | None
    nodes: int
    why_not: str = ""


@compiled
def term_on_disc(z: complex, slope: complex, L: complex, rho: float, bend: float, S: float) -> float:
    """Bound of |E(z(w)) exp(-L (w - c))| exp(-S) for |w - c| <= rho, without the factor |w z'|/2.

    Two bounds of the exponents +-sqrt(z) - L (w - c), the smaller counts: one from |sqrt(z)| alone,
    one from its Taylor polynomial, where the disc stays away from z = 0. `bend` bounds the part of
    z(w) - z(c) beyond the linear one.
    """
    root = cmath.sqrt(z)
    drift = abs(L) * rho
    change = abs(slope) * rho + bend
    crude = math.sqrt(max((abs(z) + z.real) / 2 + change, 0.0)) + drift
    grow = crude
    decay = crude
    if change < 0.5 * abs(z):
        rate = slope / (2 * root)
        x = change / abs(z)
        curve = bend / (2 * abs(root)) + abs(root) * x * x / (8 * (1 - x))
        grow = min(grow, root.real + abs(rate - L) * rho + curve)
        decay = min(decay, -root.real + abs(rate + L) * rho + curve)
    small = min(1.0, 4 / (abs(z) - change)) if abs(z) > change else 1.0
    exponentials = math.exp(min(grow - S, HUGE)) + math.exp(min(decay - S, HUGE))
    return small / 8 * (exponentials + 2 * math.exp(min(drift - S, HUGE)))


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
def reach(w: complex, coefficients: Coefficients) -> tuple[complex, complex, float]:
    """(D exp(-S), L = D'/D, r): no zero of D lies within r of w, and f turns by less than pi/2."""
    F, nu, c2, gamma3 = coefficients
    D, D1, S, noise = scaled_determinant(w, coefficients)
    room = CLEARANCE * abs(D) - ROUNDING_OF_D * noise
    L = D1 / D
    if not room > 0:
        return D, L, 0.0
    P, P1, _, plus, minus = branches(w, coefficients)
    cg = c2 * gamma3
    gn = (nu + F * c2) * nu
    best = 0.0
    rho = radius(w, coefficients, L, S)
    for _ in range(2):
        # w = c (1 + e1) and g nu + cg w = (...)(1 + e2) with |e1|, |e2| <= eta over the disc.
        eta = rho / abs(w)
        if cg > 0:
            eta = max(eta, rho * cg / abs(gn + cg * w))
        bend = 2 * abs(P) * ((2 - math.sqrt(1 - eta)) ** 2 - 1 - eta)
        steepest = c2 + gamma3
        if P != 0:
            steepest += (abs(gn + 2 * cg * w) + 2 * cg * rho) / (abs(P) * (1 - eta))
        terms = term_on_disc(plus, c2 + gamma3 + 2 * P1, L, rho, bend, S)
        terms += term_on_disc(minus, c2 + gamma3 - 2 * P1, L, rho, bend, S)
        M = math.exp(min(abs(L) * rho - S, HUGE)) + (abs(w) + rho) / 2 * steepest * terms
        q = room / M
        best = max(best, rho * (math.sqrt(q * q + 4 * q) - q) / 2)
        rho /= 2
    return D, L, best


@compiled
def phase_change(
    start: complex, end: complex, coefficients: Coefficients, most_nodes: int
) -> tuple[float, int]:
    """(change of arg D along the segment, nodes used); the nodes are negative where it failed."""
    length = abs(end - start)
    direction = (end - start) / length
    t = 0.0
    D, L, r = reach(start, coefficients)
    w = start
    total = 0.0
    nodes = 1
    while t < length:
        if not r > SMALLEST_REACH * abs(w) or nodes > most_nodes:
            return 0.0, -nodes
        # The next node may lie beyond this one's reach if it reaches back; otherwise step inside.
        ahead = min(1.9 * r, length - t)
        while True:
            inside = ahead < r
            w_next = start + direction * (t + ahead) if ahead < length - t else end
            D_next, L_next, r_next = reach(w_next, coefficients)
            nodes += 1
            if inside or abs(w_next - w) < max(r, r_next):
                break
            ahead = 0.999 * r
        turn = ((L if r >= r_next else L_next) * (w_next - w)).imag
        total += turn + cmath.phase(D_next / D * cmath.exp(complex(0.0, -turn)))
        t = length if w_next == end else t + ahead
        w, D, L, r = w_next, D_next, L_next, r_next
    return total, nodes


def count_right_of(line: float, rod: Rod) -> Count:
    """Number of transverse eigenvalues of `rod` with Re w > line, for a line <= 0 or above.

    Raises nothing: what cannot be proved is a Count without a number.
    """
    real, imag = eigenvalue_box(rod, max(-line, 0.0))
    if not math.isfinite(imag) or not math.isfinite(real):
        return Count(None, 0, "no a-priori bound on the eigenvalues applies")
    if line >= real:
        return Count(0, 0)
    if line == 0.0:
        raise ValueError("w = 0 is a branch point of the exponents: choose a line beside it")
    corners = (complex(real, 0), complex(real, imag), complex(line, imag), complex(line, 0))
    total, nodes = 0.0, 0
    for start, end in zip(corners[:-1], corners[1:], strict=True):
        change, used = phase_change(start, end, rod.coefficients, MOST_NODES)
        nodes += abs(used)
        if used < 0:
            return Count(None, nodes, "an eigenvalue lies too close to the line, or the box is too large")
        total += change
    number = round(total / math.pi)
    if abs(total / math.pi - number) > 1e-3:
        return Count(None, nodes, "the winding number is not an integer within rounding")
    return Count(number, nodes)
