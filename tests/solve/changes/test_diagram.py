"""Curves through folds against known ones, and rows and curves against each other."""

import re
from dataclasses import replace
from math import inf, log

import numpy as np
import pytest

from rodsweep.determinant.certificate.winding_number import count_right_of
from rodsweep.determinant.parameter_plane import ParameterPlane, PlaneAxis
from rodsweep.determinant.stability_boundary import StabilityBoundary
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.diagram import boundary_curves
from rodsweep.solve.changes.diagram.boundaries import boundary_curves_through, seed_of
from rodsweep.solve.changes.diagram.boundary_curves import trace_boundary
from rodsweep.solve.changes.diagram.boundary_problem import BoundaryEndReason
from rodsweep.solve.changes.diagram.rows import RowRequest, StabilityClass, solve_row
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import ThresholdKind

FOLDS = [
    # k2, gamma3, k1, F, frequency: 30-digit roots of D = 0 and of the vanishing Jacobian
    (1e4, 1e-4, 147.921519683199662, 75.3972626336484526, 770.860809443855688),
    (1e3, 1e-3, 125.348273522142548, 76.4344208786000375, 856.287128113415467),
    (inf, 0.0, 150.781723361274312, 75.3908616806371558, 765.034543061012451),
]


def rows(plane_axes, rod, count):
    """Rows along the first axis at `count` values of the second, and the seeds on them."""
    along, across = plane_axes
    found, seeds = [], []
    for y in np.linspace(0, 1, count):
        value = across.value(float(y))
        request = RowRequest(along.parameter_name, np.linspace(along.start, along.stop, 41), 1e-9, True, 50)
        row = solve_row(replace(rod, **{across.parameter_name: value}), request)
        assert row.status == ThresholdStatus.ok, row.message
        found.append(row)
        seeds += [
            seed_of((c.value, value), c.kind, c.frequency, c.growth_rate) for c in row.thresholds.thresholds
        ]
    return found, seeds


@pytest.mark.parametrize(("k2", "gamma3", "k1", "F", "frequency"), FOLDS)
def test_the_flutter_window_closes_at_the_fold_to_nine_digits(k2, gamma3, k1, F, frequency):
    plane = ParameterPlane(
        Rod(F=0.0, k1=200.0, k2=k2, gamma3=gamma3),
        (PlaneAxis("F", 0.0, 119.0), PlaneAxis("k1", 120.0, 1000.0, is_logarithmic=True)),
    )
    row = solve_row(
        Rod(F=0.0, k1=300.0, k2=k2, gamma3=gamma3), RowRequest("F", np.array([0.0, 119.0]), 1e-9, True, 9)
    )
    hopf = next(c for c in row.thresholds.thresholds if c.kind == ThresholdKind.hopf)
    curve = trace_boundary(
        0.0,
        plane,
        (plane.axes[0].scaled_coordinate(hopf.value), plane.axes[1].scaled_coordinate(300.0)),
        hopf.frequency,
    )
    (fold,) = [f for f in curve.folds if f.axis == 1]
    assert fold.parameter_values[1] == pytest.approx(k1, rel=1e-12)
    assert fold.parameter_values[0] == pytest.approx(F, rel=1e-10)
    assert fold.frequency == pytest.approx(frequency, rel=1e-9)
    assert abs(fold.parameter_values[1] - k1) <= 10 * fold.parameter_errors[1]
    assert abs(fold.parameter_values[0] - F) <= fold.parameter_errors[0] <= 1e-8


def test_the_hopf_curve_of_the_partial_beam_is_the_parabola_of_the_paper():
    """F (1 - F/k1) = Fc with k2 = inf, gamma3 = 0 (Sec. VIII), all along the curve and through its fold."""
    Fc = 37.6954308403185779
    plane = ParameterPlane(
        Rod(F=0.0, k1=200.0, k2=inf, gamma3=0.0), (PlaneAxis("F", 0.0, 140.0), PlaneAxis("k1", 145.0, 400.0))
    )
    start = 200.0 * (0.5 - np.sqrt(0.25 - Fc / 200.0))
    curve = trace_boundary(
        0.0, plane, (plane.axes[0].scaled_coordinate(start), plane.axes[1].scaled_coordinate(200.0)), 341.801
    )
    F, k1 = curve.parameter_values.T
    assert len(F) > 30
    assert np.abs(F * (1 - F / k1) - Fc).max() < 1e-11
    assert F.min() < 42.2
    assert F.max() == pytest.approx(140.0, rel=1e-12)


