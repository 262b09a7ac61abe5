"""The nonlinear rod on a mesh with its stresses as unknowns: the balance and its exact Jacobian, compiled.

Sec. III, second formulation, with cross products written out in the plane. The unknowns S = (n1 + F, n2, m3)
are the stresses beyond those of the straight rod, at every node but the tip, where they vanish. With the
compliances c1 = 1/k1 and c2 = 1/k2, the assembled differentiation matrix D and the nodes' weights W

    E = (h1, h2, Pi) = (nu + c1 S1, c2 S2, S3),    n1 = S1 - F,
    Gamma V = D*_E Sigma = (D S1 - Pi S2, D S2 + Pi n1, D S3 - h2 n1 + h1 S2),
    W C dS/dt = G(S) = -D^T W V + W ad_E V,        ad_E V = (h2 Omega - Pi v2, Pi v1 - h1 Omega, 0).

Nothing is divided by a stiffness, so k1 = inf and k2 = inf are rods like others: their stresses are then
without a derivative. At the tip G is the reaction r, and -r is the tip's velocity: it converges twice as fast
as V itself, and dU/dt = F r1 - <Gamma V, V> holds to rounding. The tip's stress is essential, the clamp
V(0) = 0 natural.

V is eliminated, but for Omega where gamma3 is so small that the division by it costs digits: Omega at all
nodes, the tip's included, is then a further unknown, and W (D*_E Sigma - gamma3 Omega)_3 = 0 its equation.
States are flat: S1 at every node, then S2, S3 and, if it is unknown, Omega.

`rodsweep.model.balance` states the balance without mesh, `mixed_form` with all of V as unknowns.
"""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..model.compilation import compiled_for_vectors


class BeamParameters(NamedTuple):
    """A rod's parameters as the compiled functions take them; c1, c2: compliances, nu = 1 - F c1."""

    F: float
    nu: float
    c1: float
    c2: float
    gamma1: float
    gamma3: float


class NodeMatrices(NamedTuple):
    """D, D^T, -D^T W and -D^T W D on all nodes of a mesh, (nodes + 1, nodes + 1), and W, (nodes + 1,).

    All are contiguous, and so are the inner loops over the nodes.
    """

    D: Array
    D_transposed: Array
    weak: Array
    second: Array
    weights: Array


@compiled_for_vectors
def balance(x: Array, V: Array, G: Array, c: BeamParameters, m: NodeMatrices) -> None:
    """V and G at all nodes of a state x, (3, nodes + 1) both; Omega is taken from x if it is there."""
    size = len(m.weights)
    n = size - 1
    known = len(x) > 3 * n
    V[:, :] = 0.0
    for j in range(n):
        s1, s2, s3 = x[j], x[n + j], x[2 * n + j]
        for i in range(size):
            slope = m.D_transposed[j, i]
            V[0, i] += slope * s1
            V[1, i] += slope * s2
            V[2, i] += slope * s3
    for i in range(size):
        s1, s2, Pi = (x[i], x[n + i], x[2 * n + i]) if i < n else (0.0, 0.0, 0.0)
        h1, h2, n1 = c.nu + c.c1 * s1, c.c2 * s2, s1 - c.F
        V[0, i] = (V[0, i] - Pi * s2) / c.gamma1
        V[1, i] += Pi * n1
        V[2, i] = x[3 * n + i] if known else (V[2, i] - h2 * n1 + h1 * s2) / c.gamma3
        w = m.weights[i]
        G[0, i] = w * (h2 * V[2, i] - Pi * V[1, i])
        G[1, i] = w * (Pi * V[0, i] - h1 * V[2, i])
        G[2, i] = 0.0
    for j in range(size):
        w = m.weights[j]
        v1, v2, v3 = w * V[0, j], w * V[1, j], w * V[2, j]
        for i in range(size):
            slope = m.D[j, i]
            G[0, i] -= slope * v1
            G[1, i] -= slope * v2
            G[2, i] -= slope * v3


@compiled_for_vectors
def torque_balance(x: Array, out: Array, c: BeamParameters, m: NodeMatrices) -> None:
    """W (D*_E Sigma - gamma3 Omega)_3 at all nodes into out, (nodes + 1,), for x with Omega."""
    size = len(m.weights)
    n = size - 1
    out[:] = 0.0
    for j in range(n):
        for i in range(size):
            out[i] += m.D_transposed[j, i] * x[2 * n + j]
    for i in range(size):
        s1, s2 = (x[i], x[n + i]) if i < n else (0.0, 0.0)
        turned = out[i] - c.c2 * s2 * (s1 - c.F) + (c.nu + c.c1 * s1) * s2
        out[i] = m.weights[i] * (turned - c.gamma3 * x[3 * n + i])


