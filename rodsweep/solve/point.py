"""One point is solved: the time it takes, and a failure as its outcome instead of an exception."""

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
    """The model or the method has no answer for this point; says why."""


FAILURES = (*PETSC_ERRORS, Unsolvable, ArithmeticError, MemoryError, np.linalg.LinAlgError)
"""How a solve may fail; anything else is a bug, which ends the run."""


def solved(
    solve: Callable[[], Outcome], failed: Callable[[str], Outcome], also: tuple[type[Exception], ...] = ()
) -> Outcome:
    """What `solve` gives, or `failed` of the cause in one line; with its time. also: more that may fail."""
    started = time.perf_counter()
    try:
        with np.errstate(all="ignore"):
            report()
            outcome = solve()
    except (*FAILURES, *also) as error:
        outcome = failed(cause_of(error))
    return replace(outcome, seconds=time.perf_counter() - started)


def cause_of(error: BaseException) -> str:
    """The last line of an error's message, which in PETSc's says what is wrong."""
    cause = error.__cause__ or error
    return (str(cause) or type(cause).__name__).splitlines()[-1]
