"""The command as `rodsweep bench sweep` starts it: it notes each rank's memory, and can do without solving.

    python -m rodsweep.cli.measured DIRECTORY KIND WORDS...

runs `rodsweep WORDS...` and leaves the peak memory in bytes of every rank in DIRECTORY, in a file
`first-PID` or `other-PID`. KIND is what takes the place of the solver of the task spectrum: `solved` none,
`instant` outcomes that cost nothing, `killed` the same and a kill at the last point.
"""

import os
import resource
import signal
import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ..config import SpectrumConfig
from ..results.layouts.variables import Filled
from ..sweep.estimate import Estimate
from ..sweep.grid import Points
from . import _speaks, main
from .tasks import TASKS
from .tasks.protocol import Part, Solver
from .tasks.spectrum import SpectrumTask

TABLE = 4096
"""Outcomes that the points take in turn: more than any compression looks back."""


@dataclass(frozen=True, slots=True)
class InstantSpectra:
    """The task spectrum with random outcomes from a table, so that all time is the sweep's own."""

    spectra: SpectrumTask
    killed: Path | None
    """Where the rank that gets the last point notes its memory before it is killed there; None: nobody is."""

    def coordinates(self) -> dict[str, np.ndarray]:
        return self.spectra.coordinates()

    def constants(self) -> tuple[Filled, ...]:
        return self.spectra.constants()

    def headline(self) -> str:
        return self.spectra.headline()

    def parts(self) -> list[Part]:
        return self.spectra.parts()

    def cost(self) -> Estimate:
        return self.spectra.cost()

    def solver(self) -> Solver:
        from ..discretization.resolution import Resolution
        from ..solve.spectrum.search import Spectrum
        from ..solve.spectrum.status import Status

        points, modes = self.spectra.points, self.spectra.config.spectrum.modes
        parts = np.random.default_rng(1).standard_normal((TABLE, 3, modes))
        rest: dict[str, Any] = {"unstable_count": 1, "certified": True, "resolution": Resolution(1, 20)}
        table = [
            Spectrum(
                status=Status.ok,
                eigenvalues=100 * (a + 1j * b),
                error_estimate=1e-12 * c,
                seconds=1e-7,
                **rest,
            )
            for a, b, c in parts
        ]

        def solve(index: int) -> Spectrum:
            points.rod(index)
            if self.killed and index == points.count - 1:
                note_memory(self.killed)
                os.kill(os.getpid(), signal.SIGKILL)
            return table[index % TABLE]

        return replace(self.spectra.solver(), warm_up=lambda: None, solve=solve)


def instant_spectra(killed: Path | None, config: SpectrumConfig, points: Points) -> InstantSpectra:
    """The task of a config on its points."""
    return InstantSpectra(SpectrumTask(config, points), killed)


def note_memory(directory: Path) -> None:
    """Leaves this rank's peak memory so far."""
    rank = "first" if _speaks() else "other"
    (directory / f"{rank}-{os.getpid()}").write_text(str(peak_memory()))


def peak_memory() -> int:
    """Bytes that this process has held at most.

    What getrusage says would also count what the process that started this one held: it outlives exec.
    """
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))
    except (OSError, StopIteration):
        return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def run_measured() -> None:
    """Runs the command that the arguments ask for."""
    directory, kind, *words = sys.argv[1:]
    notes = Path(directory)
    if kind != "solved":
        TASKS["spectrum"] = partial(instant_spectra, notes if kind == "killed" else None)
    sys.argv = ["rodsweep", *words]
    try:
        main()
    finally:
        note_memory(notes)


if __name__ == "__main__":
    run_measured()
