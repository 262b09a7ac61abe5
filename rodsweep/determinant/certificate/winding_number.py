"""Proved number of transverse eigenvalues of a uniform rod right of a vertical line, without mesh or shift.

All eigenvalues with Re w >= -depth lie in the box of
`rodsweep.determinant.certificate.box_of_all_eigenvalues`, so their number is the winding number of the entire
function D around the box. D is real on the real axis, so the upper half of the box suffices: count = (change
of arg D along the upper half)/pi.

The change of phase is proved. Where one exponential of D dominates, large discs without a zero of D are
proved (`rodsweep.determinant.certificate.dominance`); elsewhere the contour is covered by smaller discs about
points called nodes. Within the zero-free radius of a node D has no zero, and the phase of D, without a linear
part, changes by less than pi/2. A step between two nodes is accepted only if one node lies within the
zero-free radius of the other node. If the zero-free radius is 0, the rounding error of D cannot separate a
zero of D from the node, and the count fails.
"""

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar

from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ...model.rod import Coefficients, Rod
from ..value import scaled_determinant
from .box_of_all_eigenvalues import box_of_all_eigenvalues, zero_free_radius_of_rod
from .dominance import phase_over_dominated_segment
from .zero_free_disc import zero_free_disc_at


@dataclass(frozen=True, slots=True, kw_only=True)
class WindingSettings(KernelConstants):
    """Settings for the contour around which the winding number of D is computed."""

    contour_width_factor: float = 4.0
    """Width of the box around which the contour runs, divided by the width of `box_of_all_eigenvalues`. A
    wider box is cheaper: far from eigenvalues one exponential dominates D."""
    additional_contour_width: float = 50.0
    """Length added to the width of the box around which the contour runs, in 1/tau2, because a contour
    farther from the eigenvalues takes fewer steps."""
    min_contour_height_over_line_distance: float = 0.5
    """Smallest height of the box around which the contour runs, divided by the distance of the vertical line,
    its left side, from the imaginary axis."""
    integer_tolerance: float = 1e-3
    """The count fails if the computed winding number differs from the nearest integer by more than this."""
    dominance_retry_distance_over_w: float = 0.25
    """If a proof of dominance succeeds at first and fails further on, at the point w, the phase is followed
    by nodes over this length times |w| before dominance is tried again. The length doubles after each proof
    that fails at its start."""
    first_step_over_zero_free_radius: float = 1.9
    """The first step tried from a node is this number times its zero-free radius. A step beyond the zero-free
    radius needs a next node whose zero-free radius covers the step."""
    safe_step_over_radius: float = 0.999
    """If the first step fails, the next is this number, below 1 because of rounding, times the zero-free
    radius."""
    min_zero_free_radius_over_w: float = 1e-13
    """The count fails if the zero-free radius of a node w is below this number times |w|: a zero is too
    close."""
    max_edge_nodes: int = 20_000
    """Maximum number of nodes on one edge of the box; the paper's rods need about 30 nodes on all edges."""
    field_ranges: ClassVar = {"safe_step_over_radius": (0.0, 1.0)}
    """Exclusive bounds (lower, upper) of fields, by name, that the proofs require; see `KernelConstants`."""


WINDING_SETTINGS = WindingSettings()

PHASE_LOST_MESSAGE = (
    "the winding number is undecided: an eigenvalue lies too close to its contour, or the contour is too long"
)
"""Reason of a failed count: the change of arg D along the contour could not be proved."""
NO_INTEGER_MESSAGE = "the winding number of D is not an integer within rounding errors"
"""Reason of a failed count: rounding errors are too large."""


@dataclass(frozen=True, slots=True)
class EigenvalueCount:
    """Number of eigenvalues right of a vertical line. number: None if the count failed. node_count: number of
    nodes and discs on the contour. failure_reason: reason of the failure, "" if the count succeeded."""

    number: int | None
    node_count: int
    failure_reason: str = ""


@compiled
def phase_change(start: complex, end: complex, coefficients: Coefficients) -> tuple[float, int]:
    """Returns (change of arg D along the segment from `start` to `end`, number of nodes and discs). Where one
    exponential of D is proved to dominate, `phase_over_dominated_segment` gives the change; elsewhere
    `phase_change_by_nodes` does. If the change cannot be proved, returns (0, -number of nodes and discs)."""
    length = abs(end - start)
    direction = (end - start) / length
    t = 0.0
    total = 0.0
    node_count = 0
    node_walk_length = WINDING_SETTINGS.dominance_retry_distance_over_w
    while t < length:
        w = start + direction * t
        dominated_length, change, discs = phase_over_dominated_segment(w, direction, length - t, coefficients)
        total += change
        node_count += discs
        # Dominance that fails is tried again only after a longer walk: each failure costs three discs.
        node_walk_length = (
            WINDING_SETTINGS.dominance_retry_distance_over_w if dominated_length > 0 else 2 * node_walk_length
        )
        t = length if dominated_length == length - t else t + dominated_length
        if t < length:
            w = start + direction * t
            walk_end = min(length, t + node_walk_length * abs(w))
            # The corner itself, since the next edge starts there.
            walk_end_w = end if walk_end == length else start + direction * walk_end
            change, used_count = phase_change_by_nodes(w, walk_end_w, coefficients)
            node_count += abs(used_count)
            if used_count < 0 or node_count > WINDING_SETTINGS.max_edge_nodes:
                return 0.0, -node_count
            total += change
            t = walk_end
    return total, node_count


