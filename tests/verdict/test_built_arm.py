"""What is said of arms that taper, have segments or are of rubber, in Python, sweeps and the command."""

import math

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.model.arm.neglected import Validity
from rodsweep.solve.changes.threshold_kinds import ThresholdKind

ARM = {"length": "12 cm", "radius": "6 mm", "young": "100 kPa", "viscosity": "50 Pa s"}
CONE = ARM | {"tip_radius": "3 mm"}
CAST = ["5 cm: radius 6 mm, young 80 kPa", "7 cm: radius 4 mm, inner_radius 1 mm"]
SEGMENTED = {"segments": CAST, "young": "100 kPa", "viscosity": "50 Pa s"}
RUBBER = {"law": "neo_hookean", "section": "swelling"}


def by_hand(u):
    """gamma2 of a cone of half the radius at its tip, 20 radii long, over that at its base."""
    return (math.log(40) - 0.5) / (np.log(40 / (1 - u / 2)) - 0.5)


def test_report_on_segments_alike_is_that_on_the_uniform_arm():
    two = {"segments": ["5 cm: radius 6 mm", "7 cm: radius 6 mm"], "pressure": "3 kPa"}
    same = rs.Arm(**{n: v for n, v in ARM.items() if n not in ("length", "radius")}, **two).report()
    assert str(same) == str(rs.Arm(**ARM, pressure="3 kPa").report())


@pytest.mark.long
@pytest.mark.parametrize("segments", [["10 cm: radius 5 mm"], ["4 cm: radius 5 mm", "6 cm: radius 5 mm"]])
def test_segments_alike_beyond_the_limit_of_inertia_get_the_remedies_of_the_uniform_arm(segments):
    fluid = {"young": "100 kPa", "viscosity": "1 mPa s"}
    uniform = rs.Arm(length="10 cm", radius="5 mm", **fluid).report()
    assert "times as thick" in uniform.verdict[0]
    assert str(rs.Arm(segments=segments, **fluid).report()) == str(uniform)


def test_flutter_of_a_cone_is_that_of_the_rod_converted_by_hand():
    """k1 = 4 20^2, k2 = 3 k1/10, gamma3 = (ln 40 - 1/2)/(2 20^2); the pressure is on the tip."""
    u = np.linspace(0, 1, 21)
    logarithm = math.log(40) - 0.5
    rod = rs.Rod(
        k1=1600.0,
        k2=480.0,
        gamma3=logarithm / 800,
        taper=0.5,
        profile={"u": u.tolist(), "gamma2": by_hand(u).tolist()},
    )
    found, arm = rod.thresholds(F_max=30), rs.Arm(**CONE)
    own = arm.thresholds(F_max=30)
    # 21 rows have the logarithm to 1e-6, the arm's own to 3e-4
    assert own.F_hopf == pytest.approx(found.F_hopf, rel=1e-4)
    unit = 1e5 * math.pi * 0.006**4 / 4 / 0.12**2
    tau2 = 4 * math.pi * 50 / logarithm * 0.12**2 / unit
    assert own.pressure_hopf == pytest.approx(own.F_hopf * unit / (math.pi * 0.003**2), rel=1e-12)
    assert own.frequency_hopf_hz == pytest.approx(found.hopf_frequency / (2 * math.pi * tau2), rel=5e-4)
    assert arm.flutter.by_drag[0].first_force(ThresholdKind.hopf) == pytest.approx(own.F_hopf, rel=1e-6)
    assert rs.Rod(arm=arm).thresholds(F_max=30).F_hopf == own.F_hopf


