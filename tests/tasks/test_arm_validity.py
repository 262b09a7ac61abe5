"""Whether the model applies, point by point: in files, in what `check` and `show` say first, in figures."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from surveyed import few

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.api.keyword_arguments import job_of_tree
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.arm.neglected import (
    Validity,
    angular_frequency_at_smallest_drag,
    neglected_effects,
    worst_validity,
)
from rodsweep.post.figures import draw
from rodsweep.post.summary.arm.arm_answer_lines import arm_answer
from rodsweep.post.summary.arm.validity_sentences import judged_row_motion_clause, validity_sentence
from rodsweep.post.summary.selection import PointSelection
from rodsweep.results.file.view import read_view
from rodsweep.results.layouts.phase_diagram import STABILITY_CLASSES
from rodsweep.results.layouts.si_variables import UNKNOWN_VALIDITY_NUMBER, VALIDITY_VARIABLES
from rodsweep.results.layouts.thresholds import HOPF_CROSSING_CODES
from rodsweep.tasks.arm.validity import MOTION_OF_TASK, ArmValidity

SILICONE = {"radius": "5 mm", "young": "100 kPa", "viscosity": "4 Pa s"}
LENGTHS = ["4 cm", "6 cm", "10 cm", "14 cm"]
MAP = """
task: thresholds
parameters:
  arm: {length: [4 cm, 6 cm, 10 cm, 14 cm], radius: 5 mm, young: [50 kPa, 100 kPa], viscosity: 4 Pa s}
thresholds: {crossings: 8}
"""
HEAVY = MAP.replace("viscosity: 4 Pa s", "viscosity: 400 Pa s, density_difference: 200 kg/m^3")

DIAGRAM_OVER_POISSON = """
task: phase_diagram
parameters:
  arm: {length: 14 cm, radius: 4 mm, young: 100 kPa, viscosity: 5 Pa s, density_difference: 8 kg/m^3,
        poisson: [0, 0.2, 0.5], pressure: {start: 0 kPa, stop: 1 kPa, num: 5}}
"""


def arm_at(data, **more):
    """The arm of one point of a Dataset."""
    names = [name for name in ("length", "radius", "young", "viscosity") if name in data.coords]
    return SlenderArm(**{name: data[name].item() for name in names}, pressure=0, **more)


def test_each_point_has_the_worst_of_what_is_left_out():
    data = rs.sweep("thresholds", arm=SILICONE | {"length": LENGTHS}, crossings=8)
    assert data.model_applies[0] == Validity.does_not_apply  # shorter than ten radii
    for point in (data.isel(length=i) for i in (1, 2, 3)):
        arm = arm_at(point)
        effects = neglected_effects(
            arm, angular_frequency_at_smallest_drag(arm, point.hopf_frequency), point.F_hopf
        )
        counted = [effect for effect in effects if not effect.is_of_cycles_only]
        assert point.model_applies == worst_validity(effects, of_cycles=False)
        largest = max(counted, key=lambda effect: effect.value_over_limit)
        assert point.neglected_excess.item() == pytest.approx(float(largest.value_over_limit), rel=1e-12)
        words = data.neglected_effect.flag_meanings.split()
        assert words[1 + int(point.neglected_effect)] == largest.name.replace(" ", "_")
    assert set(data.model_applies.values.tolist()) == {Validity.doubtful, Validity.does_not_apply}


def test_a_short_list_of_crossings_hides_no_effect():
    """The onset alone was in the list, and the arm was judged at rest."""
    arm = SILICONE | {"length": "10 cm"}
    short, whole = (rs.sweep("thresholds", arm=arm, crossings=count, progress=False) for count in (1, 8))
    for name in ("model_applies", "neglected_effect", "neglected_excess"):
        assert short[name].item() == whole[name].item()


SHORT_ROW = {
    "arm": SILICONE | {"length": "10 cm", "pressure": rs.linspace("1 kPa", "3 kPa", 5)},
    "gamma3": [0.002, 0.004],
    "curves": False,
}


@pytest.mark.parametrize("crossings", [1, 8])
def test_a_short_list_of_crossings_of_a_diagram_hides_no_effect(crossings):
    """The onset alone was in the list, and the arm was judged at rest."""
    data = rs.sweep("phase_diagram", **SHORT_ROW, crossings=crossings, progress=False)
    assert data.status.values.ravel().tolist() == [0 if crossings == 8 else 4] * 2
    if crossings == 8:
        assert (data.model_applies > Validity.applies).all()
        return
    assert (data.model_applies == UNKNOWN_VALIDITY_NUMBER).all()
    assert np.isnan(data.neglected_excess).all()
    validity = {v.name: data[v.name].values.ravel() for v in VALIDITY_VARIABLES}
    said = (
        "whether the model applies is not known at all 2 points: an unstable mode or a cycle may have been "
        "missed, and the neglected effects depend on the frequency of the motion"
    )
    assert validity_sentence(validity) == said
    mixed = {
        name: np.append(values, {"neglected_excess": np.nan}.get(name, 0))
        for name, values in validity.items()
    }
    assert validity_sentence(mixed) == "the model applies at 1 of 3 points; not known at 2 of 3 points"


ROW_THAT_RESTS = """
task: phase_diagram
phase_diagram: {curves: false}
parameters:
  arm: {length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 1 kPa s, density_difference: 0 kg/m^3,
    pressure: {start: 0 kPa, stop: STOP, num: 3}}
  gamma3: [1.0e-3, 2.0e-3]
