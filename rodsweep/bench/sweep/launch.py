"""Runs of sweeps started as by a user: time, memory of each rank, and size of the files.

The measured command begins with arguments given by the caller. The module appends: a directory, in which
every rank writes its peak memory in bytes into a file FIRST_RANK_MEMORY_FILE_PREFIX-PID or
OTHER_RANKS_MEMORY_FILE_PREFIX-PID; the kind of solver, SOLVED, INSTANT or KILLED; and the arguments of
`rodsweep`.
"""

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path

import numpy as np

from ...errors import EnvironmentIncomplete
from ...results.file.view import read_view
from ...results.run.journal import journal_directory

RESULT, NOTES = "c.h5", "notes"
"""Names of the result file and of the folder with the ranks' peak memory, in the directory of a sweep."""
FIRST_RANK_MEMORY_FILE_PREFIX = "first"
"""Prefix of the name of the file with the peak memory of the first rank."""
OTHER_RANKS_MEMORY_FILE_PREFIX = "other"
"""Prefix of the names of the files with the peak memory of the remaining ranks."""
SOLVED, INSTANT, KILLED = "solved", "instant", "killed"
"""Kinds of solver: the real solver; random results at once; random results at once, and the process is killed
at the last point."""
CONFIG_NAME = "c.yaml"
"""Name of the config in the directory of a sweep."""
SPECTRUM_CONFIG = """
task: spectrum
parameters:
  F: {{start: 0, stop: 90, num: {F_count}}}
  k1: [200, .inf]
  k2: {{start: 100, stop: 1.0e4, num: {k2_count}, spacing: log}}
  gamma3: 1.0e-4
spectrum: {{modes: 2}}
"""
"""Config of a sweep of spectra, as a format string. F_count, k2_count: numbers of values of F and of k2."""
CYCLE_CONFIG = "task: limit_cycle\nparameters: {points: points.csv}\n"
"""Config of a sweep of limit cycles over a list of points."""
HOPF_FORCE = 27.4271941267592812
"""F of the Hopf point of the rod with k1 = 1e4, k2 = 1e2, gamma3 = 1e-2."""


@dataclass(frozen=True, slots=True)
class SweepCase:
    """A sweep to be measured.

    points: number of points. directories: directories with a config each. If there are several, each config
    has a part of the points, and one command runs in each directory, all at the same time. solver_kind:
    SOLVED, INSTANT or KILLED.
    """

    name: str
    """Name of the case in the tables."""
    points: int
    directories: tuple[Path, ...]
    solver_kind: str


def write_spectrum_case(directory: Path, name: str, point_count: int, solver_kind: str) -> SweepCase:
    """A sweep of spectra, named `name`, over F, two values of k1, and k2, whose config is written into the
    new directory `directory`.

    point_count: number of points, which is rounded down to a multiple of 100, below 200 to a multiple of 4.
    """
    force_count = 50 if point_count >= 200 else 2
    k2_count = point_count // (2 * force_count)
    directory.mkdir()
    (directory / CONFIG_NAME).write_text(SPECTRUM_CONFIG.format(F_count=force_count, k2_count=k2_count))
    return SweepCase(name, 2 * force_count * k2_count, (directory,), solver_kind)


def write_cycle_case(directory: Path, point_count: int, solver_kind: str) -> SweepCase:
    """A sweep of `point_count` limit cycles whose costs differ much, in random order; its config is written
    into the new directory `directory`."""
    directory.mkdir()
    rows = [f"{F!r},1e4,1e2,1e-2,1" for F in shuffled_forces(point_count).tolist()]
    (directory / "points.csv").write_text("\n".join(["F,k1,k2,gamma3,gamma1", *rows]) + "\n")
    (directory / CONFIG_NAME).write_text(CYCLE_CONFIG)
    return SweepCase("limit cycles", point_count, (directory,), solver_kind)


def shuffled_forces(count: int) -> np.ndarray:
    """Forces F far below, just below, just above and far above HOPF_FORCE, in random order, (count,)."""
    below_count = count // 5
    near_count = count // 6
    above_count = count // 4
    forces = np.concatenate(
        [
            np.linspace(5, 27, below_count),
            HOPF_FORCE * (1 - np.geomspace(1e-6, 1e-2, near_count)),
            HOPF_FORCE * (1 + np.geomspace(1e-7, 1e-2, above_count)),
            np.linspace(28, 90, count - below_count - near_count - above_count),
        ]
    )
    return np.random.default_rng(1).permutation(forces)


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandRunCost:
    """Time, memory and disk space of a run of the command."""

    seconds: float
    """Clock time of the whole command, in s."""
    printed_seconds: float
    """Clock time printed by the command, in s, without the start of Python and MPI; nan if the command was
    killed."""
    solver_seconds: float
    """Time in the solver, in s, summed over the ranks."""
    first_and_other_rank_peak_bytes: tuple[int, ...]
    """Peak memory of the first rank and, if there are several ranks, largest peak memory of the other ranks,
    in bytes."""
    file_bytes: int
    """Size of the result files in bytes."""
    journal_bytes: int
    """Size, in bytes, of the journals of an unfinished run."""
    processors_busy_elsewhere: float
    """Mean number of processors that other programs kept busy; nan if unknown."""
    busy_fraction: float
    """Fraction of the time of all ranks that was spent on solving points, not on waiting; nan if
    `solver_kind` is not SOLVED."""


