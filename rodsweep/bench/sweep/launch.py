"""Runs of the command as a user starts them, and what they took: time, memory of each rank, bytes on disk."""

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from math import isnan, nan
from pathlib import Path

from ...errors import EnvironmentLacks
from ...results.file.view import read_view
from ...results.run.journal import journal_directory

CONFIG, RESULT, NOTES = "c.yaml", "c.h5", "notes"
"""Names in the directory of a case."""


@dataclass(frozen=True, slots=True)
class Case:
    """A sweep to be run: how many points its config has, and where it is."""

    name: str
    points: int
    directory: Path
    kind: str = "solved"
    """What takes the place of the solver: "solved", "instant" or "killed", see `rodsweep.cli.measured`."""
    beside: "Case | None" = None
    """Another sweep, which a command of its own runs at the same time; counted together with this one."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run of the command: what it took, and what it left."""

    seconds: float
    """Of the whole command, from its start to its end."""
    inside: float
    """As the command says, which leaves out the start of Python and MPI; nan where it was killed."""
    solving: float
    """In the solver, all ranks together."""
    memory: tuple[int, ...]
    """Peak bytes of the first rank, and of the one of the others that held most."""
    file: int
    """Bytes of the result file."""
    journal: int
    """Bytes of the journals that it left, which is none unless it was killed."""
    elsewhere: float
    """Processors that other programs kept busy meanwhile; nan where the system does not say."""
    busy: float = nan
    """Share of the ranks' time that went into points and not into waiting; nan without the real solver."""


def launcher(ranks: int) -> list[str]:
    """The words that start a command on some ranks; none where there is no mpiexec."""
    beside = Path(sys.executable).with_name("mpiexec")
    found = str(beside) if beside.exists() else shutil.which("mpiexec")
    return [found, "-n", str(ranks)] if found else []


def run(case: Case, ranks: int, fresh: bool = True) -> Run:
    """Runs a case on some ranks; EnvironmentLacks where that fails without having been killed."""
    if case.beside is None:
        return _run(case, ranks, fresh)
    with _measured() as load, ThreadPoolExecutor(1) as pool:
        beside = pool.submit(_run, case.beside, ranks, fresh)
        own, other = _run(case, ranks, fresh), beside.result()
    return replace(
        own,
        seconds=load.seconds,
        inside=max(own.inside, other.inside),
        solving=own.solving + other.solving,
        elsewhere=load.elsewhere,
    )


def _run(case: Case, ranks: int, fresh: bool) -> Run:
    """Runs a case, and nothing beside it."""
    directory, file, notes = case.directory, case.directory / RESULT, case.directory / NOTES
    notes.mkdir()
    start = [*launcher(ranks), sys.executable, "-m", "rodsweep.cli.measured", str(notes), case.kind]
    words = ["run", CONFIG, "-o", RESULT, *(["--fresh"] if fresh else [])]
    with _measured() as load:
        done = subprocess.run(
            [*start, *words],
            cwd=directory,
            env=dict(os.environ),  # as this process got it: MPI, once started in here, adds to the one in C
            capture_output=True,
            text=True,
            check=False,
        )
    said = re.search(r"points in ([\d.]+) s on", done.stdout)
    stopped = said is None or "stopped by" in done.stdout
    if case.kind != "killed" and (stopped or done.returncode not in (0, 1)):
        raise EnvironmentLacks(f"a run of the benchmark failed: {' '.join(done.stderr.split())[-500:]}")
    memory = [
        max((int(note.read_text()) for note in notes.glob(f"{rank}-*")), default=0)
        for rank in ("first", "other")[:ranks]
    ]
    shutil.rmtree(notes)
    solving, busy = _solving(file) if case.kind == "solved" else (0.0, nan)
    return Run(
        load.seconds,
        float(said[1]) if said else nan,
        solving,
        tuple(memory),
        file.stat().st_size,
        sum(page.stat().st_size for page in journal_directory(file).glob("rank-*")),
        load.elsewhere,
        busy,
    )


def _solving(file: Path) -> tuple[float, float]:
    """(seconds in the solver, share of the ranks' time that went into points), as a result says."""
    view = read_view(file)
    busy, idle = (float(view.attributes[f"rank_{name}_seconds"].sum()) for name in ("busy", "idle"))
    return float(view.variables["seconds"].sum(dtype=float)), busy / (busy + idle)


@dataclass(slots=True)
class _Load:
    """How long something took, and how many processors other programs kept busy meanwhile."""

    seconds: float = nan
    elsewhere: float = nan


@contextmanager
def _measured() -> Iterator[_Load]:
    """Measures what children of this process do in here."""
    load = _Load()
    began, busy, own = time.monotonic(), _busy_seconds(), _children_seconds()
    yield load
    load.seconds = time.monotonic() - began
    others = (_busy_seconds() - busy - (_children_seconds() - own)) / load.seconds
    load.elsewhere = others if isnan(others) else max(0.0, others)


def _busy_seconds() -> float:
    """Seconds that all processors together were busy since the machine started; nan if it says nothing."""
    try:
        line = Path("/proc/stat").read_text().split("\n", 1)[0]
        user, nice, system, _, _, irq, softirq, steal = map(int, line.split()[1:9])
    except (OSError, ValueError):
        return nan
    return (user + nice + system + irq + softirq + steal) / os.sysconf("SC_CLK_TCK")


def _children_seconds() -> float:
    """Seconds of the processor that ended children of this process have taken."""
    times = os.times()
    return times.children_user + times.children_system
