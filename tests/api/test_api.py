"""The Python interface: its names, that it says what the command says, and that it starts nothing early."""

import inspect
import json
import os
import pydoc
import shutil
import signal
import subprocess
import sys
from enum import IntEnum, StrEnum
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from conftest import BIN
from faults import small
from ruamel.yaml import YAML
from surveyed import only

import rodsweep as rs
from rodsweep.api import task_keywords
from rodsweep.api.answers.picture import CachedCycleShapeSolver, as_python_arguments
from rodsweep.api.keyword_arguments import config_tree, job_of_tree
from rodsweep.cli import commands
from rodsweep.config.base_config import Config
from rodsweep.config.document.reading import tree_yaml
from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.model.parameters import PARAMETERS
from rodsweep.post.figures import draw
from rodsweep.post.figures.request import FIGURE_KINDS, ROOT_CHOICES

pytestmark = pytest.mark.usefixtures("not_fitted")

NAMES = [
    "Answer",
    "Arm",
    "EnvironmentIncomplete",
    "InputError",
    "Picture",
    "Rod",
    "linspace",
    "logspace",
    "open",
    "plot",
    "sweep",
    "table",
]
METHODS = {
    "parameters",
    "replace",
    "spectrum",
    "thresholds",
    "modes",
    "limit_cycle",
    "cycle",
    "criticality",
    "branch",
    "portrait",
}
ROD = {"F": 50, "k1": 1e4, "k2": 1e2, "gamma3": 1e-2}
SILICONE = {"length": "10 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "1.4 Pa s"}
LOADED = SILICONE | {"pressure": "2 kPa"}
OF_A_RUN = {"seconds", "started", "finished", "config", "seal"}
"""What differs between two runs of one config, its text, which a file has as it was written, and the seal of
all that."""
OF_RANKS = {
    "rank_points",
    "rank_busy_seconds",
    "rank_idle_seconds",
    "mpi_library",
    "slurm_job",
}
"""What only a run by the command has to tell."""


def keywords_of(text):
    """The keywords that say what a config file says."""
    tree = YAML(typ="safe").load(text)
    task = tree.pop("task")
    return task, tree.pop("parameters") | tree.pop(task, {}) | tree


def test_names_are_these():
    assert rs.__all__ == NAMES
    assert set(NAMES) <= set(dir(rs))
    assert all(callable(getattr(rs, name)) for name in NAMES)
    public = {name for name in vars(rs.Rod) if not name.startswith("_")}
    assert public == METHODS


def test_arguments_are_these():
    assert list(inspect.signature(rs.sweep).parameters) == ["task", "ranks", "strict", "progress", "keywords"]
    said = pydoc.plaintext.document(rs.sweep)
    assert "rs.sweep(task: str, *, ranks: int | None" in said
    assert "ranks: number of MPI ranks" in said
    drawn = list(inspect.signature(rs.plot).parameters)
    assert drawn == ["data", "output", "roots", "what", "points", "at", "look"]
    assert list(inspect.signature(rs.open).parameters) == ["path"]
    arguments = inspect.signature(rs.Rod).parameters
    assert [name for name in arguments if name != "unknown"] == [
        *PARAMETERS,
        "arm",
        "law",
        "section",
        "profile",
    ]


def test_import_loads_nothing():
    code = (
        "import sys, rodsweep as rs\n"
        "heavy = {'numpy', 'mpi4py', 'petsc4py', 'slepc4py', 'xarray', 'h5py', 'matplotlib', 'pydantic'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
        "rod = rs.Rod(F=50, k1=1e4, k2=1e2, gamma3=1e-2)\n"
        "rs.sweep, rs.logspace, rs.Answer\n"
        "try: rod.spectrum(modes=0)\n"
        "except rs.InputError: pass\n"
        "assert not {'mpi4py', 'petsc4py', 'slepc4py', 'matplotlib'} & set(sys.modules)\n"
        "rod.spectrum()\n"
        "assert 'mpi4py' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_sweep_can_be_called_whatever_was_imported_first():
    code = (
        "import rodsweep.sweep.points.points_from_config, rodsweep as rs\n"
        "from rodsweep import sweep\n"
        "assert rs.sweep is sweep\n"
        "try: rs.sweep('nothing')\n"
        "except rs.InputError as error: print(error)\n"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert run.stdout.startswith("task = 'nothing' is not allowed; it should be spectrum, ")


@pytest.mark.parametrize("name", only(["list", "limit_cycle"], small.CONFIGS))
def test_sweep_gives_the_dataset_of_the_file(name, command, monkeypatch):
    command.write("points.csv", small.POINTS)
    command.write("c.yaml", small.CONFIGS[name])
    command("run", "c.yaml")
    monkeypatch.chdir(command.directory)
    task, keywords = keywords_of(small.CONFIGS[name])
    file, data = rs.open("c.h5"), rs.sweep(task, **{"title": "c"} | keywords)
    assert data.attrs.keys() == file.attrs.keys() - OF_RANKS
    same = data.attrs.keys() - OF_A_RUN - {"config_resolved", "fingerprint"}
    assert {key: data.attrs[key] for key in same} == {key: file.attrs[key] for key in same}
    resolved = [json.loads(each.attrs["config_resolved"]) | {"title": ""} for each in (data, file)]
    assert resolved[0] == resolved[1]
    for each in (data, file):
        each.attrs.clear()
    xr.testing.assert_identical(data.drop_vars("seconds"), file.drop_vars("seconds"))


def test_text_of_the_config_gives_the_same_points(tmp_path):
    """It is what ranks are given, and what the Dataset carries."""
    tree = config_tree("thresholds", {"k1": [200, np.inf], "k2": rs.logspace(10, 1e6, 31), "gamma3": 1e-300})
    again = job_of_tree(YAML(typ="safe").load(tree_yaml(tree)))
    assert again.resolved_config == job_of_tree(tree).resolved_config
    assert again.given_config_yaml == tree_yaml(tree)


@pytest.mark.parametrize("name", list(small.CONFIGS))
def test_what_yaml_has_read_can_be_given_as_keywords(name):
    tree = YAML(typ="safe").load(small.CONFIGS[name])
    whole = {key: value for key, value in tree.items() if key != "task"}
    task, keywords = keywords_of(small.CONFIGS[name])
    assert config_tree(task, keywords) == config_tree(task, whole) == tree


@pytest.mark.skipif(not (BIN / "mpiexec").exists() and not shutil.which("mpiexec"), reason="no mpiexec")
def test_ranks_give_the_same_numbers(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "p.csv").write_text("gamma3,F,k1,k2\n0,30,inf,inf\n1e-4,30,1e4,1e4\n")
    here, there = (rs.sweep("spectrum", points="p.csv", modes=2, ranks=ranks) for ranks in (None, 2))
    assert there.attrs["ranks"] == 2
    for data in (here, there):
        data.attrs.clear()
    xr.testing.assert_identical(here.drop_vars("seconds"), there.drop_vars("seconds"))
    assert [path.name for path in tmp_path.iterdir()] == ["p.csv"]


@pytest.mark.parametrize("ranks", [0, -1, 1.5, True])
def test_ranks_are_a_whole_number(ranks):
    with pytest.raises(rs.InputError, match="ranks = "):
        rs.sweep("thresholds", k1=200, k2=100, gamma3=0, ranks=ranks)


@pytest.mark.parametrize("launcher", ["#!/bin/sh\nexec /nowhere/mpiexec", "#!/nowhere/sh", None])
def test_ranks_that_no_mpiexec_starts_are_refused_in_a_sentence(tmp_path, monkeypatch, launcher):
    if launcher is not None:
        (tmp_path / "mpiexec").write_text(launcher)
        (tmp_path / "mpiexec").chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(
        rs.EnvironmentIncomplete, match="mpiexec.* (is not found|cannot be started|did not start)"
    ):
        rs.sweep("spectrum", **ROD, ranks=2)


@pytest.mark.long
@pytest.mark.parametrize(
    ("before", "variables", "code", "sentence"),
    [
        ("import os, tempfile; d = tempfile.mkdtemp(); os.chdir(d); os.rmdir(d)", {}, 3, "working directory"),
        ("", {"NUMBA_DISABLE_JIT": "1"}, 2, "NUMBA_DISABLE_JIT is set"),
    ],
)
def test_a_process_that_cannot_solve_says_why(tmp_path, before, variables, code, sentence):
    (tmp_path / "c.yaml").write_text(small.CONFIGS["spectrum"])
    codes = (
        f"rs.Rod(**{ROD}).spectrum()",
        f"from rodsweep import cli; sys.argv[1:] = ['run', {str(tmp_path / 'c.yaml')!r}]; cli.main()",
    )
    for command in codes:
        words = [sys.executable, "-c", f"import sys, rodsweep as rs; {before}\n{command}"]
        done = subprocess.run(words, env=os.environ | variables, capture_output=True, text=True, check=False)
        assert sentence in done.stderr.splitlines()[-1]
    assert (done.returncode, done.stderr.count("rodsweep: ")) == (code, 1)
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("axis", [np.array([10, 20]), (10, 20.0), range(10, 30, 10), rs.linspace(10, 20, 2)])
def test_axes_may_be_what_python_has(axis):
    job = job_of_tree(config_tree("spectrum", {"F": axis, "k1": np.int64(10**4), "k2": np.inf, "gamma3": 0}))
    assert [column.tolist() for column in job.points.columns] == [[10, 20], [1e4], [np.inf], [0]]


def test_numpy_scalars_as_values_and_as_names_are_those_of_python():
    asked = {"F": [10, 20], "k1": 1e4, "k2": 100.0, "gamma3": 0.01, "law": "neo_hookean", "modes": 3}
    own = {
        np.str_(name): np.str_(value) if isinstance(value, str) else value for name, value in asked.items()
    }
    own |= {"k1": np.float32(1e4), "modes": np.int64(3), "certify": np.bool_(False)}
    plain = job_of_tree(config_tree("spectrum", asked | {"certify": False}))
    assert job_of_tree(config_tree(np.str_("spectrum"), own)).given_config_yaml == plain.given_config_yaml
    arm = {np.str_(name): np.str_(text) for name, text in SILICONE.items()}
    plain = job_of_tree(config_tree("thresholds", {"arm": SILICONE}))
    assert job_of_tree(config_tree("thresholds", {"arm": arm})).given_config_yaml == plain.given_config_yaml
    assert rs.Arm(**arm) == rs.Arm(**SILICONE)


@pytest.mark.long
def test_numpy_scalars_are_taken_by_every_door():
    off, once = np.bool_(False), np.int64(1)
    rod = rs.Rod(**{np.str_(name): np.float64(value) for name, value in ROD.items()}, law=np.str_("linear"))
    assert rod == rs.Rod(**ROD)
    options = {np.str_("modes"): once, np.str_("progress"): off}
    assert rod.spectrum(**options).growth_rate.shape == (1,)
    assert rs.sweep("spectrum", ranks=once, strict=off, progress=off, **ROD, modes=once).sizes["mode"] == 1
    portrait = rod.portrait(F_max=np.float32(20), accuracy=np.float32(2.0**-7), progress=off)
    assert portrait.results.F_max == 20
    assert rs.Rod(**ROD | {"k1": np.longdouble(ROD["k1"])}) == rod
    assert rs.Arm(**SILICONE, poisson=np.array(0.49)) == rs.Arm(**SILICONE, poisson=0.49)
    with pytest.raises(rs.InputError, match="length = True is not a single quantity"):
        rs.Arm(**SILICONE | {"length": np.bool_(True)})


@pytest.mark.parametrize(
    "length", [np.array(["30"]), np.array("30"), b"30", np.array([True]), np.array(True), np.array([[0.1]])]
)
def test_an_array_or_a_text_without_unit_is_no_quantity_of_an_arm(length):
    with pytest.raises(
        rs.InputError, match="length = .* is not a single quantity; write a number with a unit"
    ):
        rs.Arm(**SILICONE | {"length": length})


def test_members_of_enumerations_are_their_numbers_and_texts():
    class Modes(IntEnum):
        one = 1

    class Methods(StrEnum):
        roots = "determinant"

    rod = rs.Rod(**ROD | {"k1": IntEnum("Stiffnesses", {"soft": 200}).soft})
    assert rod.parameters["k1"] == 200
    assert rs.Rod(**ROD).spectrum(modes=Modes.one, method=Methods.roots).growth_rate.shape == (1,)


def test_an_empty_profile_and_an_empty_list_of_segments_are_called_empty():
    with pytest.raises(
        rs.InputError, match=r"material\.profile is empty; it should be the name of a CSV file"
    ):
        rs.Rod(**ROD, profile="")
    with pytest.raises(rs.InputError, match="segments has no segment; write each segment as in '4 cm"):
        rs.Arm(segments=[], viscosity="1 Pa s")


def test_a_wrong_item_of_a_list_of_words_is_refused_with_the_words_that_are_allowed(tmp_path):
    (tmp_path / "points.csv").write_text("F,k1,k2,gamma3\n5,1e3,1e3,1e-3\n")
    with pytest.raises(rs.InputError, match="columns, number 1 = 'F' is not allowed; it should be 'taper'$"):
        rs.sweep("spectrum", points=tmp_path / "points.csv", columns=["F"])


def test_a_rods_numbers_are_those_of_the_sweep():
    rod, data = rs.Rod(**ROD), rs.sweep("spectrum", **ROD)
    answer = rod.spectrum(modes=4)
    assert answer.growth_rate.tolist() == data.growth_rate.values.ravel().tolist()
    assert answer.data.growth_rate.dims == ("mode",)
    assert float(answer.data.F) == 50
    assert answer.units["growth_rate"] == answer.data.growth_rate.attrs["units"] == "1/tau2"
    assert (answer.status, answer.unstable_count) == ("ok", 2)
    assert answer.config["spectrum"]["modes"] == 4


def test_every_task_answers_for_a_rod():
    rod = rs.Rod(**ROD)
    assert rod.thresholds().F_hopf == pytest.approx(27.427194, abs=1e-6)
    assert rod.modes(nodes=9).Y_real.shape == (2, 9)
    assert rod.cycle(accuracy=1e-3).period == pytest.approx(0.03445, abs=1e-4)
    assert rod.replace(F=20).cycle(accuracy=1e-3).status == "straight"
    assert rod.spectrum(longitudinal=True).longitudinal_rate[0] == pytest.approx(-1e4 * (np.pi / 2) ** 2)


def test_parameters_that_are_not_given_have_the_defaults_of_the_table():
    assert rs.Rod(**ROD).parameters == ROD | {"gamma1": PARAMETERS["gamma1"].default}
    assert "F" not in rs.Rod(k1=200, k2=100, gamma3=0).parameters


def test_keywords_of_a_rods_tasks_are_the_keys_of_the_config():
    kinds = {
        "spectrum": task_keywords.SpectrumKeywords,
        "thresholds": task_keywords.ThresholdsKeywords,
        "modes": task_keywords.ModesKeywords,
        "limit_cycle": task_keywords.LimitCycleKeywords,
        "criticality": task_keywords.CriticalityKeywords,
        "branch": task_keywords.BranchKeywords,
    }
    for task, kind in kinds.items():
        section = CONFIG_CLASSES_BY_TASK[task].model_fields[task].annotation
        assert set(kind.__annotations__) == {*section.model_fields, "accuracy", "title", "progress"}


def test_no_key_is_in_two_sections():
    """So that keywords need none."""
    for task, config in CONFIG_CLASSES_BY_TASK.items():
        sections = [config.model_fields[name].annotation.model_fields for name in (task, "parameters")]
        names = [name for section in (*sections, Config.model_fields) for name in section]
        assert len(names) == len(set(names))


WRONG = {
    "task: spectrumm\nparameters: {F: 1, k1: 9, k2: 9, gamma3: 1}": "did",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 9, gamma3: -1}": "gamma3",
    "task: spectrum\nparameters: {F: 10, k1: 9, k2: 9, gamma3: 1}": "crushed",
    "task: spectrum\nparameters: {F: 1, k1: 9, K2: 9, gamma3: 1}": "k2",
    "task: spectrum\nparameters: {F: [2, 1], k1: 9, k2: 9, gamma3: 1}": "sorted",
    "task: spectrum\nparameters: {F: one, k1: 9, k2: 9, gamma3: 1}": "number",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 9}": "missing",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 9, gamma3: 1}\nspectrum: {modes: 0}": "100",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 9, gamma3: 1}\nspectrum: {mods: 4}": "modes",
    "task: spectrum\nparameters: {F: 1, k1: 9, k2: 9, gamma3: 1}\naccuracy: 2": "accuracy",
    "task: spectrum\nparameters: {points: none.csv}": "none.csv",
    "task: thresholds\nparameters: {F: 1, k1: 9, k2: 9, gamma3: 1}": "F_max",
    "task: phase_diagram\nparameters: {F: 1, k1: 9, k2: 9, gamma3: 1}": "axes",
}


