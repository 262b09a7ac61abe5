"""Solver processes, one for each group of kinds of requests. A new request replaces the older request of the
same session and kind."""

import os
import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.context import ForkServerProcess
from typing import Any

from tornado.ioloop import IOLoop

from ..page_state import PageState
from . import worker
from .fork_server import FORK_SERVER, start_fork_server
from .requests import Reply, SolveRequest

RequestKey = tuple[str, str]
"""(session, kind) of a request; a session is a page in a browser tab. A new request replaces an older request
with an equal key."""
ReplyCallback = Callable[[Reply], None]
"""Function that is called with the reply to a request, or with a progress message."""


def ignore_progress(reply: Reply) -> None:
    """Callback for progress messages that are not shown; does nothing."""


PROCESS_GROUP_BY_KIND = {
    "spectrum": "spectrum", "thresholds": "thresholds", "growth": "thresholds", "cycle": "cycle",
    "branch": "branch", "diagram": "diagram", "bent": "spectrum", "motion": "cycle", "film": "film",
    "cycles": "diagram", "load": "spectrum",
}  # fmt: skip
"""Process group of each kind of request, chosen so that fast requests do not wait for slow requests."""
NICENESS_BY_GROUP = {"spectrum": 0, "cycle": 10, "thresholds": 12, "branch": 15, "diagram": 15, "film": 15}
"""Unix niceness of the solver process of each group. Only the group "spectrum" has the priority of the page
and the browser, so its pictures are drawn while other processes solve."""
INTERRUPT_RETRY_SECONDS = 0.1
"""Time after which a cancellation is repeated if the process was not yet ready, in seconds."""
WARM_UP_REQUEST_KINDS = ("spectrum", "cycle", "thresholds")
"""Kinds of requests that are solved once at the start of the server, to start their processes and to load
compiled code."""


@dataclass(frozen=True, kw_only=True)
class CancellationDelays:
    """Times, in seconds, until a superseded solve is cancelled, and until a process that does not react is
    killed.

    min_age_of_cancelled_solve: a solve of at least this age is cancelled when a newer request with the same
    key waits. Younger solves finish, so that pictures follow a moving slider.
    kill_after_cancellation_seconds: a process that has not replied within this time after a cancellation is
    killed, and restarted for the next request.
    """

    min_age_of_cancelled_solve: float = 0.3
    kill_after_cancellation_seconds: float = 1.5


