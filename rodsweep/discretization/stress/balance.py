"""The compiled balance of the nonlinear rod on a mesh with stresses as unknowns.

Sec. III, second formulation, in the plane or in space, according to the argument `g`, an algebra of
`model.lie_algebra`. The unknowns S are the stresses of a linear rod with the same strain, minus the stresses
of the straight rod, at every node except the tip, where S = 0. With the compliances C and the drags Gamma of
each node, the assembled differentiation matrix D, the weights W of the nodes, and the strain E0 of the
straight rod under its force,

    E = E0 + C S,    Sigma = Sigma(1) + s(S),    Gamma V = D*_E Sigma = D s(S) + ad*_E Sigma,
    W C dS/dt = G(S) = -D^T W V + W ad_E V.

The constitutive law s(S) is local at each node (`rodsweep.model.material.stress_strain`); s(S) = S for a
linear rod. The strain is affine in S for every law, so the matrix W C of dS/dt is constant and diagonal. At a
node where the material jumps, E is the mean strain of both sides, and s(S) is the stress, which is equal on
both sides (`rodsweep.model.material.jump`).

A compliance may be 0, since no formula divides by a compliance; the corresponding stress then has no time
derivative. The tip condition S = 0 is essential; G at the tip is its reaction r, and -r is the velocity of
the tip: -r converges twice as fast as V(1), and dU/dt = -Sigma(1) r - <Gamma V, V> holds to rounding. The
clamp V(0) = 0 is natural.

V is eliminated, except components with a drag so small that division by the drag costs digits. These are
unknowns at all nodes, tip included, with the equations W (D*_E Sigma - Gamma V) = 0. A state is flat: S1 at
every node, S2 at every node, and so on, then the unknown components of V.

Notation of all functions: x: state, (unknowns,). c: the rod at the nodes. m: matrices of the mesh. d:
dimension of g. See also `rodsweep.model.balance` (without a mesh), `mixed_form` (all of V as unknowns) and
`jacobian`.
"""

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.compiled.unrolling import UnrolledOverAlgebra
from ...model.lie_algebra import LieAlgebra
from ...model.material.jump import stress_at_jump, stress_parameter_derivative_at_jump
from ...model.material.stress_strain import (
    LINEAR_LAW_NUMBER,
    LocalSection,
    stress_minus_rest_stress,
    stress_parameter_derivative,
)
from ..elements.mesh import NodeMatrices
from ..nodal_rod import NodalRod, NodalRodDerivative
from ..state_layout import stress_index, velocity_index


@UnrolledOverAlgebra
def write_strains_and_stresses(g: LieAlgebra, x: Array, E: Array, S: Array, c: NodalRod) -> None:
    """Writes strains and stresses of a state x, (unknowns,), at all nodes into E and S, (d, nodes + 1)."""
    size = E.shape[1]
    for i in range(size):
        s = [x[stress_index(a, i, size - 1)] if i < size - 1 else 0.0 for a in g.component_indices]
        for a in g.component_indices:
            E[a, i] = c.straight_state_strain[a, i] + c.compliance[a, i] * s[a]
            S[a, i] = s[a]
    if c.law_number != LINEAR_LAW_NUMBER:
        replace_by_law_stresses(S, c)


@compiled
def replace_by_law_stresses(S: Array, c: NodalRod) -> None:
    """Replaces the unknown stresses S at all nodes, (3, nodes + 1), by s(S), for a rod in the plane."""
    k = 0
    for i in range(S.shape[1]):
        if k < len(c.jump_nodes) and c.jump_nodes[k] == i:
            S[0, i], S[2, i] = stress_at_jump(c.law_number, c.jump_side_coefficients[k], S[0, i], S[2, i])
            k += 1
        else:
            material = LocalSection(c.straight_state_strain[0, i], c.compliance[0, i], c.compliance[2, i])
            S[0, i], S[2, i] = stress_minus_rest_stress(c.law_number, material, S[0, i], S[2, i])


