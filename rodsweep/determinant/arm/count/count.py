"""Number of an arm's transverse eigenvalues right of a vertical line, without mesh or shift.

The number is the change of arg D along the upper half of a box that contains all these eigenvalues, divided
by pi, as in `rodsweep.determinant.certificate.winding_number`. The phase between two nodes follows from the
tangents log D(w) + L (v - w), L = D'/D, of log D(v) at both nodes w, if the error of each tangent is below
pi/2 at a common point between the nodes.

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
from ..local_waves import ExponentSamples, mean_wave_number_and_w_scale
from .phase_node import PhaseNode, linearised_log_determinant, phase_node
from .settings import CONTOUR_SETTINGS

NO_KNOWN_EIGENVALUES: Complex = np.empty(0, complex)
"""No known eigenvalues, (0,)."""


class PhaseLost(ArithmeticError):
    """The change of arg D along the contour could not be determined; node_count: number of nodes used."""

    def __init__(self, node_count: int):
        super().__init__(PHASE_LOST_MESSAGE)
        self.node_count = node_count


class ContourTraversal(NamedTuple):
    """State of a traversal of the contour of a count: on side number `side_number` of the box, at
    `distance_on_side` from the start of this side.

    phase_change: change of arg D so far. node_count: number of nodes so far. last_node: the last node.
    radius_growth: change of the valid radius per distance. next_distance: distance of the next node, 0 if not
    chosen yet. required_w_bound: |w| for which propagators are needed to continue; 0 at the end, inf if the
    change of phase is not determined.
    """

    side_number: int
    distance_on_side: float
    phase_change: float
    node_count: int
    last_node: PhaseNode
    radius_growth: float
    next_distance: float
    required_w_bound: float


def count_right_of(
    line: float,
    determinant: ArmDeterminant,
    hull: EigenvalueHull,
    known_w: Complex = NO_KNOWN_EIGENVALUES,
    errors: Array | float = 0.0,
) -> EigenvalueCount:
    """Number of transverse eigenvalues of an arm with Re w > line, for any real `line`, in 1/tau2. known_w,
    errors: some eigenvalues, (n,), and their errors, (n,), which make the count faster. A failed count raises
    no exception: `number` is then None and `failure_reason` the reason."""
    if not math.isfinite(hull.a):
        place = f"at F = {determinant.rod.F:g}"
        return EigenvalueCount(None, 0, f"no a-priori bound on the eigenvalues applies to this rod {place}")
    if line >= hull.box(max(-line, 0.0))[0]:
        return EigenvalueCount(0, 0)
    known_w = known_w[errors < CONTOUR_SETTINGS.max_known_error_ratio * np.abs(known_w.real - line)]
    # D divided by one factor of a pair would not be real on the real axis, and half a box would not suffice.
    known_w = known_w[has_conjugate(known_w)]
    height = np.maximum(np.abs(known_w.imag), abs(line))
    known_w = known_w[np.abs(known_w.real - line) < CONTOUR_SETTINGS.max_known_line_distance_ratio * height]
    try:
        phase_change, node_count = _phase_change(line, determinant, hull, known_w)
    except PhaseLost as lost:
        return EigenvalueCount(None, lost.node_count, str(lost))
    except FloatingPointError as unresolved:
        return EigenvalueCount(None, 0, str(unresolved))
    # D is real at both ends of the contour, on the real axis: the phase changes by a multiple of pi.
    count = round(phase_change / math.pi)
    if abs(phase_change / math.pi - count) > WINDING_SETTINGS.integer_tolerance:
        return EigenvalueCount(None, node_count, NO_INTEGER_MESSAGE)
    return EigenvalueCount(count + int((known_w.real > line).sum()), node_count)


def is_countable(determinant: ArmDeterminant, hull: EigenvalueHull) -> bool:
    """Whether eigenvalues right of a line Re w <= 0 are countable: the hull is bounded, elements resolve
    D."""
    if not math.isfinite(hull.a):
        return False
    try:
        determinant.propagators_for(abs(_upper_right_corner(0.0, hull)), CONTOUR_SETTINGS.max_W_ratio)
    except FloatingPointError:
        return False
    return True


def largest_w_of_count(line: float, determinant: ArmDeterminant, hull: EigenvalueHull) -> float:
    """The largest |w| at which a count right of the line evaluates D."""
    corner = _upper_right_corner(line, hull)
    return abs(corner) + CONTOUR_SETTINGS.first_radius_in_lengths * determinant.w_scale(corner)


def _upper_right_corner(line: float, hull: EigenvalueHull) -> complex:
    """Upper right corner of the contour about all eigenvalues right of the line."""
    return upper_contour_corner(line, hull.box(max(-line, 0.0)))


def _phase_change(
    line: float, determinant: ArmDeterminant, hull: EigenvalueHull, known_w: Complex
) -> tuple[float, int]:
    """Returns (change along the upper half of the box of arg D with `known_w` divided out; number of nodes).
    Raises `PhaseLost` if a node's valid radius is too small, or too many nodes are needed."""
    corner = _upper_right_corner(line, hull)
    corners = np.array([corner.real, corner, complex(line, corner.imag), line])
    # The elements for the largest |w| come first, because they serve most other w of the contour.
    largest_w = largest_w_of_count(line, determinant, hull)
    propagators = determinant.propagators_for(largest_w, CONTOUR_SETTINGS.max_W_ratio)
    samples = determinant.samples, determinant.gauss_samples
    scale = determinant.w_scale(corners[0])
    trial_radii = (
        scale,
        min(CONTOUR_SETTINGS.first_radius_in_lengths * scale, propagators[0] - abs(corners[0])),
    )
    first_node = phase_node(corners[0], known_w, trial_radii, hull, (samples[1], propagators))
    traversal = ContourTraversal(0, 0.0, 0.0, 1, first_node, 0.0, 0.0, 0.0)
    # Compiled code cannot make propagators; it returns here whenever it needs others, and continues.
    while True:
        traversal = _continue_traversal(traversal, (corners, largest_w), known_w, hull, samples, propagators)
        if traversal.required_w_bound == 0:
            break
        if traversal.required_w_bound == math.inf:
            raise PhaseLost(traversal.node_count)
        propagators = determinant.propagators_for(traversal.required_w_bound, CONTOUR_SETTINGS.max_W_ratio)
    return traversal.phase_change, traversal.node_count


