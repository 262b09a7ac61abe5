"""Input that is neither computed nor printed as it is: masked numbers, control characters, loops of links."""

import json
import os
import warnings

import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr

import rodsweep as rs
from rodsweep.results.file.seal import seal
from rodsweep.tasks.running import job
from rodsweep.tasks.running.job import job_of_file

SPECTRA = """
task: spectrum
parameters: {F: [10, 30], k1: 200, k2: 1.0e4, gamma3: 1.0e-4}
spectrum: {modes: 2}
"""
ROD = {"k1": 1e4, "k2": 100, "gamma3": 0.01}
ARM = {"radius": 0.005, "young": 1e5, "viscosity": 1.4, "pressure": 2e3}
MASKED = [np.ma.masked, np.ma.array(30.0, mask=True), np.ma.array([20.0, 30.0], mask=[True, False])]
NO_NUMBERS = [
    *MASKED,
    [20.0, np.ma.masked],
    pd.NA,
    pd.array([20.0, None], dtype="Float64"),
    pd.Series([20, pd.NA]),
    xr.DataArray(MASKED[2]),
]


@pytest.mark.parametrize("value", NO_NUMBERS, ids=lambda value: type(value).__name__)
@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda value: rs.Rod(F=value, **ROD), "parameters.F"),
        (lambda value: rs.sweep("spectrum", F=value, **ROD), "parameters.F"),
        (lambda value: rs.sweep("spectrum", parameters={"F": value, **ROD}), "parameters"),
        (lambda value: rs.sweep("spectrum", F=rs.linspace(value, 40, num=3), **ROD), ""),
        (lambda value: rs.sweep("spectrum", F=rs.logspace(1, value, num=3), **ROD), ""),
        (lambda value: rs.Rod(**ROD).thresholds(F_max=value), "thresholds.F_max"),
        (lambda value: rs.Rod(**ROD).thresholds(accuracy=value), "accuracy"),
        (lambda value: rs.Rod(**ROD, profile={"u": [0, 1], "k3": value}), "material.profile"),
        (lambda value: rs.Arm(length=value, **ARM), "length"),
        (lambda value: rs.sweep("spectrum", arm={"length": value, **ARM}), "parameters.arm"),
    ],
)
def test_masked_values_are_refused_and_not_computed_as_what_lies_under_the_mask(value, call, key):
    with warnings.catch_warnings(), pytest.raises(rs.InputError) as refusal:
        warnings.simplefilter("error")
        call(value)
    assert key in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_array_with_a_mask_that_hides_nothing_is_numbers():
    whole = np.ma.array([20.0, 30.0], mask=[False, False])
    assert rs.sweep("spectrum", F=whole, modes=1, **ROD).F.values.tolist() == [20, 30]


@pytest.mark.parametrize(
    "path", [None, 3, b"x.h5", "", "a\0b", ".", "..", "/", "none.h5", "\x1b[31m", [], np.ma.masked]
)
def test_what_is_no_file_is_not_opened(path):
    with pytest.raises(rs.InputError):
        rs.open(path)


@pytest.mark.parametrize("data", [[None], [3], ["none.h5", None], [""]])
def test_what_is_no_result_is_not_drawn(data):
    with pytest.raises(rs.InputError):
        rs.plot(data)


def test_control_characters_of_a_file_do_not_reach_the_terminal(command):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml").returncode == 0
    path = command.directory / "c.h5"
    with h5py.File(path, "r+") as file:
        for name in ("title", "rodsweep_version", "stopped", "blas_kernels", "status_sentences", "hosts"):
            file.attrs[name] = f"a\x1b[31m\x07\u202e{file.attrs[name]}"
        file["status"].attrs["flag_meanings"] = str(file["status"].attrs["flag_meanings"]).replace(
            "ok", "o\x1b[31mk"
        )
        file["growth_rate"].attrs["units"] = "\x1b[31m"
    broken = command("show", "c.h5")
    seal(path)
    for words in (("show", "c.h5"), ("show", "c.h5", "--statuses"), ("export", "c.h5"), ("run", "c.yaml")):
        done = command(*words)
        assert done.returncode == 0, done.stderr
        assert "\x1b" not in done.stdout + done.stderr + broken.stdout + broken.stderr
        assert "\u202e" not in done.stdout
    assert "\x1b" not in (command.directory / "c.csv").read_text()
    data = rs.open(path)
    texts = [data.attrs, *(variable.attrs for variable in data.variables.values())]
    assert not any("\x1b" in str(value) for attributes in texts for value in attributes.values())
    assert json.loads(data.attrs["config_resolved"])["task"] == "spectrum"


