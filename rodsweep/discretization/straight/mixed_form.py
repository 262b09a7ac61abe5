"""The nonlinear rod in the plane in mixed form on a mesh: stresses and velocities in the body frame are
unknowns.

The balance is given in `rodsweep.model.balance`. S is the stress of a linear rod with the same strain minus
the stress of the straight rod, (n1 + F, n2, m3), and V = (v1, v2, Omega3). W are the quadrature weights, D is
the differentiation matrix, and s(S) is the constitutive law, s(S) = S for a linear rod:

    W C dS/dt = -D^T W V + W ad_E V          at all nodes but the tip; the clamp V(0) = 0 is natural
    0         = W (D*_E Sigma - Gamma V)     at all nodes; Sigma = (-F, 0, 0) + s(S); S(1) = 0 is essential

where E = (nu, 0, 0) + C S. With X = (S; v1, v2, Omega3) this is

    M dX/dt = A X + B(X, X)/2 + C(X, X, X)/6 + ...,

where only a nonlinear law has terms beyond the quadratic terms. No formula contains a stiffness or the
inverse of a drag, so c1 = c2 = gamma3 = 0 are allowed. M is singular: components of X without a time
derivative satisfy algebraic equations. On several elements e the fields are continuous, and D = W^-1 sum_e
W_e D_e. Summation by parts, W D + D^T W = diag(-1, 0, ..., 0, 1), and therefore the energy law hold to
rounding on every mesh.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import Array
from ...model.balance import Values, ad, coad
from ..elements.mesh import Mesh, shape_integration_matrices
from ..rod_on_mesh import RodOnMesh, broadcast_to_field
from ..state_layout import SE2_DIMENSION
from .law_derivatives import LawDerivativesAtRest, law_derivatives_at_rest

REFLECTION_SIGNS = np.array([1.0, -1.0, -1.0])
"""Signs of the components of a stress or a velocity under reflection in the axis of the straight rod."""


@dataclass(frozen=True, eq=False)
class MixedForm(RodOnMesh):
    """One rod on one mesh in mixed form; k1, k2 may be inf and gamma3 may be 0.

    A state X has the shape (..., unknowns). With N = mesh.node_count, X contains N values of S1 and of S2
    (k3/L^2) and of S3 (k3/L) at all nodes except the tip, then N + 1 values of v1 and of v2 (L/tau2) and of
    Omega3 (1/tau2) at all nodes. X may be complex.
    """

    @property
    def unknown_velocity_components(self) -> tuple[int, ...]:
        return tuple(range(SE2_DIMENSION))

    @cached_property
    def law_derivatives(self) -> LawDerivativesAtRest:
        """Derivatives of the constitutive law s(S) at S = 0, the straight rod under its load, at all
        nodes."""
        return law_derivatives_at_rest(self.rod, self.nodal_rod)

    @cached_property
    def reflection_signs(self) -> Array:
        """Diagonal of the reflection R, +1 or -1, (unknowns,). If X solves the equations, so does R X."""
        signs = np.repeat(REFLECTION_SIGNS[:, None], self.mesh.node_count + 1, axis=1)
        return self.layout.state(signs, signs)

    @cached_property
    def M(self) -> Array:
        """Diagonal of the matrix M, (unknowns,): W C for stresses, 0 for velocities."""
        weighted = self.nodal_rod.compliance * self.mesh.quadrature_weights
        return self.layout.state(weighted, np.zeros(weighted.shape))

    @cached_property
    def A_terms_without_derivative(self) -> tuple[Array, Array]:
        """Returns (W ad_E, W (ad*_E T + ad*_{C .} Sigma)), the terms of A without the differentiation matrix
        and the drag; T: tangent of the law. Both map components at a node to equations at the same node, for
        each node but the tip: (equation, component, node), (3, 3, nodes). The first term acts on V in the
        equations of S, the second on S in the equations of V. The tip contributes nothing: s = 0, and E
        enters only the equation of S(1), which is not solved."""
        nodal = self.nodal_rod
        W = self.mesh.quadrature_weights[:-1]
        identity = np.eye(SE2_DIMENSION)[:, :, None]
        E = nodal.straight_state_strain[:, None, :-1]
        stress_part = identity * self.law_derivatives.law_tangent[None, :, :-1]
        strain_part = identity * nodal.compliance[None, :, :-1]
        forces = coad(E, stress_part) + coad(strain_part, nodal.tip_stress[:, None, None])
        return W * ad(E, identity), W * forces

    def times_force_derivative_of_A(self, X: Values) -> Values:
        """Product (dA/dF) X for states X, (..., unknowns): dA/dF is the derivative of A by the force."""
        S, V = self.stresses_and_velocities(X)
        W = self.mesh.quadrature_weights
        derivatives_by_force = self.law_derivatives.derivatives_by_force
        E = axial_field(derivatives_by_force.nu)
        dE = broadcast_to_field(derivatives_by_force.law_tangent, S) * S
        Sigma = axial_field(-np.ones(len(W)))
        rest_strain = broadcast_to_field(self.nodal_rod.straight_state_strain, S)
        # F enters through the strain at rest, the tangent at rest, and Sigma1 = -F.
        forces = coad(broadcast_to_field(E, S), self._linearised_stress(S)) + coad(rest_strain, dE)
        forces = forces + coad(self._compliance_times_stress(S), broadcast_to_field(Sigma, S))
        return self.layout.state(
            W * ad(broadcast_to_field(E, V), V), W * forces + self._weights_times_derivative(dE)
        )

    @cached_property
    def tip_y_functional(self) -> Array:
        """Vector, (unknowns,), whose product with X is the deflection y of the tip in L, to first order. y =
        int c2 S2 + c3 S3(u) (int_u^1 nu) du."""
        W = self.mesh.quadrature_weights[:-1]
        c = self.nodal_rod.compliance[:, :-1]
        return self.layout.state_with_stresses(
            {
                "n2": c[1] * W,
                "m3": c[2] * integral_to_tip(self.mesh, self.nodal_rod.straight_state_strain[0])[:-1] * W,
            }
        )

    def stresses_and_velocities(self, X: Values) -> tuple[Values, Values]:
        """Returns (S, V), stresses and velocities of states X at all nodes, tip included, (3, ..., nodes + 1)
        each."""
        return self.stresses(X), self.layout.velocities(X)

    def bilinear_map(self, X: Values, Y: Values) -> Values:
        """The symmetric bilinear map B(X, Y) of the quadratic terms; X, Y and result: (..., unknowns)."""
        S, U = self.stresses_and_velocities(X)
        T, V = self.stresses_and_velocities(Y)
        CS = self._compliance_times_stress(S)
        CT = self._compliance_times_stress(T)
        W = self.mesh.quadrature_weights
        forces: Values = W * (coad(CS, self._linearised_stress(T)) + coad(CT, self._linearised_stress(S)))
        if self.law_derivatives.is_nonlinear:
            second_derivative = self.law_derivatives.second_derivative_form(S, T)
            forces = (
                forces
                + W * coad(broadcast_to_field(self.nodal_rod.straight_state_strain, S), second_derivative)
                + self._weights_times_derivative(second_derivative)
            )
        return self.layout.state(W * (ad(CS, V) + ad(CT, U)), forces)

    def trilinear_map(self, X: Values, Y: Values, Z: Values) -> Values:
        """The symmetric trilinear form C(X, Y, Z) of the cubic terms, (..., unknowns); 0 for a linear law."""
        S, T, R = (self.stresses(state) for state in (X, Y, Z))
        W = self.mesh.quadrature_weights
        law = self.law_derivatives
        third_derivative = law.third_derivative_form(S, T, R)
        forces = W * coad(
            broadcast_to_field(self.nodal_rod.straight_state_strain, S), third_derivative
        ) + self._weights_times_derivative(third_derivative)
        for first, second, third_factor in ((S, T, R), (T, R, S), (R, S, T)):
            forces = forces + W * coad(
                self._compliance_times_stress(first), law.second_derivative_form(second, third_factor)
            )
        return self.layout.state(np.zeros_like(forces), forces)

    def _compliance_times_stress(self, S: Values) -> Values:
        """The strain C S, relative to the straight rod, at all nodes, (3, ..., nodes + 1)."""
        return broadcast_to_field(self.nodal_rod.compliance, S) * S

    def _linearised_stress(self, S: Values) -> Values:
        """The law s(S) to first order in S, at all nodes, (3, ..., nodes + 1)."""
        return broadcast_to_field(self.law_derivatives.law_tangent, S) * S

    def _weights_times_derivative(self, field: Values) -> Values:
        """W D times a field at all nodes, both (3, ..., nodes + 1)."""
        return field @ -self.mesh.node_matrices.weak_derivative_matrix


def axial_field(values: Array) -> Array:
    """The field with components (values, 0, 0), (3, nodes + 1); values: (nodes + 1,)."""
    field = np.zeros((SE2_DIMENSION, len(values)))
    field[0] = values
    return field


def integral_to_tip(mesh: Mesh, values: Array) -> Array:
    """Integral of a field from each node to the tip, (nodes + 1,). values: values of the field at all nodes,
    (nodes + 1,). mesh: a mesh without node spacing ratios, on which positions are linear in the coordinates
    of the elements."""
    total = np.zeros(mesh.node_count + 1)
    for nodes, order, length in zip(mesh.node_ranges, mesh.orders, mesh.lengths, strict=True):
        ends = shape_integration_matrices(order).nodal_integrals_to_nodes
        total[nodes] = total[nodes.start] + length * (values[nodes] @ ends)
    return total[-1] - total
