"""What a config may say and how it is refused: one sentence, before anything is computed."""

import os

import numpy as np
import pytest

from rodsweep.config.document.reading import config_from_resolved, config_yaml
from rodsweep.config.document.refusals import similar_keys
from rodsweep.errors import InputError
from rodsweep.tasks.running.job import job_of_file

GOOD = """
title: test
task: spectrum
parameters:
  F: {start: 0, stop: 30, num: 4.0e0}
  k1: 1e4
  k2: [100, 1.0e4, inf]
  gamma3: {start: 1e-4, stop: 1e-2, num: 3, spacing: log}
spectrum: {modes: 3}
accuracy: 1.0e-8
"""


def job(tmp_path, text, *overrides):
    path = tmp_path / "c.yaml"
    path.write_text(text)
    return job_of_file(path, overrides)


def test_axes_are_numbers_lists_and_ranges(tmp_path):
    points = job(tmp_path, GOOD).points
    assert points.shape == (4, 1, 3, 3)
    F, k1, k2, gamma3 = points.columns
    assert np.array_equal(F, [0, 10, 20, 30])
    assert np.array_equal(k2, [100, 1e4, np.inf])
    assert np.allclose(gamma3, [1e-4, 1e-3, 1e-2], rtol=1e-14)
    rod = points.rod(points.count - 1)
    assert (rod.F, rod.k1, rod.k2) == (30, 1e4, np.inf)


def test_axes_may_come_in_any_order(tmp_path):
    shuffled = "parameters: {gamma3: 0, k2: .inf, F: 3, k1: inf}\ntask: spectrum\n"
    assert job(tmp_path, shuffled).points.rod(0).F == 3


def test_defaults_are_certified_and_without_vectors(tmp_path):
    config = job(tmp_path, GOOD).config
    assert (config.spectrum.certify, config.spectrum.vectors, config.spectrum.longitudinal) == (
        True,
        False,
        False,
    )


def test_override_sets_a_key(tmp_path):
    points = job(tmp_path, GOOD, "parameters.F.num=7", "accuracy=1e-6").points
    assert points.shape[0] == 7


@pytest.mark.parametrize("parts", [("F", "k1", "k2", "gamma3"), ("gamma3", "k2", "F", "k1")])
def test_point_list_is_read_in_any_column_order(tmp_path, parts):
    row = {"F": "10", "k1": "inf", "k2": "50", "gamma3": "0.5"}
    (tmp_path / "p.csv").write_text(",".join(parts) + "\n" + ", ".join(row[p] for p in parts) + "\n\n")
    points = job(tmp_path, "task: spectrum\nparameters: {points: p.csv}").points
    assert points.shape == (1,)
    assert points.rod(0).gamma3 == 0.5
    assert points.rod(0).k1 == np.inf


REFUSED = {
    "F: {start: 0, stop: 1e4, num: 4}": ["F", "10000", "k1"],
    "k1: 0": ["k1", "0", "above 0"],
    "k1: 30": ["F", "30", "k1"],
    "k2: -5": ["k2", "-5", "above 0"],
    "gamma3: -1e-3": ["gamma3", "-0.001", "0 or above"],
    "gamma3: inf": ["gamma3", "inf", "finite"],
    "F: .nan": ["F", "nan"],
    "F: []": ["F", "empty"],
    "F: [3, 2]": ["F", "[3, 2]", "sorted"],
    "F: [2, 2]": ["F", "sorted"],
    "F: {start: 3, stop: 2, num: 4}": ["F", "start", "stop"],
    "F: {start: 3, stop: 4}": ["F", "num"],
    "F: {start: 3, stop: 4, num: 1}": ["F", "num = 1 makes one value, but start = 3 and stop = 4 differ"],
    "F: {start: 3, stop: 4, num: 0}": ["F", "num", "0"],
    "F: {start: 3, stop: 4, num: 2.5}": ["F", "num", "2.5"],
    "F: {start: 3, stop: 4, num: 3, step: 1}": ["F", "step"],
    "F: {start: 0, stop: 4, num: 3, spacing: log}": ["F", "log", "0"],
    "F: {start: 1, stop: 4, num: 3, spacing: cubic}": ["F", "cubic", "log"],
    "F: {start: 1, stop: inf, num: 3}": ["F", "finite"],
    "F: yes": ["F", "yes"],
    "F: true": ["F", "True", "number"],
    "F: null": ["F", "missing"],
    "F: {start: 0, stop: 1, num: 1000000000}": ["points", "memory"],
    "Force: 3": ["Force", "F"],
    "gamma1: 1": ["gamma1", "not used"],
    "points: p.csv": ["points", "F"],
}


