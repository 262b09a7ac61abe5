"""`rodsweep show` tells the answer: the numbers of a single point, the headline of a grid, every status."""

import re
from dataclasses import replace
from math import inf
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import ROOT
from shown import HOPF, STABLE_AGAIN, shown

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.post.located_thresholds import BracketedThreshold, LocatedThreshold, StoredThresholds
from rodsweep.post.summary import summary_of
from rodsweep.post.summary.number_texts import axis_values_text, number_with_error_text
from rodsweep.post.summary.selection import PointSelection
from rodsweep.post.summary.stability import rod_and_arm_stability_lines
from rodsweep.post.summary.thresholds import oscillation_end_index
from rodsweep.post.summary.variable_errors import absolute_errors
from rodsweep.results.file.provenance import example_failure_sentence
from rodsweep.results.file.view import read_view
from rodsweep.solve.changes.status import ThresholdStatus
from rodsweep.sweep.points.points import lines_along
from rodsweep.sweep.progress import ProgressReporter
from rodsweep.tasks.running.job import job_of_file

ROD = "k1: 200, k2: 1.0e4, gamma3: 1.0e-4"


def test_the_thresholds_of_the_demo_come_out_of_show(command):
    told = shown(command, (ROOT / "configs" / "fig2c.yaml").read_text())
    hopf, again = (
        float(re.search(rf"{re.escape(words)}: ([\d.]+) \(\+- \de-1[34]\)", told)[1])
        for words in (
            "F** (straight rod starts to flutter)",
            "restabilization (straight rod is stable again)",
        )
    )
    assert hopf == pytest.approx(HOPF, abs=1e-12)
    assert again == pytest.approx(STABLE_AGAIN, abs=1e-12)
    assert "frequency 334.321 rad/tau2" in told
    assert "by a zero of the characteristic determinant" in " ".join(told.split())


@pytest.mark.long
@pytest.mark.parametrize("step", [0.5, 7, 45])
@pytest.mark.parametrize("certify", ["true", "false"])
def test_thresholds_between_grid_points_do_not_depend_on_the_grid(command, step, certify):
    forces = [round(1.3 + step * i, 3) for i in range(int(198 / step) + 1)]
    config = f"task: spectrum\nparameters: {{F: {forces}, {ROD}}}\nspectrum: {{certify: {certify}}}\n"
    shown(command, config)
    view = read_view(command.directory / "c.h5")
    (line,) = lines_along(view.point_columns, "F")
    found = [
        change
        for change in StoredThresholds(view, "F").thresholds_on_line(line)
        if isinstance(change, LocatedThreshold) and change.changes_stability
    ]
    assert [point.kind for point in found] == ["hopf", "restabilization"]
    for point, exact in zip(found, (HOPF, STABLE_AGAIN), strict=True):
        assert abs(point.position - exact) <= point.position_error + 1e-12
        assert point.position_error < 1e-12


def test_changes_do_not_depend_on_how_points_are_given(command):
    """A grid whose longest axis is another one than F, and the same points as a list in another order."""
    k1 = [180.0, 200, 400, 600, 800, 1e3, 2e3, 4e3, 1e4]
    axes = {"F": [20.0, 40, 60, 150, 170], "k1": k1, "k2": [1e2, 1e4]}
    grid = ", ".join(f"{name}: {values}" for name, values in axes.items())
    rods = [(F, first, k2) for k2 in axes["k2"] for F in reversed(axes["F"]) for first in k1]
    command.write("p.csv", "F,k1,k2,gamma3\n" + "".join(f"{F},{k1},{k2},1e-4\n" for F, k1, k2 in rods))
    found = []
    for number, parameters in enumerate((f"{{{grid}, gamma3: 1.0e-4}}", "{points: p.csv}")):
        command.write("c.yaml", f"task: spectrum\nparameters: {parameters}\n")
        assert command("run", "c.yaml", "-o", f"{number}.h5").returncode == 0
        v = read_view(command.directory / f"{number}.h5").variables
        rows = zip(*(v[f"change_{name}"] for name in ("k1", "k2", "kind", "F", "frequency")), strict=True)
        found.append(sorted(tuple(map(float, row)) for row in rows))
    assert len(found[0]) == len(found[1]) > len(k1)
    assert np.array(found[0]) == pytest.approx(np.array(found[1]), rel=1e-11)