def test_rows_and_curves_agree_and_every_change_lies_on_a_curve():
    axes = (PlaneAxis("F", 0.0, 99.0), PlaneAxis("k1", 100.0, 1000.0, is_logarithmic=True))
    rod = Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4)
    _, seeds = rows(axes, rod, 12)
    curves = boundary_curves_through(ParameterPlane(rod, axes), seeds)
    assert curves.untraced_seed_count == 0
    assert curves.max_seed_distance_per_row_length < 1e-11
    assert sum(c.consists_of_hopf_points for c in curves.curves) == 1
    for curve in curves.curves:
        inside = (np.diff(curve.scaled_points[:, :2], axis=0) ** 2).sum(axis=1)
        assert np.sqrt(inside).max() < 0.05


def test_a_plane_of_two_material_parameters():
    """k2 against gamma3 at fixed force: rows along k2, curves through both, counts on either side."""
    axes = (
        PlaneAxis("k2", 20.0, 1e5, is_logarithmic=True),
        PlaneAxis("gamma3", 1e-4, 0.1, is_logarithmic=True),
    )
    rod = Rod(F=30.0, k1=1e4, k2=1e3, gamma3=1e-3)
    found, seeds = rows(axes, rod, 6)
    curves = boundary_curves_through(ParameterPlane(rod, axes), seeds)
    assert seeds
    assert (curves.untraced_seed_count, curves.max_seed_distance_per_row_length < 1e-11) == (0, True)
    values = np.linspace(20.0, 1e5, 41)
    gamma3 = axes[1].value(0.4)
    for k2, motion, unstable in zip(values, found[2].stability_class, found[2].unstable_count, strict=True):
        assert count_right_of(0.0, Rod(F=30.0, k1=1e4, k2=float(k2), gamma3=gamma3)).number == unstable
        assert (motion == StabilityClass.flutter) == (unstable > 0)


ENDS = [
    # double eigenvalues and Hopf points that end on gamma3 = 0, where no rod lies beyond
    (
        (PlaneAxis("F", 0.0, 150.0), PlaneAxis("gamma3", 0.0, 0.25)),
        Rod(F=0.0, k1=327.0, k2=4502.0, gamma3=1e-3),
        {(BoundaryEndReason.edge, BoundaryEndReason.edge)},
    ),
    # Hopf points that come as close to F = k1 as steps can be short
    (
        (PlaneAxis("F", 0.0, 239.0), PlaneAxis("k1", 183.0, 3e3, is_logarithmic=True)),
        Rod(F=0.0, k1=1e3, k2=33.0, gamma3=2.7e-3),
        {
            (BoundaryEndReason.edge, BoundaryEndReason.edge),
            (BoundaryEndReason.crushed, BoundaryEndReason.edge),
        },
    ),
]


@pytest.mark.parametrize(("axes", "rod", "ends"), ENDS)
def test_a_curve_says_where_it_ends(axes, rod, ends, monkeypatch):
    _, seeds = rows(axes, rod, 3)
    curves = boundary_curves_through(ParameterPlane(rod, axes), seeds).curves
    assert {curve.end_reasons for curve in curves} == ends
    for curve in curves:
        for (x, y, _), (F, other), end in zip(
            curve.scaled_points[[0, -1]], curve.parameter_values[[0, -1]], curve.end_reasons, strict=True
        ):
            beside_an_edge = min(x, 1 - x, y, 1 - y) < 1e-9
            assert beside_an_edge if end == BoundaryEndReason.edge else pytest.approx(other, rel=1e-7) == F
    few = replace(boundary_curves.BOUNDARY_STEP_CONTROL, max_solutions=5)
    monkeypatch.setattr(boundary_curves, "BOUNDARY_STEP_CONTROL", few)
    curve = boundary_curves_through(ParameterPlane(rod, axes), seeds[:1]).curves[0]
    assert BoundaryEndReason.list_full in curve.end_reasons
    assert len(curve.parameter_values) < 10


