"""Shards: every point in one of them, put together as if never divided; what merge refuses."""

import re
import shutil
import threading
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from contents import content, same
from ranks import PATIENCE

from rodsweep.errors import InputError
from rodsweep.results.file import replacement
from rodsweep.results.file.combination.merge import merge
from rodsweep.results.file.replacement import ResultFileLock
from rodsweep.results.run.journal import journal_directory
from rodsweep.sweep.points.ranges import Shard, parsed_shard
from rodsweep.tasks.running.job import plan_without_solver

SPECTRA = """
title: shards
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 41}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
"""
DIAGRAM = """
task: phase_diagram
parameters:
  F: {start: 10, stop: 60, num: 6}
  k1: {start: 150, stop: 1.0e4, num: 7, spacing: log}
  k2: 1.0e4
  gamma3: 1.0e-4
"""


@pytest.mark.parametrize("units", [1, 7, 64, 1000, 12345, 10**6])
@pytest.mark.parametrize("of", [1, 2, 3, 8, 100])
def test_every_unit_is_in_one_shard(units, of):
    parts = [Shard(number, of).ranges_of_shard([(0, units)], units) for number in range(1, of + 1)]
    ranges = sorted(r for part in parts for r in part)
    assert ranges[0][0] == 0
    assert ranges[-1][1] == units
    assert all(a[1] == b[0] for a, b in zip(ranges[:-1], ranges[1:], strict=True))
    sizes = [sum(stop - start for start, stop in part) for part in parts]
    assert max(sizes) - min(sizes) <= max(1, units // (of * 64))
    assert max(map(len, parts)) <= 2 * 64 + 1


def test_shard_of_what_is_left_is_what_is_left_of_the_shard():
    rng = np.random.default_rng(3)
    for _ in range(50):
        units, of = int(rng.integers(1, 3000)), int(rng.integers(1, 9))
        edges = np.unique(rng.integers(0, units + 1, 10)).tolist()
        todo = list(zip(edges[::2], edges[1::2], strict=False))
        left = {i for start, stop in todo for i in range(start, stop)}
        for number in range(1, of + 1):
            whole = {i for r in Shard(number, of).ranges_of_shard([(0, units)], units) for i in range(*r)}
            part = {i for r in Shard(number, of).ranges_of_shard(todo, units) for i in range(*r)}
            assert part == whole & left


@pytest.mark.parametrize("text", ["0/2", "3/2", "1", "a/b", "1/0", "-1/2", "1/2/3", "", "1/1e9", "9" * 5000])
def test_shards_that_are_none_are_refused(text):
    with pytest.raises(InputError, match="--shard .* I/N"):
        parsed_shard(text)


def test_merged_shards_are_the_undivided_run(command):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    names = []
    for number in (1, 2, 3):
        done = command("run", "c.yaml", "--shard", f"{number}/3", ranks=2 if number == 1 else 0)
        assert done.returncode == 0, done.stderr
        assert f"164 of 492 points to do; shard {number}/3" in done.stdout
        names.append(f"c-{number}-of-3.h5")
        assert "328 of other shards, 164 ok" in done.stdout
    told = command("show", names[1]).stdout
    assert "328 points are not in this file: it is shard 2/3" in told
    assert "missing; if no run is in progress" not in told
    assert re.search(r"computed from \S+ on, all points of shard 2/3; rodsweep", told)
    some = command("merge", "m.h5", *names[:2])
    assert (some.returncode, "164 missing" in some.stdout) == (75, True)
    rest = command("merge", "m.h5", names[2], names[1])  # one that is already there changes nothing
    assert rest.returncode == 0
    whole, merged = (command.directory / name for name in ("whole.h5", "m.h5"))
    assert same(content(whole), content(merged))
    assert [p.name for p in command.directory.glob("*.journal")] == []
    with h5py.File(merged) as file:
        assert file.attrs["finished"]
        assert file.attrs["ranks"] == 4
        assert file.attrs["rank_points"].sum() == 492
        assert file.attrs["shard"] == ""
    assert "complete, nothing to do" in command("run", "c.yaml", "-o", "m.h5").stdout


@pytest.mark.long
def test_merged_diagram_gets_its_curves_from_a_last_run(command):
    command.write("c.yaml", DIAGRAM)
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    for number in (1, 2):
        assert command("run", "c.yaml", "--shard", f"{number}/2").returncode == 0
    merged = command("merge", "m.h5", "c-1-of-2.h5", "c-2-of-2.h5")
    assert merged.returncode == 0
    assert "adds the variables that need all points" in merged.stdout
    assert command("run", "c.yaml", "-o", "m.h5").returncode == 0
    assert same(content(command.directory / "whole.h5"), content(command.directory / "m.h5"))


def test_missing_shard_is_computed_by_a_run_of_the_merged_file(command):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert command("run", "c.yaml", "--shard", "2/2").returncode == 0
    assert command("merge", "m.h5", "c-2-of-2.h5").returncode == 75
    done = command("run", "c.yaml", "-o", "m.h5")
    assert "246 of 492 points to do, 246 kept" in done.stdout
    assert same(content(command.directory / "whole.h5"), content(command.directory / "m.h5"))


def test_what_does_not_belong_together_is_not_merged(command):
    command.write("c.yaml", SPECTRA)
    command.write("d.yaml", SPECTRA.replace("num: 41", "num: 40").replace("[100,", "[90,"))
    command.write("e.yaml", SPECTRA + "spectrum: {modes: 3}")
    command.write("text.h5", "no result")
    assert command("run", "c.yaml", "--shard", "1/2").returncode == 0
    assert command("run", "d.yaml", "-o", "d.h5").returncode == 0
    assert command("run", "e.yaml", "--shard", "1/99", "-o", "e.h5").returncode == 0
    shard = command.directory / "c-1-of-2.h5"
    before = shard.read_bytes()
    for names, sentence in (
        (("m.h5", shard.name, "d.h5"), "together the files do not form a full grid"),
        (("m.h5", shard.name, "e.h5"), "spectrum.modes is 4 in c-1-of-2.h5 and 3 in e.h5"),
        (("m.h5", "text.h5"), "cannot be read as a result of rodsweep"),
        (("m.h5", "nowhere.h5"), "does not exist"),
        (("e.h5", shard.name), "made from another config"),
        ((".", shard.name), "is a directory"),
    ):
        done = command("merge", *names)
        assert (done.returncode, sentence in done.stderr, done.stderr.count("\n")) == (2, True, 1), (
            done.stderr
        )
    journal = command.directory / (shard.name + ".journal")
    journal.mkdir()
    (journal / "rank-000000-1").write_bytes(b"points")
    done = command("merge", "m.h5", shard.name)
    assert (done.returncode, "first repeat the run of this file, which adds them" in done.stderr) == (2, True)
    shutil.rmtree(journal)
    assert shard.read_bytes() == before
    assert not (command.directory / "m.h5").exists()


def test_merge_takes_over_what_another_wrote_while_it_waited(command, monkeypatch):
    command.write("c.yaml", SPECTRA)
    for number in (1, 2):
        assert command("run", "c.yaml", "--shard", f"{number}/2").returncode == 0
    first, second, merged = (command.directory / f"{name}.h5" for name in ("c-1-of-2", "c-2-of-2", "m"))
    held = ResultFileLock(journal_directory(merged), merged)
    waits = threading.Event()
    clock = SimpleNamespace(monotonic=lambda: 0.0, sleep=lambda seconds: waits.set())  # patient without end
    monkeypatch.setattr(replacement, "time", clock)
    with ThreadPoolExecutor(1) as pool:
        waiting = pool.submit(merge, merged, [second], plan_without_solver)
        assert waits.wait(PATIENCE)
        shutil.copy(first, merged)
        held.release()
        assert waiting.result(PATIENCE).computed_point_count == 492


def test_damaged_shard_leaves_the_merged_file_as_it_was(command):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml", "--shard", "1/2").returncode == 0
    assert command("run", "c.yaml", "--shard", "2/2").returncode == 0
    assert command("merge", "m.h5", "c-1-of-2.h5").returncode == 75
    before = (command.directory / "m.h5").read_bytes()
    bad = command.directory / "c-2-of-2.h5"
    bad.write_bytes(bad.read_bytes()[: bad.stat().st_size // 2])
    done = command("merge", "m.h5", bad.name)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert (command.directory / "m.h5").read_bytes() == before
