"""`rodsweep run` as a user starts it: ranks, kills, refusals, exit statuses, the file in other hands."""

import re
import subprocess
import sys

import h5py
import numpy as np
import pytest
import xarray
from contents import content, same
from faults import small
from ranks import PATIENCE, kill, ranks_in, wait_for_end
from slow_runs import FOR_EVER, pause_until_journalled, slowly
from surveyed import few

from rodsweep.results.file.view import read_view

SMALL = """
title: small
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 21}
  k1: [100, 1.0e4, inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
spectrum: {modes: 4, follow: false}
"""


@pytest.mark.parametrize("ranks", few([3, 1], 1))
def test_any_number_of_ranks_gives_the_same_file(command, ranks):
    command.write("c.yaml", SMALL)
    alone = command("run", "c.yaml", "-o", "alone.h5")
    assert alone.returncode == 0, alone.stderr
    many = command("run", "c.yaml", "-o", "many.h5", ranks=ranks)
    assert many.returncode == 0, many.stderr
    assert same(content(command.directory / "alone.h5"), content(command.directory / "many.h5"))
    assert many.stdout.count("252 of 252 points to do") == 1
    with h5py.File(command.directory / "many.h5") as file:
        assert file.attrs["ranks"] == ranks


MANY = SMALL.replace("num: 21", "num: 40")


@pytest.mark.parametrize("whole_job", few([True, False], 1), ids=few(["all ranks", "one rank"], 1))
def test_resume_after_a_kill_gives_the_same_file(command, whole_job):
    """Killed while each rank waits behind its fiftieth point: all of these are there, and no other."""
    command.write("c.yaml", MANY)
    path = command.directory / "c.h5"
    process = command.started("run", "c.yaml", ranks=2, patch=slowly(FOR_EVER, 50))
    pause_until_journalled(process, path, 100)
    ranks = ranks_in(command.directory)
    assert set(ranks) == {0, 1}
    kill(*([process.pid, *ranks.values()] if whole_job else [ranks[1]]))
    _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode not in (0, 1, 2, 75), err
    wait_for_end(command.directory)
    assert read_view(path).journalled_count == 100
    assert "100 of the computed points are so far only in the journal" in " ".join(
        command("show", "c.h5").stdout.split()
    )
    again = command("run", "c.yaml", ranks=2)
    assert again.returncode == 0, again.stderr
    assert "380 of 480 points to do, 100 kept" in again.stdout
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(path), content(command.directory / "whole.h5"))
    assert not (command.directory / "c.h5.journal").exists()
    third = command("run", "c.yaml")
    assert "complete, nothing to do" in third.stdout
    assert third.returncode == 0


def test_bad_config_ends_all_ranks_with_status_2_and_one_message(command):
    command.write("c.yaml", SMALL.replace("modes", "mods"))
    for ranks in (0, 2):
        run = command("run", "c.yaml", ranks=ranks)
        assert run.returncode == 2
        assert run.stderr.count("unknown key spectrum.mods; did you mean modes?") == 1
        assert "Traceback" not in run.stderr
        assert [p.name for p in command.directory.iterdir()] == ["c.yaml"]


def test_refusals_of_the_command_line_have_status_2(command):
    command.write("c.yaml", SMALL)
    for words in (
        ["frob"],
        ["run"],
        ["run", "none.yaml"],
        ["show", "none.h5"],
        ["run", "c.yaml", "--set", "parameters.F.stop=200"],
        ["run", "c.yaml", "-o", "."],
    ):
        run = command(*words)
        assert run.returncode == 2, (words, run.stderr)
        assert run.stderr.startswith("rodsweep: ")
        assert len(run.stderr.splitlines()) == 1
        assert [p.name for p in command.directory.iterdir()] == ["c.yaml"]


def test_file_from_another_config_is_refused_and_fresh_replaces_it(command):
    command.write("c.yaml", SMALL)
    command("run", "c.yaml", "--set", "accuracy=1e-6", "-o", "c.h5")
    refused = command("run", "c.yaml")
    assert refused.returncode == 2
    assert "accuracy is 1e-06 in the file and 1e-10 in the config" in refused.stderr
    assert command("run", "c.yaml", "--fresh").returncode == 0


