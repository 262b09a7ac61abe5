"""The exact Jacobian of the rod on a mesh with its stresses as unknowns, compiled.

With A_ac = sum_b s_abc E_b and B_cb = d(ad*_E Sigma)_c/dS_b at each node the derivative of G,
see `stress_balance`, consists of

    J_ab(i, j) = [a = b] (-D^T W Gamma_a^-1 D)_ij + (-D^T W)_ij (B_ab/Gamma_a)_j + w_i (A_ab/Gamma_b)_i D_ij
                 + [i = j] w_i (sum_c A_ac B_cb/Gamma_c + d(ad_E V)_a/dS_b at fixed V).

Blocks that vanish for every E are skipped.
"""

import numpy as np

from ..arrays import Array
from ..model.compilation import compiled_for_vectors
from .mesh import NodeMatrices
from .nodal_rod import NodalRod
from .stress_balance import strains_and_stresses


@compiled_for_vectors
def jacobian(x: Array, V: Array, J: Array, tip: Array, c: NodalRod, m: NodeMatrices) -> None:
    """The derivative of the equations at x, of which V is known, into J, (unknowns, unknowns).

    Rows are equations, in the order of the unknowns: G at all nodes but the tip, then the balance of each V
    that is unknown. tip, (d, unknowns): the derivative of the reaction.
    """
    d, size = V.shape
    n, local = size - 1, np.zeros((4, d, d, size))
    _local_slopes(x, V, local, c)
    for a in range(d):
        for b in range(d):
            _fill_block(a, b, local, J, tip, c, m)
            for i in range(n):
                J[a * n + i, b * n + i] += m.weights[i] * local[3, a, b, i]
    for k in range(len(c.kept)):
        _kept_columns(k, local[0], J, tip, c, m)
        _kept_rows(k, local[1], J, c, m)


@compiled_for_vectors
def _fill_block(  # noqa: PLR0913, PLR0917 - a tuple of arrays would count references at each use
    a: int, b: int, local: Array, J: Array, tip: Array, c: NodalRod, m: NodeMatrices
) -> None:
    """The block (a, b) of `jacobian`, but for its diagonal, into J and tip; local as in `_local_slopes`."""
    size = len(m.weights)
    n, terms = size - 1, local[2, a, b]
    first = b * n
    if a == b:
        for i in range(size):
            row, second = J[a * n + i] if i < n else tip[a], c.second[a, i]
            for j in range(n):
                row[first + j] = second[j]
    elif c.algebra.forward[a, b]:
        for i in range(size):
            row, weak, slopes = J[a * n + i] if i < n else tip[a], m.weak[i], m.D[i]
            factor = m.weights[i] * local[0, a, b, i] * c.mobility[b, i]
            for j in range(n):
                row[first + j] = weak[j] * terms[j] + factor * slopes[j]
    elif c.algebra.backward[a, b]:
        for i in range(size):
            row, weak = J[a * n + i] if i < n else tip[a], m.weak[i]
            for j in range(n):
                row[first + j] = weak[j] * terms[j]
    else:
        for i in range(size):
            row = J[a * n + i] if i < n else tip[a]
            for j in range(n):
                row[first + j] = 0.0


@compiled_for_vectors
def _local_slopes(x: Array, V: Array, local: Array, c: NodalRod) -> None:
    """A, B, mobility B, and dG/dS but for D and w, at all nodes, into local, (4, d, d, nodes + 1), all 0."""
    d, size = V.shape
    E, Sigma, g = np.empty((d, size)), np.empty((d, size)), c.algebra
    A, B, velocities, same = local[0], local[1], local[2], local[3]
    strains_and_stresses(x, E, Sigma, c)
    for t in range(len(g.signs)):
        a, b, o, sign = g.terms[t, 0], g.terms[t, 1], g.terms[t, 2], g.signs[t]
        for i in range(size):
            turn, bend = sign * E[b, i], sign * c.compliance[b, i]
            A[a, o, i] += turn
            B[o, a, i] -= turn
            B[o, b, i] -= bend * Sigma[a, i]
            same[a, b, i] += bend * V[o, i]
    for o in range(d):
        for b in range(d):
            if g.backward[o, b]:
                for i in range(size):
                    velocities[o, b, i] = c.mobility[o, i] * B[o, b, i]
                for a in range(d):
                    if g.forward[a, o]:
                        for i in range(size):
                            same[a, b, i] += A[a, o, i] * velocities[o, b, i]


@compiled_for_vectors
def _kept_columns(k: int, A: Array, J: Array, tip: Array, c: NodalRod, m: NodeMatrices) -> None:
    """The derivative of G by the k-th of the V that are unknowns, into J and tip; A as in `_local_slopes`."""
    d, size, n = len(tip), len(m.weights), len(m.weights) - 1
    of, first = c.kept[k], d * n + k * size
    for a in range(d):
        own = 1.0 if a == of else 0.0
        for i in range(size):
            row = J[a * n + i] if i < n else tip[a]
            for j in range(size):
                row[first + j] = own * m.weak[i, j]
            row[first + i] += m.weights[i] * A[a, of, i]


@compiled_for_vectors
def _kept_rows(k: int, B: Array, J: Array, c: NodalRod, m: NodeMatrices) -> None:
    """The rows of the balance of the k-th of the V that are unknowns into J; B as in `_local_slopes`."""
    d, size, n = len(B), len(m.weights), len(m.weights) - 1
    of, first = c.kept[k], d * n + k * size
    for i in range(size):
        row, w = J[first + i], m.weights[i]
        row[:] = 0.0
        for j in range(n):
            row[of * n + j] = w * m.D[i, j]
        if i < n:
            for b in range(d):
                row[b * n + i] += w * B[of, b, i]
        row[first + i] = -w * c.drag[of, i]