@compiled
def phase_change_by_nodes(start: complex, end: complex, coefficients: Coefficients) -> tuple[float, int]:
    """Returns (change of arg D along the segment from `start` to `end`, number of nodes), by zero-free discs
    about successive nodes on the segment. If the zero-free radius of a node is too small, or too many nodes
    are needed, returns (0, -number of nodes)."""
    length = abs(end - start)
    direction = (end - start) / length
    t = 0.0
    total = 0.0
    node_count = 1
    node = zero_free_disc_at(start, coefficients)
    while t < length:
        if (
            not node.zero_free_radius > WINDING_SETTINGS.min_zero_free_radius_over_w * abs(node.w)
            or node_count > WINDING_SETTINGS.max_edge_nodes
        ):
            return 0.0, -node_count
        # The next node may lie outside the zero-free disc of this node if its own disc covers the step.
        distance = min(WINDING_SETTINGS.first_step_over_zero_free_radius * node.zero_free_radius, length - t)
        # The second trial lies within the zero-free radius, so there are at most two.
        while True:
            is_in_disc = distance < node.zero_free_radius
            next_node = zero_free_disc_at(
                start + direction * (t + distance) if distance < length - t else end, coefficients
            )
            node_count += 1
            if is_in_disc or abs(next_node.w - node.w) < max(
                node.zero_free_radius, next_node.zero_free_radius
            ):
                break
            distance = WINDING_SETTINGS.safe_step_over_radius * node.zero_free_radius
        # The linear part of the change may exceed 2 pi; the values of D give the rest, less than pi/2.
        # The linear part of the larger disc, which contains the step, leaves less than pi/2.
        linear_change = (
            (
                node.log_derivative
                if node.zero_free_radius >= next_node.zero_free_radius
                else next_node.log_derivative
            )
            * (next_node.w - node.w)
        ).imag
        total += linear_change + cmath.phase(next_node.D / node.D * cmath.exp(complex(0.0, -linear_change)))
        t = length if next_node.w == end else t + distance
        node = next_node
    return total, node_count


@compiled
def contour_phase_change(
    line: float, start_height: float, corner: complex, coefficients: Coefficients
) -> tuple[float, int]:
    """Returns (change of arg D along the upper half of the boundary of a box, number of nodes and discs). The
    contour goes from the real axis up to `corner`, left to Re w = line, and down to the height
    `start_height`. The number is negative, and the returned change meaningless, if the change could not be
    proved."""
    top = complex(line, corner.imag)
    right_change, node_count = phase_change(complex(corner.real, 0.0), corner, coefficients)
    if node_count < 0:
        return 0.0, node_count
    top_change, used_count = phase_change(corner, top, coefficients)
    node_count += abs(used_count)
    if used_count < 0 or start_height == corner.imag:  # in the latter case D is near 1 on the whole line
        return right_change + top_change, node_count if used_count > 0 else -node_count
    # The line is walked upwards, because a sum from the top could not resolve a small start height.
    left_change, used_count = phase_change(complex(line, start_height), top, coefficients)
    node_count += abs(used_count)
    return right_change + top_change - left_change, node_count if used_count > 0 else -node_count


def count_right_of(line: float, rod: Rod) -> EigenvalueCount:
    """Proved number of transverse eigenvalues of a uniform rod with Re w > line, for any real `line`, in
    1/tau2. A failed proof raises no exception: `number` is then None and `failure_reason` the reason."""
    max_real, max_imag = box_of_all_eigenvalues(rod, max(-line, 0.0))
    if not math.isfinite(max_imag) or not math.isfinite(max_real):
        place = f"at F = {rod.F:g}"
        return EigenvalueCount(None, 0, f"no a-priori bound on the eigenvalues applies to this rod {place}")
    if line >= max_real:
        return EigenvalueCount(0, 0)
    start_height = 0.0
    phase = 0.0
    if line == 0.0:  # D is near D(0) = 1 up to `start_height`, so this part of the line needs no nodes
        start_height = zero_free_radius_of_rod(rod.coefficients, max_imag)
        if start_height == 0.0:
            return EigenvalueCount(
                None, 0, f"the pull F = {rod.F:g} is so strong that floating-point numbers underflow"
            )
        # From w = i start_height down to w = 0, where D = 1 is real, arg D changes by minus its value.
        phase = -cmath.phase(scaled_determinant(complex(0.0, start_height), rod.coefficients)[0])
    corner = upper_contour_corner(line, (max_real, max_imag))
    change, node_count = contour_phase_change(line, start_height, corner, rod.coefficients)
    if node_count < 0:
        return EigenvalueCount(None, -node_count, PHASE_LOST_MESSAGE)
    phase += change
    # Half the box has half the winding number: 2 pi times the count over both halves.
    count = round(phase / math.pi)
    if abs(phase / math.pi - count) > WINDING_SETTINGS.integer_tolerance:
        return EigenvalueCount(None, node_count, NO_INTEGER_MESSAGE)
    return EigenvalueCount(count, node_count)


def upper_contour_corner(line: float, box: tuple[float, float]) -> complex:
    """Upper right corner of the contour, in 1/tau2: the point of the contour with the largest |w|. line: real
    part of the left edge of the contour. box: bounds (max Re w, max |Im w|) of all eigenvalues right of the
    line. Also for the contours of arms."""
    max_real, max_imag = box
    return complex(
        WINDING_SETTINGS.contour_width_factor * max_real + WINDING_SETTINGS.additional_contour_width,
        max(max_imag, WINDING_SETTINGS.min_contour_height_over_line_distance * abs(line)),
    )