def test_failed_point_is_a_status_and_not_the_end(command):
    """The onset F* cannot be had to 1e-12: its status says so, the rest is computed, exit status 1."""
    config = "task: spectrum\nparameters: {F: [10, 20.0080206921031, 30], k1: 1e4, k2: 1e4, gamma3: 1e-4}\n"
    command.write("c.yaml", config + "accuracy: 1e-12\n")
    run = command("run", "c.yaml", ranks=2)
    assert run.returncode == 1
    assert "2 ok, 1 accuracy_not_reached" in run.stdout
    status = read_view(command.directory / "c.h5").variables["status"].ravel()
    assert status.tolist() == [0, 3, 0]
    shown = " ".join(command("show", "c.h5").stdout.split())
    assert "as its error estimate says" in shown


def run_patched(command, patch, ranks=2):
    """A run whose every rank wraps `solve(index)` by the function `patched(rank, solve)` of `patch`."""
    patch = (
        "import time\nimport rodsweep.cli.run.shard_solver as shard_solver\nreal = shard_solver.sweep\n"
        + patch
        + "\nfrom dataclasses import replace\n"
        "def sweep(ranks, todo, loop, *words):\n"
        "    return real(ranks, todo, replace(loop, solve=patched(ranks.rank, loop.solve)), *words)\n"
        "shard_solver.sweep = sweep\n"
    )
    return command("run", "c.yaml", ranks=ranks, patch=patch)


ELSEWHERE = "import os\nif os.environ['OMPI_COMM_WORLD_RANK'] == '1': os.chdir('other')\n"
"""Patch that starts the second rank in another directory."""


def test_points_of_a_rank_started_in_another_directory_are_in_the_file(command):
    command.write("c.yaml", SMALL)
    (command.directory / "other").mkdir()
    run = command("run", "c.yaml", ranks=2, patch=ELSEWHERE)
    assert run.returncode == 0  # a slow machine shows progress on stderr
    assert "252 ok" in run.stdout
    assert list((command.directory / "other").iterdir()) == []


def test_directory_that_a_rank_cannot_enter_is_refused(command):
    command.write("c.yaml", SMALL)
    (command.directory / "other").mkdir()
    refuse = "def refuse(to): raise FileNotFoundError(2, 'No such file or directory')\nos.chdir = refuse\n"
    run = command("run", "c.yaml", ranks=2, patch=ELSEWHERE + refuse)
    assert run.returncode == 3
    assert "of the first rank cannot be entered: No such file or directory" in run.stderr
    assert not (command.directory / "c.h5").exists()


def test_bug_while_the_file_is_opened_ends_all_ranks(command):
    command.write("c.yaml", SMALL)
    patch = (
        "import rodsweep.results.file.result_file_writer as store\n"
        "def broken(self, *words): raise ValueError('a bug')\n"
        "store.ResultFileWriter.__init__ = broken\n"
        "def patched(rank, solve): return solve\n"
    )
    run = run_patched(command, patch)
    assert run.returncode not in (0, 1, 2)
    assert "rank 0 failed, all ranks end" in run.stderr


def test_petsc_missing_on_one_rank_ends_all_ranks_with_one_sentence(command):
    command.write("c.yaml", SMALL)
    patch = (
        "import os, sys\n"
        "if os.environ.get('OMPI_COMM_WORLD_RANK', os.environ.get('PMI_RANK')) == '1':\n"
        "    sys.modules['petsc4py'] = None\n"
        "def patched(rank, solve): return solve\n"
    )
    run = run_patched(command, patch)
    assert run.returncode == 3
    assert run.stderr.count("rodsweep: petsc4py cannot be imported") == 1