@UnrolledOverAlgebra
def write_force_densities(
    g: LieAlgebra, E: Array, S: Array, out: Array, c: NodalRod, m: NodeMatrices
) -> None:
    """Writes the forces per length D*_E Sigma at all nodes into out, (d, nodes + 1). E, S: strains and
    stresses from `write_strains_and_stresses`, (d, nodes + 1) each."""
    size = len(m.quadrature_weights)
    out[:, :] = 0.0
    # The stress at the tip is 0 and has no column.
    for j in range(size - 1):
        s = [S[a, j] for a in g.component_indices]
        for i in range(size):
            # Loops over components are innermost because they are unrolled; D is read along rows.
            slope = m.transposed_differentiation_matrix[j, i]
            for a in g.component_indices:
                out[a, i] += slope * s[a]
    for i in range(size):
        force = [out[a, i] for a in g.component_indices]
        for a, b, o, sign in g.structure_constants:
            # Minus: ad*_E is minus the transpose of (ad_E V)_a = sum s_abo E_b V_o. The tip stress is
            # constant along the rod, so it enters only here.
            force[o] -= sign * E[b, i] * (c.tip_stress[a] + S[a, i])
        for a in g.component_indices:
            out[a, i] = force[a]


@UnrolledOverAlgebra
def write_strain_rates(g: LieAlgebra, E: Array, V: Array, G: Array, m: NodeMatrices) -> None:
    """Writes the strain rates W (V' + ad_E V) at all nodes, in weak form, into G. E: strains. V: velocities.
    E, V, G: (d, nodes + 1)."""
    size = len(m.quadrature_weights)
    for i in range(size):
        rate = [0.0 for _ in g.component_indices]
        for a, b, o, sign in g.structure_constants:
            rate[a] += sign * E[b, i] * V[o, i]
        for a in g.component_indices:
            G[a, i] = m.quadrature_weights[i] * rate[a]
    add_weak_derivative(g, V, G, m)


@UnrolledOverAlgebra
def add_weak_derivative(g: LieAlgebra, V: Array, G: Array, m: NodeMatrices) -> None:
    """Adds -D^T W V to G, both (d, nodes + 1)."""
    size = len(m.quadrature_weights)
    for j in range(size):
        v = [m.quadrature_weights[j] * V[a, j] for a in g.component_indices]
        for i in range(size):
            slope = m.differentiation_matrix[j, i]
            for a in g.component_indices:
                G[a, i] -= slope * v[a]


@UnrolledOverAlgebra
def write_velocities_and_rates(
    g: LieAlgebra, x: Array, V: Array, G: Array, c: NodalRod, m: NodeMatrices
) -> None:
    """Writes the velocities V and the strain rates G = W C dS/dt of a state x, (unknowns,), at all nodes into
    V and G, (d, nodes + 1) each. Unknown components of V are copied from x."""
    size = len(m.quadrature_weights)
    E = np.empty((g.dimension, size))
    S = np.empty((g.dimension, size))
    write_strains_and_stresses(g, x, E, S, c)
    write_force_densities(g, E, S, V, c, m)
    for i in range(size):
        for a in g.component_indices:
            V[a, i] *= c.mobility[a, i]
    for k in range(len(c.unknown_velocity_components)):
        for i in range(size):
            # The loop above has set these components to 0, because their mobility is 0.
            V[c.unknown_velocity_components[k], i] = x[velocity_index(k, i, g.dimension, size - 1)]
    write_strain_rates(g, E, V, G, m)


@UnrolledOverAlgebra
def write_velocity_residuals(g: LieAlgebra, x: Array, out: Array, c: NodalRod, m: NodeMatrices) -> None:
    """Writes the residuals W (D*_E Sigma - Gamma V) of the unknown components of V into out, (unknowns,). x:
    state, (unknowns,). Entries of out for stresses are not changed."""
    size = len(m.quadrature_weights)
    E = np.empty((g.dimension, size))
    S = np.empty((g.dimension, size))
    force = np.empty((g.dimension, size))
    write_strains_and_stresses(g, x, E, S, c)
    write_force_densities(g, E, S, force, c, m)
    for k in range(len(c.unknown_velocity_components)):
        a = c.unknown_velocity_components[k]
        for i in range(size):
            index = velocity_index(k, i, g.dimension, size - 1)
            out[index] = m.quadrature_weights[i] * (force[a, i] - c.drag[a, i] * x[index])


