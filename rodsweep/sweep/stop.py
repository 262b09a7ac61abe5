"""A request to stop early, which a scheduler's warning or a user's kill makes, heeded between two points."""

import signal
from types import FrameType

STOP_SIGNALS = (signal.SIGTERM, signal.SIGUSR1)
"""What asks for a stop: what `kill` and a scheduler's end send, and what schedulers warn with."""


class StopRequest:
    """Whether this process has been asked to stop, and by which signal."""

    def __init__(self) -> None:
        self.name = ""

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
        self.name = signal.Signals(number).name
