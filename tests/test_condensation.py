"""Newton's matrix of an orbit, condensed interval by interval, beside dense systems of all stages at once."""

import numpy as np
import pytest

from rodsweep.discretization.mesh import mesh
from rodsweep.discretization.stress_balance import jacobian
from rodsweep.discretization.stress_form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.condensation import eliminate, equations, substitute
from rodsweep.solve.cycle.linearisation import workspace
from rodsweep.solve.cycle.orbit import Orbit

INTERVALS, PERIOD, COLUMNS = 4, 0.02, 2
RODS = {
    "soft": Rod(50.0, 1e4, 1e2, 1e-2),
    "no stretch, no shear": Rod(40.0, np.inf, np.inf, 1e-3),
    "no rotational drag": Rod(40.0, 1e4, np.inf, 0.0),
}


def orbit_with(rod, stages):
    """Any states: what is tested holds for orbits and for what is none."""
    form = StressForm(rod, 0.7, mesh(1, 8))
    states = np.random.default_rng(stages).normal(size=(1 + INTERVALS * stages, form.unknowns))
    return Orbit.of(form, True, PERIOD, states, stages)


def dense_matrix(orbit, k):
    """Of all stages of an interval, (s n, s n)."""
    p, (s, n) = orbit.semidiscrete, orbit.states.shape[1:]
    V, G, tip = np.empty((3, 9)), np.empty((3, 9)), np.empty((3, n))
    A = np.kron(p.differentiation[:, 1:], np.diag(p.mass))
    for i in range(s):
        F, J = np.empty(n), np.zeros((n, n))
        equations(orbit.states[k, i], F, V, G, p)
        jacobian(orbit.states[k, i], V, J, tip, p.parameters, p.matrices)
        A[i * n : (i + 1) * n, i * n : (i + 1) * n] -= orbit.duration * p.lengths[k] * J
    return A


@pytest.mark.kernel
@pytest.mark.parametrize("stages", [3, 4, 5, 6])
@pytest.mark.parametrize("rod", RODS.values(), ids=RODS.keys())
def test_elimination_is_the_solution_of_the_dense_systems(rod, stages):
    orbit = orbit_with(rod, stages)
    p, n = orbit.semidiscrete, orbit.form.unknowns
    factors = workspace(INTERVALS, stages, n)
    random = np.random.default_rng(0)
    columns = random.normal(size=(INTERVALS, stages, COLUMNS, n)) * (p.mass + 1e-3)
    start = random.normal(size=(COLUMNS, n))
    ends = eliminate(orbit.points, orbit.duration, p, factors, columns)
    out = np.empty_like(columns)
    substitute(start, columns, p, factors, out)

    flow, first, still = np.eye(n), start, np.zeros_like(start)
    for k in range(INTERVALS):
        A = dense_matrix(orbit, k)
        by_start = np.kron(p.differentiation[:, :1], np.diag(p.mass))
        sides = columns[k].transpose(0, 2, 1).reshape(stages * n, COLUMNS)
        changes = np.linalg.solve(A, sides - by_start @ first.T)
        expected = changes.reshape(stages, n, COLUMNS).transpose(0, 2, 1)
        assert np.abs(out[k] - expected).max() < 1e-9 * np.abs(expected).max()
        first = expected[-1]
        still = np.linalg.solve(A, sides - by_start @ still.T)[-n:].T
        flow = -np.linalg.solve(A, by_start @ flow)[-n:]
    assert np.abs(ends - still).max() < 1e-9 * np.abs(still).max()
    assert np.abs(factors.propagator - flow).max() < 1e-9 * np.abs(flow).max()
