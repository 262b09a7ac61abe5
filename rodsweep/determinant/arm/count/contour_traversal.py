"""Traversal of the contour of a count of an arm's eigenvalues: the nodes, and the change of arg D between
them.

The nodes are points w on the contour. The change of phase between two nodes follows from the tangents log
D(w) + L (v - w), L = D'/D, of log D(v) at both nodes w, if the error of each tangent is below pi/2 at a
common point between the nodes.
"""

import cmath
import math
from typing import NamedTuple

from ....arrays import Complex
from ....model.compiled.compilation import compiled
from ..determinant import PropagatorsUpToW
from ..elements.settings import ARM_ELEMENT_SETTINGS
from ..hull.region import EigenvalueHull
from ..local_waves import ExponentSamples, mean_wave_number_and_w_scale
from .phase_node import PhaseNode, linearised_log_determinant, phase_node
from .settings import CONTOUR_SETTINGS


class ContourTraversal(NamedTuple):
    """State of a traversal of the contour of a count: on side number `side_number` of the box, at
    `distance_on_side` from the start of this side.

    phase_change: change of arg D so far. node_count: number of nodes so far. last_node: the last node.
    valid_radius_growth: change per distance of the valid radius of a node, within which the tangent of log D
    at the node has an error below pi/2. distance_to_next_node: distance from the last node to the next node,
    0 if not chosen yet. required_w_bound: |w| for which propagators are needed to continue; 0 at the end, inf
    if the change of phase is not determined.
    """

    side_number: int
    distance_on_side: float
    phase_change: float
    node_count: int
    last_node: PhaseNode
    valid_radius_growth: float
    distance_to_next_node: float
    required_w_bound: float


@compiled
def continue_traversal(  # noqa: PLR0913, PLR0917 - state and constants of one walk
    traversal: ContourTraversal,
    box: tuple[Complex, float],
    known_w: Complex,
    hull: EigenvalueHull,
    samples: tuple[ExponentSamples, ExponentSamples],
    level: PropagatorsUpToW,
) -> ContourTraversal:
    """Continues a traversal of the box to the end, or until propagators for another |w| are needed. box:
    (corners, largest |w| for which propagators are known to exist). known_w: known eigenvalues, (n,), by
    whose factors D is divided. level: (W, propagators) in use, valid for |w| <= W. samples: two samplings of
    the arm's coefficients, one for the change of w over which D changes, one for the dominant exponential of
    D."""
    corners, largest_w = box
    side, t, change, nodes, node, growth, step, _ = traversal
    while side < len(corners) - 1:
        end = corners[side + 1]
        length = abs(end - corners[side])
        # The comparison is exact because t is set to the length itself at a corner.
        if t == length:
            side, t, growth = side + 1, 0.0, 0.0
            continue
        if _is_phase_lost(node, nodes):
            return ContourTraversal(side, t, change, nodes, node, growth, step, math.inf)
        if step == 0:
            step = min(_distance_to_next_node(node.valid_radius, growth), length - t)
        # The last node of a side is the corner itself, where the next side starts, not a rounded sum.
        w = end if step == length - t else corners[side] + (end - corners[side]) / length * (t + step)
        unit = mean_wave_number_and_w_scale(w, samples[0])[1]
        radius, min_W = _first_radius_and_required_w(w, unit, node.circle_radius, largest_w)
        if not _are_propagators_reusable(level[0], min_W):
            return ContourTraversal(side, t, change, nodes, node, growth, step, min_W)
        neighbour = phase_node(w, known_w, (unit, min(radius, level[0] - abs(w))), hull, (samples[1], level))
        nodes += 1
        # A node that proves too far away still shows how fast the valid radius changes.
        growth = (neighbour.valid_radius - node.valid_radius) / step
        if abs(neighbour.w - node.w) < node.valid_radius + neighbour.valid_radius:
            change += _phase_change_between(node, neighbour, samples[1])
            t = length if neighbour.w == end else t + step
            node = neighbour
            step = 0.0
        else:
            step = _shortened_distance_to_next_node(node.valid_radius, growth, step)
    return ContourTraversal(side, t, change, nodes, node, growth, step, 0.0)