TOUCHED = [
    # double eigenvalues at gamma3 = 0, where differences are one-sided, and Hopf points
    ((PlaneAxis("F", 5.0, 60.0), PlaneAxis("gamma3", 0.0, 1.0)), Rod(F=30.0, k1=1e4, k2=20.0, gamma3=0.01)),
    # double eigenvalues beside a crushed rod
    (
        (PlaneAxis("F", 0.0, 99.999), PlaneAxis("k1", 100.0, 1e3, is_logarithmic=True)),
        Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4),
    ),
    (
        (
            PlaneAxis("k2", 20.0, 1e5, is_logarithmic=True),
            PlaneAxis("gamma3", 1e-4, 0.1, is_logarithmic=True),
        ),
        Rod(F=30.0, k1=1e4, k2=1e3, gamma3=1e-3),
    ),
]


@pytest.mark.parametrize(("axes", "rod"), TOUCHED)
def test_the_tangent_of_a_boundary_touches_it(axes, rod):
    """A step along it leaves the curve by the curvature alone, in proportion to the square of the step."""
    plane = ParameterPlane(rod, axes)
    _, seeds = rows(axes, rod, 2)
    for seed in seeds:
        boundary = StabilityBoundary(plane, seed.double_eigenvalue_sign)
        scaled = [
            axis.scaled_coordinate(value) for axis, value in zip(axes, seed.parameter_values, strict=True)
        ]
        start = boundary.point_near(
            np.array([*scaled, log(abs(seed.frequency_or_double_eigenvalue))]), np.array([0.0, 1.0, 0.0])
        )
        assert boundary.growth_rate_and_frequency(start.v[2])[
            int(seed.double_eigenvalue_sign == 0)
        ] == pytest.approx(seed.frequency_or_double_eigenvalue, rel=1e-6)
        tangent = start.tangent
        if (scaled[1] < 0.5) != (tangent[1] > 0):
            tangent = -tangent  # into the plane
        bends = []
        for step in (1e-3, 1e-4):
            guess = start.v + step * tangent
            bends.append(np.linalg.norm(boundary.point_near(guess, tangent).v - guess) / step**2)
        assert bends[0] == pytest.approx(bends[1], rel=0.02)


def test_a_value_on_a_boundary_is_undecided_and_its_neighbours_are_not():
    hopf = 37.6559805452710668
    row = solve_row(
        Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4),
        RowRequest("F", np.array([10.0, 30.0, hopf, 40.0]), 1e-9, True, 9),
    )
    assert row.stability_class.tolist() == [
        StabilityClass.monotone,
        StabilityClass.oscillatory,
        StabilityClass.undecided,
        StabilityClass.flutter,
    ]
    assert row.unstable_count.tolist() == [0, 0, -1, 2]


def test_a_row_without_a_bound_fails_with_its_reason():
    row = solve_row(
        Rod(F=0.0, k1=1e4, k2=10.0, gamma3=0.0), RowRequest("F", np.linspace(-50.0, -20.0, 8), 1e-9, True, 9)
    )
    assert row.status == ThresholdStatus.failed
    assert "bound" in row.message
    assert (row.stability_class == StabilityClass.undecided).all()


def test_a_diagram_that_begins_at_the_limit_of_the_model_has_its_curves():
    """gamma3 = 0 is the first row: nothing lies beyond it, neither for steps nor for differences."""
    axes = (PlaneAxis("F", 5.0, 60.0), PlaneAxis("gamma3", 0.0, 1.0))
    rod = Rod(F=30.0, k1=1e4, k2=20.0, gamma3=0.01)
    _, seeds = rows(axes, rod, 3)
    curves = boundary_curves_through(ParameterPlane(rod, axes), seeds)
    assert {seed.parameter_values[1] for seed in seeds} == {0.0, 0.5, 1.0}
    assert (curves.untraced_seed_count, curves.max_seed_distance_per_row_length < 1e-11) == (0, True)