"""
"""The arm flutters at 2.36 kPa."""


@pytest.mark.parametrize(
    ("stop", "said"),
    [
        ("5 kPa", "the model is doubtful on all 2 rows, judged at the first Hopf point of each row: "),
        ("2 kPa", "the model applies on all 2 rows, judged at rest without load"),
    ],
)
def test_show_says_at_which_loads_a_row_was_judged(command, stop, said):
    """Compression is doubtful above 1 kPa: a row without Hopf point "applies" where its loads are not."""
    command.write("a.yaml", ROW_THAT_RESTS.replace("STOP", stop))
    command.solved("a.yaml")
    lines = command("show", "a.h5").stdout.splitlines()
    assert any(line.startswith(said) for line in lines), lines[:6]
    assert "above 1 kPa compression is more than 0.1 times its limit, and the model is doubtful" in lines


def test_rows_with_and_without_a_hopf_point_are_counted():
    """At k1 = 100 the Hopf point is at 4.3 kPa, beyond the range."""
    arm = SILICONE | {"length": "10 cm", "viscosity": "1 kPa s", "pressure": rs.linspace("0 kPa", "4 kPa", 3)}
    data = rs.sweep("phase_diagram", arm=arm, k1=[100.0, 1600.0], curves=False, progress=False)
    view = view_of_dataset(data, Path("a.h5"))
    every = np.ones(data.status.shape, bool)
    assert judged_row_motion_clause(PointSelection(view, every)) == (
        ", judged at the first Hopf point of each row, and at rest without load on 1 row without"
    )
    assert judged_row_motion_clause(PointSelection(view, ~every)) == ""


def test_a_search_that_failed_is_no_arm_at_rest():
    made = job_of_tree(
        {
            "task": "thresholds",
            "parameters": {"arm": SILICONE | {"length": "10 cm"}},
            "thresholds": {"F_max": 10.0},
        }
    )
    solver = made.solver()
    record = solver.file_values_of_outcome(0, solver.solve(0))
    assert record["model_applies"] == Validity.applies
    judge = ArmValidity(made.config, made.points, solver.possible_statuses)
    failed = next(status for status in solver.possible_statuses if status.name == "failed")
    assert (
        judge.variables_of_points(record | {"status": int(failed)}, 0)["model_applies"]
        == UNKNOWN_VALIDITY_NUMBER
    )


def test_a_row_that_flutters_from_end_to_end_is_judged_by_no_rest():
    record = {"crossing_kind": np.zeros((1, 3)), "crossing_frequency": np.full((1, 3), np.nan)}
    record |= {"crossing_at": np.full((1, 3), np.nan)}
    row = MOTION_OF_TASK["phase_diagram"]
    flutter, oscillatory = (
        next(v for v, name in STABILITY_CLASSES if name == kind) for kind in ("flutter", "oscillatory")
    )
    assert row(record | {"class": np.array([[flutter] * 2])}).may_be_missed.tolist() == [True]
    assert row(record | {"class": np.array([[oscillatory] * 2])}).may_be_missed.tolist() == [False]
    back = record | {
        "crossing_kind": np.array([[1, HOPF_CROSSING_CODES[2], 0]]),
        "crossing_frequency": np.array([[1.0, -5.0, 0]]),
    }
    assert row(back | {"class": np.array([[flutter, oscillatory]])}).frequency.tolist() == [5.0]


@pytest.mark.parametrize(
    ("task", "more"),
    [("spectrum", {"modes": 4}), ("modes", {"nodes": 9}), ("limit_cycle", {"accuracy": 1e-3})],
)
def test_the_motion_is_that_of_the_task(task, more):
    arm = SILICONE | {"length": "10 cm", "pressure": ["0.1 kPa", "3 kPa"], "density_difference": "1 kg/m^3"}
    data = rs.sweep(task, arm=arm, **more)
    for i in (0, 1):
        point = data.isel(F=i).squeeze(drop=True)
        frequency = np.abs(np.atleast_1d(point.frequency.values))
        rate = next((w for w in frequency if w > 0), np.nan)
        arm_here = arm_at(point, density_difference=1.0)
        amplitude = np.nan_to_num(point.tip_y_max.item()) if task == "limit_cycle" else 0.5
        effects = neglected_effects(
            arm_here,
            angular_frequency_at_smallest_drag(arm_here, rate),
            data.F[i].item(),
            amplitude=amplitude,
        )
        assert point.model_applies == worst_validity(effects, of_cycles=task == "limit_cycle")
        counted = [e for e in effects if task == "limit_cycle" or not e.is_of_cycles_only]
        expected = np.nanmax([float(effect.value_over_limit) for effect in counted])
        assert point.neglected_excess.item() == pytest.approx(expected, rel=1e-12)


def test_an_arm_that_becomes_straight_is_judged_by_the_mode_that_decays():
    arm = {"length": "10 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "1 Pa s"}
    loaded = rs.Arm(**arm, pressure="0.9 of flutter")
    cycle, modes = loaded.cycle(accuracy=1e-3), loaded.modes()
    assert cycle.status == "straight"
    assert cycle.neglected_effect == modes.neglected_effect == "inertia_of_the_arm"
    assert cycle.neglected_excess == pytest.approx(modes.neglected_excess, rel=1e-6)
    assert cycle.model_applies == modes.model_applies == "does_not_apply"
    record = {"frequency": np.nan, "tip_y_max": np.nan, "linear_frequency": 2.0, "status": 2}
    assert np.isnan(MOTION_OF_TASK["limit_cycle"](record).frequency)  # a motion that has not settled


def test_the_leading_mode_that_oscillates_is_not_always_the_first():
    frequency = np.array([[0, 3, -3], [2, -2, 0], [0, 0, 0]])
    motion = MOTION_OF_TASK["spectrum"]({"frequency": frequency}).frequency
    assert motion == pytest.approx(np.array([3, 2, np.nan]), nan_ok=True)


def test_a_stiffness_beside_the_arm_is_what_is_compressed():
    arm = SILICONE | {"length": "10 cm", "viscosity": "1 kPa s", "pressure": "1 kPa"}
    data = rs.sweep("spectrum", arm=arm, k1=[100, 1600], modes=1)
    compression = data.F.item() / data.k1.values / 0.1
    assert data.neglected_excess.values.ravel() == pytest.approx(compression, rel=1e-12)
    assert data.model_applies.values.ravel().tolist() == [Validity.does_not_apply, Validity.doubtful]


def test_branches_and_diagrams_are_judged_too():
    arm = SILICONE | {"length": "10 cm"}
    branch = rs.sweep("branch", arm=arm, stop=45, cycles=60, accuracy=1e-4)
    fastest = np.nanmax(2 * np.pi / branch.period.values)
    here = arm_at(branch)
    effect = neglected_effects(here, angular_frequency_at_smallest_drag(here, fastest), 0.0)[0]
    assert branch.neglected_excess.item() >= float(effect.value_over_limit) * (1 - 1e-12)
    diagram = rs.sweep(
        "phase_diagram", arm=arm | {"pressure": rs.linspace("1 kPa", "3 kPa", 5)}, gamma3=[0.002, 0.004],
        curves=False,
    )  # fmt: skip
    single = rs.sweep("thresholds", arm=arm, gamma3=[0.002, 0.004])
    assert diagram.neglected_excess.values.ravel() == pytest.approx(
        single.neglected_excess.values.ravel(), rel=1e-6
    )


def test_check_tells_before_the_run_what_can_be_known(command):
    command.write("a.yaml", HEAVY)
    told = " ".join(command("check", "a.yaml").stdout.split())
    found = re.search(r"the model does not apply at (\d) of 6 points at rest: weight is", told)
    assert "not_slender at 2 of 8 points: the arm is shorter than 10 radii" in told
    assert "does not apply" not in command("check", command.write("b.yaml", MAP)).stdout
    command.solved("a.yaml")
    data = rs.open(command.directory / "a.h5")
    outside = (data.model_applies == Validity.does_not_apply) & (data.status == 0)
    assert int(found[1]) == outside.sum()


def span(text, data):
    """(low, high) of what a sentence says, compared with data to its three digits."""
    low, high = (float(number) for number in text)
    assert low == pytest.approx(float(data.min()), rel=6e-3)
    assert high == pytest.approx(float(data.max()), rel=6e-3)


def test_show_begins_with_the_answer_in_the_units_that_were_typed(command):
    command.write("a.yaml", MAP)
    command.solved("a.yaml")
    first, second, *_ = command("show", "a.h5").stdout.splitlines()[1:]
    data = rs.open(command.directory / "a.h5")
    rods = data.status == 0
    outside = int((rods & (data.model_applies == Validity.does_not_apply)).sum())
    number = r"([\d.]+)"
    worst = re.fullmatch(
        rf"the model does not apply at {outside} of 6 points: inertia of the arm is up to {number} times its "
        "limit",
        first,
    )
    assert float(worst[1]) == pytest.approx(float(data.neglected_excess.max()), rel=6e-2)
    found = re.fullmatch(
        rf"where the model applies: flutter begins at {number} to {number} kPa; "
        rf"there the arm beats at {number} to {number} Hz",
        second,
    ).groups()
    inside = data.where(rods & (data.model_applies != Validity.does_not_apply))
    span(found[:2], inside.pressure_hopf / 1e3)
    span(found[2:], inside.frequency_hopf_hz)


def test_show_of_an_arm_in_water_says_nothing_without_reservation(command):
    command.write("w.yaml", MAP.replace("viscosity: 4 Pa s", "viscosity: 1 mPa s"))
    command.solved("w.yaml")
    first, second, *_ = command("show", "w.h5").stdout.splitlines()[1:]
    assert first.startswith("the model does not apply at all 6 points: inertia of the arm is up to")
    assert second.startswith("if the model applied: flutter begins at ")


@pytest.mark.parametrize(
    ("task", "arm", "more", "told"),
    [
        ("limit_cycle", "pressure: [1 kPa, 2.5 kPa]", "accuracy: 1.0e-3", "beats at 2 of 4 points at"),
        (
            "spectrum",
            "force: [80 mN, 200 mN]",
            "",
            "the straight arm is unstable at 2 of 4 points; its leading mode oscillates at",
        ),
        ("criticality", "", "", "flutter begins at"),
        ("branch", "", "branch: {stop: 40, cycles: 40}\naccuracy: 1.0e-3", "cycles, stable or not, exist at"),
        ("thresholds", "poisson: 0.4", "thresholds: {F_max: 32}", "does not flutter up to 1.81 to 2 kPa"),
    ],
)
def test_show_answers_of_every_task(command, task, arm, more, told):
    quantities = f"length: [10 cm, 10.5 cm], radius: 5 mm, young: 100 kPa, viscosity: 40 Pa s, {arm}"
    command.write("a.yaml", f"task: {task}\nparameters: {{arm: {{{quantities}}}}}\n{more}\n")
    command.solved("a.yaml")
    lines = command("show", "a.h5").stdout.splitlines()[1:3]
    assert any(line.startswith("the model ") for line in lines)
    assert any(line.startswith(told) for line in lines)


def test_show_of_a_diagram_without_flutter_says_up_to_which_load(command):
    quantities = "length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 40 Pa s, poisson: [0.4, 0.5]"
    loads = "pressure: {start: 0 kPa, stop: 1 kPa, num: 3}"
    command.write("a.yaml", f"task: phase_diagram\nparameters: {{arm: {{{quantities}, {loads}}}}}\n")
    command.solved("a.yaml")
    assert "does not flutter up to 1 kPa\n" in command("show", "a.h5").stdout


@pytest.mark.parametrize(
    ("stop", "more", "said"),
    [
        ("15 kPa", "", "above 10 kPa compression exceeds its limit, and the model does not apply"),
        ("15 kPa", ", tip_radius: 4 mm", "above 10 kPa compression"),  # the load on the tip's face
        ("9 kPa", "", ""),
        ("15 kPa", ", law: neo_hookean, section: swelling", ""),  # the law includes large compression
    ],
    ids=["cylinder", "cone", "small loads", "rubber"],
)
def test_show_of_a_diagram_says_above_which_load_an_arm_is_compressed_too_much(command, stop, more, said):
    """A pressure p on the face of the tip compresses the tip, the weakest section, by p/E: 0.1 at 10 kPa."""
    quantities = f"length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 40 Pa s{more}"
    loads = f"pressure: {{start: 0 kPa, stop: {stop}, num: 3}}"
    rows = "gamma3: [1.0e-3, 2.0e-3]"
    command.write("a.yaml", f"task: phase_diagram\nparameters: {{arm: {{{quantities}, {loads}}}, {rows}}}\n")
    checked = " ".join(command("check", "a.yaml").stdout.split())
    assert ("and compression, by the loads of the rows" in checked) == ("law" not in more)
    command.solved("a.yaml")
    lines = command("show", "a.h5").stdout.splitlines()
    found = [line for line in lines if "compression exceeds" in line]
    assert len(found) == bool(said)
    assert all(line.startswith(said) for line in found)
    doubtful = "above 1 kPa compression is more than 0.1 times its limit, and the model is doubtful"
    assert lines.count(doubtful) == ("law" not in more)
    judged = r"the model .* on all 2 rows, judged at the first Hopf point of each row(:|$)"
    assert any(re.match(judged, line) for line in lines)  # these loads are smaller than most of the rows


def test_lines_that_are_asked_for_over_an_arm_name_what_draws_them(command):
    command.write("a.yaml", MAP)
    command.solved("a.yaml")
    refused = command.drawn("plot", "a.h5", "--what", "lines")
    assert refused.returncode == 2
    assert (
        "--what lines is not for a grid over an arm's quantities; remove --what or draw lines over"
        in refused.stderr
    )


@pytest.mark.parametrize(("height", "told"), few([("[5 mm, 7 mm]", 1), ("5 mm", 0), ("8 mm", 1)], 2))
def test_a_rectangle_that_gives_way_first_in_the_other_plane_is_said_to(command, height, told):
    quantities = f"length: 15 cm, width: 6 mm, height: {height}, young: 60 kPa, viscosity: 40 Pa s"
    command.write("a.yaml", f"task: thresholds\nparameters: {{arm: {{{quantities}}}}}\n")
    said = "the arm flutters first in the other plane, at a lower load"
    assert command("check", "a.yaml").stdout.count(said) == told
    command.solved("a.yaml")
    assert command("show", "a.h5").stdout.splitlines()[1].count(said) == told


def test_a_rectangle_in_python_is_said_to_give_way_first_in_the_other_plane():
    flat = rs.Arm(length="15 cm", width="5 mm", height="8 mm", young="60 kPa", viscosity="40 Pa s")
    first, second = flat.turned.thresholds(), flat.thresholds()
    assert "flutters first in the plane of its width" in " ".join(str(second).split())
    assert "flutters first" not in str(first)
    assert first.pressure_hopf < second.pressure_hopf


def figure_of(drawn, path, output, **choice):
    """The figure of a file, not written, with its legend and labels."""
    draw(read_view(path), output, **choice)
    drawn[-1].draw_without_rendering()
    return drawn[-1]


def test_a_map_of_arms_has_typed_units_and_hatches(command, drawn):
    command.write("a.yaml", MAP)
    command.solved("a.yaml")
    figure = figure_of(drawn, command.directory / "a.h5", command.directory / "f.png")
    labels = {axes.get_xlabel() for axes in figure.axes} | {axes.get_ylabel() for axes in figure.axes}
    assert {"length (cm)", "Young's modulus (kPa)", "pressure at flutter (kPa)"} <= labels
    words = {text.get_text() for text in figure.legends[0].get_texts()}
    assert words == {"model doubtful", "model does not apply", "shorter than 10 radii"}
    mesh = figure.axes[0].collections[0]
    data = rs.open(command.directory / "a.h5")
    values = np.ma.masked_invalid(data.pressure_hopf.values.T / 1e3)
    assert np.ma.allclose(mesh.get_array().reshape(values.shape), values)


def test_lines_over_one_quantity(command, drawn):
    command.write("a.yaml", MAP.replace("[50 kPa, 100 kPa]", "50 kPa"))
    command.solved("a.yaml")
    figure = figure_of(drawn, command.directory / "a.h5", command.directory / "f.png")
    data = rs.open(command.directory / "a.h5")
    x, y = figure.axes[0].lines[0].get_data()
    assert x == pytest.approx(data.length.values * 100)
    assert y == pytest.approx(data.pressure_hopf.values / 1e3, nan_ok=True)
    assert [axes.get_ylabel() for axes in figure.axes] == ["pressure (kPa)", "frequency at flutter (Hz)"]


def test_figures_over_F_are_hatched_where_the_model_does_not_apply(command, drawn):
    arm = "length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 4 Pa s"
    load = "pressure: {start: 0 kPa, stop: 4 kPa, num: 21}"
    command.write("a.yaml", f"task: spectrum\nparameters: {{arm: {{{arm}, {load}}}}}\n")
    command.solved("a.yaml")
    figure = figure_of(drawn, command.directory / "a.h5", command.directory / "f.png")
    data = rs.open(command.directory / "a.h5")
    outside = data.F.values[(data.model_applies == Validity.does_not_apply).values.ravel()]
    doubtful = data.F.values[(data.model_applies == Validity.doubtful).values.ravel()]
    for pattern, forces in (("////", outside), ("...", doubtful)):
        (hatched,) = (cells for cells in figure.axes[0].collections if cells.get_hatch() == pattern)
        assert len(hatched.get_paths()) == len(forces) > 0
        for path, F in zip(hatched.get_paths(), forces, strict=True):
            box = path.get_extents()
            assert box.x0 < F < box.x1
    assert "hatched: the model does not apply\ndotted: the model is doubtful" in figure.get_suptitle()


@pytest.mark.parametrize(
    ("stop", "law", "hatched"), [("15 kPa", "", True), ("9 kPa", "", False), ("15 kPa", "neo_hookean", False)]
)
def test_a_diagram_is_hatched_where_the_load_compresses_the_arm_too_much(command, drawn, stop, law, hatched):
    """Above 10 kPa, a tenth of Young's modulus; the rows are judged at their first Hopf points, 2 kPa."""
    arm = f"length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 1 kPa s{law and f', law: {law}'}"
    loads = f"pressure: {{start: 0 kPa, stop: {stop}, num: 4}}"
    rows = "gamma3: [1.0e-3, 2.0e-3]"
    command.write("d.yaml", f"task: phase_diagram\nparameters: {{arm: {{{arm}, {loads}}}, {rows}}}\n")
    command.solved("d.yaml")
    figure = figure_of(drawn, command.directory / "d.h5", command.directory / "f.png")
    areas = [each for each in figure.axes[0].collections if any(getattr(each, "hatches", [None]) or [None])]
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(areas) == legend.count("compression beyond its limit") == hatched
    for area in areas:
        x = np.concatenate([path.vertices for path in area.get_paths()])[:, 0]
        k1 = rs.open(command.directory / "d.h5").k1.item()
        assert x.min() == pytest.approx(0.1 * k1, rel=0.01)


