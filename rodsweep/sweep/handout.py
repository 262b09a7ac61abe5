"""Distribution of work items over ranks, in small chunks whose size follows from each rank's time per item.

A work item, in the code a unit, is a point, a chain or a stretch of points. A rank with a slow chunk returns
the unsolved units of the chunk with the next request. No rank ends while another rank may still return units,
and all ranks finish within about the time of one unit. `rodsweep.sweep.claims` sends the messages.
"""

import threading
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from .points.ranges import IndexRange, index_count

CHUNK_SECONDS = 0.1
"""Planned solve time of a chunk, in s: long compared with the time of a message, short compared with a
run."""
CHUNK_SECONDS_A_RANK = 1e-3
"""Planned time of a chunk in a run with many ranks, in s per rank. The first rank answers a request in 50
microseconds and so spends a twentieth of its time on answers."""
GIVE_BACK_AFTER = 3.0
"""Time after which a rank returns the unsolved units of a chunk to the queue, divided by the planned time of
the chunk."""
LARGEST_CHUNK = 1 << 16
"""Maximum number of units in a chunk."""
MIN_UNITS_AHEAD = 4
"""A rank gets its next chunk in advance only if the queue has at least this number of units per rank."""
NO_WORK_LEFT: IndexRange = (0, 0)
"""Empty range of units: the answer to a request for a chunk if no unit is left to solve."""


def chunk_seconds(ranks: int) -> float:
    """Planned time of a chunk, in s, in a run with `ranks` ranks."""
    return max(CHUNK_SECONDS, ranks * CHUNK_SECONDS_A_RANK)


@dataclass(frozen=True, slots=True)
class RankReport:
    """Report of a rank on its last chunk, sent with the request for the next chunk."""

    done: int = 0
    """Number of units finished since the last report."""
    seconds: float = 0.0
    """Time spent since the last report, in s."""
    given_back: IndexRange = NO_WORK_LEFT
    """Range of the units of the last chunk that the rank did not solve."""
    points: int = 0
    """Number of points that the rank has stored in its journal since the last report."""
    ahead: bool = False
    """Whether the rank requests the next chunk in advance, at the start of the present chunk."""
    stop: str = ""
    """Name of the stop signal that the rank received, or empty. Units returned after a stop signal are left
    for another run."""
    results: dict[int, Any] = field(default_factory=dict)
    """Results of finished units, by number of the unit; empty if no unit depends on the results of other
    units."""


class ChunkQueue:
    """Queue of the unsolved units, on the first rank; safe to use from two threads. todo: ranges of units.
    ranks: number of ranks.
    """

    def __init__(self, todo: list[IndexRange], ranks: int):
        self.todo = deque(todo)
        self.left = index_count(todo)
        self.ranks = ranks
        self.held: Counter[int] = Counter()
        """Number of chunks that a rank has received but not reported on, by rank."""
        self.points = 0
        """Total number of points that the ranks have reported as stored."""
        self.pace: dict[int, float] = {}
        """Latest time per unit, in s, by rank."""
        self.stopped = False
        self.change = threading.Condition()

    def settle(self, rank: int, report: RankReport) -> None:
        """Updates the queue from a rank's report on finished and returned units."""
        with self.change:
            if self.held[rank]:
                self.held[rank] -= 1
            self.points += report.points
            if report.done:
                self.pace[rank] = report.seconds / report.done
            first, end = report.given_back
            if end > first and not self.stopped:
                self.pace[rank] = report.seconds  # pessimistic, so that its next chunk is one unit
                self.todo.appendleft(report.given_back)
                self.left += end - first
            self.change.notify_all()

    def take(self, rank: int) -> IndexRange | None:
        """The next chunk for a rank; NO_WORK_LEFT if no unit is left, None if the rank has to wait."""
        with self.change:
            if self.todo:
                return self._take(rank)
            return None if self.held.total() and not self.stopped else NO_WORK_LEFT

    def take_ahead(self, rank: int) -> IndexRange | None:
        """The next chunk for a rank that still works on a chunk; None if few units are left in the queue."""
        with self.change:
            return self._take(rank) if self.todo and self.left >= MIN_UNITS_AHEAD * self.ranks else None

    def _take(self, rank: int) -> IndexRange:
        """Removes and returns the next chunk, sized by the rank's time per unit; the lock must be held."""
        # At most half of an equal division: chunks shrink toward the end, where waiting costs most.
        share = max(1, self.left // (2 * self.ranks))
        pace = self.pace.get(rank)
        size = 1 if pace is None else int(chunk_seconds(self.ranks) / max(pace, 1e-7))
        first, last = self.todo.popleft()
        end = min(last, first + max(1, min(size, share, LARGEST_CHUNK)))
        if end < last:
            self.todo.appendleft((end, last))
        self.left -= end - first
        self.held[rank] += 1
        return first, end

    def stop(self) -> None:
        """Empties the queue after a stop request; a later run solves the units."""
        with self.change:
            self.stopped = True
            self.todo.clear()
            self.change.notify_all()


class UnitChooser(Protocol):
    """Chooses the units to solve next, the most urgent unit first, from the results of solved units."""

    def wanted(self, results: Mapping[int, Any]) -> list[int]: ...


class Pool(ChunkQueue):
    """`ChunkQueue` whose units depend on the results of solved units, one unit in a chunk.

    work: chooses the next units from the results. results: by number of the unit, at first from an earlier
    run; reported results are added.
    """

    def __init__(self, work: UnitChooser, results: dict[int, Any], ranks: int):
        super().__init__([], ranks)
        self.work = work
        self.results = results
        self.taken: dict[int, IndexRange] = {}
        """Range of the unit that a rank is solving, by rank."""
        self._wanted: list[int] | None = None

    @property
    def open(self) -> list[int]:
        """Units that `work` has chosen and that no rank is solving, the most urgent unit first."""
        if self._wanted is None:
            self._wanted = self.work.wanted(self.results)
        in_hand = {first for first, _ in self.taken.values()}
        return [unit for unit in self._wanted if unit not in in_hand]

    def settle(self, rank: int, report: RankReport) -> None:
        """Adds the results in a rank's report; a unit without a result can be chosen again."""
        with self.change:
            self.points += report.points
            self.results |= report.results
            self._wanted = None
            self.taken.pop(rank, None)
            self.change.notify_all()

    def take(self, rank: int) -> IndexRange | None:
        """The next unit for a rank, as a range; NO_WORK_LEFT if no unit is left, None if the rank has to
        wait.
        """
        with self.change:
            if self.stopped:
                return NO_WORK_LEFT
            wanted = self.open
            if wanted:
                self.taken[rank] = (wanted[0], wanted[0] + 1)
                return self.taken[rank]
            return None if self.taken else NO_WORK_LEFT

    def take_ahead(self, rank: int) -> IndexRange | None:
        """Always None, because the choice of a rank's next unit depends on the result of the present unit."""
        return None
