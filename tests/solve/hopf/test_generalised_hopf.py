"""Generalised Hopf points: against other equations, meshes and planes, and as users see them."""

from dataclasses import replace

import h5py
import numpy as np
import pytest
from contents import content, same
from second_normal_form import ArmGeometry, coefficients
from test_paper import run, stated

import rodsweep as rs
from rodsweep.determinant.parameter_plane import ParameterPlane, PlaneAxis
from rodsweep.errors import InputError
from rodsweep.model.rod import Rod
from rodsweep.post.figures.stability.diagram_curves import hopf_curve_parts_by_criticality
from rodsweep.post.plane_curves import PlaneParameters
from rodsweep.results.file.view import read_view
from rodsweep.solve.changes.diagram.boundary_curves import trace_boundary
from rodsweep.solve.hopf import bautin_points, hopf_coefficients
from rodsweep.solve.hopf.bautin_curves import (
    BautinCurvePoint,
    BautinEndReason,
    BautinProblem,
    bautin_curve,
    lies_on_curve,
)
from rodsweep.solve.hopf.bautin_points import curve_criticality
from rodsweep.solve.unsolvable import Unsolvable
from rodsweep.tasks.running.job import job_of_file

K2, GAMMA3 = 1e4, 1e-4
FOLD = 75.3972626336484526, 147.921519683199662, 770.860809443855688
"""F, k1 and frequency, 30-digit roots: between it and the generalised Hopf point nothing changes side."""
DIAGRAM = """
task: phase_diagram
parameters: {F: {start: 60, stop: 110, num: 6}, k1: [148, 150, 152, 154], k2: 1.0e4, gamma3: 1.0e-4}
phase_diagram: {criticality: true}
"""


def curve_of(plane, F, k1, frequency):
    start = [
        axis.scaled_coordinate({"F": F, "k1": k1, "gamma3": GAMMA3}[axis.parameter_name])
        for axis in plane.axes
    ]
    return trace_boundary(0.0, plane, tuple(start), frequency)


def over_F_and_k1(F=(60.0, 110.0), k1=(145.0, 160.0), logarithmic=False):
    """A plane of the rod and the Hopf curve through its fold."""
    axes = PlaneAxis("F", *F), PlaneAxis("k1", *k1, is_logarithmic=logarithmic)
    plane = ParameterPlane(Rod(F=0.0, k1=200.0, k2=K2, gamma3=GAMMA3), axes)
    return plane, curve_of(plane, *FOLD)


@pytest.fixture(scope="module")
def found():
    """Plane, curve, and what is found along it."""
    plane, curve = over_F_and_k1()
    return plane, curve, curve_criticality(plane, curve, 1e-10)


@pytest.mark.long
def test_a_generalised_hopf_point_is_that_of_other_equations(found):
    """Newton's method in (F, k1) on the second normal form leaves it where it is."""
    (point,) = found[2].bautin_points

    def growth_and_c(values):
        rod = (*values, K2, GAMMA3, 1.0)
        w = np.linalg.eigvals(ArmGeometry(*rod, 24).linear())
        w = w[np.argmin(abs(w - 1j * point.frequency))]
        c = coefficients(rod, w, 24)[0]
        return np.array([w.real / abs(w), c.real / abs(c)])

    at = np.array(point.parameter_values)
    here, steps = growth_and_c(at), np.diag(1e-5 * at)
    slopes = np.column_stack([(growth_and_c(at + step) - here) / step.sum() for step in steps])
    # Of these equations rounding leaves some 1e-11, from nodes to nodes.
    assert at == pytest.approx(at - np.linalg.solve(slopes, here), rel=1e-10)
    c = coefficients((*point.parameter_values, K2, GAMMA3, 1.0), 1j * point.frequency, 24)[0]
    assert point.landau_imag == pytest.approx(c.imag, rel=1e-6)
    assert all(
        error <= 1e-9 * value
        for error, value in zip(point.parameter_errors, point.parameter_values, strict=True)
    )


