"""Number of an arm's transverse eigenvalues right of a vertical line, without mesh or shift.

The number is the change of arg D along the upper half of a box that contains all these eigenvalues, divided
by pi, as in `rodsweep.determinant.certificate.winding_number`. The phase between two nodes follows from what
both say about D around them (`rodsweep.determinant.arm.phase_node`).

Known eigenvalues close to the line are divided out: D above stands for D(w)/prod (w - w_n), whose zeros are
far from the line. Those of them right of the line are added to the count.
"""

import cmath
import math

import numpy as np

from ...arrays import Array, Complex
from ..certificate.winding_number import COUNT, Count
from .completeness import has_conjugate
from .determinant import ArmDeterminant
from .dominant_wave import ArmSamples
from .phase_node import FIRST_RADIUS, LEVELS_ABOVE, DividedDeterminant, PhaseNode, node_at, tangent
from .region import Hull

SHARP = 1e-3
"""Largest error of an eigenvalue that is divided out, in units of its distance from the line."""
CLOSE_TO_LINE = 1.0
"""Largest distance from the line of eigenvalues that are divided out, in units of their height above the real
axis, or of |line|: without farther ones D would follow its dominant wave no more."""
NONE_KNOWN: Complex = np.empty(0, complex)
SMALLEST_ARM_REACH = 1e-12
"""Reach in units of |w| below which the line counts as running through a zero of D."""
MAX_NODES = 5000
"""Maximum nodes on one side of the box; cones with tapers from 0.1 to 1 need 15 to 210 on all sides."""
OVERLAP = 0.95
"""Distance of two nodes in units of the sum of their expected reaches."""
LARGEST_GROWTH = 0.5
"""Largest expected growth of the reach per distance: the next node is 3.6 reaches ahead at most."""


class PhaseLost(ArithmeticError):
    """The change of phase could not be determined; nodes: number of nodes used."""

    def __init__(self, nodes: int):
        super().__init__("an eigenvalue lies too close to the line, or the box is too large")
        self.nodes = nodes


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
    known = known[error < SHARP * np.abs(known.real - line)]
    known = known[has_conjugate(known)]
    height = np.maximum(np.abs(known.imag), abs(line))
    known = known[np.abs(known.real - line) < CLOSE_TO_LINE * height]
    largest = largest_w_of_count(line, determinant, hull)
    divided = DividedDeterminant(determinant, hull, known, largest)
    nodes = 0
    total = 0.0
    try:
        # Elements for the largest |w| first: they serve most others.
        determinant.level(largest, LEVELS_ABOVE)
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
        determinant.level(abs(_corner(0.0, hull)), LEVELS_ABOVE)
    except FloatingPointError:
        return False
    return True


def largest_w_of_count(line: float, determinant: ArmDeterminant, hull: Hull) -> float:
    """The largest |w| at which a count right of a line evaluates D."""
    corner = _corner(line, hull)
    return abs(corner) + FIRST_RADIUS * determinant.length(corner)


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
    here = node_at(start, divided)
    while t < length:
        if not here.reach > SMALLEST_ARM_REACH * abs(here.w) or nodes > MAX_NODES:
            raise PhaseLost(nodes)
        ahead = min(_stride(here.reach, growth), length - t)
        while True:
            w = end if ahead == length - t else start + direction * (t + ahead)
            there = node_at(w, divided, 2 * here.radius)
            nodes += 1
            growth = (there.reach - here.reach) / ahead
            if abs(there.w - here.w) < here.reach + there.reach:
                break
            # The reaches leave a gap: place the next node closer, at last within the present one's reach.
            nearer = min(_stride(here.reach, growth), 0.9 * ahead)
            ahead = nearer if nearer > here.reach else min(0.99 * here.reach, ahead / 2)
        total += _turn(here, there, divided.determinant.gauss_samples)
        t = length if there.w == end else t + ahead
        here = there
    return total, nodes


def _stride(reach: float, growth: float) -> float:
    """Distance at which the reaches of two nodes just overlap, if they grow by `growth` per distance."""
    return 2 * OVERLAP * reach / (1 - OVERLAP * min(max(growth, -1.0), LARGEST_GROWTH))


def _turn(here: PhaseNode, there: PhaseNode, samples: ArmSamples) -> float:
    """The change of arg D between two nodes whose reaches overlap."""
    share = here.reach / (here.reach + there.reach)
    between = here.w + share * (there.w - here.w)
    # The tangents at both nodes predict the turn. D gives the remainder, which is below half a turn because
    # the reaches overlap.
    expected = tangent(here, between, samples).imag - tangent(there, between, samples).imag
    return expected + cmath.phase(there.direction / here.direction * cmath.exp(complex(0.0, -expected)))
