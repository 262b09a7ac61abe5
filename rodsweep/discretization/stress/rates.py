"""The compiled rod on a mesh as an explicit differential equation dz/dt = f(z), for finite stiffnesses.

The unknown is z = C^(1/2) S, with the stresses S of `write_balance` and the nodal compliances C; z^2 is an
energy density."""

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled_with_reordered_sums
from ..elements.mesh import NodeMatrices
from ..nodal_rod import NodalRod
from ..plane_equations import write_balance, write_jacobian
from ..state_layout import stress_index


@compiled_with_reordered_sums
def write_rate(z: Array, out: Array, roots: Array, c: NodalRod, m: NodeMatrices) -> None:
    """Writes dz/dt, with time in tau2, of the state z into out; z, out: (unknowns,). roots: positive square
    roots of the compliances C at the nodes, (d, nodes + 1)."""
    d, size = c.drag.shape
    V = np.empty((d, size))
    G = np.empty((d, size))
    x = np.empty(len(z))
    _write_stresses_of_state(z, x, roots)
    write_balance(x, V, G, c, m)
    for a in range(d):
        for i in range(size - 1):
            # W C dS/dt = G with z = C^(1/2) S, so dz/dt = G/(W C^(1/2)).
            out[stress_index(a, i, size - 1)] = G[a, i] / (m.quadrature_weights[i] * roots[a, i])


@compiled_with_reordered_sums
def _write_stresses_of_state(z: Array, x: Array, roots: Array) -> None:
    """Writes the stresses S = C^(-1/2) z into x; x, z: (unknowns,). roots: square roots of the
    compliances at the nodes, (d, nodes + 1)."""
    d = roots.shape[0]
    n = roots.shape[1] - 1
    for a in range(d):
        for i in range(n):
            index = stress_index(a, i, n)
            x[index] = z[index] / roots[a, i]


@compiled_with_reordered_sums
def write_rate_jacobian(z: Array, out: Array, roots: Array, c: NodalRod, m: NodeMatrices) -> None:
    """Writes the Jacobian d(dz/dt)/dz at the state z, (unknowns,), into out, (unknowns, unknowns). out is
    column-major: out[column, row]. roots: square roots of the compliances at the nodes, (d, nodes + 1)."""
    d, size = c.drag.shape
    unknowns = len(z)
    V = np.empty((d, size))
    G = np.empty((d, size))
    x = np.empty(unknowns)
    J = np.empty((unknowns, unknowns))
    tip = np.empty((d, unknowns))
    _write_stresses_of_state(z, x, roots)
    write_balance(x, V, G, c, m)
    write_jacobian(x, V, J, tip, c, m)
    scale = np.empty(unknowns)
    inverse = np.empty(unknowns)
    for a in range(d):
        for i in range(size - 1):
            index = stress_index(a, i, size - 1)
            inverse[index] = 1 / roots[a, i]
            scale[index] = inverse[index] / m.quadrature_weights[i]
    for p in range(unknowns):
        for q in range(unknowns):
            out[q, p] = scale[p] * inverse[q] * J[p, q]


@compiled_with_reordered_sums
def write_rates(states: Array, out: Array, roots: Array, c: NodalRod, m: NodeMatrices) -> None:
    """Writes dz/dt of n states z into out; states, out: (n, unknowns). roots: square roots of the
    compliances at the nodes, (d, nodes + 1)."""
    for i in range(len(states)):
        write_rate(states[i], out[i], roots, c, m)


@compiled_with_reordered_sums
def write_rate_jacobians(states: Array, out: Array, roots: Array, c: NodalRod, m: NodeMatrices) -> None:
    """Writes the Jacobians of `write_rate_jacobian` at n states z, (n, unknowns), into out, (n, unknowns,
    unknowns). roots: square roots of the compliances at the nodes, (d, nodes + 1)."""
    for i in range(len(states)):
        write_rate_jacobian(states[i], out[i], roots, c, m)
