"""`rodsweep run`, read aloud: read the config, open the file, solve what is missing, fold it in."""

import os
import socket
import time
from collections.abc import Callable, Iterable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
import numpy as np

from ..errors import EnvironmentLacks
from ..results.file import provenance
from ..results.file.creation import Plan
from ..results.file.store import Store
from ..results.file.view import read_view
from ..results.run.checkpoints import Checkpoints
from ..results.run.journal import Journal, journal_directory, kept_sentence
from ..solve.backend.availability import require_directory, require_petsc
from ..sweep.chains import ChainSolver
from ..sweep.loop import Indices, Share, sweep
from ..sweep.progress import Teller
from ..sweep.ranges import IndexRange, IndexSet, total
from ..sweep.shards import Shard
from ..sweep.stop import StopRequest
from ..sweep.stretches import StretchSolver, Together
from ..sweep.team import Team
from .job import Job, make_job
from .tasks.protocol import Solver
from .wording import counted

FAILURES_TOLD = 3
"""Failed points that are named at the end of a run; the file has the status of all."""
CONTINUE = 75
"""Exit status of a run that was asked to stop: the same command continues it (EX_TEMPFAIL of sysexits.h)."""

Contribution = tuple[str, list[str], Share]
"""A rank's host, the failures that it tells, and what it did."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """What the user asks of a run beside the config."""

    overrides: tuple[str, ...] = ()
    fresh: bool = False
    """Whether an existing file is replaced."""
    extend: bool = False
    """Whether an existing file of a smaller config is extended."""
    shard: Shard
    quiet: bool = False
    """Whether only what is amiss is told."""


def run_config(path: Path, output: Path, options: RunOptions, stop: StopRequest) -> int:
    """Runs a config, or a shard of it, on all ranks; returns the exit status."""
    require_directory()
    team = Team()
    with team.together():
        job = team.on_first(lambda: make_job(path, options.overrides))
        team.all_can(require_petsc)
        return _Run(team, job, output, options, stop).run()


class _Run:
    """One run of a job on this rank."""

    store: Store
    """On the first rank, once it is open."""

    def __init__(self, team: Team, job: Job, output: Path, options: RunOptions, stop: StopRequest):
        from ..solve.backend.blas_kernel import blas

        self.team, self.job, self.output, self.stop = team, job, output, stop
        self.options, self.shard = options, options.shard
        self.began, self.started = time.monotonic(), provenance.now()
        self.solver = job.solver()
        self.kernels = provenance.united_kernels(team.gather(blas()) or [])
        self.plan = plan_of(job, self.solver, self.shard, self.kernels)

    def run(self) -> int:
        """Solves what is missing and folds it into the file; returns the exit status."""
        missing = self.team.on_first(self._open)
        units, count = self._units(missing)
        if self.team.first:
            points, shard = self.job.points.count, f"; shard {self.shard}" if self.shard.of > 1 else ""
            kept = f", {points - total(missing)} kept" if points > total(missing) else ""
            self._say(f"{self.output}: {count} of {counted(points, 'point')} to do{kept}{shard}")
        contributions: list[Contribution] = []
        if count:
            self.team.on_first(self._note_kernels)
            failures, share = self._solve(units, missing, count)
            contributions = self.team.gather((socket.gethostname(), failures, share)) or []
        return self.team.on_first(lambda: self._finish(count, contributions))

    def _say(self, text: str, amiss: bool = False) -> None:
        """Tells the user, who may want to hear only what is amiss."""
        if amiss or not self.options.quiet:
            click.echo(text)

    def _open(self) -> list[IndexRange]:
        """Opens the file; returns the points that it misses."""
        self.store = Store(self.output, self.plan, self.options.fresh, self.options.extend)
        self._tell_notes()
        return self.store.missing()

    def _tell_notes(self) -> None:
        """Tells what the store has to say of points and journals that are not where they were."""
        for note in self.store.notes:
            self._say(f"{self.output}: {note}", amiss=True)
        self.store.notes.clear()

    def _units(self, missing: list[IndexRange]) -> tuple[list[IndexRange], int]:
        """(the units of this shard that miss a point, the points that they miss)."""
        if self.solver.stretched is not None:
            stretches = self.solver.stretched[0]
            units = self.shard.part(stretches.todo(missing), stretches.count)
            return units, stretches.missing_in(units, missing)
        if self.solver.chained is None:
            units = self.shard.part(missing, self.job.points.count)
            return units, total(units)
        lacks, (chains, _) = IndexSet(missing), self.solver.chained
        units = self.shard.part(chains.todo(lacks), chains.count)
        each = (lacks[chains.indices(chain)].sum() for unit in units for chain in range(*unit))
        return units, int(sum(each))

    def _note_kernels(self) -> None:
        """Keeps in the file which BLAS kernels compute its points, and says so where there are several."""
        before = self.store.attributes()
        kernels = provenance.united_kernels(provenance.kernels_of(before), self.kernels.splitlines())
        if kernels != before.get(provenance.KERNELS):
            self.store.fold({provenance.KERNELS: kernels})
        if sentence := provenance.kernels_sentence(kernels):
            click.echo(f"{self.output}: {sentence}")

    def _solve(
        self, units: list[IndexRange], missing: list[IndexRange], count: int
    ) -> tuple[list[str], Share]:
        """This rank's share of the units, into its journal; and what to tell of failures."""
        failures: list[str] = []
        solver, plan = self.solver, self.plan

        def keep(index: Indices, result: Any) -> None:
            if isinstance(result, Together):
                journal.append_all(np.asarray(index), result.values)
            else:
                journal.append(int(index), solver.record(int(index), result))
            if len(failures) < FAILURES_TOLD:
                failures.extend(self._failures(index, result))

        solver.warm_up()
        tell = Teller(count, self.job.name) if self.team.first and not self.options.quiet else None
        directory = journal_directory(self.output)
        try:
            with closing(Journal(directory, self.team.rank, plan.layout, plan.fingerprint)) as journal:
                checkpoints = Checkpoints(directory, plan.fingerprint)
                solve = self._solve_unit(IndexSet(missing), checkpoints)
                share = sweep(self.team, units, solve, keep, tell or (lambda done: None), self.stop)
        except OSError as error:
            raise EnvironmentLacks(
                f"cannot write beside {self.output}: {error.strerror or error}"
                f"{kept_sentence(directory, plan.fingerprint)}: make room and run again"
            ) from error
        finally:
            if tell:
                tell.close()
        return failures, share

    def _solve_unit(
        self, missing: IndexSet, checkpoints: Checkpoints
    ) -> Callable[[int], Iterable[tuple[Indices, Any]]]:
        """How a unit is solved: a point, a chain or a stretch."""
        solver = self.solver
        if solver.stretched:
            return StretchSolver(*solver.stretched, missing)
        if solver.chained:
            return ChainSolver(*solver.chained, missing, checkpoints, self.stop)
        return lambda index: ((index, solver.solve(index)),)

    def _failures(self, index: Indices, result: Any) -> list[str]:
        """What to tell of the points that did not succeed."""
        if isinstance(result, Together):
            failed = np.flatnonzero(~result.succeeded)[:FAILURES_TOLD]
            told = [(int(np.asarray(index)[i]), result.told(int(i))) for i in failed]
        else:
            told = [] if result.status.succeeded else [(int(index), f"{result.status.name} {result.message}")]
        return [f"{self._where(at)}: {outcome}".rstrip() for at, outcome in told]

    def _where(self, index: int) -> str:
        values = self.job.points.values(index)
        return ", ".join(f"{name}={value!r}" for name, value in values.items())

    def _finish(self, count: int, contributions: list[Contribution]) -> int:
        """Folds everything into the file, says how the run ended, and with which status it exits."""
        if count:
            self.store.fold(self._history(contributions))
        missing = self.store.missing()
        if not missing and "finished" not in self.store.attributes():
            finish = self.solver.finish
            self.store.fold({"finished": provenance.now()}, finish(read_view(self.output)) if finish else ())
        self._tell_notes()
        counts = self.store.status_counts()
        self.store.close()
        left = self._units(missing)[1]
        part = f"shard {self.shard} of {self.output}" if missing else f"{self.output}"
        if count:
            seconds, points = time.monotonic() - self.began, count - left
            each = 1e3 * seconds * self.team.size / max(points, 1)
            pace = f" ({each:.3g} ms a point and rank)" if points else ""
            ranks = counted(self.team.size, "rank")
            self._say(f"{counted(points, 'point')} in {seconds:.2f} s on {ranks}{pace}")
        else:
            self._say(f"{part} is complete, nothing to do")
        expected = {status.name for status in self.solver.statuses if status.succeeded} | {"missing"}
        amiss = not set(counts) <= expected
        self._say(f"{self.output}: " + ", ".join(f"{n} {name}" for name, n in counts.items()), amiss)
        told = [failure for _, failures, _ in contributions for failure in failures]
        for failure in told[:FAILURES_TOLD]:
            click.echo(f"  {failure}")
        if left:
            kept = self.job.points.count - total(missing)
            ended = f"stopped by {self.stop.name}" if self.stop else "not complete"
            click.echo(f"{ended}; {counted(kept, 'point')} kept, the same command continues")
            return CONTINUE
        if not amiss:
            return 0
        click.echo(f"  `rodsweep show {self.output}` says what each status means")
        return 1

    def _history(self, contributions: list[Contribution]) -> dict[str, Any]:
        """Attributes that say where, by what and by whom the points of this run were computed."""
        names = ("_version", "_commit", "_options")
        hosts = {host for host, *_ in contributions}
        shares = [share for *_, share in contributions[: provenance.MOST_RANKS_TOLD]]
        points, busy, idle = zip(*((share.points, share.busy, share.idle) for share in shares), strict=True)
        numbers = (np.array(points, "i4"), np.array(busy, "f4"), np.array(idle, "f4"))
        return {k: v for k, v in self.plan.attributes.items() if k.endswith(names)} | {
            "ranks": self.team.size,
            "hosts": " ".join(sorted(hosts))[: provenance.LONGEST_ATTRIBUTE],
            "started": self.started,
            "stopped": self.stop.name,
            "shard": self.plan.attributes["shard"],
            "mpi_library": self.team.MPI.Get_library_version().split("\n")[0].strip("\0 "),
            "slurm_job": os.environ.get("SLURM_JOB_ID", ""),
            **dict(zip(provenance.RANK_SHARES, numbers, strict=True)),
        }


def plan_of(job: Job, solver: Solver, shard: Shard, kernels: str) -> Plan:
    """The file that a run of the job, with these BLAS kernels, makes or continues."""
    from ..solve.backend import petsc

    attributes = {
        "Conventions": "CF-1.8",
        "title": job.name,
        "task": job.config.task,
        "time_unit": "tau2 = gamma2 L^4/k3",
        "config": job.text,
        "petsc_options": petsc.options(),
        "shard": str(shard) if shard.of > 1 else "",
        "status_sentences": "\n".join(f"{s.name}: {s.sentence}" for s in solver.statuses),
        provenance.KERNELS: kernels,
    }
    versions = {f"{name}_version": value for name, value in petsc.versions().items()}
    return Plan(
        points=job.points,
        layout=job.layout,
        coordinates=job.task.coordinates(),
        constants=job.task.constants(),
        quantities=job.quantities,
        config=job.resolved,
        attributes=attributes | job.config.parameters.numbers | versions | provenance.provenance(),
        flags=tuple((int(s), s.name) for s in solver.statuses),
        chains=job.task.chains,
        stretches=job.task.stretches,
    )
