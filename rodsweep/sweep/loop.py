"""The loop of every rank: get a chunk, solve its items, store the points, return unsolved items."""

import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..solve_progress import SolveStopped, reporting_to
from .chunk_queue import MAX_CHUNK_TIME_OVER_PLANNED_TIME, NO_WORK_LEFT, ChunkQueue, RankReport, chunk_seconds
from .chunk_requests import ChunkClient, ChunkServer
from .points.ranges import IndexRange
from .ranks import Ranks
from .stop import SolverReportListener, StopRequest

PointIndexOrIndices = int | NDArray[np.int64]
"""Flat index of one point, or flat indices, (n,), of points that are stored together."""


class ItemSolver(Protocol):
    """Function that solves a work item, that is, a point, a chain or a group of points. Yields (flat index,
    result) of a point, or (flat indices, results) of points of a group that were solved together."""

    def __call__(self, item: int, /) -> Iterable[tuple[PointIndexOrIndices, Any]]: ...


class ProgressSink(Protocol):
    """Interface of a display, on the first rank, for the progress of all ranks."""

    def __call__(self, finished_count: int) -> None:
        """Shows `finished_count`, the number of points that all ranks have finished."""

    def show_position(self, text: str, fraction_sum: float) -> None:
        """Shows the text `text` on the progress of a long point. fraction_sum: sum of the completed fractions
        of all unfinished points."""


@dataclass(frozen=True, slots=True)
class RankStatistics:
    """Statistics of a rank after the sweep. solved_point_count: number of points that this rank solved.
    busy_seconds, idle_seconds: time spent on solving and on waiting, in s. was_interrupted: whether a stop
    request interrupted a solve; a later run repeats this solve."""

    solved_point_count: int
    busy_seconds: float
    idle_seconds: float
    was_interrupted: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class SweepCallbacks:
    """Functions that every rank calls during a sweep."""

    solve: ItemSolver
    """Solves the points of an item."""
    store: Callable[[PointIndexOrIndices, Any], None]
    """Stores the result of a point durably, on the rank that solved it, before the next point begins."""
    prepare: Callable[[], object] = lambda: None
    """Called once, before the first item."""
    results_since_last_call: Callable[[], dict[int, Any]] = dict
    """Returns the results of the items stored since the last call, by number of the item; empty if no item
    depends on the results of other items."""
    item_label: Callable[[int], str] = lambda item: ""
    """Returns a description of an item for the progress display."""


def sweep(
    ranks: Ranks, queue: ChunkQueue, callbacks: SweepCallbacks, progress: ProgressSink, stop: StopRequest
) -> RankStatistics:
    """Solves every item in `queue`, which is used on the first rank only; returns when all ranks have
    finished. An exception on any rank ends all ranks. After a stop request to any rank, each rank ends after
    the current point, or abandons the point after GRACE_SECONDS (see `stop`)."""
    requests = (
        ChunkServer(ranks, queue, stop, progress.show_position)
        if ranks.is_first
        else ChunkClient(ranks, stop)
    )
    # A stop request during the preparation ends it; the loop below then gets no work.
    with suppress(SolveStopped), reporting_to(SolverReportListener(requests, stop)):
        callbacks.prepare()
    # Points count from here on, so that the preparation does not lower the rate.
    progress(0)
    return _RankLoop(ranks, requests, callbacks, progress, stop).solve_chunks()


class _RankLoop:
    """Loop of one rank over its chunks."""

    def __init__(
        self,
        ranks: Ranks,
        requests: ChunkServer | ChunkClient,
        callbacks: SweepCallbacks,
        progress: ProgressSink,
        stop: StopRequest,
    ):
        self.ranks = ranks
        self.requests = requests
        self.callbacks = callbacks
        self.progress = progress
        self.stop = stop
        self.solved_points = 0
        self.was_interrupted = False

    def solve_chunks(self) -> RankStatistics:
        """Solves chunk after chunk; returns the statistics of the rank once all ranks have finished."""
        start = time.monotonic()
        busy_seconds = 0.0
        chunk = self.requests.next_chunk(RankReport())
        while chunk != NO_WORK_LEFT:
            chunk_start = time.monotonic()
            points_before = self.solved_points
            next_item = self._solve_to_first_unsolved(chunk)
            chunk_seconds = time.monotonic() - chunk_start
            # Measured before the next request, so that waiting counts as idle.
            busy_seconds += chunk_seconds
            report = RankReport(
                finished_item_count=next_item - chunk[0],
                seconds=chunk_seconds,
                returned_items=(next_item, chunk[1]),
                newly_stored_point_count=self.solved_points - points_before,
                stop_signal=self.stop.name,
                results=self.callbacks.results_since_last_call(),
            )
            chunk = self.requests.next_chunk(report)
        if isinstance(self.requests, ChunkServer):
            self.requests.close()
        self.ranks.wait_for_all()
        return RankStatistics(
            self.solved_points, busy_seconds, time.monotonic() - start - busy_seconds, self.was_interrupted
        )

    def _solve_to_first_unsolved(self, chunk: IndexRange) -> int:
        """Solves the items of a chunk in order; returns the number of the first unsolved item, `chunk[1]` if
        there is none. Items stay unsolved after a stop request, or if the chunk takes too long."""
        deadline = time.monotonic() + MAX_CHUNK_TIME_OVER_PLANNED_TIME * chunk_seconds(self.ranks.size)
        item = chunk[0]
        points_before = self.solved_points
        while item < chunk[1] and not self.stop:
            try:
                with reporting_to(
                    SolverReportListener(self.requests, self.stop, partial(self.callbacks.item_label, item))
                ):
                    self._solve_and_store_item(item, points_before)
            except SolveStopped:
                self.was_interrupted = True
            if self.stop:  # the item may be unfinished, so it does not count as solved
                break
            item += 1
            if time.monotonic() > deadline:
                break
        return item

    def _solve_and_store_item(self, item: int, points_before: int) -> None:
        """Solves an item and stores its points. points_before: number of points stored before the chunk."""
        for index, result in self.callbacks.solve(item):
            self.callbacks.store(index, result)
            self.solved_points += 1 if isinstance(index, int) else len(index)
            self.requests.poll_messages()
            if isinstance(self.requests, ChunkServer):
                self.progress(self.requests.queue.stored_points + self.solved_points - points_before)
