"""Newton's matrix for a cycle with the parameter as a further unknown: one further column for the parameter,
and one further row, the border. The solved time interval is half the period for a symmetric orbit, otherwise
the period. Shapes: K intervals with s stages each, n unknowns of a state, m shooting intervals, N orbit
values."""

from functools import cached_property

import numpy as np

from ....arrays import Array, Complex
from ...orbit.matrix.elimination import eliminate_newton_matrix
from ...orbit.matrix.linearisation import (
    closing_residual,
    parameter_derivatives,
    reduced_residuals,
    reduced_stage_residual_variations,
)
from ...orbit.matrix.multipliers import multipliers_over_period, multipliers_over_solved_time_interval
from ...orbit.matrix.phase_condition import phase_residual, phase_right_side, write_phase_row
from ...orbit.matrix.right_sides import write_right_sides
from ...orbit.matrix.shooting_intervals import shooting_intervals_of
from ...orbit.matrix.substitution import substitute_stages
from ...orbit.matrix.workspace import FactorStorage, NewtonWorkspace
from ...orbit.newton import relative_change
from ...orbit.orbit import Orbit
from .linear_system_with_border_row import LinearSystemWithBorderRow
from .scale import ArcLengthScale, deflection_functional


class BorderedMatrix:
    """Newton's matrix at an orbit with the parameter as a further unknown. The last row is the argument
    `border` of the methods that solve the system.

    A step, (N + 1,), changes the orbit values and the parameter coordinate. Solving raises RuntimeError after
    another matrix was assembled in the same workspace; multipliers stay valid.
    """

    def __init__(self, orbit: Orbit, scale: ArcLengthScale, workspace: NewtonWorkspace) -> None:
        self.orbit = orbit
        self.scale = scale
        self.workspace = workspace
        self.tangent: Array | None = None  # the branch orients its own tangent, see `tangent_at`
        p = orbit.orbit_equations
        derivatives = parameter_derivatives(orbit.form, scale.parameter_name)
        K, s, n = orbit.stage_states.shape
        V = np.empty((K, s, 3, len(p.node_matrices.quadrature_weights)))
        # Third axis: column of the period (0), residual (1), column of the parameter (2).
        self._stage_columns = np.empty((K, s, 3, n))
        self._memory = FactorStorage(workspace, K, s, n)
        write_right_sides(orbit.all_states, orbit.solved_duration, p, derivatives, V, self._stage_columns)
        ends = eliminate_newton_matrix(
            orbit.all_states, V, orbit.solved_duration, p, self._memory.factors, self._stage_columns
        )
        self._shooting_intervals = shooting_intervals_of(self._memory.factors, p.mass_diagonal)
        m = len(self._shooting_intervals.flow_maps)
        self._matrix = np.zeros((m * n + 2, m * n + 2))
        for j in range(m):
            rows = slice(j * n, (j + 1) * n)
            self._matrix[rows, rows] = self._shooting_intervals.flow_maps[j]
            # The last shooting interval ends at the symmetric image of the first interval's start.
            if j < m - 1:
                self._matrix[rows, (j + 1) * n : (j + 2) * n] = -np.eye(n)
            else:
                self._matrix[rows, :n] -= p.symmetry_matrix
        for place, c in ((-2, 0), (-1, 2)):
            column = slice(c, c + 1)
            self._matrix[:-2, place] = -self.matching_right_sides(
                np.zeros(n), self._stage_columns[:, :, column], ends[column]
            )
        row = np.empty(n)
        write_phase_row(orbit.start_state, p.rod, p.node_matrices, row)
        self._matrix[-2, :n] = row
        # `phase_right_side` is a right-hand side, with a minus sign; in a column of the matrix it is plus.
        self._matrix[-2, -1] = -phase_right_side(
            orbit.start_state, derivatives.rod_derivative, p.rod, p.node_matrices
        )
        self._system = LinearSystemWithBorderRow(self._matrix)
        self._right_sides = self._matching_and_phase_right_sides(
            orbit, self._stage_columns[:, :, 1:2], ends[1:2]
        )

    @property
    def has_valid_factors(self) -> bool:
        """Whether no other matrix was assembled in the workspace, so that systems can be solved."""
        return self._memory.is_valid

    def relative_distance_to_orbit(self, orbit: Orbit) -> float:
        """Relative distance of an orbit on the same mesh from the orbit of this matrix."""
        return relative_change(self.orbit, orbit.values - self.orbit.values)

    def newton_step(self, border: Array, residual: float) -> Array:
        """Newton's step at the orbit, (N + 1,), which changes `border` . `scale.components` by `residual`, to
        first order. border: last row, coefficients of (deflection, log period, parameter), (3,). residual:
        residual of the condition `BorderCondition` that closes the system."""
        return self.solve(border, np.append(self._right_sides, residual), self._stage_columns[:, :, 1], 1.0)

    def newton_step_at_nearby_orbit(self, orbit: Orbit, border: Array, residual: float) -> Array:
        """Approximate Newton's step, (N + 1,), at a neighbouring `orbit` with a similar parameter, from the
        factors of this matrix. border, residual: as in `newton_step`, the residual at `orbit`."""
        factors = self._memory.factors
        p = self.orbit.orbit_equations
        columns, ends = reduced_residuals(
            orbit.all_states, orbit.solved_duration, orbit.orbit_equations, p, factors
        )
        right_side = np.append(self._matching_and_phase_right_sides(orbit, columns, ends), residual)
        return self.solve(border, right_side, columns[:, :, 0], 1.0)

    def branch_tangent(self, border: Array) -> Array:
        """Tangent of the branch with unit arc length, (N + 1,). In components (deflection, log period,
        parameter), (3,), the tangent is a unit vector that makes an acute angle with `border`, (3,)."""
        # The null vector of all rows except the last, normalised by the border; residuals are not needed.
        right_side = np.append(np.zeros(len(self._right_sides)), 1.0)
        change = self.solve(border, right_side, self._stage_columns[:, :, 1], 0.0)
        return change / np.linalg.norm(self.scale.directional_derivative(self.orbit, change))

    def residual_variations(
        self, orbit: Orbit, variations: Array, name: str | None = None
    ) -> tuple[Array, Array]:
        """Returns (stages, ends): derivatives of the stage residuals of `orbit` along v variations, reduced
        by the factors of this matrix, (K, s, v, n), and the resulting increments of the state at the
        end of the last interval for a fixed start, (v, n).

        variations: variations of orbit values and of the coordinate of the parameter `name`, (v, N + 1).
        name: None for the parameter of the branch.
        """
        derivatives = parameter_derivatives(orbit.form, name or self.scale.parameter_name)
        equations = orbit.orbit_equations
        p = self.orbit.orbit_equations
        sides: tuple[Array, Array] = reduced_stage_residual_variations(
            orbit.values, equations, derivatives, variations, p, self._memory.factors
        )
        return sides

    def parameter_derivative_by_other_parameter(self, name: str, border: Array) -> float:
        """Derivative of the parameter coordinate with respect to the coordinate of another parameter `name`,
        along cycles that all have the same value of `border` . `scale.components`; border: (3,).

        At a fold the derivative does not depend on `border`: it is the slope of the curve of folds.
        """
        orbit = self.orbit
        variation = np.append(np.zeros(len(orbit.values)), 1.0)
        columns, ends = self.residual_variations(orbit, variation[None], name)
        sides = self.matching_right_sides(np.zeros(len(orbit.start_state)), columns, ends)
        p = orbit.orbit_equations
        change = orbit.form.nodal_rod_parameter_derivative(name)
        phase_side = phase_right_side(orbit.start_state, change, p.rod, p.node_matrices)
        return float(self.solve(border, np.array([*sides, phase_side, 0.0]), columns[:, :, 0], 1.0)[-1])

    def orbit_increments_at_fixed_parameter(self, starts: Array, columns: Array) -> Array:
        """Increments of the orbit, (v, N + 1), at fixed period and parameter, for v increments `starts` of
        the start state, (v, n). columns: reduced right-hand sides at the stages for `starts`, (K, s, v,
        n)."""
        out = np.empty_like(columns)
        substitute_stages(starts, columns, self.orbit.orbit_equations, self._memory.factors, out)
        stages = out.transpose(2, 0, 1, 3).reshape(len(starts), -1)
        # Eigenvectors of the monodromy matrix change neither the period nor the parameter.
        return np.hstack([starts, stages, np.zeros((len(starts), 2))])

    @property
    def has_several_shooting_intervals(self) -> bool:
        """Whether the orbit is so unstable that its matrix has more than one shooting interval."""
        return len(self._shooting_intervals.flow_maps) > 1

    @property
    def propagator(self) -> Array:
        """Propagator P, (n, n), of the linearised motion over the solved time interval."""
        return self._memory.propagator

    @cached_property
    def multipliers_over_solved_time_interval(self) -> Complex:
        """Multipliers over the solved time interval, (multipliers,): eigenvalues of the propagator, composed
        with the reflection for a symmetric orbit."""
        if len(self._shooting_intervals.flow_maps) == 1:
            return multipliers_over_solved_time_interval(self.propagator, self.orbit)
        return self._shooting_intervals.multipliers(self.orbit)

    def multipliers(self) -> Complex:
        """Floquet multipliers larger than rounding error, by descending modulus, (multipliers,), with the
        trivial multiplier."""
        return multipliers_over_period(self.multipliers_over_solved_time_interval, self.orbit)

    def approximate_null_vector(self) -> Array:
        """Approximate null vector of the matrix with the parameter fixed, (N + 1,), of any length and sign:
        the right singular vector of the smallest singular value.

        At a crossing of two branches the vector points along the second branch.
        """
        matrix = self._matrix.copy()
        # The last row fixes the parameter.
        matrix[-1, -1] = 1.0
        return self._back_substitute(np.linalg.svd(matrix)[2][-1], self._stage_columns[:, :, 1], 0.0)

    def matching_right_sides(self, jump: Array, columns: Array, end_increments: Array) -> Array:
        """Right-hand sides, (m n,), of the m matching conditions of multiple shooting: each shooting interval
        must end where the next interval starts, the last interval at the symmetric image of the first start.

        jump: distance S x(0) - x(end) from the end of the last interval to this image, (n,), S: symmetry. The
        other intervals have no jump, because the orbit has one state for the end of an interval and the start
        of the next. columns: right-hand sides of the stages, reduced by the factors of the matrix, (K, s, 1,
        n). end_increments: increment of the state at the end of the last time interval that `columns` cause
        if the first state is fixed, (1, n).
        """
        p = self.orbit.orbit_equations
        sides = -self._shooting_intervals.end_increments_for_fixed_starts(
            self._memory.factors, columns, end_increments, p
        )[:, 0]
        sides[-1] += jump
        return sides.ravel()

    def _matching_and_phase_right_sides(self, orbit: Orbit, columns: Array, end_increments: Array) -> Array:
        """Right-hand sides of the m matching conditions of an orbit, one for each shooting interval, and of
        the phase condition, (m n + 1,). columns, end_increments: as in `matching_right_sides`."""
        p = orbit.orbit_equations
        matching_sides = self.matching_right_sides(
            closing_residual(orbit.all_states, p), columns, end_increments
        )
        return np.append(matching_sides, -phase_residual(orbit.start_state, p.rod, p.node_matrices))

    def solve(self, border: Array, right_side: Array, sides: Array, fraction: float) -> Array:
        """Solution of the bordered linear system, (N + 1,). border: last row, in components (deflection, log
        period, parameter), (3,).

        right_side: right-hand sides of the matching conditions, of the phase condition and of the border, (m
        n + 2,). sides: right-hand sides of the stages, (K, s, n). fraction: factor on `sides`, 1 for a Newton
        step, 0 for a tangent.
        """
        row = np.zeros(len(self._matrix))
        row[: len(self.orbit.start_state)] = (
            border[0] / self.scale.deflection_unit * deflection_functional(self.orbit)
        )
        # The border acts on log T, whose derivative is 1/T.
        row[-2:] = border[1] / self.orbit.period, border[2] / self.scale.coordinate_unit
        return self._back_substitute(self._system.solve(row, right_side), sides, fraction)

    def _back_substitute(self, increments: Array, sides: Array, fraction: float) -> Array:
        """Increment of orbit values and parameter, (N + 1,). increments: increments of the states at the
        starts of the shooting intervals, of the period and of the parameter, (m n + 2,). sides: right-hand
        sides of the stages, (K, s, n). fraction: factor on `sides`, 1 for a Newton step, 0 for a null
        vector."""
        n = len(self.orbit.start_state)
        stages = (
            increments[-2] * self._stage_columns[:, :, 0]
            + fraction * sides
            + increments[-1] * self._stage_columns[:, :, 2]
        )
        columns = np.ascontiguousarray(stages[:, :, None])
        starts = increments[:-2].reshape(-1, n).copy()
        factors = self._memory.factors
        out = self._shooting_intervals.stage_increments(factors, starts, columns, self.orbit.orbit_equations)
        return np.concatenate([increments[:n], out.ravel(), increments[-2:]])
