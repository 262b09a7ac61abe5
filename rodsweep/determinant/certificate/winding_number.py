"""Proved number of transverse eigenvalues of a uniform rod right of a vertical line, without mesh or shift.

All eigenvalues with Re w >= -depth lie in the box of `rodsweep.determinant.certificate.box`, so their number
is the winding number of the entire function D around the box. D is real on the real axis, so the upper half
of the box suffices: count = (change of arg D along the upper half)/pi.

The change of phase is proved. Where one exponential of D dominates, large discs without a zero of D are
proved (`rodsweep.determinant.certificate.dominance`); elsewhere the contour is covered by smaller discs about
points called nodes. Within the `reach` of a node D has no zero, and the phase of D, without a linear part,
changes by less than pi/2. A step between two nodes is accepted only if one node lies within the reach of the
other node. If the reach is 0, the rounding error of D cannot separate a zero of D from the node, and the
count fails.
"""

import cmath
import math
from dataclasses import dataclass
from typing import ClassVar

from ...model.compiled.compilation import compiled
from ...model.compiled.settings import CompiledSettings
from ...model.rod import Coefficients, Rod
from ..value import scaled_determinant
from .box import eigenvalue_box, zero_free_radius_of_rod
from .dominance import phase_over_dominated_segment
from .zero_free_disc import zero_free_disc_at


@dataclass(frozen=True, slots=True, kw_only=True)
class WindingSettings(CompiledSettings):
    """Settings for the contour around which the winding number of D is computed."""

    width_factor: float = 4.0
    """Factor on the width of the box. A wider box is cheaper, because one exponential dominates D far from
    the eigenvalues."""
    additional_width: float = 50.0
    """Length added to the width of the box, in 1/tau2, because a wider box is cheaper to walk around."""
    min_height: float = 0.5
    """Smallest height of the box divided by the distance of the line from the imaginary axis."""
    integer_tolerance: float = 1e-3
    """The count fails if the computed winding number differs from the nearest integer by more than this."""
    walk_length: float = 0.25
    """After a failed proof of dominance at w, the phase is followed by nodes over this length times |w|
    before dominance is tried again. The length doubles after each failure."""
    max_step: float = 1.9
    """The first step tried from a node is this number times its reach. A step beyond the reach needs a next
    node whose reach covers the step."""
    safe_step: float = 0.999
    """If the first step fails, the step is this number times the reach: below 1, because of rounding."""
    min_reach: float = 1e-13
    """The count fails if the reach of a node is below this number times |w|: a zero of D is too close."""
    max_edge_nodes: int = 20_000
    """Maximum number of nodes on one edge of the box; the paper's rods need about 30 nodes on all edges."""
    ranges: ClassVar = {"safe_step": (0.0, 1.0)}


WINDING_SETTINGS = WindingSettings()

PHASE_LOST_MESSAGE = (
    "the winding number is undecided: an eigenvalue lies too close to its contour, or the contour is too long"
)
"""Reason of a failed count: the change of arg D along the contour could not be proved."""
NO_INTEGER_MESSAGE = "the winding number of D is not an integer within rounding errors"
"""Reason of a failed count: rounding errors are too large."""


@dataclass(frozen=True, slots=True)
class EigenvalueCount:
    """Number of eigenvalues right of a vertical line.

    number: None if the count failed. node_count: number of nodes and discs on the contour.
    failure_reason: reason of the failure.
    """

    number: int | None
    node_count: int
    failure_reason: str = ""


@compiled
def phase_change(start: complex, end: complex, coefficients: Coefficients) -> tuple[float, int]:
    """Returns (change of arg D along the segment from `start` to `end`, number of nodes and discs).

    Where one exponential of D is proved to dominate, `phase_over_dominated_segment` gives the change;
    elsewhere `phase_change_by_nodes` does. If the change cannot be proved, returns (0, -number of nodes and
    discs).
    """
    length = abs(end - start)
    direction = (end - start) / length
    t = 0.0
    total = 0.0
    nodes = 0
    patience = WINDING_SETTINGS.walk_length
    while t < length:
        w = start + direction * t
        ahead, change, discs = phase_over_dominated_segment(w, direction, length - t, coefficients)
        total += change
        nodes += discs
        # Dominance that fails is tried again only after a longer walk: each failure costs three discs.
        patience = WINDING_SETTINGS.walk_length if ahead > 0 else 2 * patience
        t = length if ahead == length - t else t + ahead
        if t < length:
            w = start + direction * t
            goal = min(length, t + patience * abs(w))
            to = end if goal == length else start + direction * goal
            change, used = phase_change_by_nodes(w, to, coefficients)
            nodes += abs(used)
            if used < 0 or nodes > WINDING_SETTINGS.max_edge_nodes:
                return 0.0, -nodes
            total += change
            t = goal
    return total, nodes


