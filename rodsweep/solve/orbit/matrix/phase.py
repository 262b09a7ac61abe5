"""Phase condition of an orbit in the plane, compiled: at t = 0 the tip's y is at an extremum.

The velocity of the tip is computed from the reaction, which converges twice as fast as the velocity field.
"""

import numpy as np

from ....arrays import Array
from ....discretization.elements.mesh import NodeMatrices
from ....discretization.nodal_rod import NodalChange, NodalRod
from ....discretization.plane import balance, balance_change, jacobian
from ....discretization.state_layout import BENDING_INDEX, PLANE_COMPONENTS, stress_index
from ....model.compiled.compilation import compiled_for_vectors


@compiled_for_vectors
def phase_change(start: Array, change: NodalChange, c: NodalRod, m: NodeMatrices) -> float:
    """Derivative of `phase` at a start, (n,), along a change of the parameters, negated as a right side."""
    V = np.empty(c.drag.shape)
    G = np.empty(c.drag.shape)
    changes = np.empty((3, *c.drag.shape))
    balance(start, V, G, c, m)
    balance_change(start, V, changes, change, c, m)
    theta = tip_angle(start, c.compliance, m)
    turned = tip_angle(start, change.compliance, m)
    by_angle = np.cos(theta) * G[0, -1] - np.sin(theta) * G[1, -1]
    # Negated: the phase condition has its right side on the other side of the equation.
    return by_angle * turned - lateral_velocity(changes[2], theta)


@compiled_for_vectors
def phase(start: Array, c: NodalRod, m: NodeMatrices) -> float:
    """Lateral velocity dy/dt of the tip at the start of the orbit, (n,), from the reaction at the tip: the
    phase condition.
    """
    V = np.empty(c.drag.shape)
    G = np.empty(c.drag.shape)
    balance(start, V, G, c, m)
    return float(lateral_velocity(G, tip_angle(start, c.compliance, m)))


@compiled_for_vectors
def lateral_velocity(G: Array, theta: float) -> float:
    """dy/dt of the tip at an angle, from G at all nodes, (3, nodes + 1)."""
    # G at the tip is the reaction of the weak form: minus the tip's velocity in the body frame, here turned
    # into the laboratory frame.
    return -(np.sin(theta) * G[0, -1] + np.cos(theta) * G[1, -1])


@compiled_for_vectors
def tip_angle(x: Array, compliance: Array, m: NodeMatrices) -> float:
    """Angle theta of the tip for a state, (n,), and compliances, (3, nodes + 1)."""
    theta = 0.0
    nodes = len(m.weights) - 1
    for i in range(nodes):
        theta += m.weights[i] * compliance[BENDING_INDEX, i] * x[stress_index(BENDING_INDEX, i, nodes)]
    return theta


@compiled_for_vectors
def phase_row(start: Array, c: NodalRod, m: NodeMatrices, row: Array) -> None:
    """Derivative of `phase` with respect to the start, into row, (n,) each."""
    n = len(start)
    V = np.empty(c.drag.shape)
    G = np.empty(c.drag.shape)
    J = np.empty((n, n))
    tip = np.empty((PLANE_COMPONENTS, n))
    balance(start, V, G, c, m)
    jacobian(start, V, J, tip, c, m)
    theta = tip_angle(start, c.compliance, m)
    nodes = len(m.weights) - 1
    sin = np.sin(theta)
    cos = np.cos(theta)
    for i in range(n):
        row[i] = -(sin * tip[0, i] + cos * tip[1, i])
    for i in range(nodes):
        # theta is the integral of the curvature C m3, so each node turns the tip by its weight.
        turn = m.weights[i] * c.compliance[BENDING_INDEX, i]
        row[stress_index(BENDING_INDEX, i, nodes)] += (sin * G[1, nodes] - cos * G[0, nodes]) * turn
