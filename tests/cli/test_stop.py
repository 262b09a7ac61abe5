"""A run that is asked to stop: what is done is in the file, the exit status says "continue me"."""

import os
import pty
import re
import signal
from contextlib import suppress
from functools import cache

import h5py
import pytest
from conftest import Command
from contents import content, same
from ranks import PATIENCE, kill, pause_until, ranks_in, wait_for_end
from slow_runs import FOR_EVER, pause_until_journalled, slowly
from surveyed import survey_only

from rodsweep.results.file.view import read_view

SPECTRA = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 40}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
spectrum: {follow: false}
"""
CYCLES = """
task: limit_cycle
parameters: {F: {start: 30, stop: 60, num: 6}, k1: 1.0e4, k2: 100, gamma3: 1.0e-2}
limit_cycle: {start: neighbour}
"""


@pytest.fixture(scope="module")
def content_of(tmp_path_factory, loaded):
    """What the file of a config holds after a run that nothing stops, each computed once."""

    @cache
    def whole(config):
        command = Command(tmp_path_factory.mktemp("whole"), lambda: loaded)
        command.write("c.yaml", config)
        assert command("run", "c.yaml").returncode == 0
        return content(command.directory / "c.h5")

    return whole


def started(command, ranks, pause, afresh=False):
    """A run whose journals hold points; each rank takes `pause` seconds for every further one."""
    process = command.started("run", "c.yaml", ranks=ranks, patch=slowly(pause), afresh=afresh)
    pause_until_journalled(process, command.directory / "c.h5", 1)
    return process


@pytest.mark.parametrize(
    ("number", "ranks", "rank"),
    [
        (signal.SIGINT, 0, None),
        (signal.SIGTERM, 3, 2),
    ],
    ids=["Ctrl-C", "last rank"],
)
def test_stopped_run_ends_with_its_points_in_the_file_and_goes_on(command, content_of, number, ranks, rank):
    command.write("c.yaml", SPECTRA)
    process = started(command, ranks, pause=0.2)
    os.kill(ranks_in(command.directory)[rank] if ranks else process.pid, number)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 75, err
    stopped = rf"stopped by {number.name}; (\d+) points? kept, the same command continues the run"
    assert "Traceback" not in err
    assert not (command.directory / "c.h5.journal").exists()
    with h5py.File(command.directory / "c.h5") as file:
        done = int((file["status"][...] == 0).sum())
        assert file.attrs["stopped"] == number.name
        assert "finished" not in file.attrs
    assert 0 < done < 480
    assert re.search(stopped, out)[1] == str(done)
    assert ("stopping: all points that are done are kept" in err) == (number == signal.SIGINT and not ranks)
    assert f"stopped by {number.name}" in command("show", "c.h5").stdout
    again = command("run", "c.yaml")
    assert again.returncode == 0, again.stderr
    assert f"{480 - done} of 480 points to do, {done} kept" in again.stdout
    assert same(content(command.directory / "c.h5"), content_of(SPECTRA))


@pytest.mark.long
def test_further_signals_do_not_change_the_status(command):
    """Python forgets its handlers long before MPI is through with its end: they come until all is over."""
    command.write("c.yaml", SPECTRA)
    process = started(command, ranks=0, pause=0.2, afresh=True)
    process.send_signal(signal.SIGUSR1)
    said = ""
    while "the same command continues" not in said:
        line = process.stdout.readline()
        assert line, process.communicate()
        said += line
    while process.poll() is None:
        process.send_signal(signal.SIGTERM)
    assert process.returncode == 75


def typed_ctrl_c(command, ranks):
    """(exit status, output) of a run on a terminal of its own on which Ctrl-C is typed after 61 points."""
    patch = command.directory / "patch"
    patch.mkdir()
    (patch / "sitecustomize.py").write_text(slowly(FOR_EVER, points=61))
    argv = command.argv("run", "c.yaml", ranks=ranks)
    path = os.pathsep.join([str(patch), os.environ.get("PYTHONPATH", "")])
    pid, terminal = pty.fork()
    if not pid:
        os.chdir(command.directory)
        os.execve(argv[0], argv, os.environ | {"PYTHONPATH": path})
    result, said = command.directory / "c.h5", b""
    try:
        pause_until(
            lambda: result.exists() and read_view(result).journalled_count >= 61, "61 points are not there"
        )
        os.write(terminal, b"\x03")
        with suppress(OSError):  # once the terminal's other end is closed
            while part := os.read(terminal, 4096):
                said += part
    finally:
        if not said:
            kill(pid, *ranks_in(command.directory).values())
        status = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        os.close(terminal)
    return status, said.decode(errors="replace")


@pytest.mark.long
def test_ctrl_c_in_a_terminal_ends_like_sigterm(command):
    command.write("c.yaml", SPECTRA)
    status, said = typed_ctrl_c(command, ranks=0)
    assert status == 75
    assert "stopping: all points that are done are kept" in said
    assert "stopped by SIGINT; 61 points kept, the same command continues the run" in said
    assert "61 kept" in command("run", "c.yaml").stdout


def test_ctrl_c_under_a_launcher_loses_no_point(command):
    """What the launcher makes of it, and how it exits, is its own: Open MPI's asks the ranks by SIGTERM."""
    command.write("c.yaml", SPECTRA)
    typed_ctrl_c(command, ranks=2)
    wait_for_end(command.directory)
    again = command("run", "c.yaml")
    assert again.returncode == 0
    assert 61 <= int(re.search(r"(\d+) kept", again.stdout)[1]) < 480


