"""One thread of this process at a time, and Python's signal handlers where a solve is safe.

PETSc, the solvers that are kept from point to point, HDF5 and matplotlib belong to one thread at a time. And
compiled code calls Python back when it makes a NamedTuple of its results: an exception that a signal handler
raises there, as Ctrl-C does, is a segmentation fault; pydantic makes another exception of it.
"""

import inspect
import signal
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


def one_at_a_time(function: Callable[P, R]) -> Callable[P, R]:
    """`function`, which waits until no other thread is inside a function of this kind."""

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        with _one:
            return function(*values, **named)

    return call


def signals_held(function: Callable[P, R]) -> Callable[P, R]:
    """`function`, where signal handlers run at the safe places that solvers report, or at its end."""

    @wraps(function)
    def call(*values: P.args, **named: P.kwargs) -> R:
        with HeldSignals() as held, reporting_to(held.hear):
            return function(*values, **named)

    return call


def solving(function: Callable[P, R]) -> Callable[P, R]:
    """`function`, one at a time and with signals held.

    Kept solvers are dropped after an exception: it may have come in the middle of their work.
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
    """Signals with handlers in Python, which are called later: at the next report, or at the end.

    Python runs handlers in the main thread only; in others this does nothing.
    """

    def __init__(self) -> None:
        self._handlers: dict[int, Callable[[int, FrameType | None], Any]] = {}
        self._due: list[int] = []

    def __enter__(self) -> Self:
        if current_thread() is not main_thread():
            return self
        try:
            for number in signal.valid_signals():
                handler = signal.getsignal(number)
                if callable(handler):
                    self._handlers[number] = handler
                    signal.signal(number, self._note)
        except BaseException:  # of a handler that was not held yet
            self._restore()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._restore()
        self._call_handlers()

    def hear(self, _: MakePosition) -> None:
        """A safe place: calls the handlers of the signals that came, and raises what they raise."""
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
            if signal.getsignal(number) == self._note:  # else a handler has put another in its place
                signal.signal(number, handler)
