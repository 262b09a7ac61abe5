"""The solvers of a page: one process for each kind of question, of which the newest is answered."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from typing import Any

from tornado.ioloop import IOLoop

from ..state import PageState
from .questions import Question, Reply

Key = tuple[str, str]
"""(session, kind): a new question replaces an older one of the same key."""
Done = Callable[[Reply], None]
GROUPS = {
    "spectrum": "spectrum", "thresholds": "thresholds", "growth": "thresholds", "cycle": "cycle",
    "branch": "branch", "diagram": "diagram", "bent": "spectrum", "motion": "cycle", "film": "film",
    "cycles": "diagram",
}  # fmt: skip
"""The process that answers each kind: what follows a slider never waits for what takes seconds."""
NICENESS = {"spectrum": 0, "cycle": 3, "thresholds": 5, "branch": 10, "diagram": 10, "film": 10}
"""How much the process of each group steps back for others: pictures that follow a slider come first."""
STARTED_AGAIN = 0.1
"""Seconds after which a cancellation that came while the process starts is tried again."""
AT_ONCE = ("spectrum", "cycle", "thresholds")
"""Groups whose processes start, and compile, before the page is opened."""


@dataclass(frozen=True, kw_only=True)
class Patience:
    """How long a solver may take, in seconds, when a newer question waits.

    interrupt: age at which the old question is cancelled. A question that is answered faster is worth its
    answer: pictures then follow a slider that never rests. kill: time after which a solver that was cancelled
    and does not answer is killed, and another is started.
    """

    interrupt: float = 0.3
    kill: float = 1.5


class SolverProcess:
    """One process, which is started when it is first asked, and again when it was killed."""

    def __init__(self, patience: Patience | None = None, niceness: int = 0):
        self.patience, self.niceness = patience or Patience(), niceness
        self.waiting: dict[Key, tuple[Question, Done]] = {}
        self.asked: tuple[Key, Done] | None = None
        self.number = 0
        """Number of questions asked so far; tells whether a timer still concerns the question asked."""
        self.since = 0.0
        self.starts = 0
        self.is_ready = False
        """Whether the process has started; before, a signal would end it."""
        self._process: subprocess.Popen[bytes] | None = None
        self._connection: Connection[Any, Any] | None = None
        self._life = -1

    @property
    def pid(self) -> int | None:
        """Process id, None if no process runs."""
        return None if self._process is None else self._process.pid

    def ask(self, key: Key, question: Question, done: Done) -> None:
        """Answers a question when the solver is free; an older question of the same key is dropped."""
        self.waiting.pop(key, None)
        self.waiting[key] = question, done
        if self.asked is None:
            self._send_next()
        elif self.asked[0] == key:
            age = time.monotonic() - self.since
            number = self.number
            IOLoop.current().call_later(
                max(0.0, self.patience.interrupt - age), lambda: self._cancel(number, key)
            )

    def forget(self, session: str) -> None:
        """Drops all questions of a session that ended."""
        for key in [key for key in self.waiting if key[0] == session]:
            del self.waiting[key]
        if self.asked is not None and self.asked[0][0] == session:
            self._interrupt(self.number)

    def drop(self, key: Key) -> None:
        """Cancels the questions of a key."""
        self.waiting.pop(key, None)
        if self.asked is not None and self.asked[0] == key:
            self._interrupt(self.number)

    def close(self) -> None:
        """Ends the process."""
        self.waiting.clear()
        self._end()

    def start(self) -> None:
        """Starts the process, if none runs."""
        if self._process is not None:
            return
        self._connection, theirs = Pipe()
        watched, self._life = os.pipe()
        words = [sys.executable, "-m", f"{__package__}.worker", str(theirs.fileno()), str(watched)]
        words.append(str(self.niceness))
        self._process = subprocess.Popen(
            words, stdin=subprocess.DEVNULL, pass_fds=(theirs.fileno(), watched), start_new_session=True
        )
        self.starts += 1
        self.is_ready = False
        theirs.close()
        os.close(watched)
        IOLoop.current().add_handler(self._connection.fileno(), self._hear, IOLoop.READ)

    def _send_next(self) -> None:
        if not self.waiting:
            return
        key = next(iter(self.waiting))
        question, done = self.waiting.pop(key)
        self.start()
        assert self._connection is not None
        self.asked, self.since = (key, done), time.monotonic()
        self.number += 1
        self._connection.send(question)

    def _hear(self, descriptor: int, events: int) -> None:
        assert self._connection is not None
        try:
            reply: Reply = self._connection.recv()
        except (EOFError, OSError):
            self._end()
            reply = Reply("failed", {"sentence": "the solver ended unexpectedly"}, 0.0)
        if reply.outcome == "ready":
            self.is_ready = True
            return
        asked, self.asked = self.asked, None
        if asked is not None and reply.outcome != "cancelled":
            asked[1](reply)
        if self.asked is None:
            self._send_next()

    def _cancel(self, number: int, key: Key) -> None:
        """Cancels question `number` if it is still being solved and a newer one of its key waits."""
        if number == self.number and key in self.waiting:
            self._interrupt(number)

    def _interrupt(self, number: int) -> None:
        if self.asked is None or number != self.number or self._process is None:
            return
        if not self.is_ready:
            IOLoop.current().call_later(STARTED_AGAIN, lambda: self._interrupt(number))
            return
        self._process.send_signal(signal.SIGINT)
        IOLoop.current().call_later(self.patience.kill, lambda: self._kill(number))

    def _kill(self, number: int) -> None:
        if self.asked is None or number != self.number:
            return
        self._end()
        self.asked = None
        self._send_next()

    def _end(self) -> None:
        if self._process is None or self._connection is None:
            return
        IOLoop.current().remove_handler(self._connection.fileno())
        self._connection.close()
        os.close(self._life)
        self._process.kill()
        self._process.wait()
        self._process = self._connection = None


class Solvers:
    """The solvers of all pages of a server."""

    def __init__(self, patience: Patience | None = None):
        self.groups = {group: SolverProcess(patience, niceness) for group, niceness in NICENESS.items()}

    def warm_up(self) -> None:
        """Starts the processes of `AT_ONCE` and lets them solve once, which loads compiled code."""
        for kind in AT_ONCE:
            self.ask("warm up", Question(kind, PageState()), lambda reply: None)

    def ask(self, session: str, question: Question, done: Done) -> None:
        """Answers a question of a session."""
        self.groups[GROUPS[question.kind]].ask((session, question.kind), question, done)

    def drop(self, session: str, kind: str) -> None:
        """Cancels a session's question of a kind."""
        self.groups[GROUPS[kind]].drop((session, kind))

    def forget(self, session: str) -> None:
        """Drops all questions of a session."""
        for solver in self.groups.values():
            solver.forget(session)

    def close(self) -> None:
        """Ends all processes."""
        for solver in self.groups.values():
            solver.close()