@pytest.mark.parametrize("text", WRONG)
def test_bad_input_is_refused_in_the_words_of_the_command(text, command, monkeypatch):
    command.write("c.yaml", text)
    monkeypatch.chdir(command.directory)
    run = command("check", "c.yaml")
    assert run.returncode == 2
    sentence = run.stderr.strip().removeprefix("rodsweep: ").removeprefix("c.yaml: ")
    task, keywords = keywords_of(text)
    with pytest.raises(rs.InputError) as refusal:
        rs.sweep(task, **keywords)
    assert str(refusal.value) == sentence


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (
            lambda: rs.Rod(**ROD | {"gamma3": -1}),
            "parameters.gamma3 = -1 is not allowed; it must be a finite",
        ),
        (lambda: rs.Rod(**ROD | {"k1": "stiff"}), "parameters.k1: 'stiff' is not a number"),
        (lambda: rs.Rod(**ROD | {"F": 2e4}), "parameters.F reaches 20000 and parameters.k1 starts at 10000;"),
        (lambda: rs.Rod(**ROD, K1=3), "a rod has no parameter K1; did you mean k1?"),
        (
            lambda: rs.Rod(F=1, k1=9, k2=9, gama3=0),
            "a rod has no parameter gama3; did you mean gamma3?",
        ),
        (lambda: rs.Rod(F=1, k1=9, k2=9), "gamma3 is missing; give k1, k2 and gamma3, or an arm"),
        (
            lambda: rs.Rod(k1=9, k2=9, gamma3=0).spectrum(),
            "parameters.F is missing; give F, k1, k2 and gamma3",
        ),
        (lambda: rs.Rod(**ROD).spectrum(mods=3), "unknown key spectrum.mods; did you mean modes?"),
        (
            lambda: rs.Rod(**ROD).spectrum(F=3),
            "F is a parameter of the rod, not an option; rod.replace(F=...) makes another rod",
        ),
        (
            lambda: rs.Rod(**ROD).phase_diagram(),
            "phase_diagram is a task of several rods; use rs.sweep('phase_diag",
        ),
        (lambda: rs.Rod(30, 1e4), "the argument 30 has no name; write it as in rs.Rod(F=30, k1="),
        (lambda: rs.Rod(**ROD).spectrum(4), "the argument 4 has no name; write it as in rod.spectrum("),
        (lambda: rs.Rod(**ROD).replace(3), "the argument 3 has no name; write it as in rod.replace(F=40)"),
        (lambda: rs.Arm("10 cm"), "the argument '10 cm' has no name; write it as in rs.Arm(length="),
        (lambda: rs.Arm(**LOADED, presure="1 kPa"), "unknown key presure; did you mean pressure?"),
        (lambda: rs.Arm(**SILICONE, diameter="1 cm"), "unknown key diameter; give radius, half of it"),
        (lambda: rs.Arm(**SILICONE, outer_diameter=1), "unknown key outer_diameter; give radius, half of it"),
        (
            lambda: rs.sweep("thresholds", arm=SILICONE | {"diameter": "1 cm"}),
            "unknown key parameters.arm.diameter; give radius, half of it",
        ),
        (
            lambda: rs.sweep("thresholds", **ROD, diameter=1),
            "unknown key diameter; known keys are",
        ),
        (rs.Arm, "viscosity is missing; write it as in rs.Arm("),
        (lambda: rs.Arm(viscosity="1 Pa s"), "length is missing; write it as in '10 cm'"),
        (
            lambda: rs.Arm(**LOADED | {"length": ["10 cm"]}),
            "length = ['10 cm'] is not a single quantity; write a",
        ),
        (lambda: rs.Arm(**LOADED | {"length": 10**400}), "length = 1000"),
        (lambda: rs.Arm(**LOADED | {"length": "1e300 km"}), "length = '1e300 km', with this section"),
        (
            lambda: rs.Arm(**LOADED | {"length": "1e80 m"}),
            "length = '1e80 m' and viscosity = '1.4 Pa s' make the unit of time or the inertia of the fluid",
        ),
        (
            lambda: rs.Arm(**LOADED | {"viscosity": "1e-199 Pa s"}),
            "length = '10 cm' and viscosity = '1e-199 Pa s'",
        ),
        (lambda: rs.Arm(**LOADED | {"radius": "1e-300 m"}), "length = '10 cm', with this section and"),
        (lambda: rs.Arm(**LOADED | {"poisson": "0.5"}), "poisson = '0.5' is not a number above -1"),
        (lambda: rs.Arm(**LOADED | {"poisson": 10**400}), "poisson = 1000000000"),
        (
            lambda: rs.Arm(**LOADED | {"poisson": 10**5000}),
            "poisson = an int too large to be shown is not",
        ),
        (lambda: rs.Arm(**SILICONE | {"radius": "-5 mm"}), "radius = '-5 mm' is not above 0"),
        (lambda: rs.Arm(**LOADED, force="1 N"), "pressure = '2 kPa' and force = '1 N' are both given"),
        (
            lambda: rs.Arm(**SILICONE).spectrum(),
            "spectrum needs a load; give one, such as arm.replace(pressure='2 kPa')",
        ),
        (
            lambda: rs.Arm(**LOADED).cycle(young="1 MPa"),
            "young is a quantity of the arm, not an option",
        ),
        (lambda: rs.Arm(**LOADED).thresholds(F_mx=3), "unknown key thresholds.F_mx; did you mean F_max?"),
        (lambda: rs.Arm(**LOADED).replace(lenght=3), "unknown key lenght; did you mean length?"),
        (lambda: rs.Rod(arm=3), "arm = 3 is not an arm; write it as in rs.Rod(arm=rs.Arm("),
        (lambda: rs.linspace(0, 10), "num is missing; write it as in rs.linspace(0, 10, num=11)"),
        (lambda: rs.linspace(0, 10, 5, 6), "the argument 6 has no name; write it as in rs.linspace("),
        (lambda: rs.linspace(0, 10, n=5), "unknown key n; did you mean num?"),
        (lambda: rs.logspace(1, 10, 3, stop=4), "stop is given twice"),
        (rs.open, 'path is missing; write it as in rs.open("RESULT.h5")'),
        (lambda: rs.plot(3, colour="red"), "unknown key colour; known keys are output, roots"),
        (lambda: rs.sweep("spectrum", 30), "the argument 30 has no name; write it as in rs.sweep("),
        (lambda: rs.open("none.h5"), "none.h5 does not exist"),
        (lambda: rs.sweep(["spectrum"]), "task = ['spectrum'] is not allowed; it should be spectrum, "),
        (lambda: rs.plot([]), "[] has nothing to draw"),
    ],
)
def test_bad_input_of_a_rod_is_refused(call, sentence):
    with pytest.raises(rs.InputError) as refusal:
        call()
    assert str(refusal.value).startswith(sentence)


