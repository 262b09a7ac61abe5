"""The nonlinear rod on a mesh with its stresses as unknowns: its balance, compiled.

Sec. III, second formulation, in the plane and in space: only the structure constants of `model.algebra` tell
the one from the other. The unknowns S are the stresses beyond those of the straight rod, at every node but
the tip, where they vanish. With the compliances C and the drags Gamma of each node, the assembled
differentiation matrix D, the nodes' weights W and E0, the strain of the straight rod under its force,

    E = E0 + C S,    Sigma = Sigma(1) + S,    Gamma V = D*_E Sigma = D S + ad*_E Sigma,
    W C dS/dt = G(S) = -D^T W V + W ad_E V.

Nothing is divided by a stiffness, so that a compliance of 0 is one like others: its stress is then without a
derivative. At the tip G is the reaction r, and -r is the tip's velocity: it converges twice as fast as V
itself, and dU/dt = -Sigma(1) r - <Gamma V, V> holds to rounding. The tip's stress is essential, the clamp
V(0) = 0 natural.

V is eliminated, but for components whose drag is so small that the division by it costs digits: these are
further unknowns at all nodes, the tip's included, and W (D*_E Sigma - Gamma V) = 0 are their equations.
States are flat: S, one component at every node after the other, then the components of V that are unknown.

`rodsweep.model.balance` states the balance without mesh, `mixed_form` with all of V as unknowns; the exact
Jacobian is in `stress_jacobian`.
"""

import numpy as np

from ..arrays import Array
from ..model.algebra import add_ad, add_coad
from ..model.compilation import compiled_for_vectors
from .mesh import NodeMatrices
from .nodal_rod import NodalRod
from .state_layout import stresses_of, velocities_of


@compiled_for_vectors
def strains_and_stresses(x: Array, E: Array, Sigma: Array, c: NodalRod) -> None:
    """E and Sigma at all nodes of a state x, both (d, nodes + 1)."""
    d, n = E.shape[0], E.shape[1] - 1
    S = stresses_of(x, d, n)
    for a in range(d):
        for i in range(n):
            E[a, i] = c.rest[a, i] + c.compliance[a, i] * S[a, i]
            Sigma[a, i] = c.tip_stress[a] + S[a, i]
        E[a, n], Sigma[a, n] = c.rest[a, n], c.tip_stress[a]


@compiled_for_vectors
def elastic_forces(x: Array, E: Array, Sigma: Array, out: Array, c: NodalRod, m: NodeMatrices) -> None:
    """D*_E Sigma at all nodes of a state x into out, (d, nodes + 1), as are E and Sigma there."""
    d, size = out.shape
    S = stresses_of(x, d, size - 1)
    out[:, :] = 0.0
    for a in range(d):
        for j in range(size - 1):
            stress = S[a, j]
            for i in range(size):
                out[a, i] += m.D_transposed[j, i] * stress
    add_coad(E, Sigma, out, c.algebra)


@compiled_for_vectors
def weigh(V: Array, G: Array, m: NodeMatrices) -> None:
    """From ad_E V, in G, to W ad_E V - D^T W V; both (d, nodes + 1)."""
    d, size = V.shape
    for a in range(d):
        for i in range(size):
            G[a, i] *= m.weights[i]
        for j in range(size):
            v = m.weights[j] * V[a, j]
            for i in range(size):
                G[a, i] -= m.D[j, i] * v


@compiled_for_vectors
def balance(x: Array, V: Array, G: Array, c: NodalRod, m: NodeMatrices) -> None:
    """V and G at all nodes of a state x, (d, nodes + 1) both; what is known of V is taken from x."""
    d, size = V.shape
    E, Sigma = np.empty((d, size)), np.empty((d, size))
    strains_and_stresses(x, E, Sigma, c)
    elastic_forces(x, E, Sigma, V, c, m)
    for a in range(d):
        for i in range(size):
            V[a, i] *= c.mobility[a, i]
    known = velocities_of(x, d, size - 1)
    for k in range(len(c.kept)):
        for i in range(size):
            V[c.kept[k], i] = known[k, i]
    G[:, :] = 0.0
    add_ad(E, V, G, c.algebra)
    weigh(V, G, m)


@compiled_for_vectors
def velocity_balance(x: Array, out: Array, c: NodalRod, m: NodeMatrices) -> None:
    """W (D*_E Sigma - Gamma V) at all nodes, for each unknown V, into its places in out, (unknowns,)."""
    d, size = c.drag.shape
    known, rows = velocities_of(x, d, size - 1), velocities_of(out, d, size - 1)
    E, Sigma, force = np.empty((d, size)), np.empty((d, size)), np.empty((d, size))
    strains_and_stresses(x, E, Sigma, c)
    elastic_forces(x, E, Sigma, force, c, m)
    for k in range(len(c.kept)):
        a = c.kept[k]
        for i in range(size):
            rows[k, i] = m.weights[i] * (force[a, i] - c.drag[a, i] * known[k, i])


@compiled_for_vectors
def balance_change(x: Array, V: Array, out: Array, change: NodalRod, c: NodalRod, m: NodeMatrices) -> None:
    """The derivatives of V and G along a change of the rod into out, (2, d, nodes + 1).

    V at the state x, (d, nodes + 1), is known. What of V is an unknown does not change.
    """
    dV, dG = out[0], out[1]
    d, size = V.shape
    strains = np.empty((2, d, size))
    _changed_forces(x, V, strains, dV, change, c)
    for a in range(d):
        for i in range(size):
            dV[a, i] *= c.mobility[a, i]
    dG[:, :] = 0.0
    add_ad(strains[1], V, dG, c.algebra)
    add_ad(strains[0], dV, dG, c.algebra)
    weigh(dV, dG, m)


@compiled_for_vectors
def velocity_change(x: Array, V: Array, out: Array, change: NodalRod, c: NodalRod, m: NodeMatrices) -> None:
    """The derivative of `velocity_balance` along a change of the rod into its places in out, (unknowns,)."""
    d, size = V.shape
    rows = velocities_of(out, d, size - 1)
    strains, changed = np.empty((2, d, size)), np.empty((d, size))
    _changed_forces(x, V, strains, changed, change, c)
    for k in range(len(c.kept)):
        for i in range(size):
            rows[k, i] = m.weights[i] * changed[c.kept[k], i]


@compiled_for_vectors
def _changed_forces(x: Array, V: Array, strains: Array, out: Array, change: NodalRod, c: NodalRod) -> None:
    """E and its derivative along a change of the rod into strains, (2, d, nodes + 1).

    Into out, (d, nodes + 1), the derivative of D*_E Sigma - Gamma V at fixed V.
    """
    d, size = V.shape
    E, dE, Sigma, dSigma = strains[0], strains[1], np.empty((d, size)), np.empty((d, size))
    strains_and_stresses(x, E, Sigma, c)
    strains_and_stresses(x, dE, dSigma, change)
    for a in range(d):
        for i in range(size):
            dSigma[a, i] = change.tip_stress[a]  # S does not change
            out[a, i] = -change.drag[a, i] * V[a, i]
    add_coad(dE, Sigma, out, c.algebra)
    add_coad(E, dSigma, out, c.algebra)
