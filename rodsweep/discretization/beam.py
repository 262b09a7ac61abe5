"""One nonlinear rod on one mesh as a time stepper sees it: dz/dt = f(z), f compiled, with its exact Jacobian.

The unknown is z = C^(1/2) S, the stresses S of a linear rod beyond those of the straight rod in units of
energy, at all nodes but the tip, where they vanish: z1 at every node, then z2, then z3. |z|^2/2 is an energy
of the linear rod, the mass matrix is the identity, and no digits are lost for large k1 or k2. It asks for
c1, c2, gamma3 > 0; `StressForm` has every limit.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..model.balance import Values
from .rod_on_mesh import RodOnMesh
from .stress.rates import rate_jacobians, rates

TINY = 1e-30
"""Imaginary step of the complex-step derivative in `tip_velocity`, in units of time, tau2."""


@dataclass(frozen=True, eq=False)
class Beam(RodOnMesh):
    """One rod with finite k1, k2 and gamma3 > 0 on one mesh.

    z has shape (unknowns,) and the unit of sqrt(energy density), sqrt(k3)/L.
    """

    @property
    def kept(self) -> tuple[int, ...]:
        return ()

    @cached_property
    def roots(self) -> Array:
        """Square roots of C, (3, nodes + 1): z = roots S, and the strains beyond rest are roots z."""
        return np.sqrt(self.nodal.compliance)

    @cached_property
    def crushed(self) -> Array:
        """z1 at which h1 = 0, at all nodes but the tip, (nodes,)."""
        return np.ascontiguousarray(-self.nodal.rest[0, :-1] / self.roots[0, :-1])

    def stresses(self, z: Values) -> Values:
        scaled = self.layout.stresses(z)
        return scaled / self._along(scaled)

    def scaled(self, S: Array) -> Array:
        """z of stresses beyond the straight rod's at all nodes, (3, ..., nodes + 1)."""
        return self.layout.state(S * self._along(S), S)

    def unknown(self, strains: Array) -> Array:
        """z of (h1, h2, Pi) at all nodes, shape (3, nodes + 1); the tip's values are not free."""
        return self.layout.state((strains - self.nodal.rest) / self.roots, strains)

    def rate(self, z: Array) -> Array:
        """dz/dt in 1/tau2 of one state or of many, shape (..., unknowns) as that of z."""
        out = np.empty(z.shape)
        flat = z.reshape(-1, self.unknowns), out.reshape(-1, self.unknowns)
        rates(*flat, self.roots, self.nodal, self.mesh.matrices)
        return out

    def jacobian(self, z: Array) -> Array:
        """d(dz/dt)/dz of one state or of many, shape (..., unknowns, unknowns) for z (..., unknowns)."""
        size = self.unknowns
        out = np.empty((*z.shape, size))
        states, matrices = z.reshape(-1, size), out.reshape(-1, size, size)
        rate_jacobians(states, matrices, self.roots, self.nodal, self.mesh.matrices)
        return out.swapaxes(-1, -2)

    def tip_velocity(self, z: Array, direction: Array) -> Array:
        """d/dt of the tip's (x, y, theta) for dz/dt = direction, by complex step, shape (3, ...)."""
        velocity: Array = np.divide(self.tip(z + 1j * TINY * direction).imag, TINY)
        return velocity

    def _along(self, field: Values) -> Array:
        """`roots` reshaped to broadcast against a field (3, ..., nodes + 1)."""
        return self.roots.reshape(3, *(1,) * (field.ndim - 2), -1)
