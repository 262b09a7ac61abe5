"""Main loop of a solver process, which reads questions from a pipe and writes replies to it.

SIGINT cancels the question being solved. The process ends when the pipe closes. Only the page's process holds
the other end of a second pipe, so the solver process ends with it, even during a solve.
"""

import os
import signal
import time
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from threading import Thread
from types import FrameType
from typing import Any

from ...errors import Refusal
from ...sweep.stop import NoClaims, RankListener, StopRequest
from ...watch import SolvePosition, reporting_to
from .questions import Question, Reply, answer_to

CANCELLATION_RETRY = 0.05
"""Time, in seconds, after which a cancellation is repeated that arrived during an import, or while a progress
message was sent."""


class Cancellation:
    """Handler of SIGINT that raises KeyboardInterrupt only during a solve.

    It waits for the end of an import, because a module imported in part would stay broken, and of sending a
    progress message, because the page could not read half a message. SIGALRM then calls the handler again.
    """

    def __init__(self) -> None:
        self.is_solving = False
        self.is_sending = False
        self.is_due = False
        """Whether the question being solved was cancelled."""

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if not self.is_solving:
            return
        self.is_due = True
        if self.is_sending or is_importing(frame):
            signal.setitimer(signal.ITIMER_REAL, CANCELLATION_RETRY)
            return
        self.is_solving = False
        raise KeyboardInterrupt


def is_importing(frame: FrameType | None) -> bool:
    """Whether the call stack above `frame` contains an import of a module."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def reply_to(question: Question, cancellation: Cancellation, send: Callable[[Reply], None]) -> Reply:
    """Reply to one question. An unexpected exception gives the outcome "failed", and is printed on standard
    error.

    send: called with replies of the outcome "progress" during a long solve.
    """

    def send_progress(place: SolvePosition) -> None:
        cancellation.is_sending = True
        try:
            send(Reply("progress", place._asdict(), time.perf_counter() - started))
        finally:
            cancellation.is_sending = False

    started = time.perf_counter()
    cancellation.is_due = False
    try:
        try:
            cancellation.is_solving = True
            outcome = "answer"
            with reporting_to(RankListener(NoClaims(send_progress), StopRequest())):
                content = answer_to(question)
        finally:
            cancellation.is_solving = False
            signal.setitimer(signal.ITIMER_REAL, 0)  # a pending alarm would cancel the next question
    except KeyboardInterrupt:
        outcome = "cancelled"
        content = {}
    except Refusal as error:
        outcome = "refused"
        content = {"sentence": str(error)}
    except Exception as error:
        if cancellation.is_due:  # a library converted the interrupt to another exception
            outcome = "cancelled"
            content = {}
        else:  # a bug: the page shows a sentence, and the process lives on
            traceback.print_exc()
            outcome = "failed"
            content = {"sentence": f"this is a bug of rodsweep: {error!r}"}
    return Reply(outcome, content, time.perf_counter() - started)


def end_with_page(life: "Connection[Any, Any]") -> None:
    """Ends this process when the other end of the pipe `life` closes. Nothing is ever written to
    this pipe.
    """
    life.poll(None)
    os._exit(0)


def run(connection: "Connection[Reply, Question]", life: "Connection[Any, Any]", niceness: int) -> None:
    """Answers the questions from a pipe until it closes. life: pipe that closes when the page's
    process ends.
    """
    os.setpgid(0, 0)  # out of reach of Ctrl-C, which ends the page; a session of its own would undo niceness
    os.nice(niceness)
    Thread(target=end_with_page, args=(life,), daemon=True).start()
    cancellation = Cancellation()
    for number in (signal.SIGINT, signal.SIGALRM):
        signal.signal(number, cancellation)
    connection.send(Reply("ready", {}, 0.0))
    while True:
        try:
            question = connection.recv()
        except EOFError:
            return
        connection.send(reply_to(question, cancellation, connection.send))