class SolverProcess:
    """One solver process, and the queue of its requests. A request starts the process if it is not running.
    delays: times, in s, until a superseded solve is cancelled, and until a process that does not react to the
    cancellation is killed; None for the default times. niceness: Unix niceness of the process."""

    def __init__(self, delays: CancellationDelays | None = None, niceness: int = 0):
        self.delays = delays or CancellationDelays()
        self.niceness = niceness
        self.waiting: dict[RequestKey, tuple[SolveRequest, ReplyCallback, ReplyCallback]] = {}
        self.current_request: tuple[RequestKey, ReplyCallback, ReplyCallback] | None = None
        self.request_number = 0
        """Number of requests sent so far. A timer compares this number with the number at which the timer
        was set, and acts only if both are equal."""
        self.solve_start_time = 0.0
        self.start_count = 0
        self.is_ready = False
        """Whether the process has installed its signal handlers; before that, SIGINT would end it."""
        self._process: ForkServerProcess | None = None
        self._connection: Connection[Any, Any] | None = None
        self._lifetime_pipe: Connection[Any, Any] | None = None

    @property
    def pid(self) -> int | None:
        """Id of the operating system's process; None if no process is running."""
        return None if self._process is None else self._process.pid

    def ask(
        self,
        key: RequestKey,
        request: SolveRequest,
        on_reply: ReplyCallback,
        progress: ReplyCallback = ignore_progress,
    ) -> None:
        """Queues a request. An older request with the same key leaves the queue, or is cancelled when its
        solve is `min_age_of_cancelled_solve` old. on_reply, progress: get the reply, progress messages."""
        self.waiting.pop(key, None)
        self.waiting[key] = request, on_reply, progress
        if self.current_request is None:
            self._send_next()
        elif self.current_request[0] == key:
            age = time.monotonic() - self.solve_start_time
            number = self.request_number
            IOLoop.current().call_later(
                max(0.0, self.delays.min_age_of_cancelled_solve - age),
                lambda: self._cancel_superseded(number, key),
            )

    def cancel_session(self, session: str) -> None:
        """Removes all requests of a session from the queue, and cancels its running request."""
        for key in [key for key in self.waiting if key[0] == session]:
            del self.waiting[key]
        if self.current_request is not None and self.current_request[0][0] == session:
            self._interrupt(self.request_number)

    def cancel(self, key: RequestKey) -> None:
        """Removes the request with the given key from the queue, and cancels its solve if it has started."""
        self.waiting.pop(key, None)
        if self.current_request is not None and self.current_request[0] == key:
            self._interrupt(self.request_number)

    def close(self) -> None:
        """Ends the process and empties the queue."""
        self.waiting.clear()
        self._end_process()

    def start(self) -> None:
        """Starts the process if it is not running."""
        if self._process is not None:
            return
        start_fork_server()
        self._connection, far_end = FORK_SERVER.Pipe()
        lifetime_end, self._lifetime_pipe = FORK_SERVER.Pipe(duplex=False)
        self._process = FORK_SERVER.Process(
            target=worker.answer_requests, args=(far_end, lifetime_end, self.niceness), daemon=True
        )
        self._process.start()
        self.start_count += 1
        self.is_ready = False
        far_end.close()
        lifetime_end.close()
        IOLoop.current().add_handler(self._connection.fileno(), self._receive_replies, IOLoop.READ)

    def _send_next(self) -> None:
        if not self.waiting:
            return
        key = next(iter(self.waiting))
        request, on_reply, progress = self.waiting.pop(key)
        self.start()
        assert self._connection is not None
        self.current_request = (key, on_reply, progress)
        self.solve_start_time = time.monotonic()
        self.request_number += 1
        self._connection.send(request)

    def _receive_replies(self, descriptor: int, events: int) -> None:
        assert self._connection is not None
        try:
            reply: Reply = self._connection.recv()
        except (EOFError, OSError):
            self._end_process()
            reply = Reply("failed", {"sentence": "the solver ended unexpectedly"}, 0.0)
        if reply.outcome == "ready":
            self.is_ready = True
            return
        current = self.current_request
        if reply.outcome == "progress":
            if current is not None:
                current[2](reply)
            return
        self.current_request = None
        if current is not None and reply.outcome != "cancelled":
            current[1](reply)
        if self.current_request is None:
            self._send_next()

    def _cancel_superseded(self, number: int, key: RequestKey) -> None:
        """Cancels request `number` if it is still being solved and a newer request with its key waits."""
        if number == self.request_number and key in self.waiting:
            self._interrupt(number)

    def _interrupt(self, number: int) -> None:
        if self.current_request is None or number != self.request_number or self._process is None:
            return
        if not self.is_ready:
            IOLoop.current().call_later(INTERRUPT_RETRY_SECONDS, lambda: self._interrupt(number))
            return
        if self._process.is_alive() and self._process.pid is not None:
            os.kill(self._process.pid, signal.SIGINT)
        delay = self.delays.kill_after_cancellation_seconds
        IOLoop.current().call_later(delay, lambda: self._kill_if_solving(number))

    def _kill_if_solving(self, number: int) -> None:
        if self.current_request is None or number != self.request_number:
            return
        self._end_process()
        self.current_request = None
        self._send_next()

    def _end_process(self) -> None:
        if self._process is None or self._connection is None or self._lifetime_pipe is None:
            return
        IOLoop.current().remove_handler(self._connection.fileno())
        self._connection.close()
        self._lifetime_pipe.close()
        if self._process.is_alive():
            self._process.kill()
        self._process.join()
        self._process.close()
        self._process = self._connection = self._lifetime_pipe = None


class SolverProcesses:
    """Solver processes of all groups, shared by all pages of a server."""

    def __init__(self, delays: CancellationDelays | None = None):
        self.groups = {name: SolverProcess(delays, value) for name, value in NICENESS_BY_GROUP.items()}

    def warm_up(self) -> None:
        """Sends one request of each of the WARM_UP_REQUEST_KINDS, to start their processes and load compiled
        code."""
        for kind in WARM_UP_REQUEST_KINDS:
            self.ask("warm up", SolveRequest(kind, PageState()), lambda reply: None)

    def ask(
        self,
        session: str,
        request: SolveRequest,
        on_reply: ReplyCallback,
        progress: ReplyCallback = ignore_progress,
    ) -> None:
        """Queues a request of a session. on_reply, progress: called with the reply, and with each progress
        message."""
        self.groups[PROCESS_GROUP_BY_KIND[request.kind]].ask(
            (session, request.kind), request, on_reply, progress
        )

    def cancel(self, session: str, kind: str) -> None:
        """Cancels the request of the given kind in a session."""
        self.groups[PROCESS_GROUP_BY_KIND[kind]].cancel((session, kind))

    def cancel_session(self, session: str) -> None:
        """Cancels all requests of a session."""
        for solver in self.groups.values():
            solver.cancel_session(session)

    def close(self) -> None:
        """Ends all solver processes."""
        for solver in self.groups.values():
            solver.close()
