"""Where a long solve is: solvers report it at safe places, and whoever runs them listens, or ends them there.

A solver knows nothing of its listener. Without one a report costs a fraction of a microsecond. A place is
safe where no compiled code is on the stack that calls back into Python, and nothing is half changed.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple


class Whereabouts(NamedTuple):
    """Where a solve is, in words, and the share of its work that is done, from 0 to 1; None if unknown."""

    words: str = ""
    share: float | None = None


MakeWhereabouts = Callable[[], Whereabouts]
"""Makes the place of a report, which is only made where it is shown."""
Listener = Callable[[MakeWhereabouts], None]
"""Hears every report; raises `Stopped` to end the solve."""


class Stopped(BaseException):
    """Raised by a listener to end a solve in the middle. No handler of a solver's own errors catches it."""


class _Part(NamedTuple):
    """A part of a solve: its name, and the shares of the whole between which it lies, if they are known."""

    name: str
    shares: tuple[float, float] | None

    def of_whole(self, inner: Whereabouts) -> Whereabouts:
        """The place in the whole of a place in this part."""
        share = None
        if self.shares is not None:
            begin, end = self.shares
            share = begin + (end - begin) * (inner.share or 0.0)
        return Whereabouts(": ".join(filter(None, (self.name, inner.words))), share)


_listener: ContextVar[Listener | None] = ContextVar("listener", default=None)
_parts: ContextVar[tuple[_Part, ...]] = ContextVar("parts", default=())


@contextmanager
def heard_by(listener: Listener) -> Iterator[None]:
    """Reports of solves in here go to the listener, after those that hear them already."""
    outer = _listener.get()

    def both(place: MakeWhereabouts) -> None:
        if outer is not None:
            outer(place)
        listener(place)

    token = _listener.set(both)
    try:
        yield
    finally:
        _listener.reset(token)


@contextmanager
def part(name: str, shares: tuple[float, float] | None = None) -> Iterator[None]:
    """Reports in here are of a part of the whole, such as a branch; their words begin with its name.

    shares: of the whole work that are done when the part begins and when it ends, if they are known.
    """
    token = _parts.set((*_parts.get(), _Part(name, shares)))
    try:
        yield
    finally:
        _parts.reset(token)


def report(place: MakeWhereabouts = Whereabouts) -> None:
    """Says where the solve is, at a safe place; without words only that the place is safe."""
    listener = _listener.get()
    if listener is not None:
        listener(lambda: _in_whole(place()))


def _in_whole(place: Whereabouts) -> Whereabouts:
    """The place in the whole of a place in the innermost part."""
    if not place.words:
        return place
    for outer in reversed(_parts.get()):
        place = outer.of_whole(place)
    return place
