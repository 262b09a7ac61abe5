"""One nonlinear rod on one mesh, in its stresses: every limit, k1 = inf, k2 = inf and gamma3 = 0, included.

The equations and the unknowns are `rodsweep.discretization.stress.balance`'s.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ..arm_on_mesh import jump_change_on, material_change_on
from ..elements.mesh import Mesh, transfer
from ..nodal_rod import NodalChange, NodalRod, nodal_change
from ..rod_on_mesh import RodOnMesh
from ..state_layout import COMPONENTS, plane_layout

LEAST_ELIMINATED_DRAG = 1e-5
"""Rotational drag from which Omega is eliminated: below, the division by it costs multipliers their digits,
2e-9 at 1e-6 and 2e-7 at 1e-8, and soft rods their cycles; as an unknown Omega costs 2.4 times the time."""
OMEGA = (2,)
"""Index of Omega among the components of V, as a tuple."""


@dataclass(frozen=True, eq=False)
class StressForm(RodOnMesh):
    """One rod on one mesh.

    A state x has shape (..., unknowns): n1 + F, n2 in k3/L^2 and m3 in k3/L of a linear rod with the same
    strain, at every node but the tip, where they vanish, and Omega in 1/tau2 at all nodes where gamma3 is
    small.
    """

    @property
    def omega_unknown(self) -> bool:
        """Whether Omega is among the unknowns."""
        return self.rod.least_rotational_drag < LEAST_ELIMINATED_DRAG

    @property
    def kept(self) -> tuple[int, ...]:
        return OMEGA if self.omega_unknown else ()

    def stresses(self, x: Array) -> Array:
        return self.layout.stresses(x)

    def states_on(self, grid: Mesh, x: Array) -> Array:
        """States x on another mesh, (..., unknowns there)."""
        E = transfer(self.mesh, grid)
        if not len(self.nodal.jumps):
            return self.layout.carried(x, E)
        layout = plane_layout(grid.nodes, self.kept)
        V = np.zeros((COMPONENTS, *x.shape[:-1], grid.nodes + 1))
        V[list(self.kept)] = self.layout.velocities(x) @ E.T
        return layout.state(self.stresses_on(grid, x), V)

    def change(self, name: str) -> NodalChange:
        """Derivative of `nodal` by the parameter `name`; for a stiffness k, by 1/k."""
        change = material_change_on(self.rod, name, self.mesh)
        return nodal_change(change, self.mesh, jump_change_on(self.rod, name, self.mesh))

    @cached_property
    def mass(self) -> Array:
        """The diagonal of W C, 0 for Omega, shape (unknowns,)."""
        return self.mass_of(self.nodal)

    def mass_of(self, rod: NodalRod | NodalChange) -> Array:
        """`mass` for other compliances."""
        weighted = rod.compliance * self.mesh.quadrature
        return self.layout.state(weighted, np.zeros(weighted.shape))

    def size(self, x: Array) -> Array:
        """sqrt of the energy of the stresses beyond the straight rod's, an amplitude of the motion, (...)."""
        size: Array = np.sqrt(x**2 @ self.mass)
        return size
