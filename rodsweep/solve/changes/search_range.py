"""Intervals of a path variable, searched from left to right, and the end of the search.

If the eigenvalues of a rod cannot be computed or proved, the search ends before this rod; the results up to
this end are complete.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ...model.rod import Rod
from ..unsolvable import Unsolvable


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchRangeSettings:
    """Settings for the end of a search along a path."""

    max_halvings_after_failure: int = 4
    """If the search of an interval fails, its left half is searched, then the left half of the remaining
    part, and so on, up to this many times."""


SEARCH_RANGE_SETTINGS = SearchRangeSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class CrushingEndSettings:
    """Settings for the end of a search just below the force that crushes the rod."""

    relative_crushing_margin: float = 1e-6
    """A search ends at this relative distance below the crushing force; at F = k1 the rod is crushed."""
    relative_crushing_tolerance: float = 1e-12
    """F and the crushing force are treated as equal if their relative difference is at most this number: on a
    grid of F and k1 the two forces may differ by rounding alone."""


CRUSHING_END_SETTINGS = CrushingEndSettings()


def search_end_below_crushing(rod: Rod, F: float) -> float:
    """Largest force of a search up to F, in k3/L^2: F, or a force just below the crushing force of `rod`."""
    return min(F, rod.crushing_force * (1 - CRUSHING_END_SETTINGS.relative_crushing_margin))


class SearchEnd(NamedTuple):
    """The largest path variable p up to which the search is complete, and the reason why the search ended
    there; the reason is empty at the requested end."""

    p: float
    reason: str = ""


class IntervalQueue:
    """Intervals of the path variable that are still to be searched, leftmost first. end: end of the search.
    When the queue is empty, the range from the first of `edges` to `end.p` has been searched."""

    def __init__(self, edges: list[float]):
        self.start_p = edges[0]
        self.length = edges[-1] - edges[0]
        self.end = SearchEnd(edges[-1])
        # Reversed, so that `pop` takes the leftmost interval without moving the others.
        self._queue = list(zip(edges[:-1], edges[1:], strict=True))[::-1]
        self._unsearched_end = edges[-1]
        self._halvings = 0

    def __iter__(self) -> Iterator[tuple[float, float]]:
        """Yields the intervals of the queue; raises Unsolvable if no interval could be searched."""
        settings = SEARCH_RANGE_SETTINGS
        while True:
            # The left part of an interval whose search failed can often be searched.
            if not self._queue and self.end.reason and self._halvings < settings.max_halvings_after_failure:
                self._halvings += 1
                middle = (self.end.p + self._unsearched_end) / 2
                self._queue.append((self.end.p, middle))
                # The new end holds only if the half is searched; a failure moves it back.
                self.end = SearchEnd(middle, self.end.reason)
            if not self._queue:
                break
            yield self._queue.pop()
        # Raised after the halvings, because a search of any part is a result.
        if self.end.reason and self.end.p <= self.start_p:
            raise Unsolvable(self.end.reason)

    def add_subintervals(self, *intervals: tuple[float, float]) -> None:
        """Adds parts of the current interval to the queue; `intervals` is in increasing order."""
        self._queue += intervals[::-1]

    def stop_at(self, p: float, reason: str) -> None:
        """Ends the search at path variable `p`, up to which it is complete. reason: why the search ends."""
        self._queue.clear()
        # This end is intended, so the search does not continue in a half beyond it.
        self._halvings = SEARCH_RANGE_SETTINGS.max_halvings_after_failure
        self.end = SearchEnd(p, reason)

    def limit_search_to_left_half(self, interval: tuple[float, float], reason: str) -> None:
        """Drops all intervals after the start of the current `interval`, whose search failed. Only its left
        half is still searched, at most `max_halvings_after_failure` times. reason: why the search failed."""
        self._queue.clear()
        self._unsearched_end = interval[1]
        self.end = SearchEnd(interval[0], reason)