@compiled
def phase_change_by_nodes(start: complex, end: complex, coefficients: Coefficients) -> tuple[float, int]:
    """Returns (change of arg D along the segment from `start` to `end`, number of nodes), by zero-free discs
    about successive nodes on the segment.

    If the reach of a node is too small, or too many nodes are needed, returns (0, -number of nodes).
    """
    length = abs(end - start)
    direction = (end - start) / length
    t = 0.0
    total = 0.0
    nodes = 1
    here = zero_free_disc_at(start, coefficients)
    while t < length:
        if (
            not here.reach > WINDING_SETTINGS.min_reach * abs(here.w)
            or nodes > WINDING_SETTINGS.max_edge_nodes
        ):
            return 0.0, -nodes
        # The next node may lie beyond the reach of this node if its own reach covers the step.
        ahead = min(WINDING_SETTINGS.max_step * here.reach, length - t)
        while True:
            inside = ahead < here.reach
            there = zero_free_disc_at(
                start + direction * (t + ahead) if ahead < length - t else end, coefficients
            )
            nodes += 1
            if inside or abs(there.w - here.w) < max(here.reach, there.reach):
                break
            ahead = WINDING_SETTINGS.safe_step * here.reach
        # The linear part of the change may exceed 2 pi; the values of D give the rest, less than pi/2.
        turn = ((here.L if here.reach >= there.reach else there.L) * (there.w - here.w)).imag
        total += turn + cmath.phase(there.D / here.D * cmath.exp(complex(0.0, -turn)))
        t = length if there.w == end else t + ahead
        here = there
    return total, nodes


@compiled
def contour_phase_change(
    line: float, foot: float, corner: complex, coefficients: Coefficients
) -> tuple[float, int]:
    """Returns (change of arg D along the upper half of the box, number of nodes and discs).

    The contour goes from the real axis up to `corner`, left to Re w = line, and down to the height `foot`.
    The number is negative, and the returned change meaningless, if the change could not be proved.
    """
    top = complex(line, corner.imag)
    right, nodes = phase_change(complex(corner.real, 0.0), corner, coefficients)
    if nodes < 0:
        return 0.0, nodes
    above, used = phase_change(corner, top, coefficients)
    nodes += abs(used)
    if used < 0 or foot == corner.imag:  # in the latter case D is near 1 on the whole line
        return right + above, nodes if used > 0 else -nodes
    # The line is walked upwards, because a sum from the top could not resolve a small foot.
    left, used = phase_change(complex(line, foot), top, coefficients)
    nodes += abs(used)
    return right + above - left, nodes if used > 0 else -nodes


def count_right_of(line: float, rod: Rod) -> EigenvalueCount:
    """Proved number of transverse eigenvalues of a uniform rod with Re w > line, for any real `line`, in
    1/tau2.

    A failed proof raises no exception: `number` is then None and `failure_reason` the reason.
    """
    real, imag = eigenvalue_box(rod, max(-line, 0.0))
    if not math.isfinite(imag) or not math.isfinite(real):
        where = f"at F = {rod.F:g}"
        return EigenvalueCount(None, 0, f"no a-priori bound on the eigenvalues applies to this rod {where}")
    if line >= real:
        return EigenvalueCount(0, 0)
    foot = 0.0
    total = 0.0
    if line == 0.0:  # D(0) = 1, and D is near 1 up to `foot`, so this part of the line needs no nodes
        foot = zero_free_radius_of_rod(rod.coefficients, imag)
        if foot == 0.0:
            return EigenvalueCount(
                None, 0, f"the pull F = {rod.F:g} is so strong that floating-point numbers underflow"
            )
        # Downwards from the foot to w = 0, where D = 1 is real, arg D changes by minus its value at the foot.
        total = -cmath.phase(scaled_determinant(complex(0.0, foot), rod.coefficients)[0])
    corner = upper_contour_corner(line, (real, imag))
    change, nodes = contour_phase_change(line, foot, corner, rod.coefficients)
    if nodes < 0:
        return EigenvalueCount(None, -nodes, PHASE_LOST_MESSAGE)
    total += change
    # Half the box has half the winding number: 2 pi times the count over both halves.
    number = round(total / math.pi)
    if abs(total / math.pi - number) > WINDING_SETTINGS.integer_tolerance:
        return EigenvalueCount(None, nodes, NO_INTEGER_MESSAGE)
    return EigenvalueCount(number, nodes)


def upper_contour_corner(line: float, box: tuple[float, float]) -> complex:
    """Upper right corner of the contour, in 1/tau2: the point of the contour with the largest |w|.

    line: real part of the left edge of the contour. box: bounds (max Re w, max |Im w|) of all eigenvalues
    right of the line. Also for the contours of arms.
    """
    real, imag = box
    return complex(
        WINDING_SETTINGS.width_factor * real + WINDING_SETTINGS.additional_width,
        max(imag, WINDING_SETTINGS.min_height * abs(line)),
    )
