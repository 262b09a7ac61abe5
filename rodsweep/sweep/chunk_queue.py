"""Distribution of work items over ranks. Independent items are handed out in small chunks, whose size follows
from each rank's time per item. Items that depend on earlier results are handed out one by one.

A work item, item for short, is a point, a chain, a group of points, or a part of a curve. A rank with a
slow chunk returns the unsolved items of the chunk with the next request. No rank ends while another rank may
still return items, and all ranks finish within about the time of one item. The module
`rodsweep.sweep.chunk_requests` sends the messages.
"""

import threading
from collections import Counter, deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from .points.ranges import IndexRange, index_count

CHUNK_SECONDS = 0.1
"""Planned solve time of a chunk, in s: long compared with a message, short compared with a run."""
CHUNK_SECONDS_PER_RANK = 1e-3
"""Planned time of a chunk in a run with many ranks, in s per rank. The first rank answers a request in 50
microseconds and so spends a twentieth of its time on answers."""
MAX_CHUNK_TIME_OVER_PLANNED_TIME = 3.0
"""Time after which a rank returns the unsolved items of a chunk, divided by the planned time of a chunk."""
MAX_CHUNK_ITEMS = 1 << 16
"""Maximum number of items in a chunk."""
MIN_QUEUED_ITEMS_PER_RANK_FOR_ADVANCE = 4
"""A rank gets its next chunk in advance only if the queue has at least this number of items per rank."""
NO_WORK_LEFT: IndexRange = (0, 0)
"""Empty range of items: the answer to a request for a chunk if no item is left to solve."""


def chunk_seconds(rank_count: int) -> float:
    """Planned time of a chunk, in s, in a run with `rank_count` ranks."""
    # The first rank answers one request per chunk and rank, so chunks must grow with the number of ranks.
    return max(CHUNK_SECONDS, rank_count * CHUNK_SECONDS_PER_RANK)


@dataclass(frozen=True, slots=True)
class RankReport:
    """Report of a rank on its last chunk, sent with the request for the next chunk."""

    finished_item_count: int = 0
    """Number of items finished since the last report."""
    seconds: float = 0.0
    """Time spent since the last report, in s."""
    returned_items: IndexRange = NO_WORK_LEFT
    """Range of the items of the last chunk that the rank did not solve."""
    newly_stored_point_count: int = 0
    """Number of points that the rank has stored in its journal since the last report."""
    is_request_in_advance: bool = False
    """Whether the rank requests the next chunk in advance, at the start of the current chunk."""
    stop_signal: str = ""
    """Name of the stop signal that the rank received, or empty. Items returned after a stop signal are left
    for another run."""
    results: dict[int, Any] = field(default_factory=dict)
    """Results of finished items, by number of the item; empty if no item depends on other items."""