@compiled
def write_law_derivative(x: Array, dS: Array, change: NodalRodDerivative, c: NodalRod) -> None:
    """Writes the derivative of s(S) with respect to a parameter, at fixed S, into dS, (3, nodes + 1). x: a
    state in the plane, (unknowns,). change: derivative of the rod `c` with respect to the parameter."""
    n = dS.shape[1] - 1
    k = 0
    for i in range(n + 1):
        # At the tip S = 0.
        q1, q3 = (x[stress_index(0, i, n)], x[stress_index(2, i, n)]) if i < n else (0.0, 0.0)
        if k < len(c.jump_nodes) and c.jump_nodes[k] == i:
            dS[0, i], dS[2, i] = stress_parameter_derivative_at_jump(
                c.law_number, c.jump_side_coefficients[k], change.jump_side_coefficients[k], q1, q3
            )
            k += 1
            continue
        material = LocalSection(c.straight_state_strain[0, i], c.compliance[0, i], c.compliance[2, i])
        material_derivative = LocalSection(
            change.straight_state_strain[0, i], change.compliance[0, i], change.compliance[2, i]
        )
        dS[0, i], dS[2, i] = stress_parameter_derivative(c.law_number, material, material_derivative, q1, q3)


@UnrolledOverAlgebra
def write_balance_parameter_derivative(  # noqa: PLR0913, PLR0917 - a tuple of arrays would count references at each use
    g: LieAlgebra, x: Array, V: Array, out: Array, change: NodalRodDerivative, c: NodalRod, m: NodeMatrices
) -> None:
    """Writes the derivatives of the equations with respect to a parameter, at a fixed state x, (unknowns,),
    into out.

    out: (3, d, nodes + 1). out[0]: derivative of D*_E Sigma - Gamma V at fixed V; out[1]: derivative of V;
    out[2]: derivative of G. V: velocity at x, (d, nodes + 1). change: derivative of the rod `c` with respect
    to the parameter. Unknown components of V are fixed.
    """
    size = len(m.quadrature_weights)
    E = np.empty((g.dimension, size))
    S = np.empty((g.dimension, size))
    dS = np.zeros((g.dimension, size))
    write_strains_and_stresses(g, x, E, S, c)
    if c.law_number != LINEAR_LAW_NUMBER:
        write_law_derivative(x, dS, change, c)
    for i in range(size):
        s = [x[stress_index(a, i, size - 1)] if i < size - 1 else 0.0 for a in g.component_indices]
        dE = [
            change.straight_state_strain[a, i] + change.compliance[a, i] * s[a] for a in g.component_indices
        ]
        # The derivative of Gamma V = D* Sigma at a fixed state: Gamma dV = d(force) - dGamma V.
        force = [-change.drag[a, i] * V[a, i] for a in g.component_indices]
        if c.law_number != LINEAR_LAW_NUMBER:
            for j in range(size):
                for a in g.component_indices:
                    force[a] += m.differentiation_matrix[i, j] * dS[a, j]
        for a, b, o, sign in g.structure_constants:
            stress_derivative = change.tip_stress[a] + dS[a, i]
            force[o] -= sign * (dE[b] * (c.tip_stress[a] + S[a, i]) + E[b, i] * stress_derivative)
        dV = [c.mobility[a, i] * force[a] for a in g.component_indices]
        rate = [0.0 for _ in g.component_indices]
        for a, b, o, sign in g.structure_constants:
            rate[a] += sign * (dE[b] * V[o, i] + E[b, i] * dV[o])
        for a in g.component_indices:
            out[0, a, i] = force[a]
            out[1, a, i] = dV[a]
            out[2, a, i] = m.quadrature_weights[i] * rate[a]
    add_weak_derivative(g, out[1], out[2], m)
