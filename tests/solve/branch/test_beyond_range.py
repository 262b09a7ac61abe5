"""Branches that leave the range and come back, and branches that enter it from Hopf points beyond.

Fig. 2c's rod k1 = 200 has Hopf points at F = 49.758 and 155.600, joined by a branch with a fold at F =
199.160. The branch of the rubber rod begins at F = 108.306, turns at a fold at F = 77.690 and is stable from
there on.
"""

from dataclasses import replace

import numpy as np
import pytest

from rodsweep.determinant.parameter_plane import PlaneAxis
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.branch import branches, region_beyond_range, regions_beyond_range
from rodsweep.solve.branch.branch_limits import BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.coexistence import solve_coexistence, stability_intervals
from rodsweep.solve.branch.special.curve_problem import SpecialCurveProblem
from rodsweep.solve.branch.special.row_crossing import RowCrossing
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.status import BranchStatus, CoexistenceStatus
from rodsweep.solve.changes.diagram.rows import RowRequest
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace

FIG_2C = Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4)
RUBBER = Rod(F=0.0, k1=322.11, k2=1e4, gamma3=0.02, material=RodMaterial("neo_hookean", "swelling"))
ACCURACY = 1e-4


def followed(rod, start, stop, along="F"):
    found = solve_branches(rod, BranchRequest(along, start, stop, ACCURACY, False, 500, 50))
    assert found.status == BranchStatus.ok
    return found


def kinds(curve):
    return [point.kind.name for point in curve.special_points]


def states(rod, values):
    row = solve_coexistence(rod, RowRequest("F", np.array(values), 1e-8, False, 16, ACCURACY, 64))
    assert row.status == CoexistenceStatus.ok
    return row.stable_states.tolist()


@pytest.fixture
def within_only(monkeypatch):
    """Function that turns the search beyond the range off and on."""

    def switch(off):
        monkeypatch.undo()
        if off:
            monkeypatch.setattr(branches, "regions_beyond_range", lambda *_: [])

    return switch


def at_force(curve, force):
    """Period and largest tip y of a branch at a force, by interpolation between its cycles."""
    order = np.argsort([point.parameter_value for point in curve.stored_cycles])
    at, period, y = np.array(
        [(p.parameter_value, p.measures.period, p.measures.tip_y_max) for p in curve.stored_cycles]
    )[order].T
    return np.interp(force, at, period), np.interp(force, at, y)


@pytest.mark.long
def test_a_branch_that_turns_back_beyond_the_range_comes_back_stable():
    found = followed(RUBBER, 88.04, 137.56)
    first, second, back = found.curves
    assert [kinds(curve) for curve in (first, second)] == [["hopf", "end"]] * 2
    assert kinds(back) == ["end", "end"]
    assert [point.parameter_value for point in back.special_points] == pytest.approx(
        [88.04, 137.56], rel=1e-12
    )
    assert [interval.stability for interval in stability_intervals(back)] == [1]
    assert found.followed_range == (0.0, pytest.approx(1.5 * 137.56))
    # On the wide range the same cycles lie beyond the fold of one branch.
    (wide, *_) = followed(RUBBER, 50.0, 137.56).curves
    fold = next(i for i, point in enumerate(wide.special_points) if point.kind == SpecialPointKind.fold)
    after = wide.special_points[fold].index_of_cycle_before + 1
    upper = replace(wide, stored_cycles=wide.stored_cycles[after:])
    for force in (100.0, 120.0):
        assert at_force(back, force) == pytest.approx(at_force(upper, force), rel=3e-3)
    last, same = back.special_points[-1], wide.special_points[-1]
    assert abs(last.period / same.period - 1) <= last.period_error + same.period_error


