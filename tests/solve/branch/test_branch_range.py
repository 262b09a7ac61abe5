"""A branch that leaves the range of its parameter before a fold ends there, though a step reaches over it."""

import pytest

from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branch_continuation import follow_branch_from_hopf_point
from rodsweep.solve.branch.branch_limits import BranchLimits, BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.start.hopf_point import hopf_branch_start
from rodsweep.solve.branch.status import BranchEndReason, BranchStatus
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace

FOLDED = Rod(F=0.0, k1=175.0, k2=1e4, gamma3=1e-4)


def branches_to(stop, rod=FOLDED):
    return solve_branches(rod, BranchRequest("F", 0.0, stop, 1e-4, False, 500, 50))


@pytest.fixture(scope="module")
def fold():
    (curve,) = branches_to(150.0).curves
    (found,) = (one for one in curve.special_points if one.kind == SpecialPointKind.fold)
    return found


@pytest.mark.parametrize("share", [1e-3, 1e-4])
def test_branch_ends_before_a_fold_beyond_the_range(fold, share):
    stop = fold.parameter_value * (1 - share)
    found = branches_to(stop)
    assert found.status == BranchStatus.ok
    first = found.curves[0]
    assert [one.kind.name for one in first.special_points] == ["hopf", "end"]
    assert first.special_points[-1].end_reason == BranchEndReason.range_end
    assert first.special_points[-1].parameter_value == pytest.approx(stop, rel=1e-9)
    assert max(point.parameter_value for point in first.stored_cycles) <= stop * (1 + 1e-9)


def test_branch_passes_a_fold_within_the_range(fold):
    (curve, *_) = branches_to(fold.parameter_value * (1 + 1e-4)).curves
    (same,) = (one for one in curve.special_points if one.kind == SpecialPointKind.fold)
    assert same.parameter_value == pytest.approx(fold.parameter_value, abs=fold.error + same.error)


@pytest.mark.parametrize("distance", [1e-7, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-7])
def test_a_range_that_starts_beside_a_hopf_point_has_its_branch(distance):
    """The relative distance of the start above (+) or below (-) the Hopf point is far below the accuracy."""
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4)
    (hopf,) = find_imaginary_axis_crossings(ParameterPath(rod, "F"), 0.0, 40.0).thresholds
    start = hopf.value * (1 + distance)
    found = solve_branches(rod, BranchRequest("F", start, 40.0, 1e-5, True, 100, 10))
    assert found.status == BranchStatus.ok, found.message
    (curve,) = found.curves
    kinds = [SpecialPointKind.end if distance > 0 else SpecialPointKind.hopf, SpecialPointKind.end]
    assert [point.kind for point in curve.special_points] == kinds
    begin = hopf.value if distance <= 0 else start
    assert curve.special_points[0].parameter_value == pytest.approx(begin, rel=1e-13)


@pytest.mark.parametrize("distance", [1e-3, 1e-4, 3e-5])
def test_the_period_is_accurate_where_the_amplitude_is_steep(distance):
    """Near its Hopf point a mesh displaces this point: y at a force changes by far more than the accuracy,
    the period does not."""
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4)
    (hopf,) = find_imaginary_axis_crossings(ParameterPath(rod, "F"), 0.0, 40.0).thresholds
    start = hopf.value * (1 + distance)
    ends = []
    for accuracy in (1e-9, 1e-5):
        (curve,) = solve_branches(rod, BranchRequest("F", start, 40.0, accuracy, True, 100, 10)).curves
        ends.append(curve.special_points[0])
    exact, end = ends
    assert [point.parameter_value for point in ends] == pytest.approx([start, start], rel=1e-13)
    assert abs(end.period / exact.period - 1) <= end.period_error < 2e-6
    assert abs(end.tip_y_max / exact.tip_y_max - 1) <= end.tip_y_max_error < 1e-5


def test_the_normal_form_and_cycles_beside_the_hopf_point_give_the_cycle_at_an_end():
    """The exact y is that of a cycle solved at 1e-11, with an error of 1e-11."""
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4)
    start = 37.6559805453 * (1 + 1e-4)
    (curve,) = solve_branches(rod, BranchRequest("F", start, 40.0, 1e-5, True, 100, 10)).curves
    end = curve.special_points[0]
    assert abs(end.tip_y_max / 0.00756562544604389 - 1) <= end.tip_y_max_error < 1e-5