@pytest.mark.parametrize(
    ("k1", "top", "folds"), [((100.0, 150.0, 200.0), 120.0, 1), ((10.0, 20.0, 1e4), 250.0, 4)]
)
def test_each_curve_is_followed_once_and_ends_are_no_folds(k1, top, folds):
    """Rows on the border, and rows where the curve of double eigenvalues runs along the crushed rods."""
    axes = (PlaneAxis("F", 0.0, top), PlaneAxis("k1", k1[0], k1[-1], is_logarithmic=k1[-1] > 10 * k1[0]))
    rod = Rod(F=0.0, k1=k1[-1], k2=1e4, gamma3=1e-4)
    seeds = []
    for value in k1:
        row = solve_row(replace(rod, k1=value), RowRequest("F", np.linspace(0.0, top, 13), 1e-9, True, 50))
        seeds += [
            seed_of((c.value, value), c.kind, c.frequency, c.growth_rate) for c in row.thresholds.thresholds
        ]
    curves = boundary_curves_through(ParameterPlane(rod, axes), seeds).curves
    found = [fold for curve in curves for fold in curve.folds]
    assert len(found) == folds
    assert (
        len({(f.axis, round(f.parameter_values[0], 3), round(f.parameter_values[1], 3)) for f in found})
        == folds
    )


@pytest.mark.parametrize("off", [-3e-16, 0.0, 3e-16])
def test_a_force_that_is_k1_but_for_rounding_is_crushed(off):
    """Two axes in logarithmic steps meet at F = k1 up to rounding: nothing is undecided there."""
    k1 = 10**2.5
    values = np.array([0.5 * k1, k1 * (1 + off), 2 * k1])
    row = solve_row(Rod(F=0.0, k1=k1, k2=1e4, gamma3=1e-4), RowRequest("F", values, 1e-9, True, 9))
    assert [StabilityClass(motion).name for motion in row.stability_class] == [
        "flutter",
        "crushed",
        "crushed",
    ]


@pytest.mark.parametrize(
    ("k", "values", "undecided", "reason"),
    [
        (
            1e4,
            [-1e6, -1e4, -1e3, 0.0, 40.0],
            1,
            "because a search from F = -1000000 fails: no a-priori bound",
        ),
    ],
)
def test_a_row_from_a_pull_that_cannot_be_searched_begins_at_a_smaller_pull(k, values, undecided, reason):
    rod = Rod(F=0.0, k1=k, k2=k, gamma3=1e-4 if k == 1e4 else 1e-3)
    row = solve_row(rod, RowRequest("F", np.array(values), 1e-8, True, 9))
    assert row.status == ThresholdStatus.ended_early
    assert re.match(f"the search begins at F = {values[undecided]:.12g}, {reason}", row.message)
    pushed = solve_row(rod, RowRequest("F", np.array([0.0, 40.0]), 1e-8, True, 9)).thresholds.thresholds
    found = [c.value for c in row.thresholds.thresholds]
    assert found == pytest.approx([c.value for c in pushed], rel=1e-8)
    assert (row.stability_class == StabilityClass.undecided).tolist() == [
        n < undecided for n in range(len(values))
    ]
    assert row.stability_class[undecided] == StabilityClass.monotone
    assert row.stability_class[-1] == StabilityClass.flutter


def test_a_row_from_a_strong_pull_is_searched_whole():
    """The leading eigenvalue is exponentially small under the pull, and must not hide the others."""
    rod = Rod(F=0.0, k1=1e8, k2=1e8, gamma3=1e-3)
    row = solve_row(rod, RowRequest("F", np.array([-5e3, -100.0, 40.0]), 1e-8, True, 9))
    assert row.status == ThresholdStatus.ok
    assert row.stability_class.tolist() == [
        StabilityClass.monotone,
        StabilityClass.monotone,
        StabilityClass.flutter,
    ]
    pushed = solve_row(rod, RowRequest("F", np.array([0.0, 40.0]), 1e-8, True, 9)).thresholds.thresholds
    found = [c.value for c in row.thresholds.thresholds]
    assert found == pytest.approx([c.value for c in pushed], rel=1e-8)


def test_a_pull_whose_bound_almost_underflows_is_no_failure():
    """The radius without eigenvalues about 0 is so small that the ratio of both bounds overflows."""
    rod = Rod(F=0.0, k1=1e7, k2=1e6, gamma3=1e-4)
    row = solve_row(rod, RowRequest("F", np.array([-9e5, 0.0, 100.0]), 1e-8, True, 9))
    assert row.status == ThresholdStatus.ended_early
    assert row.message.startswith(
        "the search begins at F = 0, because a search from F = -900000 fails: no a-priori bound"
    )
    assert (row.stability_class[1:] != StabilityClass.undecided).all()
