"""Newton's matrix at an orbit: Newton's step, derivative along a parameter, and all Floquet multipliers.

After the elimination of the intervals (`elimination`) a system for the state at t = 0 and the period remains.
Its last row is the phase condition. N: number of orbit values. K: intervals, s: stages each, n: unknowns of a
state.
"""

from functools import cached_property

import numpy as np

from ....arrays import Array, Complex
from ....discretization.nodal_rod import NO_JUMP_DERIVATIVE, NodalRodDerivative
from ....discretization.state_layout import SE2_DIMENSION
from ....discretization.stress.form import StressForm
from ....model.compiled.compilation import compiled_with_reordered_sums
from ..equations import OrbitEquations
from ..orbit import Orbit
from .elimination import eliminate_newton_matrix
from .inversion import INVERSION_SETTINGS, invert_matrix
from .multipliers import multipliers_over_period, multipliers_over_solved_time_interval
from .phase_condition import phase_residual, phase_right_side, write_phase_row
from .right_sides import (
    ParameterDerivatives,
    write_right_sides,
    write_right_sides_of_variations,
    write_stage_residuals,
)
from .substitution import map_start_to_end, reduce_right_sides, substitute_stages
from .workspace import FactorStorage, NewtonFactors, NewtonWorkspace

NO_ROD_DERIVATIVE = NodalRodDerivative(np.zeros(0), *(np.zeros((0, 0)),) * 3, NO_JUMP_DERIVATIVE)
"""Placeholder for the derivative of a rod if there is no parameter; compiled code never reads it."""


class Linearisation:
    """Newton's matrix at an orbit. `newton_step_at_nearby_orbit` works until another matrix is assembled in
    its workspace.

    step: Newton's step at the orbit, (N,). tangent: derivative of the orbit values with respect to the
    coordinate of the parameter `parameter_name`, (N,); None if no parameter was given.
    """

    def __init__(self, orbit: Orbit, workspace: NewtonWorkspace, parameter_name: str | None = None) -> None:
        self.orbit = orbit
        self.workspace = workspace
        self._memory = FactorStorage(
            workspace, orbit.interval_count, orbit.stage_count, orbit.form.unknown_count
        )
        p = orbit.orbit_equations
        factors = self._memory.factors
        derivatives = (
            ParameterDerivatives(NO_ROD_DERIVATIVE, p.mass_diagonal)
            if parameter_name is None
            else parameter_derivatives(orbit.form, parameter_name)
        )
        column_count = 2 if parameter_name is None else 3
        steps, self._period_derivative = eliminate_and_solve_at_orbit(
            orbit.values, column_count, derivatives, p, factors
        )
        self.step = steps[0]
        self.tangent = None if parameter_name is None else steps[1]

    def newton_step_at_nearby_orbit(self, orbit: Orbit) -> Array:
        """Newton's step, (N,), at the nearby `orbit`; raises RuntimeError if the factors were overwritten."""
        step: Array = newton_step_with_factors(
            orbit.values, self._period_derivative, orbit.orbit_equations, self._memory.factors
        )
        return step

    @cached_property
    def multipliers_over_solved_time_interval(self) -> Complex:
        """Multipliers over the solved part of the period (half a period for a symmetric orbit, else the whole
        period), (multipliers,). Another matrix in the same workspace does not change them."""
        return multipliers_over_solved_time_interval(self._memory.propagator, self.orbit)

    def multipliers(self) -> Complex:
        """Floquet multipliers larger than rounding error, by descending modulus, (multipliers,), with the
        trivial multiplier."""
        return multipliers_over_period(self.multipliers_over_solved_time_interval, self.orbit)


def parameter_derivatives(form: StressForm, name: str) -> ParameterDerivatives:
    """Derivatives of the rod and of its mass, (n,), with respect to the coordinate of the parameter `name`,
    for example 1/k1 (`Rod.coordinate`)."""
    change = form.nodal_rod_parameter_derivative(name)
    return ParameterDerivatives(change, form.mass_diagonal_of(change))


