"""Distribution of chunks of work items: the first rank takes chunks from the `ChunkQueue`, other ranks
request chunks by messages.

The first rank solves points too. A thread of the first rank answers requests meanwhile, so that no rank waits
for the end of a solve on the first rank. A solve may still delay the thread. Every rank therefore requests
the next chunk at the beginning of a chunk, and is answered in advance while enough work items are left. A
rank with a stop signal notifies the first rank, which notifies all ranks; each rank stops after the current
point.
"""

import threading
import time
from collections import deque
from collections.abc import Callable

from ..solve_progress import SolvePosition
from .chunk_queue import NO_WORK_LEFT, ChunkQueue, RankReport
from .points.ranges import IndexRange
from .ranks import Ranks
from .stop import StopRequest

REQUEST_TAG = 71
"""MPI tag of a rank's request for a chunk, a `RankReport`."""
ANSWER_TAG = 72
"""MPI tag of the answer to a request, an `IndexRange`."""
STOP_TAG = 73
"""MPI tag of a stop request; the message is the name of the signal."""
PROGRESS_TAG = 74
"""MPI tag of a report of progress in a point that takes long, a `SolvePosition`."""
POLL_SECONDS = 2e-3
"""Seconds between two polls for messages by the thread of the first rank. Each poll takes 20 microseconds or
more from the solve on that rank."""
POLL_SECONDS_IF_ANSWERED = 5e-3
"""Seconds between two polls for messages by the thread of the first rank, if the first rank has recently
answered requests between two points."""
SHORTEST_CHUNK_POLL_SECONDS = 1e-4
"""First pause, in seconds, between two polls of a rank that waits for a chunk."""
LONGEST_CHUNK_POLL_SECONDS = 1e-2
"""Longest pause, in seconds, between two polls of a rank that waits for a chunk: an idle rank must not take
processor time from solving ranks."""
CHUNK_POLL_GROWTH = 1.1
"""Ratio of two successive pauses of a waiting rank. A ratio near 1 hardly prolongs a wait of a
millisecond."""
IDLE_FIRST_RANK_WAIT_SECONDS = 0.05
"""Seconds for which an idle first rank waits for the queue to change before it polls for MPI messages."""