def test_an_unfinished_file_says_between_which_forces_stability_changes(command):
    """Of two shards the first has the first point of a line and misses the others."""
    command.write("c.yaml", f"task: spectrum\nparameters: {{F: [40, 45, 60, 70], {ROD}}}\n")
    parts = [("1.h5", "1/2"), ("2.h5", "2/2")]
    for output, shard in parts:
        assert command("run", "c.yaml", "-o", output, "--shard", shard).returncode == 0
        view = read_view(command.directory / output)
        assert "change_F" not in view.variables
    view.variables["growth_rate"][:] = np.array([-1.0, -1, 1, 1]).reshape(-1, 1, 1, 1, 1)
    (line,) = lines_along(view.point_columns, "F")
    assert StoredThresholds(view, "F").thresholds_on_line(line) == [BracketedThreshold(45, 60, "hopf")]
    assert command("merge", "all.h5", "1.h5", "2.h5").returncode == 0
    assert "flutter): 49.758004916" in command("show", "all.h5").stdout


def test_a_change_that_is_not_understood_is_a_bracket(command):
    """Here another mode is said to be unstable: one zero of D does not explain that."""
    shown(command, f"task: spectrum\nparameters: {{F: [40, 60], {ROD}}}\n")
    view = read_view(command.directory / "c.h5")
    view.variables["unstable_count"][-1] = 4
    located = job_of_file(command.directory / "c.yaml", ()).task.variables_from_points(view.variables)
    view = replace(view, variables=dict(view.variables) | {v.name: values for v, values in located})
    (line,) = lines_along(view.point_columns, "F")
    assert StoredThresholds(view, "F").thresholds_on_line(line) == [BracketedThreshold(40, 60, "hopf")]
    (told,), _ = rod_and_arm_stability_lines(view, "F", StoredThresholds(view, "F").thresholds_on_line)
    assert told == "F** (straight rod starts to flutter): between 40 and 60"


def test_thresholds_of_several_lines_are_named_by_what_differs(command):
    config = "task: modes\nparameters: {F: [30, 60], k1: [200, .inf], k2: 1.0e4, gamma3: 1.0e-4}\n"
    told = shown(command, config)
    assert re.search(r"flutter\): 49\.7580049161?\d+ for k1 = 200, 37\.5155341729\d+ for k1 = inf", told)


def test_eigenvalues_of_a_single_point_are_told_with_errors_and_count(command):
    told = shown(command, f"task: spectrum\nparameters: {{F: 60, {ROD}}}\n")
    assert re.search(r"^1 +72\.04009792307\d* +\de-1\d +433\.79628096374\d* +\de-1\d$", told, re.MULTILINE)
    assert re.search(r"^4 +-19940\.00335896\d* +\de-1\d +0$", told, re.MULTILINE)
    assert re.search(r"^mode +growth rate +\+- +frequency +\+-\n +1/tau2 +rad/tau2$", told, re.MULTILINE)
    assert "unstable modes: 2, proved by a winding number" in told


def test_modes_of_a_single_point_are_told_with_their_eigenvalues(command):
    told = shown(command, f"task: modes\nparameters: {{F: 30, {ROD}}}\n")
    assert re.search(r"^1 +-115\.51902382007\d* +\de-1\d +151\.864644304\d* +\de-1\d$", told, re.MULTILINE)
    assert "unstable modes: 0, proved" in told
    assert "largest transient growth: 1.26004 times" in told


