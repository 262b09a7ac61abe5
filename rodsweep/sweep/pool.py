"""Units of work of which it depends on results which are wanted: handed out one by one by the first rank."""

from collections.abc import Mapping
from typing import Any, Protocol

from .handout import OVER, Handout, Report
from .points.ranges import IndexRange


class Wanting(Protocol):
    """Says which units are wanted next, most needed first, from the results so far."""

    def wanted(self, results: Mapping[int, Any]) -> list[int]: ...


class Pool(Handout):
    """The units that are wanted, on the first rank; safe to use from its two threads.

    results: those of an earlier run, and then all, by unit.
    """

    def __init__(self, work: Wanting, results: dict[int, Any], ranks: int):
        super().__init__([], ranks)
        self.work, self.results = work, results
        self.taken: dict[int, IndexRange] = {}
        """What each rank has in hand."""
        self._wanted: list[int] | None = None

    @property
    def open(self) -> list[int]:
        """Units that are wanted and in nobody's hands."""
        if self._wanted is None:
            self._wanted = self.work.wanted(self.results)
        in_hand = {first for first, _ in self.taken.values()}
        return [unit for unit in self._wanted if unit not in in_hand]

    def settle(self, rank: int, report: Report) -> None:
        """Takes in what a rank has found; what it gives back is wanted again."""
        with self.change:
            self.points += report.points
            self.results |= report.results
            self._wanted = None
            self.taken.pop(rank, None)
            self.change.notify_all()

    def take(self, rank: int) -> IndexRange | None:
        """The next unit for a rank, OVER when nothing more is wanted, None when it has to wait."""
        with self.change:
            if self.stopped:
                return OVER
            wanted = self.open
            if wanted:
                self.taken[rank] = (wanted[0], wanted[0] + 1)
                return self.taken[rank]
            return None if self.taken else OVER

    def take_ahead(self, rank: int) -> IndexRange | None:
        """Nothing: what is wanted next depends on what is in hand."""
        return None
