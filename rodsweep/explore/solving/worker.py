"""The process of one solver: it reads questions from a pipe, and writes replies to it.

SIGINT cancels the question that is being answered. The process ends when its pipe closes, and in the middle
of a solve when the process of the page ends: only that process held the other end of the second pipe.
"""

import os
import signal
import sys
import time
import traceback
from multiprocessing.connection import Connection
from threading import Thread
from types import FrameType

from ...errors import Refusal
from .questions import Question, Reply, answer_to

IMPORTED_AGAIN = 0.05
"""Seconds after which a cancellation that came during an import is tried again."""


class Cancellation:
    """Handler of SIGINT that interrupts a solve, and nothing else of this process.

    A module that is being imported is left to finish: half imported, it would stay broken. SIGALRM then calls
    the handler again.
    """

    def __init__(self) -> None:
        self.is_solving = False
        self.is_due = False
        """Whether the question that is being solved was cancelled."""

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if not self.is_solving:
            return
        self.is_due = True
        if is_importing(frame):
            signal.setitimer(signal.ITIMER_REAL, IMPORTED_AGAIN)
            return
        self.is_solving = False
        raise KeyboardInterrupt


def is_importing(frame: FrameType | None) -> bool:
    """Whether a module is being imported at a place of the program."""
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def reply_to(question: Question, cancellation: Cancellation) -> Reply:
    """The reply to one question. A bug is printed on standard error and replied as "failed"."""
    started = time.perf_counter()
    cancellation.is_due = False
    try:
        try:
            cancellation.is_solving = True
            outcome, content = "answer", answer_to(question)
        finally:
            cancellation.is_solving = False
            signal.setitimer(signal.ITIMER_REAL, 0)  # or it would cancel the next question
    except KeyboardInterrupt:
        outcome, content = "cancelled", {}
    except Refusal as error:
        outcome, content = "refused", {"sentence": str(error)}
    except Exception as error:
        if cancellation.is_due:  # a library made another exception of the interrupt
            outcome, content = "cancelled", {}
        else:  # a bug: the page says it, and the next question is answered
            traceback.print_exc()
            outcome, content = "failed", {"sentence": f"this is a bug of rodsweep: {error!r}"}
    return Reply(outcome, content, time.perf_counter() - started)


def end_with_parent(descriptor: int) -> None:
    """Ends this process as soon as a pipe closes into which nobody writes."""
    os.read(descriptor, 1)
    os._exit(0)


def main() -> None:
    """Arguments: descriptors of the pipe of questions, and of that which closes with the parent; niceness."""
    questions, life, niceness = (int(word) for word in sys.argv[1:4])
    os.nice(niceness)
    connection: Connection[Reply, Question] = Connection(questions)
    Thread(target=end_with_parent, args=(life,), daemon=True).start()
    cancellation = Cancellation()
    for number in (signal.SIGINT, signal.SIGALRM):
        signal.signal(number, cancellation)
    connection.send(Reply("ready", {}, 0.0))
    while True:
        try:
            question = connection.recv()
        except EOFError:
            return
        connection.send(reply_to(question, cancellation))


if __name__ == "__main__":
    main()