def test_the_time_of_a_growth_that_is_hardly_known_from_1_is_not_told():
    """Of a parabola from 1 up to 1.001 the error 1e-5 hides the top but for a tenth of its time."""
    v = {
        "transient_growth": np.array([1.001, 1.00005]),
        "transient_time": np.array([2.0, 0.04]),
        "growth_error": np.array([1e-5, 2e-4]),
    }
    view = SimpleNamespace(variables=v)
    assert absolute_errors(v, "transient_time")[0] == pytest.approx(0.2, rel=1e-3)
    assert PointSelection(view, np.array([True, True])).range_text("transient_time") == "2"
    assert PointSelection(view, np.array([False, True])).range_text("transient_time") == "none"


@pytest.mark.long
@pytest.mark.parametrize("task", ["spectrum", "modes"])
@pytest.mark.parametrize("listed", [False, True])
def test_several_points_are_told_by_how_many_are_stable(command, task, listed):
    """Of three rods the second flutters; a list says the same as the grid."""
    command.write("p.csv", "F,k1,k2,gamma3\n30,200,1e4,1e-4\n100,200,1e4,1e-4\n180,200,1e4,1e-4\n")
    points = "points: p.csv" if listed else f"F: [30, 100, 180], {ROD}"
    told = shown(command, f"task: {task}\nparameters: {{{points}}}\n{task}: {{modes: 1}}\n")
    assert "straight rod, of 3 points: stable at 2 (F = 30 to 180), unstable at 1 (F = 100)" in told
    low, high = map(
        float, re.search(r"leading growth rate (-[\d.]+) to ([\d.]+) 1/tau2, frequency", told).groups()
    )
    assert low < 0 < high


def test_phase_diagram_is_told_by_its_shares_and_where_it_flutters(command):
    """The window of configs/fig4.yaml closes at k1 = 147.92; exact thresholds of k1 = 200 lie in between."""
    told = shown(
        command,
        "task: phase_diagram\nparameters: {F: {start: 0, stop: 199, num: 200}, k1: [100, 140, 200, 400],"
        " k2: 1.0e4, gamma3: 1.0e-4}\n",
    )
    shares = re.findall(r"([\d.]+) % \w+", re.search("% of the grid points: (.*)", told)[1])
    assert sum(map(float, shares)) == pytest.approx(100, abs=0.25)
    assert "flutter: on 2 of 4 rows, k1 = 200 to 400; none on 2, k1 = 100 to 140" in told
    low, high = map(
        float,
        re.search(r"\nhopf \(.*\): on 2 of 4 rows, F = ([\d.]+) to ([\d.]+), k1 = 200 to 400", told).groups(),
    )
    assert high == pytest.approx(HOPF, abs=1e-4)
    assert low < high
    meaning = "the last unstable pair becomes stable"
    assert f"restabilization ({meaning}): on 1 of 4 rows, F = {STABLE_AGAIN:.6g}, k1 = 200" in told
    assert "where the rows begin" not in told


def test_rows_tell_first_changes_apart_from_later_ones_and_what_was_before_them(command):
    """At k1 = 140 the rod stops oscillating at F = 120.5 and begins again at F = 137.57."""
    config = (
        "task: phase_diagram\nparameters: {{F: {{start: {start}, stop: 180, num: 4}}, k1: [140, 200],"
        " k2: 1.0e4, gamma3: 1.0e-4}}\nphase_diagram: {{curves: false}}\n"
    )
    told = shown(command, config.format(start=0))
    first = "onset of oscillations: on 2 of 2 rows, F = 22.471 to 24.0686, k1 = 140 to 200"
    assert f"\n{first}; again further along the row on 1 of these rows, at F = 137.568\n" in told
    command.write("c.yaml", config.format(start=30))
    command("run", "c.yaml", "--fresh")
    told = command("show", "c.h5").stdout
    assert "the straight rod at F = 30, where the rows begin: oscillatory on 2 of 2 rows" in told
    assert "onset of oscillations: on 1 of 2 rows, F = 137.568, k1 = 140\n" in told


