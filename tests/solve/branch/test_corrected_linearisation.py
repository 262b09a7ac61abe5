"""Tangent and multipliers corrected with the matrix of a nearby orbit; number of matrices of a branch."""

from dataclasses import replace

import numpy as np
import pytest

from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.arc_length_step import next_cycle
from rodsweep.solve.branch.bordered.border_condition import moved_orbit
from rodsweep.solve.branch.bordered.corrected_linearisation import corrected_linearisation
from rodsweep.solve.branch.bordered.matrix import BorderedMatrix
from rodsweep.solve.branch.branch_limits import BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.start.first_cycle import first_cycle
from rodsweep.solve.branch.start.hopf_point import hopf_branch_start
from rodsweep.solve.branch.status import BranchStatus
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace

ACCURACY = 1e-7
ROD = Rod(F=0.0, k1=150.0, k2=1e4, gamma3=1e-4)
"""Its branch goes through torus points and a fold; the corrections of its multipliers converge slowly."""


class CountedWorkspace(NewtonWorkspace):
    """Memory that counts its matrices."""

    def __init__(self):
        super().__init__()
        self.matrices = 0

    def count_matrix_work_within_limit(self, work):
        self.matrices += 1
        super().count_matrix_work_within_limit(work)


@pytest.fixture(scope="module")
def cycle():
    """A large cycle of the branch from the first Hopf point."""
    crossing = find_imaginary_axis_crossings(ParameterPath(ROD, "F"), 0.0, 80.0).thresholds[0]
    point = first_cycle(hopf_branch_start(ParameterPath(ROD, "F"), crossing), ACCURACY, NewtonWorkspace())
    for _ in range(7):
        point = next_cycle(point, ACCURACY)
    return point


def moved(cycle, distance):
    """The orbit of a cycle, moved along the branch by an arc length."""
    return moved_orbit(cycle.orbit, "F", distance * cycle.tangent)


def sorted_by_modulus(values, count):
    return values[np.argsort(-np.abs(values))][:count]


@pytest.mark.parametrize("distance", [1e-5, 1e-4, 1e-3])
def test_corrected_multipliers_and_tangent_are_those_of_a_matrix_at_the_cycle(cycle, distance):
    exact = BorderedMatrix(cycle.orbit, cycle.scale, NewtonWorkspace())
    nearby = BorderedMatrix(moved(cycle, distance), cycle.scale, NewtonWorkspace())
    corrected = corrected_linearisation(nearby, cycle.orbit, cycle.unit_tangent, 1e-8)
    assert corrected is not None and corrected.relative_error <= 1e-8
    there = sorted_by_modulus(exact.multipliers_over_solved_time_interval, 3)
    error = np.abs(corrected.multipliers_over_solved_time_interval[:, None] - there).min(axis=0).max()
    uncorrected = np.abs(nearby.multipliers_over_solved_time_interval[:, None] - there).min(axis=0).max()
    assert error <= 10 * 1e-8 < uncorrected
    tangents = [one.branch_tangent(cycle.unit_tangent) for one in (exact, corrected)]
    parts = [cycle.scale.directional_derivative(cycle.orbit, tangent) for tangent in tangents]
    assert parts[1] == pytest.approx(parts[0], abs=1e-5)


def test_multipliers_far_from_the_matrix_are_not_corrected(cycle):
    nearby = BorderedMatrix(moved(cycle, 0.2), cycle.scale, NewtonWorkspace())
    assert corrected_linearisation(nearby, cycle.orbit, cycle.unit_tangent, 1e-8) is None


def test_multipliers_near_the_circle_are_not_corrected_beside_multipliers_of_a_million():
    """A cycle at the third Hopf point: two multipliers are 1.0 and 0.97, the largest have moduli of 1e6. With
    the BLAS kernel Haswell the corrected multiplier 0.97 had an error of 6e-5, to a tolerance of 1e-6."""
    path = ParameterPath(Rod(F=0.0, k1=1e4, k2=20.0, gamma3=1e-3), "F")
    crossing = find_imaginary_axis_crossings(path, 0.0, 100.0).thresholds[2]
    cycle = first_cycle(hopf_branch_start(path, crossing), ACCURACY, NewtonWorkspace())
    there = BorderedMatrix(cycle.orbit, cycle.scale, NewtonWorkspace()).multipliers_over_solved_time_interval
    assert np.abs(there).max() > 1e5
    workspace = NewtonWorkspace()
    for distance in (1e-5, 1e-4, 1e-3):
        nearby = BorderedMatrix(moved(cycle, distance), cycle.scale, workspace)
        # A matrix at the cycle then gives the multipliers.
        assert corrected_linearisation(nearby, cycle.orbit, cycle.unit_tangent, 1e-6) is None


def test_corrected_linearisation_needs_the_factors_of_its_matrix(cycle):
    workspace = NewtonWorkspace()
    nearby = BorderedMatrix(moved(cycle, 1e-4), cycle.scale, workspace)
    BorderedMatrix(cycle.orbit, cycle.scale, workspace)
    with pytest.raises(RuntimeError, match="overwritten"):
        corrected_linearisation(nearby, cycle.orbit, cycle.unit_tangent, 1e-8)


def test_next_cycle_has_the_mesh_that_was_chosen_ahead(cycle):
    finer = replace(cycle.calibration.mesh, order=cycle.calibration.mesh.order + 2)
    ahead, same = (next_cycle(replace(cycle, next_mesh=mesh), ACCURACY) for mesh in (finer, None))
    assert ahead.orbit.form.mesh == finer.space_mesh != same.orbit.form.mesh
    assert ahead.orbit.period == pytest.approx(same.orbit.period, rel=1e-6)


def test_branch_takes_about_two_matrices_for_a_cycle():
    """One for the cycle, two for the errors of every third cycle, and some for other meshes."""
    workspace = CountedWorkspace()
    rod = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2)
    branches = solve_branches(rod, BranchRequest("F", 1.0, 60.0, ACCURACY, True, 100, 10), workspace)
    assert branches.status == BranchStatus.ok
    cycles = sum(len(curve.stored_cycles) for curve in branches.curves)
    assert workspace.matrices <= 2.2 * cycles
