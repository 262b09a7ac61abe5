"""Reasons why points failed, and treatment of unforeseen exceptions, which are bugs: the point gets the
status `failed`, the sweep continues.

Any `UserError` and errors of the operating system are no bugs and are not caught, because they concern every
point.
"""

import os
import socket
import time
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import __version__
from ...arrays import list_of
from ...errors import UserError
from ...results.file.provenance import MAX_FAILURE_REASONS, failure_kind, utc_time
from ...results.layouts.variables import SECONDS_VARIABLE, STATUS_VARIABLE, Layout
from ...solve.backend.solver_pools import destroy_pooled_solvers
from ...solve.status import PointStatus
from ...sweep.loop import PointIndexOrIndices
from ...sweep.points.chains import State
from ...sweep.points.groups import GroupResult
from ..protocol import Solver, SweepWideResult


@dataclass(frozen=True, slots=True)
class FailureReasons:
    """Distinct reasons why points failed, each with the first point that failed for this reason; at most
    MAX_FAILURE_REASONS.

    point_text: function from the flat index of a point to a text with its parameters. example_by_reason: text
    with parameters, status and message, by reason; in a reason all numbers are replaced.
    """

    point_text: Callable[[int], str]
    example_by_reason: dict[str, str] = field(default_factory=dict)

    def add(self, index: PointIndexOrIndices, result: Any) -> list[str]:
        """Adds the reason why a point failed; returns a list with the text on this point, or an empty list if
        the reason is known, the list of reasons is full, or no point failed.

        index, result: flat index and outcome of one point, or flat indices, (n,), and result of a group, of
        which no point failed.
        """
        if isinstance(result, GroupResult) or result.status.succeeded:
            return []
        if len(self.example_by_reason) >= MAX_FAILURE_REASONS:
            return []
        point = self.point_text(int(index))
        line = " ".join(f"{point}: {result.status.name} {result.message}".split())
        if failure_kind(line) in self.example_by_reason:
            return []
        self.example_by_reason[failure_kind(line)] = line
        return [line]


def changed_point_failure_reasons(
    result: SweepWideResult, statuses: Sequence[PointStatus], point_text: Callable[[int], str]
) -> list[str]:
    """Texts with parameters, status and message of failed points among the points that changed after they
    were solved, one for each distinct reason. statuses: all statuses that a point can have. point_text:
    function from the flat index of a point to a text with its parameters."""
    status_by_value = {int(status): status for status in statuses}
    reasons = FailureReasons(point_text)
    for index, values in result.changed_points.items():
        status = status_by_value[int(values[STATUS_VARIABLE.name])]
        reasons.add(index, SimpleNamespace(status=status, message=result.messages[index]))
    return [*reasons.example_by_reason.values()]


RUN_ENDING_EXCEPTIONS = (UserError, OSError)
"""Exceptions that end the run with a message, because they concern all points."""
MAX_LOGGED_EXCEPTIONS = 1000
"""Maximum number of exceptions that a rank writes into the log; more exceptions would repeat the same bug."""
FAILED_STATUS = "failed"
"""Status, in every task, of a point with an unforeseen exception in the solver."""
PointExceptionCallback = Callable[[Sequence[int], Exception], None]
"""Function called with the flat indices of the points that were solved together, and the exception of the
solver."""
SweepWideExceptionCallback = Callable[[str, Exception], None]
"""Function called with the name of a work item for variables that depend on all points, and the exception of
the solver."""


@dataclass(frozen=True, slots=True)
class StorableOutcome:
    """Outcome of a point that is ready to be stored. status, message: as in the solver's outcome. values: all
    variables of the layout by name."""

    status: PointStatus
    message: str
    values: dict[str, Any]


def guarded_solver(solver: Solver, layout: Layout, note: PointExceptionCallback) -> Solver:
    """A solver that catches unforeseen exceptions, calls `note`, and gives a failed point fill values.

    After an exception in a group, each of its points is solved alone. Only points that fail again get fill
    values.
    """
    guard = _GuardedSolver(solver, layout, note)
    return solver.with_wrapper(
        guard.outcome, guard.solve_group, file_values_of_outcome=lambda _, outcome: outcome.values
    )


