"""Progress reports of long solves: a solver reports its position, and a listener shows it or ends the solve.

A solver has no reference to the listeners. Without a listener a report costs a fraction of a microsecond.
Solvers report only where stopping is safe: no compiled code that calls back into Python is on the stack, and
no data are half changed.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import partial
from typing import NamedTuple


class SolvePosition(NamedTuple):
    """Position of a running solve, for display by a listener.

    text: text of the position, such as "branch 2 of 3". completed_fraction: completed fraction of the work,
    from 0 to 1; None if unknown.
    """

    text: str = ""
    completed_fraction: float | None = None


PositionMaker = Callable[[], SolvePosition]
"""Function that returns the position of a solve. A listener calls the function only to show the position."""
Listener = Callable[[PositionMaker], None]
"""Function called at every report of a solve. A listener raises `SolveStopped` to end the solve."""


class SolveStopped(BaseException):
    """Raised by a listener to end a running solve. Solvers never catch this exception."""


class _SolvePart(NamedTuple):
    """Named part of a solve. name: prefix of the texts of reports from the part.

    completed_fractions: completed fractions of the work of the whole solve at the start and at the end of the
    part; None if unknown.
    """

    name: str
    completed_fractions: tuple[float, float] | None

    def position_in_whole(self, inner: SolvePosition) -> SolvePosition:
        """Converts a position within this part into a position within the whole solve."""
        fraction = None
        if self.completed_fractions is not None:
            start, end = self.completed_fractions
            fraction = start + (end - start) * (inner.completed_fraction or 0.0)
        return SolvePosition(": ".join(filter(None, (self.name, inner.text))), fraction)


_listeners: ContextVar[tuple[tuple[Listener, int], ...]] = ContextVar("listeners", default=())
"""Pairs (listener, number of the `solve_part` blocks around the `reporting_to` block of the listener), from
the outermost listener inwards."""
_solve_parts: ContextVar[tuple[_SolvePart, ...]] = ContextVar("parts", default=())


@contextmanager
def reporting_to(listener: Listener) -> Iterator[None]:
    """Calls the listener at every report of a solve in the `with` block, after the listeners of outer blocks.

    The positions are relative to the block: their text omits the names of parts that enclose the block.
    """
    token = _listeners.set((*_listeners.get(), (listener, len(_solve_parts.get()))))
    try:
        yield
    finally:
        _listeners.reset(token)


@contextmanager
def solve_part(name: str, fractions: tuple[float, float] | None = None) -> Iterator[None]:
    """Marks the reports in the `with` block as reports of a named part of a larger solve, such as a branch.

    name: prefix of the text of each report. fractions: completed fractions of the work of the larger solve at
    the start and at the end of the part; None if unknown.
    """
    token = _solve_parts.set((*_solve_parts.get(), _SolvePart(name, fractions)))
    try:
        yield
    finally:
        _solve_parts.reset(token)


def report(make_position: PositionMaker = SolvePosition) -> None:
    """Reports the position of the solve to all listeners.

    make_position: function that returns the position. By default the position is empty, and the report only
    lets a listener end the solve.
    """
    for listener, enclosing_part_count in _listeners.get():
        listener(partial(_position_in_whole_solve, make_position, enclosing_part_count))


def _position_in_whole_solve(make_position: PositionMaker, enclosing_part_count: int) -> SolvePosition:
    """Position within the whole solve that a listener observes; a position without text is returned
    unchanged.

    make_position: function that returns the position within the innermost part. enclosing_part_count: number
    of parts that enclose the listener's `with` block.
    """
    position = make_position()
    if not position.text:
        return position
    for part in reversed(_solve_parts.get()[enclosing_part_count:]):
        position = part.position_in_whole(position)
    return position
