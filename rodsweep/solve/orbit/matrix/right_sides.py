"""Right-hand sides of Newton's systems for a periodic orbit, compiled: residuals of the stages and
derivatives of the residuals. K: intervals, s: stages each, n: unknowns of a state, h: length of an interval
in tau2."""

from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....discretization.nodal_rod import NodalRodDerivative
from ....discretization.plane_equations import (
    write_balance,
    write_balance_parameter_derivative,
    write_jacobian,
    write_velocity_residuals,
)
from ....discretization.state_layout import stress_index, velocity_index
from ....model.compiled.compilation import compiled_with_reordered_sums
from ..equations import OrbitEquations
from .substitution import add_products


class ParameterDerivatives(NamedTuple):
    """Derivatives with respect to the coordinate of a parameter (1/k for a stiffness k). rod_derivative:
    derivatives of the rod's tip stress, compliances, drags and stretch at the nodes. mass_derivative:
    derivative of the diagonal of the mass matrix, (n,)."""

    rod_derivative: NodalRodDerivative
    mass_derivative: Array


@compiled_with_reordered_sums
def write_rates_of_state(x: Array, F: Array, V: Array, G: Array, p: OrbitEquations) -> None:
    """Writes the right-hand side F(x) of M dx/dt = F(x) at the state x, (n,), into F, (n,), the velocities
    into V, and the strain rates into G, (3, nodes + 1) each. p: equations of the orbit."""
    write_balance(x, V, G, p.rod, p.node_matrices)
    _copy_to_stress_unknowns(G, F)
    if len(p.rod.unknown_velocity_components):
        write_velocity_residuals(x, F, p.rod, p.node_matrices)


@compiled_with_reordered_sums
def _copy_to_stress_unknowns(G: Array, F: Array) -> None:
    """Copies G, (3, nodes + 1), at all nodes except the tip to the stress unknowns of F, (n,)."""
    d = G.shape[0]
    n = G.shape[1] - 1
    for a in range(d):
        for i in range(n):
            F[stress_index(a, i, n)] = G[a, i]


@compiled_with_reordered_sums
def write_parameter_derivative_of_rates(
    x: Array, F: Array, V: Array, out: Array, change: NodalRodDerivative, p: OrbitEquations
) -> None:
    """Writes the derivative of F(x) of `write_rates_of_state` with respect to the parameter into F, (n,).

    x: state, (n,). V: velocities at x, (3, nodes + 1). out: work array, (3, 3, nodes + 1). change:
    derivatives of the arrays of the rod. p: equations of the orbit.
    """
    write_balance_parameter_derivative(x, V, out, change, p.rod, p.node_matrices)
    _copy_to_stress_unknowns(out[2], F)
    d, size = V.shape
    for k in range(len(p.rod.unknown_velocity_components)):
        for i in range(size):
            F[velocity_index(k, i, d, size - 1)] = (
                p.node_matrices.quadrature_weights[i] * out[0, p.rod.unknown_velocity_components[k], i]
            )


@compiled_with_reordered_sums
def write_stage_residuals(points: Array, duration: float, p: OrbitEquations, out: Array) -> None:
    """Writes the residuals h F(x_i) - sum_j d_ij M x_j of all stages into `out`, (K, s, n).

    K: intervals of s stages. h: length of an interval. j: the start and the stages of the interval of stage
    i. points: states at the start and at all stages, in order, (1 + K s, n). duration: total length of the
    intervals, in tau2. p: equations F, differentiation matrix d and mass matrix M.
    """
    K, s, n = out.shape
    size = len(p.node_matrices.quadrature_weights)
    V = np.empty((3, size))
    G = np.empty((3, size))
    F = np.empty(n)
    for k in range(K):
        h = duration * p.time_interval_lengths[k]
        for i in range(s):
            write_rates_of_state(points[1 + k * s + i], F, V, G, p)
            _write_stage_slope(points[k * s : (k + 1) * s + 1], i, p.stage_differentiation_matrix, out[k, i])
            for r in range(n):
                out[k, i, r] = h * F[r] - p.mass_diagonal[r] * out[k, i, r]