def test_cycles_on_another_mesh_show_the_deviation_from_the_normal_form_at_an_end():
    """Before the last cycle the mesh changes: on its mesh alone the largest y had an error of 3e-5."""
    rod = Rod(F=0.0, k1=295.8168, k2=177.39654, gamma3=0.02556)
    (hopf, *_) = find_imaginary_axis_crossings(ParameterPath(rod, "F"), 0.0, 60.0).thresholds
    start = hopf.value * (1 + 1.3e-5)
    exact, end = (
        solve_branches(rod, BranchRequest("F", start, 1.06 * start, a, False, 100, 10))
        .curves[0]
        .special_points[0]
        for a in (1e-8, 1e-5)
    )
    assert abs(end.tip_y_max / exact.tip_y_max - 1) <= end.tip_y_max_error < 1e-5


@pytest.mark.parametrize("distance", [1e-5, 3e-6, 1e-6])
@pytest.mark.parametrize("accuracy", [1e-4, 1e-5, 1e-6])
def test_the_normal_form_gives_the_cycle_at_an_end_next_to_the_hopf_point(distance, accuracy):
    """Its errors fall with the distance: the cycles before the end show them, free of the errors of a mesh,
    which grow towards the Hopf point."""
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4)
    (hopf,) = find_imaginary_axis_crossings(ParameterPath(rod, "F"), 0.0, 40.0).thresholds
    start = hopf.value * (1 + distance)
    exact, end = (
        solve_branches(rod, BranchRequest("F", start, 40.0, a, True, 100, 10)).curves[0].special_points[0]
        for a in (1e-10, accuracy)
    )
    assert exact.tip_y_max_error < 2e-8
    assert (
        abs(end.tip_y_max / exact.tip_y_max - 1) <= end.tip_y_max_error < distance * (0.5 + accuracy / 2e-5)
    )
    assert abs(end.period / exact.period - 1) <= end.period_error < 0.01 * accuracy


@pytest.mark.long
def test_a_branch_passes_the_drag_below_which_omega_is_an_unknown():
    """Along the taper of a rod with gamma3 = 1e-4 the rotational drag of the tip is 1e-5 at 0.316."""
    rod = Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4)
    whole = solve_branches(rod, BranchRequest("taper", 0.25, 0.45, 1e-5, True, 100, 10))
    assert whole.status == BranchStatus.ok
    (curve,) = whole.curves
    assert curve.special_points[-1].end_reason == BranchEndReason.range_end
    assert min(point.parameter_value for point in curve.stored_cycles) == pytest.approx(0.25, rel=1e-9)


def test_a_branch_along_the_taper_ends_where_the_force_crushes_the_tip():
    """The sensitivity of the last cycle was measured by a step towards crushing, where there is no rod: the
    branch had the status stopped. The tip is crushed at taper = sqrt(F/k1), less the margin 1e-4 of F."""
    found = solve_branches(
        Rod(F=20.0, k1=200.0, k2=1e4, gamma3=1e-4), BranchRequest("taper", 0.26, 0.6, 1e-5, False, 500, 50)
    )
    assert found.status == BranchStatus.ok
    end = found.curves[0].special_points[-1]
    assert (end.kind, end.end_reason) == (SpecialPointKind.end, BranchEndReason.crushed)
    assert end.parameter_value == pytest.approx((0.1 / (1 - 1e-4)) ** 0.5, rel=1e-6)


@pytest.mark.long
def test_cycles_are_the_same_whether_omega_is_an_unknown_or_eliminated():
    path = ParameterPath(Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.33), "taper")
    (crossing,) = find_imaginary_axis_crossings(path, 0.33, 0.45).thresholds
    ends = []
    for is_omega_always_unknown in (False, True):
        hopf = hopf_branch_start(path, crossing, is_omega_always_unknown)
        reasons = (BranchEndReason.range_end,) * 2
        limits = BranchLimits([hopf], (0.33, 0.45), reasons, 1e-6, 100, NewtonWorkspace())
        last = follow_branch_from_hopf_point(0, limits).special_points[-1]
        assert last.end_reason == BranchEndReason.range_end
        ends.append(last)
    one, other = ends
    assert abs(one.period - other.period) <= one.period_error + other.period_error < 1e-6
    assert abs(one.tip_y_max - other.tip_y_max) <= one.tip_y_max_error + other.tip_y_max_error < 1e-5