@pytest.mark.parametrize(
    "wait",
    few(["ctypes.PyDLL(None).usleep(200000)", "time.sleep(0.2)"], 1),
    ids=few(["holding the interpreter", "asleep"], 1),
)
def test_slow_points_are_shared_evenly(command, wait):
    """Sixteen slow points in a row: each rank solves about half, also where a rank's Python stands still.

    A solve inside PETSc keeps the interpreter from the thread that answers the other ranks. A point is longer
    where the other rank lags behind, as one does that a busy machine lets wait; but not for ever, as nothing
    but the handing out may bring the other its share.
    """
    command.write("c.yaml", SMALL)
    patch = (
        "import ctypes\n"
        "begun, waits = open('slow', 'a+'), []\n"
        "def patched(rank, solve):\n"
        "    def is_ahead():\n"
        "        begun.seek(0)\n"
        "        ranks = begun.read()\n"
        "        return 2 * ranks.count(str(rank)) > len(ranks) + 3 and len(ranks) < 14\n"
        "    def slow(index):\n"
        "        if 100 <= index < 116:\n"
        "            begun.write(str(rank))\n"
        "            begun.flush()\n"
        f"            {wait}\n"
        "            while is_ahead() and len(waits) < 200:\n"
        "                waits.append(index)\n"
        f"                {wait}\n"
        "        return solve(index)\n"
        "    return slow\n"
    )
    run = run_patched(command, patch)
    assert run.returncode == 0, run.stderr
    ranks = (command.directory / "slow").read_text()
    assert len(ranks) == 16
    assert 5 <= ranks.count("0") <= 11, ranks


def test_fresh_leaves_a_file_that_is_no_result(command):
    command.write("c.yaml", SMALL)
    for name, why in (("c.yaml", "must end in .h5"), ("notes.h5", "not a result file")):
        command.write(name, SMALL)
        run = command("run", "c.yaml", "-o", name, "--fresh")
        assert run.returncode == 2
        assert why in run.stderr
        assert (command.directory / name).read_text() == SMALL
    with h5py.File(command.directory / "theirs.h5", "w") as file:
        file["data"] = 1.0
    assert command("run", "c.yaml", "-o", "theirs.h5", "--fresh").returncode == 2
    with h5py.File(command.directory / "theirs.h5") as file:
        assert file["data"][()] == 1.0


def test_run_killed_before_its_end_was_written_writes_it_the_next_time(command):
    command.write("c.yaml", SMALL)
    patch = (
        "import os, rodsweep.results.file.result_file_writer as store\n"
        "def die(self, attributes): os._exit(9)\n"
        "writer = store.ResultFileWriter\n"
        "fold = writer.add_journals\n"
        "writer.add_journals = lambda self, a, more=(): die(self, a) if a else fold(self, a, more)\n"
        "def patched(rank, solve): return solve\n"
    )
    assert run_patched(command, patch, ranks=0).returncode == 9
    again = command("run", "c.yaml")
    assert again.returncode == 0, again.stderr
    assert "complete" in again.stdout
    assert "finished" in read_view(command.directory / "c.h5").attributes


@pytest.mark.long
@pytest.mark.parametrize("rank", [0, 1])
def test_bug_on_one_rank_ends_all_ranks(command, rank):
    command.write("c.yaml", MANY)
    patch = (
        "import time\n"
        "def patched(rank, solve):\n"
        "    def slow(index):\n"  # so slow that the other rank, which may begin later, gets a point too
        "        time.sleep(0.1)\n"
        "        return solve(index)\n"
        f"    return (lambda index: 1 / 0) if rank == {rank} else slow\n"
    )
    run = run_patched(command, patch)
    assert run.returncode not in (0, 1, 2)
    assert f"rank {rank} failed, all ranks end" in run.stderr
    assert "ZeroDivisionError" in run.stderr


def test_only_the_first_rank_talks_and_logs_have_plain_lines(command):
    command.write("c.yaml", SMALL)
    patch = (
        "import rodsweep.sweep.progress as progress\n"
        "class Clock:\n"
        "    seconds = 0.0\n"
        "    def monotonic(self):\n"
        "        self.seconds += 1.0\n"
        "        return self.seconds\n"
        "progress.time = Clock()\n"
        "def patched(rank, solve): return solve\n"
    )
    run = run_patched(command, patch)
    assert run.stdout.count("252 points in") == 1
    lines = run.stderr.splitlines()
    assert lines
    assert all(
        re.fullmatch(r"\d+ of 252 points(, [\d.]+(/s| s per point))?(, about [\d.]+ (s|min) left)?", line)
        for line in lines
    ), lines
    assert "\x1b" not in run.stdout