def test_launcher_passes_the_warning_on(command):
    command.write("c.yaml", SPECTRA)
    process = started(command, ranks=2, pause=0.2)
    process.send_signal(signal.SIGUSR1)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 75, err
    assert "stopped by SIGUSR1" in out


@pytest.mark.long
def test_chain_stops_between_two_of_its_points_and_goes_on_from_there(command):
    command.write("c.yaml", CYCLES)
    process = started(command, ranks=2, pause=FOR_EVER)
    process.send_signal(signal.SIGUSR1)  # which ends the pause of the rank that is at the chain
    process.communicate(timeout=PATIENCE)
    assert process.returncode == 75
    with h5py.File(command.directory / "c.h5") as file:
        done = int((file["status"][...] != -1).sum())
    assert done == 1
    again = command("run", "c.yaml")
    assert again.returncode == 0, again.stderr
    assert "5 of 6 points to do, 1 kept" in again.stdout
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(command.directory / "c.h5"), content(command.directory / "whole.h5"))


BRANCHES = """
task: branch
parameters: {k1: [100, 150, 200], k2: 1.0e4, gamma3: 1.0e-4}
branch: {stop: 120, cycles: 100, special: 8}
accuracy: 1.0e-4
"""
FOR_EVER_INSIDE = """
import os, pathlib, time
from rodsweep.sweep.stop import SolverReportListener

hear = SolverReportListener.__call__
rank = os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMI_RANK", "0"))

def hear_and_wait(self, text):
    hear(self, text)
    if self.item_label() and self.item_label() != "point 1 of 3" and "cycles" in text().text:
        pathlib.Path(f"inside-{rank}").write_text(f"{self.item_label()}: {text().text}")
        while True:
            time.sleep(0.01)
            hear(self, text)

SolverReportListener.__call__ = hear_and_wait
"""
"""What every rank executes first: within a point but the first it stays on a branch until a stop ends it."""


@pytest.mark.long
@pytest.mark.parametrize(
    ("number", "ranks", "rank"),
    [pytest.param(signal.SIGINT, 0, None, marks=survey_only), (signal.SIGTERM, 2, 1)],
    ids=["Ctrl-C", "other rank"],
)
def test_run_is_stopped_within_a_point_that_is_then_solved_anew(command, content_of, number, ranks, rank):
    """Whichever rank hears the signal, both end where they are, and what they were at is missing."""
    command.write("c.yaml", BRANCHES)
    process = command.started("run", "c.yaml", ranks=ranks, patch=FOR_EVER_INSIDE)
    begun = [command.directory / f"inside-{number}" for number in range(max(ranks, 1))]
    pause_until(lambda: process.poll() is not None or all(path.exists() for path in begun), "no long point")
    os.kill(ranks_in(command.directory)[rank] if ranks else process.pid, number)
    out, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 75, err
    assert "Traceback" not in err
    said = rf"stopped by {number.name}; 1 point kept, {max(ranks, 1)} interrupted, to be solved again"
    assert re.search(said, out), out
    for path in begun:
        assert re.match(
            r"point [23] of 3: branch from Hopf point \d of \d: F = [\d.]+ on the way to 120, \d+ cycles",
            path.read_text(),
        )
    with h5py.File(command.directory / "c.h5") as file:
        assert (file["status"][...] == -1).sum() == 2
    again = command("run", "c.yaml")
    assert again.returncode == 0, again.stderr
    assert "2 of 3 points to do, 1 kept" in again.stdout
    assert same(content(command.directory / "c.h5"), content_of(BRANCHES))


@pytest.mark.long
def test_shares_of_the_ranks_are_kept_and_shown(command):
    command.write("c.yaml", SPECTRA.replace("num: 40", "num: 25"))
    assert command("run", "c.yaml", ranks=3).returncode == 0
    with h5py.File(command.directory / "c.h5") as file:
        points, busy, idle = (
            file.attrs[f"rank_{name}"] for name in ("points", "busy_seconds", "idle_seconds")
        )
        seconds = file["seconds"][...].sum()
    assert points.sum() == 300
    assert len(points) == len(busy) == len(idle) == 3
    assert busy.sum() > seconds
    assert (idle >= 0).all()
    shown = " ".join(command("show", "c.h5").stdout.split())
    assert "last run: 3 ranks on 1 host, 300 points" in shown
    assert f"{points.min()} to {points.max()} points" in shown