@pytest.mark.parametrize("line", REFUSED)
def test_bad_parameters_are_refused_naming_key_and_value(tmp_path, monkeypatch, line):
    monkeypatch.setattr(os, "sysconf", {"SC_PAGE_SIZE": 4096, "SC_PHYS_PAGES": 2**22}.__getitem__)  # 17 GB
    key = line.split(":")[0]
    kept = [text for text in GOOD.splitlines() if not text.strip().startswith(key + ":")]
    at = kept.index("parameters:") + 1
    with pytest.raises(InputError) as refusal:
        job(tmp_path, "\n".join([*kept[:at], "  " + line, *kept[at:]]))
    for word in REFUSED[line]:
        assert word in str(refusal.value), str(refusal.value)
    assert "\n" not in str(refusal.value)


BROKEN = {
    "": "is empty",
    "- 1\n- 2": "mapping",
    "a: [1, 2": "line",
    "a: 1\na: 2": "a",
    "task: spectrum\nparameters: {F: !!python/object/apply:os.system [ls]}": "tags",
    "a: &x [1]\nb: *x": "aliases",
    "task: spectrum": "parameters",
    "task: thresolds\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}": "spectrum",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1}": "gamma3",
    "task: spectrum\nparameters: 3": "parameters",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}\nspectrum: {mods: 3}": "modes",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}\nspectrum: {modes: 0}": "modes",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}\nspectrum: {modes: 2.0}": "modes",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}\nspectrum: {nodes: 9}": "vectors",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}\nspectrum: {longitudinal: true}": "gamma1",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}\naccuracy: 0": "accuracy",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}\naccurracy: 1e-8": "accuracy",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}\n---\na: 1": "document",
    "%YAML 1.1\n---\na: 1": "directives",
    'task: spectrum\nparameters: {points: "a\\0b"}': "printed",
    "task: spectrum\n1: 2\nparameters: {F: 1, k1: 9, k2: 1, gamma3: 0}": "keys are words",
    "task: spectrum\nparameters: {F: {start: 1, stop: 1.0000000000000004, num: 99}}": "cannot hold 99 values",
    "[" * 100: "nested",
    "a: " + "[" * 5000: "nested",
    "\t- x": "YAML",
    "task: spectrum\nparameters: {F: 1" + "0" * 400 + ", k1: 9, k2: 1, gamma3: 0}": "F",
}


@pytest.mark.parametrize("text", BROKEN, ids=range(len(BROKEN)))
def test_broken_configs_are_refused_in_one_sentence(tmp_path, text):
    with pytest.raises(InputError) as refusal:
        job(tmp_path, text)
    assert BROKEN[text] in str(refusal.value)
    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 500


def config(task, parameters="F: 1, k1: 9, k2: 1, gamma3: 0", options=""):
    section = f"{task}: {{{options}}}\n" if options else ""
    return f"task: {task}\nparameters: {{{parameters}}}\n{section}"


def thresholds(parameters="k1: 9, k2: 1, gamma3: 0", options=""):
    return config("thresholds", parameters, options)


def diagram(F="[1, 2]", k1="9", k2="[1, inf]", more="gamma3: 0", options=""):
    return config("phase_diagram", f"F: {F}, k1: {k1}, k2: {k2}, {more}", options)