class ChunkQueue:
    """Queue of the unsolved items, on the first rank; safe to use from two threads. ranges: ranges of items.
    rank_count: number of ranks."""

    def __init__(self, ranges: list[IndexRange], rank_count: int):
        self.unsolved = deque(ranges)
        self.items_left = index_count(ranges)
        self.rank_count = rank_count
        self.outstanding: Counter[int] = Counter()
        """Number of chunks that a rank has received but not reported on, by rank."""
        self.stored_points = 0
        """Total number of points that the ranks have reported as stored."""
        self.seconds_per_item: dict[int, float] = {}
        """Latest time per item, in s, by rank."""
        self.is_stopped = False
        """Whether a stop request has emptied the queue."""
        self.change = threading.Condition()
        """Lock of the queue; notified when items or reports arrive."""

    def add_report(self, rank: int, report: RankReport) -> None:
        """Updates the queue from a rank's report on finished and returned items."""
        with self.change:
            # The first report of a rank belongs to no chunk.
            if self.outstanding[rank]:
                self.outstanding[rank] -= 1
            self.stored_points += report.newly_stored_point_count
            if report.finished_item_count:
                self.seconds_per_item[rank] = report.seconds / report.finished_item_count
            start, end = report.returned_items
            if end > start and not self.is_stopped:
                # Pessimistic, so that its next chunk is one item.
                self.seconds_per_item[rank] = report.seconds
                # At the front, so that points are still solved nearly in the order of the file.
                self.unsolved.appendleft(report.returned_items)
                self.items_left += end - start
            self.change.notify_all()

    def next_chunk(self, rank: int) -> IndexRange | None:
        """The next chunk for a rank; NO_WORK_LEFT if no item is left, None if the rank has to wait."""
        with self.change:
            if self.unsolved:
                return self._pop_chunk(rank)
            # A chunk under way may come back unsolved, so a rank waits for it instead of ending.
            return None if self.outstanding.total() and not self.is_stopped else NO_WORK_LEFT

    def next_chunk_in_advance(self, rank: int) -> IndexRange | None:
        """The next chunk for a rank that still works on a chunk; None if few items are left in the queue."""
        with self.change:
            # Near the end a chunk handed out early would wait on a busy rank while another rank is idle.
            if self.unsolved and self.items_left >= MIN_QUEUED_ITEMS_PER_RANK_FOR_ADVANCE * self.rank_count:
                return self._pop_chunk(rank)
            return None

    def _pop_chunk(self, rank: int) -> IndexRange:
        """Removes and returns the next chunk, sized by the rank's time per item; the lock must be held."""
        # At most half of an equal division: chunks shrink toward the end, where waiting costs most.
        fair_size = max(1, self.items_left // (2 * self.rank_count))
        seconds_per_item = self.seconds_per_item.get(rank)
        size = (
            1
            if seconds_per_item is None
            else int(chunk_seconds(self.rank_count) / max(seconds_per_item, 1e-7))
        )
        first, last = self.unsolved.popleft()
        end = min(last, first + max(1, min(size, fair_size, MAX_CHUNK_ITEMS)))
        # The rest of a range goes back to the front, which keeps the order of the file.
        if end < last:
            self.unsolved.appendleft((end, last))
        self.items_left -= end - first
        self.outstanding[rank] += 1
        return first, end

    def stop(self) -> None:
        """Empties the queue after a stop request; a later run solves the items."""
        with self.change:
            self.is_stopped = True
            self.unsolved.clear()
            self.change.notify_all()


class ItemChooser(Protocol):
    """Chooses the items to solve next from the results of solved items."""

    def items_to_solve(self, results: Mapping[int, Any]) -> list[int]:
        """Numbers of the items still to be solved, most urgent first; empty if no item is left. results:
        results of the solved items, by number."""


class DependentItemQueue(ChunkQueue):
    """`ChunkQueue` whose items depend on the results of solved items, one item in a chunk. item_chooser:
    chooses the next items from the results. results: results of solved items, by number of the item; at first
    from an earlier run, later also from the reports. rank_count: number of ranks."""

    def __init__(self, item_chooser: ItemChooser, results: dict[int, Any], rank_count: int):
        super().__init__([], rank_count)
        self.item_chooser = item_chooser
        self.results = results
        self.in_progress: dict[int, IndexRange] = {}
        """Range of the item that a rank is solving, by rank."""
        self._items_to_solve: list[int] | None = None

    def add_report(self, rank: int, report: RankReport) -> None:
        """Adds the results in a rank's report; an item without a result can be chosen again."""
        with self.change:
            self.stored_points += report.newly_stored_point_count
            self.results |= report.results
            # A new result may change the choice of all items, so it is made anew when a rank next asks.
            self._items_to_solve = None
            # An item that was abandoned has no result, and is chosen again.
            self.in_progress.pop(rank, None)
            self.change.notify_all()

    def next_chunk(self, rank: int) -> IndexRange | None:
        """The next item for a rank, as a range; NO_WORK_LEFT if no item is left or after a stop request, None
        if the rank has to wait."""
        with self.change:
            if self.is_stopped:
                return NO_WORK_LEFT
            if self._items_to_solve is None:
                self._items_to_solve = self.item_chooser.items_to_solve(self.results)
            taken_items = {start for start, _ in self.in_progress.values()}
            for item in self._items_to_solve:
                if item not in taken_items:
                    self.in_progress[rank] = (item, item + 1)
                    return self.in_progress[rank]
            # Results under way may call for further items.
            return None if self.in_progress else NO_WORK_LEFT

    def next_chunk_in_advance(self, rank: int) -> IndexRange | None:
        """Always None, because the choice of a rank's next item depends on the result of the current item."""
        return None
