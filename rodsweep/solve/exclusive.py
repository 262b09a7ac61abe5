"""Lets one thread of this process solve at a time, and runs signal handlers only at safe places of a solve.

PETSc, the solvers kept from point to point, HDF5 and matplotlib may be used by one thread at a time.
Elsewhere a handler that raises, as that of Ctrl-C, does harm: while compiled code calls Python to make a
NamedTuple of results, the process ends with a segmentation fault, and pydantic replaces the exception by a
different one.
"""

import inspect
import signal

# `signal.getsignal` converts its result to an enumeration, which takes a hundred times as long.
from _signal import getsignal  # type: ignore[import-not-found]
from collections.abc import Callable
from functools import wraps
from threading import RLock, current_thread, main_thread
from types import FrameType
from typing import Any, ParamSpec, Self, TypeVar

from ..watch import MakePosition, reporting_to
from .backend.kept import forget_all

P = ParamSpec("P")
R = TypeVar("R")

_one = RLock()
_signals = tuple(map(int, signal.valid_signals()))
"""Numbers of all signals. Listing them takes longer than holding them."""


def one_at_a_time(function: Callable[P, R]) -> Callable[P, R]:
    """`function`, which waits until no other thread executes a decorated function."""

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        with _one:
            return function(*values, **named)

    return call


def signals_held(function: Callable[P, R]) -> Callable[P, R]:
    """`function` with signal handlers deferred to the safe places that solvers report, or to its end."""

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        with HeldSignals() as held, reporting_to(held.call_due):
            return function(*values, **named)

    return call


def solving(function: Callable[P, R]) -> Callable[P, R]:
    """`function` for one thread at a time and with signals held.

    Kept solvers are dropped after an exception, which may have interrupted their work.
    """

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        try:
            return function(*values, **named)
        except BaseException:
            forget_all()
            raise

    return one_at_a_time(signals_held(call))


class HeldSignals:
    """Defers the Python handlers of signals to the next report, or to the end.

    Python runs handlers in the main thread only; in other threads this does nothing.
    """

    def __init__(self) -> None:
        self._handlers: dict[int, Callable[[int, FrameType | None], Any]] = {}
        self._due: list[int] = []

    def __enter__(self) -> Self:
        if current_thread() is not main_thread():
            return self
        try:
            for number in _signals:
                handler = getsignal(number)
                if callable(handler):
                    self._handlers[number] = handler
                    signal.signal(number, self._note)
        except BaseException:  # raised by a handler that is not deferred yet
            self._restore()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._restore()
        self._call_handlers()

    def call_due(self, _: MakePosition) -> None:
        """Calls the handlers of signals that arrived, at a safe place, and raises their exceptions."""
        if self._due and current_thread() is main_thread():
            self._call_handlers()

    def _note(self, number: int, _: FrameType | None) -> None:
        self._due.append(number)

    def _call_handlers(self) -> None:
        while self._due:
            number = self._due.pop(0)
            self._handlers[number](number, inspect.currentframe())

    def _restore(self) -> None:
        for number, handler in self._handlers.items():
            if getsignal(number) == self._note:  # otherwise a handler has installed another handler
                signal.signal(number, handler)