ALL = "F, k1, k2 and gamma3"
REFUSED_BY_TASK = [
    (
        "parameters: {F: 1}",
        "task is missing; it should be spectrum, thresholds, phase_diagram, modes, limit_cycle, "
        "criticality or branch",
    ),
    (
        "task: spectrum\nparameters: {arm: {length: 0.1, radius: 5.0e-3, young: 1.0e+5, viscosity: 1, "
        "pressure: 100, load_kind: force}}",
        "parameters.arm.load_kind is given, but parameters.arm.pressure is given too; remove load_kind",
    ),
    (
        "task: spectrum\nparameters: {arm: {length: 0.1, radius: 5.0e-3, young: 1.0e+5, viscosity: 1, "
        "load_kind: force}}",
        "parameters.arm.load_kind is given, but the task needs a load; give parameters.arm.force instead",
    ),
    (
        "task: thresholds\nparameters: {arm: {length: 0.1, radius: 5.0e-3, young: 1.0e+5, viscosity: 1, "
        "force: 0.1, load_kind: force}}",
        "parameters.arm.force is given, but the task solves for the load; remove it; load_kind: force gives "
        "the loads in newton, and F_max sets the end of the search (for the task branch, branch.stop)",
    ),
    ("task: [spectrum]", "task = ['spectrum'] is not allowed; it should be spectrum, thresholds"),
    (thresholds() + "spectrum: {modes: 3}", "spectrum is given but the task is thresholds; remove it"),
    (config("modes") + "thresholds: {}", "thresholds is given but the task is modes; remove it"),
    (diagram() + "modes:", "modes is given but the task is phase_diagram; remove it"),
    (config("spectrum") + "phase_diagram: 3", "phase_diagram is given but the task is spectrum"),
    (
        thresholds() + "thresholds: 3",
        "thresholds = 3 is not allowed; it should be a mapping of keys to values",
    ),
    (thresholds() + "thresholds:", "thresholds has no value; it should be a mapping"),
    (thresholds(options="Fmax: 3"), "unknown key thresholds.Fmax; did you mean F_max?"),
    (
        config("branch", "F: 9, k2: 9, gamma3: 0", "along: k1, start: 1.0e-320, stop: 9"),
        "along k1; it should be a finite number above 0 (1/k1 overflows)",
    ),
    (thresholds(options="F_max: 0"), "F_max = 0 is not allowed; it should be a finite number above 0"),
    (thresholds(options="F_max: -3"), "F_max = -3 is not allowed; it should be a finite number above 0"),
    (thresholds(options="F_max: .inf"), "F_max = inf is not allowed; it should be a finite number above 0"),
    (thresholds(options="F_max: far"), "thresholds.F_max: 'far' is not a number"),
    (thresholds(options="F_max: 2024-01-01"), "thresholds.F_max: 2024-01-01 is not a number"),
    (
        thresholds(options="crossings: 0"),
        "crossings = 0 is not allowed; it should be a whole number from 1 to",
    ),
    (thresholds(options="crossings: 1001"), "it should be a whole number from 1 to 1000"),
    (thresholds(options="certify: 1"), "certify = 1 is not allowed; it should be true or false"),
    (
        thresholds("F: 3, k1: 9"),
        "parameters.F is given but the task thresholds finds F itself; remove it and",
    ),
    (config("criticality", "F: 3, k1: 9"), "parameters.F is given but the task criticality finds F itself"),
    (
        config("criticality", "k2: 9, gamma3: 0"),
        "parameters.k1 is missing; give k1, k2, gamma3 and gamma1, or points: FILE.csv",
    ),
    (
        config("criticality", "k1: 9, k2: 1, gamma3: 0", "F_max: 0"),
        "F_max = 0 is not allowed; it should be a finite number above 0",
    ),
    (
        config("spectrum", options="method: krylov_schur, certify: true"),
        "spectrum.certify is given but not used; set spectrum.method: determinant or remove it",
    ),
    (config("branch", "F: 3, k1: 9"), "parameters.F is given but the task branch follows F; remove it"),
    (
        config("branch", "k1: 9, k2: 9, gamma3: 0", "work: 0"),
        "branch.work = 0 is not allowed; it should be a finite number above 0, or null for no limit",
    ),
    (
        config("branch", "k1: 9, k2: 9, gamma3: 0", "along: k1, start: 1"),
        "parameters.k1 is given but the task branch follows k1; remove it and set branch.start",
    ),
    (
        config("branch", "k2: 9, gamma3: 0", "along: k1, start: 1"),
        "parameters.F is missing; give F, k2, gamma3 and gamma1, or points: FILE.csv",
    ),
    (
        config("branch", "F: 9, k2: 9, gamma3: 0", "along: k1"),
        "start = 0 is not allowed along k1; it should be a finite number above 0",
    ),
    (
        config("branch", "F: 9, k2: 9, gamma3: 0", "along: k1, start: 3, stop: .inf"),
        "stop = inf is not allowed; it should be a finite number",
    ),
    (config("branch", "k1: 9, k2: 9, gamma3: 0", "start: 300"), "start = 300 is not below stop = 200"),
    (
        config("branch", "k1: 9, k2: 9, gamma3: 0", "along: gamma1"),
        "along = 'gamma1' is not allowed; it should be F, k1, k2, gamma3 or taper",
    ),
    (config("criticality", "k1: 9, k2: 1, gamma3: 0, gamma1: 0"), "parameters.gamma1 = 0 is not allowed"),
    (thresholds("gamma1: 3, k1: 9"), "parameters.gamma1 is given but the task thresholds does not use it"),
    (thresholds("k2: 9, gamma3: 0"), "parameters.k1 is missing; give k1, k2 and gamma3, or points: FILE.csv"),
    (
        thresholds("k1: -9, k2: 1, gamma3: 0"),
        "parameters.k1 = -9 is not allowed; it must be a number above 0",
    ),
    (thresholds("points: p.csv, k1: 9"), "parameters.points and parameters.k1 are both given"),
    (
        diagram(F="1"),
        "has 1 axis with more than one value (k2); a phase diagram needs exactly two of F, k1, k2, gamma3 "
        "and taper",
    ),
    (diagram(k1="[9, 10]"), "has 3 axes with more than one value (F, k1, k2); a phase diagram needs exactly"),
    (diagram(more="points: p.csv"), "parameters.points is given but the task phase_diagram needs axes"),
    (diagram(more="gamma3: null"), f"parameters.gamma3 is missing; give {ALL}"),
    (diagram(more="gamma3: 0, gamma1: 2"), "parameters.gamma1 is given but the task phase_diagram does not"),
    (diagram(F="[1, inf]"), "parameters.F contains inf, which is not allowed on the axis along which"),
    (diagram(F="1", k1="[9, .inf]"), "parameters.k1 contains inf, which is not allowed on the axis along"),
    (diagram(F="[9, 10]"), "parameters.F starts at 9 and parameters.k1 ends at 9; the rod is crushed where"),
    (diagram(F="{start: 0, stop: 8, num: 40000000}"), "the results of one point take 0.2 GB"),
    (diagram(options="crossings: 2.0"), "phase_diagram.crossings = 2.0 is not allowed"),
    (
        diagram(options="cycles: true, cycle_accuracy: 1e-12"),
        "phase_diagram.cycle_accuracy = 1e-12 is not allowed; it should be a number from 1e-11 to 0.01",
    ),
    (
        diagram(options="cycles: true, cycle_accuracy: 0.1"),
        "phase_diagram.cycle_accuracy = 0.1 is not allowed; it should be a number from 1e-11 to 0.01",
    ),
    (
        diagram(options="cycles: true, cycle_accuracy: fine"),
        "phase_diagram.cycle_accuracy: 'fine' is not a number",
    ),
    (
        diagram(options="cycle_accuracy: 1e-8"),
        "phase_diagram.cycle_accuracy is given but not used; set phase_diagram.cycles: true or remove it",
    ),
    (diagram(options="curves: no"), "phase_diagram.curves = 'no' is not allowed; it should be true or false"),
    (config("modes", options="modes: 101"), "modes.modes = 101 is not allowed; it should be a whole number"),
    (
        config("modes", options="nodes: 2"),
        "modes.nodes = 2 is not allowed; it should be a whole number from 3",
    ),
    (config("modes", options="growth: 2"), "modes.growth = 2 is not allowed; it should be true or false"),
    (config("modes", options="vectors: true"), "unknown key modes.vectors"),
    (config("modes", "k1: 9, k2: 1, gamma3: 0"), f"parameters.F is missing; give {ALL}, or points: FILE.csv"),
]


