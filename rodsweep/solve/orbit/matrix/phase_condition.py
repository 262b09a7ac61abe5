"""Phase condition of an orbit in the plane, compiled: at t = 0 the tip's y is at an extremum.

The velocity of the tip is computed from the reaction at the tip, which converges twice as fast as the
velocity field. c, m: nodal values of the rod and matrices of its mesh.
"""

import numpy as np

from ....arrays import Array
from ....discretization.elements.mesh import NodeMatrices
from ....discretization.nodal_rod import NodalRod, NodalRodDerivative
from ....discretization.plane_equations import (
    write_balance,
    write_balance_parameter_derivative,
    write_jacobian,
)
from ....discretization.state_layout import BENDING_INDEX, SE2_DIMENSION, stress_index
from ....model.compiled.compilation import compiled_with_reordered_sums


@compiled_with_reordered_sums
def phase_right_side(start: Array, change: NodalRodDerivative, c: NodalRod, m: NodeMatrices) -> float:
    """Minus the derivative of the phase condition with respect to the parameter, at the state `start` at t
    = 0, (n,): the right-hand side of the phase equation. change: derivatives of the nodal values c of the
    rod. m: matrices of the mesh."""
    V = np.empty(c.drag.shape)
    G = np.empty(c.drag.shape)
    changes = np.empty((3, *c.drag.shape))
    write_balance(start, V, G, c, m)
    write_balance_parameter_derivative(start, V, changes, change, c, m)
    theta = tip_angle(start, c.compliance, m)
    angle_change = tip_angle(start, change.compliance, m)
    angle_factor = np.cos(theta) * G[0, -1] - np.sin(theta) * G[1, -1]
    # With the minus sign of a right-hand side.
    return angle_factor * angle_change - tip_lateral_velocity(changes[2], theta)


@compiled_with_reordered_sums
def phase_residual(start: Array, c: NodalRod, m: NodeMatrices) -> float:
    """Residual of the phase condition: lateral velocity dy/dt of the tip, computed from the reaction at the
    tip. start: state at t = 0, (n,). c: nodal values of the rod. m: matrices of the mesh."""
    V = np.empty(c.drag.shape)
    G = np.empty(c.drag.shape)
    write_balance(start, V, G, c, m)
    return float(tip_lateral_velocity(G, tip_angle(start, c.compliance, m)))


@compiled_with_reordered_sums
def tip_lateral_velocity(G: Array, theta: float) -> float:
    """Lateral velocity dy/dt of the tip. G: strain rates of the weak form at all nodes, (3, nodes + 1).
    theta: angle of the tip."""
    # G at the tip is the reaction of the weak form: minus the velocity of the tip in the body frame, which is
    # rotated into the laboratory frame here.
    return -(np.sin(theta) * G[0, -1] + np.cos(theta) * G[1, -1])


@compiled_with_reordered_sums
def tip_angle(x: Array, compliance: Array, m: NodeMatrices) -> float:
    """Angle theta of the tip. x: state, (n,). compliance: compliances at all nodes, (3, nodes + 1). m:
    matrices of the mesh."""
    theta = 0.0
    nodes = len(m.quadrature_weights) - 1
    # The sum ends before the tip, where m3 is 0.
    for i in range(nodes):
        theta += (
            m.quadrature_weights[i] * compliance[BENDING_INDEX, i] * x[stress_index(BENDING_INDEX, i, nodes)]
        )
    return theta


@compiled_with_reordered_sums
def write_phase_row(start: Array, c: NodalRod, m: NodeMatrices, row: Array) -> None:
    """Writes the derivative of the tip's lateral velocity (`phase_residual`) with respect to the state
    `start`, (n,), into `row`, (n,). c: rod at the nodes of the mesh. m: matrices of the mesh."""
    n = len(start)
    V = np.empty(c.drag.shape)
    G = np.empty(c.drag.shape)
    J = np.empty((n, n))
    tip = np.empty((SE2_DIMENSION, n))
    write_balance(start, V, G, c, m)
    write_jacobian(start, V, J, tip, c, m)
    theta = tip_angle(start, c.compliance, m)
    nodes = len(m.quadrature_weights) - 1
    sin = np.sin(theta)
    cos = np.cos(theta)
    for i in range(n):
        row[i] = -(sin * tip[0, i] + cos * tip[1, i])
    for i in range(nodes):
        # theta is the integral of the curvature C m3, C: bending compliance.
        bending_weight = m.quadrature_weights[i] * c.compliance[BENDING_INDEX, i]
        row[stress_index(BENDING_INDEX, i, nodes)] += (sin * G[1, nodes] - cos * G[0, nodes]) * bending_weight
