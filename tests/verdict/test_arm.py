"""An arm in centimetres and kilopascals: formulas against hand-made numbers, units, verdict, command."""

import math
import re
import subprocess
import sys
from dataclasses import replace

import pytest

from rodsweep import Arm
from rodsweep.errors import InputError
from rodsweep.model.arm.drag import (
    cox_drag_over_viscosity,
    drag_estimates,
    gray_hancock_drag_over_viscosity,
    lighthill_drag_over_viscosity,
)
from rodsweep.model.arm.section import Circle, Rectangle, Tube
from rodsweep.model.rod import Rod
from rodsweep.model.units import load_over_flutter
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import Threshold, ThresholdKind
from rodsweep.solve.changes.thresholds import Thresholds, empty_thresholds
from rodsweep.solve.changes.thresholds_along_path import ThresholdSearchResult
from rodsweep.verdict import flutter_over_drags
from rodsweep.verdict.flutter_over_drags import ThresholdsOverDrags, ThresholdsWithDrag
from rodsweep.verdict.planes import PlaneOfMotion, PlanesOfMotion
from rodsweep.verdict.sentences import verdict_sentences
from rodsweep.verdict.validity_assessment import ValidityAssessment

OK = ThresholdStatus.ok

SILICONE = {
    "length": "10 cm",
    "radius": "5 mm",
    "young": "100 kPa",
    "viscosity": "1.4 Pa s",
    "pressure": "2 kPa",
}
OPTIONS = [word for name, text in SILICONE.items() for word in (f"--{name}", text)]


THICK = "50 Pa s"
"""Viscosity of a fluid in which the silicone arm has no inertia to speak of."""


def arm(**changes):
    """The silicone arm in glycerol, changed; None leaves a quantity out."""
    return Arm(**{name: given for name, given in (SILICONE | changes).items() if given is not None})


def test_silicone_arm_by_hand():
    """k1 = 4 (L/a)^2, k2 = kappa k1/3 with kappa = 9/10 at nu = 1/2, F = k1 p/E, k3 = E pi a^4/4."""
    rod = arm()
    assert rod.k1 == pytest.approx(1600, rel=1e-12)
    assert rod.k2 == pytest.approx(480, rel=1e-12)
    assert pytest.approx(32, rel=1e-12) == rod.F
    assert rod.tip_force == pytest.approx(0.15707963, rel=1e-7)
    assert rod.bending_stiffness == pytest.approx(4.9087385e-5, rel=1e-7)
    assert rod.tau2 == pytest.approx(5.516960 * 1e-4 / 4.9087385e-5, rel=1e-6)
    assert rod.gamma3 == pytest.approx(2.199115e-4 / (5.516960 * 0.01), rel=1e-6)


def test_drag_by_hand():
    """L/a = 20: ln 40 = 3.688879, ln 160 = 5.075174, ln 3.6 = 1.280934; per viscosity."""
    assert cox_drag_over_viscosity(20) == pytest.approx(
        (2 * math.pi / 2.188879, 4 * math.pi / 3.188879), rel=1e-6
    )
    assert gray_hancock_drag_over_viscosity(20) == pytest.approx(
        (2 * math.pi / 4.575174, 4 * math.pi / 5.575174), rel=1e-6
    )
    assert lighthill_drag_over_viscosity(20) == pytest.approx(
        (2 * math.pi / 1.280934, 4 * math.pi / 1.780934), rel=1e-6
    )
    rotational = [drag.rotational_factor for drag in drag_estimates(1.0, 20.0, 1.0, 1.0)]
    assert rotational == pytest.approx([2 * math.pi, *2 * [math.pi, 4 * math.pi]])


def test_sections_by_hand():
    circle, rectangle = Circle(2.0), Rectangle(3.0, 2.0)
    assert (circle.area, circle.second_moment) == pytest.approx((12.566371, 12.566371), rel=1e-7)
    assert (rectangle.area, rectangle.second_moment, rectangle.drag_radius) == pytest.approx((6, 2, 1.25))
    assert (circle.shear_coefficient(0), rectangle.shear_coefficient(0)) == pytest.approx((6 / 7, 5 / 6))
    assert rectangle.shear_coefficient(0.5) == pytest.approx(15 / 17.5)


