"""How ranks claim their chunks: the first from its handout, the others from the first by messages.

The first rank computes like any other; a thread of it answers the requests of the others, so they
need not wait for its own solve to end. A solve may keep the thread waiting, so ranks ask for their next
chunk when they begin one, and get it while plenty is left. A rank that is asked to stop tells the first,
which tells all: each ends with the point that it is at.
"""

import threading
import time
from collections import deque
from collections.abc import Callable

from ..watch import Whereabouts
from .handout import OVER, Handout, Report
from .points.ranges import IndexRange
from .stop import StopRequest
from .team import Team

REQUEST_TAG, ANSWER_TAG, STOP_TAG, PLACE_TAG = 71, 72, 73, 74
POLL_SECONDS, RELIEVED_POLL_SECONDS = 2e-3, 5e-3
"""How long the thread sleeps: each waking takes the first rank 20 microseconds or more of its solve. Longer
where that rank itself answers between its points."""
ASK_SECONDS, LONGEST_ASK_SECONDS = 1e-4, 1e-2
"""Seconds between two looks of a rank that waits for its next chunk, at first and after a while: what idles
must not take the processor from what solves."""
ASK_GROWTH = 1.1
"""Ratio of a pause between looks to the one before: a wait of a millisecond costs a few looks."""
WAIT_SECONDS = 0.05
"""Seconds for which the first rank waits for a change before it looks at its mail itself."""


class FirstRankClaims:
    """How the first rank gets its chunks, and how its thread serves the others."""

    def __init__(
        self,
        team: Team,
        handout: Handout,
        stop: StopRequest,
        show: Callable[[str, float], None],
    ):
        """show: takes where a rank is in a long point, in words, and how much of all long points is done."""
        self.team, self.handout, self.stop, self.show = team, handout, stop, show
        self.waiting: deque[int] = deque()
        self.ahead: set[int] = set()
        """Ranks that have an answer to their next request already."""
        self.working = set(range(1, team.size))
        self.status = team.MPI.Status()
        self.places: dict[int, Whereabouts] = {}
        """Where each rank is in a long point, as it has said last."""
        self.serving = threading.Lock()
        self.served = 0.0
        self.thread: threading.Thread | None = None
        if team.size > 1:
            self.thread = threading.Thread(target=self._serve_until_over, name="handout", daemon=True)
            self.thread.start()

    def claim(self, report: Report) -> IndexRange:
        with self.serving:
            self._heed_stop()
        self.places.pop(0, None)
        self.handout.settle(0, report)
        self.between_points()
        while (chunk := self.handout.take(0)) is None:
            with self.handout.change:
                self.handout.change.wait(WAIT_SECONDS)
            self.between_points()
            for place in list(self.places.values())[:1]:
                self.show(place.words, self._begun())
        return chunk

    def close(self) -> None:
        if self.thread is not None:
            self.thread.join()
            self._hear_places()

    def tell_place(self, place: Whereabouts) -> None:
        """Where this rank is in a long point."""
        self.places[0] = place
        self.show(place.words, self._begun())

    def _begun(self) -> float:
        """How much is done of the long points that are being solved, in points."""
        return sum(place.share or 0.0 for place in list(self.places.values()))

    def between_points(self) -> None:
        """Answers what other ranks ask; while a long point is solved, the thread does.

        The thread alone would not do: a solve inside PETSc keeps Python's lock, and the thread might
        get it only once a point for each of its steps.
        """
        if self.thread is not None:
            self._serve()
            self.served = time.monotonic()
        else:
            self._heed_stop()

    def _heed_stop(self) -> None:
        """Once this rank has been asked to stop, nothing more is handed out, and all are told."""
        if self.stop and not self.handout.stopped:
            self.handout.stop()
            for rank in self.working:
                self.team.comm.send(self.stop.name, dest=rank, tag=STOP_TAG)

    def _serve(self) -> None:
        comm, MPI = self.team.comm, self.team.MPI
        with self.serving:
            while comm.Iprobe(source=MPI.ANY_SOURCE, tag=STOP_TAG, status=self.status):
                self.stop.take(comm.recv(source=self.status.Get_source(), tag=STOP_TAG))
            self._heed_stop()
            self._hear_places()
            while comm.Iprobe(source=MPI.ANY_SOURCE, tag=REQUEST_TAG, status=self.status):
                rank = self.status.Get_source()
                self._hear(rank, comm.recv(source=rank, tag=REQUEST_TAG))
            while self.waiting and (chunk := self.handout.take(self.waiting[0])) is not None:
                rank = self.waiting.popleft()
                comm.send(chunk, dest=rank, tag=ANSWER_TAG)
                if chunk == OVER:
                    self.working.discard(rank)

    def _hear_places(self) -> None:
        comm, MPI = self.team.comm, self.team.MPI
        while comm.Iprobe(source=MPI.ANY_SOURCE, tag=PLACE_TAG, status=self.status):
            rank = self.status.Get_source()
            self.places[rank] = comm.recv(source=rank, tag=PLACE_TAG)

    def _hear(self, rank: int, report: Report) -> None:
        """A report: its rank waits for an answer unless it has it; one to a request ahead is sent at once."""
        if report.ahead:
            if (chunk := self.handout.take_ahead(rank)) is not None:
                self.team.comm.send(chunk, dest=rank, tag=ANSWER_TAG)
                self.ahead.add(rank)
            return
        if report.stop:  # which may come before the message that says so
            self.stop.take(report.stop)
            self._heed_stop()
        self.places.pop(rank, None)
        self.handout.settle(rank, report)
        if rank in self.ahead:
            self.ahead.remove(rank)
        else:
            self.waiting.append(rank)

    def _serve_until_over(self) -> None:
        with self.team.together():
            while self.working:
                self._serve()
                answering = time.monotonic() - self.served < RELIEVED_POLL_SECONDS
                time.sleep(RELIEVED_POLL_SECONDS if answering else POLL_SECONDS)


class OtherRankClaims:
    """How every other rank gets its chunks: by asking the first."""

    def __init__(self, team: Team, stop: StopRequest):
        self.comm, self.stop, self.told = team.comm, stop, False

    def claim(self, report: Report) -> IndexRange:
        self.comm.send(report, dest=0, tag=REQUEST_TAG)
        # A blocking receive would spin and take the processor from the ranks that compute.
        pause = ASK_SECONDS
        while not self.comm.Iprobe(source=0, tag=ANSWER_TAG):
            self.between_points()
            time.sleep(pause)
            pause = min(ASK_GROWTH * pause, LONGEST_ASK_SECONDS)
        chunk: IndexRange = self.comm.recv(source=0, tag=ANSWER_TAG)
        if chunk != OVER:
            self.comm.send(Report(ahead=True), dest=0, tag=REQUEST_TAG)
        return chunk

    def tell_place(self, place: Whereabouts) -> None:
        """Where this rank is in a long point."""
        self.comm.send(place, dest=0, tag=PLACE_TAG)

    def between_points(self) -> None:
        """Passes a request to stop on to the first rank, or learns of it from there."""
        if not self.told and self.comm.Iprobe(source=0, tag=STOP_TAG):
            self.stop.take(self.comm.recv(source=0, tag=STOP_TAG))
            self.told = True
        if not self.told and self.stop:
            self.comm.send(self.stop.name, dest=0, tag=STOP_TAG)
            self.told = True
