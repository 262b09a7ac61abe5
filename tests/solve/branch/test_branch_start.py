"""First cycles of branches: folds close to the point where a branch begins or ends."""

from dataclasses import replace

import numpy as np
import pytest

from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branch_continuation import follow_asymmetric_branch, follow_branch_from_hopf_point
from rodsweep.solve.branch.branch_limits import BranchLimits, BranchRequest
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.special.special_point import SpecialPointKind
from rodsweep.solve.branch.start.hopf_point import hopf_branch_start
from rodsweep.solve.branch.status import BranchEndReason, BranchStatus
from rodsweep.solve.branch.symmetry_breaking import symmetry_breakings_in
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace


@pytest.mark.long
def test_a_fold_close_to_the_birth_of_a_branch_is_found():
    """The cycles without symmetry are born subcritically, and turn back 3e-6 below the symmetry breaking.
    F of the fold by the branch at the accuracy 1e-8, with an error of 2e-11."""
    straight = Rod(F=0.0, k1=30.0, k2=0.61, gamma3=0.1)
    path = ParameterPath(straight, "F")
    hopf = hopf_branch_start(path, find_imaginary_axis_crossings(path, 0.0, 5.0).thresholds[0])
    limits = BranchLimits([hopf], (0.0, 21.8), (BranchEndReason.range_end,) * 2, 1e-3, 500, NewtonWorkspace())
    known = replace(
        limits, breakings=symmetry_breakings_in([follow_branch_from_hopf_point(0, limits).special_points])
    )
    curve = follow_asymmetric_branch(0, "F", known)
    assert [point.kind.name for point in curve.special_points] == ["symmetry_breaking", "fold", "end"]
    fold = curve.special_points[1]
    assert abs(fold.parameter_value - 21.72716581562) <= fold.error < 1e-7
    assert curve.special_points[0].parameter_value - fold.parameter_value == pytest.approx(2.87e-6, rel=0.05)


NEAR_HOPF_POINTS = {
    "1e-6": (
        Rod(F=0.0, k1=133.072, k2=1e4, gamma3=0.006),
        (60.0, 86.0),
        1e-6,
        [74.208181684, 84.358686271],
    ),
    "1e-5": (
        Rod(F=0.0, k1=134.5294704184161, k2=11174.024843, gamma3=0.00541206904868, gamma1=0.86337382),
        (20.0, 130.0),
        1e-5,
        [74.624718195, 78.387323836],
    ),
}
"""Rod, range of F, accuracy, and F of the folds of the branch between the two Hopf points, at ten times the
accuracy."""


@pytest.mark.long
@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize(
    ("rod", "ends", "accuracy", "folds"), NEAR_HOPF_POINTS.values(), ids=NEAR_HOPF_POINTS
)
def test_a_branch_between_two_near_hopf_points_ends_at_the_other_one(rod, ends, accuracy, folds, start):
    """The small cycles of both Hopf points are almost alike, so that a long step leads from one part of the
    branch to the other; and behind its first fold the parabola through a cycle misses the Hopf point at
    first. Steps of these accuracies once met both."""
    path = ParameterPath(rod, "F")
    crossings = find_imaginary_axis_crossings(path, *ends).thresholds
    hopfs = [hopf_branch_start(path, crossing) for crossing in crossings]
    unit = 0.01 * (ends[1] - ends[0])
    reasons = (BranchEndReason.range_end,) * 2
    limits = BranchLimits(hopfs, ends, reasons, accuracy, 500, NewtonWorkspace(), unit)
    curve = follow_branch_from_hopf_point(start, limits)
    assert (curve.is_complete, curve.start_hopf_index, curve.end_hopf_index) == (True, start, 1 - start)
    found = [point.parameter_value for point in curve.special_points[1:-1]]
    assert sorted(found) == pytest.approx(folds, rel=1e-8)