def test_lines_of_a_file_that_is_no_list_of_points_are_not_printed(command):
    secret = command.write("shadow", "root:$y$secret,k1:19000:0:::\n")
    command.write("c.yaml", f"task: spectrum\nparameters: {{points: {secret}}}\n")
    refused = command("check", "c.yaml")
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert "the first line names no parameter; it must name F, k1, k2 and gamma3" in refused.stderr
    assert "secret" not in refused.stderr
    secret.write_text("F,k1,k2,gama3\n1,2,3,4\n")
    assert "the header is 'F,k1,k2,gama3'" in command("check", "c.yaml").stderr


def test_link_that_leads_to_itself_is_left_alone(command):
    command.write("c.yaml", SPECTRA)
    for name, to in (("a.h5", "b.h5"), ("b.h5", "a.h5"), ("c.csv", "c.csv")):
        (command.directory / name).symlink_to(to)
    assert command("run", "c.yaml").returncode == 0
    lines = [
        ("run", "c.yaml", "-o", "a.h5"),
        ("merge", "a.h5", "c.h5"),
        ("snapshot", "c.h5", "-o", "b.h5"),
        ("export", "c.h5"),
        ("show", "a.h5"),
    ]
    for words in lines:
        refused = command(*words)
        assert (refused.returncode, refused.stderr.count("\n")) == (2, 1), words
        assert "is a link that leads to itself" in refused.stderr
    assert all((command.directory / name).is_symlink() for name in ("a.h5", "b.h5", "c.csv"))


@pytest.mark.parametrize(
    ("key", "value", "sentence"),
    [
        ("branch.stop", ".inf", "branch.stop = inf is not allowed; it should be a finite number"),
        ("branch.start", "-.inf", "branch.start = -inf is not allowed; it should be a finite number"),
        ("branch.stop", ".nan", "branch.stop: nan is not allowed; give a number"),
        ("branch.stop", '""', "branch.stop: '' is not a number"),
        (
            "parameters",
            "{points: ''}",
            "parameters.points = '' is not allowed; it should be the name of a CSV file",
        ),
    ],
)
def test_values_without_end_and_names_without_letters_are_refused(command, key, value, sentence):
    command.write("c.yaml", "task: branch\nparameters: {k1: 200, k2: 1.0e4, gamma3: 1.0e-4}\n")
    refused = command("check", "c.yaml", "--set", f"{key}={value}")
    assert (refused.returncode, refused.stderr) == (2, f"rodsweep: c.yaml: {sentence}\n")


def test_large_grid_may_be_larger_than_the_memory_but_not_its_axes(command, monkeypatch):
    """A file is written point by point, so its points need no memory, but the values of its axes do."""
    axes = {"F": "start: 0, stop: 9", "k1": "start: 100, stop: 1000", "k2": "start: 100, stop: 1000"}
    sets = tuple(f"parameters.{name}={{{ends}, num: 1000}}" for name, ends in axes.items())
    path = command.write("c.yaml", SPECTRA)
    assert job_of_file(path, sets).points.count == 10**9
    checked = command("check", "c.yaml", *(word for given in sets for word in ("--set", given)))
    assert checked.returncode == 0, checked.stderr
    axis = rs.linspace(100, 1000, 1000)
    with pytest.raises(rs.InputError, match="memory of this machine; `rodsweep run` writes them into a file"):
        rs.sweep("spectrum", F=rs.linspace(0, 9, 1000), k1=axis, k2=axis, gamma3=rs.linspace(0, 1, 1000))
    monkeypatch.setattr(job, "machine_memory", lambda: 10**7)
    with pytest.raises(rs.InputError, match="GB of memory of this machine; use fewer values"):
        job_of_file(path, ("parameters.F={start: 0, stop: 9, num: 1000000}",))


def test_deleted_working_directory_is_told_in_a_sentence(command):
    path = command.write("c.yaml", SPECTRA)
    gone = command.directory / "gone"
    gone.mkdir()
    there = command.in_directory(gone)
    there.loaded = None
    patch = f"import os; os.rmdir({str(gone)!r})"
    (command.directory / "patch").mkdir()
    (command.directory / "patch" / "sitecustomize.py").write_text(patch)
    place = os.pathsep.join([str(command.directory / "patch"), os.environ.get("PYTHONPATH", "")])
    done = there.afresh("run", path, PYTHONPATH=place)
    assert (done.returncode, done.stderr) == (
        3, "rodsweep: the working directory was deleted; change to an existing directory\n",
    )  # fmt: skip
