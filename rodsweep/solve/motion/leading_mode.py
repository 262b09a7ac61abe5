"""Leading mode of the straight rod on a mesh, for the start of a motion."""

from dataclasses import dataclass

import numpy as np

from ...arrays import Complex
from ...determinant.exponents import EXPONENT_SETTINGS
from ...discretization.beam import Beam


@dataclass(frozen=True, slots=True)
class LeadingMode:
    """Leading eigenvalue w of the straight rod, in 1/tau2, Im w >= 0, and its mode z, (unknowns,), scaled to
    a tip deflection y(1) = 1 to first order."""

    w: complex
    z: Complex

    @property
    def period(self) -> float:
        """Period 2 pi/Im w in tau2, or the time constant 1/|w| of a mode that does not oscillate."""
        return (
            2 * np.pi / self.w.imag
            if self.w.imag
            else 1 / max(abs(self.w.real), EXPONENT_SETTINGS.least_divisor)
        )


def leading_mode(beam: Beam) -> LeadingMode:
    """The leading mode of the straight rod, from the transverse block of the Jacobian; the axial block is
    decoupled."""
    layout = beam.layout
    rest = np.zeros(layout.unknown_count)
    J = layout.transverse_unknowns(layout.transverse_unknowns(beam.jacobian(rest)).T).T
    values, vectors = np.linalg.eig(J)
    # The second key selects the member of a complex pair with Im w > 0.
    k = int(np.lexsort((values.imag, values.real))[-1])
    z = np.zeros(layout.unknown_count, complex)
    layout.transverse_unknowns(z)[:] = vectors[:, k]
    # The tip's y is linear in z about the straight rod, so the tip's 'velocity' along z is its deflection.
    tip = complex(*(beam.tip_velocity(rest, part)[1] for part in (z.real, z.imag)))
    return LeadingMode(complex(values[k]), z / tip)