def test_a_window_of_flutter_between_two_grid_points_is_flutter_of_its_row(command):
    config = "F: [0, 60, 100], k1: [100, 150, 300], k2: 1.0e4, gamma3: 1.0e-4"
    text = shown(command, f"task: phase_diagram\nparameters: {{{config}}}\n")
    assert (
        "restabilization (the last unstable pair becomes stable): on 1 of 3 rows, F = 85.5693, k1 = 150"
        in text
    )
    assert "flutter: on 2 of 3 rows, k1 = 150 to 300; none on 1, k1 = 100\n" in text


TWO_WINDOWS = {"k1": 179.13147682127965, "k2": 1731.448934345779, "gamma3": 0.0003002436554066619}


def test_a_second_window_of_flutter_is_in_the_answer(command):
    rod = ", ".join(f"{name}: {value!r}" for name, value in TWO_WINDOWS.items())
    text = shown(command, f"task: thresholds\nparameters: {{{rod}}}\n")
    assert "flutter from F = 49.785, stable again from F = 161.376, flutter again from F = 174; " in text
    answer = " ".join(str(rs.Rod(**TWO_WINDOWS).thresholds()).split())
    again = "stable again from F = 161.376 k3/L^2, flutter again from F = 174 k3/L^2 "
    assert again in answer
    one = " ".join(str(rs.Rod(**TWO_WINDOWS | {"k1": 170.0}).thresholds(F_max=165)).split())
    assert "again from" in one
    assert "flutter again" not in one


def test_thresholds_tell_where_they_rise_and_fall(command):
    told = shown(command, "task: thresholds\nparameters: {k1: [150, 200, 300], k2: 1.0e4, gamma3: 1.0e-4}\n")
    assert "F_hopf rises with k1 on 0 of 1 line of rods, falls on 1\n" in told


def test_thresholds_that_differ_by_less_than_a_rounding_error_are_constant(command):
    told = shown(command, "task: thresholds\nparameters: {k1: [1e14, 1e15, 1e16], k2: 100, gamma3: 1.0e-3}\n")
    assert "F_hopf rises with k1 on 0 of 1 line of rods, is constant on 1\n" in told


def test_thresholds_of_a_single_rod_are_told_one_by_one(command):
    told = shown(command, f"task: thresholds\nparameters: {{{ROD}}}\n")
    row = r"^(\w+) +([\d.]+) +\de-1[34] +-?[\d.]+ +[\d.]+ +(\d)$"
    found = re.findall(row, told, re.MULTILINE)
    assert "hopf: a pair becomes unstable\n" in told
    assert [(kind, count) for kind, _, count in found] == [
        ("onset", "0"),
        ("hopf", "2"),
        ("restabilization", "0"),
    ]
    assert [float(F) for _, F, _ in found] == pytest.approx([22.4709774737663, HOPF, STABLE_AGAIN], abs=1e-12)
    assert "the list of crossings is proved complete" in told


def test_the_first_lines_say_where_an_oscillation_ends(command):
    """Beyond F = 94.14 a real eigenvalue leads again, and a disturbance decays without oscillation."""
    values = {"k1": 100, "k2": 1e4, "gamma3": 0.05}
    config = "task: thresholds\nparameters: {k1: 100, k2: 1.0e4, gamma3: 0.05}\nthresholds: {F_max: 99}\n"
    told = shown(command, config)
    assert "\ndecaying oscillation from F = 14.7897 to 94.1445; 2 crossings up to F = 99\n" in told
    answer = rs.Rod(**values).thresholds(F_max=99)
    first_line = "decaying oscillation from F = 14.7897 k3/L^2 to 94.1445 k3/L^2\n"
    assert repr(answer).startswith(first_line)
    [below, above] = [rs.Rod(F=F, **values).spectrum(modes=2).data["frequency"].max() for F in (94.14, 94.15)]
    assert below > 0 == above