def test_a_sweep_is_written_read_and_drawn(tmp_path):
    data = rs.sweep("thresholds", k1=200, k2=rs.logspace(10, 1e4, 4), gamma3=1e-4, F_max=60)
    data.to_netcdf(tmp_path / "d.nc")
    xr.testing.assert_identical(rs.open(tmp_path / "d.nc"), data)
    assert "F_onset" in data._repr_html_()
    picture = rs.plot(data, tmp_path / "d.pdf")
    assert picture.shown == "critical forces against k2"
    assert repr(picture) == "Picture(shown='critical forces against k2')"
    assert picture._repr_mimebundle_()["image/png"].startswith(b"\x89PNG")
    assert (tmp_path / "d.pdf").read_bytes().startswith(b"%PDF")
    picture.save(tmp_path / "d.svg")
    assert (tmp_path / "d.svg").exists()
    with pytest.raises(rs.InputError, match="not a complete result: they lack F_onset"):
        rs.plot(data.isel(k2=0))
    with pytest.raises(rs.InputError, match="not a complete rodsweep result"):
        rs.plot(xr.Dataset())


@pytest.mark.parametrize(("name", "times"), [("a: b.png", 1), ("d.svg", 2)])
def test_a_file_in_the_format_of_the_display_is_drawn_once(tmp_path, monkeypatch, name, times):
    draws = []
    monkeypatch.setattr("rodsweep.api.answers.picture.draw", lambda *a, **k: draws.append(a) or draw(*a, **k))
    data = rs.sweep("thresholds", k1=200, k2=[10, 100], gamma3=1e-4, F_max=60)
    picture = rs.plot(data, tmp_path / name)
    assert len(draws) == times
    assert picture.shown == "critical forces against k2"
    assert (picture.image == (tmp_path / name).read_bytes()) == (times == 1)


