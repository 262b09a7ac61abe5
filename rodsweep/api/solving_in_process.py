"""Solution of all points of a job in sequence in this process, without files and without MPI."""

import socket
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..arrays import list_of
from ..errors import InputError
from ..results.file.creation import FilePlan
from ..results.file.provenance import joined_reasons_attribute, utc_time
from ..results.file.view import ResultView
from ..solve.backend.availability import require_solvers
from ..solve.backend.solver_pools import destroy_pooled_solvers
from ..solve.solve_lock import exclusive_solve
from ..solve_progress import reporting_to, solve_part
from ..sweep.points.groups import GroupSolveFunction, PointGroups
from ..sweep.progress import (
    Display,
    ProgressReporter,
    SilentProgress,
    can_show_notebook_bar,
    display_listener,
)
from ..tasks.protocol import NamedArrays, Solver, SweepWideResult, SweepWideVariableSolver
from ..tasks.running.in_memory import blas_thread_controller, view_in_memory
from ..tasks.running.job import Job, plan_in_memory
from ..tasks.running.unforeseen_exceptions import (
    FailureReasons,
    PointExceptionCallback,
    changed_point_failure_reasons,
    guarded_solver,
)
from .keyword_arguments import keyword_value_of_yaml_types
from .task_results import SolvedPoints

_tasks_with_compiled_solvers: set[str] = set()
"""Names of the tasks whose solvers are already compiled in this process."""


@exclusive_solve
def solve_in_process(
    job: Job, note: PointExceptionCallback | None = None, progress: bool | None = None
) -> SolvedPoints:
    """Solves all points of a job in this process, and returns the results.

    note: function called with every unforeseen exception, after which the point has the status `failed`;
    None: the exception is raised. progress: whether to display progress; None: only in a terminal or a
    notebook. Raises InputError for any other value of `progress`, and EnvironmentIncomplete if PETSc or SLEPc
    is missing.
    """
    display = progress_display(progress, job.points.count, job.title)
    require_solvers()
    solver = job.solver()
    start_time = utc_time()
    if note is not None:
        solver = guarded_solver(solver, job.layout, note)
    plan = plan_in_memory(job, solver.possible_statuses)
    if job.config.task not in _tasks_with_compiled_solvers:
        solver.warm_up()
        _tasks_with_compiled_solvers.add(job.config.task)
    # One thread, as in the command: threads change the order of sums.
    with blas_thread_controller().limit(limits=1, user_api="blas"):
        display(0)
        try:
            values, messages, reasons = _solve_points(job, solver, plan, display)
            sweep_wide = SweepWideResult(())
            if solver.sweep_wide_solver:
                view = view_in_memory(job, plan, values)
                sweep_wide = _solve_sweep_wide_variables(solver.sweep_wide_solver, view, display)
                _replace_changed_points(sweep_wide, job, plan, values, messages)
                reasons += changed_point_failure_reasons(sweep_wide, solver.possible_statuses, job.point_text)
        except BaseException:  # a solve was interrupted, by Ctrl-C too: cached solvers may be half changed
            destroy_pooled_solvers()
            raise
        finally:
            display.close()
        from_config, from_points = plan.variables_from_config(), plan.variables_from_points(values)
    return SolvedPoints(
        job=job,
        plan=plan,
        possible_statuses=solver.possible_statuses,
        values=values,
        sweep_wide_variables=(*from_config, *sweep_wide.sweep_wide_variables, *from_points),
        run_attributes=_attributes_of_solve(start_time, reasons),
        messages=messages,
    )


def _attributes_of_solve(start_time: str, reasons: Sequence[str]) -> dict[str, Any]:
    """Attributes of a result whose solve began at `start_time` and ends now. reasons: reasons why points
    failed."""
    from ..solve.backend import petsc

    return {
        "petsc_options": petsc.user_options_text(),
        "ranks": 1,
        "hosts": socket.gethostname(),
        "started": start_time,
        "stopped": "",
        **joined_reasons_attribute("\n".join(reasons)),
        "finished": utc_time(),
    }


