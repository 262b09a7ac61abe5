"""What is said of an arm: that the model does not apply, which plane goes first, no or relative loads."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from surveyed import few

import rodsweep as rs
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.arm.neglected import (
    Validity,
    angular_frequency_at_smallest_drag,
    neglected_effects,
    worst_validity,
)
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.solve.changes.threshold_kinds import ThresholdKind
from rodsweep.solve.changes.thresholds import empty_thresholds
from rodsweep.verdict.arm import arm_report
from rodsweep.verdict.checks import THRESHOLD_DECREASE_PER_INERTIA_PHASE, relative_rubber_stiffening
from rodsweep.verdict.flutter_over_drags import ThresholdsOverDrags, ThresholdsWithDrag
from rodsweep.verdict.load_texts import LoadFormatter
from rodsweep.verdict.planes import PlaneOfMotion, PlanesOfMotion, with_absolute_load

WATER = {"length": "12 cm", "radius": "6 mm", "young": "80 kPa", "poisson": 0.49, "viscosity": "1 mPa s"}
THICK = {"length": "15 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "100 Pa s"}
"""An arm of 30 radii in a fluid so viscous that the model applies."""
TALL = {"length": "12 cm", "width": "8 mm", "height": "12 mm", "young": "100 kPa", "viscosity": "100 Pa s"}


def headline(arm):
    return arm_report(arm).verdict[0]


def numbers_in(text):
    return [float(number) for number in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:e[+-]\d+)?", text)]


def test_the_arm_in_water_is_no_case_for_the_model():
    report = rs.Arm(**WATER, pressure="2 kPa").report()
    assert report.validity == Validity.does_not_apply
    assert report.warnings == ()
    assert report.verdict[0] == (
        "The model does not apply: inertia of the arm is 1.5e+07 times what the model allows; the model "
        "needs a fluid at least 4600 times as viscous (4600 mPa s), or an arm at most 0.018 times as thick."
    )
    assert report.verdict[1:] == (
        "Without inertia the arm would flutter at 1.67 to 1.76 kPa and begin to beat at 1460 to 4650 Hz.",
        "2 kPa would be 13 to 20 % above that threshold.",
    )
    assert str(report).startswith("The model does not apply")


@pytest.mark.long
def test_the_fluid_and_the_thickness_that_are_stated_would_do_and_less_would_not():
    """4600 times the viscosity, or 0.018 times the radius: rounded to the safe side in the second digit."""
    for factor, fine in ((4600, True), (4450, False)):
        report = arm_report(SlenderArm(**WATER | {"viscosity": factor * 1e-3}))
        assert (report.validity == Validity.does_not_apply) != fine
    for factor, fine in ((0.018, True), (0.0195, False)):
        report = arm_report(SlenderArm(**WATER | {"radius": factor * 6e-3}))
        assert (report.validity == Validity.does_not_apply) != fine


def test_a_thinner_arm_is_no_way_out_where_it_would_hang_down():
    """Weight over stiffness goes as 1/radius^2."""
    stiff = {"length": 0.19, "radius": 9e-3, "young": 1.33e6, "poisson": 0.3, "viscosity": 0.39}
    assert "or an arm at most 0.1" in headline(SlenderArm(**stiff))
    heavy = headline(SlenderArm(**stiff, density_difference=-188.0))
    assert "times as viscous" in heavy
    assert "thick" not in heavy


def test_large_numbers_and_units_are_written_as_people_do():
    """Of an arm in SI: 6800, not 6.8e+03, and Pa s, not Pa*s."""
    said = headline(SlenderArm(length=1.76e-3, radius=1.2e-4, young=5.5e4, poisson=0.41, viscosity=1.1e-3))
    assert re.search(r"is \d{4,5} times what the model allows; .* \(0\.\d+ Pa s\)", said)


def test_near_a_limit_a_warning_stands_above_the_verdict():
    """Inertia goes as 1/viscosity^2: 0.64 at 1.4 Pa s."""
    arm = SlenderArm(length="10 cm", radius="5 mm", young="100 kPa", viscosity="7 Pa s", pressure="2 kPa")
    report = arm_report(arm)
    assert report.validity == Validity.doubtful
    first, second, *_ = str(report).splitlines()
    assert first.startswith("warning: Compression: the load shortens the arm by 2 %")
    assert [check.sentence.split(":")[0] for check in report.warnings] == ["Compression", "Inertia"]
    assert "2 kPa is 4 to 9 % below flutter" in report.verdict[0]
    assert not any(check.sentence.startswith(("Compression", "Inertia")) for check in report.checks)


@pytest.mark.parametrize(
    "rod", [(math.inf, math.inf, 0.0), (1600.0, 480.0, 0.004), (4e4, 1e4, 1e-4), (3e3, 150.0, 0.02)]
)
def test_warnings_state_by_how_much_inertia_lowers_flutter(rod):
    """Flutter with a phase r is where the eigenvalue without inertia is on the ray Re = -r |Im|."""
    k1, k2, gamma3 = rod
    one = rs.Rod(k1=k1, k2=k2, gamma3=gamma3)
    flutter = one.thresholds(F_max=60).F_hopf
    F = np.linspace(0.85, 1.0, 31) * flutter
    data = rs.sweep("spectrum", F=list(F), k1=k1, k2=k2, gamma3=gamma3, modes=1)
    phases = (-data.growth_rate / abs(data.frequency)).values.ravel()
    for phase in (0.02, 0.1, 0.2):
        lowered = 1 - np.interp(phase, phases[::-1], F[::-1]) / flutter
        assert lowered == pytest.approx(THRESHOLD_DECREASE_PER_INERTIA_PHASE * phase, rel=0.15)


def test_rubber_is_stiffer_under_compression_as_stated():
    """Neo-Hookean: engineering stress E (x - 1/x^2)/3 at the stretch x."""
    x, step = 0.9, 1e-6
    slope = ((x + step - 1 / (x + step) ** 2) - (x - step - 1 / (x - step) ** 2)) / (2 * step) / 3
    assert 1 + relative_rubber_stiffening(0.1) == pytest.approx(slope, rel=1e-6)


def test_a_load_that_crushes_the_material_is_beyond_the_model_while_flutter_is_not():
    report = arm_report(SlenderArm(**THICK, pressure="20 kPa"))
    assert report.verdict[0] == (
        "The model does not apply at 20 kPa: compression is 2 times what the model allows; the model needs a "
        "load of at most 10 kPa."
    )
    assert re.fullmatch(
        r"Flutter, at [\d.]+ to [\d.]+ kPa, is within the model; 20 kPa is not.", report.verdict[1]
    )
    assert arm_report(SlenderArm(**THICK, pressure="9.99 kPa")).validity == Validity.doubtful


@pytest.mark.parametrize(
    ("law", "pressure", "compression"),
    [
        ("linear", "-5 kPa", "lengthens the arm by 5 %; rubber is some 9 % softer at this extension"),
        ("linear", "-100 kPa", "lengthens the arm by 100 %; real materials are no longer linear at this ext"),
        ("linear", "5 kPa", "shortens the arm by 5 %; rubber is some 10 % stiffer at this compression"),
        ("neo_hookean", "-5 kPa", "lengthens the arm by 5.3 %; the law of rubber includes large compression"),
    ],
)
def test_a_pull_lengthens_the_arm(law, pressure, compression):
    """Neo-Hookean: p/E = (h - 1/h^2)/3 with p = -5 kPa, E = 100 kPa at h = 1.0527; tangent (1 + 2/h^3)/3."""
    report = arm_report(SlenderArm(**THICK, pressure=pressure, law=law))
    checks = (*report.warnings, *report.checks)
    sentence = next(check.sentence for check in checks if check.sentence.startswith("Compression"))
    start, end = compression.split("; ")
    assert f"the load {start} and the flutter load shortens it by " in sentence
    assert f"; {end}" in sentence
    if pressure == "-100 kPa":
        assert report.verdict[0] == (
            "The model does not apply at -100 kPa: extension is 10 times what the model allows; the model "
            "needs a pull of at most 10 kPa."
        )


def test_weight_beyond_its_limit_says_which_density_would_do():
    report = arm_report(SlenderArm(**THICK, density_difference="-200 kg/m^3"))
    (excess, most) = numbers_in(report.verdict[0])[:2]
    assert report.verdict[0].startswith("The model does not apply: weight is ")
    assert excess == pytest.approx(200 / most, rel=0.1)
    assert arm_report(SlenderArm(**THICK, density_difference=most)).validity < Validity.does_not_apply
    assert arm_report(SlenderArm(**THICK, density_difference=1.1 * most)).validity == Validity.does_not_apply


def random_arm(rng):
    """An arm of 10 to 60 radii, of any softness, in water or honey, round, hollow or rectangular."""
    radius = 10 ** rng.uniform(-4, -2)
    sections = (
        {"radius": radius},
        {"radius": radius, "inner_radius": radius * rng.uniform(0.1, 0.9)},
        {"width": 2 * radius, "height": 2 * radius * rng.uniform(0.5, 2.0)},
    )
    given = sections[rng.integers(3)] | {
        "length": radius * 10 ** rng.uniform(1.2, 1.8),
        "young": 10 ** rng.uniform(4, 6),
        "viscosity": 10 ** rng.uniform(-3, 2.5),
        "poisson": rng.uniform(0.2, 0.5),
    }
    load = (None, "0.7 of flutter", "1.2 of flutter", "130 % of flutter")[rng.integers(4)]
    if rng.random() < 0.3:
        given["density_difference"] = rng.uniform(-300, 300)
    return SlenderArm(**given, **({} if load is None else {"pressure": load}))


@pytest.mark.long
@pytest.mark.parametrize("seed", few(range(6), 2))
def test_the_headline_agrees_with_the_neglected_effects_of_random_arms(seed):
    arm = random_arm(np.random.default_rng(seed))
    report = arm_report(arm)
    plane = min(
        (
            (rod, rs.Arm(**{n: getattr(rod, n) for n in GIVEN_QUANTITIES if getattr(rod, n) is not None}))
            for rod in planes(arm)
        ),
        key=lambda each: each[1].flutter.by_drag[0].first_force(ThresholdKind.hopf) * each[0].force_scale,
    )
    first, found = plane[0], plane[1].flutter
    hopf = found.by_drag[0].first_threshold(ThresholdKind.hopf)
    effects = neglected_effects(
        first, angular_frequency_at_smallest_drag(first, abs(hopf.frequency)), hopf.value
    )
    worst = int(worst_validity(effects, of_cycles=False))
    if arm.load_over_flutter is not None:
        share = arm.load_over_flutter * hopf.value / first.k1
        worst = max(worst, 2 if share > 0.1 else 1 if share > 0.01 else 0)
    assert report.validity == worst
    assert report.verdict[0].startswith("The model does not apply") == (worst == 2)
    assert bool(report.warnings) == (worst == 1)
    if worst < 2 and arm.load_over_flutter is not None:
        spans = found.first_force_range(ThresholdKind.hopf)
        at = arm.load_over_flutter * hopf.value
        words = "stays straight" if at < spans.low else "drag decides" if at < spans.high else "the arm beats"
        assert words in report.verdict[0]


GIVEN_QUANTITIES = ("length", "radius", "inner_radius", "width", "height", "young", "viscosity", "poisson")


def planes(arm):
    return [arm] if arm.radius is not None else [arm, replace(arm, width=arm.height, height=arm.width)]


@pytest.mark.long
def test_a_tall_rectangle_flutters_first_in_the_plane_of_its_width():
    """Its verdict is that of the same arm turned, and the other plane is mentioned."""
    tall = rs.Arm(**TALL, pressure="2 kPa")
    flat = tall.turned
    assert (flat.width, flat.height) == ("12 mm", "8 mm")
    found, other = (
        flat.flutter.first_force_range(ThresholdKind.hopf),
        tall.flutter.first_force_range(ThresholdKind.hopf),
    )
    low, high = (F * flat.pressure_scale / 1000 for F in (found.low, found.high))
    report = tall.report()
    assert report.verdict[0] == headline(flat).replace("plane of its height", "plane of its width")
    assert "above flutter" in report.verdict[0]
    assert "in the plane of its width: the arm beats." in report.verdict[0]
    assert [low, high] == pytest.approx(numbers_in(report.verdict[0])[3:5], rel=5e-3)
    last = numbers_in(report.verdict[-1])
    assert report.verdict[-1].startswith("In the plane of its height flutter is at")
    assert last == pytest.approx([F * tall.pressure_scale / 1000 for F in (other.low, other.high)], rel=5e-3)
    assert min(last) > high
    assert dict((row.name, row.value) for row in report.rows)["k1"] == f"{flat.k1:.5g}"


def test_a_square_has_one_plane():
    assert "plane" not in str(arm_report(SlenderArm(**TALL | {"width": "12 mm"})))


def test_a_tall_arm_that_is_stiff_in_its_plane_of_motion_beats_in_the_other():
    """Below flutter in the plane that was meant, and above in the one that goes first."""
    tall = rs.Arm(**TALL, pressure="2 kPa")
    assert tall.flutter.first_force_range(ThresholdKind.hopf).low > tall.F
    assert tall.turned.flutter.first_force_range(ThresholdKind.hopf).high < tall.turned.F


@pytest.mark.long
def test_no_load_is_needed_to_ask_when_an_arm_flutters(command):
    arm = rs.Arm(**THICK)
    flutter, rate = (
        arm.flutter.first_force_range(ThresholdKind.hopf),
        arm.flutter.first_frequency_range(ThresholdKind.hopf),
    )
    said = headline(arm)
    stated = numbers_in(said)
    assert said.startswith("The arm flutters at ")
    assert stated[:2] == pytest.approx(
        [F * arm.pressure_scale / 1000 for F in (flutter.low, flutter.high)], rel=5e-3
    )
    assert stated[2:] == pytest.approx([rate.low, rate.high], rel=5e-3)
    assert "tip force" not in str(arm.report())
    words = [word for name, text in THICK.items() for word in (f"--{name}", text)]
    assert command("arm", *words).stdout == f"{arm.report()}\n"


@pytest.mark.long
@pytest.mark.parametrize("load", ["pressure", "force"])
def test_a_load_may_be_relative_to_flutter(load):
    arm = rs.Arm(**THICK, **{load: "1.25 of flutter"})
    same = rs.Arm(**THICK, **{load: "125% of flutter"})
    likeliest = arm.flutter.by_drag[0].first_force(ThresholdKind.hopf)
    assert pytest.approx(1.25 * likeliest, rel=1e-12) == arm.loaded.F
    assert same.loaded == arm.loaded
    report = arm.report()
    assert (
        report.verdict[1]
        == f"{report.verdict[0].split(' is ')[0]} is 1.25 of flutter with the likeliest drag."
    )
    with pytest.raises(rs.InputError, match=f"^{load} = '1.25 of flutter' is relative to flutter"):
        _ = arm.F


def test_a_load_relative_to_the_flutter_of_a_rectangle_is_so_in_the_plane_that_goes_first():
    tall = rs.Arm(**TALL, pressure="1.5 of flutter")
    flutter = tall.turned.flutter.by_drag[0].first_force(ThresholdKind.hopf) * tall.turned.pressure_scale
    assert tall.loaded.si.pressure == pytest.approx(1.5 * flutter)
    assert tall.loaded.height == tall.height


@pytest.mark.parametrize("given", ["of flutter", "-1 of flutter", "1.2 of onset", "nan of flutter"])
def test_other_relative_loads_are_refused(given):
    with pytest.raises(
        rs.InputError,
        match=f"^pressure = '{given}' .*(?:write a number with a unit|is not a number|of 0 or above)",
    ):
        SlenderArm(**THICK, pressure=given)


def test_a_load_relative_to_no_flutter_is_refused():
    arm = SlenderArm(**THICK, pressure="1.2 of flutter")
    none = ThresholdsWithDrag(tau2=1.0, thresholds=empty_thresholds(ThresholdStatus.ok, 200.0))
    with pytest.raises(
        rs.InputError, match="^pressure = '1.2 of flutter' cannot be computed: .* up to 5560 Pa"
    ):
        with_absolute_load(PlanesOfMotion(PlaneOfMotion(arm, ThresholdsOverDrags((none,)))))


def test_the_report_is_a_table_in_a_notebook():
    report = rs.Arm(**THICK, pressure="2 kPa").report()
    page = report._repr_html_()
    assert page.count("<tr>") == len(report.rows) + 1
    assert f"<b>{report.verdict[0]}</b>" in page
    assert repr(report) == str(report)
    assert "<td>gamma3</td>" in page


@pytest.mark.parametrize("share", [0.9986, 1.0, 1.0004, 0.1])
def test_a_load_of_at_most_so_much_is_rounded_down(share):
    """1.3381 kPa was told as 1.34 kPa, which is beyond the limit."""
    load = LoadFormatter(SlenderArm(**THICK, pressure="1.34 kPa"))
    force = share * 1.34 / load.load_at_unit_force
    told = float(load.rounded_down_text(force).split()[0])
    assert 0.99 * share * 1.34 < told <= share * 1.34 * (1 + 1e-9)
