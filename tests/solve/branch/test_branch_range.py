"""A branch that leaves the range of its parameter before a fold ends there, though a step reaches over it."""

import pytest

from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branch_request import BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.special.special_point import EndReason, SpecialKind
from rodsweep.solve.branch.status import BranchStatus

FOLDED = Rod(F=0.0, k1=175.0, k2=1e4, gamma3=1e-4)


def branches_to(stop, rod=FOLDED):
    return solve_branches(rod, BranchRequest("F", 0.0, stop, 1e-4, False, 500, 50))


@pytest.fixture(scope="module")
def fold():
    (curve,) = branches_to(150.0).curves
    (found,) = (one for one in curve.special_points if one.kind == SpecialKind.fold)
    return found


@pytest.mark.parametrize("share", [1e-3, 1e-4])
def test_branch_ends_before_a_fold_beyond_the_range(fold, share):
    stop = fold.at * (1 - share)
    found = branches_to(stop)
    assert found.status == BranchStatus.ok
    first = found.curves[0]
    assert [one.kind.name for one in first.special_points] == ["hopf", "end"]
    assert first.special_points[-1].reason == EndReason.range_end
    assert first.special_points[-1].at == pytest.approx(stop, rel=1e-9)
    assert max(point.at for point in first.points) <= stop * (1 + 1e-9)


def test_branch_passes_a_fold_within_the_range(fold):
    (curve, *_) = branches_to(fold.at * (1 + 1e-4)).curves
    (same,) = (one for one in curve.special_points if one.kind == SpecialKind.fold)
    assert same.at == pytest.approx(fold.at, abs=fold.error + same.error)
