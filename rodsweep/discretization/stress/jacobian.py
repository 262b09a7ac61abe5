"""The compiled exact Jacobian of the rod on a mesh with stresses as unknowns.

With A_ac = sum_b s_abc E_b and B_cb = d(ad*_E Sigma)_c/dS_b at each node, the derivative of G (see `balance`)
for a linear law is

    J_ab(i, j) = [a = b] (-D^T W Gamma_a^-1 D)_ij + (-D^T W)_ij (B_ab/Gamma_a)_j + w_i (A_ab/Gamma_b)_i D_ij
                 + [i = j] w_i (sum_c A_ac B_cb/Gamma_c + d(ad_E V)_a/dS_b at fixed V).

The sparsity patterns of the algebra, the first argument `g`, show which blocks are 0 for every E.

For another law, s(S) replaces S in Sigma, but not in E. The derivative above is the sum of a part P with
respect to Sigma and a part with respect to E. With the tangent T = ds/dS of the law, local at each node, J
becomes J - P + P T.
"""

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.compiled.unrolling import UnrolledOverAlgebra
from ...model.lie_algebra import LieAlgebra
from ...model.material.jump import tangent_at_jump
from ...model.material.stress_strain import LINEAR_LAW_NUMBER, LocalSection, stress_tangent
from ..elements.mesh import NodeMatrices
from ..nodal_rod import NodalRod
from ..state_layout import stress_index, velocity_index
from .balance import write_strains_and_stresses


@UnrolledOverAlgebra
def write_jacobian(  # noqa: PLR0913, PLR0917 - a tuple of arrays would count references at each use
    g: LieAlgebra, x: Array, V: Array, J: Array, tip: Array, c: NodalRod, m: NodeMatrices
) -> None:
    """Writes the Jacobian of the equations at the state x, (unknowns,), into J, (unknowns, unknowns).

    V: velocity at x, (d, nodes + 1). Rows of J are equations in the order of the unknowns: G at all nodes
    except the tip, then the balance of each unknown component of V. tip: output, derivative of the reaction
    at the tip, (d, unknowns).
    """
    size = len(m.quadrature_weights)
    E = np.empty((g.dimension, size))
    S = np.empty((g.dimension, size))
    write_strains_and_stresses(g, x, E, S, c)
    _write_linear_law_jacobian(g, (E, S, V), J, tip, c.compliance, c, m)
    if c.law_number != LINEAR_LAW_NUMBER:
        P = np.empty(J.shape)
        tip_P = np.empty(tip.shape)
        # With compliances of 0 the strain is fixed, so the derivative is P.
        _write_linear_law_jacobian(g, (E, S, V), P, tip_P, np.zeros(c.compliance.shape), c, m)
        # Unknown velocities do not depend on the law, so their columns of P are not used.
        _add_law_tangent_minus_identity(x, J, P, c)
        _add_law_tangent_minus_identity(x, tip, tip_P, c)


@compiled
def _add_law_tangent_minus_identity(x: Array, J: Array, P: Array, c: NodalRod) -> None:
    """Adds P (T - 1) to J, (rows, unknowns) each. P: part of the Jacobian, see the module docstring. T:
    tangent of the law of the rod `c` at the state x."""
    n = c.compliance.shape[1] - 1
    k = 0
    for i in range(n):
        p1 = stress_index(0, i, n)
        p3 = stress_index(2, i, n)
        if k < len(c.jump_nodes) and c.jump_nodes[k] == i:
            T = tangent_at_jump(c.law_number, c.jump_side_coefficients[k], x[p1], x[p3])
            k += 1
        else:
            material = LocalSection(c.straight_state_strain[0, i], c.compliance[0, i], c.compliance[2, i])
            T = stress_tangent(c.law_number, material, x[p1], x[p3])
        for row in range(len(J)):
            by_pull = P[row, p1]
            by_moment = P[row, p3]
            # T - 1, because J already has the derivative of a linear law, T = 1.
            J[row, p1] += by_pull * (T.N1 - 1) + by_moment * T.M1
            J[row, p3] += by_pull * T.N3 + by_moment * (T.M3 - 1)


