"""One nonlinear rod on one mesh: its strains, shape and energy, computed from its stresses.

`RodOnMesh` is the base class of `StressForm`, whose unknowns are stresses, of `MixedForm`, whose unknowns are
stresses and all velocities, and of `ExplicitSystem`, whose unknowns are stresses times the square roots of
the compliances.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from ..arrays import Array
from ..model.balance import Values
from ..model.material.laws import LINEAR_CONSTITUTIVE_LAW
from ..model.material.stress_strain import LocalSection, stress_tangent
from ..model.rod import Rod
from .coefficients_on_mesh import balance_coefficients_at_nodes, jumps_on_mesh
from .element_strains import write_element_strain_rates, write_element_strains
from .elements.mesh import Mesh, shape_from_strains
from .nodal_rod import NodalRod, nodal_rod
from .state_layout import StateLayout, plane_layout
from .stresses_at_jumps import interpolate_state_stress, interpolate_stress, stresses_at_both_sides


@dataclass(frozen=True, eq=False)
class RodOnMesh(ABC):
    """One nonlinear rod on one mesh; states x have the shape (..., unknowns)."""

    rod: Rod
    mesh: Mesh

    @property
    @abstractmethod
    def unknown_velocity_components(self) -> tuple[int, ...]:
        """Indices of the components of the velocity V = (v1, v2, Omega3) that are unknowns; the balance gives
        the others."""

    def stresses(self, x: Values) -> Values:
        """Stresses S of states x at all nodes, tip included, (3, ..., nodes + 1); the strain is E = E0 + C S.
        In a linear rod S is (n1 + F, n2, m3)."""
        return self.layout.stresses(x)

    def with_coordinate(self, parameter_name: str, coordinate: float) -> Self:
        """The same rod on the same mesh with another value of the parameter `parameter_name`, given by its
        coordinate (1/k for a stiffness k, else the value). Raises ValueError for an invalid coordinate."""
        return replace(self, rod=self.rod.with_coordinate(parameter_name, coordinate))

    @cached_property
    def layout(self) -> StateLayout:
        """Indices of the fields in a state."""
        return plane_layout(self.mesh.node_count, self.unknown_velocity_components)

    @property
    def unknown_count(self) -> int:
        """Number of unknowns in a state."""
        return self.layout.unknown_count

    @cached_property
    def nodal_rod(self) -> NodalRod:
        """The rod at the nodes of the mesh, as an argument of compiled functions."""
        rod = self.rod
        mesh = self.mesh
        law = rod.material.law_number
        jumps = jumps_on_mesh(rod, mesh)
        return nodal_rod(
            balance_coefficients_at_nodes(rod, mesh), mesh, self.unknown_velocity_components, law, jumps
        )

    @property
    def has_continuous_stresses(self) -> bool:
        """Whether S is continuous along the rod: the material does not jump, or the law is linear."""
        return self.rod.material.constitutive_law is LINEAR_CONSTITUTIVE_LAW or not len(
            self.nodal_rod.jump_nodes
        )

    def strains(self, x: Values) -> Values:
        """Strains (h1, h2, Pi) of states x at all nodes, tip included, (3, ..., nodes + 1); at a jump, the
        mean of both sides."""
        S = self.stresses(x)
        c = self.nodal_rod
        return broadcast_to_field(c.straight_state_strain, S) + broadcast_to_field(c.compliance, S) * S

    def element_strains(self, x: Array) -> Array:
        """Strains (h1, h2, Pi) of states x at the nodes of every element, (3, ..., nodes + elements); at
        a jump, the strains of both sides."""
        S = self.stresses(x)
        strains = np.empty((*S.shape[:-1], self.mesh.element_node_indices.size))
        write_element_strains(
            _flatten_middle_axes(S),
            self.nodal_rod,
            self.mesh.element_node_indices,
            _flatten_middle_axes(strains),
        )
        return strains

    def element_strain_rates(self, x: Array, direction: Array) -> Array:
        """Derivative of `element_strains` at states x along `direction`, (3, ..., nodes + elements)."""
        S = self.stresses(x)
        dS = self.stresses(direction)
        dE = broadcast_to_field(self.nodal_rod.compliance, dS) * dS
        rates = np.empty((*S.shape[:-1], self.mesh.element_node_indices.size))
        write_element_strain_rates(
            _flatten_middle_axes(S),
            _flatten_middle_axes(dE),
            self.nodal_rod,
            self.mesh.element_node_indices,
            _flatten_middle_axes(rates),
        )
        return rates

    def shape(self, x: Array) -> Array:
        """Shape (x, y, theta) of states at all nodes, in L and rad, (3, ..., nodes + 1); the clamp is at the
        origin, along e_x."""
        return shape_from_strains(self.mesh, self.element_strains(x), np.zeros(3))

    def tip_coordinates(self, x: Array) -> Array:
        """Coordinates (x, y) and angle of the tip, in L and rad, (3, ...), for states (..., unknowns)."""
        return self.shape(x)[..., -1]

    def elastic_energy(self, x: Array) -> Array:
        """Elastic energy U of states x, in k3/L, (...). For a uniform linear rod U = 1/2 int [k1 (h1 - 1)^2 +
        k2 h2^2 + Pi^2] du."""
        S = self.stresses(x)
        c = self.nodal_rod
        nu = broadcast_to_field(c.straight_state_strain, S)[0]
        (c1, c2, c3) = broadcast_to_field(c.compliance, S)
        density = self._strain_energy_density(nu, c1, c3, S[0], S[2])
        for node, side_stresses, jump_sides in zip(
            c.jump_nodes, stresses_at_both_sides(c, S), c.jump_side_coefficients, strict=True
        ):
            # The energy of the mean stress at a jump is not the mean of the energies of both sides.
            density[..., node] = 0.0
            for (q1, q3), (nu, c1, c3, _, _, weight, _) in zip(side_stresses, jump_sides, strict=True):
                density[..., node] += weight * self._strain_energy_density(nu, c1, c3, q1, q3)
        energy: Array = (density + c2 * S[1] ** 2 / 2) @ self.mesh.quadrature_weights
        return energy

    def _strain_energy_density(self, nu: Values, c1: Values, c3: Values, q1: Values, q3: Values) -> Values:
        """Energy per length of stretching and bending, without shear, at the nodes. nu: stretch of the
        straight rod. c1, c3: compliances of stretching and bending. q1, q3: stresses S1 and S3."""
        F = self.rod.F
        law = self.rod.material.constitutive_law
        load = F * c1
        h1 = nu + c1 * q1
        # shortening/load tends to 1 for load -> 0. For c1 = 0 this limit replaces (h1 - 1)/c1 = 0/0.
        # The inner where keeps the quotient that is not used from being 0/0.
        ratio = np.where(load == 0, 1.0, law.shortening(load) / np.where(load == 0, 1.0, load))
        scaled_strain = q1 - F * ratio  # (h1 - 1)/c1
        energy_density: Values = (
            c1 * scaled_strain**2 * law.energy_over_squared_strain(h1)
            + law.bending_factor(h1) * c3 * q3**2 / 2
        )
        return energy_density

    def stresses_on_mesh(self, target: Mesh, x: Array) -> Array:
        """Stresses S of states x at all nodes of the mesh `target`, (3, ..., nodes of target + 1)."""
        S = self.stresses(x)
        if self.has_continuous_stresses:
            return interpolate_stress(self.rod, S, self.mesh, target)
        return interpolate_state_stress(self.nodal_rod, S, self.mesh, self.rod, target)

    def stress_increments_on_mesh(self, target: Mesh, increments: Array) -> Array:
        """Increments of the stresses S for the `increments` of states, (..., unknowns), at all nodes of the
        mesh `target`, (3, ..., nodes of target + 1), by a linear map."""
        return interpolate_stress(self.rod, self.stresses(increments), self.mesh, target)

    def least_stretch(self, x: Array) -> float:
        """Smallest stretch h1 of all nodes and states x, over both sides of each jump. The model requires a
        positive h1."""
        return float(self.element_strains(x)[0].min())

    def has_convex_energy(self, x: Array) -> bool:
        """Whether the energy of every cross-section is convex in its strains h1 and Pi, for one state x,
        (unknowns,). Without convexity the equations are ill-posed: the shortest waves of the mesh grow
        fastest."""
        S = self.stresses(x)
        c = self.nodal_rod
        sections = np.stack(
            [c.straight_state_strain[0], c.compliance[0], c.compliance[2], S[0], S[2]], axis=1
        )
        for node, side_stresses, jump_sides in zip(
            c.jump_nodes, stresses_at_both_sides(c, S), c.jump_side_coefficients, strict=True
        ):
            # The energy must be convex on each side; a section with the mean material does not exist.
            left, right = np.column_stack([jump_sides[:, :3], side_stresses])
            sections[node] = left
            sections = np.vstack([sections, right])
        tangents = (
            stress_tangent(c.law_number, LocalSection(*section[:3]), *section[3:]) for section in sections
        )
        return all(T.M3 > 0 and T.N1 * T.M3 > T.N3 * T.M1 for T in tangents)


def _flatten_middle_axes(field: Array) -> Array:
    """A view of a field (3, ..., n) with the shape (3, m, n)."""
    return field.reshape(len(field), -1, field.shape[-1])


def broadcast_to_field(constant: Array, field: Values) -> Array:
    """`constant`, (3, nodes + 1) or (3, 1), reshaped to broadcast against `field`, (3, ..., nodes + 1)."""
    return constant.reshape(len(constant), *(1,) * (field.ndim - 2), -1)