def test_own_data_go_into_a_figure(tmp_path):
    data = rs.sweep("thresholds", k1=200, k2=rs.logspace(10, 1e4, 4), gamma3=1e-4, F_max=60)
    picture = rs.plot(data, width="89 mm")
    figure = picture.figure()
    (axes,) = figure.axes
    before = len(axes.lines)
    axes.plot([100], [30], "ks")
    figure.savefig(tmp_path / "own.pdf")
    assert (tmp_path / "own.pdf").read_bytes().startswith(b"%PDF")
    assert len(picture.figure().axes[0].lines) == before, "each figure is a new one"
    assert figure.get_size_inches()[0] == pytest.approx(89 / 25.4)
    assert not Path("figure.png").exists()


def test_an_answer_is_drawn():
    picture = rs.plot(rs.Rod(**ROD).modes(nodes=9, growth=False))
    assert picture.shown.startswith("the leading mode")


def test_a_cycle_without_stored_shapes_is_drawn_with_the_shapes_that_it_would_have():
    cycle = rs.Rod(F=50, k1=1e4, k2=100, gamma3=0.01).cycle(accuracy=1e-4)
    assert "shape_x" not in cycle.data
    picture = rs.plot(cycle)
    assert picture.shown.startswith("shapes through the cycle")
    assert [*picture.choices["shapes"].views_by_point_numbers] == [(1,)]
    assert rs.plot(cycle, what="energy").shown.startswith("energy, injection and dissipation")
    with pytest.raises(
        rs.InputError, match="no cycle that could be drawn; the statuses of its points are: straight"
    ):
        rs.plot(rs.Rod(F=5, k1=1e4, k2=100, gamma3=0.01).cycle(accuracy=1e-4))


