"""Number of an arm's transverse eigenvalues right of a vertical line, without mesh or shift.

The number is the change of arg D along the upper half of a box that contains all these eigenvalues, divided
by pi, as in `rodsweep.determinant.certificate.winding_number`, see `contour_traversal`.

Known eigenvalues close to the line are divided out: D above stands for D(w)/prod (w - w_n), whose zeros are
far from the line. The known eigenvalues right of the line are then added to the count.
"""

import math

import numpy as np

from ....arrays import Array, Complex
from ...certificate.winding_number import (
    NO_INTEGER_MESSAGE,
    PHASE_LOST_MESSAGE,
    WINDING_SETTINGS,
    EigenvalueCount,
    upper_contour_corner,
)
from ..completeness import is_real_or_conjugate_known
from ..determinant import ArmDeterminant
from ..hull.region import EigenvalueHull
from .contour_traversal import ContourTraversal, continue_traversal
from .phase_node import phase_node
from .settings import CONTOUR_SETTINGS

NO_KNOWN_EIGENVALUES: Complex = np.empty(0, complex)
"""No known eigenvalues, (0,)."""


class PhaseLost(ArithmeticError):
    """The change of arg D along the contour could not be determined. node_count: number of nodes that were
    used."""

    def __init__(self, node_count: int):
        super().__init__(PHASE_LOST_MESSAGE)
        self.node_count = node_count


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
    known_w = known_w[
        errors < CONTOUR_SETTINGS.max_divided_out_error_over_distance * np.abs(known_w.real - line)
    ]
    # D divided by one factor of a pair would not be real on the real axis, and half a box would not suffice.
    known_w = known_w[is_real_or_conjugate_known(known_w)]
    height = np.maximum(np.abs(known_w.imag), abs(line))
    known_w = known_w[
        np.abs(known_w.real - line) < CONTOUR_SETTINGS.max_divided_out_line_distance_over_w * height
    ]
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
    """Whether eigenvalues right of a line Re w <= 0 can be counted, that is, whether the hull is bounded and
    elements resolve D."""
    if not math.isfinite(hull.a):
        return False
    try:
        determinant.propagators_for(abs(_upper_right_corner(0.0, hull)), CONTOUR_SETTINGS.max_reused_W_over_w)
    except FloatingPointError:
        return False
    return True


def largest_w_of_count(line: float, determinant: ArmDeterminant, hull: EigenvalueHull) -> float:
    """The largest |w| at which a count of the eigenvalues with Re w > `line` evaluates D."""
    corner = _upper_right_corner(line, hull)
    return abs(corner) + CONTOUR_SETTINGS.first_circle_radius_over_w_scale * determinant.w_scale(corner)


def _upper_right_corner(line: float, hull: EigenvalueHull) -> complex:
    """Upper right corner of the contour about all eigenvalues with Re w > `line`."""
    return upper_contour_corner(line, hull.box(max(-line, 0.0)))


def _phase_change(
    line: float, determinant: ArmDeterminant, hull: EigenvalueHull, known_w: Complex
) -> tuple[float, int]:
    """Returns (change of arg D, with `known_w` divided out of D, along the upper half of the boundary of a
    box with all eigenvalues that have Re w > line; number of nodes). Raises `PhaseLost` if the disc of a
    node, in which the phase is known, is too small, or too many nodes are needed."""
    corner = _upper_right_corner(line, hull)
    corners = np.array([corner.real, corner, complex(line, corner.imag), line])
    # The elements for the largest |w| come first, because they serve most other w of the contour.
    largest_w = largest_w_of_count(line, determinant, hull)
    propagators = determinant.propagators_for(largest_w, CONTOUR_SETTINGS.max_reused_W_over_w)
    samples = determinant.samples, determinant.exponent_samples_at_gauss_points
    scale = determinant.w_scale(corners[0])
    trial_radii = (
        scale,
        min(CONTOUR_SETTINGS.first_circle_radius_over_w_scale * scale, propagators[0] - abs(corners[0])),
    )
    first_node = phase_node(corners[0], known_w, trial_radii, hull, (samples[1], propagators))
    traversal = ContourTraversal(0, 0.0, 0.0, 1, first_node, 0.0, 0.0, 0.0)
    # Compiled code cannot make propagators; it returns here whenever it needs others, and continues.
    while True:
        traversal = continue_traversal(traversal, (corners, largest_w), known_w, hull, samples, propagators)
        if traversal.required_w_bound == 0:
            break
        if traversal.required_w_bound == math.inf:
            raise PhaseLost(traversal.node_count)
        propagators = determinant.propagators_for(
            traversal.required_w_bound, CONTOUR_SETTINGS.max_reused_W_over_w
        )
    return traversal.phase_change, traversal.node_count