@pytest.mark.parametrize(("text", "sentence"), REFUSED_BY_TASK, ids=range(len(REFUSED_BY_TASK)))
def test_what_a_task_cannot_use_is_refused_in_one_sentence(tmp_path, text, sentence):
    with pytest.raises(InputError) as refusal:
        job(tmp_path, text)
    assert sentence in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_options_of_every_task_have_their_defaults(tmp_path):
    options = job(tmp_path, thresholds()).config.thresholds
    assert (options.F_max, options.crossings, options.certify) == (200, 16, True)
    options = job(tmp_path, diagram()).config.phase_diagram
    assert (options.crossings, options.certify, options.curves) == (16, True, True)
    options = job(tmp_path, config("modes")).config.modes
    assert (options.modes, options.nodes, options.growth, options.certify) == (2, 65, True, True)


def test_thresholds_may_search_beyond_k1_and_their_points_have_no_force(tmp_path):
    points = job(tmp_path, thresholds(options="F_max: 1000")).points
    assert points.names == ("k1", "k2", "gamma3")
    assert points.parameter_values_of_point(0) == {"k1": 9, "k2": 1, "gamma3": 0}
    (tmp_path / "p.csv").write_text("gamma3,k1,k2\n0,9,inf\n1,inf,3\n")
    points = job(tmp_path, thresholds("points: p.csv")).points
    assert points.parameter_values_of_point(1) == {"k1": np.inf, "k2": 3, "gamma3": 1}
    for table, word in {
        "F,k1,k2,gamma3\n1,9,1,0\n": "it must name k1, k2 and gamma3",
        "k1,k2,gamma3\n9,1,-1\n": "line 2: gamma3 = -1.0 is not",
    }.items():
        (tmp_path / "p.csv").write_text(table)
        with pytest.raises(InputError, match=word):
            job(tmp_path, thresholds("points: p.csv"))