def test_file_opens_in_xarray_with_named_coordinates_and_no_argument(command):
    command.write("c.yaml", SMALL)
    command("run", "c.yaml")
    with xarray.open_dataset(command.directory / "c.h5", engine="h5netcdf") as data:
        sizes = {"F": 21, "k1": 3, "k2": 2, "gamma3": 2, "mode": 4}
        assert dict(data.sizes) == sizes | {"change": len(data.change_F)}
        point = data.sel(F=30, k1=1e4, k2=1e4, gamma3=1e-4)
        assert float(point.growth_rate.sel(mode=1)) == pytest.approx(-54.2947994117, rel=1e-10)
        assert float(point.frequency.sel(mode=1)) == pytest.approx(145.671884063, rel=1e-10)
        assert data.growth_rate.attrs["units"] == "1/tau2"
        assert int(data.status.max()) == 0
        for name in ("config", "petsc_version", "git_commit", "ranks", "hosts", "started", "finished"):
            assert name in data.attrs
        assert data.attrs["config"] == SMALL


def test_point_list_opens_with_its_parameters_as_coordinates(command):
    command.write("p.csv", "gamma3,F,k1,k2\n0,30,inf,inf\n1e-4,30,1e4,1e4\n")
    command.write("c.yaml", "task: spectrum\nparameters: {points: p.csv}\n")
    assert command("run", "c.yaml").returncode == 0
    with xarray.open_dataset(command.directory / "c.h5", engine="h5netcdf") as data:
        assert {"F", "k1", "k2", "gamma3", "point", "mode"} <= set(data.coords)
        assert data.growth_rate.dims == ("point", "mode")
        assert data.k1.values.tolist() == [np.inf, 1e4]
    command.write("p.csv", "gamma3,F,k1,k2\n0,31,inf,inf\n1e-4,30,1e4,1e4\n")
    changed = command("run", "c.yaml")
    assert changed.returncode == 2
    assert "points" in changed.stderr


def test_longitudinal_modes_are_added_only_where_asked(command):
    config = "task: spectrum\nparameters: {F: 3, k1: [10, 40], k2: 9, gamma3: 0, gamma1: 0.5}\n"
    command.write("c.yaml", config + "spectrum: {longitudinal: true, modes: 2}\n")
    assert command("run", "c.yaml").returncode == 0
    rates = read_view(command.directory / "c.h5").variables["longitudinal_rate"]
    assert np.allclose(rates, -np.outer([20, 80], [(np.pi / 2) ** 2, (1.5 * np.pi) ** 2]), rtol=1e-14)
    command.write("d.yaml", SMALL)
    command("run", "d.yaml")
    assert "longitudinal_rate" not in read_view(command.directory / "d.h5").variables