def test_tube_by_hand():
    """a = 2, b = 1: A = 3 pi, I = 15 pi/4; Cowper's coefficient from m = 1/2, and a thin wall's."""
    tube = Tube(2.0, 1.0)
    numbers = (tube.area, tube.second_moment, tube.face_area, tube.bore_area)
    assert numbers == pytest.approx((3 * math.pi, 15 * math.pi / 4, 4 * math.pi, math.pi))
    assert tube.shear_coefficient(0.5) == pytest.approx(9 * 1.5625 / (10 * 1.5625 + 26 * 0.25))
    assert Tube(1.0, 1 - 1e-9).shear_coefficient(0.3) == pytest.approx(2 * 1.3 / (4 + 0.9))
    assert Tube(1.0, 1e-9).shear_coefficient(0.3) == pytest.approx(Circle(1.0).shear_coefficient(0.3))


def test_pressure_on_a_tube_pushes_on_the_whole_face_of_its_closed_tip():
    """a = 5 mm, b = 3 mm: E A L^2/k3 = 4 L^2/(a^2 + b^2), and the tip's force is p pi a^2."""
    rod = arm(inner_radius="3 mm", density_difference="100 kg/m^3")
    assert rod.k1 == pytest.approx(4 * 0.01 / 34e-6)
    assert rod.tip_force == pytest.approx(2000 * math.pi * 25e-6)
    assert rod.F * rod.pressure_scale == pytest.approx(2000)
    assert rod.mass_per_length_at(rod.geometry.base) == pytest.approx(math.pi * (16e-6 * 1100 + 9e-6 * 1000))
    crushing = 1e5 * 16 / 25
    assert arm(inner_radius="3 mm", pressure=0.999 * crushing).k1 > 0
    with pytest.raises(
        InputError, match=r"crushes the arm; the load on a linear material must be below 64000 Pa"
    ):
        arm(inner_radius="3 mm", pressure=crushing)


def test_least_rotational_drag_is_the_torque_of_its_flow():
    """Of the axial flow -Omega a^2 cos(phi)/r around a section that turns, by quadrature."""
    a, step, phi = 0.7, 1e-6, [2 * math.pi * k / 64 for k in range(64)]

    def flow(r, angle):
        return -(a**2) * math.cos(angle) / r

    traction = [(flow(a + step, angle) - flow(a - step, angle)) / (2 * step) for angle in phi]
    lever = [a * math.cos(angle) for angle in phi]
    torque = sum(t * x for t, x in zip(traction, lever, strict=True)) * a * 2 * math.pi / 64
    assert torque == pytest.approx(drag_estimates(1.0, 20.0, a, a)[1].rotational_factor, rel=1e-6)


@pytest.mark.parametrize(
    "changes",
    [
        {"length": "100 mm", "radius": 0.005, "young": "0.1 MPa", "viscosity": "14 P", "pressure": "20 mbar"},
        {"viscosity": "1400 mPa·s", "pressure": None, "force": f"{2000 * math.pi * 25e-6} N"},
    ],
)
def test_units_do_not_matter(changes):
    same, other = arm(), arm(**changes)
    for name in ("k1", "k2", "gamma3", "gamma1", "F", "tau1", "tau2"):
        assert getattr(other, name) == pytest.approx(getattr(same, name), rel=1e-12)


def test_only_time_scales_with_viscosity():
    thin, thick = arm(viscosity="0.7 Pa s"), arm()
    for name in ("k1", "k2", "gamma3", "gamma1", "F"):
        assert getattr(thin, name) == pytest.approx(getattr(thick, name), rel=1e-12)
    assert thick.tau2 == pytest.approx(2 * thin.tau2)


