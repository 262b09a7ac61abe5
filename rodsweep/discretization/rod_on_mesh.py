"""One nonlinear rod on one mesh: strains, shape and energy from stresses.

This is the common part of two forms: `StressForm`, whose unknowns are stresses, and `Beam`, whose unknowns
are stresses in units of energy.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from ..arrays import Array
from ..model.balance import Values
from ..model.rod import Rod
from .arm_on_mesh import material_on
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
        """S at all nodes, tip included, shape (3, ..., nodes + 1), with the strain E = E0 + C S.

        In a linear rod S is (n1 + F, n2, m3).
        """

    def with_coordinate(self, name: str, coordinate: float) -> Self:
        """The rod with another coordinate of a parameter, on the same mesh; ValueError for an invalid rod."""
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
        """The rod as argument of compiled functions."""
        return nodal_rod(material_on(self.rod, self.mesh), self.mesh, self.kept, self.rod.build.law_number)

    def strains(self, x: Values) -> Values:
        """(h1, h2, Pi) at all nodes, tip included, shape (3, ..., nodes + 1)."""
        S = self.stresses(x)
        return _along(self.nodal.rest, S) + _along(self.nodal.compliance, S) * S

    def shape(self, x: Values) -> Values:
        """(x, y, theta) at all nodes in L and rad, (3, ..., nodes + 1); clamped at the origin along e_x."""
        return configuration(self.mesh, self.strains(x), np.zeros(3))

    def tip(self, x: Values) -> Values:
        """(x, y, theta) of the tip, shape (3, ...)."""
        return self.shape(x)[..., -1]

    def energy(self, x: Array) -> Array:
        """Elastic energy U of states x, in k3/L, shape (...).

        For a uniform linear rod U = 1/2 int k1 (h1 - 1)^2 + k2 h2^2 + Pi^2.
        """
        S = self.stresses(x)
        law = self.rod.build.constitutive_law
        compliance = _along(self.nodal.compliance, S)
        h1 = _along(self.nodal.rest, S)[0] + compliance[0] * S[0]
        push = S[0] - _along(self._shortening[None], S)[0]  # (h1 - 1)/c1
        stretched = compliance[0] * push**2 * law.energy_over_square(h1)
        bent = compliance[1] * S[1] ** 2 / 2 + law.bending(h1) * compliance[2] * S[2] ** 2 / 2
        energy: Array = (stretched + bent) @ self.mesh.quadrature
        return energy

    @cached_property
    def _shortening(self) -> Array:
        """(1 - nu)/c1 of the straight rod, (nodes + 1,); the limit F for c1 = 0."""
        F = self.rod.F
        law = self.rod.build.constitutive_law
        load = F * self.nodal.compliance[0]
        ratio = np.where(load == 0, 1.0, law.shortening(load) / np.where(load == 0, 1.0, load))
        shortening: Array = F * ratio
        return shortening

    def least_stretch(self, x: Array) -> float:
        """Minimum of h1 over all nodes and states; the model is valid while the minimum is positive."""
        return float(self.strains(x)[0].min())


def _along(constant: Array, field: Values) -> Array:
    """A constant (3, nodes + 1) or (3, 1), reshaped to broadcast against a field (3, ..., nodes + 1)."""
    return constant.reshape(len(constant), *(1,) * (field.ndim - 2), -1)