def launcher_arguments(rank_count: int) -> list[str]:
    """Arguments that start a command on `rank_count` ranks; empty if there is no mpiexec."""
    next_to_python = Path(sys.executable).with_name("mpiexec")
    mpiexec = str(next_to_python) if next_to_python.exists() else shutil.which("mpiexec")
    return [mpiexec, "-n", str(rank_count)] if mpiexec else []


def run_case(command: Sequence[str], case: SweepCase, rank_count: int, fresh: bool = True) -> CommandRunCost:
    """Runs a sweep on `rank_count` ranks and returns its measurements. Raises EnvironmentIncomplete if a run
    fails that is not killed on purpose.

    command: first arguments of the measured command. fresh: whether an existing result file is replaced.
    """
    seconds_of_others = _processor_seconds_of_others()
    start = time.monotonic()
    full_command = [*launcher_arguments(rank_count), *command]
    solver_kind = case.solver_kind
    processes = [
        _start_sweep_process(full_command, solver_kind, directory, fresh) for directory in case.directories
    ]
    stated_seconds = [_wait_for_printed_seconds(process, solver_kind) for process in processes]
    seconds = time.monotonic() - start
    other_load = np.maximum(0.0, (_processor_seconds_of_others() - seconds_of_others) / seconds)
    files = [directory / RESULT for directory in case.directories]
    solve_times = [
        _solver_time_and_busy_fraction(file) if solver_kind == SOLVED else (0.0, nan) for file in files
    ]
    journals = [journal for file in files for journal in journal_directory(file).glob("rank-*")]
    prefixes = (FIRST_RANK_MEMORY_FILE_PREFIX, OTHER_RANKS_MEMORY_FILE_PREFIX)[:rank_count]
    return CommandRunCost(
        seconds=seconds,
        printed_seconds=max(stated_seconds),
        solver_seconds=sum(solve_seconds for solve_seconds, _ in solve_times),
        first_and_other_rank_peak_bytes=tuple(_peak_memory(case, prefix) for prefix in prefixes),
        file_bytes=sum(file.stat().st_size for file in files),
        journal_bytes=sum(journal.stat().st_size for journal in journals),
        processors_busy_elsewhere=float(other_load),
        busy_fraction=min(busy_fraction for _, busy_fraction in solve_times),
    )


def _start_sweep_process(
    command: Sequence[str], solver_kind: str, directory: Path, fresh: bool
) -> subprocess.Popen[str]:
    notes = directory / NOTES
    shutil.rmtree(notes, ignore_errors=True)
    notes.mkdir()
    run = ["run", CONFIG_NAME, "-o", RESULT, *(["--fresh"] if fresh else [])]
    return subprocess.Popen(
        [*command, str(notes), solver_kind, *run],
        cwd=directory,
        env=dict(os.environ),  # as at the start of this process: MPI adds variables only to the C environment
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def _wait_for_printed_seconds(process: subprocess.Popen[str], solver_kind: str) -> float:
    """Waits for the command to finish, and returns the time in s that the command printed; nan if the command
    was killed on purpose. Raises EnvironmentIncomplete if the command failed."""
    output, errors = process.communicate()
    match = re.search(r"points? in ([\d.]+) s on", output)
    stopped = match is None or "stopped by" in output
    if solver_kind != KILLED and (stopped or process.returncode not in (0, 1)):
        raise EnvironmentIncomplete(f"a run of the benchmark failed: {' '.join(errors.split())[-500:]}")
    return float(match[1]) if match else nan


def _peak_memory(case: SweepCase, rank: str) -> int:
    """Peak memory of the first rank, or largest peak memory of the other ranks, in bytes. rank:
    FIRST_RANK_MEMORY_FILE_PREFIX or OTHER_RANKS_MEMORY_FILE_PREFIX."""
    notes = (file for directory in case.directories for file in (directory / NOTES).glob(f"{rank}-*"))
    return max((int(file.read_text()) for file in notes), default=0)


def _solver_time_and_busy_fraction(file: Path) -> tuple[float, float]:
    """Returns (time in the solver, in s; fraction of the time of all ranks that was spent on points), from a
    result file."""
    view = read_view(file)
    names = ("rank_busy_seconds", "rank_idle_seconds")
    busy_seconds, idle_seconds = (float(view.attributes[name].sum()) for name in names)
    return float(view.variables["seconds"].sum(dtype=float)), busy_seconds / (busy_seconds + idle_seconds)


def _processor_seconds_of_others() -> float:
    """Processor time, in s, of all processes of the machine except the finished children of this process; nan
    if unknown."""
    try:
        line = Path("/proc/stat").read_text().split("\n", 1)[0]
        user, nice, system, _, _, irq, softirq, steal = map(int, line.split()[1:9])
    except (OSError, ValueError):
        return nan
    busy_seconds = (user + nice + system + irq + softirq + steal) / os.sysconf("SC_CLK_TCK")
    children = os.times()
    return busy_seconds - children.children_user - children.children_system
