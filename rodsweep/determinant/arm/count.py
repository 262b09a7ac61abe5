"""Number of an arm's transverse eigenvalues right of a vertical line, without mesh or shift.

The number is the change of arg D along the upper half of a box that contains all these eigenvalues, divided
by pi, as in `rodsweep.determinant.certificate.winding_number`. The phase between two nodes follows from the
tangents log D(w) + L (v - w), L = D'/D, at both nodes, if each tangent is wrong by less than pi/2 where
the tangents meet.

Outside the hull of the spectrum this condition is proved from D'/D alone. D is entire of order 1/2, so that
D = prod (1 - w/w_n), and with the distance d of w from the hull and the unit normal n towards w

    Re(n L) = sum <n, w - w_n>/|w - w_n|^2 >= d S,   S = sum 1/|w - w_n|^2,
    |log D(v) - log D(w) - L (v - w)| <= S r^2/2/(1 - r/d)^2,   r = |v - w|.

Inside the hull, f(v) = D(v) exp(-L (v - w)) has f'(w) = 0, and Cauchy's estimate with the maximum of |f| on a
circle bounds the change of f. The maximum is estimated from some points and a safety factor. Inside the
hull the count is therefore an estimate; the rounding errors of D and the errors of its elements are estimates
everywhere.

Known eigenvalues are divided out: D above stands for D(w)/prod (w - w_n), whose zeros are far from the line.
The nodes are then few even between many unstable modes, and the known eigenvalues right of the line are added
to the count.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np

from ...arrays import Array, Complex
from ...model.compiled.compilation import compiled
from ..certificate.winding_number import COUNT, Count
from ..exponents import EXPONENTS
from ..value import Value
from .completeness import has_conjugate
from .count_settings import ARM_COUNT
from .determinant import ArmDeterminant
from .region import Hull, clearance
from .value import chain_size, chain_value

NONE_KNOWN: Complex = np.empty(0, complex)


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


class PhaseLost(ArithmeticError):
    """The change of phase could not be determined; nodes: number of nodes used."""

    def __init__(self, nodes: int):
        super().__init__("an eigenvalue lies too close to the line, or the box is too large")
        self.nodes = nodes


class DividedDeterminant(NamedTuple):
    """D without known eigenvalues, `known`, (n,), closed under conjugation, and a region with all others."""

    determinant: ArmDeterminant
    hull: Hull
    known: Complex


def count_right_of(
    line: float,
    determinant: ArmDeterminant,
    hull: Hull,
    known: Complex = NONE_KNOWN,
    error: Array | float = 0.0,
) -> Count:
    """The number of transverse eigenvalues with Re w > line, for any real line.

    known, error: some of the eigenvalues, (n,), and how far each may be off; with them the count is faster.
    Raises no error: a failed count is a Count without a number, with the reason.
    """
    if not math.isfinite(hull.a):
        return Count(None, 0, "no a-priori bound on the eigenvalues applies")
    if line >= hull.box(max(-line, 0.0))[0]:
        return Count(0, 0)
    corner = _corner(line, hull)
    top = complex(line, corner.imag)
    known = known[error < ARM_COUNT.sharp * np.abs(known.real - line)]
    known = known[has_conjugate(known)]
    divided = DividedDeterminant(determinant, hull, known)
    nodes = 0
    total = 0.0
    try:
        # Elements for the largest |w| first: they serve most others.
        determinant.level(largest_w_of_count(line, determinant, hull), ARM_COUNT.levels_above)
        for start, end in ((complex(corner.real, 0.0), corner), (corner, top), (top, complex(line, 0.0))):
            change, used = phase_change(start, end, divided)
            total += change
            nodes += used
    except PhaseLost as lost:
        return Count(None, nodes + lost.nodes, str(lost))
    except FloatingPointError as unresolved:
        return Count(None, nodes, str(unresolved))
    number = round(total / math.pi)
    if abs(total / math.pi - number) > COUNT.not_an_integer:
        return Count(None, nodes, "the winding number is not an integer within rounding")
    return Count(number + int((known.real > line).sum()), nodes)


def is_countable(determinant: ArmDeterminant, hull: Hull) -> bool:
    """Whether eigenvalues right of a line at most 0 can be counted: a bound is known, and D resolved."""
    if not math.isfinite(hull.a):
        return False
    try:
        determinant.level(abs(_corner(0.0, hull)), ARM_COUNT.levels_above)
    except FloatingPointError:
        return False
    return True


def largest_w_of_count(line: float, determinant: ArmDeterminant, hull: Hull) -> float:
    """The largest |w| at which a count right of a line evaluates D."""
    corner = _corner(line, hull)
    return abs(corner) + ARM_COUNT.first_radius * determinant.length(corner)


def _corner(line: float, hull: Hull) -> complex:
    """The corner of the box about all eigenvalues right of the line, with the largest |w|."""
    real, imag = hull.box(max(-line, 0.0))
    return complex(COUNT.width_factor * real + COUNT.width_added, max(imag, COUNT.least_height * abs(line)))


def phase_change(start: complex, end: complex, divided: DividedDeterminant) -> tuple[float, int]:
    """(change of arg D along the segment, nodes used); raises `PhaseLost` if the nodes do not connect.

    D is without the known eigenvalues.
    """
    length = abs(end - start)
    direction = (end - start) / length
    t = 0.0
    total = 0.0
    nodes = 1
    growth = 0.0  # change of the reach per distance
    here = node_at(start, divided, ARM_COUNT.first_radius)
    while t < length:
        if not here.reach > ARM_COUNT.smallest_reach * abs(here.w) or nodes > ARM_COUNT.max_nodes:
            raise PhaseLost(nodes)
        ahead = min(_stride(here.reach, growth), length - t)
        radius = min(2 * here.radius, ARM_COUNT.largest_radius) if here.radius > 0 else ARM_COUNT.first_radius
        while True:
            w = end if ahead == length - t else start + direction * (t + ahead)
            there = node_at(w, divided, radius)
            nodes += 1
            growth = (there.reach - here.reach) / ahead
            if abs(there.w - here.w) < here.reach + there.reach:
                break
            # The reaches leave a gap: place the next node closer, at last within the present one's reach.
            nearer = min(_stride(here.reach, growth), ARM_COUNT.closer * ahead)
            ahead = nearer if nearer > here.reach else min(ARM_COUNT.within_reach * here.reach, ahead / 2)
        total += _turn(here, there)
        t = length if there.w == end else t + ahead
        here = there
    return total, nodes


def _stride(reach: float, growth: float) -> float:
    """Distance at which the reaches of two nodes just overlap, if they grow by `growth` per distance."""
    overlap = ARM_COUNT.overlap
    return 2 * overlap * reach / (1 - overlap * min(max(growth, -1.0), ARM_COUNT.largest_growth))


def _turn(here: PhaseNode, there: PhaseNode) -> float:
    """The change of arg D between two nodes whose reaches overlap."""
    step = there.w - here.w
    share = here.reach / (here.reach + there.reach)
    # The tangents at both nodes predict the turn. D gives the remainder, which is below half a turn because
    # the reaches overlap.
    expected = (here.L * step * share + there.L * step * (1 - share)).imag
    return expected + cmath.phase(there.direction / here.direction * cmath.exp(complex(0.0, -expected)))


def node_at(w: complex, divided: DividedDeterminant, radius: float) -> PhaseNode:
    """The node at w; its reach is 0 if rounding errors hide D.

    radius: radius of the largest circle to try, in units of the length over which D changes.
    """
    determinant, hull, known = divided
    length = determinant.length(w)
    level = determinant.level(
        abs(w) + max(radius, ARM_COUNT.smallest_radius) * length, ARM_COUNT.levels_above
    )
    return _node(w, known, (length, radius), hull, level)


@compiled
def _node(
    w: complex, known: Complex, trial: tuple[float, float], hull: Hull, level: tuple[float, Array]
) -> PhaseNode:
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
    level: tuple[float, Array],
) -> tuple[float, float]:
    """(reach of a node inside the hull, best radius), from the largest |f| on circles.

    tangent: (w, L). For the other arguments see `_node`.
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
