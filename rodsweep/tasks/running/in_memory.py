"""Results of a job in memory, without a file: as a `ResultView`, and as variables with attributes.
`solve_job_in_memory` first solves the job, which must have no chains and no variables that depend on all
points."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import ThreadpoolController

from ...results.file.creation import FilePlan
from ...results.file.provenance import utc_time
from ...results.file.view import ResultView
from ...results.layouts.dimensions import dimension_attributes
from ...results.layouts.variables import MISSING_STATUS, FilledVariable, flag_attributes
from ...solve.backend.availability import require_solvers
from ...solve.solve_lock import exclusive_solve
from ...sweep.points.ranges import Shard
from .job import Job, result_file_plan

StoredVariable = tuple[tuple[str, ...], np.ndarray, dict[str, Any]]
"""Variable of a file: (dimensions, values, attributes)."""


@exclusive_solve
def solve_job_in_memory(job: Job) -> ResultView:
    """Solves all points of a job; returns the results as a `ResultView`, which `show` and figures read.

    The job must have no chains and no variables that depend on all points. Raises EnvironmentIncomplete if
    PETSc or SLEPc is missing.
    """
    require_solvers()
    start_time = utc_time()
    solver = job.solver()
    plan = result_file_plan(job, solver, Shard(), blas_kernels())
    solver.warm_up()
    point_count = job.points.count
    columns = {
        name: np.repeat(value[None], point_count, axis=0)
        for name, value in plan.layout.fill_values_of_point.items()
    }
    # One thread, as in the command: threads change the order of sums.
    with blas_thread_controller().limit(limits=1, user_api="blas"):
        for index in range(point_count):
            record = solver.file_values_of_outcome(index, solver.solve(index))
            for name, array in columns.items():
                array[index] = record[name]
    values = {name: array.reshape(*job.points.shape, *array.shape[1:]) for name, array in columns.items()}
    view = view_in_memory(job, plan, values)
    times = {"started": start_time, "finished": utc_time()}
    return replace(view, attributes=view.attributes | plan.attributes | times)


def view_in_memory(
    job: Job, plan: FilePlan, values: Mapping[str, np.ndarray], sweep_wide: Sequence[FilledVariable] = ()
) -> ResultView:
    """Results as a `ResultView`, with only the attributes `task` and `config_resolved`.

    values: variables of the layout by name, shape (points, own dimensions). sweep_wide: variables that do not
    belong to single points, with values.
    """
    coordinates, variables = stored_coordinates_and_variables(plan, values, sweep_wide)
    return ResultView(
        Path(job.title),
        {"task": job.config.task, "config_resolved": json.dumps(plan.config)},
        {name: array for name, (_, array, _) in (coordinates | variables).items()},
        plan.layout.parameters,
        {MISSING_STATUS: "missing", **dict(plan.status_flags)},
        journalled_count=0,
        arm_axes=plan.layout.arm_axes,
        typed_units={
            variable.name: variable.typed_unit
            for variable, _ in plan.quantity_variables
            if variable.typed_unit
        },
    )


def stored_coordinates_and_variables(
    plan: FilePlan, values: Mapping[str, np.ndarray], sweep_wide: Sequence[FilledVariable]
) -> tuple[dict[str, StoredVariable], dict[str, StoredVariable]]:
    """Returns (coordinates, variables) of the file of a plan, by name. values: variables of the layout by
    name, shape (points, own dimensions). sweep_wide: as in `view_in_memory`."""
    coordinates = _coordinates(plan)
    variables: dict[str, StoredVariable] = {}
    for variable in plan.layout.variables:
        dimensions = (*plan.point_dimension_names, *variable.extra_dimensions)
        variables[variable.name] = (dimensions, values[variable.name], variable.attributes)
    for variable, array in sweep_wide:
        data = array.astype(variable.dtype)
        variables[variable.name] = (variable.extra_dimensions, data, variable.attributes)
        for name, length in zip(variable.extra_dimensions, data.shape, strict=True):
            coordinates.setdefault(name, ((name,), np.arange(1, length + 1), dimension_attributes(name)))
    variables["status"][2].update(flag_attributes(((MISSING_STATUS, "missing"), *plan.status_flags)))
    return coordinates, variables


def _coordinates(plan: FilePlan) -> dict[str, StoredVariable]:
    """Coordinates of the points and of all other dimensions of a plan, by name."""
    points = plan.points
    coordinates: dict[str, StoredVariable] = {}
    if not points.axes:
        rows = np.arange(1, points.count + 1, dtype="<i4")
        coordinates["point"] = (("point",), rows, dimension_attributes("point"))
    for name, column in () if points.arm_axes else points.columns_by_name.items():
        coordinates[name] = ((name if points.is_grid else "point",), column, dimension_attributes(name))
    for variable, values in plan.quantity_variables:
        coordinates[variable.name] = (variable.extra_dimensions, values, variable.attributes)
    for name, length in plan.layout.extents.items():
        coordinate = plan.coordinates.get(name, np.arange(1, length + 1))
        coordinates[name] = ((name,), coordinate, dimension_attributes(name))
    return coordinates


@cache
def blas_kernels() -> str:
    """Names of the BLAS kernels that this process uses."""
    from ...solve.backend.petsc import blas_description as kernel

    return kernel()


@cache
def blas_thread_controller() -> ThreadpoolController:
    """Controller of the threads of all loaded BLAS libraries. PETSc must be loaded before the first call."""
    return ThreadpoolController()