@compiled_with_reordered_sums
def eliminate_and_solve_at_orbit(
    values: Array, count: int, derivatives: ParameterDerivatives, p: OrbitEquations, factors: NewtonFactors
) -> tuple[Array, Array]:
    """Eliminates Newton's matrix at the orbit with the given `values`, (N,), and writes it into `factors`.

    Returns (steps, period_derivative). steps: Newton's step and, if count = 3, the derivative of the orbit
    values along the parameter of `derivatives`, (count - 1, N). period_derivative: derivative of the stage
    residuals with respect to the period, reduced by the elimination, (K, s, n), for K time intervals with s
    stages of n unknowns. count: 2 or 3. p: equations of the orbit.
    """
    K = len(factors.eliminated_blocks)
    s = len(p.stage_differentiation_matrix)
    n = len(p.mass_diagonal)
    points = values[:-1].reshape(1 + K * s, n)
    duration = values[-1] / p.solved_parts_per_period
    V = np.empty((K, s, SE2_DIMENSION, len(p.node_matrices.quadrature_weights)))
    columns = np.empty((K, s, count, n))
    write_right_sides(points, duration, p, derivatives, V, columns)
    ends = eliminate_newton_matrix(points, V, duration, p, factors, columns)
    inverse = factors.closing_matrix_inverse
    inverse[:, :] = 0.0
    inverse[:n, :n] = factors.propagator
    for i in range(n):
        # System of the closing condition, (P - S) dx(0) + (dx(T/p)/dT) dT = jump, and of the phase condition.
        inverse[i, n] = ends[0, i]
        for j in range(n):
            inverse[i, j] -= p.symmetry_matrix[i, j]
    write_phase_row(points[0], p.rod, p.node_matrices, inverse[n, :n])
    invert_matrix(inverse, np.empty(n + 1, np.int64), np.empty((n + 1, INVERSION_SETTINGS.panel_width)))
    right_sides = np.zeros((count - 1, n + 1))
    for m in range(1, count):
        for i in range(n):
            right_sides[m - 1, i] = -ends[m, i]
    right_sides[0, :n] += closing_residual(points, p)
    right_sides[0, n] = -phase_residual(points[0], p.rod, p.node_matrices)
    if count > 2:
        right_sides[1, n] = phase_right_side(points[0], derivatives.rod_derivative, p.rod, p.node_matrices)
    # A contiguous copy: later corrections at nearby orbits need only this column.
    period_derivative = columns[:, :, 0].copy()
    return orbit_increments(right_sides, period_derivative, columns[:, :, 1:], p, factors), period_derivative


@compiled_with_reordered_sums
def closing_residual(points: Array, p: OrbitEquations) -> Array:
    """Residual S x(0) - x(end) of the closing condition, (n,), S: symmetry. points: states at the start and
    at the s stages of the K time intervals, (1 + K s, n)."""
    jump = -points[-1]
    for i in range(len(jump)):
        for j in range(len(jump)):
            jump[i] += p.symmetry_matrix[i, j] * points[0, j]
    return jump


@compiled_with_reordered_sums
def orbit_increments(
    right_sides: Array, period_derivative: Array, columns: Array, p: OrbitEquations, factors: NewtonFactors
) -> Array:
    """Increments of the orbit values, (k, N), for k right-hand sides, by the eliminated matrix `factors`.
    right_sides: right-hand sides of closing and phase conditions, (k, n + 1). columns: right-hand sides of
    the s stages of each of the K time intervals, reduced by the elimination, (K, s, k, n). period_derivative:
    derivative of the stage residuals with respect to the period, also reduced, (K, s, n)."""
    K, s, count, n = columns.shape
    increments = np.zeros((count, n + 1))
    for m in range(count):
        for i in range(n + 1):
            total = 0.0
            for j in range(n + 1):
                total += factors.closing_matrix_inverse[i, j] * right_sides[m, j]
            increments[m, i] = total
    end_increments = np.empty((K, s, count, n))
    out = np.empty((K, s, count, n))
    for k in range(K):
        for i in range(s):
            for m in range(count):
                for r in range(n):
                    end_increments[k, i, m, r] = (
                        columns[k, i, m, r] + increments[m, n] * period_derivative[k, i, r]
                    )
    substitute_stages(increments[:, :n].copy(), end_increments, p, factors, out)
    steps = np.empty((count, (1 + K * s) * n + 1))
    for m in range(count):
        steps[m, :n] = increments[m, :n]
        steps[m, -1] = increments[m, n]
        for k in range(K):
            for i in range(s):
                first = (1 + k * s + i) * n
                for r in range(n):
                    steps[m, first + r] = out[k, i, m, r]
    return steps


