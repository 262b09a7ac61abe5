"""One nonlinear rod on one mesh as an explicit system for time stepping: dz/dt = f(z) and its exact Jacobian.

The unknown z = C^(1/2) S, with the compliances C, has the unit of the square root of an energy density. S is
the stress of a linear rod with the same strain minus the stress of the straight rod, at all nodes except the
tip, where S = 0. A state contains z1 at every node, then z2, then z3. |z|^2/2 is an energy density of the
linear rod, the mass matrix is the identity, and large k1 or k2 cost no digits. The form requires c1, c2,
gamma3 > 0; `StressForm` also covers c1 = 0, c2 = 0 and gamma3 = 0.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Complex
from ..model.balance import Values
from .elements.mesh import shape_from_strains
from .rod_on_mesh import RodOnMesh, broadcast_to_field
from .stress.rates import write_rate_jacobians, write_rates


@dataclass(frozen=True, slots=True, kw_only=True)
class TipVelocitySettings:
    """Settings for the velocity of the tip."""

    imaginary_step: float = 1e-30
    """Imaginary step, in tau2, of the complex-step derivative in `_shape_and_velocities`. The square of
    the step underflows, so the derivative has no truncation error."""


TIP_VELOCITY_SETTINGS = TipVelocitySettings()


@dataclass(frozen=True, eq=False)
class ExplicitSystem(RodOnMesh):
    """One rod with finite k1, k2 and gamma3 > 0 on one mesh, as an explicit system. States z have the shape
    (unknowns,) and the unit of the square root of an energy density, sqrt(k3)/L."""

    @property
    def unknown_velocity_components(self) -> tuple[int, ...]:
        return ()

    @cached_property
    def sqrt_compliance(self) -> Array:
        """Square roots of the compliances C, (3, nodes + 1): z = sqrt(C) S, and E - E0 = sqrt(C) z."""
        return np.sqrt(self.nodal_rod.compliance)

    @cached_property
    def crushing_z1(self) -> Array:
        """Values of z1 at which the stretch h1 is 0, at all nodes except the tip, (nodes,). At a jump, h1
        reaches 0 first on one side if the law is linear, and the value belongs to this side; for another law
        h1 reaches 0 on both sides at once."""
        z1 = -self.nodal_rod.straight_state_strain[0, :-1] / self.sqrt_compliance[0, :-1]
        if self.has_continuous_stresses:
            for node, sides in zip(
                self.nodal_rod.jump_nodes, self.nodal_rod.jump_side_coefficients, strict=True
            ):
                # The larger value belongs to the side that is crushed first.
                z1[node] = self.sqrt_compliance[0, node] * (-sides[:, 0] / sides[:, 1]).max()
        return np.ascontiguousarray(z1)

    def stresses(self, z: Values) -> Values:
        scaled_stresses = self.layout.stresses(z)
        return scaled_stresses / broadcast_to_field(self.sqrt_compliance, scaled_stresses)

    def state_of_stresses(self, S: Array) -> Array:
        """States z, (..., unknowns), of stresses S at all nodes, (3, ..., nodes + 1)."""
        return self.layout.state(S * broadcast_to_field(self.sqrt_compliance, S), S)

    def state_of_strains(self, strains: Array) -> Array:
        """The state z, (unknowns,), with the given strains (h1, h2, Pi) at all nodes, (3, nodes + 1). Strains
        at the tip are ignored."""
        return self.layout.state(
            (strains - self.nodal_rod.straight_state_strain) / self.sqrt_compliance, strains
        )

    def state_derivative(self, z: Array) -> Array:
        """dz/dt of states z, both (..., unknowns), with time in tau2."""
        rates = np.empty(z.shape)
        flat = z.reshape(-1, self.unknown_count), rates.reshape(-1, self.unknown_count)
        write_rates(*flat, self.sqrt_compliance, self.nodal_rod, self.mesh.node_matrices)
        return rates

    def jacobian(self, z: Array) -> Array:
        """Jacobians d(dz/dt)/dz, (..., unknowns, unknowns), of states z, (..., unknowns); time in tau2."""
        size = self.unknown_count
        jacobians = np.empty((*z.shape, size))
        states = z.reshape(-1, size)
        matrices = jacobians.reshape(-1, size, size)
        write_rate_jacobians(states, matrices, self.sqrt_compliance, self.nodal_rod, self.mesh.node_matrices)
        # The kernel writes columns, as LAPACK reads them.
        return jacobians.swapaxes(-1, -2)

    def tip_position_and_velocity(self, z: Array, direction: Array) -> tuple[Array, Array]:
        """Returns (position, velocity) of the tip, (3, ...) each: (x, y, theta) at z, in L and rad, and the
        derivative of (x, y, theta) by the time in tau2, for dz/dt = direction. z, direction: (..., unknowns).
        The velocity is a complex-step derivative."""
        shape = self._shape_and_velocities(z, direction)[..., -1]
        return shape.real, shape.imag / TIP_VELOCITY_SETTINGS.imaginary_step

    def y_velocities(self, z: Array, direction: Array) -> Array:
        """Time derivative of y, in L/tau2, at z for dz/dt = direction, at all nodes, (..., nodes + 1); z,
        direction: (..., unknowns)."""
        velocities: Array = (
            self._shape_and_velocities(z, direction)[1].imag / TIP_VELOCITY_SETTINGS.imaginary_step
        )
        return velocities

    def _shape_and_velocities(self, z: Array, direction: Array) -> Complex:
        """Complex-step evaluation of (x, y, theta) at all nodes, (3, ..., nodes + 1): the shape at z in the
        real part, the imaginary step times the velocity for dz/dt = direction in the imaginary part."""
        strain_rates = self.element_strain_rates(z, TIP_VELOCITY_SETTINGS.imaginary_step * direction)
        strains = self.element_strains(z) + 1j * strain_rates
        return shape_from_strains(self.mesh, strains, np.zeros(3)).astype(complex, copy=False)
