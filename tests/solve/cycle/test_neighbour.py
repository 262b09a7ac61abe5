"""How the cycles before it predict the next one of a chain."""

from dataclasses import replace

import numpy as np
import pytest

from rodsweep.bench.limit_cycle.swept_rods import TWO_SEGMENT_PROFILE
from rodsweep.model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.results.run.checkpoints import Checkpoints
from rodsweep.solve.cycle.accuracy.finer_meshes import measured_mesh_error_calibration
from rodsweep.solve.cycle.cycle_of_neighbouring_rod import CycleStart
from rodsweep.solve.cycle.cycles_along_parameter import CYCLE_PREDICTION_SETTINGS, CyclePredictor
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.newton import relative_change, solve_by_newton

ROD = Rod(F=34.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
HOPF = 27.4271941267593
TWO_SEGMENTS = RodMaterial(profile=TWO_SEGMENT_PROFILE)
REQUEST = CycleRequest(1e-7, 0.1, 1, 0, 0, 0, 100)
STEP = 0.99


@pytest.fixture(scope="module")
def chain():
    """What the points of a chain hand on, down towards the Hopf point."""
    handed, F = [None], ROD.F
    while F > 1.09 * HOPF:
        cycle = solve_cycle(replace(ROD, F=F), REQUEST, handed[-1], "F")
        assert cycle.status == CycleStatus.cycle
        handed.append(cycle.start_for_next_rod)
        F *= STEP
    return handed[1:]


@pytest.mark.parametrize(
    "places, orders",
    [
        ([0.0], [1]),
        ([0.0, -0.3], [1, 1]),
        ([0.0, -0.3, -0.3], [1, 0, 1]),
        ([0.0, 20.0, 35.0, 20.0], [1, 0, 0, 1]),
        ([0.0, -1e-3, -2.5e-3, -3e-3, -5e-3], [1, 0, 0, 0, 0]),
    ],
)
def test_polynomials_with_as_many_terms_are_predicted_exactly(places, orders):
    places, orders = np.array(places), np.array(orders, dtype=float)
    size = np.abs(places).max() or 1.0
    p = np.polynomial.Polynomial(np.random.default_rng(2).normal(size=len(places) + 1), [0, size], [0, 1])
    here = CyclePredictor(None, places, orders, np.empty(0))
    data = np.where(orders == 1, p.deriv()(places), p(places) - p(0))
    for step in (size, -0.4 * size):
        assert here.prediction_weights(step) @ data == pytest.approx(p(step) - p(0), rel=1e-10, abs=1e-10)


def test_a_chain_goes_on_by_the_cycles_behind(chain):
    last = chain[-1].predictor
    assert np.count_nonzero(last.derivative_orders == 0) == CYCLE_PREDICTION_SETTINGS.max_earlier_orbits
    assert last.parameter_offsets[0] == 0 and np.all(last.parameter_offsets[1:] > 0)  # it went downwards


def test_a_chain_goes_on_from_a_checkpoint_with_the_same_bits(chain, tmp_path):
    """The next cycle and all that its own neighbour starts from; fewer than all cycles behind, too."""
    kept = Checkpoints(tmp_path, "print", CycleStart.from_arrays)
    for place in (0, 1, -1):
        kept.write(0, 0, chain[place])
        _, again = kept.read(0)
        rod = replace(ROD, F=STEP * chain[place].predictor.orbit.form.rod.F)
        there, other = (solve_cycle(rod, REQUEST, start, "F") for start in (chain[place], again))
        assert there.status == CycleStatus.cycle
        arrays, others = there.start_for_next_rod.arrays(), other.start_for_next_rod.arrays()
        assert {name: (a.shape, a.tobytes()) for name, a in arrays.items()} == {
            name: (a.shape, a.tobytes()) for name, a in others.items()
        }


def test_next_to_a_hopf_point_cycles_are_predicted_though_they_go_as_a_root(chain):
    """The amplitude's slope is infinite at the Hopf point; in the square of the size it is smooth there."""
    last = chain[-1].predictor
    form = last.orbit.form
    for F, most in ((STEP * form.rod.F, 3e-7), (1.05 * HOPF, 1e-4), (1.01 * HOPF, 1e-2)):
        predicted = last.predicted_orbit(replace(form, rod=replace(form.rod, F=F)), "F")
        found = solve_by_newton(predicted, 1e-10, NewtonWorkspace()).orbit
        assert found.max_energy_norm < last.orbit.max_energy_norm
        assert relative_change(predicted, found.values - predicted.values) < most


@pytest.mark.parametrize(("material", "is_kept"), [(TWO_SEGMENTS, True), (DEFAULT_MATERIAL, False)])
def test_errors_in_space_of_several_elements_are_kept_where_errors_in_time_are_measured_again(
    material, is_kept
):
    rod, memory = (
        Rod(F=18.0 if is_kept else 40.0, k1=1e4, k2=1e2, gamma3=1e-2, material=material),
        NewtonWorkspace(),
    )
    handed = None
    for _ in range(2):
        handed = solve_cycle(rod, REQUEST, handed, "F", memory).start_for_next_rod
        rod = replace(rod, F=STEP * rod.F)
    calibration = handed.calibration
    orbit = handed.predictor.orbit
    grown = replace(
        calibration.with_errors_scaled_on_chain(orbit, 0.05, calibration.error_indicators),
        parameter_change_since_measurement=0.05,
        error_growth_since_measurement=np.array([1.1, 1.2]),
    )
    measured = measured_mesh_error_calibration(solve_by_newton(orbit, 1e-11, memory), REQUEST.accuracy, grown)
    assert not grown.is_measured_at_orbit
    assert measured.is_measured_at_orbit
    assert measured.parameter_change_since_measurement == (0.05 if is_kept else 0.0)
    assert measured.mesh_errors[1] == pytest.approx(calibration.mesh_errors[1], rel=0.3)
    expected = calibration.mesh_errors[0] * ([1.1, 1.1, 1.2, 1.2, 1.2] if is_kept else 1.0)
    assert measured.mesh_errors[0] == pytest.approx(expected, rel=1e-12 if is_kept else 0.3)
