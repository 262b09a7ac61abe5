"""Where a long solve is: solvers report it at safe places, and whoever runs them listens, or ends them there.

A solver knows nothing of its listener. Without one a report costs a fraction of a microsecond. A place is
safe where no compiled code is on the stack that calls back into Python, and nothing is half changed.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Text = Callable[[], str]
"""Makes the words of a report, which are made only where they are shown."""
Listener = Callable[[Text], None]
"""Hears every report; raises `Stopped` to end the solve."""


class Stopped(BaseException):
    """Raised by a listener to end a solve in the middle. No handler of a solver's own errors catches it."""


_listener: ContextVar[Listener | None] = ContextVar("listener", default=None)
_parts: ContextVar[tuple[str, ...]] = ContextVar("parts", default=())


@contextmanager
def heard_by(listener: Listener) -> Iterator[None]:
    """Reports of solves in here go to the listener, after those that hear them already."""
    outer = _listener.get()

    def both(text: Text) -> None:
        if outer is not None:
            outer(text)
        listener(text)

    token = _listener.set(both)
    try:
        yield
    finally:
        _listener.reset(token)


@contextmanager
def part(name: str) -> Iterator[None]:
    """Reports in here are of a part of the whole, such as a branch; their words begin with its name."""
    token = _parts.set((*_parts.get(), name))
    try:
        yield
    finally:
        _parts.reset(token)


def report(text: Text | None = None) -> None:
    """Says where the solve is, at a safe place; without a text only that the place is safe."""
    listener = _listener.get()
    if listener is not None:
        listener(str if text is None else lambda: ": ".join((*_parts.get(), text())))
