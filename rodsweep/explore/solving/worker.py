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


class Cancellation:
    """Handler of SIGINT that interrupts a solve, and nothing else of this process."""

    def __init__(self) -> None:
        self.is_solving = False

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if self.is_solving:
            self.is_solving = False
            raise KeyboardInterrupt


def reply_to(question: Question, cancellation: Cancellation) -> Reply:
    """The reply to one question. A bug is printed on standard error and replied as "failed"."""
    started = time.perf_counter()
    try:
        try:
            cancellation.is_solving = True
            outcome, content = "answer", answer_to(question)
        finally:
            cancellation.is_solving = False
    except KeyboardInterrupt:
        outcome, content = "cancelled", {"sentence": "cancelled"}
    except Refusal as error:
        outcome, content = "refused", {"sentence": str(error)}
    except Exception as error:  # a bug: the page says it, and the next question is answered
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
    signal.signal(signal.SIGINT, cancellation)
    while True:
        try:
            question = connection.recv()
        except EOFError:
            return
        connection.send(reply_to(question, cancellation))


if __name__ == "__main__":
    main()
