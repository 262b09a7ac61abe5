"""Units chosen individually on the first rank, because results decide which units are solved next."""

from collections.abc import Mapping
from typing import Any, Protocol

from .handout import OVER, Handout, Report
from .points.ranges import IndexRange


class UnitChooser(Protocol):
    """Chooses the units to solve next from the results so far, the most urgent unit first."""

    def wanted(self, results: Mapping[int, Any]) -> list[int]: ...


class Pool(Handout):
    """Units to solve next, on the first rank; safe to use from two threads.

    results: by unit, at first from an earlier run; reported results are added.
    """

    def __init__(self, work: UnitChooser, results: dict[int, Any], ranks: int):
        super().__init__([], ranks)
        self.work = work
        self.results = results
        self.taken: dict[int, IndexRange] = {}
        """Unit in progress on each rank."""
        self._wanted: list[int] | None = None

    @property
    def open(self) -> list[int]:
        """Chosen units in progress on no rank."""
        if self._wanted is None:
            self._wanted = self.work.wanted(self.results)
        in_hand = {first for first, _ in self.taken.values()}
        return [unit for unit in self._wanted if unit not in in_hand]

    def settle(self, rank: int, report: Report) -> None:
        """Takes the results of a rank into account; a unit without a result can be chosen again."""
        with self.change:
            self.points += report.points
            self.results |= report.results
            self._wanted = None
            self.taken.pop(rank, None)
            self.change.notify_all()

    def take(self, rank: int) -> IndexRange | None:
        """The next unit for a rank; OVER if no unit is left, None if the rank has to wait."""
        with self.change:
            if self.stopped:
                return OVER
            wanted = self.open
            if wanted:
                self.taken[rank] = (wanted[0], wanted[0] + 1)
                return self.taken[rank]
            return None if self.taken else OVER

    def take_ahead(self, rank: int) -> IndexRange | None:
        """None: the choice of the next unit depends on the unfinished unit."""
        return None
