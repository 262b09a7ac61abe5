"""Branches of cycles: where they lead, where they change, and how sure both is."""

from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace

import numba
import numpy as np
import pytest
from surveyed import survey_only

from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.determinant.parameter_plane import PlaneAxis
from rodsweep.model.rod import Rod
from rodsweep.solve import seldom_used_functions
from rodsweep.solve.branch import branch_continuation, branches
from rodsweep.solve.branch.bordered import matrix
from rodsweep.solve.branch.bordered.matrix import BorderedMatrix
from rodsweep.solve.branch.branch_continuation import follow_branch_from_hopf_point
from rodsweep.solve.branch.branch_limits import BranchLimits, BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.special.augmented.fold_and_torus_test_functions import (
    multiplier_pair_nearest_unit_circle,
)
from rodsweep.solve.branch.special.curve_problem import SpecialCurveProblem
from rodsweep.solve.branch.special.special_curves import CurveEndReason
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.start import first_cycle as start_of_branch
from rodsweep.solve.branch.start.first_cycle import first_cycle
from rodsweep.solve.branch.start.hopf_point import hopf_branch_start
from rodsweep.solve.branch.status import BranchEndReason, BranchStatus
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.orbit import orbit_mesh
from rodsweep.solve.orbit.matrix.linearisation import reduced_stage_residual_variations
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.unsolvable import Unsolvable
from rodsweep.solve_progress import reporting_to

FIG_2C = Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4)
SHORT = Rod(F=0.0, k1=150.0, k2=1e4, gamma3=1e-4)
"""Its window of flutter is short, and so is its branch, with a fold just beyond the window."""


@lru_cache(maxsize=16)
def solved(rod, start=0.0, stop=200.0, accuracy=1e-7, along="F", points=500):
    return solve_branches(rod, BranchRequest(along, start, stop, accuracy, True, points, 50))


def kinds(curve):
    return [point.kind.name for point in curve.special_points]


def only(curve, kind):
    (point,) = [point for point in curve.special_points if point.kind == kind]
    return point


def first_branch(rod, stop, accuracy=1e-7):
    """The branch from the first Hopf point alone."""
    straight = Rod(F=0.0, k1=rod.k1, k2=rod.k2, gamma3=rod.gamma3)
    crossing = find_imaginary_axis_crossings(ParameterPath(straight, "F"), 0.0, stop).thresholds[0]
    hopf = hopf_branch_start(ParameterPath(rod, "F"), crossing)
    return follow_branch_from_hopf_point(
        0,
        BranchLimits([hopf], (0.0, stop), (BranchEndReason.range_end,) * 2, accuracy, 500, NewtonWorkspace()),
    )


def slopes(curve):
    """(p/y) dy/dp at the cycles of a branch, by differences to their neighbours."""
    at = np.array([point.parameter_value for point in curve.stored_cycles])
    y = np.array([point.measures.tip_y_max for point in curve.stored_cycles])
    return np.gradient(np.log(y)) / np.gradient(np.log(at))


@pytest.mark.long
def test_branch_from_the_first_hopf_point_of_fig_2c_arrives_at_its_restabilization():
    found = solved(FIG_2C)
    assert (found.status, found.message) == (BranchStatus.ok, "")
    (curve,) = found.curves
    assert kinds(curve) == ["hopf", "fold", "hopf"]
    first, fold, last = curve.special_points
    assert first.parameter_value == pytest.approx(49.7580049161915, abs=1e-11)
    assert last.parameter_value == pytest.approx(155.600159298791, abs=1e-10)
    assert last.period == pytest.approx(2 * np.pi / 3367.28095760, rel=1e-11)
    assert 199.16 < fold.parameter_value < 199.1602
    assert fold.error < 1e-9 * fold.parameter_value
    unstable = [point.unstable_count for point in curve.stored_cycles]
    turn = fold.index_of_cycle_before + 1
    assert unstable == [0] * turn + [1] * (len(unstable) - turn)
    assert all(point.parameter_value_error <= 1e-7 for point in curve.stored_cycles)
    steep = [abs(slope) > 100 for slope in slopes(curve)]
    assert all(
        point.errors.largest_weighted_error <= 1e-7
        for point, is_steep in zip(curve.stored_cycles, steep, strict=True)
        if not is_steep
    )
    assert 0 < sum(steep) < len(steep) / 2