def test_the_side_changes_once_and_at_the_point(found):
    plane, curve, told = found
    (point,) = told.bautin_points
    assert told.unlocated_sign_change_count == 0
    assert set(told.criticality) == {-1.0, 1.0}
    (after,) = np.flatnonzero(np.diff(told.criticality))
    assert point.preceding_index == after
    at = np.array(
        [axis.scaled_coordinate(v) for axis, v in zip(plane.axes, point.parameter_values, strict=True)]
    )
    a, b = curve.scaled_points[after : after + 2, :2]
    assert np.linalg.norm(at - a) + np.linalg.norm(b - at) < 1.001 * np.linalg.norm(b - a)
    for i, side in ((after, told.criticality[after]), (after + 1, told.criticality[after + 1])):
        w = 1j * curve.frequency[i]
        c = coefficients((*curve.parameter_values[i], K2, GAMMA3, 1.0), w, 24)[0]
        assert np.sign(c.real) == side


def test_it_is_the_same_on_finer_meshes_and_from_other_neighbours(found):
    (point,) = found[2].bautin_points
    finer = curve_criticality(*found[:2], 1e-12).bautin_points
    elsewhere = over_F_and_k1((50.0, 125.0), (146.0, 300.0), logarithmic=True)
    others = curve_criticality(*elsewhere, 1e-10).bautin_points
    for (other,) in (finer, others):
        for value, error, theirs, their_error in zip(
            point.parameter_values,
            point.parameter_errors,
            other.parameter_values,
            other.parameter_errors,
            strict=True,
        ):
            assert abs(value - theirs) <= error + their_error
        assert other.frequency == pytest.approx(point.frequency, rel=1e-9)


def test_another_plane_through_the_same_rod_has_it_too(found):
    (point,) = found[2].bautin_points
    F, k1 = point.parameter_values
    axes = PlaneAxis("k1", 140.0, 160.0), PlaneAxis("gamma3", 1e-5, 1e-3, is_logarithmic=True)
    plane = ParameterPlane(Rod(F=F, k1=200.0, k2=K2, gamma3=GAMMA3), axes)
    (other,) = curve_criticality(plane, curve_of(plane, F, k1, point.frequency), 1e-10).bautin_points
    assert other.parameter_values == pytest.approx((k1, GAMMA3), rel=1e-8)


def test_axial_drag_moves_it_along_the_hopf_curve(found):
    plane, curve, told = found
    (point,), (other,) = (
        told.bautin_points,
        curve_criticality(replace(plane, rod=plane.rod.with_values(gamma1=0.5)), curve, 1e-10).bautin_points,
    )
    assert abs(other.parameter_values[0] - point.parameter_values[0]) > 1e-3
    c = coefficients((*other.parameter_values, K2, GAMMA3, 0.5), 1j * other.frequency, 24)[0]
    assert abs(c.real) < 1e-7 * abs(c)


def test_where_the_normal_form_fails_the_side_is_not_known_and_no_other_is_lost(found, monkeypatch):
    plane, curve, told = found
    F = curve.parameter_values[3, 0]
    real = bautin_points.hopf_coefficients

    def fails_at_one(rod, *more):
        if abs(rod.F - F) < 1e-9 * F:
            raise Unsolvable("no normal form")
        return real(rod, *more)

    monkeypatch.setattr(bautin_points, "hopf_coefficients", fails_at_one)
    again = curve_criticality(plane, curve, 1e-10)
    assert np.flatnonzero(np.isnan(again.criticality)).tolist() == [3]
    assert np.array_equal(np.delete(again.criticality, 3), np.delete(told.criticality, 3))
    assert again.bautin_points == told.bautin_points


def test_a_change_that_cannot_be_located_is_counted(found, monkeypatch):
    plane, curve, told = found
    real = bautin_points.hopf_coefficients

    def jumps(*asked):
        """Re c/|c| changes its sign without vanishing."""
        c = real(*asked)
        return replace(c, landau=complex(np.sign(c.landau.real), 1.0))

    monkeypatch.setattr(bautin_points, "hopf_coefficients", jumps)
    again = curve_criticality(plane, curve, 1e-10)
    assert (again.bautin_points, again.unlocated_sign_change_count) == ((), 1)
    assert np.array_equal(again.criticality, told.criticality)


def test_a_point_is_located_if_rounding_makes_Re_c_exactly_zero(found, monkeypatch):
    """Re c, rounded to 1e-9, is 0 near the zero, where Brent's method evaluates the normal form. The
    amplitude coefficient is infinite there."""
    plane, curve, located = found
    normal_form = hopf_coefficients.normal_form_on
    zeros = []

    def rounded(*arguments):
        form = normal_form(*arguments)
        c = complex(round(form.landau.real, 9), form.landau.imag)
        zeros.extend([replace(form, landau=c)] if c.real == 0 else [])
        return replace(form, landau=c)

    monkeypatch.setattr(hopf_coefficients, "normal_form_on", rounded)
    again = curve_criticality(plane, curve, 1e-10)
    assert again.unlocated_sign_change_count == 0
    assert again.bautin_points[0].parameter_values == pytest.approx(
        located.bautin_points[0].parameter_values, rel=1e-10
    )
    assert np.isinf(zeros[0].amplitude_coefficient)
    assert np.isinf(zeros[0].frequency_slope)


