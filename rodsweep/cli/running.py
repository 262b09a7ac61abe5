"""`rodsweep run`, read aloud: read the config, open the file, solve what is missing, fold it in."""

import os
import socket
import time
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

from ..errors import EnvironmentLacks
from ..results.file.creation import Plan
from ..results.file.kernels import KERNELS, kernels_of, told, united
from ..results.file.provenance import LONGEST_ATTRIBUTE, MOST_RANKS_TOLD, now, provenance
from ..results.file.store import Store
from ..results.file.view import read_view
from ..results.run.checkpoints import Checkpoints
from ..results.run.journal import Journal, journal_directory
from ..solve.backend.availability import require_petsc
from ..sweep.chains import ChainSolver, Missing
from ..sweep.handout import Range
from ..sweep.loop import Share, sweep
from ..sweep.progress import Teller
from ..sweep.shards import Shard
from ..sweep.stop import Stop
from ..sweep.team import Team
from .job import Job, make_job
from .tasks.protocol import Solver

FAILURES_TOLD = 3
"""Failed points that are named at the end of a run; the file has the status of all."""
CONTINUE = 75
"""Exit status of a run that was asked to stop: the same command continues it (EX_TEMPFAIL of sysexits.h)."""


def run_config(
    path: Path, output: Path, overrides: tuple[str, ...], fresh: bool, shard: Shard, stop: Stop
) -> int:
    """Runs a config, or a shard of it, on all ranks; returns the exit status."""
    team = Team()
    with team.together():
        job = team.on_first(lambda: make_job(path, overrides))
        team.all_can(require_petsc)
        return _Run(team, job, output, shard, stop).run(fresh)


