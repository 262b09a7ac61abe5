"""The leading eigenvalue of a rod from the leading eigenvalue of a neighbouring rod, without a mesh.

Newton's method on D follows the eigenvalue; the winding number proves that it still leads.
"""

from ...determinant.certificate.winding_number import count_right_of
from ...determinant.newton import refined
from ...determinant.roots import root_error
from ...model.rod import Rod
from .candidates import BEHIND

FAR_BEHIND = 0.5
"""Distance behind the eigenvalue of the first line for a count, in units of the modulus. A distant line takes
fewer nodes; BEHIND follows, in case another eigenvalue lies between."""


def followed_leader(rod: Rod, near: complex, accuracy: float) -> complex | None:
    """The leading eigenvalue, in 1/tau2, with Im w >= 0; None unless it is proved to lead.

    near: leading eigenvalue of a neighbouring rod. accuracy: relative.
    """
    w = refined(near, rod.coefficients)
    error, _, _ = root_error(w, rod.coefficients)
    if not error <= accuracy * abs(w) or w.imag < 0 or (w.imag == 0) != (near.imag == 0):
        return None
    number = 2 if w.imag else 1
    leads = any(count_right_of(w.real - far * abs(w), rod).number == number for far in (FAR_BEHIND, BEHIND))
    return w if leads else None
