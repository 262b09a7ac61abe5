"""The rod at rest on the mesh of its motion: the leading mode, from which it starts."""

from dataclasses import dataclass

import numpy as np

from ...arrays import Complex
from ...discretization.beam import Beam


@dataclass(frozen=True, slots=True)
class LeadingMode:
    """The leading eigenvalue w in 1/tau2, Im w >= 0, and its z for y(1) = 1 to first order."""

    w: complex
    z: Complex

    @property
    def period(self) -> float:
        """Period in tau2, or the time of decay where nothing oscillates."""
        return 2 * np.pi / self.w.imag if self.w.imag else 1 / max(abs(self.w.real), 1e-300)


def leading_mode(beam: Beam) -> LeadingMode:
    """The leading mode, from the Jacobian at rest, whose transverse part is decoupled from the axial one."""
    layout, rest = beam.layout, np.zeros(beam.layout.unknowns)
    J = layout.transverse(layout.transverse(beam.jacobian(rest)).T).T
    values, vectors = np.linalg.eig(J)
    k = int(np.argmax(values.real + 1e-9 * values.imag))
    z = np.zeros(layout.unknowns, complex)
    layout.transverse(z)[:] = vectors[:, k]
    tip = complex(*(beam.tip_velocity(rest, part)[1] for part in (z.real, z.imag)))
    return LeadingMode(complex(values[k]), z / tip)
