"""The nonlinear rod in its body frame: the rate of its strains and its exact Jacobian.

Sec. III, second formulation. With Sigma = K (E - Ebar), E = (h1, h2, Pi), K = diag(k1, k2, 1),
Gamma = diag(gamma1, 1, gamma3) and D*_E sigma = (s1' - Pi s2, s2' + Pi s1, s3' - h2 s1 + h1 s2),

    V = Gamma^-1 D*_E Sigma,    <sigma, dE/dt> = -<D*_E sigma, V>  for all sigma with sigma(1) = 0,

and Sigma(1) = (-F, 0, 0). The tip's stress is essential, the clamp V(0) = 0 natural. E is continuous in P_p
on equal elements with Lobatto nodes and lumped mass; V is nodal in each element, two-valued where two meet.

The unknown is the strain beyond the straight rod's (nu, 0, 0) in units of energy, z = K^(1/2) (E -
E_straight), at all nodes but the tip, where it vanishes: z1 at every node, then z2, then z3. |z|^2/2 is an
energy, the mass matrix is the identity, and no digits are lost for large k1 or k2.

All functions take c, the rod's parameters, and the matrices of one element of the mesh, which are all equal.
They are compiled, contain no configuration and no trigonometric function, and know no time stepping.
`rodsweep.model.balance` states the same balance without mesh and compilation.
"""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..model.compilation import compiled


class BeamParameters(NamedTuple):
    """A rod's parameters as the compiled functions take them; root_k1, root_k2: square roots of k1 and k2."""

    F: float
    nu: float
    root_k1: float
    root_k2: float
    gamma1: float
    gamma3: float


class Coupling(NamedTuple):
    """Of nodes i and j of an element: entries of D, -D^T W and -D^T W D, and the weight of i."""

    slope: float
    weak: float
    second: float
    weight: float


class Element(NamedTuple):
    """D, D^T and -D^T W D on the Lobatto nodes of one element, (p + 1, p + 1), and its weights, (p + 1,).

    All are contiguous, and so are inner loops over the nodes.
    """

    D: Array
    D_transposed: Array
    weak_second: Array
    weights: Array


