"""Lets one thread of this process solve at a time, and delays signal handlers until a solver reports
progress.

PETSc, the pooled solvers, HDF5 and matplotlib may be used by one thread at a time. A signal handler that
raises an exception, for example on Ctrl-C, must not run at other times: if compiled code is calling Python to
make a NamedTuple of results, the process ends with a segmentation fault, and pydantic replaces the exception
by a different exception.
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

from ..solve_progress import PositionMaker, reporting_to
from .backend.solver_pools import destroy_pooled_solvers

P = ParamSpec("P")
R = TypeVar("R")

_solve_lock = RLock()
_all_signal_numbers = tuple(map(int, signal.valid_signals()))
"""Numbers of all signals, listed once because listing takes longer than replacing the handlers."""


def one_at_a_time(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator: a call of `function` waits until no other thread executes a function with this decorator."""

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        with _solve_lock:
            return function(*values, **named)

    return call


def defer_signals(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator: while `function` runs, signal handlers run only at the solvers' progress reports; the
    handlers of the remaining signals run when `function` ends."""

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        with SignalDeferral() as held, reporting_to(held.call_due_handlers):
            return function(*values, **named)

    return call


def exclusive_solve(function: Callable[P, R]) -> Callable[P, R]:
    """Decorator for a solve: combines `one_at_a_time` and `defer_signals`.

    An exception destroys all pooled solvers, because the exception may have interrupted a solver at work.
    """

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        try:
            return function(*values, **named)
        except BaseException:
            destroy_pooled_solvers()
            raise

    return one_at_a_time(defer_signals(call))


class SignalDeferral:
    """Context in which Python's signal handlers wait for the next progress report or the end of the context.

    Python runs signal handlers in the main thread only; in another thread the context has no effect.
    """

    def __init__(self) -> None:
        self._handlers: dict[int, Callable[[int, FrameType | None], Any]] = {}
        self._due_signals: list[int] = []

    def __enter__(self) -> Self:
        if current_thread() is not main_thread():
            return self
        try:
            for number in _all_signal_numbers:
                handler = getsignal(number)
                if callable(handler):
                    self._handlers[number] = handler
                    signal.signal(number, self._note_signal)
        except BaseException:  # raised by a handler that is not deferred yet
            self._restore_handlers()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._restore_handlers()
        self._call_handlers()

    def call_due_handlers(self, _: PositionMaker) -> None:
        """Calls the handlers of the signals that arrived since the last call; passes on an exception of a
        handler."""
        if self._due_signals and current_thread() is main_thread():
            self._call_handlers()

    def _note_signal(self, number: int, _: FrameType | None) -> None:
        self._due_signals.append(number)

    def _call_handlers(self) -> None:
        while self._due_signals:
            number = self._due_signals.pop(0)
            self._handlers[number](number, inspect.currentframe())

    def _restore_handlers(self) -> None:
        for number, handler in self._handlers.items():
            if getsignal(number) == self._note_signal:  # otherwise a handler has installed another handler
                signal.signal(number, handler)