@pytest.mark.long
def test_a_branch_enters_the_range_from_a_fold_beyond_it_without_a_hopf_point():
    """At k1 = 321.7 there is no Hopf point; the fold is on a curve through the fold at k1 = 322.11."""
    request = BranchRequest("F", 88.04, 137.56, ACCURACY, False, 500, 50)
    (fold,) = solve_branches(RUBBER, request).folds_beyond_range
    assert fold.parameter_value == pytest.approx(77.690, abs=2e-3)
    axes = PlaneAxis("F", 50.0, 137.56), PlaneAxis("k1", 321.0, 323.0)
    problem = SpecialCurveProblem(SpecialPointKind.fold, *axes, NewtonWorkspace(), -1.0)
    points, _ = problem.follow_from(fold, RUBBER.k1)
    row = axes[1].scaled_coordinate(321.7)
    number = next(i for i, point in enumerate(points) if point.row_coordinate < row)
    one, other = points[number - 1 : number + 1]
    crossing = problem.point_on_row(one, other, row)
    start = RowCrossing.from_solved_point(0, SpecialPointKind.fold, crossing, 0.0).special_point
    rod = RUBBER.with_values(k1=321.7)
    assert solve_branches(rod, request).curves == ()
    found = solve_branches(rod, request, starts=[start])
    assert (found.status, found.message) == (BranchStatus.ok, "")
    assert [kinds(curve) for curve in found.curves] == [["end", "end"]] * 2
    stable = [[interval.stability for interval in stability_intervals(curve)] for curve in found.curves]
    assert sorted(stable) == [[0], [1]]
    (same,) = found.folds_beyond_range
    # The branch through a fold that is known starts no other branch, nor does the fold of a known branch.
    again = solve_branches(rod, request, starts=[start, same])
    assert len(again.curves) == 2
    assert len(solve_branches(RUBBER, request, starts=[fold]).curves) == 3
    # On a range that contains the fold it is a point of the branch.
    (wide,) = solve_branches(rod, replace(request, start=70.0), starts=[start]).curves
    (located,) = [point for point in wide.special_points if point.kind == SpecialPointKind.fold]
    assert located.parameter_value == pytest.approx(same.parameter_value, rel=2e-9)
    assert crossing.branch_parameter_value == pytest.approx(same.parameter_value, rel=1e-7)


@pytest.mark.long
@pytest.mark.parametrize("distance", [1e-7, 1e-6, 1e-5])
def test_a_range_may_begin_just_beyond_a_hopf_point(distance):
    """The cycles grow with the square root of the distance from the Hopf point at F = 67.386984288, which a
    mesh displaces by more than the distance of the range from it."""
    rod = Rod(F=0.0, k1=150.0, k2=1e4, gamma3=1e-4)
    (whole,) = followed(rod, 60.0, 75.0).curves
    hopf = whole.special_points[0]
    (part,) = followed(rod, hopf.parameter_value + 0.01, 75.0).curves
    amplitude = part.special_points[0].tip_y_max / 0.1  # over the square root of 0.01
    found = followed(rod, hopf.parameter_value + distance, 75.0)
    (curve,) = found.curves
    start, end = curve.special_points
    assert (kinds(curve), found.followed_range) == (["end", "end"], (0.0, 112.5))
    assert start.parameter_value == hopf.parameter_value + distance
    assert start.tip_y_max / distance**0.5 == pytest.approx(amplitude, rel=3e-3)
    assert start.tip_y_max_error < 1e-2
    assert start.period == pytest.approx(hopf.period, rel=1e-6)
    assert [interval.stability for interval in stability_intervals(curve)] == [1]
    assert at_force(curve, 72.0) == pytest.approx(at_force(whole, 72.0), rel=1e-3)
    # The same from the other side: the branch from the Hopf point leaves the range at once.
    (same,) = followed(rod, 60.0, hopf.parameter_value + 2 * distance).curves
    assert kinds(same) == ["hopf", "end"]