@compiled_for_vectors
def balance_change(
    x: Array, V: Array, out: Array, change: BeamParameters, c: BeamParameters, m: NodeMatrices
) -> None:
    """The derivatives of V and G along a change of the parameters into out, (2, 3, nodes + 1).

    V at the state x, (3, nodes + 1), is known. Omega does not change where it is an unknown.
    """
    dV, dG = out[0], out[1]
    size = len(m.weights)
    n = size - 1
    known = len(x) > 3 * n
    dG[:, :] = 0.0
    for i in range(size):
        s1, s2, Pi = (x[i], x[n + i], x[2 * n + i]) if i < n else (0.0, 0.0, 0.0)
        h1, h2, n1 = c.nu + c.c1 * s1, c.c2 * s2, s1 - c.F
        dh1, dh2 = change.nu + change.c1 * s1, change.c2 * s2
        dV[0, i] = -V[0, i] * change.gamma1 / c.gamma1
        dV[1, i] = -Pi * change.F
        turned = dh1 * s2 - dh2 * n1 + h2 * change.F
        dV[2, i] = 0.0 if known else (turned - V[2, i] * change.gamma3) / c.gamma3
        w = m.weights[i]
        dG[0, i] = w * (dh2 * V[2, i] + h2 * dV[2, i] - Pi * dV[1, i])
        dG[1, i] = w * (Pi * dV[0, i] - dh1 * V[2, i] - h1 * dV[2, i])
    for j in range(size):
        w = m.weights[j]
        v1, v2, v3 = w * dV[0, j], w * dV[1, j], w * dV[2, j]
        for i in range(size):
            slope = m.D[j, i]
            dG[0, i] -= slope * v1
            dG[1, i] -= slope * v2
            dG[2, i] -= slope * v3


@compiled_for_vectors
def torque_change(x: Array, out: Array, change: BeamParameters, c: BeamParameters, m: NodeMatrices) -> None:
    """The derivative of `torque_balance` along a change of the parameters into out, (nodes + 1,)."""
    n = len(m.weights) - 1
    for i in range(n + 1):
        s1, s2 = (x[i], x[n + i]) if i < n else (0.0, 0.0)
        bent = c.c2 * change.F - change.c2 * (s1 - c.F) + change.nu + change.c1 * s1
        out[i] = m.weights[i] * (bent * s2 - change.gamma3 * x[3 * n + i])


@compiled_for_vectors
def jacobian(x: Array, V: Array, J: Array, tip: Array, c: BeamParameters, m: NodeMatrices) -> None:
    """The derivative of the equations at x, of which V is known, into J, (unknowns, unknowns).

    Rows are equations, in the order of the unknowns: G at all nodes but the tip, then the torque balance if
    Omega is unknown. tip, (3, unknowns): the derivative of the reaction.
    """
    size, unknowns = len(m.weights), len(x)
    n = size - 1
    known = unknowns > 3 * n
    drag1, drag3 = 1 / c.gamma1, 0.0 if known else 1 / c.gamma3
    local = _local_slopes(x, c, n, drag3)
    if known:
        J[:, 3 * n :] = 0.0
        tip[:, 3 * n :] = 0.0
    for i in range(size):
        s1, s2, Pi = (x[i], x[n + i], x[2 * n + i]) if i < n else (0.0, 0.0, 0.0)
        h1, h2 = c.nu + c.c1 * s1, c.c2 * s2
        A, B, C = (J[i], J[n + i], J[2 * n + i]) if i < n else (tip[0], tip[1], tip[2])
        w = m.weights[i]
        to12, to13, to21, to23 = -w * Pi, w * h2 * drag3, w * Pi * drag1, -w * h1 * drag3
        for j in range(n):
            weak, slope, second = m.weak[i, j], m.D[i, j], m.second[i, j]
            A[j] = drag1 * second
            A[n + j] = weak * local[0, j] + to12 * slope
            A[2 * n + j] = weak * local[1, j] + to13 * slope
            B[j] = weak * local[2, j] + to21 * slope
            B[n + j] = second
            B[2 * n + j] = weak * local[3, j] + to23 * slope
            C[j] = weak * local[4, j]
            C[n + j] = weak * local[5, j]
            C[2 * n + j] = drag3 * second
        if known:
            A[3 * n + i], B[3 * n + i] = w * h2, -w * h1
            for j in range(size):
                C[3 * n + j] = m.weak[i, j]
        if i < n:
            A[i] += w * (-Pi * local[2, i] + h2 * local[4, i])
            A[n + i] += w * (h2 * local[5, i] + c.c2 * V[2, i])
            A[2 * n + i] += w * (-Pi * local[3, i] - V[1, i])
            B[i] += w * (-h1 * local[4, i] - c.c1 * V[2, i])
            B[n + i] += w * (Pi * local[0, i] - h1 * local[5, i])
            B[2 * n + i] += w * (Pi * local[1, i] + V[0, i])
    if known:
        _torque_rows(x, J, c, m)