@compiled
def _continue_traversal(  # noqa: PLR0913, PLR0917 - state and constants of one walk
    traversal: ContourTraversal,
    box: tuple[Complex, float],
    known_w: Complex,
    hull: EigenvalueHull,
    samples: tuple[ExponentSamples, ExponentSamples],
    level: PropagatorsUpToW,
) -> ContourTraversal:
    """Continues a traversal of the box to the end, or until propagators for another |w| are needed. box:
    (corners, largest |w| for which propagators are known to exist). level: (W, propagators) in use. samples:
    samples of the arm's coefficients, which give the lengths over which D changes and the dominant wave."""
    corners, largest_w = box
    side, t, change, nodes, node, growth, step, _ = traversal
    while side < len(corners) - 1:
        end = corners[side + 1]
        length = abs(end - corners[side])
        # The comparison is exact because t is set to the length itself at a corner.
        if t == length:
            side, t, growth = side + 1, 0.0, 0.0
            continue
        if _is_lost(node, nodes):
            return ContourTraversal(side, t, change, nodes, node, growth, step, math.inf)
        if step == 0:
            step = min(_overlapping_distance(node.valid_radius, growth), length - t)
        # The last node of a side is the corner itself, where the next side starts, not a rounded sum.
        w = end if step == length - t else corners[side] + (end - corners[side]) / length * (t + step)
        unit = mean_wave_number_and_w_scale(w, samples[0])[1]
        first = CONTOUR_SETTINGS.first_radius_in_lengths * unit
        radius = min(2 * node.radius, CONTOUR_SETTINGS.max_circle_radius * unit) if node.radius > 0 else first
        radius = max(radius, CONTOUR_SETTINGS.max_wave_radius * w.imag)
        limit = max(first, min(CONTOUR_SETTINGS.max_wave_radius * w.imag, largest_w - abs(w)))
        min_W = abs(w) + min(radius, limit)
        if not _serves_efficiently(level[0], min_W):
            return ContourTraversal(side, t, change, nodes, node, growth, step, min_W)
        neighbour = phase_node(w, known_w, (unit, min(radius, level[0] - abs(w))), hull, (samples[1], level))
        nodes += 1
        # A node that proves too far away still shows how fast the valid radius changes.
        growth = (neighbour.valid_radius - node.valid_radius) / step
        if abs(neighbour.w - node.w) < node.valid_radius + neighbour.valid_radius:
            change += _phase_between(node, neighbour, samples[1])
            t = length if neighbour.w == end else t + step
            node = neighbour
            step = 0.0
        else:
            step = _shortened_distance(node.valid_radius, growth, step)
    return ContourTraversal(side, t, change, nodes, node, growth, step, 0.0)


