"""Runs the solver of one point of a sweep: measures the time and turns exceptions into outcomes."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from ..watch import report
from .backend.petsc import PETSC_ERRORS

Outcome = TypeVar("Outcome", bound=Any)
"""Result of a solver: a dataclass with the field `seconds`."""


class Unsolvable(Exception):
    """The model or the numerical method has no solution for a rod; the message says why."""


FAILURES = (*PETSC_ERRORS, Unsolvable, ArithmeticError, MemoryError, np.linalg.LinAlgError)
"""Exceptions that count as a failed solve; any other exception is a bug and ends the run."""


def solved(
    solve: Callable[[], Outcome],
    failed: Callable[[str], Outcome],
    more_failures: tuple[type[Exception], ...] = (),
) -> Outcome:
    """Result of `solve()`, or `failed(cause)` after an exception in `FAILURES` or `more_failures`. `seconds`
    is set to the duration."""
    started = time.perf_counter()
    try:
        with np.errstate(all="ignore"):
            report()
            outcome = solve()
    except (*FAILURES, *more_failures) as error:
        outcome = failed(cause_of(error))
    return replace(outcome, seconds=time.perf_counter() - started)


def cause_of(error: BaseException) -> str:
    """Last line of the message of `error`; PETSc writes the cause there."""
    cause = error.__cause__ or error
    return (str(cause) or type(cause).__name__).splitlines()[-1]
