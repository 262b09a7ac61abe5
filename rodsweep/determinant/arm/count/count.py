"""Number of an arm's transverse eigenvalues right of a vertical line, without mesh or shift.

The number is the change of arg D along the upper half of a box that contains all these eigenvalues, divided
by pi, as in `rodsweep.determinant.certificate.winding_number`. The phase between two nodes follows from the
tangents log D(w) + L (v - w), L = D'/D, at both nodes, if the error of each tangent is below pi/2 at a common
point between the nodes.

Known eigenvalues close to the line are divided out: D above stands for D(w)/prod (w - w_n), whose zeros are
far from the line. The known eigenvalues right of the line are then added to the count.
"""

import cmath
import math
from typing import NamedTuple

import numpy as np

from ....arrays import Array, Complex
from ....model.compiled.compilation import compiled
from ...certificate.winding_number import (
    NO_INTEGER_MESSAGE,
    PHASE_LOST_MESSAGE,
    WINDING_SETTINGS,
    EigenvalueCount,
    upper_contour_corner,
)
from ..completeness import has_conjugate
from ..determinant import ArmDeterminant, PropagatorsUpToW
from ..elements.settings import ARM_ELEMENT_SETTINGS
from ..hull.region import EigenvalueHull
from ..local_waves import ArmSamples, mean_wave_number_and_w_scale
from .phase_node import PhaseNode, linearised_log_determinant, phase_node
from .settings import CONTOUR_SETTINGS

NO_KNOWN_EIGENVALUES: Complex = np.empty(0, complex)
"""No known eigenvalues, (0,)."""


class PhaseLost(ArithmeticError):
    """The change of arg D along the contour could not be determined; node_count: number of nodes used."""

    def __init__(self, nodes: int):
        super().__init__(PHASE_LOST_MESSAGE)
        self.node_count = nodes


class ContourTraversal(NamedTuple):
    """State of a traversal of the contour of a count: on side number `side_number` of the box, at
    `distance_on_side` from the start of this side.

    phase_change: change of arg D so far. node_count: number of nodes so far. last_node: the last node.
    reach_growth: change of the reach per distance. next_distance: distance of the next node, 0 if not chosen
    yet. required_w_bound: |w| for which propagators are needed to continue; 0 at the end, inf if the change
    of phase is not determined.
    """

    side_number: int
    distance_on_side: float
    phase_change: float
    node_count: int
    last_node: PhaseNode
    reach_growth: float
    next_distance: float
    required_w_bound: float


def count_right_of(
    line: float,
    determinant: ArmDeterminant,
    hull: EigenvalueHull,
    known: Complex = NO_KNOWN_EIGENVALUES,
    error: Array | float = 0.0,
) -> EigenvalueCount:
    """Number of transverse eigenvalues of an arm with Re w > line, for any real `line`, in 1/tau2.

    known, error: some eigenvalues, (n,), and their errors, (n,), which make the count faster. A failed count
    raises no exception: `number` is then None and `failure_reason` the reason.
    """
    if not math.isfinite(hull.a):
        where = f"at F = {determinant.rod.F:g}"
        return EigenvalueCount(None, 0, f"no a-priori bound on the eigenvalues applies to this rod {where}")
    if line >= hull.box(max(-line, 0.0))[0]:
        return EigenvalueCount(0, 0)
    known = known[error < CONTOUR_SETTINGS.max_known_error * np.abs(known.real - line)]
    known = known[has_conjugate(known)]
    height = np.maximum(np.abs(known.imag), abs(line))
    known = known[np.abs(known.real - line) < CONTOUR_SETTINGS.max_known_distance * height]
    try:
        total, nodes = _phase_change(line, determinant, hull, known)
    except PhaseLost as lost:
        return EigenvalueCount(None, lost.node_count, str(lost))
    except FloatingPointError as unresolved:
        return EigenvalueCount(None, 0, str(unresolved))
    number = round(total / math.pi)
    if abs(total / math.pi - number) > WINDING_SETTINGS.integer_tolerance:
        return EigenvalueCount(None, nodes, NO_INTEGER_MESSAGE)
    return EigenvalueCount(number + int((known.real > line).sum()), nodes)


def is_countable(determinant: ArmDeterminant, hull: EigenvalueHull) -> bool:
    """Whether eigenvalues right of a line at Re w <= 0 can be counted: the hull is bounded, and elements
    resolve D.
    """
    if not math.isfinite(hull.a):
        return False
    try:
        determinant.propagators_for(abs(_corner(0.0, hull)), CONTOUR_SETTINGS.max_level_ratio)
    except FloatingPointError:
        return False
    return True


def largest_w_of_count(line: float, determinant: ArmDeterminant, hull: EigenvalueHull) -> float:
    """The largest |w| at which a count right of the line evaluates D."""
    corner = _corner(line, hull)
    return abs(corner) + CONTOUR_SETTINGS.first_radius * determinant.w_scale(corner)


def _corner(line: float, hull: EigenvalueHull) -> complex:
    """Upper right corner of the contour about all eigenvalues right of the line."""
    return upper_contour_corner(line, hull.box(max(-line, 0.0)))