def _solve_points(
    job: Job, solver: Solver, plan: FilePlan, display: Display
) -> tuple[dict[str, np.ndarray], list[str], list[str]]:
    """Returns (variables, messages, reasons). variables: values by name of the variable, with the dimensions
    of the points first. messages: one message for each point. reasons: reasons why points failed."""
    reasons = FailureReasons(job.point_text)
    point_count = job.points.count
    columns = {
        name: np.repeat(value[None], point_count, axis=0)
        for name, value in plan.layout.fill_values_of_point.items()
    }
    messages = [""] * point_count
    unsolved = (
        range(point_count)
        if solver.groups_and_group_solver is None
        else _solve_groups(*solver.groups_and_group_solver, columns, display)
    )
    outcomes = _solve_outcomes(unsolved, point_count, solver, display)
    for solved_count, (index, outcome) in enumerate(outcomes, point_count - len(unsolved) + 1):
        record = solver.file_values_of_outcome(index, outcome)
        for name, array in columns.items():
            array[index] = record[name]
        messages[index] = outcome.message
        reasons.add(index, outcome)
        display(solved_count)
    shape = job.points.shape
    values = {name: array.reshape(*shape, *array.shape[1:]) for name, array in columns.items()}
    return values, messages, [*reasons.example_by_reason.values()]


def _solve_groups(
    groups: PointGroups, solve_group: GroupSolveFunction, columns: dict[str, np.ndarray], display: Display
) -> Sequence[int]:
    """Fills the variables of all points that are solved together; returns the flat indices of all other
    points. columns: variables by name, (points, ...)."""
    unsolved: list[int] = []
    solved_count = 0
    for indices in map(groups.indices, range(groups.count)):
        result = solve_group(indices)
        solved_indices = np.flatnonzero(result.is_solved)
        for name, column in result.part_at(solved_indices).variable_values.items():
            columns[name][indices[solved_indices]] = column
        unsolved += list_of(indices[~result.is_solved])
        solved_count += len(solved_indices)
        display(solved_count)
    return unsolved


def _solve_sweep_wide_variables(
    solver: SweepWideVariableSolver, view: ResultView, display: Display
) -> SweepWideResult:
    """Computes the variables that depend on all points, for example curves, and the new values of the points
    that change. view: the solved points."""
    results = dict[int, NamedArrays]()
    while (items := solver.work_items(view, results)) and (chosen := items.items_to_solve(results)):
        name = items.item_label(chosen[0])
        with solve_part(name), reporting_to(display_listener(display, name)):
            results[chosen[0]] = solver.solve_item(items, chosen[0])
    return solver.result(view, results)


def _replace_changed_points(
    result: SweepWideResult, job: Job, plan: FilePlan, values: dict[str, np.ndarray], messages: list[str]
) -> None:
    """Replaces variables and messages of the points that change. values: variables by name, with the
    dimensions of the points first."""
    for index, changed in result.changed_points.items():
        position = np.unravel_index(index, job.points.shape)
        for variable in plan.layout.variables:
            values[variable.name][position] = changed[variable.name]
        messages[index] = result.messages[index]


def _solve_outcomes(
    unsolved: Sequence[int], point_count: int, solver: Solver, display: Display
) -> Iterator[tuple[int, Any]]:
    """Solves the points with flat indices `unsolved`; yields (flat index, outcome) of each point. Along a
    chain, each point starts from the solution of the previous point. point_count: number of all points."""
    solved_count = point_count - len(unsolved)

    @contextmanager
    def point_progress() -> Iterator[None]:
        """Context in which progress reports are displayed as reports of the next point."""
        name = f"point {solved_count + 1} of {point_count}" if point_count > 1 else ""
        share = solved_count / point_count, (solved_count + 1) / point_count
        with solve_part(name, share), reporting_to(display_listener(display, name)):
            yield

    if solver.sweep_chains is None:
        for index in unsolved:
            with point_progress():
                outcome = solver.solve(index)
            solved_count += 1
            yield index, outcome
        return
    chains = solver.sweep_chains.chains
    solve_from = solver.sweep_chains.solve_from
    for chain in range(chains.count):
        state = None
        for index in map(int, chains.indices(chain)):
            with point_progress():
                outcome, state = solve_from(index, state)
            solved_count += 1
            yield index, outcome


def progress_display(progress: bool | None, total: int | None, title: str) -> Display:
    """Progress display of a solve, which appears after a second.

    progress: whether to display progress; None: only in a terminal or a notebook. total: number of points,
    None if unknown. title: text before the bar. Raises InputError for any other value of `progress`.
    """
    progress = keyword_value_of_yaml_types("progress", progress)
    if not (progress is None or isinstance(progress, bool)):
        raise InputError(f"progress = {progress!r} is not allowed; it should be True, False or None")
    is_shown = sys.stderr.isatty() or can_show_notebook_bar() if progress is None else progress
    return ProgressReporter(total, title, is_bar=True) if is_shown else SilentProgress()