@compiled_for_vectors
def _local_slopes(x: Array, c: BeamParameters, n: int, drag3: float) -> Array:
    """dV/dS at the same node but for D, (6, n): v1 by S2 and S3, v2 by S1 and S3, Omega by S1 and S2."""
    local = np.empty((6, n))
    for j in range(n):
        s1, s2, Pi = x[j], x[n + j], x[2 * n + j]
        local[0, j], local[1, j] = -Pi / c.gamma1, -s2 / c.gamma1
        local[2, j], local[3, j] = Pi, s1 - c.F
        local[4, j] = (c.c1 - c.c2) * s2 * drag3
        local[5, j] = (c.nu + c.c1 * s1 - c.c2 * (s1 - c.F)) * drag3
    return local


@compiled_for_vectors
def _torque_rows(x: Array, J: Array, c: BeamParameters, m: NodeMatrices) -> None:
    """The rows of the torque balance of `jacobian`."""
    size = len(m.weights)
    n = size - 1
    for i in range(size):
        row, w = J[3 * n + i], m.weights[i]
        row[:] = 0.0
        for j in range(n):
            row[2 * n + j] = w * m.D[i, j]
        if i < n:
            s1, s2 = x[i], x[n + i]
            row[i] = w * (c.c1 - c.c2) * s2
            row[n + i] = w * (c.nu + c.c1 * s1 - c.c2 * (s1 - c.F))
        row[3 * n + i] = -w * c.gamma3


@compiled_for_vectors
def rate(z: Array, out: Array, roots: Array, c: BeamParameters, m: NodeMatrices) -> None:
    """dz/dt in 1/tau2 into out, both (unknowns,), of z = C^(1/2) S; roots: of c1, c2 and 1, above 0."""
    size = len(m.weights)
    n = size - 1
    V, G, x = np.empty((3, size)), np.empty((3, size)), np.empty(3 * n)
    for a in range(3):
        for i in range(n):
            x[a * n + i] = z[a * n + i] / roots[a]
    balance(x, V, G, c, m)
    for a in range(3):
        for i in range(n):
            out[a * n + i] = G[a, i] / (m.weights[i] * roots[a])


@compiled_for_vectors
def rate_jacobian(z: Array, out: Array, roots: Array, c: BeamParameters, m: NodeMatrices) -> None:
    """d(dz/dt)/dz into out, (unknowns, unknowns), as LAPACK and PETSc store it: out[column, row]."""
    size = len(m.weights)
    n = size - 1
    V, G, x = np.empty((3, size)), np.empty((3, size)), np.empty(3 * n)
    J, tip = np.empty((3 * n, 3 * n)), np.empty((3, 3 * n))
    for a in range(3):
        for i in range(n):
            x[a * n + i] = z[a * n + i] / roots[a]
    balance(x, V, G, c, m)
    jacobian(x, V, J, tip, c, m)
    for a in range(3):
        for b in range(3):
            share = 1 / (roots[a] * roots[b])
            for i in range(n):
                f = share / m.weights[i]
                for j in range(n):
                    out[b * n + j, a * n + i] = f * J[a * n + i, b * n + j]


@compiled_for_vectors
def rates(states: Array, out: Array, roots: Array, c: BeamParameters, m: NodeMatrices) -> None:
    """`rate` of each of the states, into out, both of shape (n, unknowns): one call for many."""
    for i in range(len(states)):
        rate(states[i], out[i], roots, c, m)


@compiled_for_vectors
def rate_jacobians(states: Array, out: Array, roots: Array, c: BeamParameters, m: NodeMatrices) -> None:
    """`rate_jacobian` of each of the states, shape (n, unknowns), into out, (n, unknowns, unknowns)."""
    for i in range(len(states)):
        rate_jacobian(states[i], out[i], roots, c, m)