@pytest.mark.parametrize(
    ("distance", "accuracy", "largest_error"),
    [(1e-8, 1e-7, 3e-6), (1e-7, 1e-7, 3e-6), (3e-7, 1e-7, 3e-6), (1e-6, 1e-7, 3e-6), (1e-5, 1e-4, 2e-3)],
)
def test_the_amplitude_just_beyond_a_hopf_point_has_the_error_of_the_normal_form(
    distance, accuracy, largest_error
):
    """Cycles that a mesh solves there have errors of the largest tip y of 1e-4 to 5e-3. The largest tip y is
    sqrt(d) (A + B d) at the relative distance d from the Hopf point (`hard.test_beside_the_hopf_point`)."""
    rod, hopf_point = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2), 27.427194126759282
    start = hopf_point * (1 + distance)
    found = solve_branches(rod, BranchRequest("F", start, 28.0, accuracy, False, 500, 50))
    assert (found.status, found.message) == (BranchStatus.ok, "")
    (curve,) = found.curves
    end = curve.special_points[0]
    exact = start / hopf_point - 1
    amplitude = exact**0.5 * (0.898059510153 + 0.162248 * exact)
    assert (end.kind, end.parameter_value) == (SpecialPointKind.end, start)
    assert abs(end.tip_y_max / amplitude - 1) <= end.tip_y_max_error <= largest_error
    # The error contains a part of the error of a cycle, which is a fraction of the accuracy at least.
    assert end.period_error < max(1e-7, 1e-2 * accuracy)


@pytest.mark.long
@pytest.mark.parametrize(("distance", "start"), [(-1e-6, "end"), (1e-6, "hopf")])
def test_a_range_may_end_just_before_a_hopf_point_or_behind_it(distance, start):
    """The branch of the rubber rod leaves its Hopf point at F = 108.306 downwards and comes back stable."""
    hopf = followed(RUBBER, 88.04, 110.0).crossings[0].value
    found = followed(RUBBER, 88.04, hopf + distance)
    first, back = found.curves
    assert [kinds(curve) for curve in (first, back)] == [[start, "end"], ["end", "end"]]
    assert [i.stability for curve in (first, back) for i in stability_intervals(curve)] == [0, 1]
    assert found.followed_range == (0.0, pytest.approx(1.5 * (hopf + distance)))


@pytest.mark.long
def test_cycles_without_symmetry_enter_the_range_from_a_symmetry_breaking_beyond():
    """The symmetry breaks at F = 19.9028051; the branch turns at a fold at F = 19.7130206 and has tip y =
    1.3554 at F = 20, on the branches from F = 0 on."""
    found = followed(Rod(F=0.0, k1=30.0, k2=0.5, gamma3=0.1), 20.0, 20.2)
    (lopsided,) = [curve for curve in found.curves if curve.special_points[0].tip_y_max > 1.35]
    assert kinds(lopsided) == ["end", "end"]
    assert lopsided.special_points[0].tip_y_max == pytest.approx(1.3554, abs=1e-4)
    assert lopsided.special_points[0].period == pytest.approx(0.103005, abs=1e-6)
    measures = lopsided.stored_cycles[0].measures
    assert abs(measures.tip_y_min) < 0.99 * measures.tip_y_max
    assert [interval.stability for interval in stability_intervals(lopsided)] == [1]
    assert found.followed_range[0] == 0.0


@pytest.mark.long
def test_a_branch_that_enters_the_range_by_less_than_the_accuracy_is_found():
    """The branch from the Hopf point at F = 85.569 turns back at F = 85.6055767, 8e-8 of it within the
    range."""
    rod = Rod(F=0.0, k1=150.0, k2=1e4, gamma3=1e-4)
    whole = next(curve for curve in followed(rod, 75.0, 86.0).curves if "fold" in kinds(curve))
    fold = next(point for point in whole.special_points if point.kind == SpecialPointKind.fold)
    widths = {}
    for distance in (6.7e-6, 1e-3):
        found = followed(rod, fold.parameter_value - distance, 86.0)
        (curve,) = found.curves
        assert kinds(curve) == ["end", "fold", "end"]
        assert curve.special_points[1].is_same_as(fold)
        assert not any(point.is_same_as(fold) for point in found.folds_beyond_range)
        first, _, last = curve.special_points
        widths[distance] = abs(first.tip_y_max - last.tip_y_max) / distance**0.5
    # Near a fold the two cycles differ by the square root of the distance from it.
    assert widths[6.7e-6] == pytest.approx(widths[1e-3], rel=0.02)
    assert followed(rod, fold.parameter_value + 1e-6, 86.0).curves == ()


