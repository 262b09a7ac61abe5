"""Rows and curves of phase diagrams of arms that vary along their length or are of rubber."""

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.determinant.parameter_plane import ParameterPlane, PlaneAxis
from rodsweep.determinant.stability_boundary import StabilityBoundary
from rodsweep.errors import InputError
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.diagram.boundary_curves import trace_boundary
from rodsweep.solve.changes.diagram.rows import RowRequest, StabilityClass, solve_row
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import ThresholdKind
from rodsweep.solve.changes.thresholds_along_path import find_thresholds
from rodsweep.solve.hopf.bautin_points import curve_criticality

ONES = RodMaterial(profile=Profile((0.0, 1.0), ((1.0,) * 6, (1.0,) * 6)))
SWELLING = RodMaterial("neo_hookean", "swelling")
FORCE_AND_STIFFNESS = PlaneAxis("F", 20.0, 140.0), PlaneAxis("k1", 100.0, 300.0)
ROD = {"k2": 1e4, "gamma3": 1e-4}


def traced(material, kind, axes=FORCE_AND_STIFFNESS, **values):
    """The curve from the first change of a kind on the middle row of a plane."""
    first, second = axes
    middle = Rod(
        **{"F": 0.0, "k1": 300.0, **ROD, **values, second.parameter_name: second.value(0.5)},
        material=material,
    )
    found = find_thresholds(ParameterPath(middle, "F"), 0.0, min(first.stop, 0.999 * middle.crushing_force))
    change = next(c for c in found.thresholds if c.kind == kind)
    plane = ParameterPlane(Rod(**{"F": 0.0, "k1": 300.0, **ROD, **values}, material=material), axes)
    sign = 0.0 if kind == ThresholdKind.hopf else -1.0
    return trace_boundary(
        sign, plane, (first.scaled_coordinate(change.value), 0.5), change.frequency or change.growth_rate
    )


@pytest.mark.long
def test_the_hopf_curve_of_a_uniform_arm_folds_where_the_closed_form_does():
    exact, found = (traced(material, ThresholdKind.hopf) for material in (RodMaterial(), ONES))
    (fold,), (of_arm,) = exact.folds, found.folds
    assert of_arm.parameter_values[1] == pytest.approx(fold.parameter_values[1], rel=1e-13)
    assert abs(of_arm.parameter_values[0] - fold.parameter_values[0]) <= of_arm.parameter_errors[0] < 2e-7
    assert found.parameter_values[[0, -1]] == pytest.approx(exact.parameter_values[[0, -1]], rel=1e-10)


@pytest.mark.parametrize("kind", [ThresholdKind.hopf, ThresholdKind.onset])
def test_tangents_of_a_uniform_arm_are_those_of_the_closed_form(kind):
    curve = traced(RodMaterial(), kind)
    boundaries = [
        StabilityBoundary(
            ParameterPlane(Rod(F=20.0, k1=300.0, **ROD, material=material), FORCE_AND_STIFFNESS),
            curve.double_eigenvalue_sign,
        )
        for material in (RodMaterial(), ONES)
    ]
    for v in curve.scaled_points[::6]:
        exact, found = (boundary.tangent(v) for boundary in boundaries)
        assert found * np.sign(found @ exact) == pytest.approx(exact, abs=3e-10)


@pytest.mark.long
def test_the_fold_of_rubber_bounds_the_rows_that_flutter():
    axes = PlaneAxis("F", 20.0, 500.0), PlaneAxis("k1", 350.0, 550.0)
    (fold,) = traced(SWELLING, ThresholdKind.hopf, axes).folds
    assert fold.axis == 1
    k1, error = fold.parameter_values[1], 1e-6

    def hopfs(stiffness):
        found = find_thresholds(
            ParameterPath(Rod(F=0.0, k1=stiffness, **ROD, material=SWELLING), "F"), 0.0, 500.0
        )
        return [
            c.value for c in found.thresholds if c.kind in (ThresholdKind.hopf, ThresholdKind.restabilization)
        ]

    assert hopfs(k1 * (1 - error)) == []
    low, high = hopfs(k1 * (1 + error))
    assert low < fold.parameter_values[0] < high < low * 1.02


@pytest.mark.long
def test_a_curve_over_the_taper_folds_where_the_window_of_flutter_closes():
    axes = PlaneAxis("F", 40.0, 560.0), PlaneAxis("taper", 1.1, 1.8)
    (fold,) = (f for f in traced(SWELLING, ThresholdKind.hopf, axes, k1=500.0).folds if f.axis == 1)
    taper = fold.parameter_values[1]
    numbers = []
    for side in (-1e-5, 1e-5):
        rod = Rod(F=0.0, k1=500.0, **ROD, taper=taper + side, material=SWELLING)
        found = find_thresholds(ParameterPath(rod, "F"), 0.0, 560.0)
        numbers.append(
            sum(c.kind in (ThresholdKind.hopf, ThresholdKind.restabilization) for c in found.thresholds)
        )
    assert numbers == [2, 0]