@dataclass(frozen=True, slots=True)
class _GuardedSolver:
    """Implementation of `guarded_solver`. wrapped_solver: the solver whose exceptions are caught. layout:
    variables of a point. note_exception: function called with every exception that is caught."""

    wrapped_solver: Solver
    layout: Layout
    note_exception: PointExceptionCallback

    def outcome(
        self, index: int, start: State, solve: Callable[[], tuple[Any, State]]
    ) -> tuple[StorableOutcome, State]:
        """Returns (outcome, initial state for the next point) of a point. An unforeseen exception, in the
        solve or in the conversion into values of the file, gives a failed outcome and no state."""
        began = time.perf_counter()
        try:
            outcome, state = solve()
            record = self.wrapped_solver.file_values_of_outcome(index, outcome)
            return StorableOutcome(outcome.status, outcome.message, record), state
        except RUN_ENDING_EXCEPTIONS:
            raise
        except Exception as error:
            destroy_pooled_solvers()
            self.note_exception([index], error)
            return self._failed_outcome(error, time.perf_counter() - began), None

    def _failed_outcome(self, error: Exception, seconds: float) -> StorableOutcome:
        """Outcome of a failed point, with the fill value of every variable."""
        status = next(
            status for status in self.wrapped_solver.possible_statuses if status.name == FAILED_STATUS
        )
        values = {SECONDS_VARIABLE.name: seconds, STATUS_VARIABLE.name: int(status)}
        return StorableOutcome(status, describe_exception(error), self.layout.fill_values_of_point | values)

    def solve_group(self, indices: NDArray[np.int64]) -> GroupResult:
        """Result of points that are solved together, with the flat indices `indices`, (n,). After an
        unforeseen exception the result has fill values, and `is_solved` is False for every point, so that
        each point is solved alone."""
        assert self.wrapped_solver.groups_and_group_solver is not None
        try:
            return self.wrapped_solver.groups_and_group_solver[1](indices)
        except RUN_ENDING_EXCEPTIONS:
            raise
        except Exception as error:
            destroy_pooled_solvers()
            self.note_exception(list_of(indices), error)
            point_count = len(indices)
            empty = {
                name: np.stack([value] * point_count)
                for name, value in self.layout.fill_values_of_point.items()
            }
            return GroupResult(empty, np.zeros(point_count, np.bool_))


def describe_exception(error: Exception) -> str:
    """An unforeseen exception in one line: class, message, and the line of code that raised the exception."""
    message = " ".join(str(error).split())
    frame = traceback.extract_tb(error.__traceback__)[-1]
    place = f"{Path(frame.filename).name}, line {frame.lineno}, in {frame.name}"
    return f"unforeseen {type(error).__name__}{': ' if message else ''}{message} ({place}), a bug of rodsweep"


def traceback_log_path(output: Path) -> Path:
    """Path of the log with the tracebacks of failed points, in the folder of the result file `output`."""
    return output.with_name(output.name + ".log")


class TracebackLog:
    """Log of unforeseen exceptions: a file in the folder of the result file, to which all ranks append
    tracebacks."""

    def __init__(self, output: Path, rank: int, point_text: Callable[[int], str], is_strict: bool = False):
        """output: the result file. rank: number of this rank. point_text: function from the flat index of a
        point to a text with its parameters. is_strict: whether every exception is raised again after it is
        logged."""
        self.strict = is_strict
        self.path = traceback_log_path(output)
        self.rank = rank
        self.point_text = point_text
        self.count = 0
        """Number of unforeseen exceptions on this rank."""
        self._known: set[str] = set()

    def __call__(self, indices: Sequence[int], error: Exception) -> None:
        """Appends the exception of points to the log, with their parameters."""
        points_text = self.point_text(indices[0])
        if len(indices) > 1:
            points_text = (
                f"{len(indices)} points together, from {points_text} to {self.point_text(indices[-1])}"
            )
        self.append_exception(points_text, error)

    def append_exception(self, place: str, error: Exception) -> None:
        """Appends the exception of points or of a work item to the log, unless this rank has logged
        MAX_LOGGED_EXCEPTIONS. Raises the exception again if the log is strict.

        place: text naming the points or the work item. If this rank has logged the same traceback before,
        only the last line of the traceback is appended.
        """
        self.count += 1
        if self.count <= MAX_LOGGED_EXCEPTIONS:
            self._write(place, error)
        if self.strict:
            error.add_note(f"at {place}")
            raise error

    def _write(self, place: str, error: Exception) -> None:
        program = f"rodsweep {__version__}, rank {self.rank} on {socket.gethostname()}"
        heading = f"{utc_time()} {program}: {place}\n"
        lines = traceback.format_exception(error)
        text = "".join(lines)
        body = f"{lines[-1]}as above\n" if text in self._known else text
        self._known.add(text)
        handle = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
        try:  # a single call, so that lines of different ranks do not mix
            os.write(handle, f"{heading}{body}\n".encode(errors="backslashreplace"))
        finally:
            os.close(handle)