def test_a_point_within_the_error_of_the_change_is_undecided_and_brackets_nothing(found):
    """A point of the curve put where Re c vanishes: the bracket reaches over it."""
    plane, curve, told = found
    (point,) = told.bautin_points
    x, y = (axis.scaled_coordinate(v) for axis, v in zip(plane.axes, point.parameter_values, strict=True))
    there = np.insert(curve.scaled_points, point.preceding_index + 1, [x, y, np.log(point.frequency)], axis=0)
    again = curve_criticality(plane, replace(curve, scaled_points=there), 1e-10)
    assert again.criticality[point.preceding_index + 1] == 0
    assert again.bautin_points[0].parameter_values == pytest.approx(point.parameter_values, rel=1e-10)
    assert again.bautin_points[0].preceding_index in (point.preceding_index, point.preceding_index + 1)


@pytest.mark.long
def test_a_diagram_tells_shows_and_draws_it(command):
    k1, F = stated("generalised_hopf")[:2]
    axes = "parameters.F.num=18", "parameters.k1.num=6"
    along = "phase_diagram.bautin_along.gamma3=[1.0e-4, 1.5e-4]"
    with run(command, "generalised_hopf", *axes, along) as file:
        assert file["bautin_k1"][:] == pytest.approx([k1], rel=1e-11)
        assert file["bautin_F"][:] == pytest.approx([F], rel=1e-8)
        hopf = file["curve_kind"][:] == 1
        sides = file["curve_criticality"][:]
        assert np.isnan(sides[~hopf]).all()
        assert set(sides[hopf]) == {-1, 1}
        after = int(file["bautin_curve_point"][0]) - 1
        assert sides[after] * sides[after + 1] == -1
        assert file["curve_number"][after] == file["bautin_curve"][0]
    told = command("show", "generalised_hopf.h5").stdout.replace("\n", " ")
    assert "generalised Hopf point (Re c = 0) on curve 2: k1 = 149.6168916" in told
    assert "supercritical" in told
    view = read_view(command.directory / "generalised_hopf.h5")
    (one, before), (other, beyond) = hopf_curve_parts_by_criticality(view, 2, PlaneParameters("F", "k1"))
    assert {one, other} == {-1, 1}
    assert before[-1] == pytest.approx((F, k1), rel=1e-8)
    assert before[-1].tolist() == beyond[0].tolist()


@pytest.mark.long
def test_it_does_not_depend_on_ranks_or_interruptions_nor_other_variables_on_it(command):
    command.write("c.yaml", DIAGRAM)
    command.write("plain.yaml", DIAGRAM.replace("criticality: true", "curves: true"))
    for words in (("c.yaml",), ("c.yaml", "-o", "two.h5"), ("plain.yaml",)):
        assert command("run", *words, ranks=2 if "two.h5" in words else 0).returncode == 0
    for number in (1, 2):
        assert command("run", "c.yaml", "--shard", f"{number}/2").returncode == 0
    assert command("merge", "m.h5", "c-1-of-2.h5", "c-2-of-2.h5").returncode == 0
    assert command("run", "c.yaml", "-o", "m.h5").returncode == 0
    whole, two, merged, plain = (
        content(command.directory / name) for name in ("c.h5", "two.h5", "m.h5", "plain.h5")
    )
    assert len(whole["bautin_F"]) == 1
    assert same(whole, two)
    assert same(whole, merged)
    added = whole.keys() - plain.keys()
    assert all(name in ("curve_criticality", "curve_gamma1") or name.startswith("bautin") for name in added)
    assert same({name: whole[name] for name in whole.keys() - added}, plain)
    # The rows are those of the plain file, which the criticality is added to.
    refused = command("run", "c.yaml", "-o", "plain.h5")
    assert refused.returncode == 2
    assert command("run", "c.yaml", "-o", "plain.h5", "--extend").returncode == 0
    assert same(whole, content(command.directory / "plain.h5"))


