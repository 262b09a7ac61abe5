"""A request to stop early, by a scheduler's warning, a user's kill or Ctrl-C.

It is heeded between two points, and within a point that goes on for longer than `GRACE` seconds.
"""

import os
import signal
import time
from contextlib import suppress
from types import FrameType

STOP_SIGNALS = (signal.SIGTERM, signal.SIGUSR1, signal.SIGINT)
"""Signals that ask for a stop: `kill` or a scheduler's end, a scheduler's warning, and Ctrl-C."""
GRACE = 0.3
"""Seconds that a point may still take after a stop request. A point that needs longer is given up and
computed again on resuming: a run is to end within two seconds, and Open MPI's launcher kills after one."""
HEARD_CTRL_C = b"\nstopping: all points that are done are kept (Ctrl-\\ ends at once)\n"
"""Message printed at once on Ctrl-C."""


class StopRequest:
    """Whether this process has been asked to stop, and by which signal.

    speaks: whether it answers Ctrl-C on standard error; ranks of a launcher would all do so.
    """

    def __init__(self, speaks: bool = False) -> None:
        self.name, self.speaks = "", speaks
        self._since = 0.0

    def __bool__(self) -> bool:
        return bool(self.name)

    @property
    def is_due(self) -> bool:
        """Whether the grace time is over, so that the current point has to be given up unfinished."""
        if not self.name:
            return False
        self._since = self._since or time.monotonic()
        return time.monotonic() - self._since >= GRACE

    def listen(self) -> None:
        """Record the stop signals instead of ending the process. Only the main thread may call it."""
        for number in STOP_SIGNALS:
            signal.signal(number, self._note)

    @staticmethod
    def ignore() -> None:
        """Ignore the stop signals, also while Python and MPI end. Only for the main thread."""
        for number in STOP_SIGNALS:
            signal.signal(number, signal.SIG_IGN)

    def take(self, name: str) -> None:
        """Takes over a request that another rank has had, by the name of its signal."""
        self.name = name

    def _note(self, number: int, _: FrameType | None) -> None:
        if number == signal.SIGINT and self.speaks and not self.name:
            with suppress(OSError):
                os.write(2, HEARD_CTRL_C)  # print is not for signal handlers
        self.name = signal.Signals(number).name
