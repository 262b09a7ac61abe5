"""The leading eigenvalue of a rod from the leading eigenvalue of a neighbouring rod, without a mesh.

Newton's method on D follows the eigenvalue; the winding number proves that it still leads.
"""

from collections.abc import Callable

import numpy as np

from ...arrays import Complex
from ...determinant.arm import roots as arm_roots
from ...determinant.arm.count import count_right_of as count_of_arm
from ...determinant.arm.count import size_of_count
from ...determinant.arm.determinant import arm_determinant
from ...determinant.arm.hull import hull_of
from ...determinant.certificate.winding_number import Count, count_right_of
from ...determinant.newton import refined
from ...determinant.roots import root_error
from ...model.rod import Rod
from .candidates import CANDIDATES

Leader = tuple[complex, float]
"""The leading eigenvalue, in 1/tau2, with Im w >= 0, and its error."""


def followed_leader(rod: Rod, near: complex, accuracy: float) -> Leader | None:
    """The leading eigenvalue with its error; None unless it is proved to lead.

    near: leading eigenvalue of a neighbouring rod. accuracy: relative.
    """
    if rod.standard:
        w = refined(near, rod.coefficients)
        error, _, _ = root_error(w, rod.coefficients)
        return _proved((w, error), near, accuracy, lambda line: count_right_of(line, rod))
    if rod.uniform:
        linear, rate = rod.equivalent
        found = followed_leader(linear, near / rate, accuracy)
        return found and (rate * found[0], rate * found[1])
    try:
        return _of_arm(rod, near, accuracy)
    except FloatingPointError:  # D needs too many elements
        return None


def _of_arm(rod: Rod, near: complex, accuracy: float) -> Leader | None:
    """`followed_leader` for an arm that varies along its length."""
    hull = hull_of(rod)
    if not np.isfinite(hull.a):
        return None
    determinant = arm_determinant(rod)
    far = near.real - CANDIDATES.far_behind * abs(near)
    determinant.level(size_of_count(far, determinant, hull))  # its elements serve the eigenvalue too
    w = arm_roots.refined(near, determinant)
    error = arm_roots.root_error(w, determinant)
    known: Complex = np.unique([w, w.conjugate()])
    return _proved(
        (w, error), near, accuracy, lambda line: count_of_arm(line, determinant, hull, known, error)
    )


def _proved(found: Leader, near: complex, accuracy: float, count: Callable[[float], Count]) -> Leader | None:
    """An eigenvalue found from its neighbour `near`, if it is accurate, of its kind, and proved to lead."""
    w, error = found
    if not error <= accuracy * abs(w) or w.imag < 0 or (w.imag == 0) != (near.imag == 0):
        return None
    number = 2 if w.imag else 1
    lines = (w.real - far * abs(w) for far in (CANDIDATES.far_behind, CANDIDATES.behind))
    leads = any(count(line).number == number for line in lines)
    return found if leads else None
