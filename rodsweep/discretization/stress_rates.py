"""The rod on a mesh as an explicit differential equation, for finite stiffnesses, compiled.

Its unknown is z = C^(1/2) S, the stresses of `stress_balance` in units of energy.
"""

import numpy as np

from ..arrays import Array
from ..model.compilation import compiled_for_vectors
from .mesh import NodeMatrices
from .nodal_rod import NodalRod
from .stress_balance import balance
from .stress_jacobian import jacobian


@compiled_for_vectors
def rate(z: Array, out: Array, roots: Array, c: NodalRod, m: NodeMatrices) -> None:
    """dz/dt in 1/tau2 into out, both (unknowns,), of z = C^(1/2) S; roots: of C, (d, nodes + 1), above 0."""
    d, size = c.drag.shape
    n = size - 1
    V, G, x = np.empty((d, size)), np.empty((d, size)), np.empty(d * n)
    for a in range(d):
        for i in range(n):
            x[a * n + i] = z[a * n + i] / roots[a, i]
    balance(x, V, G, c, m)
    for a in range(d):
        for i in range(n):
            out[a * n + i] = G[a, i] / (m.weights[i] * roots[a, i])


@compiled_for_vectors
def rate_jacobian(z: Array, out: Array, roots: Array, c: NodalRod, m: NodeMatrices) -> None:
    """d(dz/dt)/dz into out, (unknowns, unknowns), as LAPACK and PETSc store it: out[column, row]."""
    d, size = c.drag.shape
    n = size - 1
    V, G, x = np.empty((d, size)), np.empty((d, size)), np.empty(d * n)
    J, tip, inverse = np.empty((d * n, d * n)), np.empty((d, d * n)), np.empty((d, n))
    for a in range(d):
        for i in range(n):
            inverse[a, i] = 1 / roots[a, i]
            x[a * n + i] = z[a * n + i] / roots[a, i]
    balance(x, V, G, c, m)
    jacobian(x, V, J, tip, c, m)
    for a in range(d):
        for i in range(n):
            f = inverse[a, i] / m.weights[i]
            for b in range(d):
                for j in range(n):
                    out[b * n + j, a * n + i] = f * inverse[b, j] * J[a * n + i, b * n + j]


@compiled_for_vectors
def rates(states: Array, out: Array, roots: Array, c: NodalRod, m: NodeMatrices) -> None:
    """`rate` of each of the states, into out, both of shape (n, unknowns): one call for many."""
    for i in range(len(states)):
        rate(states[i], out[i], roots, c, m)


@compiled_for_vectors
def rate_jacobians(states: Array, out: Array, roots: Array, c: NodalRod, m: NodeMatrices) -> None:
    """`rate_jacobian` of each of the states, shape (n, unknowns), into out, (n, unknowns, unknowns)."""
    for i in range(len(states)):
        rate_jacobian(states[i], out[i], roots, c, m)
