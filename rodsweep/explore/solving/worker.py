"""Main loop of a solver process, which reads requests from a pipe and writes replies to the same pipe.

SIGINT cancels the request being solved. The process ends when the pipe closes. The solver process also
watches a second pipe, whose other end only the page's process holds; it therefore ends with the page, even
during a solve.
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

from ...errors import UserError
from ...solve_progress import SolvePosition, reporting_to
from ...sweep.stop import SingleRankCommunication, SolverReportListener, StopRequest
from .requests import Reply, SolveRequest, answer_to

CANCELLATION_RETRY_SECONDS = 0.05
"""A cancellation that arrives during an import, or while a progress message is sent, is repeated after this
time, in seconds."""


class CancellationHandler:
    """Handler of SIGINT that raises KeyboardInterrupt only during a solve.

    During an import or while a progress message is sent, SIGALRM calls the handler again later: a partly
    imported module would stay broken, and the page could not read half a message.
    """

    def __init__(self) -> None:
        self.is_solving = False
        self.is_sending_progress = False
        self.is_due = False
        """Whether the request being solved was cancelled."""

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if not self.is_solving:
            return
        self.is_due = True
        if self.is_sending_progress or is_importing(frame):
            signal.setitimer(signal.ITIMER_REAL, CANCELLATION_RETRY_SECONDS)
            return
        self.is_solving = False
        raise KeyboardInterrupt


def is_importing(frame: FrameType | None) -> bool:
    """Whether `frame` or one of its callers is importing a module."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def reply_to(
    request: SolveRequest, cancellation: CancellationHandler, send: Callable[[Reply], None]
) -> Reply:
    """Solves a request and returns the reply. An unexpected exception gives the outcome "failed", and its
    traceback is printed to standard error.

    cancellation: handler of SIGINT. send: called with replies of the outcome "progress" during a long solve.
    """

    def send_progress(position: SolvePosition) -> None:
        cancellation.is_sending_progress = True
        try:
            send(Reply("progress", position._asdict(), time.perf_counter() - start))
        finally:
            cancellation.is_sending_progress = False

    start = time.perf_counter()
    cancellation.is_due = False
    try:
        try:
            cancellation.is_solving = True
            outcome = "answer"
            with reporting_to(SolverReportListener(SingleRankCommunication(send_progress), StopRequest())):
                content = answer_to(request)
        finally:
            cancellation.is_solving = False
            signal.setitimer(signal.ITIMER_REAL, 0)  # a pending alarm would cancel the next request
    except KeyboardInterrupt:
        outcome = "cancelled"
        content = {}
    except UserError as error:
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
    return Reply(outcome, content, time.perf_counter() - start)


def exit_when_pipe_closes(page_pipe: "Connection[Any, Any]") -> None:
    """Waits until the other end of the pipe `page_pipe` closes, then ends this process. No data are written
    to `page_pipe`."""
    page_pipe.poll(None)
    os._exit(0)


def answer_requests(
    connection: "Connection[Reply, SolveRequest]", page_pipe: "Connection[Any, Any]", niceness: int
) -> None:
    """Answers the requests from the pipe `connection` until the pipe closes. page_pipe: pipe that closes when
    the page's process ends. niceness: increment of the Unix niceness."""
    os.setpgid(0, 0)  # protects from Ctrl-C, which ends the page; a separate session would undo the niceness
    os.nice(niceness)
    Thread(target=exit_when_pipe_closes, args=(page_pipe,), daemon=True).start()
    cancellation = CancellationHandler()
    for number in (signal.SIGINT, signal.SIGALRM):
        signal.signal(number, cancellation)

    def send(reply: Reply) -> None:
        try:
            connection.send(reply)
        except OSError:  # the page has ended
            os._exit(0)

    send(Reply("ready", {}, 0.0))
    while True:
        try:
            request = connection.recv()
        except (EOFError, OSError):  # the page has ended, perhaps before it read the last reply
            return
        send(reply_to(request, cancellation, send))