@pytest.mark.parametrize(
    ("given", "share"),
    [
        ("1.2 of flutter", 1.2),
        ("1.2 times flutter", 1.2),
        ("120% of flutter", 1.2),
        ("20 % above flutter", 1.2),
        ("20 % below flutter", 0.8),
        ("12e-1 of flutter", 1.2),
        ("2E+1 % above flutter", 1.2),
        ("1e999 of flutter", None),
        ("0.2 above flutter", None),
        ("100 % below flutter", None),
    ],
)
def test_a_load_relative_to_flutter_is_read_as_people_write_it(given, share):
    assert load_over_flutter(given) == (None if share is None else pytest.approx(share, rel=1e-15))


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"length": "10 foo"}, "length = '10 foo' has the unknown unit 'foo'; write .* '10 cm'"),
        ({"length": "10"}, "length = '10' has no unit"),
        ({"length": "15,5 cm"}, "length = '15,5 cm' has a decimal comma; write a point"),
        (
            {"young": "60 kpa"},
            "young = '60 kpa' has the unknown unit 'kpa'; did you mean 'kPa'\\? write a number",
        ),
        (
            {"viscosity": "30 Pas"},
            "viscosity = '30 Pas' is not measured in Pa.s; did you mean 'Pa s'\\? write",
        ),
        ({"viscosity": "30 kPa"}, "viscosity = '30 kPa' is not measured in Pa.s; write"),
        (
            {"viscosity": "30 cSt"},
            ".* is a kinematic viscosity; multiply it by",
        ),
        ({"pressure": "-1.2 of flutter"}, "pressure = '-1.2 of flutter' is not a load .* of 0 or above"),
        ({"pressure": "100 % below flutter"}, "pressure = '100 % below flutter' is not a load relative"),
        ({"pressure": "1.2 of fluter"}, "pressure = '1.2 of fluter' is not a load .* like '1.2 of flutter'"),
        ({"pressure": "20 % abve flutter"}, "pressure = '20 % abve flutter' is not a load relative"),
        ({"drag": []}, "drag = \\[\\] is not a name; choose one of likeliest, least"),
        ({"drag": "leest"}, "drag = 'leest' is not known; choose one of likeliest, least"),
        ({"length": ""}, "length = '' is not a number with a unit"),
        ({"length": "1e400 m"}, "length = '1e400 m' is not a finite number"),
        ({"length": "3 cm"}, "length = '3 cm' is 6 radii, with radius = .*; .* at least 10"),
        ({"length": "10 m**9**9**9**9"}, "length = .* not understood"),
        ({"radius": "-1 mm"}, "radius = '-1 mm' is not above 0"),
        ({"radius": None}, "radius: give either a radius, or width and height"),
        ({"inner_radius": "5 mm"}, "inner_radius = '5 mm' is not below radius = '5 mm'"),
        (
            {"radius": None, "width": "1 cm", "height": "1 cm", "inner_radius": "1 mm"},
            "inner_radius = '1 mm' needs a radius",
        ),
        ({"width": "1 cm"}, "radius: give either"),
        ({"viscosity": "1400 mPas"}, "viscosity = '1400 mPas' is not measured in Pa"),
        ({"pressure": "100 kPa"}, "pressure = '100 kPa' crushes .* below 100 kPa"),
        (
            {"force": "1 N"},
            "pressure = '2 kPa' and force = '1 N' are both given; give one",
        ),
        ({"poisson": math.nan}, "poisson = nan is not a number above -1 and up to 0.5"),
        (
            {"density_difference": "-2 g/cm^3"},
            "density_difference = '-2 g/cm.3' gives the arm no positive mass",
        ),
    ],
)
def test_bad_quantities_are_refused_in_one_sentence(changes, sentence):
    with pytest.raises(InputError, match=f"^{sentence}"):
        arm(**changes)


def test_silicone_arm_is_just_below_flutter():
    """A filament's F** = 37.695 would be 2.356 kPa, shear and drag lower it; frequencies as 1/viscosity."""
    rod = arm(viscosity=THICK)
    flutter = rod.flutter.first_force_range(ThresholdKind.hopf)
    assert rod.F < flutter.low < flutter.high < 37.695
    assert flutter.exists_for_every_drag
    verdict = rod.report().verdict
    assert verdict[0] == "2 kPa is 4 to 9 % below flutter, at 2.09 to 2.21 kPa: the arm stays straight."
    assert verdict[1] == "Above, the straight arm gives way and begins to beat at 0.0365 to 0.116 Hz."


