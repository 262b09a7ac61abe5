"""The exact Jacobian of the rod on a mesh with its stresses as unknowns, compiled.

With A_ac = sum_b s_abc E_b and B_cb = d(ad*_E Sigma)_c/dS_b at each node the derivative of G,
see `stress_balance`, consists of

    J_ab(i, j) = [a = b] (-D^T W Gamma_a^-1 D)_ij + (-D^T W)_ij (B_ab/Gamma_a)_j + w_i (A_ab/Gamma_b)_i D_ij
                 + [i = j] w_i (sum_c A_ac B_cb/Gamma_c + d(ad_E V)_a/dS_b at fixed V).

Blocks that vanish for every E are known from the algebra, the first argument `g`.
"""

import numpy as np

from ...arrays import Array
from ...model.algebra import Algebra
from ...model.compiled.unrolling import OverAlgebra
from ..elements.mesh import NodeMatrices
from ..nodal_rod import NodalRod
from ..state_layout import stress_place, velocity_place


@OverAlgebra
def jacobian(  # noqa: PLR0913, PLR0917 - a tuple of arrays would count references at each use
    g: Algebra, x: Array, V: Array, J: Array, tip: Array, c: NodalRod, m: NodeMatrices
) -> None:
    """Write the Jacobian of the equations at x, with V already computed, into J, (unknowns, unknowns).

    Rows are equations, in the order of the unknowns: G at all nodes but the tip, then the balance of each V
    that is unknown. tip, (d, unknowns): the derivative of the reaction.
    """
    slopes = np.empty((g.dimension, g.dimension, len(m.weights)))
    _velocity_slopes(g, x, slopes, c)
    _rows(g, x, V, slopes, J, tip, c, m)
    for k in range(len(c.kept)):
        _kept_columns(g, k, x, J, tip, c, m)
        _kept_rows(g, k, x, J, c, m)


@OverAlgebra
def _velocity_slopes(g: Algebra, x: Array, slopes: Array, c: NodalRod) -> None:
    """Write mobility B at all nodes into slopes, (d, d, nodes + 1), where B does not vanish."""
    n = slopes.shape[2] - 1
    for i in range(n + 1):
        s = [x[stress_place(a, i, n)] if i < n else 0.0 for a in g.components]
        B = [[0.0 for _ in g.components] for _ in g.components]
        for a, b, o, sign in g.terms:
            B[o][a] -= sign * (c.rest[b, i] + c.compliance[b, i] * s[b])
            B[o][b] -= sign * c.compliance[b, i] * (c.tip_stress[a] + s[a])
        for o in g.components:
            for b in g.components:
                if g.backward[o][b]:
                    slopes[o, b, i] = c.mobility[o, i] * B[o][b]


@OverAlgebra
def _rows(  # noqa: PLR0912, PLR0913, PLR0917 - as above; what the algebra decides is no branch
    g: Algebra, x: Array, V: Array, slopes: Array, J: Array, tip: Array, c: NodalRod, m: NodeMatrices
) -> None:
    """Write the derivative of G by S into J and tip; slopes as in `_velocity_slopes`."""
    n = len(m.weights) - 1
    for i in range(n + 1):
        s = [x[stress_place(a, i, n)] if i < n else 0.0 for a in g.components]
        A = [[0.0 for _ in g.components] for _ in g.components]  # weighted
        for a, b, o, sign in g.terms:
            A[a][o] += sign * m.weights[i] * (c.rest[b, i] + c.compliance[b, i] * s[b])
        ahead = [[A[a][o] * c.mobility[o, i] for o in g.components] for a in g.components]
        rows = [J[stress_place(a, i, n)] if i < n else tip[a] for a in g.components]
        for a in g.components:
            for j in range(n):
                rows[a][stress_place(a, j, n)] = c.second[a, i, j]
        for j in range(n):
            weak, slope = m.weak[i, j], m.D[i, j]
            for a, b in g.pairs:
                back = weak * slopes[a, b, j] if g.backward[a][b] else 0.0
                rows[a][stress_place(b, j, n)] = back + (ahead[a][b] * slope if g.forward[a][b] else 0.0)
        if i < n:
            same = [[0.0 for _ in g.components] for _ in g.components]
            for a, b, o, sign in g.terms:
                same[a][b] += sign * m.weights[i] * c.compliance[b, i] * V[o, i]
            for a, o in g.pairs:
                for b in g.components:
                    if g.forward[a][o] and g.backward[o][b]:
                        same[a][b] += A[a][o] * slopes[o, b, i]
            for a in g.components:
                for b in g.components:
                    rows[a][stress_place(b, i, n)] += same[a][b]


@OverAlgebra
def _kept_columns(  # noqa: PLR0913, PLR0917 - as above
    g: Algebra, k: int, x: Array, J: Array, tip: Array, c: NodalRod, m: NodeMatrices
) -> None:
    """Write the derivative of G by the k-th unknown velocity into J and tip."""
    size, n, of = len(m.weights), len(m.weights) - 1, c.kept[k]
    first = velocity_place(k, 0, g.dimension, n)
    for i in range(size):
        rows = [J[stress_place(a, i, n)] if i < n else tip[a] for a in g.components]
        for a in g.components:
            for j in range(size):
                rows[a][first + j] = m.weak[i, j] if of == a else 0.0
        for a, b, o, sign in g.terms:
            if o == of:
                stress = x[stress_place(b, i, n)] if i < n else 0.0
                rows[a][first + i] += sign * m.weights[i] * (c.rest[b, i] + c.compliance[b, i] * stress)


@OverAlgebra
def _kept_rows(g: Algebra, k: int, x: Array, J: Array, c: NodalRod, m: NodeMatrices) -> None:
    """Write the rows of the balance of the k-th unknown velocity into J."""
    size, n, of = len(m.weights), len(m.weights) - 1, c.kept[k]
    first = velocity_place(k, 0, g.dimension, n)
    for i in range(size):
        row, w = J[first + i], m.weights[i]
        row[:] = 0.0
        for j in range(n):
            row[stress_place(of, j, n)] = w * m.D[i, j]
        row[first + i] = -w * c.drag[of, i]
        if i < n:
            s = [x[stress_place(a, i, n)] for a in g.components]
            for a, b, o, sign in g.terms:
                if o == of:
                    bend = c.compliance[b, i]
                    row[stress_place(a, i, n)] -= w * sign * (c.rest[b, i] + bend * s[b])
                    row[stress_place(b, i, n)] -= w * sign * bend * (c.tip_stress[a] + s[a])
