"""Solution of one point: its duration, and a failure as an outcome instead of an exception."""

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from ..watch import report
from .backend.petsc import PETSC_ERRORS

Outcome = TypeVar("Outcome", bound=Any)
"""A dataclass with the field `seconds`."""


class Unsolvable(Exception):
    """The model or the method has no solution for this point; the message says why."""


FAILURES = (*PETSC_ERRORS, Unsolvable, ArithmeticError, MemoryError, np.linalg.LinAlgError)
"""Exceptions by which a solve may fail; any other exception is a bug and ends the run."""


def solved(
    solve: Callable[[], Outcome],
    failed: Callable[[str], Outcome],
    more_failures: tuple[type[Exception], ...] = (),
) -> Outcome:
    """Result of `solve`, or `failed(cause)`, with its duration. more_failures: further exceptions to
    catch."""
    started = time.perf_counter()
    try:
        with np.errstate(all="ignore"):
            report()
            outcome = solve()
    except (*FAILURES, *more_failures) as error:
        outcome = failed(cause_of(error))
    return replace(outcome, seconds=time.perf_counter() - started)


def cause_of(error: BaseException) -> str:
    """The last line of an error's message, which in PETSc's messages is the cause."""
    cause = error.__cause__ or error
    return (str(cause) or type(cause).__name__).splitlines()[-1]