@pytest.mark.long
def test_a_diagram_without_one_says_so(command):
    command.write(
        "c.yaml",
        DIAGRAM.replace("[148, 150, 152, 154]", "[160, 170]").replace(
            "start: 60, stop: 110", "start: 40, stop: 80"
        ),
    )
    assert command("run", "c.yaml").returncode == 0
    with h5py.File(command.directory / "c.h5") as file:
        assert file["bautin_F"].shape == (0,)
        assert (file["curve_criticality"][file["curve_kind"][:] == 1] == -1).all()
    told = command("show", "c.h5").stdout
    assert "supercritical" in told
    assert "subcritical" not in told
    assert command.drawn("plot", "c.h5", "-o", "c.png").returncode == 0


def test_python_gives_the_same_with_the_axial_drag_that_is_asked_for():
    asked = {"F": [60, 85, 110], "k1": [148, 150, 152], "k2": 1e4, "gamma3": 1e-4, "criticality": True}
    one, half = (rs.sweep("phase_diagram", **asked, **more) for more in ({}, {"gamma1": 0.5}))
    assert (float(one.curve_gamma1), float(half.curve_gamma1)) == (1.0, 0.5)
    assert one.bautin_k1.values == pytest.approx([149.616891612], rel=1e-11)
    assert np.array_equal(one.curve_F.values, half.curve_F.values)
    assert abs(half.bautin_F.values[0] - one.bautin_F.values[0]) > 1e-3


@pytest.fixture(scope="module")
def over_shear():
    """A diagram whose generalised Hopf point is followed from k2 = 1e4 to 5e3 and 2e4."""
    axes = {"F": [60, 85, 110], "k1": [148, 150, 152], "gamma3": 1e-4, "criticality": True}
    along = {"bautin_along": {"k2": [5e3, 2e4]}}
    return axes, rs.sweep("phase_diagram", **axes, k2=1e4, **along)


@pytest.mark.long
def test_curve_over_a_third_parameter_has_the_points_of_other_diagrams(over_shear):
    axes, along = over_shear
    k2 = along.bautin_along_k2.values
    assert (np.diff(k2) > 0).all()
    for value in (1e4, 2e4):
        other = rs.sweep("phase_diagram", **axes, k2=value)
        (at,) = np.flatnonzero(np.abs(k2 / value - 1) < 1e-12)
        for name in ("F", "k1", "frequency"):
            found = along[f"bautin_along_{name}"].values[at]
            assert found == pytest.approx(other[f"bautin_{name}"].values[0], rel=1e-9)


@pytest.mark.long
def test_curve_over_the_taper_begins_at_the_uniform_rod_and_lies_where_cones_change_side():
    axes = {"F": [60, 85, 110], "k1": [142, 148, 154], "k2": 1e4, "gamma3": 1e-4, "criticality": True}
    along = rs.sweep("phase_diagram", **axes, bautin_along={"taper": [0.9, 1.0]})
    k1, taper = along.bautin_along_k1.values, along.bautin_along_taper.values
    assert k1[np.argmax(taper)] == pytest.approx(149.616891612, rel=1e-9)
    assert taper.max() == 1.0
    (at,) = np.flatnonzero(taper == 0.9)
    for factor, side in ((1 - 1e-8, -1), (1 + 1e-8, 1)):
        cone = rs.Rod(k1=k1[at] * factor, k2=1e4, gamma3=1e-4, taper=0.9).criticality()
        near = np.argmin(np.abs(cone.crossing_F - along.bautin_along_F.values[at]))
        assert np.sign(cone.landau_real[near]) == side


def test_points_of_the_curve_are_those_of_other_equations(over_shear):
    """By the second normal form, between the values asked for, beyond both."""
    along = over_shear[1]
    for i in (0, 3, -1):
        values = [float(along[f"bautin_along_{name}"].values[i]) for name in ("F", "k1", "k2")]
        c = coefficients((*values, GAMMA3, 1.0), 1j * float(along.bautin_along_frequency.values[i]), 24)[0]
        assert abs(c.real) < 1e-7 * abs(c)
        errors = [float(along[f"bautin_along_{name}_error"].values[i]) for name in ("F", "k1", "k2")]
        assert all(error <= 1e-9 * value for error, value in zip(errors, values, strict=True))


