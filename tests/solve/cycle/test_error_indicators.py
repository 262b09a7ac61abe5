"""Energy lost by the collocation in time, as an estimate of the error of the amplitude."""

import numpy as np
import pytest
from rods import rod_of

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.stress.form import StressForm
from rodsweep.solve.cycle.accuracy.error_indicators import (
    AMPLITUDE_ERROR_INDEX,
    error_indicators,
    squared_tail_growth,
)
from rodsweep.solve.cycle.hopf_start import hopf_point_below_force, orbit_from_hopf
from rodsweep.solve.orbit.compiled_measures import write_powers
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion
from rodsweep.solve.orbit.newton import newton_step_if_matrix_distant, solve_by_newton

STAGES, FINE = 4, 24


def converged(orbit, intervals):
    found = solve_by_newton(orbit.on_mesh(orbit.form.mesh, intervals, STAGES), 1e-11, NewtonWorkspace())
    return newton_step_if_matrix_distant(found, 1e-9)


@pytest.fixture(scope="module", params=[1.01, 1.1])
def orbit(request):
    form = StressForm(rod_of(100.0, 1e3, 1e2, 1e-2), uniform_mesh(1, 12))
    hopf = hopf_point_below_force(form.rod)
    beyond = StressForm(rod_of(request.param * hopf.F, 1e3, 1e2, 1e-2), form.mesh)
    return orbit_from_hopf(beyond, hopf, NewtonWorkspace())


@pytest.mark.parametrize("intervals", [6, 8])
def test_amplitude_error_by_energy_has_the_order_of_magnitude_of_the_error(orbit, intervals):
    """On the same elements, so that the error is that of the time intervals alone."""
    found, exact = converged(orbit, intervals), converged(orbit, FINE)
    path = CycleMotion(found.orbit)
    y = [one.tip_extrema["tip_y_max"] for one in (path, CycleMotion(exact.orbit))]
    estimate = error_indicators(found, path)[AMPLITUDE_ERROR_INDEX]
    assert estimate / 10 < abs(y[0] / y[1] - 1) < 10 * estimate


def test_every_interval_loses_energy(orbit):
    """The collocation never gains energy with a linear law, so the losses do not cancel."""
    found = converged(orbit, 6).orbit
    power = np.empty((2, found.interval_count * found.stage_count))
    write_powers(np.ascontiguousarray(found.all_states[1:]), power, found.orbit_equations)
    lengths = found.solved_duration * found.orbit_equations.time_interval_lengths
    gained = (
        (power[0] - power[1]).reshape(found.interval_count, -1) @ found.collocation_method.weights * lengths
    )
    stored = np.diff(found.form.elastic_energy(np.ascontiguousarray(found.all_states[:: found.stage_count])))
    assert (gained > stored).all()


@pytest.mark.parametrize(
    ("earlier", "later", "growth"),
    [
        ((2e-3, 3e-2, 1e-4, 1.0), (4e-3, 3e-2, 1e-4, 1.0), (4.0, 1.0)),
        ((2e-3, 3e-2, 1e-4, 1.0), (1e-3, 3e-2, 3e-4, 0.5), (0.25, 2.25)),
        ((1e-9, 3e-2, 1e-4, 1.0), (1e-6, 3e-2, 1e-4, 1.0), (1.0, 1.0)),
        ((2e-3, 3e-2, 1e-4, 1.0), (6e-2, 1e-4, 1.0), (4.0, 1.0)),
        ((3e-2, 1e-4, 1.0), (6e-2, 2e-4, 1.0), (4.0, 4.0)),
    ],
)
def test_errors_in_space_grow_with_the_tail_of_the_element_that_grows_most(earlier, later, growth):
    assert squared_tail_growth(np.array(earlier), np.array(later)) == pytest.approx(growth, rel=1e-12)
