"""Graded time intervals: the map, its fit to an orbit, and all that is measured on a graded mesh."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from rodsweep.bench.limit_cycle.tracking import cycle_request, orbit_of
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.symmetry_breaking import extended_to_whole_period
from rodsweep.solve.cycle.accuracy.minimal_period import restricted_to_minimal_period
from rodsweep.solve.cycle.limit_cycle import solve_cycle
from rodsweep.solve.orbit.coefficient_tails import time_tails_of_intervals
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion
from rodsweep.solve.orbit.mesh_choice import (
    coarser_regraded_mesh,
    grading_and_interval_count_ratio,
    mesh_from_coefficient_tails,
)
from rodsweep.solve.orbit.newton import relative_change, solve_by_newton
from rodsweep.solve.orbit.orbit import node_time_fractions, time_interval_lengths
from rodsweep.solve.orbit.orbit_mesh import ORBIT_MESH_SETTINGS, OrbitMesh, mesh_of_orbit
from rodsweep.solve.orbit.stored_orbit import orbit_arrays, orbit_from_arrays
from rodsweep.solve.orbit.time_grading import UNIFORM_TIME_GRADING, TimeGrading
from rodsweep.solve.orbit.tip_path_differences import EXTREMUM_INDEX, PATH_INDEX, tip_path_differences

GRADING = TimeGrading(-0.3, -0.1)


@cache
def orbit_with(intervals: int, grading: TimeGrading):
    rod = Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
    start = orbit_of(solve_cycle(rod, cycle_request(1e-7), None, "F"))
    mesh = replace(mesh_of_orbit(start), interval_count=intervals, grading=grading)
    return solve_by_newton(mesh.interpolated_orbit(start), 1e-11, NewtonWorkspace()).orbit


@pytest.mark.parametrize("grading", [GRADING, TimeGrading(0.4, -0.4, 2), UNIFORM_TIME_GRADING])
def test_mesh_times_invert_times(grading):
    times = np.linspace(0, 1, 37)
    mesh_times = grading.mesh_times(times)
    assert grading.times(mesh_times) == pytest.approx(times, abs=1e-15)
    assert (mesh_times[0], mesh_times[-1]) == pytest.approx((0, 1), abs=1e-15)
    differences = (grading.times(mesh_times + 1e-6) - grading.times(mesh_times - 1e-6)) / 2e-6
    assert differences == pytest.approx(grading.time_slopes(mesh_times), abs=1e-9)
    lengths = time_interval_lengths(9, grading)
    assert lengths.sum() == pytest.approx(1, abs=1e-15)
    assert lengths.min() > 0


def test_doubled_grading_repeats_in_each_half():
    halves = np.append(GRADING.times(np.arange(5) / 5) / 2, (1 + GRADING.times(np.arange(5) / 5)) / 2)
    assert GRADING.over_two_solved_parts.times(np.arange(10) / 10) == pytest.approx(halves, abs=1e-15)


def test_graded_and_uniform_orbits_agree_in_all_measures():
    uniform, graded = (CycleMotion(orbit_with(40, grading)) for grading in (UNIFORM_TIME_GRADING, GRADING))
    # Between the nodes the uniform path has an error of 8e-9.
    assert tip_path_differences(graded, uniform)[:PATH_INDEX].max() < 1e-9
    assert tip_path_differences(graded, uniform)[PATH_INDEX] < 2e-8
    a, b = graded.measures, uniform.measures
    count = min(len(a.harmonic_amplitude), len(b.harmonic_amplitude))
    assert a.harmonic_amplitude[:count] == pytest.approx(b.harmonic_amplitude[:count], abs=1e-9)
    assert a.injection_mean == pytest.approx(b.injection_mean, rel=1e-9)
    assert graded.tip_y_mean_crossing_time == pytest.approx(uniform.tip_y_mean_crossing_time, abs=1e-9)
    energies = (
        graded.energy_and_powers_from_mean_crossing(30),
        uniform.energy_and_powers_from_mean_crossing(30),
    )
    assert energies[0] == pytest.approx(energies[1], rel=1e-6)
    shapes = graded.shapes_from_mean_crossing(12, 9), uniform.shapes_from_mean_crossing(12, 9)
    assert shapes[0] == pytest.approx(shapes[1], abs=1e-8)
    harmonics = graded.curvature_harmonic_sizes, uniform.curvature_harmonic_sizes
    assert harmonics[0][:count] == pytest.approx(harmonics[1][:count], abs=1e-6 * harmonics[1].max())


def test_a_graded_mesh_has_a_smaller_error_with_as_many_intervals():
    exact = CycleMotion(orbit_with(40, UNIFORM_TIME_GRADING))
    errors = [
        tip_path_differences(CycleMotion(orbit_with(11, g)), exact) for g in (UNIFORM_TIME_GRADING, GRADING)
    ]
    assert errors[1][PATH_INDEX] < errors[0][PATH_INDEX] / 2
    assert errors[1][0] < errors[0][0] / 2
    assert errors[1][EXTREMUM_INDEX] < 1e-5


def test_the_fitted_grading_makes_tails_equal_and_needs_fewer_intervals():
    uniform = orbit_with(14, UNIFORM_TIME_GRADING)
    tail = float(time_tails_of_intervals(uniform).max())
    grading, ratio = grading_and_interval_count_ratio(uniform, tail, uniform.stage_count)
    assert ratio < 0.85
    tails = [time_tails_of_intervals(orbit)[:-2] for orbit in (uniform, orbit_with(14, grading))]
    assert tails[1].max() < 0.6 * tails[0].max()
    assert tails[1].min() > tails[0].min()
    mesh = coarser_regraded_mesh(mesh_of_orbit(uniform), uniform)
    assert mesh.grading == grading
    assert 14 > mesh.interval_count >= ratio * 13
    # The number of intervals for a tail is the same from an orbit that has this grading already.
    again = orbit_with(14, grading)
    assert coarser_regraded_mesh(mesh_of_orbit(again), again) == mesh_of_orbit(again)
    counts = [mesh_from_coefficient_tails(orbit, 1e-7, 4).interval_count for orbit in (uniform, again)]
    assert abs(counts[0] - counts[1]) <= 1


def test_a_mesh_with_the_present_grading_keeps_its_intervals():
    graded = orbit_with(14, GRADING)
    ratio = grading_and_interval_count_ratio(graded, float(time_tails_of_intervals(graded).max()), 4)[1]
    assert ORBIT_MESH_SETTINGS.max_regraded_interval_count_ratio < ratio < 1.01


def test_a_graded_orbit_over_the_whole_period_is_a_solution():
    half = orbit_with(20, GRADING)
    whole = extended_to_whole_period(half)
    assert whole.grading == GRADING.over_two_solved_parts
    solved = solve_by_newton(whole, 1e-10, NewtonWorkspace()).orbit
    # The extended orbit is interpolated between stages.
    assert relative_change(whole, solved.values - whole.values) < 1e-5
    differences = tip_path_differences(CycleMotion(solved), CycleMotion(half))
    assert differences[:EXTREMUM_INDEX].max() < 1e-10
    # The time nodes of both meshes differ; between them the paths have errors of 1e-7.
    assert differences[PATH_INDEX] < 3e-7


def test_three_graded_periods_are_cut_to_one():
    half = orbit_with(40, GRADING)
    thrice = half.on_mesh(half.form.mesh, 118, 4)
    at = 3 * node_time_fractions(118, 4, GRADING)
    number = np.minimum(np.floor(at + 1e-12), 2)
    states = half.states_at_time_fractions(np.clip(at - number, 0, 1))
    odd = number == 1
    states[odd] = half.symmetry.apply(states[odd], half.form.layout)
    thrice = replace(thrice, values=np.append(states, 3 * half.period))
    once = restricted_to_minimal_period(thrice)
    assert once.grading == UNIFORM_TIME_GRADING
    assert once.period == pytest.approx(half.period)
    assert tip_path_differences(CycleMotion(once), CycleMotion(half)).max() < 1e-5


def test_meshes_and_stored_orbits_keep_their_grading():
    mesh = OrbitMesh((0.0, 0.25, 1.0), 17, 9, 3, (0.5, 1.0), GRADING)
    assert OrbitMesh.from_array(mesh.as_array) == mesh
    orbit = orbit_with(14, GRADING)
    stored = orbit_from_arrays(orbit_arrays(orbit))
    assert mesh_of_orbit(stored) == mesh_of_orbit(orbit)
    assert stored.orbit_equations.time_interval_lengths == pytest.approx(time_interval_lengths(14, GRADING))