def test_a_tiny_branch_between_two_coalescing_hopf_points_is_an_ellipse():
    """At k1 within 2e-7 of the fold of the Hopf curve, relatively, the cycles between the two Hopf points p1
    and p2 have y^2 = |s/Re c| (p - p1) (p2 - p)/(p2 - p1), with the slope s and Re c of the normal form; a
    first cycle of fixed amplitude, 0.003, does not exist there."""
    path = ParameterPath(Rod(F=60.0, k1=147.9215493, k2=1e4, gamma3=1e-4), "F")
    crossings = find_imaginary_axis_crossings(path, 60.0, 100.0).thresholds
    first, second = (hopf_branch_start(path, crossing) for crossing in crossings)
    limits = BranchLimits(
        [first, second], (60.0, 100.0), (BranchEndReason.range_end,) * 2, 1e-6, 500, NewtonWorkspace()
    )
    curve = follow_branch_from_hopf_point(0, limits)
    assert [point.kind.name for point in curve.special_points] == ["hopf", "hopf"]
    assert (curve.start_hopf_index, curve.end_hopf_index) == (0, 1)
    F = np.array([point.parameter_value for point in curve.stored_cycles])
    y = np.array([point.measures.tip_y_max for point in curve.stored_cycles])
    p1, p2 = first.parameter_coordinate, second.parameter_coordinate
    ratios = [
        abs(hopf.eigenvalue_slope_by_coordinate.real / hopf.normal_form_coefficients.landau.real)
        for hopf in (first, second)
    ]
    ellipse = np.interp(F, [p1, p2], ratios) * (F - p1) * (p2 - F) / (p2 - p1)
    # The ratios at both ends differ by 6e-3; their curvature and the next order, y^2, are below 1e-5.
    assert y**2 == pytest.approx(ellipse, rel=1e-4)


@pytest.mark.parametrize("start", [0, 1])
def test_a_branch_that_returns_between_two_coalescing_hopf_points_ends_at_the_other_one(start):
    """At k1 within 1e-9 of the fold of the Hopf curve, relatively, cycles of y = 4e-4 are not yet those of
    one Hopf point alone: the parabola through one of them missed its Hopf point."""
    path = ParameterPath(Rod(F=70.0, k1=133.06804800284598, k2=1e4, gamma3=0.006), "F")
    crossings = find_imaginary_axis_crossings(path, 70.0, 86.0).thresholds
    hopfs = [hopf_branch_start(path, crossing) for crossing in crossings]
    limits = BranchLimits(
        hopfs, (70.0, 86.0), (BranchEndReason.range_end,) * 2, 1e-6, 500, NewtonWorkspace(), 0.16
    )
    curve = follow_branch_from_hopf_point(start, limits)
    assert (curve.is_complete, curve.start_hopf_index, curve.end_hopf_index) == (True, start, 1 - start)


@pytest.mark.long
@pytest.mark.parametrize("accuracy", [1e-2, 1e-3])
def test_cycles_of_low_accuracy_are_not_the_symmetric_cycles_nearby(accuracy):
    """F of the fold by the branch at the accuracy 1e-8; collocation in strains with Radau steps finds the
    same cycles."""
    rod = Rod(F=0.0, k1=13.7, k2=0.113, gamma3=0.431, gamma1=2.3)
    found = solve_branches(rod, BranchRequest("F", 0.0, 9.7, accuracy, True, 500, 50))
    curve = found.curves[-1]
    assert [point.kind.name for point in curve.special_points] == ["symmetry_breaking", "fold", "end"]
    fold = curve.special_points[1]
    assert abs(fold.parameter_value - 7.9124780687) <= fold.error + 1e-9 < 1e-6
    assert all(abs(p.measures.tip_y_max / p.measures.tip_y_min + 1) > 1e-2 for p in curve.stored_cycles)


@pytest.mark.long
@pytest.mark.parametrize("accuracy", [1e-2, 1e-6])
@pytest.mark.parametrize(
    "rod, stop, F",
    [
        (Rod(F=0.0, k1=104.055, k2=1e4, gamma3=0.1), 45.0, 41.25649642772),
        (Rod(F=0.0, k1=149.618, k2=1e4, gamma3=1e-4), 149.0, 84.48191505790),
    ],
    ids=["begins", "ends"],
)
def test_a_fold_close_to_a_hopf_point_is_found_beside_a_generalised_hopf_point(rod, stop, F, accuracy):
    """Close to the generalised Hopf points at k1 = 104.05793 and 149.61689. Folds by branches at 1e-8; an own
    collocation code finds one fold of the first rod near its largest y of 0.0054."""
    found = solve_branches(rod, BranchRequest("F", 0.0, stop, accuracy, True, 500, 50))
    folds = [point for point in found.curves[0].special_points if point.kind == SpecialPointKind.fold]
    assert found.status == BranchStatus.ok
    assert len(folds) == 1
    assert abs(folds[0].parameter_value - F) <= folds[0].error + 1e-10 < 1e-8