@pytest.mark.long
@pytest.mark.parametrize("stop", [1e9, 1e14, 1e300])
def test_a_branch_along_a_stiffness_ends_almost_at_infinity(stop):
    """Steps beyond the end of the range reached negative compliances: "stopped" at k1 = -6e9."""
    rod = Rod(F=40.0, k1=1e4, k2=255.4, gamma3=7.3e-4, gamma1=0.654)
    ends = []
    for end in (1e5, 2e5, stop):
        found = solve_branches(rod, BranchRequest("k1", 50.0, end, 1e-6, False, 100, 10))
        assert found.status == BranchStatus.ok
        (curve,) = found.curves
        ends.append(curve.special_points[-1])
        assert ends[-1].end_reason == BranchEndReason.range_end
        assert curve.stored_cycles[-1].parameter_value == pytest.approx(end, rel=1e-12)
    # Linear in 1/k1: from 1e5 to infinity y changes by 1e-3, so that squares are 1e-6.
    y = [end.tip_y_max for end in ends]
    assert y[2] == pytest.approx(2 * y[1] - y[0], rel=1e-5)


@pytest.mark.long
def test_a_branch_of_a_cone_begins_at_almost_infinite_stiffness():
    """Differences between determinants of neighbouring arms took negative compliances: a traceback."""
    rod = Rod(F=80.0, k1=1e5, k2=11.94, gamma3=6.7e-4, gamma1=0.337, taper=0.5)
    found = solve_branches(rod, BranchRequest("k1", 8704.0, 1e300, 1e-6, False, 100, 10))
    assert found.status == BranchStatus.ok


def test_a_branch_along_the_rotational_drag_ends_at_zero():
    """No rod has a negative drag, so that no step passes this end of the range."""
    rod = Rod(
        F=7.31, k1=23.9, k2=1.37, gamma3=0.0, gamma1=0.21, material=RodMaterial("neo_hookean", "swelling")
    )
    ends = []
    for accuracy in (1e-4, 1e-6):
        found = solve_branches(rod, BranchRequest("gamma3", 0.0, 5.3, accuracy, False, 100, 10))
        assert found.status == BranchStatus.ok
        (curve,) = found.curves
        assert curve.special_points[-1].end_reason == BranchEndReason.range_end
        assert curve.stored_cycles[-1].parameter_value == 0.0
        ends.append(curve.special_points[-1])
    rough, fine = ends
    assert abs(rough.period - fine.period) <= rough.period_error + fine.period_error < 1e-4
    assert abs(rough.tip_y_max - fine.tip_y_max) <= rough.tip_y_max_error + fine.tip_y_max_error < 1e-4


@pytest.mark.parametrize("distance", [5e-4, 1e-5, 1e-7])
def test_a_range_that_stops_before_the_first_cycle_ends_with_the_cycle_there(distance):
    """The first cycle that is solved has y = 0.02 L, at a relative distance of 7e-4 from the Hopf point."""
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4)
    (hopf,) = find_imaginary_axis_crossings(ParameterPath(rod, "F"), 0.0, 40.0).thresholds
    value = hopf.value * (1 + distance)
    found = branches_to(value, rod)
    (curve,) = found.curves
    beyond = solve_branches(rod, BranchRequest("F", value, 40.0, 1e-9, True, 100, 10))
    end, exact = curve.special_points[-1], beyond.curves[0].special_points[0]
    assert found.status == BranchStatus.ok and not curve.stored_cycles
    assert (end.kind, end.end_reason) == (SpecialPointKind.end, BranchEndReason.range_end)
    assert end.parameter_value == pytest.approx(value, rel=1e-13)
    period_error = end.period_error + exact.period_error
    assert abs(end.period / exact.period - 1) <= period_error < 1e-5
    tip_y_max_error = end.tip_y_max_error + exact.tip_y_max_error
    assert abs(end.tip_y_max / exact.tip_y_max - 1) <= tip_y_max_error < 1e-3


@pytest.mark.long
def test_a_branch_without_symmetry_ends_at_the_end_of_the_range_before_its_first_cycle():
    rod = Rod(F=0.0, k1=30.0, k2=0.5, gamma3=0.1)
    start = 19.9027  # the symmetry breaks at 19.902805
    curves = solve_branches(rod, BranchRequest("F", start, 19.91, 1e-5, False, 500, 50)).curves
    (curve,) = (one for one in curves if one.start_breaking is not None and not one.stored_cycles)
    breaking, end = curve.special_points
    assert end.parameter_value == pytest.approx(start, rel=1e-13)
    assert end.period == breaking.period and 1e-6 < end.period_error < 1e-2