@pytest.mark.parametrize(
    ("kinds", "end"),
    [
        (["onset", "real_again"], 1),
        (["pair_leads", "onset", "real_leads", "hopf"], 2),
        (["onset", "hopf", "restabilization", "real_again"], None),
        (["onset"], None),
        (["hopf", "restabilization"], None),
    ],
)
def test_an_oscillation_ends_at_the_next_crossing_if_a_real_eigenvalue_leads_there(kinds, end):
    assert oscillation_end_index(kinds) == end


@pytest.mark.parametrize(
    ("text", "values", "shown_text"),
    [
        ("147.9215196832", [147.92151969, 147.9215196832], "147.9215196832"),
        ("0.1234567891234567", [0.1234567891234567, 0.5], "0.123456789"),
        ("0.1234567891234567", [0.1234567891234567, 0.1234567891234569], "0.1234567891234567"),
        ("30.0", [30.0], "30"),
        ("inf", [1.0, inf], "inf"),
    ],
)
def test_parameters_of_a_failed_point_are_those_of_no_other_point(text, values, shown_text):
    line = example_failure_sentence(f"k1={text}, F=2.0: failed why", {"k1": np.array(values)})
    assert line == f"failed, for example at k1 = {shown_text}, F = 2: why"


def test_a_single_cycle_is_told_with_its_verdict(command):
    told = shown(
        command,
        "task: limit_cycle\nparameters: {F: 50, k1: 1.0e4, k2: 100, gamma3: 0.01}\naccuracy: 1.0e-5\n",
    )
    period = re.search(r"period +(0\.0344\d*) +\de-\d\d +tau2", told)
    last_digit = 10.0 ** -(len(period[1]) - 2)
    assert float(period[1]) == pytest.approx(0.034450429, abs=last_digit)
    assert re.search(r"largest y of the tip +0\.645\d* +\de-\d\d +L", told)
    assert re.search(r"the cycle is stable in the plane: .* multiplier is below 1", told)


def test_all_statuses_are_listed_on_request(command):
    config = f"task: thresholds\nparameters: {{{ROD}}}\n"
    names = [status.name for status in ThresholdStatus]
    told = shown(command, config, "--statuses")
    assert [name for name in names if not re.search(rf"^{name} +\d", told, re.MULTILINE)] == []
    assert re.search(r"^failed +0 ", told, re.MULTILINE)
    assert "failed" not in command("show", "c.h5").stdout


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (49.7580049161915, 2e-13, "49.7580049161915 (+- 2e-13)"),
        (49.75800491619153, 2e-13, "49.7580049161915 (+- 3e-13)"),
        (-0.0344504291231, 3e-10, "-0.0344504291 (+- 4e-10)"),
        (1.25e-9, 1e-12, "1.250e-09 (+- 1e-12)"),
        (0.123, 9.5e-3, "0.123 (+- 1e-02)"),
        (123456.0, 20.0, "123460 (+- 3e+01)"),
        (0.5, float("nan"), "0.5 (error not known)"),
        (float("nan"), 1.0, "none"),
        (float("inf"), 1.0, "inf"),
        (0.0, 1e-12, "0"),
        (1.0, 2.0, "1 (+- 2e+00)"),
    ],
)
def test_a_number_has_the_digits_that_its_error_leaves(value, error, text):
    assert number_with_error_text(value, error) == text