def test_a_diagram_over_poissons_ratio_has_the_arm_a_scale_of_the_ratio_and_dots(command, drawn):
    command.write("d.yaml", DIAGRAM_OVER_POISSON)
    command.solved("d.yaml")
    figure = figure_of(drawn, command.directory / "d.h5", command.directory / "f.png")
    title = figure.get_suptitle().replace("\xa0", " ")
    assert "length 14 cm, radius 4 mm, Young's modulus 100 kPa, viscosity 5 Pa s" in title
    assert title.endswith("\ndotted: the model is doubtful, judged at each row's first Hopf point or at rest")
    (axes,) = (axes for axes in figure.axes if axes.collections)
    assert "..." in {cells.get_hatch() for cells in axes.collections}
    (scale,) = (child for child in axes.child_axes if child.get_ylabel() == "Poisson's ratio")
    texts = [label.get_text() for label in scale.get_yticklabels()]
    assert len(texts) >= 3
    for text, k2 in zip(texts, scale.get_yticks(), strict=True):
        arm = SlenderArm(length=0.14, radius=4e-3, young=1e5, viscosity=5, poisson=float(text))
        assert k2 == pytest.approx(arm.k2, rel=1e-9)


def test_roots_are_drawn_over_the_points_of_a_grid_with_what_varies(command, drawn):
    arm = "length: [10 cm, 12 cm], radius: [4 mm, 5 mm], young: 100 kPa, viscosity: 4 Pa s, pressure: 1 kPa"
    command.write("a.yaml", f"task: spectrum\nparameters: {{arm: {{{arm}}}}}\n")
    command.solved("a.yaml")
    figure = figure_of(drawn, command.directory / "a.h5", command.directory / "f.png", roots="all")
    (axes,) = (axes for axes in figure.axes if "radius" in axes.get_xlabel())
    assert axes.get_xlabel() == "length (cm)\nradius (mm)"
    places = [label.get_text() for label in axes.xaxis.get_ticklabels()]
    assert places == ["10\n4", "10\n5", "12\n4", "12\n5"]


