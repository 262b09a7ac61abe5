"""Distribution of units, each a point or a chain of points: small chunks, sized by the pace of each rank.

A rank with a slow chunk gives back the rest of the chunk with the next request. No rank is dismissed while
another rank may still give units back, and all ranks finish within about one unit of each other.
`rodsweep.sweep.claims` holds the messages.
"""

import threading
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from .points.ranges import IndexRange, index_count

CHUNK_SECONDS = 0.1
"""Planned solve time of a chunk, in s: long compared with a message, short compared with a run."""
CHUNK_SECONDS_A_RANK = 1e-3
"""Planned solve time of a chunk, divided by the number of ranks, in s, where this exceeds CHUNK_SECONDS. The
first rank answers a request in 50 microseconds
and so spends a twentieth of its time on answers."""
GIVE_BACK_AFTER = 3.0
"""Time after which a rank gives back the rest of a chunk, in units of the planned time of the chunk."""
LARGEST_CHUNK = 1 << 16
"""Largest number of units in a chunk."""
MIN_UNITS_AHEAD = 4
"""Minimum number of waiting units per rank for which a rank gets its next chunk before it has finished the
present chunk."""
NO_WORK_LEFT: IndexRange = (0, 0)
"""Empty range of units, the answer to a request for a chunk once all units are solved or dropped."""


def chunk_seconds(ranks: int) -> float:
    """Planned solve time of a chunk, in s, for a run on `ranks` ranks."""
    return max(CHUNK_SECONDS, ranks * CHUNK_SECONDS_A_RANK)


@dataclass(frozen=True, slots=True)
class RankReport:
    """Message of a rank to the first rank: results of its last chunk, and a request for the next chunk."""

    done: int = 0
    """Number of units finished since the last report."""
    seconds: float = 0.0
    given_back: IndexRange = NO_WORK_LEFT
    """Units of the chunk that the rank has not solved and returns to the handout."""
    points: int = 0
    """Number of points that the rank has stored in its journal since the last report."""
    ahead: bool = False
    """Whether the rank requests the next chunk in advance, at the start of the present chunk."""
    stop: str = ""
    """Name of the stop signal that the rank received, else empty. A later run solves units given back after a
    stop."""
    results: dict[int, Any] = field(default_factory=dict)
    """Results of finished units, by unit; empty in sweeps whose later units do not depend on results."""


class Handout:
    """Queue of the units that no rank has received, on the first rank; safe to use from two threads."""

    def __init__(self, todo: list[IndexRange], ranks: int):
        self.todo = deque(todo)
        self.left = index_count(todo)
        self.ranks = ranks
        self.held: Counter[int] = Counter()
        """Number of chunks that each rank holds and has not reported on."""
        self.points = 0
        """Number of points that all ranks have reported as stored."""
        self.pace: dict[int, float] = {}
        """Latest time per unit of each rank, in s."""
        self.stopped = False
        self.change = threading.Condition()

    def settle(self, rank: int, report: RankReport) -> None:
        """Records the finished units of a report, and queues the units given back."""
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
        """Next chunk for a rank; NO_WORK_LEFT at the end, None while other ranks may give units back."""
        with self.change:
            if self.todo:
                return self._take(rank)
            return None if self.held.total() and not self.stopped else NO_WORK_LEFT

    def take_ahead(self, rank: int) -> IndexRange | None:
        """Chunk for a rank that has not finished its present chunk; None if few units are left."""
        with self.change:
            return self._take(rank) if self.todo and self.left >= MIN_UNITS_AHEAD * self.ranks else None

    def _take(self, rank: int) -> IndexRange:
        # Half of an equal share at most: chunks shrink toward the end, where waiting costs most.
        """Removes a chunk, sized by the rank's pace, from the queue; the caller holds the lock."""
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
        """Drops all units not handed out, after a stop request; a later run solves these units."""
        with self.change:
            self.stopped = True
            self.todo.clear()
            self.change.notify_all()


class UnitChooser(Protocol):
    """Chooses the units to solve next from the results so far, the most urgent unit first."""

    def wanted(self, results: Mapping[int, Any]) -> list[int]: ...


class Pool(Handout):
    """Queue of single units that `work` chooses from the results so far; safe to use from two threads.

    results: results of an earlier run, by unit; results that ranks report are added.
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
        """Units that `work` has chosen and no rank is solving, the most urgent unit first."""
        if self._wanted is None:
            self._wanted = self.work.wanted(self.results)
        in_hand = {first for first, _ in self.taken.values()}
        return [unit for unit in self._wanted if unit not in in_hand]

    def settle(self, rank: int, report: RankReport) -> None:
        """Adds the results in a report; a unit whose rank reports no result can be chosen again."""
        with self.change:
            self.points += report.points
            self.results |= report.results
            self._wanted = None
            self.taken.pop(rank, None)
            self.change.notify_all()

    def take(self, rank: int) -> IndexRange | None:
        """Next unit for a rank; NO_WORK_LEFT at the end, None while the choice waits for results."""
        with self.change:
            if self.stopped:
                return NO_WORK_LEFT
            wanted = self.open
            if wanted:
                self.taken[rank] = (wanted[0], wanted[0] + 1)
                return self.taken[rank]
            return None if self.taken else NO_WORK_LEFT

    def take_ahead(self, rank: int) -> IndexRange | None:
        """Always None: the choice of the next unit depends on the result of the unfinished unit."""
        return None