class ChunkServer:
    """Hands chunks of work items to the first rank when it calls `next_chunk`, and to all other ranks on
    request; a thread answers these requests while the first rank solves."""

    def __init__(
        self, ranks: Ranks, queue: ChunkQueue, stop: StopRequest, show_position: Callable[[str, float], None]
    ):
        """show_position: function (text on the progress in a point that takes long, sum of the completed
        fractions of all unfinished points) that displays the progress."""
        self.ranks = ranks
        self.queue = queue
        self.stop = stop
        self.show_position = show_position
        self.waiting_ranks: deque[int] = deque()
        """Ranks that wait for a chunk, in the order of their requests."""
        self.answered_in_advance: set[int] = set()
        """Ranks whose next request has been answered in advance."""
        self.working_ranks = set(range(1, ranks.size))
        """Other ranks that have not yet received NO_WORK_LEFT."""
        self.mpi_status = ranks.MPI.Status()
        self.positions: dict[int, SolvePosition] = {}
        """Latest reported progress in a point that takes long, by rank."""
        self.serving_lock = threading.Lock()
        self.last_served = 0.0
        """Time of the last poll for messages between two points, on the monotonic clock, in s."""
        self.thread: threading.Thread | None = None
        if ranks.size > 1:
            # A daemon, so that an exception on this rank does not wait for the thread.
            self.thread = threading.Thread(
                target=self._serve_until_all_ranks_finish, name="chunk queue", daemon=True
            )
            self.thread.start()

    def next_chunk(self, report: RankReport) -> IndexRange:
        """The next chunk for the first rank, given the `report` on its last chunk; NO_WORK_LEFT at the end.
        Waits until a chunk is available or no work is left."""
        with self.serving_lock:
            self._pass_on_stop()
        self.positions.pop(0, None)
        self.queue.add_report(0, report)
        self.poll_messages()
        while (chunk := self.queue.next_chunk(0)) is None:
            with self.queue.change:
                self.queue.change.wait(IDLE_FIRST_RANK_WAIT_SECONDS)
            self.poll_messages()
            for position in list(self.positions.values())[:1]:
                self.show_position(position.text, self._sum_of_done_fractions())
        return chunk

    def close(self) -> None:
        """Waits until all other ranks have finished and the thread has ended, then receives the progress
        reports that still wait. Without other ranks it does nothing."""
        if self.thread is not None:
            self.thread.join()
            self._receive_positions()

    def report_position(self, position: SolvePosition) -> None:
        """Displays the progress of the first rank in a point that takes long: `position`, its text and
        completed fraction."""
        self.positions[0] = position
        self.show_position(position.text, self._sum_of_done_fractions())

    def _sum_of_done_fractions(self) -> float:
        """Sum of the completed fractions of all unfinished points on all ranks."""
        # A copy, because the thread may change the dictionary meanwhile.
        return sum(position.completed_fraction or 0.0 for position in list(self.positions.values()))

    def poll_messages(self) -> None:
        """Answers requests of other ranks, or without other ranks checks for a stop request; called on the
        first rank between two points.

        During a long point the thread answers. The thread is not sufficient, because a solve inside PETSc
        holds Python's global interpreter lock, and the thread might rarely get the lock.
        """
        if self.thread is not None:
            self._handle_waiting_messages()
            self.last_served = time.monotonic()
        else:
            self._pass_on_stop()

    def _pass_on_stop(self) -> None:
        """After a stop request to the first rank, ends the queue and notifies all working ranks, once."""
        if self.stop and not self.queue.is_stopped:
            self.queue.stop()
            # A rank that has ended would never receive the message.
            for rank in self.working_ranks:
                self.ranks.comm.send(self.stop.name, dest=rank, tag=STOP_TAG)

    def _handle_waiting_messages(self) -> None:
        """Handles all waiting messages: stop requests, progress, and requests for chunks."""
        comm = self.ranks.comm
        MPI = self.ranks.MPI
        with self.serving_lock:
            # Stop requests come first, so that no chunk is handed out after one.
            while comm.Iprobe(source=MPI.ANY_SOURCE, tag=STOP_TAG, status=self.mpi_status):
                self.stop.adopt_request_of_rank(comm.recv(source=self.mpi_status.Get_source(), tag=STOP_TAG))
            self._pass_on_stop()
            self._receive_positions()
            while comm.Iprobe(source=MPI.ANY_SOURCE, tag=REQUEST_TAG, status=self.mpi_status):
                rank = self.mpi_status.Get_source()
                self._handle_report(rank, comm.recv(source=rank, tag=REQUEST_TAG))
            while self.waiting_ranks and (chunk := self.queue.next_chunk(self.waiting_ranks[0])) is not None:
                rank = self.waiting_ranks.popleft()
                comm.send(chunk, dest=rank, tag=ANSWER_TAG)
                if chunk == NO_WORK_LEFT:
                    self.working_ranks.discard(rank)

    def _receive_positions(self) -> None:
        """Receives all waiting reports on the progress of long solves."""
        comm = self.ranks.comm
        MPI = self.ranks.MPI
        while comm.Iprobe(source=MPI.ANY_SOURCE, tag=PROGRESS_TAG, status=self.mpi_status):
            rank = self.mpi_status.Get_source()
            self.positions[rank] = comm.recv(source=rank, tag=PROGRESS_TAG)

    def _handle_report(self, rank: int, report: RankReport) -> None:
        """Handles the report of a rank. A request made in advance (`report.is_request_in_advance`) is
        answered immediately if enough items are left. Any other request is queued, unless the rank already
        has its next chunk from a request made in advance."""
        if report.is_request_in_advance:
            if (chunk := self.queue.next_chunk_in_advance(rank)) is not None:
                self.ranks.comm.send(chunk, dest=rank, tag=ANSWER_TAG)
                self.answered_in_advance.add(rank)
            return
        if report.stop_signal:  # the report may arrive before the rank's message with STOP_TAG
            self.stop.adopt_request_of_rank(report.stop_signal)
            self._pass_on_stop()
        self.positions.pop(rank, None)
        self.queue.add_report(rank, report)
        if rank in self.answered_in_advance:
            self.answered_in_advance.remove(rank)
        else:
            self.waiting_ranks.append(rank)

    def _serve_until_all_ranks_finish(self) -> None:
        """Body of the thread: answers messages of the other ranks until all of them have finished."""
        with self.ranks.abort_all_ranks_on_error():
            while self.working_ranks:
                self._handle_waiting_messages()
                # While this rank answers messages itself, the thread leaves it the processor.
                is_polled = time.monotonic() - self.last_served < POLL_SECONDS_IF_ANSWERED
                time.sleep(POLL_SECONDS_IF_ANSWERED if is_polled else POLL_SECONDS)


class ChunkClient:
    """Obtains chunks of work items for a rank other than the first, by messages to the first rank."""

    def __init__(self, ranks: Ranks, stop: StopRequest):
        self.comm = ranks.comm
        self.stop = stop
        self.stop_exchanged = False

    def next_chunk(self, report: RankReport) -> IndexRange:
        """The next chunk for this rank, given the `report` on its last chunk; NO_WORK_LEFT at the end. Waits
        for the answer of the first rank, and requests the following chunk in advance."""
        self.comm.send(report, dest=0, tag=REQUEST_TAG)
        # A blocking receive would spin and take the processor from the ranks that compute.
        wait_seconds = SHORTEST_CHUNK_POLL_SECONDS
        while not self.comm.Iprobe(source=0, tag=ANSWER_TAG):
            self.poll_messages()
            time.sleep(wait_seconds)
            wait_seconds = min(CHUNK_POLL_GROWTH * wait_seconds, LONGEST_CHUNK_POLL_SECONDS)
        chunk: IndexRange = self.comm.recv(source=0, tag=ANSWER_TAG)
        if chunk != NO_WORK_LEFT:
            self.comm.send(RankReport(is_request_in_advance=True), dest=0, tag=REQUEST_TAG)
        return chunk

    def report_position(self, position: SolvePosition) -> None:
        """Reports the progress of this rank in a point that takes long to the first rank."""
        self.comm.send(position, dest=0, tag=PROGRESS_TAG)

    def poll_messages(self) -> None:
        """Exchanges at most one stop request with the first rank: sends the request of this rank, or receives
        the request of the first rank."""
        if not self.stop_exchanged and self.comm.Iprobe(source=0, tag=STOP_TAG):
            self.stop.adopt_request_of_rank(self.comm.recv(source=0, tag=STOP_TAG))
            self.stop_exchanged = True
        if not self.stop_exchanged and self.stop:
            self.comm.send(self.stop.name, dest=0, tag=STOP_TAG)
            self.stop_exchanged = True
