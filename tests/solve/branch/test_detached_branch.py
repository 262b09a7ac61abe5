"""Branches that no Hopf point of their rod leads to: closed ones, and ones that leave the range.

The rod k2 = 1e4, gamma3 = 0.006 has Hopf points at k1 > 133.068. Its curve of folds has its smallest k1 at
133.0145, so that at k1 = 133.03 the cycles form a closed branch in F.
"""

from dataclasses import replace

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.determinant.parameter_plane import PlaneAxis
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.coexistence import existence_of_stable_cycle, row_branches, special_points_of
from rodsweep.solve.branch.special.row_crossing import crossings_from_arrays, numbered_arrays
from rodsweep.solve.branch.special.special_curve_tracer import SpecialCurveTracer
from rodsweep.solve.branch.special.special_curves import CurveEndReason, TracedHalfCurve
from rodsweep.solve.branch.special.special_point import RowSpecialPoint, SpecialPointKind
from rodsweep.solve.branch.status import BranchEndReason, BranchStatus
from rodsweep.solve.changes.diagram.rows import RowRequest
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace

BESIDE = Rod(F=60.0, k1=133.072, k2=1e4, gamma3=0.006)
ROD = replace(BESIDE, k1=133.03)
FIRST, LAST = 76.4534854361, 81.7039922768
"""The folds of the closed branch, by the curve of folds traced from k1 = 133.072."""


def request(*values):
    return RowRequest("F", np.array(values, dtype=float), 1e-10, True, 16, max_special_points=64)


@pytest.fixture(scope="module")
def beside():
    """Special points of the branch between the two Hopf points at k1 = 133.072."""
    return special_points_of(row_branches(BESIDE, request(60, 86)))


@pytest.fixture(scope="module")
def half(beside):
    """The half curve of folds from k1 = 133.072 to smaller k1, across the row k1 = 133.03."""
    fold = max(
        (point for point in beside if point.kind == SpecialPointKind.fold),
        key=lambda point: point.parameter_value,
    )
    stored = RowSpecialPoint(
        row_index=1,
        row_parameter_value=BESIDE.k1,
        kind=fold.kind,
        parameter_value=fold.parameter_value,
        period=fold.period,
        tip_y_max=fold.tip_y_max,
    )
    axes = PlaneAxis("F", 60.0, 86.0), PlaneAxis("k1", 133.0, 133.2)
    tracer = SpecialCurveTracer(*axes, [stored], {0: ROD.k1, 1: BESIDE.k1})
    return TracedHalfCurve.from_arrays(tracer.solve(1, lambda row: beside, NewtonWorkspace()))


@pytest.fixture(scope="module")
def starts(half):
    """The crossings of the curve with the row k1 = 133.03."""
    return [crossing.special_point for crossing in half.crossings if crossing.row_index == 0]


@pytest.fixture(scope="module")
def closed(starts):
    """All branches at k1 = 133.03."""
    return row_branches(ROD, request(60, 86), starts=starts)


@pytest.mark.long
def test_a_curve_of_folds_crosses_a_row_without_hopf_points_twice(half, starts):
    assert half.half_curve.end_reason is CurveEndReason.hopf
    assert sorted(start.parameter_value for start in starts) == pytest.approx([FIRST, LAST], abs=1e-5)
    # On its own row the curve passes the two folds of the branch between the Hopf points; one is known.
    assert [crossing.row_index for crossing in half.crossings] == [0, 0, 1]
    assert half.distances_along_row == {0: pytest.approx(0, abs=1e-6)}


@pytest.mark.long
def test_a_crossing_survives_a_checkpoint(half):
    arrays = numbered_arrays(half.crossings)
    found = crossings_from_arrays(arrays | {"points": np.zeros((3, 6))})
    assert found == half.crossings
    for one, other in zip(found, half.crossings, strict=True):
        before, after = one.special_point.orbit, other.special_point.orbit
        assert np.array_equal(before.values, after.values)
        assert before.form.rod == after.form.rod
        assert before.is_symmetric == after.is_symmetric


@pytest.mark.long
def test_a_closed_branch_is_followed_once_around_from_either_fold(closed, starts):
    assert (closed.status, closed.message, closed.crossings) == (BranchStatus.ok, "", ())
    (curve,) = closed.curves
    assert curve.is_closed
    assert curve.is_complete
    assert [point.kind for point in curve.special_points] == [SpecialPointKind.fold] * 3
    assert curve.special_points[0].parameter_value == pytest.approx(
        curve.special_points[2].parameter_value, rel=2e-9
    )
    folds = special_points_of(closed)
    assert sorted(point.parameter_value for point in folds) == pytest.approx([FIRST, LAST], abs=1e-8)
    assert all(point.error <= 1e-9 * point.parameter_value for point in folds)
    low = min(starts, key=lambda start: start.parameter_value)
    other = special_points_of(row_branches(ROD, request(60, 86), starts=[low]))
    assert sorted(point.parameter_value for point in other) == pytest.approx([FIRST, LAST], abs=1e-8)