def _phase_change(
    line: float, determinant: ArmDeterminant, hull: EigenvalueHull, known: Complex
) -> tuple[float, int]:
    """Returns (change along the upper half of the box of arg D with `known` divided out; number of nodes).

    Raises `PhaseLost` if a node's reach is too small, or too many nodes are needed.
    """
    corner = _corner(line, hull)
    corners = np.array([corner.real, corner, complex(line, corner.imag), line])
    # The elements for the largest |w| come first, because they serve most other w of the contour.
    largest = largest_w_of_count(line, determinant, hull)
    level = determinant.propagators_for(largest, CONTOUR_SETTINGS.max_level_ratio)
    samples = determinant.samples, determinant.gauss_samples
    unit = determinant.w_scale(corners[0])
    trial = unit, min(CONTOUR_SETTINGS.first_radius * unit, level[0] - abs(corners[0]))
    first = phase_node(corners[0], known, trial, hull, (samples[1], level))
    walk = ContourTraversal(0, 0.0, 0.0, 1, first, 0.0, 0.0, 0.0)
    while True:
        walk = _continue_traversal(walk, (corners, largest), known, hull, samples, level)
        if walk.required_w_bound == 0:
            break
        if walk.required_w_bound == math.inf:
            raise PhaseLost(walk.node_count)
        level = determinant.propagators_for(walk.required_w_bound, CONTOUR_SETTINGS.max_level_ratio)
    return walk.phase_change, walk.node_count


@compiled
def _continue_traversal(  # noqa: PLR0913, PLR0917 - state and constants of one walk
    walk: ContourTraversal,
    box: tuple[Complex, float],
    known: Complex,
    hull: EigenvalueHull,
    samples: tuple[ArmSamples, ArmSamples],
    level: PropagatorsUpToW,
) -> ContourTraversal:
    """Continues a traversal of the box to the end, or until propagators for another |w| are needed.

    box: (corners, largest |w| for which propagators are known to exist). level: (W, propagators) in use.
    samples: samples of the arm's coefficients, which give the lengths over which D changes and the dominant
    wave.
    """
    corners, largest = box
    side, t, total, nodes, here, growth, ahead, _ = walk
    while side < len(corners) - 1:
        end = corners[side + 1]
        length = abs(end - corners[side])
        if t == length:
            side, t, growth = side + 1, 0.0, 0.0
            continue
        if not here.reach > CONTOUR_SETTINGS.min_reach * abs(here.w) or nodes > CONTOUR_SETTINGS.max_nodes:
            return ContourTraversal(side, t, total, nodes, here, growth, ahead, math.inf)
        if ahead == 0:
            ahead = min(_overlapping_distance(here.reach, growth), length - t)
        w = end if ahead == length - t else corners[side] + (end - corners[side]) / length * (t + ahead)
        unit = mean_wave_number_and_w_scale(w, samples[0])[1]
        first = CONTOUR_SETTINGS.first_radius * unit
        radius = min(2 * here.radius, CONTOUR_SETTINGS.max_circle_radius * unit) if here.radius > 0 else first
        radius = max(radius, CONTOUR_SETTINGS.max_wave_radius * w.imag)
        enough = max(first, min(CONTOUR_SETTINGS.max_wave_radius * w.imag, largest - abs(w)))
        needed = abs(w) + min(radius, enough)
        if not _serves_efficiently(level[0], needed):
            return ContourTraversal(side, t, total, nodes, here, growth, ahead, needed)
        there = phase_node(w, known, (unit, min(radius, level[0] - abs(w))), hull, (samples[1], level))
        nodes += 1
        growth = (there.reach - here.reach) / ahead
        if abs(there.w - here.w) < here.reach + there.reach:
            total += _phase_between(here, there, samples[1])
            t = length if there.w == end else t + ahead
            here = there
            ahead = 0.0
        else:
            ahead = _shortened_distance(here.reach, growth, ahead)
    return ContourTraversal(side, t, total, nodes, here, growth, ahead, 0.0)


@compiled
def _serves_efficiently(W: float, needed: float) -> bool:
    """Whether propagators for |w| <= W are valid at |w| = `needed`, with W not much larger than necessary."""
    return needed <= W <= CONTOUR_SETTINGS.max_level_ratio * max(needed, ARM_ELEMENT_SETTINGS.min_W)


@compiled
def _overlapping_distance(reach: float, growth: float) -> float:
    """Distance to the next node: `reach_overlap` times the sum of the present reach and of the reach expected
    there. growth: expected change of the reach per distance, clipped to between -1 and `max_reach_growth`.
    """
    overlap = CONTOUR_SETTINGS.reach_overlap
    return 2 * overlap * reach / (1 - overlap * min(max(growth, -1.0), CONTOUR_SETTINGS.max_reach_growth))


@compiled
def _shortened_distance(reach: float, growth: float, ahead: float) -> float:
    """A distance to the next node below `ahead`; repeated calls give a distance within the reach of the
    present node.
    """
    nearer = min(_overlapping_distance(reach, growth), CONTOUR_SETTINGS.max_step_ratio * ahead)
    return nearer if nearer > reach else min(CONTOUR_SETTINGS.safe_step * reach, ahead / 2)


@compiled
def _phase_between(here: PhaseNode, there: PhaseNode, samples: ArmSamples) -> float:
    """The change of arg D between two nodes whose reaches overlap, from their tangents and values of D."""
    share = here.reach / (here.reach + there.reach)
    between = here.w + share * (there.w - here.w)
    # The tangents at both nodes predict the change. The values of D give the remainder, which is below pi
    # because the reaches overlap.
    expected = (
        linearised_log_determinant(here, between, samples).imag
        - linearised_log_determinant(there, between, samples).imag
    )
    rest = there.direction / here.direction * cmath.exp(complex(0.0, -expected))
    return expected + cmath.phase(rest)