@UnrolledOverAlgebra
def _write_linear_law_jacobian(  # noqa: PLR0913, PLR0917 - as above
    g: LieAlgebra,
    fields: tuple[Array, Array, Array],
    J: Array,
    tip: Array,
    compliance: Array,
    c: NodalRod,
    m: NodeMatrices,
) -> None:
    """Writes the derivative of the equations with respect to the stresses S, for a linear law, into J and
    tip. fields: strains E, s(S) of the law and velocities V at all nodes, (d, nodes + 1) each. compliance:
    dE/dS, (d, nodes + 1); arrays of 0 give the part P with respect to Sigma only. J: (unknowns, unknowns).
    tip: (d, unknowns)."""
    slopes = np.empty((g.dimension, g.dimension, len(m.quadrature_weights)))
    _write_velocity_derivatives(g, fields, slopes, compliance, c)
    _write_rate_derivatives(g, fields, slopes, J, tip, compliance, c, m)
    for k in range(len(c.unknown_velocity_components)):
        _write_unknown_velocity_columns(g, k, fields[0], J, tip, c, m)
        _write_unknown_velocity_rows(g, k, fields, J, compliance, c, m)


@UnrolledOverAlgebra
def _write_velocity_derivatives(
    g: LieAlgebra, fields: tuple[Array, Array, Array], slopes: Array, compliance: Array, c: NodalRod
) -> None:
    """Writes the derivatives of the velocities with respect to the stresses of the same node into the nonzero
    blocks of slopes.

    slopes: (d, d, nodes + 1), mobility times the derivative B of ad*_E Sigma; the term with the derivative
    matrix D is not included. fields: strains E, s(S) of the law and velocities V at all nodes, (d, nodes + 1)
    each. compliance: dE/dS, (d, nodes + 1).
    """
    E, S, _ = fields
    for i in range(slopes.shape[2]):
        B = [[0.0 for _ in g.component_indices] for _ in g.component_indices]
        for a, b, o, sign in g.structure_constants:
            B[o][a] -= sign * E[b, i]
            # Product rule: E = E0 + C S depends on S as well.
            B[o][b] -= sign * compliance[b, i] * (c.tip_stress[a] + S[a, i])
        for o in g.component_indices:
            for b in g.component_indices:
                if g.coad_derivative_pattern[o][b]:
                    slopes[o, b, i] = c.mobility[o, i] * B[o][b]