def test_curve_ends_at_the_ends_of_the_range_or_of_the_plane(over_shear):
    """From k1 = 147.1, below the plane, to 150.9, which k2 reaches within the range."""
    starts, ends = (over_shear[1][f"bautin_along_{side}"].values for side in ("start", "end"))
    assert (starts[0], ends[-1]) == (BautinEndReason.plane_edge, BautinEndReason.range_end)
    assert not starts[1:].any() and not ends[:-1].any()
    assert over_shear[1].bautin_along_k1.values[0] == pytest.approx(148, rel=1e-12)


def test_curve_that_turns_back_in_the_third_parameter_is_followed_through_it(monkeypatch):
    """Instead of rods a parabola, z = 0.8 - 2 (x - 1/2)^2 at y = 1/2: at z = 1 nothing is found."""

    def on_parabola(space, guess, held):
        x, _, z, h = guess
        if held == 2:
            if z > 0.8:
                raise Unsolvable("beyond the turn")
            x = 0.5 + np.copysign(np.sqrt((0.8 - z) / 2), x - 0.5)
        v = np.array([x, 0.5, 0.8 - 2 * (x - 0.5) ** 2, h])
        return BautinCurvePoint(
            scaled_point=v,
            parameter_values=v[:3],
            parameter_errors=np.zeros(3),
            frequency=1.0,
            landau_imag=0.0,
        )

    monkeypatch.setattr(BautinProblem, "solve_point", on_parabola)
    unit = tuple(PlaneAxis(name, 0.0, 1.0) for name in ("F", "k1", "gamma3"))
    space = BautinProblem(Rod(F=0.0, k1=2.0, k2=1.0, gamma3=1.0), unit, np.array([0.5, 0.6]), 1e-10)
    start = on_parabola(space, np.array([0.3, 0.5, 0.6, 0.0]), 2)
    curve = bautin_curve(space, start)
    assert (
        curve.end_reasons == (BautinEndReason.plane_edge, BautinEndReason.plane_edge)
        or curve.end_reasons[1] == BautinEndReason.range_end
    )
    x, _, z = np.array([point.parameter_values for point in curve.points]).T
    assert (np.diff(x) > 0).all()
    assert x[-1] > 0.9
    assert z.max() == pytest.approx(0.8, abs=0.02)
    assert sum(abs(z - 0.6) < 1e-9) == 2
    beyond = on_parabola(space, np.array([0.7, 0.5, 0.6, 0.0]), 2)
    assert lies_on_curve(beyond, curve)


def test_a_closed_curve_over_three_parameters_is_followed_once(monkeypatch):
    """Instead of rods a circle of radius 0.3 about (1/2, 1/2) in x and z."""

    def on_circle(space, guess, held):
        x, z = guess[[0, 2]] - 0.5
        other = np.sqrt(np.maximum(0.09 - (z if held == 2 else x) ** 2, 0))
        if other == 0:
            raise Unsolvable("beyond the circle")
        x, z = (np.copysign(other, x), z) if held == 2 else (x, np.copysign(other, z))
        v = np.array([0.5 + x, 0.5, 0.5 + z, guess[3]])
        return BautinCurvePoint(
            scaled_point=v,
            parameter_values=v[:3],
            parameter_errors=np.zeros(3),
            frequency=1.0,
            landau_imag=0.0,
        )

    monkeypatch.setattr(BautinProblem, "solve_point", on_circle)
    unit = tuple(PlaneAxis(name, 0.0, 1.0) for name in ("F", "k1", "gamma3"))
    space = BautinProblem(Rod(F=0.0, k1=2.0, k2=1.0, gamma3=1.0), unit, np.array([0.5]), 1e-10)
    curve = bautin_curve(space, on_circle(space, np.array([0.7, 0.5, 0.7, 0.0]), 0))
    assert curve.end_reasons == (BautinEndReason.closed, BautinEndReason.closed)
    x, _, z = np.array([point.parameter_values for point in curve.points]).T - 0.5
    turned = np.unwrap(np.arctan2(z, x))
    assert abs(turned[-1] - turned[0]) == pytest.approx(2 * np.pi)
    assert (np.abs(np.diff(turned)) < 0.5).all()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ("bautin_along: {k2: [1, 20]}", "bautin_along is given but criticality is false"),
        (
            "criticality: true, bautin_along: {k2: [10, 20]}",
            "parameters.k2 is 9; it must have a single value in the range of ",
        ),
        (
            "criticality: true, bautin_along: {k1: [8, 20]}",
            "parameters.k1 has 2 values; it must have a single value",
        ),
        ("criticality: true, bautin_along: {k2: 9}", "bautin_along.k2 has a single value; give at least two"),
        (
            "criticality: true, bautin_along: {k2: [1, inf]}",
            "bautin_along.k2 = inf is not allowed; it must be a finite number above 0$",
        ),
        (
            "criticality: true, bautin_along: {k1: [1.0e-320, 10]}",
            r"bautin_along.k1 = \S+e-321 is not allowed; .* a finite number above 0 \(1/k1 overflows\)$",
        ),
        ("criticality: true, bautin_along: {}", "has 0 parameters; give one"),
        ("criticality: true, bautin_along: {gamma1: [1, 2]}", "bautin_along.gamma1"),
        ("criticality: true, bautin_along: {k2: [8, 20], taper: [0.5, 1]}", "has 2 parameters; give one"),
        ("criticality: true, bautin_along: {taper: [0, 1]}", "bautin_along.taper"),
        ("criticality: true, bautin_along: {taper: [0.5, 0.9]}", "bautin_along.taper, from 0.5 to 0.9"),
    ],
)
def test_a_third_parameter_that_cannot_be_is_refused(tmp_path, options, sentence):
    path = tmp_path / "c.yaml"
    path.write_text(
        "task: phase_diagram\nparameters: {F: [1, 2], k1: [9, 10], k2: 9, gamma3: 1}\n"
        f"phase_diagram: {{{options}}}\n"
    )
    with pytest.raises(InputError, match=sentence):
        job_of_file(path, ())