def test_a_thin_wall_ends_the_model_where_the_arm_beats_widely(command):
    """5.2 times the limit at the stored amplitude; the thresholds of the same tube are not concerned."""
    tube = (
        "length: 24 cm, radius: 6 mm, inner_radius: 5.5 mm, young: 80 kPa, poisson: 0.49, viscosity: 20 Pa s"
    )
    command.write(
        "w.yaml",
        f"task: limit_cycle\nparameters: {{arm: {{{tube}, pressure: 1.2 of flutter}}}}\naccuracy: 1.0e-4\n",
    )
    command.solved("w.yaml")
    view = read_view(command.directory / "w.h5")
    amplitude = view.variables["tip_y_max"].item()
    bend, middle, wall = 6 * amplitude / 0.24, 0.00575, 0.0005
    lost = 1.5 * (1 - 0.49**2) * (bend * middle**2 / wall) ** 2
    assert view.variables["neglected_excess"].item() == pytest.approx(lost / 0.1, rel=1e-12)
    assert view.variables["model_applies"].item() == Validity.does_not_apply
    shown = command("show", "w.h5").stdout.splitlines()[1:3]
    assert shown[0] == "the model does not apply: flattening of the wall is 5.2 times its limit"
    assert shown[1].startswith("if the model applied: beats at")
    assert command("check", "w.yaml").stdout.count("the section flattens") == 1
    command.write("t.yaml", f"task: thresholds\nparameters: {{arm: {{{tube}}}}}\n")
    command.solved("t.yaml")
    assert "flattening" not in command("show", "t.h5").stdout.splitlines()[1]
    solid = rs.sweep("thresholds", arm=SILICONE | {"length": "10 cm"})
    assert solid.neglected_effect.attrs["flag_meanings"].split()[-2] == "flattening_of_the_wall"