def test_phase_diagram_may_reach_into_the_crushed_rods(tmp_path):
    assert job(tmp_path, diagram(F="[1, 9]")).points.count == 2
    assert job(tmp_path, diagram(F="9", k1="[8, 10]")).points.count == 2


@pytest.mark.parametrize(
    ("axes", "line", "row"),
    [
        ("F: [1, 2], k1: 9, k2: [1, inf], gamma3: 0", "F", "k2"),
        ("F: [1, 2], k1: [9, inf], k2: 1, gamma3: 0", "F", "k1"),
        ("gamma3: [0, 1], k2: 3, k1: [9, 10], F: 1", "k1", "gamma3"),
        ("F: 1, k1: inf, k2: [1, 2], gamma3: [0, 1]", "k2", "gamma3"),
    ],
)
def test_rows_of_a_phase_diagram_lie_along_the_first_of_its_two_axes(tmp_path, axes, line, row):
    made = job(tmp_path, config("phase_diagram", axes))
    assert made.config.plane_parameters == (line, row)
    assert made.points.names == tuple(name for name in ("F", "k1", "k2", "gamma3") if name != line)
    assert made.points.count == 2
    assert made.points.parameter_values_of_point(0)[row] != made.points.parameter_values_of_point(1)[row]
    assert made.layout.extents[line] == 2
    assert made.task.coordinates()[line].tolist() == made.config.parameters.axes[line].array().tolist()


