"""Flutter of relative loads: searched for by all ranks together, once a rod, before the points are made."""

import os
import re
import signal

import h5py
import pytest
from contents import content, same
from ranks import PATIENCE, pause_until
from surveyed import few

from rodsweep.config import read_config
from rodsweep.config.arm.status import FLUTTER_UNKNOWN
from rodsweep.errors import BUG_EXIT_STATUS, InputError
from rodsweep.model.rod import Rod
from rodsweep.sweep.points.flutter_forces import FlutterForce, rods_needing_flutter_force
from rodsweep.tasks.running.job import job_of_config
from rodsweep.verdict import relative_load

RODS = 8
"""Four lengths, each with a rod in either plane of the rectangle."""
ARMS = """
task: {task}
parameters:
  arm:
    length: [8 cm, 10 cm, 12 cm, 14 cm]
    width: 6 mm
    height: 8 mm
    young: 100 kPa
    viscosity: 20 Pa s
    drag: [likeliest, most]
    pressure: [0.9 of flutter, 1.2 of flutter]
"""
SEARCH = """
import os, pathlib, time
from rodsweep.verdict import relative_load

search, rank = relative_load.first_hopf_force, os.environ.get("OMPI_COMM_WORLD_RANK", "0")

def first_hopf_force(rod):
    with open(f"searches-{{rank}}", "a") as file:
        file.write(f"{{rod.k1!r}} {{rod.k2!r}} {{rod.gamma3!r}}\\n")
    {first}
    return search(rod)

relative_load.first_hopf_force = first_hopf_force
"""
"""What every rank executes first: a search is noted, and begins with one more statement."""


def searching(first="pass"):
    return SEARCH.format(first=first)


def searches(command, rank):
    path = command.directory / f"searches-{rank}"
    found = path.read_text().splitlines()
    path.unlink()
    return found


@pytest.fixture
def rods(command):
    """The rods of the config `a.yaml`, in the order in which the ranks share them."""
    config, _ = read_config(command.write("a.yaml", ARMS.format(task="spectrum")))
    return rods_needing_flutter_force(config.parameters.arm)


@pytest.mark.long
def test_ranks_divide_the_search_and_give_the_same_file(command, rods):
    assert len(rods) == RODS
    files = {}
    for ranks in (1, 3):
        run = command("run", "a.yaml", "-o", f"{ranks}.h5", ranks=ranks, patch=searching())
        assert run.returncode == 0, run.stderr
        files[ranks] = content(command.directory / f"{ranks}.h5")
        parts = [searches(command, rank) for rank in range(ranks)]
        assert sorted(sum(parts, [])) == sorted(f"{rod.k1!r} {rod.k2!r} {rod.gamma3!r}" for rod in rods)
        assert max(map(len, parts)) - min(map(len, parts)) <= 1
    assert same(files[1], files[3])


@pytest.mark.long
@pytest.mark.parametrize(("task", "ranks"), few([("modes", 2), ("spectrum", 0)], 1))
def test_flutter_that_is_not_found_is_a_status_with_a_reason(command, rods, task, ranks):
    """Of the second length in its second plane; all other points are as they are without the failure."""
    command.write("a.yaml", ARMS.format(task=task))
    failure = f"if rod.k1 == {rods[3].k1!r}: raise relative_load.FlutterSearchFailed('no box is left')"
    assert command("run", "a.yaml", "-o", "whole.h5").returncode == 0
    run = command("run", "a.yaml", "-o", "part.h5", ranks=ranks, patch=searching(failure))
    assert run.returncode == 1
    assert re.search(r"flutter_unknown, for example at .*: no box is left", run.stdout)
    whole, part = (h5py.File(command.directory / f"{name}.h5") for name in ("whole", "part"))
    with whole, part:
        assert (part["status"][1] == FLUTTER_UNKNOWN).all()
        for name in ("status", "growth_rate", "F"):
            for length in (0, 2, 3):
                assert (whole[name][length] == part[name][length]).all()
    assert "the search could not determine the flutter threshold" in command("show", "part.h5").stdout


def test_an_exception_in_the_search_on_one_rank_ends_all_ranks(command, rods):
    bug = f"if rod.k1 == {rods[3].k1!r}: raise RuntimeError('a bug')"
    run = command("run", "a.yaml", ranks=2, patch=searching(bug))
    assert run.returncode == BUG_EXIT_STATUS
    assert "rank 1 failed" in run.stderr
    assert "RuntimeError: a bug" in run.stderr
    assert not (command.directory / "a.h5").exists()


def test_a_stop_during_the_search_ends_the_run_before_its_file(command, rods):
    """Within the first search; no other one begins."""
    wait = "while not pathlib.Path('go').exists(): time.sleep(0.01)"
    process = command.started("run", "a.yaml", patch=searching(wait))
    pause_until((command.directory / "searches-0").exists, "the search never begins")
    os.kill(process.pid, signal.SIGTERM)
    (command.directory / "go").touch()
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 75, err
    assert "stopped by SIGTERM; no point is computed yet" in out
    assert len(searches(command, 0)) < RODS
    assert not (command.directory / "a.h5").exists()


def test_arms_of_which_none_has_a_known_flutter_are_refused(command, rods):
    path = command.directory / "a.yaml"
    unknown = dict.fromkeys(rods, FlutterForce(float("nan"), "no box is left"))
    with pytest.raises(InputError, match=r"parameters\.arm\.pressure: no box is left"):
        job_of_config(path, *read_config(path), unknown)


@pytest.mark.parametrize("error", [OverflowError("too large"), ZeroDivisionError()])
def test_a_search_that_overflows_fails_in_words(monkeypatch, error):
    def overflowing(*_):
        raise error

    monkeypatch.setattr(relative_load, "zeros_and_open_boxes_of_covering", overflowing)
    with pytest.raises(
        relative_load.FlutterSearchFailed, match="relative load refers fails: (too large|ZeroDivisionError)"
    ):
        relative_load.first_hopf_force(Rod(F=0.0, k1=1234.5, k2=1e3, gamma3=1e-4))


def test_a_rank_without_an_arm_to_search_waits_for_no_other(command):
    """PETSc, which the search needs, starts on all ranks together."""
    arm = "length: 14 cm, radius: 4 mm, young: 100 kPa, viscosity: 20 Pa s, law: neo_hookean"
    command.write("a.yaml", f"task: spectrum\nparameters: {{arm: {{{arm}, pressure: 1.3 of flutter}}}}\n")
    run = command("run", "a.yaml", ranks=2)
    assert run.returncode == 0, run.stderr
