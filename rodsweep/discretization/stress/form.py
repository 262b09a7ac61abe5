"""One nonlinear rod on one mesh with stresses as unknowns; k1 = inf, k2 = inf and gamma3 = 0 are allowed.

Equations and unknowns are defined in `rodsweep.discretization.stress.balance`.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ...model.rod import Rod
from ..coefficients_on_mesh import balance_coefficient_derivatives_at_nodes, jump_derivatives
from ..elements.mesh import Mesh, interpolation_matrix
from ..nodal_rod import NodalRod, NodalRodDerivative, nodal_rod_derivative
from ..rod_on_mesh import RodOnMesh
from ..state_layout import SE2_DIMENSION, plane_layout


@dataclass(frozen=True, slots=True, kw_only=True)
class VelocityEliminationSettings:
    """Settings for the choice of the unknowns of a `StressForm`."""

    min_eliminated_rotational_drag: float = 1e-5
    """The angular velocity Omega is eliminated if the rotational drag is at least this; else it is an
    unknown. Division by a smaller drag costs digits of Floquet multipliers (errors of 2e-9 at a drag of 1e-6,
    of 2e-7 at 1e-8), and cycles of soft rods are not found. A form with Omega as an unknown takes 2.4 times
    as long."""
    min_eliminated_axial_drag: float = 2e-3
    """The axial velocity v1 is eliminated if the axial drag is everywhere at least this; otherwise v1 is an
    unknown. Newton's method for the form without v1 converges only from starts whose relative error is below
    the axial drag, because an error of the axial force is divided by the drag: no cycle was found from
    motions at a drag of 1e-5, and none near a Hopf point at 1e-10. At drags from 1e-4 to 1e-3 the motions of
    5 of 15 rods had to be integrated again on finer meshes, which took 7 to 22 times as long, and no cycle
    was found for another rod; none of 13 rods with drags from 3e-3 to 1e-2 had these problems. The form with
    v1 takes up to twice as long."""


VELOCITY_ELIMINATION_SETTINGS = VelocityEliminationSettings()

AXIAL_VELOCITY_COMPONENTS = (0,)
"""Index of the axial velocity v1 among the components of V, as a tuple."""
ANGULAR_VELOCITY_COMPONENTS = (2,)
"""Index of the angular velocity Omega among the components of V, as a tuple."""


def has_small_rotational_drag(rod: Rod) -> bool:
    """Whether the rotational drag is somewhere so small that the angular velocity Omega must be an
    unknown."""
    return rod.least_rotational_drag < VELOCITY_ELIMINATION_SETTINGS.min_eliminated_rotational_drag


@dataclass(frozen=True, eq=False)
class StressForm(RodOnMesh):
    """One nonlinear rod on one mesh with stresses as unknowns.

    A state x has the shape (..., unknowns). It contains the stresses n1 + F and n2 in k3/L^2, and m3 in k3/L,
    of a linear rod with the same strain, at every node except the tip, where all three stresses are 0; then,
    for small gamma1, the axial velocity v1 in L/tau2, and for small gamma3 the angular velocity Omega in
    1/tau2, at all nodes.
    """

    is_omega_always_unknown: bool = False
    """Whether the angular velocity Omega is an unknown for any rotational drag, so that states of rods with
    small and with large drags can be compared."""

    @property
    def unknown_velocity_components(self) -> tuple[int, ...]:
        is_axial_velocity_unknown = (
            self.rod.least_axial_drag < VELOCITY_ELIMINATION_SETTINGS.min_eliminated_axial_drag
        )
        is_omega_unknown = self.is_omega_always_unknown or has_small_rotational_drag(self.rod)
        axial = AXIAL_VELOCITY_COMPONENTS if is_axial_velocity_unknown else ()
        return (*axial, *(ANGULAR_VELOCITY_COMPONENTS if is_omega_unknown else ()))

    def states_on_mesh(self, target: Mesh, x: Array) -> Array:
        """States x, (..., unknowns), interpolated to the mesh `target`, (..., unknowns on target)."""
        if self.has_continuous_stresses:
            return self.layout.interpolate(x, interpolation_matrix(self.mesh, target))
        return self._states_with_stresses_on_mesh(target, self.stresses_on_mesh(target, x), x)

    def increments_on_mesh(self, target: Mesh, increments: Array) -> Array:
        """The `increments` of states, (..., unknowns), mapped linearly to `target`, (..., unknowns on
        target)."""
        if self.has_continuous_stresses:
            return self.states_on_mesh(target, increments)
        return self._states_with_stresses_on_mesh(
            target, self.stress_increments_on_mesh(target, increments), increments
        )

    def _states_with_stresses_on_mesh(self, target: Mesh, S: Array, x: Array) -> Array:
        """States on the mesh `target`, (..., unknowns on target), with the stresses S at all nodes of
        `target`, (3, ..., nodes of target + 1), and the velocities of the states x, (..., unknowns)."""
        # Velocities are continuous where stresses jump, so their interpolation needs no correction.
        V = np.zeros((SE2_DIMENSION, *x.shape[:-1], target.node_count + 1))
        V[list(self.unknown_velocity_components)] = (
            self.layout.velocities(x) @ interpolation_matrix(self.mesh, target).T
        )
        return plane_layout(target.node_count, self.unknown_velocity_components).state(S, V)

    def nodal_rod_parameter_derivative(self, parameter_name: str) -> NodalRodDerivative:
        """Derivative of `nodal_rod` with respect to the coordinate of the parameter `parameter_name`: 1/k for
        a stiffness k, else the parameter itself."""
        coefficient_derivatives = balance_coefficient_derivatives_at_nodes(
            self.rod, parameter_name, self.mesh
        )
        return nodal_rod_derivative(
            coefficient_derivatives, self.mesh, jump_derivatives(self.rod, parameter_name, self.mesh)
        )

    @cached_property
    def mass_diagonal(self) -> Array:
        """Diagonal of the mass matrix, (unknowns,): quadrature weights times compliances for stresses, 0 for
        v1 and Omega."""
        return self.mass_diagonal_of(self.nodal_rod)

    def mass_diagonal_of(self, rod: NodalRod | NodalRodDerivative) -> Array:
        """`mass_diagonal` with the compliances of `rod`, (unknowns,). rod: another rod, or the derivative of
        a rod with respect to a parameter."""
        weighted = rod.compliance * self.mesh.quadrature_weights
        return self.layout.state(weighted, np.zeros(weighted.shape))

    def energy_norm(self, x: Array) -> Array:
        """Energy norm sqrt(x M x), (...), of states x, (..., unknowns); 0 for the straight rod. The mass
        matrix M of the stress form holds the compliances, so x M x is twice a linear rod's elastic energy."""
        amplitude: Array = np.sqrt(x**2 @ self.mass_diagonal)
        return amplitude