@compiled
def _is_lost(node: PhaseNode, node_count: int) -> bool:
    """Whether the phase is lost: the valid radius of the node is too small, or there are too many nodes."""
    min_radius = CONTOUR_SETTINGS.min_valid_radius_over_w * abs(node.w)
    # Negated, so that a valid radius of nan counts as lost.
    return not node.valid_radius > min_radius or node_count > CONTOUR_SETTINGS.max_nodes


@compiled
def _serves_efficiently(W: float, required_W: float) -> bool:
    """Whether propagators for |w| <= W are valid at |w| = `required_W`, with W not much larger than that."""
    return required_W <= W <= CONTOUR_SETTINGS.max_W_ratio * max(required_W, ARM_ELEMENT_SETTINGS.min_W)


@compiled
def _overlapping_distance(reach: float, growth: float) -> float:
    """Distance to the next node: `radius_overlap` times the sum of the current valid radius and of the valid
    radius expected there. reach: the current valid radius. growth: expected change of the valid radius per
    distance, clipped to between -1 and `max_radius_growth`."""
    overlap = CONTOUR_SETTINGS.radius_overlap
    return 2 * overlap * reach / (1 - overlap * min(max(growth, -1.0), CONTOUR_SETTINGS.max_radius_growth))


@compiled
def _shortened_distance(reach: float, growth: float, distance: float) -> float:
    """A distance to the next node below `distance`. Repeated calls lead to a distance below `reach`, the
    valid radius. growth: expected change of the valid radius per distance."""
    shorter_distance = min(
        _overlapping_distance(reach, growth), CONTOUR_SETTINGS.max_shortened_step_ratio * distance
    )
    return (
        shorter_distance
        if shorter_distance > reach
        else min(CONTOUR_SETTINGS.safe_step_over_radius * reach, distance / 2)
    )


@compiled
def _phase_between(node: PhaseNode, next_node: PhaseNode, samples: ExponentSamples) -> float:
    """The change of arg D between two nodes with overlapping discs, from their tangents and values of D."""
    fraction = node.valid_radius / (node.valid_radius + next_node.valid_radius)
    middle_w = node.w + fraction * (next_node.w - node.w)
    # The tangents at both nodes predict the change. The values of D give the remainder, which is below pi
    # because the discs overlap.
    linear_change = (
        linearised_log_determinant(node, middle_w, samples).imag
        - linearised_log_determinant(next_node, middle_w, samples).imag
    )
    remaining_rotation = next_node.direction / node.direction * cmath.exp(complex(0.0, -linear_change))
    return linear_change + cmath.phase(remaining_rotation)