@pytest.mark.long
def test_report_on_a_cone():
    arm = rs.Arm(**CONE, pressure="5 kPa", density_difference="2 kg/m^3")
    report = arm.report()
    flutter = arm.flutter.first_force_range(ThresholdKind.hopf)
    assert flutter.high < arm.F
    assert report.verdict[0].startswith("5 kPa is ")
    assert report.verdict[0].endswith(": the arm beats.")
    assert report.rows[0].name == "taper"
    assert "at the weakest section" in str(report).replace("\n  ", " ")
    share = float(arm.F / arm.crushing_force)
    assert f"shortens the arm by {100 * share:.2g} %" in str(report).replace("\n  ", " ")


def test_the_law_of_rubber_moves_the_threshold_and_is_not_crushed():
    linear, rubber = rs.Arm(**SEGMENTED), rs.Arm(**SEGMENTED | RUBBER, pressure="200 kPa")
    assert rubber.crushing_force == math.inf
    assert rubber.k1 < rubber.F
    first = rs.Arm(**SEGMENTED | RUBBER).flutter.first_force_range(ThresholdKind.hopf)
    assert first.low > 1.02 * linear.flutter.first_force_range(ThresholdKind.hopf).low
    report = rs.Arm(**SEGMENTED | RUBBER, pressure="1 kPa").report()
    assert "law of rubber includes large compression." in " ".join(str(report).split())
    assert [row.name for row in report.rows[:3]] == ["segment 1", "segment 2", "law"]
    assert report.rows[1].formula == "radius 4 mm, inner radius 1 mm, 100 kPa"


def test_a_thin_fluid_is_outside_the_model_for_a_cone_too():
    report = rs.Arm(**CONE | {"viscosity": "1 mPa s"}).report()
    assert report.validity == Validity.does_not_apply
    assert report.verdict[0].startswith("The model does not apply: inertia of the arm is ")


def test_a_sweep_over_the_tip_has_the_arm_of_every_point():
    """Each point has its own profile: the logarithms of its radii."""
    data = rs.sweep(
        "thresholds",
        arm=ARM | RUBBER | {"length": ["12 cm", "14 cm"], "tip_radius": ["4 mm", "6 mm"]},
        F_max=40,
    )
    assert data.F_hopf.dims == ("length", "tip_radius")
    for length in ("12 cm", "14 cm"):
        for tip in ("4 mm", "6 mm"):
            alone = rs.Arm(**ARM | RUBBER | {"length": length, "tip_radius": tip}).thresholds(F_max=40)
            here = data.sel(length=float(length[:2]) / 100, tip_radius=float(tip[0]) / 1000)
            assert here.F_hopf.item() == pytest.approx(alone.F_hopf, rel=1e-9)
            assert here.pressure_hopf.item() == pytest.approx(alone.pressure_hopf, rel=1e-9)
            assert here.taper.item() == pytest.approx(float(tip[0]) / 6)


def test_a_sweep_over_drags_has_the_factors_of_every_drag():
    arm = SEGMENTED | {"pressure": ["0.5 kPa", "2 kPa"], "drag": ["likeliest", "most"]}
    data = rs.sweep("spectrum", arm=arm, modes=1)
    for place, drag in enumerate(("likeliest", "most")):
        alone = rs.Arm(**SEGMENTED, pressure="2 kPa", drag=drag).spectrum(modes=1)
        here = data.isel(drag=place, pressure=1)
        assert here.growth_rate_si.item() == pytest.approx(alone.growth_rate_si[0], rel=1e-8)


SHAPES = {
    "cone": CONE,
    "segments": SEGMENTED,
    "rubber": ARM | RUBBER,
    "rubber segments": SEGMENTED | RUBBER,
}


@pytest.mark.long
@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_cycles_of_an_arm_are_those_of_its_rod(shape):
    """In SI units by the arm, and without dimension by the rod that it is."""
    flutter = rs.Arm(**shape).flutter.first_force_range(ThresholdKind.hopf).high
    arm = rs.Arm(**shape)
    arm = arm.replace(pressure=f"{1.2 * flutter * arm.pressure_scale:.6g} Pa")
    found, rod = arm.cycle(accuracy=1e-6), rs.Rod(arm=arm).cycle(accuracy=1e-6)
    assert found.status == rod.status == "cycle"
    assert found.period == pytest.approx(rod.period, rel=1e-9)
    assert found.period_si == pytest.approx(rod.period * arm.tau2, rel=1e-9)


