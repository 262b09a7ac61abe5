"""A run that is asked to stop: what is done is in the file, the exit status says "continue me"."""

import os
import signal
import subprocess
import time
from pathlib import Path

import h5py
import pytest
from contents import content, same

SPECTRA = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 2000}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
"""
CYCLES = """
task: limit_cycle
parameters: {F: {start: 30, stop: 60, num: 6}, k1: 1.0e4, k2: 100, gamma3: 1.0e-2}
limit_cycle: {continue_from: previous}
"""


def started(command, *words, ranks):
    """The process, once its journals hold a point."""
    process = subprocess.Popen(
        command.argv(*words, ranks=ranks),
        cwd=command.directory,
        start_new_session=True,
        env=dict(os.environ),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    pages = command.directory / "c.h5.journal"
    deadline = time.monotonic() + 60
    while not any(page.stat().st_size > 200 for page in pages.glob("rank-*")):
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < deadline
        time.sleep(0.01)
    return process


def ranks_of(process):
    """The processes that a launcher has started."""
    return list(map(int, Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()))


@pytest.mark.parametrize("number", [signal.SIGUSR1, signal.SIGTERM])
@pytest.mark.parametrize(("ranks", "whom"), [(0, "alone"), (3, "first rank"), (3, "last rank")])
def test_stopped_run_ends_with_its_points_in_the_file_and_goes_on(command, number, ranks, whom):
    command.write("c.yaml", SPECTRA)
    process = started(command, "run", "c.yaml", ranks=ranks)
    target = {"alone": lambda: process.pid, "first rank": lambda: min(ranks_of(process))}
    os.kill(target.get(whom, lambda: max(ranks_of(process)))(), number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 75, err
    assert f"stopped by {number.name}; the same command continues" in out
    assert "Traceback" not in err
    assert not (command.directory / "c.h5.journal").exists()
    with h5py.File(command.directory / "c.h5") as file:
        done = int((file["status"][...] == 0).sum())
        assert file.attrs["stopped"] == number.name
        assert "finished" not in file.attrs
    assert 0 < done < 24_000
    assert f"stopped by {number.name}" in command("show", "c.h5").stdout
    if whom != "last rank" or number == signal.SIGUSR1:
        return
    again = command("run", "c.yaml", ranks=2)
    assert again.returncode == 0, again.stderr
    assert f"{done} kept" in again.stdout
    assert command("run", "c.yaml", "-o", "whole.h5", ranks=2).returncode == 0
    assert same(content(command.directory / "c.h5"), content(command.directory / "whole.h5"))


def test_a_second_signal_does_not_change_the_status(command):
    """Python forgets its handlers long before MPI is through with its end."""
    command.write("c.yaml", SPECTRA)
    process = started(command, "run", "c.yaml", ranks=0)
    process.send_signal(signal.SIGUSR1)
    said = ""
    while "the same command continues" not in said:
        line = process.stdout.readline()
        assert line, process.communicate()
        said += line
    time.sleep(0.02)  # in the end of Python, on this machine or a slower one
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    assert process.returncode == 75


def test_launcher_passes_the_warning_on(command):
    command.write("c.yaml", SPECTRA)
    process = started(command, "run", "c.yaml", ranks=2)
    process.send_signal(signal.SIGUSR1)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 75, err
    assert "stopped by SIGUSR1" in out


def test_chain_stops_between_two_of_its_points_and_goes_on_from_there(command):
    command.write("c.yaml", CYCLES)
    process = started(command, "run", "c.yaml", ranks=2)
    process.send_signal(signal.SIGUSR1)
    process.communicate(timeout=120)
    assert process.returncode == 75
    with h5py.File(command.directory / "c.h5") as file:
        done = int((file["status"][...] != -1).sum())
    assert 1 <= done < 6
    again = command("run", "c.yaml")
    assert again.returncode == 0, again.stderr
    assert f"{6 - done} of 6 points to do, {done} kept" in again.stdout
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(command.directory / "c.h5"), content(command.directory / "whole.h5"))


def test_shares_of_the_ranks_are_kept_and_shown(command):
    command.write("c.yaml", SPECTRA.replace("num: 2000", "num: 300"))
    assert command("run", "c.yaml", ranks=3).returncode == 0
    with h5py.File(command.directory / "c.h5") as file:
        points, busy, idle = (
            file.attrs[f"rank_{name}"] for name in ("points", "busy_seconds", "idle_seconds")
        )
        seconds = file["seconds"][...].sum()
    assert points.sum() == 3600
    assert len(points) == len(busy) == len(idle) == 3
    assert busy.sum() > seconds
    assert (idle >= 0).all()
    shown = " ".join(command("show", "c.h5").stdout.split())
    assert "last run: 3 ranks on 1 host, 3600 points" in shown
    assert f"{points.min()} to {points.max()} points" in shown