def test_a_pull_neglects_an_extension_and_a_push_a_compression(command):
    """Of an arm under a pull the file said that the model neglects its compression."""
    for pressure, word in (("-20 kPa", "extension"), ("20 kPa", "compression")):
        data = rs.sweep("spectrum", arm=SILICONE | {"length": "20 cm", "pressure": pressure}, progress=False)
        words = data.neglected_effect.attrs["flag_meanings"].split()
        assert words[1 + data.neglected_effect.item()] == word


STATUSES = {
    "limit_cycle": (
        ("cycle", "not_settled", "beats at 1 of 2 points at"),
        ("straight", "straight", "does not beat at 2 of 2 points"),
        ("not_settled", "straight", "is not settled", "does not beat at 1 of 2 points"),
        (
            "not_settled",
            "not_settled",
            "is not settled: no stable cycle was found, but a stable cycle may exist at 2 of 2",
        ),
        (
            "torus",
            "left_the_model",
            "beats quasiperiodically (two frequencies) at 1 of 2",
            "is crushed somewhere",
        ),
        ("failed", "unstable", "is not known: the solve failed at 1 of 2", "has an unstable cycle"),
    ),
    "spectrum": (
        (
            2,
            -1,
            "the straight arm is unstable at 1 of 2 points",
            "whether the straight arm is stable is not known at 1 of 2 points",
        ),
        (-1, -1, "whether the straight arm is stable is not known at 2 of 2 points"),
        (0, -1, "whether the straight arm is stable is not known at 1 of 2 points"),
        (0, 0, "the straight arm is stable"),
    ),
    "thresholds": (
        ("ok", "failed", "flutter begins", "the result is not known at 1 of 2 points: the search failed"),
        ("failed", "failed", "the result is not known at 2 of 2 points: the search failed"),
    ),
    "branch": (
        (
            "ok",
            "failed",
            "cycles, stable or not, exist at",
            "the result is not known at 1 of 2 points: the search failed",
        ),
        ("failed", "failed", "the result is not known at 2 of 2 points: the search failed"),
    ),
}
"""What two points have, and how the lines of the answer begin."""
FALSE_IF_NOT_SOLVED = (
    "does not flutter",
    "the straight arm is stable",
    "does not beat at 2",
    "has no branch",
)


