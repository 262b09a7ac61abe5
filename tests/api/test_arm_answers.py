"""`rs.Arm` answers the tasks of a rod, in SI units too."""

import math
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hard.page import as_stated, page_of

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.solve.changes.threshold_kinds import ThresholdKind

THICK = {"length": "15 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "100 Pa s"}


def test_thresholds_of_an_arm_need_no_load_and_ignore_one():
    arm = rs.Arm(**THICK)
    answer = arm.thresholds()
    flutter = arm.flutter.by_drag[0].first_threshold(ThresholdKind.hopf)
    assert answer.F_hopf == pytest.approx(flutter.value, rel=1e-6)
    assert answer.data["F_hopf"].size == 1
    loaded = rs.Arm(**THICK, pressure="1 kPa").thresholds()
    assert loaded.F_hopf == answer.F_hopf
    assert "\nArm(length='15 cm', young='100 kPa'" in str(answer)


def test_thresholds_of_an_arm_with_a_force_are_forces():
    """Also where the force is relative to flutter, and in the list of crossings; a pressure stays in Pa."""
    by_pressure = rs.Arm(**THICK, pressure="1 kPa").thresholds()
    assert by_pressure.units["pressure_hopf"] == "Pa"
    area = math.pi * 5e-3**2
    for force in ("0.1 N", "0.5 of flutter"):
        answer = rs.Arm(**THICK, force=force).thresholds()
        assert answer.units["force_hopf"] == answer.units["crossing_force"] == "N"
        assert not any("pressure" in str(name) for name in answer.data.data_vars)
        assert answer.force_hopf == pytest.approx(by_pressure.pressure_hopf * area, rel=1e-12)
        assert re.search(r"flutter from force = 0\.0\d+ N", " ".join(str(answer).split()))
    branch = rs.Arm(**THICK, force="0.1 N").branch(stop=32, accuracy=1e-3)
    assert branch.units["branch_force"] == branch.units["special_at_si"] == "N"


@pytest.mark.parametrize(
    "viscosity, density_difference, first",
    [
        ("20 Pa s", "0 kg/m^3", "decaying oscillation from "),
        ("1 mPa s", "0 kg/m^3", "the model does not apply: inertia of the arm is "),
        ("20 Pa s", "8 kg/m^3", "the model is doubtful: weight is 0.69 times its limit"),
    ],
)
def test_an_answer_about_an_arm_begins_with_the_validity_of_the_model(viscosity, density_difference, first):
    given = dict(length="14 cm", radius="4 mm", young="100 kPa", viscosity=viscosity)
    answer = rs.Arm(**given, density_difference=density_difference).thresholds()
    lines = str(answer).splitlines()
    assert lines[0].startswith(first)
    assert ("if the model applied: decaying oscillation from " in str(answer)) == (viscosity == "1 mPa s")
    assert first in answer._repr_html_()


def test_spectrum_and_cycle_of_an_arm_are_those_of_its_rod():
    arm = rs.Arm(**THICK, pressure="1.3 of flutter")
    rod = rs.Rod(arm=arm)
    assert rod.parameters == {
        name: pytest.approx(getattr(arm.loaded, name)) for name in ("F", "k1", "k2", "gamma3", "gamma1")
    }
    assert arm.spectrum(modes=1).growth_rate == pytest.approx(rod.spectrum(modes=1).growth_rate)
    one, other = arm.cycle(accuracy=1e-4), rod.cycle(accuracy=1e-4)
    assert one.status == "cycle"
    assert one.period == pytest.approx(other.period, rel=1e-9)
    in_seconds = [v for v in one.data.data_vars if str(v).startswith("period") and one.units[str(v)] == "s"]
    assert float(one.data[in_seconds[0]]) == pytest.approx(one.period * arm.tau2, rel=1e-12)


def test_a_rod_made_of_an_arm_keeps_what_is_given():
    arm = rs.Arm(**THICK)
    rod = rs.Rod(arm=arm, gamma3=0.5)
    assert "F" not in rod.parameters
    assert rod.parameters["gamma3"] == 0.5
    assert rod.parameters["k2"] == arm.k2


@pytest.mark.long
def test_making_an_arm_starts_no_solver():
    """Nor does a rod of it, unless its load is relative to flutter."""
    code = (
        f"import sys, rodsweep as rs; arm = rs.Arm(**{THICK}, pressure='2 kPa'); rs.Rod(arm=arm.turned)\n"
        "assert 'petsc4py' not in sys.modules; rs.Rod(arm=arm.replace(pressure='1.2 of flutter'))\n"
        "assert 'petsc4py' in sys.modules"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_replace_changes_quantities_and_lets_one_load_or_section_take_the_place_of_the_other():
    arm = rs.Arm(**THICK, pressure="2 kPa", inner_radius="2 mm")
    assert arm.replace(length="30 cm").k1 == pytest.approx(4 * arm.k1)
    assert arm.replace(force="0.1 N").pressure is None
    flat = arm.replace(width="2 cm", height="1 cm")
    assert (flat.radius, flat.inner_radius, flat.load_name) == (None, None, "pressure")
    assert flat.replace(radius="4 mm").width is None
    assert arm.replace(pressure=None).load_name is None
    assert isinstance(flat, rs.Arm)
    assert math.isnan(arm.replace(pressure=None).si.pressure)


def test_an_arm_is_written_as_it_is_made_and_equal_ones_are_equal():
    arm = rs.Arm(**THICK, pressure="1.2 of flutter")
    given = "length='15 cm', young='100 kPa', viscosity='100 Pa s', radius='5 mm', pressure='1.2 of flutter'"
    assert repr(arm) == f"Arm({given})"
    assert eval(repr(arm), {"Arm": rs.Arm}) == arm
    assert hash(arm) == hash(rs.Arm(**THICK, pressure="1.2 of flutter"))


def test_a_relative_load_is_resolved_for_sweeps_too():
    arm = rs.Arm(**THICK, pressure="1.3 of flutter")
    data = rs.sweep("spectrum", arm=arm, modes=1)
    assert data.F.item() == pytest.approx(arm.loaded.F, rel=1e-12)


def test_no_digit_in_si_units_is_told_that_is_not_known():
    """The period to 1e-4 has no six digits in seconds; those that it has are those of a finer solution."""
    arm = {
        "length": "15 cm",
        "radius": "5 mm",
        "young": "100 kPa",
        "viscosity": "100 Pa s",
        "pressure": "2 kPa",
    }
    told = [
        page_of(
            view_of_dataset(rs.sweep("limit_cycle", arm=arm, accuracy=accuracy, progress=False), Path("c.h5"))
        )
        for accuracy in (1e-3, 1e-8)
    ]
    rough, fine = (
        dict(re.findall(r"(\w+) = (\S+)", next(x for x in page if x.startswith("in the arm's units"))))
        for page in told
    )
    assert rough.keys() == fine.keys() >= {"period", "injection_rms", "tip_x_min"}
    for name, text in rough.items():
        assert as_stated(text, float(fine[name])) == "", name
    assert len(rough["period"]) < len(fine["period"])