def test_a_picture_solves_shapes_once_however_often_it_is_drawn():
    asked = []
    shapes = CachedCycleShapeSolver(lambda view, numbers: asked.append(numbers) or view)
    assert shapes("file", [1, 2]) == shapes("file", (1, 2)) == "file"
    assert asked == [[1, 2]]


def test_a_branch_and_the_criticality_of_one_rod_are_drawn():
    rod = rs.Rod(k1=200, k2=1e4, gamma3=1e-4)
    assert rs.plot(rod.criticality(F_max=60)).shown.startswith("the cycles that normal forms predict")
    assert rs.plot(rod.branch(stop=60, accuracy=1e-4)).shown.startswith("1 branch of cycles over F")


@pytest.mark.parametrize(
    ("choice", "sentence"),
    [
        ({"what": "heat"}, "what = 'heat' is not allowed; choose cycle, amplitude, maps"),
        (
            {"width": "tiny"},
            "width = 'tiny' is not allowed; choose single, double, or a length such as '89 mm'",
        ),
        ({"roots": "left"}, "roots = 'left' is not allowed; choose rightmost, smallest, all"),
        ({"at": {"k1": 100}}, "has no point there; it has k1 = 200"),
        ({"at": 3}, "at = 3 is not allowed; give numbers by parameter"),
        ({"points": 3}, "points is for results of limit_cycle"),
        ({"what": "maps"}, 'what="maps" is for results of limit_cycle'),
        ({"output": "f.xyz"}, "output f.xyz: the name must end in .png"),
        ({"at": {"k1": 100}}, 'at={"k1": 100}: spectrum has no point there'),
    ],
)
def test_choices_of_a_figure_that_there_are_not_are_refused(choice, sentence):
    data = rs.sweep("spectrum", F=[1, 2], k1=200, k2=1e4, gamma3=1e-4, modes=2)
    with pytest.raises(rs.InputError) as refusal:
        rs.plot(data, **choice)
    assert sentence in str(refusal.value)
    with pytest.raises(rs.InputError, match="nothing to draw; give a Dataset"):
        rs.plot(rs.Rod(F=1, k1=200, k2=1e4, gamma3=1e-4))