@compiled_with_reordered_sums
def reduced_residuals(
    points: Array, duration: float, rod: OrbitEquations, p: OrbitEquations, factors: NewtonFactors
) -> tuple[Array, Array]:
    """Residuals of the states `points`, (1 + K s, n), with the equations `rod`, reduced by the eliminated
    matrix `factors` of a nearby orbit with the equations `p`. duration: total length of the K time intervals,
    in tau2. s: number of stages.

    Returns (columns, ends): reduced residuals of the stages, (K, s, 1, n), and increment of the state at the
    end of the last time interval for a fixed start, (1, n).
    """
    K = len(factors.eliminated_blocks)
    s = len(p.stage_differentiation_matrix)
    n = len(p.mass_diagonal)
    columns = np.empty((K, s, 1, n))
    ends = np.zeros((1, n))
    write_stage_residuals(points, duration, rod, columns[:, :, 0])
    for k in range(K):
        reduce_right_sides(factors.eliminated_blocks[k], columns[k], p)
        map_start_to_end(factors.eliminated_blocks[k], columns[k], p, ends)
    return columns, ends


@compiled_with_reordered_sums
def reduced_stage_residual_variations(
    values: Array,
    rod: OrbitEquations,
    derivatives: ParameterDerivatives,
    variations: Array,
    p: OrbitEquations,
    factors: NewtonFactors,
) -> tuple[Array, Array]:
    """The right-hand sides of `write_right_sides_of_variations` with the equations `rod`, reduced by the
    eliminated matrix `factors` of a nearby orbit with the equations `p`.

    Returns (columns, ends): for m `variations` the reduced right-hand sides of the s stages of each of the K
    time intervals, (K, s, m, n), and the increments of the state at the end of the last time interval for a
    fixed start, (m, n).
    """
    K = len(factors.eliminated_blocks)
    s = len(p.stage_differentiation_matrix)
    n = len(p.mass_diagonal)
    m = len(variations)
    columns = np.empty((K, s, m, n))
    ends = np.zeros((m, n))
    write_right_sides_of_variations(values, rod, derivatives, variations, columns)
    for k in range(K):
        reduce_right_sides(factors.eliminated_blocks[k], columns[k], p)
        map_start_to_end(factors.eliminated_blocks[k], columns[k], p, ends)
    return columns, ends


@compiled_with_reordered_sums
def newton_step_with_factors(
    values: Array, period_derivative: Array, p: OrbitEquations, factors: NewtonFactors
) -> Array:
    """Newton's step, (N,), at the orbit values `values`, (N,). p: equations of the orbit. factors,
    period_derivative: from `eliminate_and_solve_at_orbit` at a nearby orbit."""
    K, s, n = period_derivative.shape
    points = values[:-1].reshape(1 + K * s, n)
    duration = values[-1] / p.solved_parts_per_period
    columns, ends = reduced_residuals(points, duration, p, p, factors)
    right_sides = np.empty((1, n + 1))
    # The residuals of the stages move the end, too; this change is subtracted from the jump.
    right_sides[0, :n] = closing_residual(points, p) - ends[0]
    right_sides[0, n] = -phase_residual(points[0], p.rod, p.node_matrices)
    return orbit_increments(right_sides, period_derivative, columns, p, factors)[0]
