"""Solves the points of a job in sequence in this process, and keeps the results in memory."""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import ThreadpoolController

from ...results.file.creation import Plan
from ...results.file.provenance import now
from ...results.file.view import View
from ...solve.backend.availability import require_solvers
from ...solve.exclusive import solving
from ...sweep.points.ranges import Shard
from .job import Job, plan_of


@solving
def solved_view(job: Job) -> View:
    """The solved points of a job without chains and joint variables, as `show` reads them from a file.

    Raises EnvironmentIncomplete if this process cannot solve.
    """
    require_solvers()
    started = now()
    solver = job.solver()
    plan = plan_of(job, solver, Shard(), blas_kernels())
    solver.warm_up()
    count = job.points.count
    flat = {name: np.repeat(fill[None], count, axis=0) for name, fill in plan.layout.empty_point.items()}
    with blas().limit(limits=1, user_api="blas"):  # as in the command: threads change the order of sums
        for index in range(count):
            record = solver.record(index, solver.solve(index))
            for name, array in flat.items():
                array[index] = record[name]
    values = {name: array.reshape(*job.points.shape, *array.shape[1:]) for name, array in flat.items()}
    return view_in_memory(job, plan, values, {"started": started, "finished": now()})


def view_in_memory(
    job: Job, plan: Plan, values: Mapping[str, np.ndarray], origin: Mapping[str, Any] | None = None
) -> View:
    """Solved points in the form in which `show` reads a file.

    values: variables of the layout, shape (points, own dimensions). origin: further attributes.
    """
    columns: dict[str, np.ndarray] = dict(job.points.axes) or {"point": job.points.columns[0]}
    columns |= {name: np.arange(1, extent + 1) for name, extent in plan.layout.extents.items()}
    columns |= plan.coordinates
    columns |= {variable.name: array for variable, array in plan.quantities}
    resolved = {"config_resolved": json.dumps(plan.config)}
    return View(
        Path(job.name),
        resolved | plan.attributes | dict(origin or {}),
        columns | dict(values),
        plan.layout.parameters,
        dict(plan.flags),
        journalled=0,
        over=plan.layout.over,
        typed={variable.name: variable.typed for variable, _ in plan.quantities if variable.typed},
    )


@cache
def blas_kernels() -> str:
    """The BLAS kernels of this process."""
    from ...solve.backend.blas_kernel import blas as kernel

    return kernel()


@cache
def blas() -> ThreadpoolController:
    """The BLAS libraries of this process. PETSc must have loaded a BLAS before."""
    return ThreadpoolController()