def test_a_fold_needs_no_compilation_beyond_that_of_the_installation(monkeypatch):
    called = []

    def recorded(*arguments):
        called.append(tuple(map(numba.typeof, arguments)))
        return reduced_stage_residual_variations(*arguments)

    for module in (seldom_used_functions, matrix):
        monkeypatch.setattr(module, "reduced_stage_residual_variations", recorded)
    seldom_used_functions.warm_up()
    (compiled,) = called
    (curve,) = solve_branches(SHORT, BranchRequest("F", 0.0, 200.0, 1e-4, True, 500, 50)).curves
    assert "fold" in kinds(curve)
    assert len(called) > 1
    assert set(called) == {compiled}


@pytest.mark.long
def test_forward_and_backward_give_the_same_cycle():
    """At F = 100 from the first Hopf point, and from the other one through the fold."""
    forward = solved(FIG_2C, 0.0, 100.0, 1e-9).curves[0]
    backward = solved(FIG_2C, 100.0, 200.0, 1e-9).curves[0]
    assert kinds(forward) == ["hopf", "end"]
    assert kinds(backward) == ["hopf", "fold", "end"]
    for curve in (forward, backward):
        assert curve.special_points[-1].end_reason == BranchEndReason.range_end
        assert curve.stored_cycles[-1].parameter_value == pytest.approx(100.0, rel=1e-14)
    one, other = forward.stored_cycles[-1], backward.stored_cycles[-1]
    for name in ("period", "tip_y_max", "tip_x_min", "tip_x_max"):
        assert getattr(one.measures, name) == pytest.approx(getattr(other.measures, name), rel=1e-8)
    assert one.multiplier == pytest.approx(other.multiplier, abs=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("rod", [pytest.param(FIG_2C, marks=survey_only), SHORT])
def test_fold_moves_no_further_than_its_error_on_finer_meshes(rod):
    rough, fine = (only(solved(rod, 0.0, 200.0, a).curves[0], SpecialPointKind.fold) for a in (1e-5, 1e-8))
    assert abs(rough.parameter_value - fine.parameter_value) <= rough.error + fine.error
    assert max(rough.error, fine.error) <= 1e-9 * fine.parameter_value
    assert rough.period == pytest.approx(fine.period, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    ("along", "rod", "ends"),
    [("F", FIG_2C, (0.0, 200.0)), ("k1", Rod(k1=np.inf, F=100.0, k2=1e4, gamma3=1e-4), (100.0, 400.0))],
)
def test_first_cycles_have_the_amplitude_that_the_hopf_point_tells(along, rod, ends):
    """To the third order of the normal form, on the side that its sign says."""
    found = (
        solved(rod, *ends)
        if along == "F"
        else solve_branches(rod, BranchRequest(along, *ends, 1e-6, False, 200, 32))
    )
    for curve in found.curves:
        hopf, first = curve.special_points[0], curve.stored_cycles[0]
        a, away = hopf.amplitude_coefficient, first.parameter_value / hopf.parameter_value - 1
        assert np.sign(away) == np.sign(a)
        assert first.measures.tip_y_max == pytest.approx(abs(a) * abs(away) ** 0.5, rel=0.02)
    if along == "F":
        told = [
            s.amplitude_coefficient for s in found.curves[0].special_points if s.kind == SpecialPointKind.hopf
        ]
        assert told == pytest.approx([0.581140652, 0.236415530], rel=1e-3)  # tests/second_normal_form.py


def test_branch_without_a_fold():
    """The filament: no stretch, no shear, no rotational drag."""
    found = solved(Rod(F=0.0, k1=np.inf, k2=np.inf, gamma3=0.0), 0.0, 60.0)
    (curve,) = found.curves
    assert found.status == BranchStatus.ok
    assert kinds(curve) == ["hopf", "end"]
    assert np.all(np.diff([point.parameter_value for point in curve.stored_cycles]) > 0)
    assert {point.unstable_count for point in curve.stored_cycles} == {0}


@pytest.mark.long
def test_branch_that_leaves_the_model_ends_where_h1_is_0():
    found = solved(Rod(F=0.0, k1=100.0, k2=1e4, gamma3=0.1), 60.0, 120.0)
    (curve, _) = found.curves  # the other branch enters the range from the Hopf point near 42.8
    end = curve.special_points[-1]
    assert end.kind == SpecialPointKind.left_the_model
    assert end.parameter_value == pytest.approx(99.14065359, abs=1e-6)
    assert 0 < curve.stored_cycles[-1].measures.least_stretch < 0.05
    finer = solved(Rod(F=0.0, k1=100.0, k2=1e4, gamma3=0.1), 60.0, 120.0, 1e-9).curves[0].special_points[-1]
    assert abs(end.parameter_value - finer.parameter_value) <= end.error + finer.error


@pytest.mark.long
def test_torus_point_lies_where_the_cycle_of_its_own_loses_its_stability():
    rod = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2)
    curve = first_branch(rod, 207.0, 1e-5)
    assert kinds(curve) == ["hopf", "torus", "end"]
    torus = only(curve, SpecialPointKind.torus)
    assert torus.error < 1e-9 * torus.parameter_value
    after = torus.index_of_cycle_before + 1
    assert [point.unstable_count for point in curve.stored_cycles[after - 1 : after + 1]] == [0, 2]
    request = CycleRequest(1e-6, 0.01, 8, 0, 0, 0, 400, "hopf")
    for side, status in ((-1, CycleStatus.cycle), (1, CycleStatus.unstable)):
        F = torus.parameter_value * (1 + side * 2e-4)
        cycle = solve_cycle(Rod(F=F, k1=rod.k1, k2=rod.k2, gamma3=rod.gamma3, gamma1=rod.gamma1), request)
        assert cycle.status == status
        assert abs(cycle.multipliers[0].imag) > 0.5
        assert 1e-4 < side * (cycle.multiplier - 1) < 2e-3
        assert cycle.measures.tip_y_max == pytest.approx(torus.tip_y_max, rel=2e-3)
    points, end = SpecialCurveProblem(
        SpecialPointKind.torus,
        PlaneAxis("F", 150.0, 220.0),
        PlaneAxis("k2", 97.0, 103.0),
        NewtonWorkspace(),
        -1.0,
    ).follow_from(torus, 100.0)
    assert end is CurveEndReason.edge
    assert points[0].branch_parameter_value == pytest.approx(
        torus.parameter_value, abs=points[0].branch_parameter_error + torus.error
    )
    for point in points:
        assert point.branch_parameter_error <= 1e-7 * point.branch_parameter_value
        # By the eigenvalues of a matrix of its own, where the curve has the eigenvector of one near by.
        pair = multiplier_pair_nearest_unit_circle(
            BorderedMatrix(point.orbit, point.scale, NewtonWorkspace())
        )
        assert abs(pair) == pytest.approx(1.0, abs=1e-7)


