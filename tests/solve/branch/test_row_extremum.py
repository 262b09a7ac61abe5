"""Curves of folds through extrema of the row parameter, where both parameters exchange their roles.

With k2 = 1e4, gamma3 = 0.006 the folds have their smallest k1 at F = 79.004, where a closed branch of cycles
shrinks to one cycle, and a largest k1 at F = 118.458.
"""

from dataclasses import replace

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.determinant.parameter_plane import PlaneAxis
from rodsweep.model.rod import Rod
from rodsweep.solve.branch.branch_limits import BranchLimits, BranchRequest
from rodsweep.solve.branch.branch_search import BranchSearch
from rodsweep.solve.branch.branches import solve_branches
from rodsweep.solve.branch.coexistence import row_branches, special_points_of
from rodsweep.solve.branch.special import parameter_roles, row_extremum
from rodsweep.solve.branch.special.curve_problem import SpecialCurveProblem
from rodsweep.solve.branch.special.half_curve import trace_half_curve
from rodsweep.solve.branch.special.parameter_roles import ParameterRoles
from rodsweep.solve.branch.special.row_crossing import RowCrossing
from rodsweep.solve.branch.special.special_curves import CurveEndReason
from rodsweep.solve.branch.special.special_point import RowSpecialPoint, SpecialPointKind
from rodsweep.solve.branch.status import BranchEndReason, BranchStatus
from rodsweep.solve.changes.diagram.rows import RowRequest
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.unsolvable import Unsolvable

ROD = Rod(F=60.0, k1=133.3, k2=1e4, gamma3=0.006)
AXES = PlaneAxis("F", 50.0, 120.0), PlaneAxis("k1", 132.0, 136.0)
REQUEST = RowRequest("F", np.array([50.0, 120.0]), 1e-10, True, 16, max_special_points=64)
SMALLEST = 79.0040695, 133.01451425
"""F and k1 at the smallest closed branch, by folds of branches along k1 at five forces."""


def folds_of(rod, starts=()):
    found = special_points_of(row_branches(rod, REQUEST, starts=starts))
    return [point for point in found if point.kind == SpecialPointKind.fold]


def followed(special, row, direction, axes=AXES):
    problem = SpecialCurveProblem(SpecialPointKind.fold, *axes, NewtonWorkspace(), direction)
    return problem.follow_from(special, row)


def extrema_of(points):
    return [point for point in points if point.row_parameter_error_at_extremum]


@pytest.fixture(scope="module")
def fold():
    """The fold of the branches at k1 = 133.3."""
    (fold,) = folds_of(ROD)
    return fold


@pytest.fixture(scope="module")
def points(fold):
    """The curve of folds from k1 = 133.3 to smaller k1, through its smallest k1."""
    points, end = followed(fold, ROD.k1, -1.0)
    assert end is CurveEndReason.hopf
    return points


@pytest.mark.long
def test_a_curve_of_folds_passes_the_smallest_closed_branch(points):
    (extremum,) = extrema_of(points)
    assert extremum.row_parameter_value == min(point.row_parameter_value for point in points)
    assert extremum.branch_parameter_value == pytest.approx(
        SMALLEST[0], abs=extremum.branch_parameter_error + 1e-7
    )
    assert extremum.row_parameter_value == pytest.approx(
        SMALLEST[1], abs=extremum.row_parameter_error_at_extremum
    )
    assert extremum.branch_parameter_error <= 1e-7 * SMALLEST[0]
    assert extremum.row_parameter_error_at_extremum <= 1e-8 * SMALLEST[1]
    # The curve is regular there: its points lie on both sides, in order.
    forces = [point.branch_parameter_value for point in points]
    assert forces == sorted(forces, reverse=True)
    assert forces[0] > 90 > SMALLEST[0] > 75 > forces[-1]
    assert all(point.scale.parameter_name == "F" for point in points)


@pytest.mark.long
def test_the_extremum_is_that_of_folds_along_the_row_parameter():
    forces = np.array([78.4, 78.8, 79.0, 79.2, 79.6])
    along = rs.sweep(
        "branch", along="k1", F=forces, k2=1e4, gamma3=0.006, gamma1=1, start=133, stop=133.6, progress=False
    )
    kinds, at = (along[name].values.reshape(len(forces), -1) for name in ("special_kind", "special_at"))
    folds = [values[kind == SpecialPointKind.fold].item() for kind, values in zip(kinds, at, strict=True)]
    fit = np.polynomial.Polynomial.fit(forces, folds, 4)
    vertex = min(fit.deriv().roots(), key=lambda F: abs(F - 79)).real
    assert (vertex, fit(vertex)) == pytest.approx(SMALLEST, abs=1e-7)