@pytest.mark.parametrize(
    ("table", "word"),
    [
        ("", "the first line names no parameter"),
        ("F;k1;k2;gamma3\n1;100;1;1\n", "separated by semicolons; separate them by commas; it must name F"),
        ("F\tk1\tk2\tgamma3\n1\t100\t1\t1\n", "separated by tabs; separate them by commas"),
        ("F [k3/L^2],k1 [k3/L^2],k2 [k3/L^2],gamma3\n1,9,9,0\n", "leave the units out; it must name F, k1,"),
        ("F,k1,k2\n1,2,3\n", "header"),
        ("F,k1,k2,gamma3,\n1,9,9,0,\n", "has an empty name"),
        ("F,k1,k2,gamma3\n", "no point"),
        ("F,k1,k2,gamma3\n1,9,9,x\n", "gamma3"),
        ("F,k1,k2,gamma3\n1,9,9\n", "line 2"),
        ("F,k1,k2,gamma3\n1,9,9,0\n\n9,9,9,0\n", "line 4: F = 9.0 is not below k1 = 9.0"),
        ("F,k1,k2,gamma3\n1,9,9,1_0\n", "gamma3"),
        ("F,k1,k2,gamma3\n,,,\n", "line 2"),
        ("F,k1,k2,gamma3\n1,9,9,nan\n", "nan"),
        ("F,k1,k2,gamma3\n1,9,-9,0\n", "k2"),
    ],
)
def test_bad_point_lists_are_refused_naming_the_place(tmp_path, table, word):
    (tmp_path / "p.csv").write_text(table)
    with pytest.raises(InputError, match=word):
        job(tmp_path, "task: spectrum\nparameters: {points: p.csv}")


@pytest.mark.parametrize(
    "override", ["accuracy", "=3", "parameters.F.num.x=3", "spectrum.mods=3", "a..b=1", "accuracy=["]
)
def test_bad_overrides_are_refused(tmp_path, override):
    with pytest.raises(InputError):
        job(tmp_path, GOOD, override)


