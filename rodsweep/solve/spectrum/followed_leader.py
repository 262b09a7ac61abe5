"""The leading eigenvalue of a rod from the leading eigenvalue of a neighbouring rod, without a mesh.

Newton's method on D follows the eigenvalue; the winding number proves that it still leads.
"""

from ...determinant.certificate.winding_number import count_right_of
from ...determinant.newton import refined
from ...determinant.roots import root_error
from ...model.rod import Rod
from .candidates import CANDIDATES


def followed_leader(rod: Rod, near: complex, accuracy: float) -> complex | None:
    """The leading eigenvalue, in 1/tau2, with Im w >= 0; None unless it is proved to lead.

    near: leading eigenvalue of a neighbouring rod. accuracy: relative.
    """
    w = refined(near, rod.coefficients)
    error, _, _ = root_error(w, rod.coefficients)
    if not error <= accuracy * abs(w) or w.imag < 0 or (w.imag == 0) != (near.imag == 0):
        return None
    number = 2 if w.imag else 1
    lines = (w.real - far * abs(w) for far in (CANDIDATES.far_behind, CANDIDATES.behind))
    leads = any(count_right_of(line, rod).number == number for line in lines)
    return w if leads else None