@pytest.mark.long
def test_folds_near_the_extremum_are_those_of_branches_along_the_row(points):
    near = [point for point in points if 133.015 < point.row_parameter_value < 133.1]
    assert {point.branch_parameter_value > SMALLEST[0] for point in near} == {True, False}
    assert len(near) > 5
    for point in near:
        crossing = RowCrossing.from_solved_point(
            0, SpecialPointKind.fold, point, point.branch_parameter_error
        )
        folds = folds_of(replace(ROD, k1=point.row_parameter_value), [crossing.special_point])
        distance = min(abs(fold.parameter_value - point.branch_parameter_value) for fold in folds)
        assert distance <= min(point.branch_parameter_error, 1e-7 * point.branch_parameter_value)


@pytest.mark.long
def test_a_curve_begins_near_an_extremum_in_both_directions(points):
    extremum = extrema_of(points)[0]
    row = extremum.row_parameter_value + 6e-4
    problem = SpecialCurveProblem(SpecialPointKind.fold, *AXES, NewtonWorkspace(), 1.0)
    beyond = next(
        p
        for p in points
        if p.branch_parameter_value < extremum.branch_parameter_value and p.row_parameter_value > row
    )
    before = points[points.index(beyond) - 1]
    crossing = problem.point_on_row(before, beyond, AXES[1].scaled_coordinate(row))
    start = RowCrossing.from_solved_point(0, SpecialPointKind.fold, crossing, 1e-4).special_point
    low, high = sorted(folds_of(replace(ROD, k1=row), [start]), key=lambda fold: fold.parameter_value)
    assert low.parameter_value == pytest.approx(crossing.branch_parameter_value, abs=1e-4)
    for axes in (
        AXES,
        (AXES[0], PlaneAxis("k1", 136.0, 132.0)),
        (AXES[0], PlaneAxis("k1", 132.0, 180.0, True)),
    ):
        for special, leads_over in ((low, -1.0), (high, -1.0)):
            for direction in (1.0, -1.0):
                # `direction` belongs to the row coordinate, which may decrease with k1.
                rises = np.sign(axes[1].stop - axes[1].start)
                curve, _ = followed(special, row, direction * rises, axes)
                at = [round(point.branch_parameter_value, 5) for point in extrema_of(curve)]
                assert (79.00407 in at) == (direction == leads_over)
                assert (118.45785 in at) == ((special is low) == (direction == leads_over))


@pytest.mark.long
@pytest.mark.parametrize("distance", [2e-4, 1e-4, 1e-5])
def test_a_tiny_closed_branch_is_followed(points, distance):
    """Its extent grows with the square root of the distance of its row from the smallest one, which a mesh
    displaces by more than this distance."""
    index = points.index(extrema_of(points)[0])
    row = points[index].row_parameter_value + distance
    problem = SpecialCurveProblem(SpecialPointKind.fold, *AXES, NewtonWorkspace(), 1.0)
    ends = points[index - 1 : index + 1], points[index : index + 2]
    crossings = [problem.point_on_row(*pair, AXES[1].scaled_coordinate(row)) for pair in ends]
    starts = [
        RowCrossing.from_solved_point(0, SpecialPointKind.fold, c, 1e-4).special_point for c in crossings
    ]
    found = row_branches(replace(ROD, k1=row), REQUEST, starts=starts)
    (curve,) = found.curves
    assert (found.status, curve.is_closed) == (BranchStatus.ok, True)
    low, high = sorted(fold.parameter_value for fold in special_points_of(found))
    # k1 = 133.0155 has folds at F = 78.339 and 79.679, from the curve and from its branch.
    assert (high - low) / distance**0.5 == pytest.approx(42.1, rel=5e-3)
    assert (low + high) / 2 == pytest.approx(SMALLEST[0], abs=3 * distance**0.5 * 0.1)