def test_file_that_is_no_text_is_refused(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_bytes(b"\xff\xfe\x00\x01")
    for bad in (path, tmp_path, tmp_path / "none.yaml"):
        with pytest.raises(InputError):
            job_of_file(bad, ())


@pytest.mark.parametrize(
    ("key", "known", "meant"),
    [
        ("taper", ("F", "k1", "arm", "points"), []),
        ("k3", ("F", "k1", "k2"), []),
        ("G", ("F", "k1"), []),
        ("Fmax", ("certify", "F_max"), ["F_max"]),
        ("gamma", ("k1", "gamma3", "gamma1"), ["gamma3", "gamma1"]),
        ("n", ("start", "num"), ["num"]),
        ("lenght", ("length", "height"), ["length"]),
        ("density", ("viscosity", "fluid_density"), ["fluid_density"]),
        ("presure", ("force", "pressure"), ["pressure"]),
        ("tolerance", ("accuracy", "title"), []),
        ("", ("F", "k1"), []),
        ("k", ("F", "k1", "k2"), ["k1", "k2"]),
        ("a", ("a1", "a2", "a3", "a4", "a5"), []),
    ],
)
def test_only_near_keys_are_suggested(key, known, meant):
    assert similar_keys(key, known) == meant


TASKS_OF_LISTS = {
    "spectrum": "F,k1,k2,gamma3",
    "modes": "F,k1,k2,gamma3",
    "thresholds": "k1,k2,gamma3",
    "limit_cycle": "F,k1,k2,gamma3,gamma1",
    "criticality": "k1,k2,gamma3,gamma1",
    "branch": "k1,k2,gamma3,gamma1",
}


@pytest.mark.parametrize("task", TASKS_OF_LISTS)
def test_a_list_may_have_a_column_of_tapers_in_every_task(tmp_path, task):
    names = TASKS_OF_LISTS[task].split(",")
    given = {"F": "7", "k1": "1e4", "k2": "50", "gamma3": "0.5", "gamma1": "1"}
    rows = [",".join([taper, *(given[name] for name in names)]) for taper in ("0.5", "0.8")]
    (tmp_path / "p.csv").write_text("\n".join([",".join(["taper", *names]), *rows]) + "\n")
    made = job(tmp_path, f"task: {task}\nparameters: {{points: p.csv}}")
    assert [made.points.rod(i).taper for i in range(2)] == [0.5, 0.8]
    assert made.points.rod(1).k2 == 50
    assert made.layout.parameters == (*names, "taper")
    assert not made.config.is_uniform_and_linear
    assert config_from_resolved(made.resolved_config) == made.config
    assert job(tmp_path, config_yaml(made.config)).points.identifying_arrays[-1].tolist() == [0.5, 0.8]


def test_columns_are_those_of_the_header(tmp_path):
    (tmp_path / "p.csv").write_text("F,k1,k2,gamma3\n10,inf,50,0.5\n")
    with pytest.raises(InputError, match=r"the header is 'F,k1,k2,gamma3'; it must name .* and taper"):
        job(tmp_path, "task: spectrum\nparameters: {points: p.csv, columns: [taper]}")
    with pytest.raises(InputError, match=r"parameters.columns is given but parameters.points is not"):
        job(tmp_path, "task: spectrum\nparameters: {F: 1, k1: 9, k2: 9, gamma3: 1, columns: [taper]}")


@pytest.mark.parametrize(
    ("override", "sentence"),
    [
        ("accuracy=", "accuracy: a value is missing; give a number"),
        ("accuracy=null", "accuracy: a value is missing; give a number"),
        ("task=", "task has no value; it should be spectrum, "),
        ("parameters=", "parameters has no value; it should be a mapping of keys to values"),
        ("spectrum.modes=~", "spectrum.modes has no value; it should be a whole number from 1 to 100"),
        ("spectrum.certify=", "spectrum.certify has no value; it should be true or false"),
        ("parameters.F=[1, null]", "parameters.F: a value is missing; give a number"),
        (
            "parameters.F={start: 1, stop: null, num: 3}",
            "parameters.F: a range needs start, stop and num, and stop",
        ),
        (
            "parameters.F={start: 1, stop: 2, num: 3, spacing: null}",
            "parameters.F: spacing has no value; it is linear",
        ),
        (
            "parameters.arm={segments: [null]}",
            "parameters.arm.segments, number 1 has no value; write a segment as",
        ),
    ],
)
def test_a_key_without_value_is_refused_without_the_word_of_a_language(tmp_path, override, sentence):
    path = tmp_path / "c.yaml"
    path.write_text("task: spectrum\nparameters: {F: 1, k1: 200, k2: 1.0e4, gamma3: 1.0e-4}\n")
    with pytest.raises(InputError) as refused:
        job_of_file(path, (override,))
    assert sentence in str(refused.value)
    assert "None" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "overrides", "sentence"),
    [
        ("task: spectrum\nparameters: {<<: {F: 1}}\n", (), "merge keys (<<) are not allowed in a config"),
        (
            "task: spectrum\nparameters: {F: 1e400}\n",
            (),
            "c.yaml, line 2, column 17: '1e400' is too large for a floating-point number",
        ),
        (
            "Task: spectrum\nparameters: {F: 1}\n",
            (),
            "unknown key Task; did you mean task? Its value should be ",
        ),
        ("task: spectrum\nmodes: 3\n", (), "unknown key modes; did you mean spectrum.modes?"),
        (
            "task: spectrum\n",
            ("title=a\x07b",),
            "'--set title=a\\x07b' has characters that cannot be printed",
        ),
        ("task: spectrum\n", (".".join(["a"] * 200) + "=1",), "keys are nested more than "),
        (
            'task: spectrum\nparameters: {F: 1, k1: 2, k2: 3, gamma3: 1}\ntitle: "a\\x07b"\n',
            (),
            "has characters that cannot be printed",
        ),
        (
            "task: spectrum\ntitle: a\x07b\n",
            (),
            "c.yaml, line 2, column 9: '\\x07' cannot be printed; remove ",
        ),
        ("\0task: spectrum\n", (), "c.yaml, line 1, column 1: '\\x00' cannot be printed; remove "),
    ],
)
def test_odd_keys_and_texts_are_refused_with_what_to_write(tmp_path, text, overrides, sentence):
    path = tmp_path / "c.yaml"
    path.write_text(text)
    with pytest.raises(InputError) as refused:
        job_of_file(path, overrides)
    assert sentence in str(refused.value)
    assert str(refused.value).isprintable()