@pytest.mark.long
@pytest.mark.parametrize("task", STATUSES)
def test_what_is_not_solved_is_not_said_to_stay_straight(command, task):
    """Numbers that are not there are no proof of rest: of every status and task."""
    varied = "pressure: [2.4 kPa, 2.5 kPa]" if task in ("limit_cycle", "spectrum") else "poisson: [0.4, 0.5]"
    quantities = f"length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 40 Pa s, {varied}"
    more = {"branch": "branch: {stop: 37}\naccuracy: 1.0e-3\n", "limit_cycle": "accuracy: 1.0e-3\n"}.get(
        task, ""
    )
    command.write("a.yaml", f"task: {task}\nparameters: {{arm: {{{quantities}}}}}\n{more}")
    command.solved("a.yaml")
    view = read_view(command.directory / "a.h5")
    values = {word: value for value, word in view.status_flags.items()}
    for first, second, *expected in STATUSES[task]:
        changed = dict(view.variables)
        if task == "spectrum":
            changed["unstable_count"] = np.reshape([first, second], view.variables["status"].shape)
        else:
            codes = [values[first], values[second]]
            changed["status"] = np.reshape(codes, view.variables["status"].shape)
            for place in np.argwhere(changed["status"] == values.get("failed")):
                for name in ("crossing_kind", "F_hopf", "pressure_hopf", "branch_pressure"):
                    if name in changed:
                        changed[name] = changed[name].copy()
                        changed[name][tuple(place)] = 0 if name == "crossing_kind" else np.nan
        done = np.ones(view.variables["status"].shape, bool)
        lines = arm_answer(PointSelection(replace(view, variables=changed), done))
        for words in expected:
            assert any(line.startswith(words) or words in line for line in lines), (lines, words)
        if "failed" in (first, second) or "not_settled" in (first, second) or -1 in (first, second):
            assert not any(line.startswith(FALSE_IF_NOT_SOLVED) for line in lines), lines
