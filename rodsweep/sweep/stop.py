"""A request to stop early, by a scheduler's warning, a user's kill or Ctrl-C, heeded between two points."""

import os
import signal
from contextlib import suppress
from types import FrameType

STOP_SIGNALS = (signal.SIGTERM, signal.SIGUSR1, signal.SIGINT)
"""What asks for a stop: what `kill` and a scheduler's end send, what schedulers warn with, and Ctrl-C."""
HEARD_CTRL_C = b"\nstopping with the point in hand, all is kept (Ctrl-\\ ends at once and loses that point)\n"
"""What is said at once, where a point may take its time."""


class StopRequest:
    """Whether this process has been asked to stop, and by which signal.

    speaks: whether it answers Ctrl-C on standard error; ranks of a launcher would all do so.
    """

    def __init__(self, speaks: bool = False) -> None:
        self.name, self.speaks = "", speaks

    def __bool__(self) -> bool:
        return bool(self.name)

    def listen(self) -> None:
        """From here on the signals no longer end the process. Only the main thread may call it."""
        for number in STOP_SIGNALS:
            signal.signal(number, self._note)

    @staticmethod
    def ignore() -> None:
        """From here on the signals do nothing, also while Python and MPI end. Only for the main thread."""
        for number in STOP_SIGNALS:
            signal.signal(number, signal.SIG_IGN)

    def _note(self, number: int, _: FrameType | None) -> None:
        if number == signal.SIGINT and self.speaks and not self.name:
            with suppress(OSError):
                os.write(2, HEARD_CTRL_C)  # print is not for signal handlers
        self.name = signal.Signals(number).name
