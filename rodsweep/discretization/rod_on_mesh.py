"""One nonlinear rod on one mesh, whatever the unit of its unknowns: what follows from its stresses.

Strains, shape, energy. `StressForm` has the stresses themselves for unknowns, `Beam` the same in units of
energy.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from ..arrays import Array
from ..model.balance import Values
from ..model.rod import Rod
from .arm_on_mesh import jumps_on, material_on
from .elements.mesh import Mesh, configuration
from .nodal_rod import NodalRod, nodal_rod
from .state_layout import StateLayout, plane_layout


@dataclass(frozen=True, eq=False)
class RodOnMesh(ABC):
    """One rod on one mesh; states have the shape (..., unknowns)."""

    rod: Rod
    mesh: Mesh

    @property
    @abstractmethod
    def kept(self) -> tuple[int, ...]:
        """Indices of the components of V that are unknowns."""

    @abstractmethod
    def stresses(self, x: Values) -> Values:
        """S at all nodes, the tip included, shape (3, ..., nodes + 1): the strains beyond rest are C S.

        In a linear rod S is (n1 + F, n2, m3).
        """

    def with_coordinate(self, name: str, coordinate: float) -> Self:
        """The rod elsewhere along a parameter, on the same mesh; ValueError where the model has none."""
        return replace(self, rod=self.rod.with_coordinate(name, coordinate))

    @cached_property
    def layout(self) -> StateLayout:
        """Positions of the fields in a state."""
        return plane_layout(self.mesh.nodes, self.kept)

    @property
    def unknowns(self) -> int:
        return self.layout.unknowns

    @cached_property
    def nodal(self) -> NodalRod:
        """The rod as the compiled functions take it."""
        rod, mesh = self.rod, self.mesh
        law, jumps = rod.build.law_number, jumps_on(rod, mesh)
        return nodal_rod(material_on(rod, mesh), mesh, self.kept, law, jumps)

    def strains(self, x: Values) -> Values:
        """(h1, h2, Pi) at all nodes, the tip included, shape (3, ..., nodes + 1)."""
        S, c = self.stresses(x), self.nodal
        return _along(c.rest, S) + _along(c.compliance, S) * S

    def shape(self, x: Values) -> Values:
        """(x, y, theta) at all nodes in L and rad, shape (3, ..., nodes + 1), the clamp at 0 along e_x."""
        return configuration(self.mesh, self.strains(x), np.zeros(3))

    def tip(self, x: Values) -> Values:
        """(x, y, theta) of the tip, shape (3, ...)."""
        return self.shape(x)[..., -1]

    def energy(self, x: Array) -> Array:
        """U, the integral of the law's energy along the rod, in k3/L, shape (...).

        Of a linear rod: 1/2 int k1 (h1 - 1)^2 + k2 h2^2 + Pi^2 for k3 = 1 all along.
        """
        S, law = self.stresses(x), self.rod.build.constitutive_law
        compliance = _along(self.nodal.compliance, S)
        h1 = _along(self.nodal.rest, S)[0] + compliance[0] * S[0]
        push = S[0] - _along(self._shortening[None], S)[0]  # (h1 - 1)/c1
        stretched = compliance[0] * push**2 * law.energy_over_square(h1)
        bent = compliance[1] * S[1] ** 2 / 2 + law.bending(h1) * compliance[2] * S[2] ** 2 / 2
        energy: Array = (stretched + bent) @ self.mesh.quadrature
        return energy

    @cached_property
    def _shortening(self) -> Array:
        """1 - nu of the straight rod in units of c1, (nodes + 1,), in the limit where c1 = 0."""
        F, law = self.rod.F, self.rod.build.constitutive_law
        load = F * self.nodal.compliance[0]
        ratio = np.where(load == 0, 1.0, law.shortening(load) / np.where(load == 0, 1.0, load))
        shortening: Array = F * ratio
        return shortening

    def least_stretch(self, x: Array) -> float:
        """min h1 over the nodes of all states; the model holds while it is positive."""
        return float(self.strains(x)[0].min())


def _along(constant: Array, field: Values) -> Array:
    """Numbers of the components, (3, nodes + 1) or (3, 1), beside a field (3, ..., nodes + 1)."""
    return constant.reshape(len(constant), *(1,) * (field.ndim - 2), -1)
