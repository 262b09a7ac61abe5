"""Who solves which unit, a point or a chain of points: small chunks from the first rank, sized by pace.

A rank that finds its chunk slower than foreseen gives back what is left of it with its next request. Nobody
is told that the work is over while another rank may still give something back, so the ranks finish within
about one unit of each other. `rodsweep.sweep.claims` has the messages.
"""

import threading
from collections import Counter, deque
from dataclasses import dataclass, field
from typing import Any

from .points.ranges import IndexRange, total

CHUNK_SECONDS, CHUNK_SECONDS_A_RANK = 0.1, 1e-3
"""How long a chunk should take: long against a message, short against a run; with many ranks so long that the
first one, which answers a request in 50 microseconds, spends a twentieth of its time on answers."""
GIVE_BACK_AFTER = 3.0
"""Time after which a rank gives back what is left of its chunk, in units of what the chunk should take."""
LARGEST_CHUNK = 1 << 16
PLENTY = 4
"""Units a rank that have to be left for a rank to get its next chunk before it has done the last."""
OVER: IndexRange = (0, 0)


def chunk_seconds(ranks: int) -> float:
    """How long a chunk should take where so many ranks ask for more."""
    return max(CHUNK_SECONDS, ranks * CHUNK_SECONDS_A_RANK)


@dataclass(frozen=True, slots=True)
class Report:
    """What a rank says when it wants more: units done, their seconds, what it gives back, points kept.

    ahead: it says nothing but that it has begun a chunk, and would take the next. stop: the signal by which
    it was asked to stop; what it gives back then is for another run. results: of units on which it depends
    what is to be done next.
    """

    done: int = 0
    seconds: float = 0.0
    given_back: IndexRange = OVER
    points: int = 0
    ahead: bool = False
    stop: str = ""
    results: dict[int, Any] = field(default_factory=dict)


class Handout:
    """The units still to do, on the first rank; safe to use from its two threads."""

    def __init__(self, todo: list[IndexRange], ranks: int):
        self.todo = deque(todo)
        self.left = total(todo)
        self.ranks = ranks
        self.held: Counter[int] = Counter()
        """Chunks that each rank has and has not reported on."""
        self.points = 0
        """That all ranks have reported kept."""
        self.pace: dict[int, float] = {}
        self.stopped = False
        self.change = threading.Condition()

    def settle(self, rank: int, report: Report) -> None:
        """Takes in a report: what is done, and what is given back."""
        with self.change:
            if self.held[rank]:
                self.held[rank] -= 1
            self.points += report.points
            if report.done:
                self.pace[rank] = report.seconds / report.done
            first, end = report.given_back
            if end > first and not self.stopped:
                self.pace[rank] = report.seconds  # as slow as its slowest unit may be: next, one unit
                self.todo.appendleft(report.given_back)
                self.left += end - first
            self.change.notify_all()

    def take(self, rank: int) -> IndexRange | None:
        """The next chunk for a rank, OVER when all work is done, None when it has to wait."""
        with self.change:
            if self.todo:
                return self._take(rank)
            return None if self.held.total() and not self.stopped else OVER

    def take_ahead(self, rank: int) -> IndexRange | None:
        """The next chunk for a rank that still works on one, None unless plenty is left."""
        with self.change:
            return self._take(rank) if self.todo and self.left >= PLENTY * self.ranks else None

    def _take(self, rank: int) -> IndexRange:
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
        """Leaves what has not been handed out for another run."""
        with self.change:
            self.stopped = True
            self.todo.clear()
            self.change.notify_all()