def test_package_imports_start_neither_mpi_nor_petsc(command):
    code = (
        "import sys, rodsweep, rodsweep.cli\n"
        "from rodsweep.tasks.running.job import job_of_file\n"
        "from rodsweep.results.file.view import read_view\n"
        "from rodsweep.post.figures import draw\nfrom rodsweep.post.summary import show_summary\n"
        "print([m for m in ('mpi4py.MPI', 'petsc4py.PETSc', 'slepc4py.SLEPc') if m in sys.modules])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_checking_and_drawing_load_no_compiler(command):
    """Its import takes as long as all else that `check` does."""
    command.write("points.csv", small.POINTS)
    for name, text in small.CONFIGS.items():
        command.write(f"{name}.yaml", text)
    code = (
        "import sys, rodsweep.cli, rodsweep.post.figures, rodsweep.post.summary\n"
        "for name in sys.argv[1:]:\n"
        "    rodsweep.cli.commands.main(['check', name], standalone_mode=False)\n"
        "    assert 'numba' not in sys.modules, name\n"
    )
    words = [sys.executable, "-c", code, *(f"{name}.yaml" for name in small.CONFIGS)]
    run = subprocess.run(words, capture_output=True, text=True, check=True, cwd=command.directory)
    assert run.stdout.count("valid") == len(small.CONFIGS)


@pytest.mark.parametrize("F", [1e30, 1e150])
def test_forces_beyond_every_mesh_end_soon(command, F):
    command.write("c.yaml", f"task: spectrum\nparameters: {{F: {F:e}, k1: inf, k2: inf, gamma3: 0}}\n")
    checked = command("check", "c.yaml")
    assert checked.returncode == 0
    assert "unknowns allowed and will end with the status failed" in " ".join(checked.stdout.split())
    run = command("run", "c.yaml")
    assert run.returncode == 1
    assert "1 failed" in run.stdout


def test_check_says_what_is_modelled_and_what_is_left_out(command):
    command.write("c.yaml", SMALL.replace("[100, 1.0e4, inf]", "inf").replace("[0, 1.0e-4]", "0"))
    run = command("check", "c.yaml")
    assert run.returncode == 0, run.stderr
    text = " ".join(run.stdout.split())
    for words in (
        "42 points",
        "stretch no k1 = inf",
        "rotational drag no gamma3 = 0",
        "certificate yes",
        "s on one rank",
    ):
        assert words in text, words
    assert sorted(p.name for p in command.directory.iterdir()) == ["c.yaml"]


def test_transverse_spectrum_does_not_move_with_axial_drag(command):
    config = "task: spectrum\nparameters: {F: [3, 30], k1: 100, k2: 50, gamma3: 0.1, gamma1: 0.5}\n"
    command.write("c.yaml", config + "spectrum: {longitudinal: true}\n")
    for gamma1, output in ((0.5, "half.h5"), (7, "seven.h5")):
        assert command("run", "c.yaml", "-o", output, "--set", f"parameters.gamma1={gamma1}").returncode == 0
    half, seven = (h5py.File(command.directory / name) for name in ("half.h5", "seven.h5"))
    for name in ("growth_rate", "frequency", "unstable_count"):
        assert np.array_equal(half[name][:], seven[name][:])
    assert np.allclose(half["longitudinal_rate"][:] * 0.5, seven["longitudinal_rate"][:] * 7, rtol=1e-14)


def test_link_as_output_is_followed(command):
    command.write("c.yaml", SMALL)
    (command.directory / "elsewhere").mkdir()
    link, target = command.directory / "link.h5", command.directory / "elsewhere" / "real.h5"
    link.symlink_to(target)
    assert command("run", "c.yaml", "-o", "link.h5").returncode == 0
    assert link.is_symlink()
    assert target.is_file()
    assert "complete, nothing to do" in command("run", "c.yaml", "-o", "link.h5").stdout
    assert command("show", "link.h5").returncode == 0


@pytest.mark.long
def test_full_disk_under_the_log_is_told_in_a_sentence(command):
    command.write("c.yaml", SMALL)
    with open("/dev/full", "w") as full:
        run = command.afresh("run", "c.yaml", stdout=full)
    assert (run.returncode, run.stderr) == (3, "rodsweep: standard output: No space left on device\n")
    assert command("run", "c.yaml").returncode == 0


def test_another_title_continues_the_same_file(command):
    command.write("c.yaml", SMALL)
    assert command("run", "c.yaml", "--shard", "1/2", "-o", "c.h5").returncode in (0, 75)
    with h5py.File(command.directory / "c.h5") as file:
        done = int((file["status"][...] == 0).sum())
        before = file["growth_rate"][...]
    command.write("c.yaml", SMALL.replace("title: small", "title: renamed"))
    run = command("run", "c.yaml")
    assert run.returncode == 0, run.stderr
    assert f"{done} kept" in run.stdout
    assert "c.h5: renamed, task spectrum" in command("show", "c.h5").stdout
    with h5py.File(command.directory / "c.h5") as file:
        assert "title: renamed" in file.attrs["config"]
        known = np.isfinite(before)
        assert np.array_equal(file["growth_rate"][...][known], before[known])
    again = command("run", "c.yaml", "--set", "title=third")
    assert "complete, nothing to do" in again.stdout
    assert "c.h5: third, task spectrum" in command("show", "c.h5").stdout
    refused = command("run", "c.yaml", "--set", "title=fourth", "--set", "accuracy=1e-8")
    assert refused.returncode == 2
    assert "(accuracy is 1e-" in refused.stderr