@pytest.mark.long
def test_cycles_of_a_closed_branch_are_stable_on_one_side_of_both_folds(closed):
    values = np.array([FIRST - 1e-6, FIRST + 1e-6, 79, LAST - 1e-6, LAST + 1e-6])
    assert existence_of_stable_cycle(values, closed, certify=True).tolist() == [0, 1, 1, 1, 0]
    (curve,) = closed.curves
    counts = {
        point.unstable_count
        for point in curve.stored_cycles
        if FIRST + 0.1 < point.parameter_value < LAST - 0.1
    }
    assert counts == {0, 1}


@pytest.mark.long
def test_a_branch_that_leaves_the_range_has_both_ends_there(starts):
    low = min(starts, key=lambda start: start.parameter_value)
    found = row_branches(ROD, request(60, 79), starts=[low])
    assert found.status == BranchStatus.ok
    (curve,) = found.curves
    assert not curve.is_closed
    assert [point.kind for point in curve.special_points] == [
        SpecialPointKind.end,
        SpecialPointKind.fold,
        SpecialPointKind.end,
    ]
    first, fold, last = curve.special_points
    assert {first.end_reason, last.end_reason} == {BranchEndReason.range_end}
    assert fold.parameter_value == pytest.approx(FIRST, abs=1e-8)
    assert [curve.stored_cycles[i].unstable_count for i in (0, -1)] == [1, 0]
    assert [curve.stored_cycles[i].parameter_value for i in (0, -1)] == pytest.approx([79, 79], rel=1e-13)
    # The same cycles at the ends of branches along k1: one comes from a Hopf point of another rod, the other
    # enters the range from smaller k1.
    along = rs.sweep(
        "branch", along="k1", F=79, k2=1e4, gamma3=0.006, gamma1=1, start=ROD.k1, stop=134, progress=False
    )
    ends = np.flatnonzero(along.special_at.values.ravel() == ROD.k1)
    periods, heights = (along[f"special_{name}"].values.ravel()[ends] for name in ("period", "tip_y_max"))
    assert sorted(periods) == pytest.approx(sorted([first.period, last.period]), rel=2e-6)
    assert sorted(heights) == pytest.approx(sorted([first.tip_y_max, last.tip_y_max]), rel=1e-5)
    # The motion from a large deflection settles on the cycle of the other end.
    beats = rs.sweep(
        "limit_cycle", F=79, k1=ROD.k1, k2=1e4, gamma3=0.006, gamma1=1, amplitude=0.2, progress=False
    )
    assert float(beats.period.squeeze()) == pytest.approx(last.period, rel=2e-6)
    assert float(beats.tip_y_max.squeeze()) == pytest.approx(last.tip_y_max, rel=1e-5)


@pytest.mark.long
def test_a_closed_branch_beyond_the_range_is_followed_once_around_and_left_out(starts):
    found = row_branches(ROD, request(88, 100), starts=starts)
    assert (found.status, found.message, found.curves) == (BranchStatus.ok, "", ())
    places = [fold.parameter_value for fold in found.folds_beyond_range]
    assert sorted(places) == pytest.approx([FIRST, LAST], abs=1e-7)


@pytest.mark.long
def test_a_point_on_a_known_branch_starts_no_other(beside):
    folds = [point for point in beside if point.kind == SpecialPointKind.fold]
    found = row_branches(BESIDE, request(60, 86), starts=folds)
    assert len(found.curves) == 1
    assert found.status == BranchStatus.ok


@pytest.mark.long
def test_a_point_that_a_known_branch_does_not_have_is_none(beside):
    """As the crossing of a curve that a coarse mesh displaces: the branch turns out to be known."""
    fold = next(point for point in beside if point.kind == SpecialPointKind.fold)
    displaced = replace(fold, parameter_value=fold.parameter_value + 0.01)
    found = row_branches(BESIDE, request(60, 86), starts=[displaced])
    assert (len(found.curves), found.status, found.message) == (1, BranchStatus.ok, "")


@pytest.mark.long
def test_a_point_without_a_branch_is_said_and_leaves_the_row_undecided(starts):
    wrong = replace(starts[0], orbit=None, message="its cycle is lost")
    found = row_branches(ROD, request(60, 86), starts=[wrong])
    assert found.status == BranchStatus.stopped
    where = f"the fold at F = {wrong.parameter_value:.9g}"
    assert found.message == f"no branch is followed through {where}: its cycle is lost"
    assert existence_of_stable_cycle(np.array([79.0]), found, certify=True).tolist() == [-1]
    # Branches are followed beyond the range, up to F = 45 here, but not as far as this fold.
    outside = row_branches(ROD, request(20, 30), starts=starts[:1])
    assert "the cycle found lies outside the range" in outside.message
