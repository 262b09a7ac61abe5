"""Neighbours that are solved together: which, how they are kept, and that runs end in the same file."""

import math
import re

import h5py
import numpy as np
import pytest
from contents import content, same, same_spectra
from ranks import PATIENCE, kill, ranks_in, wait_for_end
from slow_runs import FOR_EVER, pause_until_journalled, slowly
from surveyed import few

import rodsweep as rs
from rodsweep.results.file.view import read_view
from rodsweep.sweep.points.groups import (
    MAX_GROUP_POINTS,
    MIN_GROUP_AXIS_VALUES,
    GroupResult,
    GroupSolver,
    PointGroups,
    groups_along_longest_axis,
)
from rodsweep.sweep.points.ranges import IndexSet, index_count

SPECTRA = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 200}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
"""
LAST_POINTS = 200 - MAX_GROUP_POINTS
"""Number of points of the second and last group of each line of SPECTRA."""
EVERY = ("F", "k1", "k2", "gamma3")
SHAPES = [(200, 3, 2, 2), (3, 258, 2, 1), (2, 2, 64, 5), (1, 1, 1, 9)]


@pytest.mark.parametrize("shape", SHAPES)
def test_every_point_is_in_one_stretch_of_neighbours(shape):
    groups = groups_along_longest_axis(shape, EVERY[: len(shape)])
    parts = [groups.indices(n) for n in range(groups.count)]
    assert sorted(np.concatenate(parts).tolist()) == list(range(math.prod(shape)))
    for part in parts:
        places = np.array(np.unravel_index(part, shape))
        others = np.delete(places, groups.axis, axis=0)
        assert len(part) <= MAX_GROUP_POINTS
        assert (others == others[:, :1]).all()
        assert (np.diff(places[groups.axis]) == 1).all()


def test_the_axis_with_most_values_is_followed_and_a_short_one_is_not():
    assert groups_along_longest_axis((5, 9, 9, 2), EVERY).axis == 1
    assert groups_along_longest_axis((1, 1, 1, MIN_GROUP_AXIS_VALUES), EVERY).axis == 3
    assert groups_along_longest_axis((1, MIN_GROUP_AXIS_VALUES - 1, 1, 1), EVERY) is None
    assert groups_along_longest_axis((99, 9, 8), ("", "F", "k2")).axis == 1
    assert groups_along_longest_axis((99, 99), ("", "")) is None


@pytest.mark.parametrize("shape", SHAPES)
def test_groups_to_do_are_those_that_miss_a_point(shape):
    groups = groups_along_longest_axis(shape, EVERY[: len(shape)])
    count = math.prod(shape)
    assert groups.unsolved_ranges([(0, count)]) == [(0, groups.count)]
    assert groups.missing_point_count([(0, groups.count)], [(0, count)]) == count
    missing = [(0, 2), (5, 6), (count - 1, count)] if count > 9 else [(3, 4)]
    lacks = IndexSet(missing)
    expected = [n for n in range(groups.count) if lacks[groups.indices(n)].any()]
    todo = groups.unsolved_ranges(missing)
    assert [n for ends in todo for n in range(*ends)] == expected
    assert groups.missing_point_count(todo, missing) == index_count(missing)


def test_of_a_stretch_only_missing_points_are_kept():
    """All are followed, as what is missing starts from the others; points that are left are solved alone, one
    after the other, if they are missing."""
    asked = []

    def follow(indices):
        asked.append(indices.tolist())
        return GroupResult({"growth_rate": 10.0 * indices}, indices % 4 == 0)

    def solve(index):
        asked.append(index)
        return f"told {index}"

    solver = GroupSolver(PointGroups((10, 2), 0), follow, solve, IndexSet([(4, 11)]))
    results = solver(0)
    index, kept = next(results)
    assert index.tolist() == [4, 8]
    assert kept.variable_values["growth_rate"].tolist() == [40.0, 80.0]
    assert asked == [list(range(0, 20, 2))]
    assert list(results) == [(6, "told 6"), (10, "told 10")]
    assert asked[1:] == [6, 10]


@pytest.mark.long
def test_any_number_of_ranks_gives_the_same_spectra(command):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml", "-o", "alone.h5").returncode == 0
    many = command("run", "c.yaml", "-o", "many.h5", ranks=3)
    assert many.returncode == 0, many.stderr
    alone = content(command.directory / "alone.h5")
    assert same(alone, content(command.directory / "many.h5"))
    assert (alone["elements"] == 0).mean() > 0.95


@pytest.mark.long
def test_followed_spectra_are_as_accurate_as_those_of_points_alone(command):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml").returncode == 0
    assert command("run", "c.yaml", "--set", "spectrum.follow=false", "-o", "alone.h5").returncode == 0
    followed, alone = content(command.directory / "c.h5"), content(command.directory / "alone.h5")
    assert (alone["elements"] > 0).all()
    assert same_spectra(followed, alone)
    refused = command("run", "c.yaml", "--set", "spectrum.follow=false")
    assert refused.returncode == 2
    assert "spectrum.follow is true in the file and false in the config" in refused.stderr


@pytest.mark.long
@pytest.mark.parametrize("whole_job", few([True, False], 1), ids=few(["all ranks", "one rank"], 1))
def test_resume_after_a_kill_gives_the_same_spectra(command, whole_job):
    """Killed while ranks wait behind their third group, of 128 or 72 points: what is journalled stays."""
    command.write("c.yaml", SPECTRA)
    path = command.directory / "c.h5"
    process = command.started("run", "c.yaml", ranks=2, patch=slowly(FOR_EVER, 3))
    pause_until_journalled(process, path, 6 * LAST_POINTS)
    ranks = ranks_in(command.directory)
    kill(*([process.pid, *ranks.values()] if whole_job else [ranks[1]]))
    process.communicate(timeout=PATIENCE)
    wait_for_end(command.directory)
    kept = read_view(path).journalled_count
    again = command("run", "c.yaml", ranks=2)
    assert again.returncode == 0, again.stderr
    assert f"{2400 - kept} of 2400 points to do, {kept} kept" in again.stdout
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(path), content(command.directory / "whole.h5"))


def test_points_of_a_stretch_that_are_solved_alone_are_kept_one_by_one(command):
    """A pull without drag: no eigenvalue is followed, because nothing can be proved."""
    alone = (
        "task: spectrum\nparameters: {F: {start: -60, stop: -30, num: 20}, k1: 1.0e4, k2: 20, gamma3: 0}\n"
    )
    command.write("c.yaml", alone)
    path = command.directory / "c.h5"
    process = command.started("run", "c.yaml", patch=slowly(FOR_EVER, 7))
    pause_until_journalled(process, path, 7)
    process.kill()
    process.communicate(timeout=PATIENCE)
    again = command("run", "c.yaml")
    assert "13 of 20 points to do, 7 kept" in again.stdout
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == again.returncode
    assert same(content(path), content(command.directory / "whole.h5"))


def test_a_stretch_of_which_a_part_was_written_is_redone_and_its_rest_kept(command):
    """A record is torn in the middle of a group: the points before it are kept, none is written twice."""
    command.write("c.yaml", SPECTRA)
    path = command.directory / "c.h5"
    process = command.started("run", "c.yaml", patch=slowly(FOR_EVER, 2))
    pause_until_journalled(process, path, 2 * MAX_GROUP_POINTS)
    process.kill()
    process.communicate(timeout=PATIENCE)
    (journal,) = (command.directory / "c.h5.journal").glob("rank-*")
    record = (journal.stat().st_size - 100) // (2 * MAX_GROUP_POINTS)
    with journal.open("r+b") as file:
        file.truncate(journal.stat().st_size - 20 * record - 7)
    kept = read_view(path).journalled_count
    assert 2 * MAX_GROUP_POINTS - 28 < kept < 2 * MAX_GROUP_POINTS - 18
    again = command("run", "c.yaml")
    assert again.returncode == 0, again.stderr
    assert f"{2400 - kept} of 2400 points to do, {kept} kept" in again.stdout
    assert re.search(rf"^{2400 - kept} points in", again.stdout, re.M)
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(path), content(command.directory / "whole.h5"))


def test_stopped_run_ends_with_whole_stretches_and_goes_on(command):
    command.write("c.yaml", SPECTRA)
    process = command.started("run", "c.yaml", patch=slowly(0.2))
    pause_until_journalled(process, command.directory / "c.h5", 1)
    process.terminate()
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 75, err
    done = int(re.search(r"stopped by SIGTERM; (\d+) points? kept", out)[1])
    with h5py.File(command.directory / "c.h5") as file:
        kept = (file["status"][...] == 0).reshape(200, -1)
    assert kept.sum() == done
    assert set(kept[:MAX_GROUP_POINTS].sum(axis=0)) <= {0, MAX_GROUP_POINTS}
    assert set(kept[MAX_GROUP_POINTS:].sum(axis=0)) <= {0, LAST_POINTS}
    assert command("run", "c.yaml").returncode == 0
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(command.directory / "c.h5"), content(command.directory / "whole.h5"))


def test_shards_of_a_followed_grid_join_to_the_same_file(command):
    command.write("c.yaml", SPECTRA)
    for i in (1, 2, 3):
        assert command("run", "c.yaml", "--shard", f"{i}/3", "-o", f"{i}.h5").returncode == 0
    assert command("merge", "joined.h5", "1.h5", "2.h5", "3.h5").returncode == 0
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(command.directory / "joined.h5"), content(command.directory / "whole.h5"))


def test_failed_points_of_a_stretch_are_told(command):
    """The onset cannot be had to 1e-12: its status says so, with the values of its parameters."""
    forces = "[10, 12, 14, 16, 18, 20, 20.0080206921031, 30]"
    command.write(
        "c.yaml",
        f"task: spectrum\nparameters: {{F: {forces}, k1: 1e4, k2: 1e4, gamma3: 1e-4}}\naccuracy: 1e-12\n",
    )
    run = command("run", "c.yaml")
    assert run.returncode == 1
    assert "7 ok, 1 accuracy_not_reached" in run.stdout
    assert (
        "accuracy_not_reached, for example at F = 20.0080206921031, k1 = 10000, k2 = 10000, gamma3 = 0.0001"
        in run.stdout
    )


@pytest.mark.parametrize(
    "options", [{"certify": False}, {"vectors": True, "nodes": 5}], ids=["uncertified", "vectors"]
)
def test_without_a_count_or_with_vectors_every_point_has_its_mesh(options):
    rod = {"F": rs.linspace(10, 40, 10), "k1": 1e4, "k2": 1e4, "gamma3": 1e-4}
    assert (rs.sweep("spectrum", **rod, **options).elements > 0).all()
    assert (rs.sweep("spectrum", **rod).elements == 0).all()


def test_python_gives_the_numbers_of_the_command(command):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml").returncode == 0
    with rs.open(command.directory / "c.h5") as file:
        here = rs.sweep(
            "spectrum", F=rs.linspace(0, 60, 200), k1=[100, 1e4, math.inf], k2=[50, 1e4], gamma3=[0, 1e-4]
        )
        for name in here.data_vars:
            assert name == "seconds" or np.array_equal(here[name], file[name], equal_nan=True), name


FEW_FORCES = "F: {start: 0, stop: 49.75, num: 20}"
"""Fewer than values of k2, along which the larger grid is followed then."""


@pytest.mark.long
@pytest.mark.parametrize(
    ("first", "larger", "kept"),
    [
        ("", "F: {start: 0, stop: 66.25, num: 266}", MAX_GROUP_POINTS),
        ("", "F: {start: 0, stop: 49.75, num: 200}\n  k1: [100, 200, 1.0e4, .inf]", 200),
        (FEW_FORCES, f"{FEW_FORCES}\n  k2: {{start: 50, stop: 600, num: 31}}", 0),
        ("", "F: {start: -0.25, stop: 49.75, num: 201}", 0),
    ],
    ids=["longer", "another line", "along another axis", "shifted"],
)
def test_extended_grid_keeps_what_a_run_of_the_whole_gives_to_the_last_bit(command, first, larger, kept):
    """Of each of the three lines as many points as are in groups of the same points."""
    parameters = {"F": "{start: 0, stop: 49.75, num: 200}", "k1": "[100, 1.0e4, .inf]"}
    parameters |= {"k2": "50", "gamma3": "1.0e-4"}
    texts = []
    for more in (first, larger):
        given = parameters | dict(line.strip().split(": ", 1) for line in more.split("\n") if line)
        lines = "".join(f"  {name}: {value}\n" for name, value in given.items())
        texts.append(f"task: spectrum\nparameters:\n{lines}spectrum: {{modes: 2}}\n")
    command.write("c.yaml", texts[0])
    assert command("run", "c.yaml").returncode == 0
    command.write("larger.yaml", texts[1])
    run = command("run", "larger.yaml", "-o", "c.h5", "--extend")
    assert run.returncode == 0, run.stderr
    assert (f", {3 * kept} kept" in run.stdout) == (kept > 0), run.stdout
    assert command("run", "larger.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(command.directory / "c.h5"), content(command.directory / "whole.h5"))
