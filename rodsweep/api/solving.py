"""Every point of a job, one after another in this process, without files and without other ranks."""

import socket
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from threadpoolctl import ThreadpoolController

from ..results.file.creation import Plan
from ..results.file.provenance import now
from ..results.file.view import View
from ..results.layouts.variables import Filled
from ..solve.backend.availability import require_solvers
from ..solve.backend.kept import forget_all
from ..solve.exclusive import solving
from ..sweep.listener import RankListener
from ..sweep.points.shards import Shard
from ..tasks.protocol import AllPoints, Arrays, Solver
from ..tasks.running.job import Job
from ..tasks.running.plan import plan_of
from ..tasks.running.unforeseen import Note, guarded
from ..watch import heard_by
from .answers.showing import Display, display, listener
from .dataset import dataset_of

_warm: set[str] = set()
"""Tasks that have been solved in this process."""


@solving
def solve_here(
    job: Job, note: Note | None = None, progress: bool | None = None
) -> tuple[xr.Dataset, list[str]]:
    """(the Dataset of all points, what each outcome has to say of points that are solved alone).

    note: what is done about an exception that no solver foresees, whose point then fails; without it the
    exception is raised. progress: whether a display is shown. Raises InputError and EnvironmentLacks where
    this process cannot solve.
    """
    shown = display(progress, job.points.count, job.name)
    require_solvers()
    solver, started = job.solver(), now()
    if note is not None:
        solver = guarded(solver, job.layout, note)
    plan = plan_of(job, solver, Shard(), _kernels())
    if job.config.task not in _warm:
        solver.warm_up()
        _warm.add(job.config.task)
    with _blas().limit(limits=1, user_api="blas"):  # as the command does: threads add in another order
        shown(0)
        try:
            values, messages = _solved(job, solver, plan, shown)
            joint = _joint(solver.together, _view(job, plan, values), shown) if solver.together else ()
        except BaseException:  # in the middle of a solve, also by Ctrl-C
            forget_all()
            raise
        finally:
            shown.close()
        attributes = {"ranks": 1, "hosts": socket.gethostname(), "started": started, "stopped": ""}
        filled = (*plan.constants(), *joint, *plan.afterwards(values))
    return dataset_of(plan, values, filled, attributes | {"finished": now()}), messages


def _solved(job: Job, solver: Solver, plan: Plan, shown: Display) -> tuple[dict[str, np.ndarray], list[str]]:
    """(the variables of the layout, each of the points' shape and its own; what points alone had to say)."""
    count, layout = job.points.count, plan.layout
    flat = {name: np.repeat(fill[None], count, axis=0) for name, fill in layout.empty_point.items()}
    messages = [""] * count
    if solver.stretched is not None:
        stretches, solve_stretch = solver.stretched
        for indices in map(stretches.indices, range(stretches.count)):
            found = solve_stretch(indices).values
            for name, array in flat.items():
                array[indices] = found[name]
            shown(int(indices[-1]) + 1)
    else:
        for done, (index, outcome) in enumerate(_outcomes(count, solver, shown), 1):
            record = solver.record(index, outcome)
            for name, array in flat.items():
                array[index] = record[name]
            messages[index] = outcome.message
            shown(done)
    shape = job.points.shape
    return {name: array.reshape(*shape, *array.shape[1:]) for name, array in flat.items()}, messages


def _joint(together: AllPoints, view: View, shown: Display) -> Sequence[Filled]:
    """What all points together give."""
    units, results = together.units(view), dict[int, Arrays]()
    while units is not None and (wanted := units.wanted(results)):
        with heard_by(listener(shown, units.where(wanted[0]))):
            results[wanted[0]] = together.solve(units, wanted[0])
    return together.variables(view, units, results)


def _outcomes(count: int, solver: Solver, shown: Display) -> Iterator[tuple[int, Any]]:
    """Every index with its outcome, along the chains where points start one from the other."""
    done = 0

    def place() -> RankListener:
        return listener(shown, f"point {done + 1} of {count}" if count > 1 else "")

    if solver.chained is None:
        for done in range(count):
            with heard_by(place()):
                outcome = solver.solve(done)
            yield done, outcome
        return
    chains, solve_from = solver.chained.chains, solver.chained.solve_from
    for chain in range(chains.count):
        state = None
        for index in map(int, chains.indices(chain)):
            with heard_by(place()):
                outcome, state = solve_from(index, state)
            done += 1
            yield index, outcome


def _view(job: Job, plan: Plan, values: dict[str, np.ndarray]) -> View:
    """The solved points as a file would show them."""
    columns = dict(job.points.axes) if job.points.axes else {"point": job.points.columns[0]}
    columns |= plan.coordinates
    columns |= {variable.name: array for variable, array in plan.quantities}
    return View(
        Path(job.name),
        plan.attributes,
        columns | values,
        plan.layout.parameters,
        dict(plan.flags),
        journalled=0,
        over=plan.layout.over,
        typed={variable.name: variable.typed for variable, _ in plan.quantities if variable.typed},
    )


@cache
def _kernels() -> str:
    from ..solve.backend.blas_kernel import blas

    return blas()


@cache
def _blas() -> ThreadpoolController:
    """The BLAS libraries of this process, once PETSc has loaded its own."""
    return ThreadpoolController()
