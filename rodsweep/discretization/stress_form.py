"""One nonlinear rod on one mesh, in its stresses: every limit, k1 = inf, k2 = inf and gamma3 = 0, included.

The equations and the unknowns are `rodsweep.discretization.stress_balance`'s; here are the mesh, the
parameters, and what follows from a state: strains, shape, energy, powers.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..model.balance import Material, plane_change, plane_material
from ..model.rod import Rod
from .mesh import Mesh, configuration
from .nodal_rod import NodalRod, nodal_change, nodal_rod
from .state_layout import StateLayout, plane_layout

LEAST_ELIMINATED_DRAG = 1e-5
"""gamma3 from which Omega is eliminated: below, the division by gamma3 costs multipliers their digits, 2e-9
at 1e-6 and 2e-7 at 1e-8, and soft rods their cycles; as an unknown Omega costs 2.4 times the time."""
OMEGA = (2,)
"""Which component of V that is."""


@dataclass(frozen=True, eq=False)
class StressForm:
    """One rod, its axial drag gamma1 in gamma2, on one mesh.

    A state x has shape (..., unknowns): n1 + F, n2 in k3/L^2 and m3 in k3/L at every node but the tip, where
    they vanish, and Omega in 1/tau2 at all nodes where gamma3 is small.
    """

    rod: Rod
    gamma1: float
    mesh: Mesh

    @cached_property
    def material(self) -> Material:
        """Compliances, drags and the force."""
        return plane_material(self.rod, self.gamma1)

    @cached_property
    def nodal(self) -> NodalRod:
        """The rod as the compiled functions take it."""
        return nodal_rod(self.material, self.mesh.matrices, self.layout.kept)

    def change(self, name: str) -> NodalRod:
        """The derivative of `nodal` by a parameter, by 1/k of a stiffness k."""
        return nodal_change(plane_change(self.rod, name), self.nodal)

    @property
    def omega_unknown(self) -> bool:
        """Whether Omega is among the unknowns."""
        return self.rod.gamma3 < LEAST_ELIMINATED_DRAG

    @cached_property
    def layout(self) -> StateLayout:
        """Where each field of a state lies."""
        return plane_layout(self.mesh.nodes, OMEGA if self.omega_unknown else ())

    @property
    def unknowns(self) -> int:
        return self.layout.unknowns

    @cached_property
    def mass(self) -> Array:
        """The diagonal of W C, 0 for Omega, shape (unknowns,)."""
        return self.mass_of(self.nodal)

    def mass_of(self, rod: NodalRod) -> Array:
        """`mass` for other compliances."""
        weighted = rod.compliance * self.mesh.quadrature
        return self.layout.state(weighted, np.zeros(weighted.shape))

    def stresses(self, x: Array) -> Array:
        """(n1 + F, n2, m3) at all nodes, the tip included, shape (3, ..., nodes + 1)."""
        return self.layout.stresses(x)

    def strains(self, x: Array) -> Array:
        """(h1, h2, Pi) at all nodes, the tip included, shape (3, ..., nodes + 1)."""
        every = (3, *(1,) * (x.ndim - 1), self.mesh.nodes + 1)
        return self.nodal.rest.reshape(every) + self.nodal.compliance.reshape(every) * self.stresses(x)

    def shape(self, x: Array) -> Array:
        """(x, y, theta) at all nodes in L and rad, shape (3, ..., nodes + 1), the clamp at 0 along e_x."""
        return configuration(self.mesh, self.strains(x), np.zeros(3))

    def tip(self, x: Array) -> Array:
        """(x, y, theta) of the tip, shape (3, ...)."""
        return self.shape(x)[..., -1]

    def energy(self, x: Array) -> Array:
        """U = 1/2 int k1 (h1 - 1)^2 + k2 h2^2 + Pi^2 in k3/L, shape (...)."""
        S = self.stresses(x)
        S[0] -= self.rod.F
        return self.material.energy(S) @ self.mesh.quadrature

    def size(self, x: Array) -> Array:
        """sqrt of the energy of the stresses beyond the straight rod's, an amplitude of the motion, (...)."""
        size: Array = np.sqrt(x**2 @ self.mass)
        return size

    def least_stretch(self, x: Array) -> float:
        """min h1 over the nodes of all states; the model holds while it is positive."""
        return float(self.strains(x)[0].min())
