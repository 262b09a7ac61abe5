"""Newton's matrix of an orbit, eliminated by intervals, beside dense systems of all stages at once."""

from dataclasses import replace

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.plane_equations import write_jacobian
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.parameters import NONLINEAR_ROD_PARAMETER_NAMES
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.bordered.matrix import BorderedMatrix
from rodsweep.solve.branch.bordered.scale import ArcLengthScale
from rodsweep.solve.orbit.matrix.elimination import eliminate_newton_matrix
from rodsweep.solve.orbit.matrix.inversion import INVERSION_SETTINGS, invert_matrix
from rodsweep.solve.orbit.matrix.linearisation import closing_residual, parameter_derivatives
from rodsweep.solve.orbit.matrix.phase_condition import phase_residual, phase_right_side, write_phase_row
from rodsweep.solve.orbit.matrix.right_sides import (
    write_rates_of_state,
    write_right_sides,
    write_stage_residuals,
)
from rodsweep.solve.orbit.matrix.substitution import substitute_stages
from rodsweep.solve.orbit.matrix.workspace import FactorStorage, NewtonWorkspace
from rodsweep.solve.orbit.orbit import Orbit
from rodsweep.solve.orbit.symmetry import REFLECTION

INTERVALS, PERIOD, COLUMNS = 4, 0.02, 2
RODS = {
    "soft": Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2),
    "no stretch, no shear": Rod(F=40.0, k1=np.inf, k2=np.inf, gamma3=1e-3),
    "no rotational drag": Rod(F=40.0, k1=1e4, k2=np.inf, gamma3=0.0),
}


def orbit_with(rod, stages):
    """Any states: what is tested holds for orbits and for what is none."""
    form = StressForm(rod.with_values(gamma1=0.7), uniform_mesh(1, 8))
    states = np.random.default_rng(stages).normal(size=(1 + INTERVALS * stages, form.unknown_count))
    return Orbit.from_states(form, REFLECTION, PERIOD, states, stages)


def velocities(orbit):
    """V of all stages, (K, s, 3, 9)."""
    V, (n, G) = np.empty((*orbit.stage_states.shape[:2], 3, 9)), (orbit.form.unknown_count, np.empty((3, 9)))
    for place in np.ndindex(V.shape[:2]):
        write_rates_of_state(orbit.stage_states[place], np.empty(n), V[place], G, orbit.orbit_equations)
    return V


def dense_matrix(orbit, k):
    """Of all stages of an interval, (s n, s n)."""
    p, (s, n) = orbit.orbit_equations, orbit.stage_states.shape[1:]
    V, G, tip = np.empty((3, 9)), np.empty((3, 9)), np.empty((3, n))
    A = np.kron(p.stage_differentiation_matrix[:, 1:], np.diag(p.mass_diagonal))
    for i in range(s):
        F, J = np.empty(n), np.zeros((n, n))
        write_rates_of_state(orbit.stage_states[k, i], F, V, G, p)
        write_jacobian(orbit.stage_states[k, i], V, J, tip, p.rod, p.node_matrices)
        A[i * n : (i + 1) * n, i * n : (i + 1) * n] -= orbit.solved_duration * p.time_interval_lengths[k] * J
    return A


@pytest.mark.kernel
@pytest.mark.parametrize("stages", [3, 4, 5, 6])
@pytest.mark.parametrize("rod", RODS.values(), ids=RODS.keys())
def test_elimination_is_the_solution_of_the_dense_systems(rod, stages):
    orbit = orbit_with(rod, stages)
    p, n = orbit.orbit_equations, orbit.form.unknown_count
    factors = FactorStorage(NewtonWorkspace(), INTERVALS, stages, n).factors
    random = np.random.default_rng(0)
    columns = random.normal(size=(INTERVALS, stages, COLUMNS, n)) * (p.mass_diagonal + 1e-3)
    start = random.normal(size=(COLUMNS, n))
    reduced, out = columns.copy(), np.empty_like(columns)
    ends = eliminate_newton_matrix(
        orbit.all_states, velocities(orbit), orbit.solved_duration, p, factors, reduced
    )
    substitute_stages(start, reduced, p, factors, out)

    flow, first, still = np.eye(n), start, np.zeros_like(start)
    for k in range(INTERVALS):
        A = dense_matrix(orbit, k)
        by_start = np.kron(p.stage_differentiation_matrix[:, :1], np.diag(p.mass_diagonal))
        sides = columns[k].transpose(0, 2, 1).reshape(stages * n, COLUMNS)
        changes = np.linalg.solve(A, sides - by_start @ first.T)
        expected = changes.reshape(stages, n, COLUMNS).transpose(0, 2, 1)
        assert np.abs(out[k] - expected).max() < 1e-9 * np.abs(expected).max()
        first = expected[-1]
        still = np.linalg.solve(A, sides - by_start @ still.T)[-n:].T
        flow = -np.linalg.solve(A, by_start @ flow)[-n:]
    assert np.abs(ends - still).max() < 1e-9 * np.abs(still).max()
    assert np.abs(factors.propagator - flow).max() < 1e-9 * np.abs(flow).max()


@pytest.mark.kernel
@pytest.mark.parametrize("n", [5, INVERSION_SETTINGS.panel_width, 54])
@pytest.mark.parametrize("unit", [1e-8, 1.0, 1e8])
def test_an_inverse_is_as_accurate_in_any_unit(n, unit):
    random = np.random.default_rng(n)
    A = unit * (random.normal(size=(n, n)) + np.diag(random.uniform(5, 50, n)))
    inverse = A.copy()
    invert_matrix(inverse, np.empty(n, np.int64), np.empty((n, INVERSION_SETTINGS.panel_width)))
    assert np.abs(inverse @ A - np.eye(n)).max() < 1e-13