@pytest.mark.long
def test_fold_along_the_stretch_stiffness_is_the_fold_along_the_force():
    along_k1 = solved(Rod(k1=np.inf, F=100.0, k2=1e4, gamma3=1e-4), 120.0, 170.0, along="k1")
    fold = only(along_k1.curves[0], SpecialPointKind.fold)
    along_F = solved(Rod(F=0.0, k1=fold.parameter_value, k2=1e4, gamma3=1e-4), 50.0, 150.0)
    same = only(along_F.curves[0], SpecialPointKind.fold)
    assert same.parameter_value == pytest.approx(100.0, abs=1e-6)
    assert same.period == pytest.approx(fold.period, rel=1e-6)


@pytest.mark.parametrize(
    ("along", "start", "stop", "values"),
    [
        ("k2", 20.0, 400.0, {"F": 22.0, "k1": 1e4, "gamma3": 1e-2}),
        ("gamma3", 1e-3, 2e-2, {"F": 45.0, "k1": 200.0, "k2": 1e4}),
    ],
)
def test_branch_along_another_parameter_has_the_cycle_that_the_force_has(along, start, stop, values):
    """At its end, where the rod is one of the task limit_cycle."""
    found = solve_branches(
        Rod(**values, **{along: start}), BranchRequest(along, start, stop, 1e-7, True, 500, 50)
    )
    assert found.status == BranchStatus.ok
    curve = found.curves[0]
    end, point = curve.special_points[-1], curve.stored_cycles[-1]
    assert end.end_reason == BranchEndReason.range_end
    request = CycleRequest(1e-7, 0.01, 8, 0, 0, 0, 400, "hopf")
    cycle = solve_cycle(Rod(gamma1=1.0, **values | {along: end.parameter_value}), request)
    assert cycle.status == CycleStatus.cycle
    assert cycle.measures.period == pytest.approx(point.measures.period, rel=3e-7)
    assert cycle.measures.tip_y_max == pytest.approx(point.measures.tip_y_max, rel=3e-7)
    assert cycle.multiplier == pytest.approx(point.multiplier, abs=1e-5)