@UnrolledOverAlgebra
def _write_rate_derivatives(  # noqa: PLR0912, PLR0913, PLR0917 - as above; what the algebra decides is no branch
    g: LieAlgebra,
    fields: tuple[Array, Array, Array],
    slopes: Array,
    J: Array,
    tip: Array,
    compliance: Array,
    c: NodalRod,
    m: NodeMatrices,
) -> None:
    """Writes the derivative of the strain rates G with respect to the stresses S into J, (unknowns,
    unknowns), and tip, (d, unknowns). fields: strains E, s(S) of the law and velocities V at all nodes, (d,
    nodes + 1) each. compliance: dE/dS, (d, nodes + 1). slopes: result of `_write_velocity_derivatives`."""
    n = len(m.quadrature_weights) - 1
    E, _, V = fields
    for i in range(n + 1):
        A = [[0.0 for _ in g.component_indices] for _ in g.component_indices]  # weighted
        for a, b, o, sign in g.structure_constants:
            A[a][o] += sign * m.quadrature_weights[i] * E[b, i]
        rate_block = [[A[a][o] * c.mobility[o, i] for o in g.component_indices] for a in g.component_indices]
        rows = [J[stress_index(a, i, n)] if i < n else tip[a] for a in g.component_indices]
        for a in g.component_indices:
            for j in range(n):
                # -D^T W Gamma^-1 D does not depend on the state and is computed once per rod.
                rows[a][stress_index(a, j, n)] = c.mobility_laplacian[a, i, j]
        for j in range(n):
            weak_entry = m.weak_derivative_matrix[i, j]
            slope = m.differentiation_matrix[i, j]
            for a, b in g.ordered_distinct_pairs:
                coupling = weak_entry * slopes[a, b, j] if g.coad_derivative_pattern[a][b] else 0.0
                rows[a][stress_index(b, j, n)] = coupling + (
                    rate_block[a][b] * slope if g.ad_pattern[a][b] else 0.0
                )
        # The stress of the tip is prescribed and has no column.
        if i < n:
            diagonal_block = [[0.0 for _ in g.component_indices] for _ in g.component_indices]
            for a, b, o, sign in g.structure_constants:
                diagonal_block[a][b] += sign * m.quadrature_weights[i] * compliance[b, i] * V[o, i]
            for a, o in g.ordered_distinct_pairs:
                for b in g.component_indices:
                    # Unrolling leaves out pairs that are 0 for every strain.
                    if g.ad_pattern[a][o] and g.coad_derivative_pattern[o][b]:
                        diagonal_block[a][b] += A[a][o] * slopes[o, b, i]
            for a in g.component_indices:
                for b in g.component_indices:
                    rows[a][stress_index(b, i, n)] += diagonal_block[a][b]


@UnrolledOverAlgebra
def _write_unknown_velocity_columns(  # noqa: PLR0913, PLR0917 - as above
    g: LieAlgebra, k: int, E: Array, J: Array, tip: Array, c: NodalRod, m: NodeMatrices
) -> None:
    """Writes the derivative of the strain rates G with respect to the k-th unknown velocity component into J
    and tip. E: strains, (d, nodes + 1). J: (unknowns, unknowns). tip: (d, unknowns)."""
    size = len(m.quadrature_weights)
    n = len(m.quadrature_weights) - 1
    component = c.unknown_velocity_components[k]
    first = velocity_index(k, 0, g.dimension, n)
    for i in range(size):
        rows = [J[stress_index(a, i, n)] if i < n else tip[a] for a in g.component_indices]
        for a in g.component_indices:
            for j in range(size):
                rows[a][first + j] = m.weak_derivative_matrix[i, j] if component == a else 0.0
        for a, b, o, sign in g.structure_constants:
            if o == component:
                rows[a][first + i] += sign * m.quadrature_weights[i] * E[b, i]


@UnrolledOverAlgebra
def _write_unknown_velocity_rows(  # noqa: PLR0913, PLR0917 - as above
    g: LieAlgebra,
    k: int,
    fields: tuple[Array, Array, Array],
    J: Array,
    compliance: Array,
    c: NodalRod,
    m: NodeMatrices,
) -> None:
    """Writes the rows of the balance of the k-th unknown velocity component into J, (unknowns, unknowns).
    fields: strains E, s(S) of the law and velocities V at all nodes, (d, nodes + 1) each. compliance: dE/dS,
    (d, nodes + 1)."""
    size = len(m.quadrature_weights)
    n = len(m.quadrature_weights) - 1
    component = c.unknown_velocity_components[k]
    E, S, _ = fields
    first = velocity_index(k, 0, g.dimension, n)
    for i in range(size):
        row = J[first + i]
        w = m.quadrature_weights[i]
        row[:] = 0.0
        for j in range(n):
            row[stress_index(component, j, n)] = w * m.differentiation_matrix[i, j]
        row[first + i] = -w * c.drag[component, i]
        if i < n:
            for a, b, o, sign in g.structure_constants:
                if o == component:
                    row[stress_index(a, i, n)] -= w * sign * E[b, i]
                    row[stress_index(b, i, n)] -= w * sign * compliance[b, i] * (c.tip_stress[a] + S[a, i])