TASKS_OF_HOPF_POINTS = {
    "thresholds": ({"F_max": 30.0}, "F_hopf"),
    "criticality": ({"F_max": 30.0}, "crossing_F"),
    "branch": ({"stop": 30.0, "accuracy": 1e-3}, "special_at"),
}


@pytest.mark.long
@pytest.mark.parametrize("task", TASKS_OF_HOPF_POINTS)
@pytest.mark.parametrize("tips", ["3 mm", ["3 mm", "4 mm"]])
def test_every_task_has_the_hopf_points_of_the_cone(task, tips):
    """Branches were those of the uniform arm."""
    options, name = TASKS_OF_HOPF_POINTS[task]
    data = rs.sweep(task, arm=CONE | {"tip_radius": tips}, **options, progress=False)
    found = data[name].values.reshape(np.size(tips), -1)[:, 0]
    alone = [
        rs.Arm(**CONE | {"tip_radius": tip}).thresholds(F_max=30.0).F_hopf for tip in np.atleast_1d(tips)
    ]
    assert found == pytest.approx(alone, rel=1e-9)


def test_another_arm_replaces_the_shape():
    cone = rs.Arm(**CONE)
    assert cone.replace(segments=CAST).tip_radius is None
    assert rs.Arm(**SEGMENTED).replace(radius="6 mm", length="12 cm").segments is None
    assert cone.replace(inner_radius="2 mm").tip_radius is None
    assert cone.turned is cone
    cast = rs.Arm(**SEGMENTED)
    assert cast.turned is cast
    assert eval(repr(cast).replace("Arm(", "rs.Arm(")) == cast


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--segment", "12 cm: radios 6 mm"], "--segment, number 1: unknown key radios; a segment has"),
        (
            ["--segment", "12 cm: radius 6 mm, inner_radius 7 mm"],
            "--segment, number 1: inner_radius = '7 mm' is not below radius = '6 mm'",
        ),
        (["--segment", "12 cm: radius 6 mm", "--radius", "5 mm"], "--radius = '5 mm' and --segment are both"),
        (
            ["--segment", "12 cm: radius 6 mm", "--length", "11 cm"],
            "--length = '11 cm' is not the sum of the",
        ),
        (
            ["--length", "12 cm", "--radius", "6 mm", "--tip-radius", "0 mm"],
            "--tip-radius = '0 mm' is not above",
        ),
        (
            ["--length", "12 cm", "--width", "6 mm", "--height", "6 mm", "--tip-radius", "3 mm"],
            "--tip-radius = '3 mm' needs a radius",
        ),
        (
            ["--length", "12 cm", "--radius", "6 mm", "--section", "swelling"],
            "--section = swelling is not known",
        ),
        (["--radius", "6 mm"], "--length is missing"),
    ],
)
def test_the_command_refuses_in_one_sentence_with_the_option(command, words, sentence):
    outcome = command("arm", "--young", "100 kPa", "--viscosity", "50 Pa s", *words)
    assert outcome.returncode == 2
    assert outcome.stderr.startswith(f"rodsweep: {sentence}")
    assert outcome.stderr.count("\n") == 1
    assert outcome.stdout == ""


def test_the_command_takes_segments_and_a_law(command):
    words = [word for text in CAST for word in ("--segment", text)]
    options = [
        "--young",
        "100 kPa",
        "--viscosity",
        "50 Pa s",
        "--law",
        "neo_hookean",
        "--section",
        "swelling",
    ]
    outcome = command("arm", *words, *options)
    assert outcome.returncode == 0
    assert outcome.stdout.rstrip("\n") == str(rs.Arm(**SEGMENTED | RUBBER).report())