@pytest.mark.parametrize(
    ("command", "python"),
    [
        (
            "choose lines with --at, such as --at k1=150, or",
            'choose lines with at, such as at={"k1": 150}, or',
        ),
        ("lines with --at, such as --at 'length=12 cm'", 'lines with at, such as at={"length": "12 cm"}'),
        ("--at k1=-2e-05: c.h5 has no point", 'at={"k1": -2e-05}: c.h5 has no point'),
        ("k2 vary; --at k2=VALUE selects", 'k2 vary; at={"k2": "VALUE"} selects'),
        ("(--what map: all)", '(what="map": all)'),
        ("--point 3: c.h5 has the points 1 to 2", "points=3: c.h5 has the points 1 to 2"),
        ("of 5 cycles (--point chooses others)", "of 5 cycles (points chooses others)"),
    ],
)
def test_sentences_of_the_command_are_in_the_words_of_python(command, python):
    assert as_python_arguments(command) == python


def test_choices_of_a_figure_are_those_of_the_command():
    choices = {o.name: o.type.choices for o in commands.commands["plot"].params if hasattr(o.type, "choices")}
    assert {name: tuple(words) for name, words in choices.items()} == {
        "roots": ROOT_CHOICES,
        "what": FIGURE_KINDS,
    }


def test_other_attributes_of_a_rod_are_refused():
    with pytest.raises(AttributeError, match="its tasks are spectrum, ") as refusal:
        _ = rs.Rod(**ROD).spectrm
    assert "phase_diagram" not in str(refusal.value)
    assert "phase_diagram" not in dir(rs.Rod(**ROD))