@pytest.mark.long
@pytest.mark.parametrize(
    ("row", "kinds", "heights"),
    [
        (134.165, ["hopf", "fold", "hopf"], ()),
        (134.1725, ["hopf", "fold", "hopf"], ()),
        (134.1735, ["hopf", "end"], (0.18574, 0.14259)),
        (134.18, ["hopf", "end"], (0.18587, 0.14249)),
    ],
)
def test_no_step_leads_from_one_branch_to_another_that_nearly_touches_it(row, kinds, heights):
    """At k1 = 134.172932 two branches touch at F = 118.458; the larger cycles are stable."""
    rod = replace(ROD, k1=row)
    found = solve_branches(rod, BranchRequest("F", 50.0, 130.0, 1e-4, False, 500, 64))
    assert (found.status, found.message) == (BranchStatus.ok, "")
    assert all([point.kind.name for point in curve.special_points] == kinds for curve in found.curves)
    if heights:
        ends = [curve.special_points[-1].tip_y_max for curve in found.curves]
        assert ends == pytest.approx(heights, abs=1e-4)
        assert [curve.stored_cycles[-1].unstable_count for curve in found.curves] == [0, 1]
        return
    (fold,) = [point for point in special_points_of(found) if point.kind == SpecialPointKind.fold]
    # The same fold on the branch along k1.
    along = BranchRequest("k1", 133.9, 134.3, 1e-6, False, 500, 64)
    across = solve_branches(replace(rod, F=fold.parameter_value), along, starts=[fold])
    (same,) = [point for point in special_points_of(across) if point.kind == SpecialPointKind.fold]
    assert same.parameter_value == pytest.approx(row, abs=1e-7)


@pytest.mark.long
def test_two_branches_with_one_cycle_at_the_end_of_the_range_are_a_failure():
    found = solve_branches(replace(ROD, k1=134.18), BranchRequest("F", 120.0, 130.0, 1e-4, False, 500, 64))
    first, second = found.curves
    limits = BranchLimits([], (120.0, 130.0), (BranchEndReason.range_end,) * 2, 1e-4, 500, NewtonWorkspace())
    for curves, count in (([first, second], 0), ([first, second, first], 2)):
        search = BranchSearch(limits, "F", curves=curves)
        search._add_messages_on_shared_range_ends()
        assert len(search.failures) == count
    assert search.failures[-1] == "branches 1 and 3 have the same cycle at F = 130: two branches nearly touch"


@pytest.mark.long
def test_a_row_near_an_extremum_is_crossed_twice(fold):
    stored = RowSpecialPoint(
        row_index=0,
        row_parameter_value=ROD.k1,
        kind=fold.kind,
        parameter_value=fold.parameter_value,
        period=fold.period,
        tip_y_max=fold.tip_y_max,
    )
    problem = SpecialCurveProblem(SpecialPointKind.fold, *AXES, NewtonWorkspace(), -1.0)
    half = trace_half_curve(problem, stored, [fold], [stored], {1: 133.0155, 2: 133.0145})
    assert half.distances_along_row == {0: pytest.approx(0, abs=1e-6)}
    assert [crossing.row_index for crossing in half.crossings] == [1, 1]
    starts = [crossing.special_point for crossing in half.crossings]
    folds = sorted(point.parameter_value for point in folds_of(replace(ROD, k1=133.0155), starts))
    assert len(folds) == 2
    for start, same in zip(starts, folds[::-1], strict=True):
        assert start.parameter_value == pytest.approx(same, abs=min(start.error, 1e-4))


@pytest.mark.long
def test_an_extremum_that_is_not_located_is_left_out(fold, points, monkeypatch):
    def fail(*_):
        raise Unsolvable("no point")

    monkeypatch.setattr(row_extremum, "_located_extremum", fail)
    others, end = followed(fold, ROD.k1, -1.0)
    assert end is CurveEndReason.hopf
    extremum = extrema_of(points)[0]
    kept = [point for point in points if point is not extremum]
    assert [point.branch_parameter_value for point in others] == [
        point.branch_parameter_value for point in kept
    ]
    (marked,) = [i for i, point in enumerate(others) if np.isnan(point.row_parameter_error_at_extremum)]
    assert (
        others[marked - 1].branch_parameter_value
        > extremum.branch_parameter_value
        > others[marked].branch_parameter_value
    )


@pytest.mark.long
def test_without_the_exchange_of_roles_the_curve_is_lost(fold, monkeypatch):
    """What the exchange is for; from k1 = 134 on, with the steps of this curve."""
    start = folds_of(replace(ROD, k1=134.0))[0]
    settings = replace(parameter_roles.PARAMETER_ROLE_SETTINGS, max_row_parameter_slope_to_exchange=0.0)
    monkeypatch.setattr(parameter_roles, "PARAMETER_ROLE_SETTINGS", settings)
    monkeypatch.setattr(ParameterRoles, "need_exchange_beyond", lambda *_: False)
    points, end = followed(start, 134.0, -1.0)
    assert end is CurveEndReason.not_followed
    assert points[-1].row_parameter_value == pytest.approx(133.0146, abs=1e-4)


def test_curves_of_torus_points_never_exchange_the_roles():
    roles = ParameterRoles(SpecialPointKind.torus, *AXES)
    assert not roles._is_row_parameter_almost_constant(ROD, 1.0, 0.0)
    assert ParameterRoles(SpecialPointKind.fold, *AXES)._is_row_parameter_almost_constant(ROD, 1.0, 0.0)