@pytest.mark.parametrize(
    ("rod", "branch", "told"),
    [
        ("k1: 60", "start: 300, stop: 400", "the force crushes the rod everywhere in the range of F"),
        ("k1: 60", "stop: 70", "from 0 to 70, where the force does not crush the rod; the list"),
        ("k1: 100, taper: 0.5", "start: 40, stop: 90", "crushes the rod everywhere in the range of F"),
        ("k1: 100, taper: [0.5, 1]", "start: 40, stop: 45", "the force crushes 1 of 2 rods everywhere in"),
        ("k1: 60, F: 30", "along: taper, start: 0.2, stop: 0.5", "everywhere in the range of taper"),
    ],
)
def test_a_branch_is_told_to_be_followed_where_the_rod_is_not_crushed(command, rod, branch, told):
    rod = f"{{{rod}, k2: 1.0e3, gamma3: 1.0e-3}}"
    text = shown(command, f"task: branch\nparameters: {rod}\nbranch: {{{branch}}}\n")
    assert told in text


@pytest.mark.parametrize(
    ("values", "text"),
    [([1.0, 3.0], "1 to 3"), ([1.0, inf], "1 and inf"), ([inf], "inf"), ([2.0, 3.0, inf], "2 to 3 and inf")],
)
def test_ranges_of_a_parameter_contain_infinity(values, text):
    assert axis_values_text(np.array(values)) == text


@pytest.mark.parametrize(
    ("arm", "material", "lines", "words"),
    [
        (
            None,
            {"law": "neo_hookean"},
            ["material: neo-Hookean rubber with a fixed section"],
            "fixed section",
        ),
        (
            None,
            {"profile": {"u": [0, 0.4, 0.4, 1], "k3": [1, 1, 0.2, 0.2]}},
            ["profile of 4 rows along the arm: k3"],
            "with a profile",
        ),
        (
            {
                "segments": ["6 cm: radius 6 mm, young 80 kPa", {"length": "8 cm", "radius": "4 mm"}],
                "law": "neo_hookean",
                "section": "swelling",
            },
            None,
            [
                "material: neo-Hookean rubber with a swelling section",
                "segment 1, 6 cm: radius 6 mm, young 80 kPa",
                "segment 2, 8 cm: radius 4 mm",
            ],
            "neo-Hookean, swelling section, in 2 segments",
        ),
        ({"length": "14 cm", "radius": "4 mm"}, None, [], ""),
    ],
)
def test_show_and_figures_name_law_profile_and_segments(arm, material, lines, words):
    """A result of rubber or of segments was shown as that of a uniform arm of linear material."""
    given = {"arm": {"young": "100 kPa", "viscosity": "20 Pa s"} | arm} if arm else {"k1": 300, "k2": 1e4}
    given |= {"gamma3": 1e-4} if arm is None else {}
    given |= {"material": material} if material else {}
    data = rs.sweep("thresholds", **given, F_max=20, certify=False, progress=False)
    view = view_of_dataset(data, Path("arms.h5"))
    assert list(summary_of(view).material) == lines
    title = rs.plot(data).figure().get_suptitle().splitlines()[0]
    assert words in title if words else title.startswith("length")


def test_parameters_are_shown_to_the_digit_in_which_they_differ():
    """F = 199.9999999 was shown as 200, the value of k1, at which the rod would be crushed."""
    data = rs.sweep("spectrum", F=199.9999999, k1=200, k2=1e4, gamma3=1e-4)
    rows = {row[0]: row[1] for row in summary_of(view_of_dataset(data, Path("data"))).axes_table.rows}
    assert rows == {"F": "199.9999999", "k1": "200", "k2": "10000", "gamma3": "0.0001"}


@pytest.mark.parametrize(("total", "line"), [(1, "0 of 1 point\n"), (2, "0 of 2 points\n"), (None, "\n")])
def test_progress_counts_one_point_as_one(monkeypatch, capsys, total, line):
    monkeypatch.setattr("rodsweep.sweep.progress.QUIET_SECONDS", 0.0)
    reporter = ProgressReporter(total, "title", "points" if total else "solved", is_bar=False)
    reporter(0)
    assert capsys.readouterr().err == line
