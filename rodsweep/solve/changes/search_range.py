"""Intervals of a path that are searched from left to right, and how far the search reaches.

A place whose eigenvalues cannot be computed or proved ends the search before this place, not the whole
search: what lies left of it is complete.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ..point import Unsolvable


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchRangeSettings:
    """Settings for the end of a search along a path."""

    last_halvings: int = 4
    """Number of halvings of the interval in which a search ends early, to come closer to its end."""


SEARCH_RANGE = SearchRangeSettings()


class SearchEnd(NamedTuple):
    """The last path variable of a search, and why the search ended there; the reason is empty at the
    requested end."""

    p: float
    reason: str = ""


class SearchedIntervals:
    """Intervals of the path variable still to be searched, leftmost first.

    reach: everything from the first edge to `reach.p` is searched once no interval is left.
    """

    def __init__(self, edges: list[float]):
        self.first = edges[0]
        self.length = edges[-1] - edges[0]
        self.reach = SearchEnd(edges[-1])
        self._left = list(zip(edges[:-1], edges[1:], strict=True))[::-1]
        self._unsolvable = edges[-1]
        self._halvings = 0

    def __iter__(self) -> Iterator[tuple[float, float]]:
        """Yields each interval once; raises Unsolvable if nothing beyond the first edge can be searched."""
        while True:
            # The first part of an interval that cannot be searched to its end often can.
            if not self._left and self.reach.reason and self._halvings < SEARCH_RANGE.last_halvings:
                self._halvings += 1
                middle = (self.reach.p + self._unsolvable) / 2
                self._left.append((self.reach.p, middle))
                self.reach = SearchEnd(middle, self.reach.reason)
            if not self._left:
                break
            yield self._left.pop()
        if self.reach.reason and self.reach.p <= self.first:
            raise Unsolvable(self.reach.reason)

    def divide(self, *intervals: tuple[float, float]) -> None:
        """Adds the parts of the present interval that are still to be searched, in increasing order."""
        self._left += intervals[::-1]

    def stop_at(self, p: float, reason: str) -> None:
        """Ends the search at a place up to which everything is searched."""
        self._left.clear()
        self._halvings = SEARCH_RANGE.last_halvings
        self.reach = SearchEnd(p, reason)

    def end_within(self, interval: tuple[float, float], reason: str) -> None:
        """Ends the search in the present interval, which cannot be searched to its end."""
        self._left.clear()
        self._unsolvable = interval[1]
        self.reach = SearchEnd(interval[0], reason)