@compiled
def rate(z: Array, out: Array, c: BeamParameters, element: Element) -> None:
    """dz/dt in 1/tau2 into out, both of shape (unknowns,)."""
    D, w = element.D, element.weights
    m, n = len(w), len(z) // 3
    p = m - 1
    out[:] = 0.0
    fields, S = np.empty((3, 3, m)), np.empty((3, m))
    E, V = fields[0], fields[2]
    for e in range(n // p):
        _velocity(z, e, fields, c, element.D_transposed)
        S[:, :] = 0.0
        for j in range(m):  # S = D^T W V, the inner loop contiguous
            v1, v2, v3 = w[j] * V[0, j], w[j] * V[1, j], w[j] * V[2, j]
            for i in range(m):
                slope = D[j, i]
                S[0, i] += slope * v1
                S[1, i] += slope * v2
                S[2, i] += slope * v3
        for i in range(min(m, n - e * p)):
            k = e * p + i
            mass = w[i] + (w[0] if (i == 0 and e > 0) or i == p else 0.0)
            share = w[i] / mass
            out[k] -= c.root_k1 * (S[0, i] / mass + share * (E[2, i] * V[1, i] - E[1, i] * V[2, i]))
            out[n + k] -= c.root_k2 * (S[1, i] / mass + share * (E[0, i] * V[2, i] - E[2, i] * V[0, i]))
            out[2 * n + k] -= S[2, i] / mass


@compiled
def _velocity(z: Array, e: int, fields: Array, c: BeamParameters, D_transposed: Array) -> None:
    """(E, Sigma - Sigma_straight, V) at the nodes of element e into fields, shape (3, 3, p + 1)."""
    E, S, V = fields[0], fields[1], fields[2]
    m, n = E.shape[1], len(z) // 3
    for i in range(m):
        k = e * (m - 1) + i
        z1, z2, z3 = (z[k], z[n + k], z[2 * n + k]) if k < n else (0.0, 0.0, 0.0)
        E[0, i], E[1, i], E[2, i] = c.nu + z1 / c.root_k1, z2 / c.root_k2, z3
        S[0, i], S[1, i], S[2, i] = z1 * c.root_k1, z2 * c.root_k2, z3
    V[:, :] = 0.0
    for j in range(m):  # V = D S, the inner loop contiguous
        s1, s2, s3 = S[0, j], S[1, j], S[2, j]
        for i in range(m):
            slope = D_transposed[j, i]
            V[0, i] += slope * s1
            V[1, i] += slope * s2
            V[2, i] += slope * s3
    for i in range(m):
        tension = S[0, i] - c.F
        V[0, i] = (V[0, i] - E[2, i] * S[1, i]) / c.gamma1
        V[1, i] = V[1, i] + E[2, i] * tension
        V[2, i] = (V[2, i] - E[1, i] * tension + E[0, i] * S[1, i]) / c.gamma3


@compiled
def jacobian(z: Array, out: Array, c: BeamParameters, element: Element) -> None:
    """d(dz/dt)/dz into out, shape (unknowns, unknowns), as LAPACK and PETSc store it: out[column, row]."""
    D, w = element.D, element.weights
    p, n = len(w) - 1, len(z) // 3
    out[:, :] = 0.0
    fields, block = np.zeros((3, 3, p + 1)), np.zeros((3, 3))
    scale = np.array([c.root_k1, c.root_k2, 1.0])
    for e in range(n // p):
        _velocity(z, e, fields, c, element.D_transposed)
        for i in range(min(p + 1, n - e * p)):
            row = e * p + i
            mass = w[i] + (w[0] if (i == 0 and e > 0) or i == p else 0.0)
            for j in range(min(p + 1, n - e * p)):
                column = e * p + j
                here = Coupling(D[i, j], -D[j, i] * w[j], element.weak_second[i, j], w[i])
                _pair(i, j, fields, c, here, block)
                for a in range(3):
                    for b in range(3):
                        # d/dz_b = K_b^-1/2 d/dE_b; z_a = K_a^1/2 E_a
                        out[b * n + column, a * n + row] += scale[a] / scale[b] / mass * block[a, b]


@compiled
def _pair(i: int, j: int, fields: Array, c: BeamParameters, here: Coupling, G: Array) -> None:
    """Derivative of the weak rates of E at node i by E at node j of one element, before the lumped mass.

    With V_a = Gamma_a^-1 (slope S_a + M_a(E)) and weak rate_a = weak V_a - w N_a(E, V):
    G = weak (V' at j) + (-w N_V at i) (V' from j) - w N_E.
    """
    slope, weak, second, w = here
    E, S, V = fields[0], fields[1], fields[2]
    K1, K2 = c.root_k1**2, c.root_k2**2
    g1, g3 = 1 / c.gamma1, 1 / c.gamma3
    h1, h2, Pi = E[0, i], E[1, i], E[2, i]
    # the local part of dV/dE at node j
    a12, a13 = -E[2, j] * K2 * g1, -S[1, j] * g1
    a21, a23 = E[2, j] * K1, S[0, j] - c.F
    a31, a32 = (S[1, j] - E[1, j] * K1) * g3, (E[0, j] * K2 - a23) * g3
    G[0, 0] = second * K1 * g1
    G[0, 1] = weak * a12 - w * Pi * slope * K2
    G[0, 2] = weak * a13 + w * h2 * slope * g3
    G[1, 0] = weak * a21 + w * Pi * slope * K1 * g1
    G[1, 1] = second * K2
    G[1, 2] = weak * a23 - w * h1 * slope * g3
    G[2, 0] = weak * a31
    G[2, 1] = weak * a32
    G[2, 2] = second * g3
    if i != j:
        return
    # -w (Pi V2 - h2 V3) and -w (h1 V3 - Pi V1): through V at the same node, then through E itself
    G[0, 0] += w * (-Pi * a21 + h2 * a31)
    G[0, 1] += w * (h2 * a32 + V[2, i])
    G[0, 2] += w * (-Pi * a23 - V[1, i])
    G[1, 0] += w * (-h1 * a31 - V[2, i])
    G[1, 1] += w * (Pi * a12 - h1 * a32)
    G[1, 2] += w * (Pi * a13 + V[0, i])


@compiled
def rates(states: Array, out: Array, c: BeamParameters, element: Element) -> None:
    """`rate` of each of the states, into out, both of shape (n, unknowns): one call for many."""
    for i in range(len(states)):
        rate(states[i], out[i], c, element)


@compiled
def jacobians(states: Array, out: Array, c: BeamParameters, element: Element) -> None:
    """`jacobian` of each of the states, shape (n, unknowns), into out, (n, unknowns, unknowns)."""
    for i in range(len(states)):
        jacobian(states[i], out[i], c, element)
