"""The command `rodsweep` as started by `rodsweep bench sweep`: records each rank's peak memory, and can
replace all solves by stored random outcomes.

    python -m rodsweep.cli.measured_command DIRECTORY KIND WORDS...

runs `rodsweep WORDS...`. `rodsweep.bench.sweep.launch` explains DIRECTORY and KIND.
"""

import os
import resource
import signal
import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from ..bench.sweep.launch import FIRST_RANK_MEMORY_FILE_PREFIX, KILLED, OTHER_RANKS_MEMORY_FILE_PREFIX, SOLVED
from ..tasks import TASKS
from ..tasks.protocol import Solver
from ..tasks.spectrum import SpectrumTask
from . import main
from .launchers import prints_messages

RANDOM_OUTCOME_COUNT = 4096
"""Number of different random outcomes. The points use the outcomes in turn. A file's compression detects no
repetition at this distance."""


@dataclass(frozen=True, slots=True)
class TabulatedSpectrumTask(SpectrumTask):
    """The task spectrum with random eigenvalues from a table, so that all measured time belongs to the sweep.

    All eigenvalues are stable, because a sweep would spend time on locating changes of stability.

    memory_directory_before_kill: directory in which the rank of the last point records its peak memory before
    the process is killed; None for a run without a kill.
    """

    memory_directory_before_kill: Path | None = None

    def solver(self) -> Solver:
        from ..solve.spectrum.search import Spectrum
        from ..solve.spectrum.status import SpectrumStatus

        points = self.points
        table_shape = (RANDOM_OUTCOME_COUNT, 3, self.config.spectrum.modes)
        solved = partial(
            Spectrum, status=SpectrumStatus.ok, unstable_count=0, certified=True, elements=1, order=20,
            seconds=1e-7,
        )  # fmt: skip
        outcomes = [
            solved(eigenvalues=100 * (-np.abs(growth) + 1j * frequency), error_estimate=1e-12 * error)
            for growth, frequency, error in np.random.default_rng(1).standard_normal(table_shape)
        ]

        def solve(index: int) -> Spectrum:
            points.rod(index)
            if self.memory_directory_before_kill and index == points.count - 1:
                record_memory(self.memory_directory_before_kill)
                os.kill(os.getpid(), signal.SIGKILL)
            return outcomes[index % RANDOM_OUTCOME_COUNT]

        return replace(
            SpectrumTask.solver(self), warm_up=lambda: None, solve=solve, groups_and_group_solver=None
        )


def record_memory(directory: Path) -> None:
    """Writes the peak memory of this rank in bytes into a file of the directory."""
    prefix = FIRST_RANK_MEMORY_FILE_PREFIX if prints_messages() else OTHER_RANKS_MEMORY_FILE_PREFIX
    (directory / f"{prefix}-{os.getpid()}").write_text(str(peak_memory()))


def peak_memory() -> int:
    """Peak memory of this process in bytes.

    `getrusage` would include the peak of the parent process, because the value survives exec. `getrusage` is
    used only if /proc is missing.
    """
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))
    except (OSError, StopIteration):
        return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def run_and_record_memory() -> None:
    """Runs `rodsweep` with the arguments of this process, and records the peak memory at the end."""
    directory, kind, *command = sys.argv[1:]
    notes = Path(directory)
    if kind != SOLVED:
        TASKS["spectrum"] = partial(
            TabulatedSpectrumTask, memory_directory_before_kill=notes if kind == KILLED else None
        )
    sys.argv = ["rodsweep", *command]
    try:
        main()
    finally:
        record_memory(notes)


if __name__ == "__main__":
    run_and_record_memory()
