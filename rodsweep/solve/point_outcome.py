"""Runs the solver of one point of a sweep: measures the time and turns exceptions into outcomes."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from ..solve_progress import report
from .backend.petsc import PETSC_EXCEPTIONS
from .unsolvable import Unsolvable

Outcome = TypeVar("Outcome", bound=Any)
"""Result of a solver: a dataclass with the field `seconds`."""


FAILURE_EXCEPTIONS = (*PETSC_EXCEPTIONS, Unsolvable, ArithmeticError, MemoryError, np.linalg.LinAlgError)
"""Exceptions that are treated as a failed solve; any other exception is passed on."""


def outcome_or_failure(
    solve: Callable[[], Outcome],
    failed: Callable[[str], Outcome],
    more_failures: tuple[type[Exception], ...] = (),
) -> Outcome:
    """Result of `solve()`, or of `failed(cause)` after an exception in `FAILURE_EXCEPTIONS` or
    `more_failures`; the field `seconds` is set to the duration. Any other exception is raised."""
    started = time.perf_counter()
    try:
        with np.errstate(all="ignore"):
            report()
            outcome = solve()
    except (*FAILURE_EXCEPTIONS, *more_failures) as error:
        outcome = failed(cause_of(error))
    return replace(outcome, seconds=time.perf_counter() - started)


def cause_of(error: BaseException) -> str:
    """Last line of the message of `error`, or of the exception that caused `error`; PETSc writes the cause in
    the last line. For a ZeroDivisionError or OverflowError: a clause that a number of the rod overflows or
    underflows, with this line in brackets."""
    cause = error.__cause__ or error
    message = (str(cause) or type(cause).__name__).splitlines()[-1]
    if isinstance(cause, ZeroDivisionError | OverflowError):
        return f"a number of this rod overflows or underflows ({message})"
    return message