def test_rod_without_a_hopf_point_has_no_branch():
    found = solved(Rod(F=0.0, k1=100.0, k2=1e4, gamma3=1e-4))
    assert (found.status, found.curves, found.crossings) == (BranchStatus.ok, (), ())


def test_branch_that_cannot_be_followed_says_where_and_why(monkeypatch):
    made = branch_continuation.next_cycle

    def lost(here, accuracy):
        if here.parameter_coordinate > 75:
            raise Unsolvable("there is no cycle near on the branch")
        return made(here, accuracy)

    monkeypatch.setattr(branch_continuation, "next_cycle", lost)
    solved.cache_clear()
    found = solved(SHORT)
    solved.cache_clear()
    first, second = found.curves
    assert found.status == BranchStatus.stopped
    assert first.special_points[-1].kind == SpecialPointKind.end
    assert first.special_points[-1].end_reason == BranchEndReason.no_cycle_found
    said = "the next cycle is not solved: there is no cycle near on the branch at F = "
    assert f"branch 1: {said}{first.stored_cycles[-1].parameter_value:.9g}; branch 2: {said}" in found.message
    assert first.stored_cycles[-1].parameter_value > 75
    assert second.start_hopf_index == 1  # the other end is tried by itself


def test_list_that_is_full_says_so():
    found = solved(SHORT, points=8)
    assert found.status == BranchStatus.list_full
    assert sum(len(curve.stored_cycles) for curve in found.curves) == 8
    assert found.curves[0].special_points[-1].end_reason == BranchEndReason.list_full


def test_search_that_fails_is_a_status(monkeypatch):
    def failing(*_):
        raise Unsolvable("no a-priori bound on the eigenvalues applies to this rod")

    monkeypatch.setattr(branches, "find_imaginary_axis_crossings", failing)
    found = solve_branches(SHORT, BranchRequest("F", 0.0, 200.0, 1e-7, True, 500, 50))
    assert found.status == BranchStatus.failed
    assert found.message == "no a-priori bound on the eigenvalues applies to this rod"


def test_place_of_a_long_solve_says_how_far_it_is(monkeypatch):
    """Half of the eliminations are done at a share of a fifth to four fifths; no clock is asked."""
    done, places = [], []
    eliminate = matrix.eliminate_newton_matrix
    monkeypatch.setattr(
        matrix, "eliminate_newton_matrix", lambda *values: done.append(1) or eliminate(*values)
    )
    with reporting_to(lambda place: places.append((len(done), *place()))):
        solve_branches(
            Rod(F=0.0, k1=4000, k2=300, gamma3=1e-3), BranchRequest("F", 0, 150, 1e-5, True, 500, 50)
        )
    work, words, shares = zip(*[place for place in places if place[1]], strict=True)
    assert all(0 <= share <= 1 for share in shares)
    assert words[0].startswith("branch from Hopf point 1 of 2: F = 3")
    assert words[0].endswith(" on the way to 150, 1 cycle")
    assert shares[0] < 0.1
    assert shares[-1] > 0.8
    assert 0.2 < np.interp(0.5 * len(done), work, shares) < 0.8


@pytest.mark.long
def test_a_fold_close_to_crushing_is_located_from_both_ends_of_its_branch():
    """A prediction over the whole step between the cycles beside it has F > k1."""
    rod = Rod(F=0.0, k1=229.46018, k2=1e4, gamma3=1e-4, gamma1=0.5)
    folds = []
    for start in (0.0, 100.0):  # from the first Hopf point, and from the restabilization
        found = solved(rod, start, stop=0.9998 * rod.k1, accuracy=1e-5)
        assert found.status == BranchStatus.ok
        folds += [only(curve, SpecialPointKind.fold) for curve in found.curves]
    one, other = folds
    assert abs(one.parameter_value - other.parameter_value) <= one.error + other.error
    assert max(one.error, other.error) < 1e-7 * rod.k1