def test_rows_reach_beyond_k1_for_rubber_and_to_the_tip_for_cones():
    def row(name, values, rod):
        request = RowRequest(name, np.array(values), accuracy=1e-10, certify=True, max_thresholds=16)
        return solve_row(rod, request)

    rubber = row("F", [10.0, 100.0, 500.0, 550.0], Rod(F=0.0, k1=500.0, **ROD, material=SWELLING))
    assert rubber.status == ThresholdStatus.ok
    assert rubber.stability_class.tolist() == [
        StabilityClass.monotone,
        StabilityClass.flutter,
        StabilityClass.oscillatory,
        StabilityClass.oscillatory,
    ]
    cone = row("F", [5.0, 20.0, 49.0, 51.0, 60.0], Rod(F=0.0, k1=200.0, **ROD, taper=0.5))
    assert cone.stability_class.tolist()[3:] == [StabilityClass.crushed] * 2
    assert StabilityClass.crushed not in cone.stability_class.tolist()[:3]
    assert cone.thresholds.end == pytest.approx(50.0, rel=2e-6)
    along_k1 = row("k1", [20.0, 39.0, 41.0, 200.0], Rod(F=10.0, k1=np.inf, **ROD, taper=0.5))
    assert (along_k1.stability_class == StabilityClass.crushed).tolist() == [True, True, False, False]


@pytest.fixture(scope="module")
def cones():
    """A diagram with everything, two rows of cones."""
    return rs.sweep(
        "phase_diagram",
        F=[0, 10, 30, 45],
        k1=1e4,
        k2=1e2,
        gamma3=1e-2,
        taper=[0.8, 0.9],
        criticality=True,
        cycles=True,
        cycle_accuracy=1e-4,
    )


@pytest.mark.long
def test_the_criticality_of_a_diagram_of_cones_is_that_of_each_cone(cones):
    for taper in (0.8, 0.9):
        of_hopf = np.isfinite(cones.curve_criticality.values)
        (point,) = np.flatnonzero(of_hopf & (cones.curve_taper.values == taper))
        found = rs.Rod(k1=1e4, k2=1e2, gamma3=1e-2, taper=taper).criticality(F_max=60)
        assert cones.curve_F.values[point] == pytest.approx(found.crossing_F[0], rel=1e-9)
        assert (cones.curve_criticality.values[point], found.criticality[0]) == (
            -1,
            "supercritical",
        )


def test_cones_of_a_diagram_beat_where_they_flutter(cones):
    """Their Hopf points are supercritical and no branch turns back."""
    flutter = (cones["class"] == 2).values
    assert flutter.any()
    assert (cones.stable_states.values == np.where(flutter, 2, 1)).all()


@pytest.mark.long
def test_a_generalised_hopf_point_of_a_uniform_arm_is_that_of_the_closed_form():
    plane_axes = PlaneAxis("F", 60.0, 110.0), PlaneAxis("k1", 145.0, 160.0)
    fold = 75.3972626336484526, 147.921519683199662, 770.860809443855688
    points = []
    for material in (RodMaterial(), ONES):
        plane = ParameterPlane(Rod(F=0.0, k1=200.0, **ROD, material=material), plane_axes)
        start = tuple(axis.scaled_coordinate(value) for axis, value in zip(plane_axes, fold[:2], strict=True))
        told = curve_criticality(plane, trace_boundary(0.0, plane, start, fold[2]), 1e-10)
        assert told.unlocated_sign_change_count == 0
        points.append(told.bautin_points[0])
    exact, found = points
    for value, theirs, error in zip(
        exact.parameter_values, found.parameter_values, found.parameter_errors, strict=True
    ):
        assert abs(value - theirs) <= 2 * error + 1e-10 * value


def test_a_plane_that_is_crushed_everywhere_is_refused():
    with pytest.raises(InputError, match="the weakest section of all arms is crushed at 25"):
        rs.sweep("phase_diagram", F=[30.0, 60.0], k1=[50.0, 100.0], taper=0.5, **ROD)


@pytest.mark.long
def test_a_diagram_of_rubber_says_that_counts_confirm_it(command):
    text = "task: phase_diagram\nparameters: {F: {start: 0, stop: 450, num: 4}, k1: [360, 400], "
    command.write(
        "rubber.yaml",
        f"{text}k2: 1.0e4, gamma3: 1.0e-4}}\nmaterial: {{law: neo_hookean, section: swelling}}\n",
    )
    assert command("run", "rubber.yaml").returncode == 0
    said = command("show", "rubber.h5").stdout
    assert "is confirmed by counts of unstable modes for 2 of 2 rows" in said
    assert "fold of the curve of Hopf points, where k1 is extremal: k1 = 366.4520346" in said
    assert "partial beam" not in said
    assert "crushed" not in said
    assert "eigenproblem" not in said, "counts have no cost that is counted"
    assert command.drawn("plot", "rubber.h5").returncode == 0


@pytest.mark.parametrize(
    ("name", "values"),
    [("k1", [2e2, 1e7]), ("k2", [1e2, 1e7]), ("gamma3", [0.0, 1e-2]), ("k1", [160.001, 1e3])],
)
def test_rows_begin_and_end_at_the_limits_of_the_model(name, values):
    """Slopes by a compliance or a drag next to 0, and next to the force that crushes the tip."""
    rod = {"F": 40.0, "k1": 1e4, **ROD, "taper": 0.5} | {name: values[0]}
    request = RowRequest(name, np.array(values), accuracy=1e-9, certify=True, max_thresholds=16)
    row = solve_row(Rod(**rod), request)
    assert row.status == ThresholdStatus.ok
    for value, unstable in zip(values, row.unstable_count, strict=True):
        assert rs.Rod(**{**rod, name: value}).spectrum(modes=4).unstable_count == unstable