class _Run:
    """One run of a job on this rank."""

    def __init__(self, team: Team, job: Job, output: Path, shard: Shard, stop: Stop):
        self.team, self.job, self.output, self.shard, self.stop = team, job, output, shard, stop
        self.began, self.started = time.monotonic(), now()
        self.solver = job.task.solver()
        self.kernels = united(team.gather(_blas()) or [])
        plan = _plan(job, self.solver, shard)
        self.plan = replace(plan, attributes=plan.attributes | {KERNELS: self.kernels})

    def run(self, fresh: bool) -> int:
        """Solves what is missing and folds it into the file; returns the exit status."""
        store: list[Store] = []

        def open_store() -> list[Range]:
            store.append(Store(self.output, self.plan, fresh))
            return store[0].missing()

        missing = self.team.on_first(open_store)
        units, count = self._units(missing)
        if self.team.first:
            self._announce(count, sum(stop - start for start, stop in missing))
        if count:
            self.team.on_first(lambda: self._note_kernels(store[0]))
        failures, share = self._solve(units, missing, count) if count else ([], Share(0, 0.0, 0.0))
        told = self.team.gather(failures)
        shares = self.team.gather(share)
        hosts = self.team.gather(socket.gethostname())
        ending = {**self._ending(hosts or []), **_utilisation(shares or [])} if count else {}
        return self.team.on_first(lambda: self._finish(store[0], count, ending, told or []))

    def _units(self, missing: list[Range]) -> tuple[list[Range], int]:
        """(the units of this shard that miss a point, the points that they miss)."""
        chained = self.solver.chained
        if chained is None:
            units = self.shard.part(missing, self.job.points.count)
            return units, sum(stop - start for start, stop in units)
        lacks, chains = Missing(missing), chained.chains
        units = self.shard.part(chains.todo(lacks), chains.count)
        each = (lacks[chains.indices(chain)].sum() for unit in units for chain in range(*unit))
        return units, int(sum(each))

    def _announce(self, count: int, missing: int) -> None:
        """Says what there is to do."""
        total = self.job.points.count
        text = f"{self.output}: {count} of {total} points to do"
        if total > missing:
            text += f", {total - missing} kept"
        if self.shard.of > 1:
            text += f"; shard {self.shard}"
        click.echo(text)

    def _note_kernels(self, store: Store) -> None:
        """Keeps in the file which BLAS kernels compute its points, and says so where there are several."""
        before = store.attributes()
        kernels = united(kernels_of(before), self.kernels.splitlines())
        if kernels != before.get(KERNELS):
            store.fold({KERNELS: kernels})
        if sentence := told(kernels):
            click.echo(f"{self.output}: {sentence}")

    def _solve(self, units: list[Range], missing: list[Range], count: int) -> tuple[list[str], Share]:
        """This rank's share of the units, into its journal; and what to tell of failures."""
        failures: list[str] = []
        solver, plan = self.solver, self.plan

        def keep(index: int, result: Any) -> None:
            journal.append(index, solver.record(index, result))
            if not result.status.succeeded and len(failures) < FAILURES_TOLD:
                where = ", ".join(
                    f"{name}={value!r}" for name, value in self.job.points.values(index).items()
                )
                failures.append(f"{where}: {result.status.name} {result.message}".rstrip())

        solver.warm_up()
        tell = Teller(count, self.job.name) if self.team.first else None
        try:
            directory = journal_directory(self.output)
            journal = Journal(directory, self.team.rank, plan.layout, plan.fingerprint)
            solve = self._solve_unit(Missing(missing), Checkpoints(directory, plan.fingerprint))
            share = sweep(self.team, units, solve, keep, tell or (lambda done: None), self.stop)
            journal.close()
        except OSError as error:
            raise EnvironmentLacks(
                f"cannot write beside {self.output}: {error.strerror or error}; what is done is kept: make "
                "room and run again"
            ) from error
        finally:
            if tell:
                tell.close()
        return failures, share

    def _solve_unit(
        self, missing: Missing, checkpoints: Checkpoints
    ) -> Callable[[int], Iterable[tuple[int, Any]]]:
        """How a unit is solved: a point, or a chain where points start one from the other."""
        chained = self.solver.chained
        if chained is None:
            return lambda index: ((index, self.solver.solve(index)),)
        return ChainSolver(chained.chains, missing, chained.solve_from, checkpoints, self.stop)

    def _ending(self, hosts: list[str]) -> dict[str, Any]:
        """Attributes that say where and by what the points of this run were computed."""
        names = ("_version", "_commit", "_options")
        return {k: v for k, v in self.plan.attributes.items() if k.endswith(names)} | {
            "ranks": self.team.size,
            "hosts": " ".join(sorted(set(hosts)))[:LONGEST_ATTRIBUTE],
            "started": self.started,
            "stopped": self.stop.name,
            "shard": self.plan.attributes["shard"],
            "mpi_library": self.team.MPI.Get_library_version().split("\n")[0].strip("\0 "),
            "slurm_job": os.environ.get("SLURM_JOB_ID", ""),
        }

    def _finish(self, store: Store, count: int, ending: dict[str, Any], told: list[list[str]]) -> int:
        """Folds everything into the file, says how the run ended, and with which status it exits."""
        if count:
            store.fold(ending)
        missing = store.missing()
        if not missing and not store.finished():
            finish = self.solver.finish
            store.fold({"finished": now()}, finish(read_view(self.output)) if finish else ())
        counts = store.status_counts()
        store.close()
        left = self._units(missing)[1]
        seconds = time.monotonic() - self.began
        each = 1e3 * seconds * self.team.size / max(count - left, 1)
        spent = f"{count - left} points in {seconds:.2f} s on {self.team.size} ranks"
        spent += f" ({each:.3g} ms a point and rank)" if count > left else ""
        part = f"shard {self.shard} of {self.output}" if missing else f"{self.output}"
        click.echo(spent if count else f"{part} is complete, nothing to do")
        click.echo(f"{self.output}: " + ", ".join(f"{n} {name}" for name, n in counts.items()))
        for failure in [failure for some in told for failure in some][:FAILURES_TOLD]:
            click.echo(f"  {failure}")
        if left:
            click.echo(f"stopped by {self.stop.name}; the same command continues")
            return CONTINUE
        expected = {status.name for status in self.solver.statuses if status.succeeded} | {"missing"}
        if set(counts) <= expected:
            return 0
        click.echo(f"  `rodsweep show {self.output}` says what each status means")
        return 1


def _utilisation(shares: list[Share]) -> dict[str, NDArray[Any]]:
    """What each rank did, as attributes, each of shape (ranks,)."""
    shares = shares[:MOST_RANKS_TOLD]
    return {
        "rank_points": np.array([share.points for share in shares], dtype="i4"),
        "rank_busy_seconds": np.array([share.busy for share in shares], dtype="f4"),
        "rank_idle_seconds": np.array([share.idle for share in shares], dtype="f4"),
    }


def _blas() -> str:
    from ..solve.backend.blas_kernel import blas

    return blas()


def _plan(job: Job, solver: Solver, shard: Shard) -> Plan:
    from ..solve.backend import petsc

    versions = {f"{name}_version": value for name, value in petsc.versions().items()}
    return Plan(
        columns=job.points.columns,
        is_grid=job.points.is_grid,
        layout=job.layout,
        coordinates=job.task.coordinates(),
        constants=job.task.constants(),
        config=job.resolved,
        attributes={
            "Conventions": "CF-1.8",
            "title": job.name,
            "task": job.config.task,
            "time_unit": "tau2 = gamma2 L^4/k3",
            "config": job.text,
            "petsc_options": petsc.options(),
            "shard": str(shard) if shard.of > 1 else "",
            "status_sentences": "\n".join(f"{s.name}: {s.sentence}" for s in solver.statuses),
        }
        | job.config.constants
        | versions
        | provenance(),
        flags=tuple((int(s), s.name) for s in solver.statuses),
    )