def unmeasured(orbit):
    """A first cycle without measured errors, on a branch that follows its normal form."""
    measures = SimpleNamespace(tip_y_max=float(orbit.form.tip_coordinates(orbit.start_state)[1]))
    return SimpleNamespace(
        orbit=orbit, parameter_per_arc_length=0.0, cycle=SimpleNamespace(measures=measures)
    )


def test_a_branch_begins_where_the_mesh_of_a_coarse_accuracy_has_no_cycle(monkeypatch):
    """The sixth Hopf point of a rod that is soft in shear; the mesh's own one lies beyond."""
    smallest = start_of_branch.BRANCH_START_SETTINGS.first_amplitudes[-1]
    beginning = replace(start_of_branch.BRANCH_START_SETTINGS, first_amplitudes=(smallest,))
    monkeypatch.setattr(start_of_branch, "BRANCH_START_SETTINGS", beginning)
    monkeypatch.setattr(
        start_of_branch, "first_cycle_with_measured_errors", lambda first, *others: unmeasured(first.orbit)
    )
    path = ParameterPath(
        Rod(F=159.0, k1=1597.4434592561727, k2=19.205853519589944, gamma3=2.45e-8, gamma1=0.72), "F"
    )
    (crossing,) = find_imaginary_axis_crossings(path, 159.0, 161.0, False).thresholds
    orbit = first_cycle(hopf_branch_start(path, crossing), 2.0785686460875202e-05, NewtonWorkspace()).orbit
    assert float(orbit.form.tip_coordinates(orbit.start_state)[1]) == pytest.approx(smallest, rel=1e-3)


@survey_only
@pytest.mark.parametrize("start, stop", [(78.0, 200.0), (99.0, 200.0), (181.0, 182.8)])
def test_branches_whose_cycles_have_multipliers_of_1e20_go_on_to_the_end_of_the_range(start, stop):
    """Their first cycles, and the errors beyond F = 174, were lost in rounding errors of Newton's steps."""
    rod = Rod(F=0.0, k1=251.35, k2=10.5379, gamma3=1.0956e-7, gamma1=0.91638)
    crossing = find_imaginary_axis_crossings(ParameterPath(rod, "F"), start, start + 5).thresholds[0]
    ends = ((0.0, stop), (BranchEndReason.range_end,) * 2, 9.9e-4, 500, NewtonWorkspace())
    curve = follow_branch_from_hopf_point(
        0, BranchLimits([hopf_branch_start(ParameterPath(rod, "F"), crossing)], *ends)
    )
    assert curve.is_complete
    assert curve.special_points[-1].parameter_value == pytest.approx(stop)
    assert max(point.multiplier for point in curve.stored_cycles) > 1e20


def test_two_cycles_lie_behind_a_corner_before_the_end_of_the_range():
    """Another maximum of y(t) becomes the largest at a corner, which a figure locates from both sides."""
    rod = Rod(F=0.0, k1=419.6, k2=23447.0, gamma3=0.1237, gamma1=0.645)
    request = BranchRequest("F", 0.0, 124.34, 3e-4, certify=False, cycles=100, special=10)
    (branch,) = solve_branches(rod, request, NewtonWorkspace()).curves
    sizes = [point.measures.tip_y_max for point in branch.stored_cycles[-4:]]
    changes = np.diff(sizes)
    assert np.sign(changes).tolist() == [-1, 1, 1]
    # The middle step contains the corner, where a fall and a rise may cancel; the others are no errors.
    assert np.abs(changes[[0, 2]]).min() > 10 * request.accuracy * max(sizes)


def test_a_branch_that_needs_too_fine_a_mesh_ends_with_the_limits_of_meshes(monkeypatch):
    smaller = replace(orbit_mesh.ORBIT_MESH_SETTINGS, max_unknown_count=45)
    monkeypatch.setattr(orbit_mesh, "ORBIT_MESH_SETTINGS", smaller)
    rod = Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
    found = solve_branches(rod, BranchRequest("F", 0.0, 80.0, 1e-6, True, 99, 9))
    assert found.status == BranchStatus.stopped
    limits = "no mesh of at most 45 unknowns and 256 time intervals, with at most 2.1 GB for its matrix"
    assert f"{limits}, reaches the requested accuracy at F = " in found.message
    assert "found" not in found.message
