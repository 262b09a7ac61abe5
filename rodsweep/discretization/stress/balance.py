"""The nonlinear rod on a mesh with its stresses as unknowns: its balance, compiled.

Sec. III, second formulation, in the plane and in space: only the structure constants of `model.algebra`, the
first argument `g`, tell the one from the other. The unknowns S are the stresses beyond those of the straight
rod, at every node but the tip, where they vanish. With the compliances C and the drags Gamma of each node,
the assembled differentiation matrix D, the nodes' weights W and E0, the strain of the straight rod under its
force,

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

from ...arrays import Array
from ...model.algebra import Algebra
from ...model.compiled.unrolling import OverAlgebra
from ..elements.mesh import NodeMatrices
from ..nodal_rod import NodalChange, NodalRod
from ..state_layout import stress_place, velocity_place


@OverAlgebra
def forces(g: Algebra, x: Array, out: Array, c: NodalRod, m: NodeMatrices) -> None:
    """D*_E Sigma at all nodes of a state x into out, (d, nodes + 1)."""
    size = len(m.weights)
    out[:, :] = 0.0
    for j in range(size - 1):
        s = [x[stress_place(a, j, size - 1)] for a in g.components]
        for i in range(size):
            slope = m.D_transposed[j, i]
            for a in g.components:
                out[a, i] += slope * s[a]
    for i in range(size):
        s = [x[stress_place(a, i, size - 1)] if i < size - 1 else 0.0 for a in g.components]
        E = [c.rest[a, i] + c.compliance[a, i] * s[a] for a in g.components]
        force = [out[a, i] for a in g.components]
        for a, b, o, sign in g.terms:
            force[o] -= sign * E[b] * (c.tip_stress[a] + s[a])
        for a in g.components:
            out[a, i] = force[a]


@OverAlgebra
def strain_rates(g: Algebra, x: Array, V: Array, G: Array, c: NodalRod, m: NodeMatrices) -> None:
    """W D_E V, weakly, at all nodes of a state x that moves with V, into G; both (d, nodes + 1)."""
    size = len(m.weights)
    for i in range(size):
        s = [x[stress_place(a, i, size - 1)] if i < size - 1 else 0.0 for a in g.components]
        E = [c.rest[a, i] + c.compliance[a, i] * s[a] for a in g.components]
        rate = [0.0 for _ in g.components]
        for a, b, o, sign in g.terms:
            rate[a] += sign * E[b] * V[o, i]
        for a in g.components:
            G[a, i] = m.weights[i] * rate[a]
    add_weak_slope(g, V, G, m)


@OverAlgebra
def add_weak_slope(g: Algebra, V: Array, G: Array, m: NodeMatrices) -> None:
    """Adds -D^T W V to G, both (d, nodes + 1)."""
    size = len(m.weights)
    for j in range(size):
        v = [m.weights[j] * V[a, j] for a in g.components]
        for i in range(size):
            slope = m.D[j, i]
            for a in g.components:
                G[a, i] -= slope * v[a]


@OverAlgebra
def balance(g: Algebra, x: Array, V: Array, G: Array, c: NodalRod, m: NodeMatrices) -> None:
    """V and G at all nodes of a state x, (d, nodes + 1) both; what is known of V is taken from x."""
    size = len(m.weights)
    forces(g, x, V, c, m)
    for i in range(size):
        for a in g.components:
            V[a, i] *= c.mobility[a, i]
    for k in range(len(c.kept)):
        for i in range(size):
            V[c.kept[k], i] = x[velocity_place(k, i, g.dimension, size - 1)]
    strain_rates(g, x, V, G, c, m)


@OverAlgebra
def velocity_balance(g: Algebra, x: Array, out: Array, c: NodalRod, m: NodeMatrices) -> None:
    """W (D*_E Sigma - Gamma V) at all nodes, for each unknown V, into its places in out, (unknowns,)."""
    size = len(m.weights)
    force = np.empty((g.dimension, size))
    forces(g, x, force, c, m)
    for k in range(len(c.kept)):
        a = c.kept[k]
        for i in range(size):
            place = velocity_place(k, i, g.dimension, size - 1)
            out[place] = m.weights[i] * (force[a, i] - c.drag[a, i] * x[place])


@OverAlgebra
def balance_change(  # noqa: PLR0913, PLR0917 - a tuple of arrays would count references at each use
    g: Algebra, x: Array, V: Array, out: Array, change: NodalChange, c: NodalRod, m: NodeMatrices
) -> None:
    """The derivatives along a change of the rod, at the state x of which V is known, into out.

    out, (3, d, nodes + 1): of D*_E Sigma - Gamma V at fixed V, of V and of G; what of V is an unknown does
    not change.
    """
    size = len(m.weights)
    for i in range(size):
        s = [x[stress_place(a, i, size - 1)] if i < size - 1 else 0.0 for a in g.components]
        E = [c.rest[a, i] + c.compliance[a, i] * s[a] for a in g.components]
        dE = [change.rest[a, i] + change.compliance[a, i] * s[a] for a in g.components]
        force = [-change.drag[a, i] * V[a, i] for a in g.components]
        for a, b, o, sign in g.terms:
            force[o] -= sign * (dE[b] * (c.tip_stress[a] + s[a]) + E[b] * change.tip_stress[a])
        dV = [c.mobility[a, i] * force[a] for a in g.components]
        rate = [0.0 for _ in g.components]
        for a, b, o, sign in g.terms:
            rate[a] += sign * (dE[b] * V[o, i] + E[b] * dV[o])
        for a in g.components:
            out[0, a, i], out[1, a, i], out[2, a, i] = force[a], dV[a], m.weights[i] * rate[a]
    add_weak_slope(g, out[1], out[2], m)