@compiled_with_reordered_sums
def write_right_sides(
    points: Array,
    duration: float,
    p: OrbitEquations,
    derivatives: ParameterDerivatives,
    V: Array,
    columns: Array,
) -> None:
    """Writes k right-hand sides of Newton's system into `columns`, (K, s, k, n), and the velocities of the
    stages into V, (K, s, 3, nodes + 1).

    Column 0: derivative of the residuals with respect to the period. Column 1: residuals by
    `write_stage_residuals`. Column 2, if present: derivative of the residuals along the parameter of
    `derivatives`. points: states at the start and at all stages, in order, (1 + K s, n). duration: total
    length of the intervals, in tau2. p: equations."""
    K, s, count, n = columns.shape
    G = np.empty(V.shape[2:])
    changes = np.empty((3, *V.shape[2:]))
    slopes = np.empty(n)
    for k in range(K):
        length = p.time_interval_lengths[k]
        for i in range(s):
            x = points[1 + k * s + i]
            sides = columns[k, i]
            write_rates_of_state(x, sides[0], V[k, i], G, p)
            _write_stage_slope(points[k * s : (k + 1) * s + 1], i, p.stage_differentiation_matrix, slopes)
            for r in range(n):
                # sides[0] contains F, which is needed for the residual, and is then overwritten by the
                # derivative of h F with respect to the period.
                sides[1, r] = duration * length * sides[0, r] - p.mass_diagonal[r] * slopes[r]
                sides[0, r] *= length / p.solved_parts_per_period
            if count > 2:
                write_parameter_derivative_of_rates(
                    x, sides[2], V[k, i], changes, derivatives.rod_derivative, p
                )
                for r in range(n):
                    sides[2, r] = duration * length * sides[2, r] - derivatives.mass_derivative[r] * slopes[r]


@compiled_with_reordered_sums
def write_right_sides_of_variations(
    values: Array, p: OrbitEquations, partials: ParameterDerivatives, variations: Array, columns: Array
) -> None:
    """Writes the derivatives of the residuals by `write_stage_residuals` along k variations of an orbit into
    `columns`, (K, s, k, n); K: intervals of s stages.

    values: values of the orbit, (N,). p: equations of the orbit. variations: variations of the values and of
    the parameter of `partials`, (k, N + 1).
    """
    K, s, count, n = columns.shape
    points = values[:-1].reshape(1 + K * s, n)
    duration = values[-1] / p.solved_parts_per_period
    # The last two entries of a variation are the period and the parameter's coordinate.
    changes = variations[:, :-2].copy().reshape(count, 1 + K * s, n)
    V = np.empty(p.rod.drag.shape)
    G = np.empty(p.rod.drag.shape)
    out = np.empty((3, *p.rod.drag.shape))
    F = np.empty(n)
    slopes = np.empty(n)
    by_p = np.zeros(n)
    J = np.empty((n, n))
    tip = np.empty((len(V), n))
    v = np.empty((count, n))
    # Eigenvectors of the flow do not change the parameter: derivatives along the parameter are not needed.
    has_change = np.any(variations[:, -1] != 0.0)
    columns[:] = 0.0
    for k in range(K):
        h = duration * p.time_interval_lengths[k]
        for i in range(s):
            x = points[1 + k * s + i]
            write_rates_of_state(x, F, V, G, p)
            write_jacobian(x, V, J, tip, p.rod, p.node_matrices)
            if has_change:
                write_parameter_derivative_of_rates(x, by_p, V, out, partials.rod_derivative, p)
                _write_stage_slope(points[k * s : (k + 1) * s + 1], i, p.stage_differentiation_matrix, slopes)
                for r in range(n):
                    by_p[r] = h * by_p[r] - partials.mass_derivative[r] * slopes[r]
            v[:] = changes[:, 1 + k * s + i]
            add_products(J, v, columns[k, i], h)
            for m in range(count):
                _write_stage_slope(
                    changes[m, k * s : (k + 1) * s + 1], i, p.stage_differentiation_matrix, slopes
                )
                # h is T/p times the relative length of the interval, so that dh/dT is this length over p.
                change = variations[m, -2] * p.time_interval_lengths[k] / p.solved_parts_per_period
                for r in range(n):
                    rates = change * F[r] + variations[m, -1] * by_p[r]
                    columns[k, i, m, r] += rates - p.mass_diagonal[r] * slopes[r]


@compiled_with_reordered_sums
def _write_stage_slope(points: Array, i: int, d: Array, out: Array) -> None:
    """Writes sum_j d_ij x_j for stage i into `out`, (n,). points: states x_j at the start and at the stages
    of an interval, (s + 1, n). d: matrix from these states to derivatives at the stages, (s, s + 1)."""
    out[:] = 0.0
    for j in range(len(points)):
        for r in range(len(out)):
            out[r] += d[i, j] * points[j, r]