def test_frequency_follows_from_tau2():
    rod = arm()
    for drag, found in zip(rod.base_drag_estimates, rod.flutter.by_drag, strict=True):
        rate = found.first_threshold(ThresholdKind.hopf).frequency
        assert found.first_frequency_hz(ThresholdKind.hopf) == pytest.approx(
            abs(rate) / (2 * math.pi * rod.tau2_with(drag))
        )


def test_a_cone_flutters_at_a_larger_pressure_and_a_smaller_force():
    forces = {}
    for tip in ("2.5 mm", "5 mm"):
        rod = Arm(length="10 cm", radius="5 mm", tip_radius=tip, young="100 kPa", viscosity="10 Pa s")
        (row,) = [row for row in rod.report().rows if row.name == "flutter force"]
        forces[tip] = [float(number) for number in re.findall(r"[0-9.]+", row.value)]
        found = rod.thresholds()
        assert forces[tip][0] == pytest.approx(
            found.pressure_hopf * math.pi * (float(tip.split()[0]) / 1e3) ** 2, rel=3e-3
        )
        assert forces[tip][1] <= forces[tip][0] <= forces[tip][2]
    assert forces["2.5 mm"][2] < 0.5 * forces["5 mm"][1]


def test_thresholds_inside_the_range_of_drag_lie_in_that_of_forces():
    """The range's corners bound it: the threshold is monotonic in gamma3."""
    from rodsweep.solve.changes.thresholds import solve_thresholds
    from rodsweep.verdict.flutter_over_drags import SEARCH_REQUEST

    rod = arm()
    flutter = rod.flutter.first_force_range(ThresholdKind.hopf)
    all_gamma3 = [rod.gamma3_with(drag) for drag in rod.base_drag_estimates]
    low, high = min(all_gamma3), max(all_gamma3)
    for share in (0.1, 0.3, 0.5, 0.7, 0.9):
        found = solve_thresholds(
            Rod(F=0.0, k1=rod.k1, k2=rod.k2, gamma3=low * (high / low) ** share), SEARCH_REQUEST
        )
        first = next(c.value for c in found.thresholds if c.kind == ThresholdKind.hopf)
        assert flutter.low <= first <= flutter.high


@pytest.mark.parametrize(
    ("pressure", "words"),
    [
        ("2.15 kPa", "2.15 kPa lies in the range of flutter"),
        ("2.5 kPa", "2.5 kPa is 13 to 20 % above flutter"),
        ("9.9 kPa", "9.9 kPa is 4.49 to 4.74 times flutter"),
        ("-1 kPa", "Flutter is at 2.09 to 2.21 kPa; -1 kPa does not push"),
    ],
)
def test_verdict_says_where_the_load_lies(pressure, words):
    assert arm(pressure=pressure, viscosity=THICK).report().verdict[0].startswith(words)


@pytest.mark.long
def test_command_prints_verdict_numbers_and_checks(command):
    end = command("arm", *OPTIONS)
    assert (end.returncode, end.stderr) == (0, "")
    assert end.stdout.startswith("The model does not apply: inertia of the arm is 6.4 times what the model")
    for words in ("Cowper 1966", "Lighthill 1976", "warning: Inertia", "k1 ", "1600", "480"):
        assert words in end.stdout
    assert max(map(len, end.stdout.splitlines())) <= 80
    assert end.stdout == f"{arm().report()}\n"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--radius", "5 foo"], "--radius = '5 foo' has the unknown unit 'foo'"),
        (["--fluid-density", "1"], "--fluid-density = '1' has no unit"),
        (["--poisson", "2"], "--poisson = 2.0 is not"),
        (["--force", "1 N"], "--pressure = '2 kPa' and --force = '1 N' are both given"),
    ],
)
def test_command_refuses_in_one_sentence(command, words, sentence):
    end = command("arm", *OPTIONS, *words)
    assert (end.returncode, end.stdout) == (2, "")
    assert end.stderr.startswith(f"rodsweep: {sentence}")
    assert end.stderr.count("\n") == 1