def test_what_is_no_result_is_not_opened(tmp_path):
    xr.Dataset({"x": 1}).to_netcdf(tmp_path / "x.nc", engine="h5netcdf")
    (tmp_path / "x.h5").write_text("text")
    with pytest.raises(
        rs.InputError,
        match="x.nc cannot be read as a result of rodsweep: the file was not written by rodsweep",
    ):
        rs.open(tmp_path / "x.nc")
    with pytest.raises(rs.InputError, match="cannot be read as a result of rodsweep"):
        rs.open(tmp_path / "x.h5")


@pytest.mark.parametrize("progress", [None, False, True])
def test_a_long_solve_is_shown_where_it_is_asked_for_or_a_terminal_is(progress, monkeypatch, capsys):
    """The display is due at once; standard error is no terminal here."""
    monkeypatch.setattr("rodsweep.sweep.progress.QUIET_SECONDS", 0.0)
    monkeypatch.setattr("rodsweep.sweep.progress.BAR_SECONDS", 0.0)
    monkeypatch.setattr("rodsweep.sweep.stop.SECONDS_BETWEEN_PROGRESS_REPORTS", 0.0)
    asked = {} if progress is None else {"progress": progress}
    rs.Rod(k1=1e4, k2=1e4, gamma3=1e-4).branch(stop=40, accuracy=1e-4, **asked)
    said = capsys.readouterr().err
    assert bool(said) == bool(progress)
    assert ("branch from Hopf point 1 of 1: F = " in said) == bool(progress)


def test_progress_is_true_or_false():
    with pytest.raises(rs.InputError, match="progress = 3 is not allowed; it should be True, False or None"):
        rs.Rod(k1=1e4, k2=1e4, gamma3=1e-4).thresholds(progress=3)


def test_ctrl_c_on_a_branch_is_a_keyboard_interrupt_and_the_next_solve_is_right(monkeypatch):
    rod = rs.Rod(k1=1e4, k2=1e4, gamma3=1e-4)
    alone = rod.branch(stop=40, accuracy=1e-4)

    def interrupt(self, text):
        if "cycles" in text().text:
            signal.raise_signal(signal.SIGINT)

    with monkeypatch.context() as patch:
        patch.setattr("rodsweep.sweep.stop.SolverReportListener.__call__", interrupt)
        with pytest.raises(KeyboardInterrupt):
            rod.branch(stop=40, accuracy=1e-4)
    assert (
        rod.branch(stop=40, accuracy=1e-4).data.drop_vars("seconds").equals(alone.data.drop_vars("seconds"))
    )
