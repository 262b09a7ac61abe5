"""A cycle on a fine mesh as three coarser ones predict it."""

from dataclasses import replace

import numpy as np
import pytest

from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle.accuracy.coarser_meshes import CoarserMeshes
from rodsweep.solve.cycle.accuracy.refinement import refined_cycle_of_any_period
from rodsweep.solve.cycle.accuracy.settings import MESH_ERROR_CALIBRATION_SETTINGS
from rodsweep.solve.cycle.hopf_start import hopf_point_below_force, orbit_from_hopf
from rodsweep.solve.cycle.transient.motion_mesh import coarse_mesh_for_branch_to_cycle
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion
from rodsweep.solve.orbit.newton import relative_change, solve_by_newton
from rodsweep.solve.orbit.orbit_mesh import OrbitMesh, mesh_of_orbit
from rodsweep.solve.orbit.tip_path_differences import PATH_INDEX, PERIOD_INDEX, Y_INDEX, tip_path_differences
from rodsweep.solve.unsolvable import Unsolvable

ACCURACY = 1e-7
FINE = OrbitMesh((0.0, 1.0), 19, 16, 4)
MEMORY = NewtonWorkspace()
RODS = {
    "soft": (Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2), 1.0),
    "half the axial drag": (Rod(F=30.0, k1=1e4, k2=1e2, gamma3=1e-2), 0.5),
    "filament": (Rod(F=60.0, k1=float("inf"), k2=float("inf"), gamma3=0.0), 1.0),
}


@pytest.fixture(scope="module", params=RODS.values(), ids=RODS.keys())
def near(request):
    """An orbit near the rod's cycle."""
    rod, gamma1 = request.param
    return orbit_from_hopf(
        StressForm(rod.with_values(gamma1=gamma1), uniform_mesh(1, 16)), hopf_point_below_force(rod), MEMORY
    )


def off(orbit, exact):
    return relative_change(exact, orbit.values - exact.values)


def test_it_is_nearer_to_the_orbit_than_two_meshes_in_between_are(near):
    coarser = CoarserMeshes(FINE, near, 1e-6 * ACCURACY, MEMORY)
    orbit, _ = coarser.fine_mesh_prediction_and_errors(FINE)
    exact = solve_by_newton(orbit, 1e-13, MEMORY).orbit
    between = [
        replace(coarser.coarse_mesh, order=FINE.order),
        replace(coarser.coarse_mesh, interval_count=FINE.interval_count),
    ]
    errors = [
        off(FINE.interpolated_orbit(solve_by_newton(m.interpolated_orbit(exact), 1e-13, MEMORY).orbit), exact)
        for m in between
    ]
    assert off(orbit, exact) < 0.1 * min(errors)


def test_finer_meshes_differ_by_no_more_than_is_stated(near):
    orbit, known = CoarserMeshes(FINE, near, ACCURACY, MEMORY).fine_mesh_prediction_and_errors(FINE)
    found = solve_by_newton(orbit, 1e-12, MEMORY).orbit
    for field, parts in zip(("order", "interval_count"), known.mesh_errors, strict=True):
        finer = replace(FINE, **{field: 2 * getattr(FINE, field)})
        true = tip_path_differences(
            CycleMotion(found),
            CycleMotion(solve_by_newton(finer.interpolated_orbit(found), 1e-12, MEMORY).orbit),
        )
        for which in (PERIOD_INDEX, Y_INDEX, PATH_INDEX):
            assert true[which] <= MESH_ERROR_CALIBRATION_SETTINGS.error_safety_factor * parts[which] + 1e-12


def test_coarser_meshes_predict_those_that_are_a_little_finer(near):
    coarser = CoarserMeshes(FINE, near, ACCURACY, MEMORY)
    assert coarser.can_predict(FINE) and coarser.can_predict(
        replace(FINE, order=FINE.order + 2, interval_count=20)
    )
    for other in (
        {"order": FINE.order + 3},
        {"interval_count": 30},
        {"element_edges": (0.0, 0.5, 1.0)},
        {"stage_count": 5},
    ):
        assert not coarser.can_predict(replace(FINE, **other))


@pytest.mark.parametrize("why", ["no coarse cycle", "far off"])
def test_what_coarser_meshes_do_not_predict_is_measured_by_finer_ones(near, why, monkeypatch):
    predicted = CoarserMeshes.fine_mesh_prediction_and_errors

    def spoilt(self, mesh):
        orbit, known = predicted(self, mesh)
        if why == "far off":
            return replace(orbit, values=orbit.values * (1 + 1e-4)), known
        raise Unsolvable(why)

    monkeypatch.setattr(CoarserMeshes, "fine_mesh_prediction_and_errors", spoilt)
    alone, first = (
        refined_cycle_of_any_period(near, ACCURACY, MEMORY),
        refined_cycle_of_any_period(near, ACCURACY, MEMORY, "F"),
    )
    assert np.array_equal(alone.orbit.values, first.orbit.values)
    assert alone.errors == first.errors


def test_a_cycle_alone_and_one_that_starts_a_chain_are_the_same(near):
    alone, first = (
        refined_cycle_of_any_period(near, ACCURACY, MEMORY),
        refined_cycle_of_any_period(near, ACCURACY, MEMORY, "F"),
    )
    assert alone.orbit.period == pytest.approx(first.orbit.period, rel=2 * ACCURACY)
    assert alone.converged_orbit.matrix.tangent is None and first.converged_orbit.matrix.tangent is not None
    apart = alone.errors.multiplier_error + first.errors.multiplier_error
    assert abs(alone.largest_multiplier_modulus - first.largest_multiplier_modulus) <= apart
    assert (
        alone.errors.largest_weighted_error <= ACCURACY
        and alone.converged_orbit.distance_from_matrix_orbit <= ACCURACY
    )


def test_the_period_of_neighbouring_orders_that_agree_by_luck_is_not_believed():
    """Orders 19 and 21 have nearly the same period of this cone, which is off by 1.9 times the accuracy."""
    accuracy = 1e-4
    rod = Rod(F=40.20452, k1=float("inf"), k2=149.6991, gamma3=0.0, gamma1=0.2582922, taper=0.5194033)
    start = orbit_from_hopf(
        StressForm(rod, coarse_mesh_for_branch_to_cycle(rod)), hopf_point_below_force(rod), MEMORY
    )
    found = refined_cycle_of_any_period(start, accuracy, MEMORY)
    own = mesh_of_orbit(found.orbit)
    finer = replace(own, order=own.order + 8, interval_count=2 * own.interval_count)
    exact = solve_by_newton(finer.interpolated_orbit(found.orbit), 1e-10, MEMORY).orbit
    assert abs(found.measures.period / exact.period - 1) <= found.errors.period_error <= accuracy
