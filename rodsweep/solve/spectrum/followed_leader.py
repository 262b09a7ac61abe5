"""The leading eigenvalue of a rod from that of a rod near by, without a mesh.

Newton's method on D leads from one to the other; that it leads here too is for the winding number to prove.
"""

from ...determinant.certificate.winding_number import count_right_of
from ...determinant.newton import refined
from ...determinant.roots import root_error
from ...model.rod import Rod
from .candidates import BEHIND

FAR_BEHIND = 0.5
"""Distance of the first line behind it that may prove it to lead, in units of its modulus: the farther from
an eigenvalue a line passes, the fewer nodes it takes. Where another eigenvalue is so near, BEHIND tells."""


def followed_leader(rod: Rod, near: complex, accuracy: float) -> complex | None:
    """The leading eigenvalue, 1/tau2, not below the real axis; None where it is not proved to lead.

    near: the one of a rod near by; accuracy: relative.
    """
    w = refined(near, rod.coefficients)
    error, _, _ = root_error(w, rod.coefficients)
    if not error <= accuracy * abs(w) or w.imag < 0 or (w.imag == 0) != (near.imag == 0):
        return None
    number = 2 if w.imag else 1
    leads = any(count_right_of(w.real - far * abs(w), rod).number == number for far in (FAR_BEHIND, BEHIND))
    return w if leads else None
