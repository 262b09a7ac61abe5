"""`rodsweep run`, read aloud: read the config, open the file, solve what is missing, fold it in."""

import os
import socket
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import click

from ..errors import EnvironmentLacks
from ..results.checkpoints import Checkpoints
from ..results.creation import Plan
from ..results.journal import Journal, journal_directory
from ..results.provenance import now, provenance
from ..results.schema import Filled
from ..results.store import Store
from ..results.view import read_view
from ..solve.presence import require_petsc
from ..sweep.chains import ChainSolver, mask
from ..sweep.handout import Range
from ..sweep.loop import sweep
from ..sweep.progress import Teller
from ..sweep.team import Team
from .job import Job, make_job
from .tasks.protocol import Solver, succeeded

FAILURES_TOLD = 3
"""Failed points that are named at the end of a run; the file has the status of all."""


def run_config(path: Path, output: Path, overrides: tuple[str, ...], fresh: bool) -> int:
    """Runs a config on all ranks; returns the exit status."""
    team = Team()
    with team.together():
        job = team.on_first(lambda: make_job(path, overrides))
        team.all_can(require_petsc)
        return _run(team, job, output, fresh)


def _run(team: Team, job: Job, output: Path, fresh: bool) -> int:
    began, started = time.monotonic(), now()
    solver = job.task.solver()
    plan = _plan(job, solver)
    store: list[Store] = []

    def open_store() -> list[tuple[int, int]]:
        store.append(Store(output, plan, fresh))
        return store[0].missing()

    todo = team.on_first(open_store)
    count = sum(stop - start for start, stop in todo)
    if team.first:
        kept = job.points.count - count
        click.echo(
            f"{output}: {count} of {job.points.count} points to do" + (f", {kept} kept" if kept else "")
        )
    failures = _solve_missing(team, job, solver, plan, output, todo) if count else []
    told = team.gather(failures)
    hosts = team.gather(socket.gethostname())
    seconds = time.monotonic() - began

    def finish() -> int:
        if count or not store[0].finished():
            additions: Sequence[Filled] = ()
            if solver.finish is not None:
                store[0].fold({})  # it needs all points in the file
                additions = solver.finish(read_view(output))
            store[0].fold(_ending(team, hosts or [], started, plan), additions)
        counts = store[0].status_counts()
        store[0].close()
        each = 1e3 * seconds * team.size / max(count, 1)
        spent = f"{count} points in {seconds:.2f} s on {team.size} ranks ({each:.3g} ms a point and rank)"
        spent = spent if count else f"{output} is complete, nothing to do"
        whole = set(counts) <= {status.name for status in solver.statuses if succeeded(status)}
        _report(output, spent, counts, [failure for some in told or [] for failure in some])
        if not whole:
            click.echo(f"  `rodsweep show {output}` says what each status means")
        return 0 if whole else 1

    return team.on_first(finish)


def _solve_missing(
    team: Team, job: Job, solver: Solver, plan: Plan, output: Path, todo: list[tuple[int, int]]
) -> list[str]:
    """This rank's share of the missing points, into its journal; returns what to tell of failures."""
    failures: list[str] = []

    def keep(index: int, result: Any) -> None:
        journal.append(index, solver.record(index, result))
        if not succeeded(result.status) and len(failures) < FAILURES_TOLD:
            where = ", ".join(f"{name}={value!r}" for name, value in job.points.values(index).items())
            failures.append(f"{where}: {result.status.name} {result.message}".rstrip())

    solver.warm_up()
    total = sum(stop - start for start, stop in todo)
    tell = Teller(total, job.name) if team.first else None
    try:
        directory = journal_directory(output)
        journal = Journal(directory, team.rank, plan.layout, plan.fingerprint)
        units, solve = _units(job, solver, todo, Checkpoints(directory, plan.fingerprint))
        sweep(team, units, solve, keep, tell or (lambda done: None))
        journal.close()
    except OSError as error:
        raise EnvironmentLacks(
            f"cannot write beside {output}: {error.strerror or error}; what is done is kept: make room and "
            "run again"
        ) from error
    finally:
        if tell:
            tell.close()
    return failures


def _units(
    job: Job, solver: Solver, todo: list[Range], checkpoints: Checkpoints
) -> tuple[list[Range], Callable[[int], Iterable[tuple[int, Any]]]]:
    """(the units to do, how one is solved): points, or chains where points start one from the other."""
    if solver.chained is None:
        return todo, lambda index: ((index, solver.solve(index)),)
    missing = mask(todo, job.points.count)
    chains = solver.chained.chains
    return chains.todo(missing), ChainSolver(chains, missing, solver.chained.solve_from, checkpoints)


def _plan(job: Job, solver: Solver) -> Plan:
    from ..solve import petsc

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
            "status_sentences": "\n".join(f"{s.name}: {s.sentence}" for s in solver.statuses),
        }
        | job.config.constants
        | versions
        | provenance(),
        flags=tuple((int(s), s.name) for s in solver.statuses),
    )


def _ending(team: Team, hosts: list[str], started: str, plan: Plan) -> dict:
    versions = {k: v for k, v in plan.attributes.items() if k.endswith(("_version", "_commit", "_options"))}
    return versions | {
        "ranks": team.size,
        "hosts": " ".join(sorted(set(hosts))),
        "started": started,
        "finished": now(),
        "mpi_library": team.MPI.Get_library_version().split("\n")[0].strip("\0 "),
        "slurm_job": os.environ.get("SLURM_JOB_ID", ""),
    }


def _report(output: Path, spent: str, counts: dict[str, int], failures: list[str]) -> None:
    """Prints how the run ended."""
    click.echo(spent)
    click.echo(f"{output}: " + ", ".join(f"{n} {name}" for name, n in counts.items()))
    for failure in failures[:FAILURES_TOLD]:
        click.echo(f"  {failure}")
