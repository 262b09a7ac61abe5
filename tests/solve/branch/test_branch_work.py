"""Work on branches: its limit ends a branch and says so, and special points are located on fitting meshes."""

import numpy as np
import pytest
from surveyed import survey_only

from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branch_errors import BranchErrorCalibration
from rodsweep.solve.branch.branch_limits import MULTIPLICATIONS_PER_WORK_UNIT, BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.multiplier_sensitivity import MultiplierErrorAmplification
from rodsweep.solve.branch.special import locating
from rodsweep.solve.branch.special.augmented.fold_and_torus_test_functions import correct_until_converged
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.special.special_point_errors import first_mesh_for_special_point
from rodsweep.solve.branch.status import BranchEndReason, BranchStatus
from rodsweep.solve.cycle.accuracy.calibration import ERROR_COUNT, MeshErrorCalibration
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.orbit_mesh import OrbitMesh
from rodsweep.solve.unsolvable import Unsolvable

ROD = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-3)
TORUS = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2)
"""Its branch passes a torus point at F = 205.36."""


def branches_of(rod, stop, work=None, accuracy=1e-5):
    return solve_branches(rod, BranchRequest("F", 0.0, stop, accuracy, False, 500, 50, work))


def test_branch_ends_where_its_work_is_used_up():
    whole = branches_of(ROD, 60.0)
    part = branches_of(ROD, 60.0, work=0.2)
    assert (whole.status, part.status) == (BranchStatus.ok, BranchStatus.stopped)
    (curve,) = part.curves
    assert curve.special_points[-1].end_reason == BranchEndReason.list_full
    assert "`work`" in part.message
    known = [point.parameter_value for point in whole.curves[0].stored_cycles]
    assert 1 <= len(curve.stored_cycles) < len(known)
    assert [point.parameter_value for point in curve.stored_cycles] == pytest.approx(
        known[: len(curve.stored_cycles)], rel=1e-5
    )


def test_rod_after_a_limited_rod_has_its_own_work():
    workspace = NewtonWorkspace()
    request = BranchRequest("F", 0.0, 60.0, 1e-5, False, 500, 50, 0.2)
    first, second = (solve_branches(ROD, request, workspace) for _ in range(2))
    assert len(first.curves[0].stored_cycles) == len(second.curves[0].stored_cycles) > 0


def test_branch_without_work_for_its_first_cycle_says_so():
    (curve,) = branches_of(ROD, 60.0, work=1e-6).curves
    assert not curve.stored_cycles
    assert curve.special_points[-1].end_reason == BranchEndReason.list_full


@pytest.mark.long
def test_special_point_has_its_error_on_the_meshes_that_the_work_allows(monkeypatch):
    solved = []
    of_mesh = locating._zero_by_secants

    def limited(kind, segment, guess, slope):
        if len(solved) == 2:
            segment.start.workspace.limit_work(1.0)
        solved.append(segment.mesh)
        try:
            return of_mesh(kind, segment, guess, slope)
        finally:
            segment.start.workspace.limit_work(np.inf)

    # From cycles of this accuracy the torus point is located on more than three meshes.
    exact = torus_of(branches_of(TORUS, 207.0, accuracy=1e-4))
    monkeypatch.setattr(locating, "_zero_by_secants", limited)
    rough = torus_of(branches_of(TORUS, 207.0, accuracy=1e-4))
    assert len(solved) == 3
    assert not rough.message
    assert exact.error < 1e-9 * exact.parameter_value < rough.error < 1e-4 * exact.parameter_value
    assert abs(rough.parameter_value - exact.parameter_value) <= rough.error + exact.error


def torus_of(found):
    (torus,) = (one for one in found.curves[0].special_points if one.kind == SpecialPointKind.torus)
    return torus


def test_further_stages_replace_time_intervals_on_the_first_mesh_of_a_special_point():
    """The errors of a cone of taper 0.19: with four stages 114 intervals are needed, with five about 50."""
    known = MeshErrorCalibration(
        OrbitMesh((0.0, 0.5, 1.0), 20, 38, 4),
        np.full((2, ERROR_COUNT), 1e-8),
        np.full(ERROR_COUNT, 1.0),
        np.full(ERROR_COUNT, 6.0),
        np.array([1e-4, 1e-4, 1.0]),
        0.0,
    )
    branch = BranchErrorCalibration(known, np.full(2, 1e-8), 1.0, 1.0, MultiplierErrorAmplification(1.0, 1.0))
    mesh = first_mesh_for_special_point(branch, 1e-9)
    assert mesh.stage_count == 5
    assert mesh.interval_count < 2 * known.mesh.interval_count
    assert branch.cheapest_mesh_at_equal_deflection(2e-10).interval_count > 2 * known.mesh.interval_count


def test_unit_of_work_is_the_documented_number_of_multiplications():
    assert (
        BranchRequest("F", 0.0, 1.0, 1e-5, False, 1, 1, 2.0).max_multiplications
        == 2 * MULTIPLICATIONS_PER_WORK_UNIT
        == 2e9
    )


@survey_only
def test_torus_point_of_a_narrow_cone_needs_no_mesh_of_gigabytes(monkeypatch):
    meshes = []
    of_mesh = locating._zero_by_secants

    def recorded(kind, segment, guess, slope):
        meshes.append(segment.mesh)
        return of_mesh(kind, segment, guess, slope)

    monkeypatch.setattr(locating, "_zero_by_secants", recorded)
    cone = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.19)
    found = solve_branches(cone, BranchRequest("F", 0.0, 15.0, 1e-7, False, 500, 50))
    torus = torus_of(found)
    assert found.status == BranchStatus.ok
    assert torus.parameter_value == pytest.approx(14.5390404204, abs=torus.error + 1e-9)
    assert torus.error < 1e-9 * torus.parameter_value
    assert max(mesh.interval_count for mesh in meshes) < 80, "114 in the first mesh, 137 in the second before"


class ListedValues:
    """A test function whose corrections give listed values."""

    def __init__(self, *values):
        self.values = iter(values)
        self.now = next(self.values)

    def value(self, _):
        return self.now

    def correct_null_vectors(self, _):
        self.now = next(self.values)


def test_a_first_value_that_is_close_by_chance_does_not_end_the_corrections():
    """Values at the torus point F = 112.34 of k1 = 9641.3, k2 = 28.017, gamma3 = 1.0516e-5, gamma1 = 0.6202:
    the first belongs to the cycle of the matrix."""
    near = ListedValues(-1.4604773e-8, 3.569858293e-7, -2.075050853e-8, -2.074154948e-8)
    correct_until_converged(near, None)
    assert near.now == -2.074154948e-8
    with pytest.raises(Unsolvable, match="does not converge"):
        correct_until_converged(ListedValues(0.0, 1e-3, -1e-3, 2e-3, -4e-3), None)