@pytest.mark.long
def test_a_branch_that_enters_the_range_by_less_than_any_mesh_resolves_is_a_failure():
    rod = Rod(F=0.0, k1=150.0, k2=1e4, gamma3=1e-4)
    found = solve_branches(rod, BranchRequest("F", 85.6055767348 - 1e-8, 86.0, ACCURACY, False, 500, 50))
    assert found.status == BranchStatus.stopped
    assert "no branch is followed through the fold at F = 85.6055767" in found.message


@pytest.mark.long
def test_a_branch_that_is_lost_beyond_the_range_leaves_the_row_undecided():
    request = BranchRequest("F", 88.04, 137.56, ACCURACY, False, 500, 50)
    (fold,) = solve_branches(RUBBER, request).folds_beyond_range
    wrong = replace(fold, parameter_value=fold.parameter_value - 1.0, orbit=None, message="its cycle is lost")
    found = solve_branches(RUBBER.with_values(k1=321.7), request, starts=[wrong])
    assert found.status == BranchStatus.stopped
    assert "no branch is followed through the fold at F = 76.68" in found.message
    assert found.message.endswith("its cycle is lost")


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        pytest.param([60.0, 100.0, 150.0], [2, 2, 2], id="Hopf points on both sides"),
        pytest.param([160.0, 170.0, 180.0], [3, 3, 3], id="only below: the straight rod is stable again"),
    ],
)
def test_cycles_on_branches_from_hopf_points_beyond_the_range_are_stable_states(
    values, expected, within_only
):
    assert states(FIG_2C, values) == expected
    within_only(True)
    assert 2 not in states(FIG_2C, values)
    assert 3 not in states(FIG_2C, values)


def test_a_branch_from_a_hopf_point_close_to_the_range_is_followed_from_the_end_of_the_range():
    """The first cycle of the branch of a subcritical Hopf point lies within the range."""
    hopf = 108.306023441
    above = followed(RUBBER, 80.0, hopf * (1 - 1e-4))
    assert above.crossings == ()
    assert sorted(kinds(curve) for curve in above.curves) == [["end", "end"]] * 2
    stable = [[interval.stability for interval in stability_intervals(curve)] for curve in above.curves]
    assert sorted(stable) == [[0], [1]]


@pytest.mark.long
def test_branches_that_do_not_come_back_are_the_same_to_the_last_bit(within_only):
    for start, stop in ((0.0, 150.0), (0.0, 157.0)):
        within_only(False)
        one = followed(FIG_2C, start, stop)
        within_only(True)
        two = followed(FIG_2C, start, stop)
        assert two.followed_range == (start, stop)
        assert one.followed_range == (
            start,
            pytest.approx(200 * (1 - branches.BRANCH_SETTINGS.crushing_margin)),
        )
        with np.printoptions(floatmode="unique"):
            assert [repr(curve.stored_cycles) for curve in one.curves] == [
                repr(curve.stored_cycles) for curve in two.curves
            ]
        for mine, other in zip(one.curves, two.curves, strict=True):
            assert repr(mine.special_points) == repr(other.special_points)


def test_branches_enter_a_range_of_a_stiffness_and_of_a_drag():
    (one,) = followed(replace(FIG_2C, F=85.0), 160.0, 180.0, "k1").curves
    assert [interval.stability for interval in stability_intervals(one)] == [1]
    found = followed(Rod(F=60.0, k1=103.0, k2=1e4, gamma3=0.05), 0.04, 0.043, "gamma3")
    assert found.crossings == ()
    stable = [[interval.stability for interval in stability_intervals(curve)] for curve in found.curves]
    assert sorted(stable) == [[0], [1]]
    assert found.followed_range == pytest.approx((0.04 / 1.5, 0.043 * 1.5))


