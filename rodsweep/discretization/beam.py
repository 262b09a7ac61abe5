"""One nonlinear rod on one mesh as a time stepper sees it: dz/dt = f(z), f compiled, with its exact Jacobian.

The unknown is z = C^(1/2) S, the stresses beyond those of the straight rod in units of energy, at all nodes
but the tip, where they vanish: z1 at every node, then z2, then z3. |z|^2/2 is an energy, the mass matrix is
the identity, and no digits are lost for large k1 or k2. It asks for c1, c2, gamma3 > 0; `StressForm` has
every limit.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..model.balance import plane_material
from ..model.rod import Rod
from .mesh import Mesh, configuration
from .nodal_rod import NodalRod, nodal_rod
from .state_layout import StateLayout, plane_layout
from .stress_rates import rate_jacobians, rates

TINY = 1e-30
"""Complex step of a velocity."""


@dataclass(frozen=True, eq=False)
class Beam:
    """One rod with finite k1, k2 and gamma3 > 0, its axial drag gamma1 in gamma2, on one mesh.

    z has shape (unknowns,) and the unit of sqrt(energy density), sqrt(k3)/L.
    """

    rod: Rod
    gamma1: float
    mesh: Mesh

    @cached_property
    def layout(self) -> StateLayout:
        """Where each field of a state lies."""
        return plane_layout(self.mesh.nodes)

    @cached_property
    def nodal(self) -> NodalRod:
        """The rod as the compiled functions take it."""
        return nodal_rod(plane_material(self.rod, self.gamma1), self.mesh.matrices)

    @cached_property
    def roots(self) -> Array:
        """Square roots of C, (3, nodes + 1): z = roots S, and the strains beyond rest are roots z."""
        return np.sqrt(self.nodal.compliance)

    def rate(self, z: Array) -> Array:
        """dz/dt in 1/tau2 of one state or of many, shape (..., unknowns) as that of z."""
        out = np.empty(z.shape)
        size = self.layout.unknowns
        rates(z.reshape(-1, size), out.reshape(-1, size), self.roots, self.nodal, self.mesh.matrices)
        return out

    def jacobian(self, z: Array) -> Array:
        """d(dz/dt)/dz of one state or of many, shape (..., unknowns, unknowns) for z (..., unknowns)."""
        size = self.layout.unknowns
        out = np.empty((*z.shape, size))
        states, matrices = z.reshape(-1, size), out.reshape(-1, size, size)
        rate_jacobians(states, matrices, self.roots, self.nodal, self.mesh.matrices)
        return out.swapaxes(-1, -2)

    def strains(self, z: Array) -> Array:
        """(h1, h2, Pi) at all nodes, the tip included, shape (3, ..., nodes + 1) for z (..., unknowns)."""
        every = (3, *(1,) * (z.ndim - 1), self.mesh.nodes + 1)
        return self.nodal.rest.reshape(every) + self.roots.reshape(every) * self.layout.stresses(z)

    def unknown(self, strains: Array) -> Array:
        """z of (h1, h2, Pi) at all nodes, shape (3, nodes + 1); the tip's values are not free."""
        return self.layout.state((strains - self.nodal.rest) / self.roots, strains)

    def scaled(self, S: Array) -> Array:
        """z of stresses beyond the straight rod's at all nodes, (3, ..., nodes + 1)."""
        return self.layout.state(S * self._along(S), S)

    def stresses(self, z: Array) -> Array:
        """(n1 + F, n2, m3) at all nodes, the tip included, shape (3, ..., nodes + 1)."""
        S = self.layout.stresses(z)
        return S / self._along(S)

    def _along(self, field: Array) -> Array:
        """The roots, to be combined with a field (3, ..., nodes + 1)."""
        return self.roots.reshape(3, *(1,) * (field.ndim - 2), -1)

    def energy(self, z: Array) -> Array:
        """U = 1/2 int k1 (h1 - 1)^2 + k2 h2^2 + Pi^2 in k3/L, shape (...)."""
        E = self.strains(z)
        E[0] -= 1.0
        every = (3, *(1,) * (z.ndim - 1), self.mesh.nodes + 1)
        return 0.5 * ((E / self.roots.reshape(every)) ** 2).sum(axis=0) @ self.mesh.quadrature

    def shape(self, z: Array) -> Array:
        """(x, y, theta) at all nodes in L and rad, shape (3, ..., nodes + 1), the clamp at 0 along e_x."""
        return configuration(self.mesh, self.strains(z), np.zeros(3))

    def tip(self, z: Array) -> Array:
        """(x, y, theta) of the tip, shape (3, ...) for z of shape (..., unknowns)."""
        return self.shape(z)[..., -1]

    def tip_velocity(self, z: Array, direction: Array) -> Array:
        """d/dt of the tip's (x, y, theta) for dz/dt = direction, by complex step, shape (3,)."""
        velocity: Array = np.divide(self.tip(z + 1j * TINY * direction).imag, TINY)
        return velocity

    def least_stretch(self, z: Array) -> float:
        """min h1 over the nodes of all states; the model holds while it is positive."""
        return float(self.strains(z)[0].min())