def test_numbers_need_no_solver_and_help_no_units():
    """An arm's numbers do not start PETSc, and the command line does not load pint."""
    code = (
        "import sys, rodsweep.cli; from rodsweep.model.arm.arm import SlenderArm;"
        "assert 'pint' not in sys.modules;"
        "SlenderArm(length='1 m', radius='1 cm', young='1 MPa', viscosity='1 Pa s', force='0 N').k2;"
        "assert 'petsc4py' not in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def found(tau2, *changes, end=200.0):
    """Changes of an arm that are given: (F, kind, unstable modes after it)."""
    crossings = tuple(Threshold(F, kind, 10.0, 0.0, 0.0, after) for F, kind, after in changes)
    transitions = ThresholdSearchResult(thresholds=crossings, is_proved=True)
    return ThresholdsWithDrag(tau2=tau2, thresholds=Thresholds(status=OK, search_result=transitions, end=end))


def verdict(rod, *forces):
    """The verdict on an arm with changes that are given for each drag."""
    plane = PlaneOfMotion(rod, ThresholdsOverDrags(forces))
    return verdict_sentences(PlanesOfMotion(plane), ValidityAssessment(plane.arm, plane.thresholds))


@pytest.mark.parametrize(
    ("second", "sentences"),
    [
        (
            True,
            [
                "2 kPa is 28 to 60 % above flutter, at 1.25 to 1.56 kPa",
                "is stable again above 2.5 to 2.81 kPa.",
            ],
        ),
        (
            False,
            [
                "drag decides",
                "For part of the range of drag the arm does not flutter",
                "is stable again above 2.5 kPa, for part",
            ],
        ),
    ],
)
def test_return_is_told_for_all_or_part_of_the_range(second, sentences):
    window = found(1.0, (20.0, ThresholdKind.hopf, 2), (40.0, ThresholdKind.restabilization, 0))
    other = [(25.0, ThresholdKind.hopf, 2), (45.0, ThresholdKind.restabilization, 0)] if second else []
    told = " ".join(verdict(arm(viscosity=1e3), window, found(2.0, *other)))
    assert all(words in told for words in sentences)


def test_a_second_window_of_flutter_is_told():
    window = ((20.0, ThresholdKind.hopf, 2), (40.0, ThresholdKind.restabilization, 0))
    twice = found(1.0, *window, (60.0, ThresholdKind.hopf, 2), (70.0, ThresholdKind.hopf, 4))
    told = " ".join(verdict(arm(viscosity=1e3), twice, twice))
    assert "is stable again above 2.5 kPa, and flutters again above 3.75 kPa." in told
    told = " ".join(verdict(arm(viscosity=1e3), found(1.0, *window), twice))
    assert "flutters again above 3.75 kPa, for part of the range of drag." in told
    assert "again above 3.75" not in " ".join(verdict(arm(viscosity=1e3), found(1.0, *window)))


def test_the_loads_between_which_a_disturbed_arm_oscillates_are_told():
    onset, end = (10.0, ThresholdKind.onset, 0), (15.0, ThresholdKind.real_again, 0)
    ending, lasting = (found(1.0, onset, *more, (20.0, ThresholdKind.hopf, 2)) for more in ([end], []))
    window = (12.0, ThresholdKind.hopf, 2), (14.0, ThresholdKind.restabilization, 0)
    interrupted = found(1.0, onset, *window, end)
    sentence = "{}, a disturbed arm oscillates as it returns to rest."
    for drags, loads in (
        ((ending, ending), "From 0.625 kPa on, up to 0.937 kPa"),
        ((ending, lasting), "From 0.625 kPa on, up to 0.937 kPa for part of the range of drag"),
        ((lasting, lasting), "From 0.625 kPa on"),
        ((interrupted, interrupted), "From 0.625 kPa on"),
    ):
        assert sentence.format(loads) in verdict(arm(viscosity=1e3), *drags)


def test_thresholds_without_proof_are_told_with_the_doubt():
    known = found(1.0, (20.0, ThresholdKind.hopf, 2))
    unproved = replace(known.thresholds.search_result, is_proved=False)
    thresholds = replace(
        known.thresholds,
        search_result=unproved,
        status=ThresholdStatus.not_certified,
        message="a count fails",
    )
    told = verdict(arm(viscosity=1e3), known, replace(known, thresholds=thresholds))
    assert told[:2] == [
        verdict(arm(viscosity=1e3), known)[0],
        "For some drags this is not certain: a count fails.",
    ]


@pytest.mark.parametrize(("kind", "certain"), [(ThresholdKind.real_leads, True), (ThresholdKind.hopf, False)])
def test_an_inaccurate_threshold_matters_only_if_the_verdict_uses_it(kind, certain):
    known = found(1.0, (20.0, kind, 2), (40.0, ThresholdKind.hopf, 2))
    inaccurate = tuple(replace(c, error=0.1 if c.value == 20.0 else 0.0) for c in known.thresholds.thresholds)
    thresholds = replace(
        known.thresholds,
        search_result=ThresholdSearchResult(thresholds=inaccurate, is_proved=True),
        status=ThresholdStatus.accuracy_not_reached,
    )
    told = verdict(arm(viscosity=1e3), replace(known, thresholds=thresholds))
    assert any("not certain" in sentence for sentence in told) != certain


def test_beyond_the_return_the_arm_is_straight_again():
    window = found(1.0, (20.0, ThresholdKind.hopf, 2), (30.0, ThresholdKind.restabilization, 0))
    told = verdict(arm(viscosity=1e3), window)
    assert told[0] == "2 kPa is beyond flutter, at 1.25 kPa: the straight arm is stable again."


def test_arm_without_flutter_and_failed_search_are_told():
    none = verdict(arm(), found(1.0))
    assert none == [
        "The arm does not flutter up to 12.5 kPa, where the search ends: it stays straight at 2 kPa."
    ]
    failed = ThresholdsWithDrag(
        tau2=1.0, thresholds=empty_thresholds(ThresholdStatus.failed, 200.0, "no box")
    )
    assert verdict(arm(), failed) == ["For some drags the thresholds could not be found: no box."]


def test_a_search_that_ended_early_limits_the_verdict_with_every_drag(monkeypatch):
    """With one drag the search ends before the arm returns with another, and before the load."""
    early = replace(
        found(1.0, (20.0, ThresholdKind.hopf, 2), end=25.0).thresholds, status=ThresholdStatus.ended_early
    )
    whole = found(1.0, (21.0, ThresholdKind.hopf, 2), (30.0, ThresholdKind.restabilization, 0))

    def forces(arm, drag, end=200.0):
        return whole if drag == arm.base_drag_estimates[0] else ThresholdsWithDrag(tau2=2.0, thresholds=early)

    monkeypatch.setattr(flutter_over_drags, "thresholds_with_drag", forces)
    searched = flutter_over_drags.thresholds_over_drags(arm(viscosity=1e3))
    assert len(searched.by_drag) > 1
    assert searched.end == 25.0
    told = " ".join(verdict(arm(viscosity=1e3), *searched.by_drag))
    assert (
        "whether the arm beats at 2 kPa is not known: thresholds were searched only up to 1.56 kPa." in told
    )
    assert "does not become stable again up to 1.56 kPa, where the search ends" in told


def test_beyond_where_changes_were_sought_nothing_is_claimed():
    window = found(1.0, (20.0, ThresholdKind.hopf, 2), end=25.0)
    assert verdict(arm(viscosity=1e3), window)[0] == (
        "Flutter is at 1.25 kPa; whether the arm beats at 2 kPa is not known: thresholds were searched "
        "only up to 1.56 kPa."
    )
