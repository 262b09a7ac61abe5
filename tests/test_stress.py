"""Runs killed at random instants, again and again, until they are whole: nothing is lost, nothing differs.

A few kills here; RODSWEEP_KILLS=N asks for N on each task (`make stress`).
"""

import os
import random
import signal
import subprocess
from pathlib import Path

import h5py
import pytest
from contents import content, same

from rodsweep.results.schema import MISSING
from rodsweep.results.view import read_view

KILLS = int(os.environ.get("RODSWEEP_KILLS", "4"))
SPECTRA = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 3000}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
spectrum: {modes: 2}
"""
CYCLES = """
task: limit_cycle
parameters: {F: {start: 25, stop: 60, num: 8}, k1: 1.0e4, k2: [90, 100], gamma3: 1.0e-2}
limit_cycle: {samples: 8}
"""
CHAINS = CYCLES.replace("samples: 8", "samples: 8, continue_from: previous")
FAULTS = ("kill a rank", "kill all", "kill the launcher", "SIGTERM to a rank", "SIGUSR1 to the launcher")
LONGEST_RUN = 5.0
"""Seconds after which a fault strikes at the latest, the start of the processes included."""


def strike(process, fault):
    """Does what the fault says to a run under mpiexec, if it still runs."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    try:
        ranks = list(map(int, children.read_text().split()))
        if fault == "kill all":
            os.killpg(process.pid, signal.SIGKILL)
            for rank in ranks:  # each rank has a process group of its own
                os.kill(rank, signal.SIGKILL)
        elif fault == "kill the launcher":
            os.kill(process.pid, signal.SIGKILL)
        elif fault == "SIGUSR1 to the launcher":
            os.kill(process.pid, signal.SIGUSR1)
        elif ranks:
            os.kill(random.choice(ranks), signal.SIGKILL if fault == "kill a rank" else signal.SIGTERM)
    except (FileNotFoundError, ProcessLookupError):
        pass


def points_on_disk(path):
    """Points in the file and its journals; the file must open whenever it is there."""
    if not path.exists():
        return 0
    view = read_view(path)
    return int((view.variables["status"] != MISSING).sum()) + view.journalled


@pytest.mark.parametrize("config", [SPECTRA, CYCLES, CHAINS], ids=["spectra", "cycles", "chains"])
def test_run_killed_at_random_ends_in_the_file_of_an_undisturbed_one(command, config):
    random.seed(config)
    command.write("c.yaml", config)
    path = command.directory / "c.h5"
    whole = command("run", "c.yaml", "-o", "whole.h5", ranks=2)
    assert whole.returncode == 0, whole.stderr
    struck, kept, told = 0, 0, []
    while struck < KILLS:
        ranks, fault = random.randint(1, 4), random.choice(FAULTS)
        process = subprocess.Popen(
            command.argv("run", "c.yaml", ranks=ranks),
            cwd=command.directory,
            start_new_session=True,
            env=dict(os.environ),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            _, said = process.communicate(timeout=random.uniform(0.3, LONGEST_RUN))
        except subprocess.TimeoutExpired:
            strike(process, fault)
            struck += 1
            _, said = process.communicate(timeout=120)
            told.append((ranks, fault, process.returncode))
        else:
            assert process.returncode == 0, said
        assert "Traceback" not in said, told
        assert (now := points_on_disk(path)) >= kept, told
        kept = now
        if process.returncode == 0:
            assert same(content(path), content(command.directory / "whole.h5")), told
            path.unlink()
            kept = 0
    again = command("run", "c.yaml", ranks=2)
    assert again.returncode == 0, (again.stderr, told)
    assert same(content(path), content(command.directory / "whole.h5")), told
    assert [p.name for p in command.directory.glob("*.journal")] == []
    with h5py.File(path) as file:
        assert "finished" in file.attrs
