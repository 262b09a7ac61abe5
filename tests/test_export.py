"""`rodsweep export`: a line a point for other programs, with the numbers of the file to the last bit."""

import csv

import h5py
import numpy as np
import pytest

SPECTRA = """
task: spectrum
parameters: {F: {start: 0, stop: 60, num: 7}, k1: [200, .inf], k2: 1.0e4, gamma3: 1.0e-4}
spectrum: {modes: 3, vectors: true}
"""
ROD = "k1: 200, k2: 1.0e4, gamma3: 1.0e-4"


def exported(command, config, *options):
    """(headings, rows as lists of words, what was said) of the CSV file of a config's results."""
    command.write("c.yaml", config)
    assert command("run", "c.yaml").returncode == 0
    done = command("export", "c.h5", *options)
    assert done.returncode == 0, done.stderr
    with (command.directory / "c.csv").open(newline="") as stream:
        head, *rows = csv.reader(stream)
    return head, rows, done.stdout


def test_numbers_of_a_grid_are_those_of_the_file_to_the_last_bit(command):
    head, rows, said = exported(command, SPECTRA)
    columns = dict(zip(head, zip(*rows, strict=True), strict=True))
    assert head[:6] == ["F", "k1", "k2", "gamma3", "status", "growth_rate_1"]
    with h5py.File(command.directory / "c.h5") as file:
        F, k1 = np.meshgrid(file["F"], file["k1"], indexing="ij")
        assert np.array_equal(np.array(columns["F"], float), F.ravel())
        assert np.array_equal(np.array(columns["k1"], float), k1.ravel())
        for name in ("growth_rate", "frequency", "error_estimate"):
            table = np.array([columns[f"{name}_{i}"] for i in (1, 2, 3)], float).T
            assert np.array_equal(table, file[name][...].reshape(14, 3))
        assert np.array_equal(np.array(columns["seconds"], "f4"), file["seconds"][...].ravel())
        assert np.array_equal(np.array(columns["unstable_count"], int), file["unstable_count"][...].ravel())
    assert set(columns["status"]) == {"ok"}
    assert said.startswith(f"wrote c.csv: 14 points in {len(head)} columns; left out, because a point has")
    assert said.rstrip().endswith("Y_real, Y_imag, Theta_real, Theta_imag")


def test_words_stand_for_what_the_file_stores_as_numbers(command):
    config = f"task: thresholds\nparameters: {{{ROD}}}\nthresholds: {{crossings: 4}}\n"
    head, (row,), _ = exported(command, config, "--units")
    values = dict(zip(head, row, strict=True))
    assert [values[f"crossing_kind_{i}"] for i in range(1, 5)] == ["onset", "hopf", "restabilization", "none"]
    assert float(values["F_hopf [k3/L^2]"]) == pytest.approx(49.7580049161915, abs=1e-12)
    assert values["crossing_F_4 [k3/L^2]"] == "nan"
    assert "k1 [k3/L^2]" in head
    assert "certified" in head  # has no unit


@pytest.mark.parametrize("task", ["modes", "phase_diagram", "limit_cycle", "list"])
def test_results_of_every_task_are_exported(command, task):
    configs = {
        "modes": f"task: modes\nparameters: {{F: 30, {ROD}}}\n",
        "phase_diagram": "task: phase_diagram\n"
        "parameters: {F: [0, 60], k1: [200, 300], k2: 1.0e4, gamma3: 1.0e-4}\n",
        "limit_cycle": "task: limit_cycle\naccuracy: 1.0e-4\n"
        "parameters: {F: 20, k1: 1.0e4, k2: 100, gamma3: 0.01}\n",
        "list": "task: spectrum\nparameters: {points: points.csv}\n",
    }
    command.write("points.csv", "F,k1,k2,gamma3\n30,200,1e4,1e-4\n40,inf,1e4,0\n")
    head, rows, said = exported(command, configs[task])
    assert len(rows) == {"phase_diagram": 2, "list": 2}.get(task, 1)
    assert all(len(row) == len(head) for row in rows)
    assert ("Pi_real" in said) == (task == "modes")
    if task == "phase_diagram":
        assert [head[0], *rows[0][:1]] == ["k1", "200.0"]
        assert [name for name in head if name.startswith("class")] == ["class_1", "class_2"]
        assert "monotone" in rows[0]


def test_a_file_that_is_there_is_written_over_only_on_request(command):
    exported(command, SPECTRA)
    before = command.write("c.csv", "mine").read_text()
    refused = command("export", "c.h5")
    assert (refused.returncode, (command.directory / "c.csv").read_text()) == (2, before)
    assert "c.csv is there already; --replace writes over it" in refused.stderr
    assert command("export", "c.h5", "-o", "c.h5", "--replace").returncode == 2
    assert command("export", "c.h5", "--replace").returncode == 0
    assert (command.directory / "c.csv").read_text().startswith("F,k1,k2")
    assert sorted(path.name for path in command.directory.iterdir()) == ["c.csv", "c.h5", "c.yaml"]


def test_missing_points_have_their_line(command):
    command.write("c.yaml", SPECTRA)
    command("run", "c.yaml", "--shard", "1/2", "-o", "c.h5")
    assert command("export", "c.h5").returncode == 0
    lines = (command.directory / "c.csv").read_text().splitlines()
    assert sum(",missing,nan," in line for line in lines) == 7
    assert len(lines) == 15