def balances(orbit, name, change):
    """Residuals of all stages, and the right side of the phase, with a parameter's coordinate changed."""
    form = orbit.form
    moved = replace(orbit, form=form.with_coordinate(name, form.rod.coordinate(name) + change))
    p, out = moved.orbit_equations, np.empty_like(orbit.stage_states)
    write_stage_residuals(orbit.all_states, orbit.solved_duration, p, out)
    return np.append(out, -phase_residual(orbit.start_state, p.rod, p.node_matrices))


@pytest.mark.long
@pytest.mark.parametrize("name", NONLINEAR_ROD_PARAMETER_NAMES)
@pytest.mark.parametrize("rod", RODS.values(), ids=RODS.keys())
def test_derivative_by_a_parameter_is_the_limit_of_differences(rod, name):
    orbit = orbit_with(rod, 4)
    along, columns = (
        parameter_derivatives(orbit.form, name),
        np.empty((INTERVALS, 4, 3, orbit.form.unknown_count)),
    )
    p, V = orbit.orbit_equations, np.empty((INTERVALS, 4, 3, 9))
    write_right_sides(orbit.all_states, orbit.solved_duration, p, along, V, columns)
    right = columns[:, :, 2]
    shift = phase_right_side(orbit.start_state, along.rod_derivative, p.rod, p.node_matrices)
    step = 1e-4 * orbit.form.rod.coordinate(name) or 1e-6  # to one side: a limit has no other
    there = np.array([balances(orbit, name, k * step) for k in range(3)])
    limit, rounding = [-1.5, 2, -0.5] @ there / step, 4e-15 * np.abs(there).max() / step
    assert np.abs(right.ravel() - limit[:-1]).max() < 1e-6 * np.abs(right).max() + rounding
    assert abs(shift - limit[-1]) < 1e-6 * abs(shift) + rounding
    assert np.abs(right).max() > 0


def whole_matrix(matrix):
    """Newton's matrix without its last row, of all states, period and parameter, (N, N + 1)."""
    orbit = matrix.orbit
    p, (K, s, n) = orbit.orbit_equations, orbit.stage_states.shape
    along, columns = parameter_derivatives(orbit.form, matrix.scale.parameter_name), np.empty((K, s, 3, n))
    write_right_sides(orbit.all_states, orbit.solved_duration, p, along, np.empty((K, s, 3, 9)), columns)
    A = np.zeros((len(orbit.values), len(orbit.values) + 1))
    A[:n, :n] -= p.symmetry_matrix
    A[:n, -2 - n : -2] += np.eye(n)
    for k in range(K):
        rows, start = slice(n + k * s * n, n + (k + 1) * s * n), slice(k * s * n, k * s * n + n)
        A[rows, rows] = dense_matrix(orbit, k)
        A[rows, start] += np.kron(p.stage_differentiation_matrix[:, :1], np.diag(p.mass_diagonal))
        A[rows, -2:] = -columns[k][:, [0, 2]].transpose(0, 2, 1).reshape(s * n, 2)
    write_phase_row(orbit.start_state, p.rod, p.node_matrices, A[-1, :n])
    A[-1, -1] = -phase_right_side(orbit.start_state, along.rod_derivative, p.rod, p.node_matrices)
    jump, shift = (
        closing_residual(orbit.all_states, p),
        phase_residual(orbit.start_state, p.rod, p.node_matrices),
    )
    return A, np.array([*jump, *columns[:, :, 1].ravel(), -shift])


@pytest.mark.parametrize("period, growth", [(0.03, 1e5), (0.05, 1e12)])
def test_steps_keep_their_digits_however_much_perturbations_grow(period, growth):
    form = StressForm(RODS["soft"].with_values(F=150.0, gamma1=0.7), uniform_mesh(1, 8))
    states = 0.3 * np.random.default_rng(3).normal(size=(61, form.unknown_count))
    states -= 150 * form.layout.state_with_stresses(
        {"n1": np.ones(8)}
    )  # beside the straight rod, which is unstable
    orbit, border = Orbit.from_states(form, REFLECTION, period, states, 3), np.array([0.6, 0.0, 0.8])
    matrix = BorderedMatrix(orbit, ArcLengthScale.at_orbit(orbit, "F", 0.1), NewtonWorkspace())
    assert np.linalg.norm(matrix.propagator) > growth
    A, right = whole_matrix(matrix)
    tangent = matrix.branch_tangent(border)
    for change, sides in (
        (matrix.newton_step(border, 0.1), right),
        (matrix.newton_step_at_nearby_orbit(orbit, border, 0.1), right),
        (tangent, 0 * right),
    ):
        assert np.abs(A @ change - sides).max() < 1e-9 * (np.abs(A) @ np.abs(change)).max()
    assert border @ matrix.scale.directional_derivative(
        orbit, matrix.newton_step(border, 0.1)
    ) == pytest.approx(0.1, rel=1e-9)
    expected = np.linalg.solve(np.vstack([A, tangent]), np.append(right, 0.0))
    found = matrix.newton_step(border, 0.1)
    found = found - tangent * (tangent @ found) / (tangent @ tangent)
    assert np.abs(found - expected).max() < 1e-8 * np.abs(expected).max()