@compiled
def _first_radius_and_required_w(
    w: complex, unit: float, last_radius: float, largest_w: float
) -> tuple[float, float]:
    """Returns (radius of the first circle about the node w, |w| for which propagators are needed). unit:
    change of w over which D changes much. last_radius: radius of the circle about the last node, 0 if the
    node has no circle. largest_w: largest |w| for which propagators are known to exist."""
    first = CONTOUR_SETTINGS.first_circle_radius_over_w_scale * unit
    radius = first
    if last_radius > 0:
        radius = min(2 * last_radius, CONTOUR_SETTINGS.max_circle_radius_over_w_scale * unit)
    wave_radius = CONTOUR_SETTINGS.max_dominant_wave_radius_over_im_w * w.imag
    radius = max(radius, wave_radius)
    limit = max(first, min(wave_radius, largest_w - abs(w)))
    return radius, abs(w) + min(radius, limit)


@compiled
def _is_phase_lost(node: PhaseNode, node_count: int) -> bool:
    """Whether the phase cannot be followed further, because the radius within which the tangent of log D at
    the node is valid is too small, or because there are too many nodes."""
    min_radius = CONTOUR_SETTINGS.min_valid_radius_over_w * abs(node.w)
    # Negated, so that a valid radius of nan counts as lost.
    return not node.valid_radius > min_radius or node_count > CONTOUR_SETTINGS.max_nodes


@compiled
def _are_propagators_reusable(W: float, required_W: float) -> bool:
    """Whether propagators for |w| <= W are valid at |w| = `required_W`, and W is not much larger than
    `required_W`."""
    return (
        required_W <= W <= CONTOUR_SETTINGS.max_reused_W_over_w * max(required_W, ARM_ELEMENT_SETTINGS.min_W)
    )


@compiled
def _distance_to_next_node(reach: float, growth: float) -> float:
    """Distance to the next node: `distance_over_sum_of_valid_radii` times the sum of the valid radii
    (`PhaseNode`) of the current and of the next node. reach: valid radius of the current node. growth:
    expected change of the valid radius per distance, here limited to the range from -1 to
    `max_valid_radius_growth`."""
    overlap = CONTOUR_SETTINGS.distance_over_sum_of_valid_radii
    return (
        2 * overlap * reach / (1 - overlap * min(max(growth, -1.0), CONTOUR_SETTINGS.max_valid_radius_growth))
    )


@compiled
def _shortened_distance_to_next_node(reach: float, growth: float, distance: float) -> float:
    """A distance to the next node that is smaller than `distance`, at which the next node was too far.
    Repeated calls lead to a distance below `reach`, the valid radius of the current node (`PhaseNode`).
    growth: expected change of the valid radius per distance."""
    shorter_distance = min(
        _distance_to_next_node(reach, growth), CONTOUR_SETTINGS.max_shortened_over_previous_step * distance
    )
    return (
        shorter_distance
        if shorter_distance > reach
        else min(CONTOUR_SETTINGS.safe_step_over_radius * reach, distance / 2)
    )


@compiled
def _phase_change_between(node: PhaseNode, next_node: PhaseNode, samples: ExponentSamples) -> float:
    """The change of arg D between two nodes whose discs of valid radius overlap, from the tangents of log D
    and the values of D at both nodes."""
    fraction = node.valid_radius / (node.valid_radius + next_node.valid_radius)
    middle_w = node.w + fraction * (next_node.w - node.w)
    # The tangents at both nodes predict the change. The values of D give the remainder, which is below pi
    # because the discs overlap.
    linear_change = (
        linearised_log_determinant(node, middle_w, samples).imag
        - linearised_log_determinant(next_node, middle_w, samples).imag
    )
    remaining_rotation = next_node.phase_factor / node.phase_factor * cmath.exp(complex(0.0, -linear_change))
    return linear_change + cmath.phase(remaining_rotation)