@pytest.mark.long
def test_curves_over_a_third_parameter_are_shown_drawn_and_the_same_on_two_ranks(command):
    command.write(
        "c.yaml",
        DIAGRAM.replace("criticality: true", "criticality: true, bautin_along: {k2: [9.6e3, 1.04e4]}"),
    )
    for words, ranks in ((("c.yaml",), 0), (("c.yaml", "-o", "two.h5"), 2)):
        assert command("run", *words, ranks=ranks).returncode == 0
    one, two = (content(command.directory / name) for name in ("c.h5", "two.h5"))
    assert len(one["bautin_along_k2"]) > 3
    assert same(one, two)
    told = command("show", "c.h5").stdout.replace("\n", " ")
    assert "curve 1 of generalised Hopf points: " in told
    assert "k2 = 9600 to 10400; both ends lie at the end of the range" in told
    assert command.drawn("plot", "c.h5", "-o", "c.png").returncode == 0


@pytest.mark.parametrize(
    ("more", "options", "sentence"),
    [
        ("", "criticality: true, curves: false", "criticality is true but phase_diagram.curves is false"),
        ("gamma1: 2", "curves: true", "does not use it without phase_diagram.criticality: true"),
        ("gamma1: [1, 2]", "criticality: true", "parameters.gamma1"),
        ("gamma1: -1", "criticality: true", "parameters.gamma1 = -1 is not allowed"),
        ("gamma1: 1", "criticality: 1", "phase_diagram.criticality = 1 is not allowed"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, more, options, sentence):
    path = tmp_path / "c.yaml"
    path.write_text(
        f"task: phase_diagram\nparameters: {{F: [1, 2], k1: [9, 10], k2: 9, gamma3: 1, {more}}}\n"
        f"phase_diagram: {{{options}}}\n"
    )
    with pytest.raises(InputError, match=sentence):
        job_of_file(path, ())


def test_the_default_drag_asks_for_the_same_and_an_arm_has_its_own(tmp_path):
    path = tmp_path / "c.yaml"
    given = DIAGRAM.replace("k2: 1.0e4", "k2: 1.0e4, gamma1: 1")
    meanings = []
    for text in (DIAGRAM, given, given.replace("gamma1: 1", "gamma1: 0.5")):
        path.write_text(text)
        meanings.append(job_of_file(path, ()).config.settings_of_results)
    assert meanings[0] == meanings[1] != meanings[2]
    path.write_text(
        "task: phase_diagram\nparameters:\n  arm: {length: 10 cm, radius: 5 mm, young: 100 kPa, "
        "viscosity: 1.4 Pa s, pressure: [1 kPa, 2 kPa]}\n  gamma3: [1.0e-4, 1.0e-3]\n"
        "phase_diagram: {criticality: true}\n"
    )
    config = job_of_file(path, ()).config
    assert config.gamma1 == config.parameters.arm.dimensionless_axes()["gamma1"].array()[0] != 1
