"""Leading mode of the straight rod on a mesh, for the start of a motion."""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Complex
from ...determinant.exponents import EXPONENT_SETTINGS
from ...discretization.explicit_system import ExplicitSystem

MAX_DEFLECTION_PER_TIP_DEFLECTION = 2.0
"""Upper limit of the deflection |y| along the rod, in L, of a mode scaled to a tip deflection of 1. The tip
may be nearly at rest in a mode, for example in the mode of an arm with a heavy tip, near one particular
force. Such a mode, scaled by its tip, is no small disturbance of the rod."""


@dataclass(frozen=True, slots=True)
class LeadingMode:
    """Leading eigenvalue w of the straight rod, in 1/tau2, Im w >= 0, and its mode, (unknowns,), scaled to
    a tip deflection y(1) = 1 to first order; y(1) is smaller, but not negative, if the largest deflection |y|
    along the rod would exceed `MAX_DEFLECTION_PER_TIP_DEFLECTION`."""

    w: complex
    mode: Complex

    def state(self, tip_y: float) -> Array:
        """The real part of the mode, (unknowns,), scaled to the tip deflection `tip_y`, in L."""
        return tip_y * self.mode.real

    @property
    def period(self) -> float:
        """Period 2 pi/Im w in tau2, or the time constant 1/|w| of a mode that does not oscillate."""
        settings = EXPONENT_SETTINGS
        return 2 * np.pi / self.w.imag if self.w.imag else 1 / max(abs(self.w.real), settings.min_divisor)


def leading_mode(system: ExplicitSystem) -> LeadingMode:
    """The leading mode of the straight rod, from the transverse block of the Jacobian."""
    layout = system.layout
    rest_state = np.zeros(layout.unknown_count)
    J = layout.transverse_unknowns(layout.transverse_unknowns(system.jacobian(rest_state)).T).T
    eigenvalues, vectors = np.linalg.eig(J)
    # The second key selects the member of a complex pair with Im w > 0.
    leading_index = int(np.lexsort((eigenvalues.imag, eigenvalues.real))[-1])
    z = np.zeros(layout.unknown_count, complex)
    layout.transverse_unknowns(z)[:] = vectors[:, leading_index]
    # y is linear in z about the straight rod, so the 'velocity' along z is the deflection.
    real, imag = (system.y_velocities(rest_state, part) for part in (z.real, z.imag))
    tip = complex(real[-1], imag[-1])
    min_tip = float(np.hypot(real, imag).max()) / MAX_DEFLECTION_PER_TIP_DEFLECTION
    # A tip near a node of the mode would scale the deflection elsewhere without limit.
    if abs(tip) < min_tip:
        phase = tip / abs(tip) if tip else 1.0
        tip = min_tip * phase
    return LeadingMode(complex(eigenvalues[leading_index]), z / tip)