@pytest.mark.parametrize(
    "limits",
    [{"min_work_limit": 0.0, "work_limit_per_work_within_range": 0.0}, {"max_cycles": 2}],
    ids=["limit of work", "limit of cycles"],
)
def test_a_limit_beyond_the_range_is_stated(limits, monkeypatch):
    """The branches within the range are complete; `followed_range` says how far the others were followed."""
    settings = replace(region_beyond_range.BEYOND_RANGE_SETTINGS, **limits)
    monkeypatch.setattr(region_beyond_range, "BEYOND_RANGE_SETTINGS", settings)
    monkeypatch.setattr(regions_beyond_range, "BEYOND_RANGE_SETTINGS", settings)
    found = followed(RUBBER, 88.04, 137.56)
    assert [kinds(curve) for curve in found.curves] == [["hopf", "end"]] * 2
    low, high = found.followed_range
    assert 77.7 < low <= 88.04
    assert 137.56 <= high < 1.5 * 137.56


def test_a_branch_given_up_on_its_way_to_the_range_is_followed_only_to_its_last_cycle(monkeypatch):
    """The branch from the Hopf point at F = 49.758 enters the range at 60, unless it is given up before."""
    low, _ = followed(FIG_2C, 60.0, 80.0).followed_range
    assert low == 0.0
    settings = replace(region_beyond_range.BEYOND_RANGE_SETTINGS, max_cycles=4)
    monkeypatch.setattr(region_beyond_range, "BEYOND_RANGE_SETTINGS", settings)
    monkeypatch.setattr(regions_beyond_range, "BEYOND_RANGE_SETTINGS", settings)
    found = followed(FIG_2C, 60.0, 80.0)
    assert found.curves == ()
    low, _ = found.followed_range
    assert 49.84 < low < 60.0  # its first cycle is at 49.817


def test_a_failure_beyond_the_range_leaves_the_branches_within(monkeypatch):
    def overflows(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(region_beyond_range.RegionBeyondRange, "_follow_to_range_entry", overflows)
    found = followed(FIG_2C, 0.0, 150.0)
    assert [kinds(curve) for curve in found.curves] == [["hopf", "end"]]
    assert found.followed_range == (0.0, 150.0)


def test_a_branch_that_turns_back_just_beyond_the_range_comes_back():
    """The step from the end of the range leads over the fold: at half of this step the branch is beyond."""
    rod = Rod(F=0.0, k1=175.0, k2=1e4, gamma3=1e-4)
    fold = 144.728
    (one,) = followed(rod, 0.0, fold * (1 - 1e-3)).curves[:1]
    assert kinds(one) == ["hopf", "end"]
    row = states(rod, [100.0, 130.0, fold * (1 - 1e-3)])
    assert row == states(rod, [100.0, 130.0, fold * (1 - 1e-3), 160.0])[:-1]


@pytest.mark.long
def test_a_narrow_diagram_equals_the_part_of_a_wide_one():
    """Random rods near the first fold of their Hopf curves, with ranges that contain no fold."""
    rng = np.random.default_rng(11)
    for k1, gamma3 in zip(rng.uniform(100, 108, 3), rng.uniform(0.05, 0.08, 3), strict=True):
        rod = Rod(F=0.0, k1=float(k1), k2=6e3, gamma3=float(gamma3))
        wide = states(rod, np.linspace(20.0, 90.0, 29))
        assert 3 in wide
        for first, last in ((12, 20), (20, 26)):
            assert states(rod, np.linspace(20.0, 90.0, 29)[first:last]) == wide[first:last]


def test_a_narrow_range_around_a_fold_holds_both_parts_of_the_branch():
    """The branch enters and leaves at one end of the range within one step, whose first zero is its start."""
    (curve,) = followed(Rod(F=0.0, k1=150.0, k2=1e4, gamma3=1e-4), 85.6055, 85.6056).curves
    assert kinds(curve) == ["end", "fold", "end"]
    ends = [point.parameter_value for point in curve.special_points]
    np.testing.assert_allclose(ends, [85.6055, 85.6055767, 85.6055], rtol=1e-8)
    first, last = (point.multiplier for point in (curve.stored_cycles[0], curve.stored_cycles[-1]))
    assert first < 1 < last


def test_branches_are_followed_up_to_the_last_allowed_taper():
    found = followed(Rod(F=75.0, k1=150.0, k2=1e4, gamma3=1e-4), 0.6, 90.0, "taper")
    assert kinds(found.curves[0]) == ["hopf", "fold", "hopf"]
    assert max(found.followed_range) == 100.0
