"""The leading eigenvalue of a rod from that of a rod near by, without a mesh.

Newton's method on D leads from one to the other; that it leads here too is for the winding number to prove.
"""

from ...determinant.newton import refined
from ...determinant.roots import root_error
from ...determinant.winding_number import count_right_of
from ...model.rod import Rod
from .candidates import BEHIND


def followed_leader(rod: Rod, near: complex, accuracy: float) -> complex | None:
    """The leading eigenvalue, 1/tau2, not below the real axis; None where it is not proved to lead.

    near: the one of a rod near by; accuracy: relative.
    """
    w = refined(near, rod.coefficients)
    error, _, _ = root_error(w, rod.coefficients)
    if not error <= accuracy * abs(w) or w.imag < 0 or (w.imag == 0) != (near.imag == 0):
        return None
    line = w.real - BEHIND * abs(w)
    return w if count_right_of(line, rod).number == (2 if w.imag else 1) else None
