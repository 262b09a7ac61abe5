"""Early stop of a run, requested by a scheduler's warning, a user's kill or Ctrl-C.

A run stops between two points; a point that is not finished GRACE_SECONDS after the request is abandoned. A
`SolverReportListener` exchanges messages during long solves, reports progress, and ends a solve after a stop
request.
"""

import os
import signal
import time
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import Protocol

from ..solve_progress import PositionMaker, SolvePosition, SolveStopped

POLL_SECONDS = 0.05
"""Seconds between two polls for messages and stop requests during a solve."""
SECONDS_BETWEEN_PROGRESS_REPORTS = 0.5
"""Seconds from the start of a solve to the first report of its progress, and between two reports."""
STOP_SIGNALS = (signal.SIGTERM, signal.SIGUSR1, signal.SIGINT)
"""Signals that request a stop: from `kill`, a scheduler's time limit or warning, or Ctrl-C."""
GRACE_SECONDS = 0.3
"""Time, in seconds, to finish the current point after a stop request. A longer point is abandoned and solved
again on resuming: a run has to end within two seconds, and Open MPI's launcher kills after one."""
STOPPING_MESSAGE = b"\nstopping: all points that are done are kept (Ctrl-\\ ends at once)\n"
"""Message printed at once on Ctrl-C."""


class StopRequest:
    """Stop request to this process; true after a stop signal. `name` is the name of the signal, empty before
    a signal. acknowledges: whether Ctrl-C is acknowledged on standard error. Under a launcher no rank
    acknowledges, because all ranks would."""

    def __init__(self, acknowledges: bool = False) -> None:
        self.name = ""
        self.acknowledges = acknowledges
        self._since = 0.0

    def __bool__(self) -> bool:
        return bool(self.name)

    @property
    def must_abandon_point(self) -> bool:
        """Whether the current point must be abandoned: GRACE_SECONDS have passed since this property was
        first read after a stop request."""
        if not self.name:
            return False
        # The clock starts at the first reading: the request of another rank comes without a signal.
        self._since = self._since or time.monotonic()
        return time.monotonic() - self._since >= GRACE_SECONDS

    def listen_for_signals(self) -> None:
        """Installs handlers, so that stop signals set this request instead of ending the process; main thread
        only."""
        for signal_number in STOP_SIGNALS:
            signal.signal(signal_number, self._record_signal_name)

    @staticmethod
    def ignore_signals() -> None:
        """Makes the process ignore stop signals, even while Python and MPI shut down; main thread only."""
        for signal_number in STOP_SIGNALS:
            # A second signal would otherwise end the process with a traceback after all results are stored.
            signal.signal(signal_number, signal.SIG_IGN)

    def adopt_request_of_rank(self, name: str) -> None:
        """Adopts the stop request of another rank; name: name of the signal."""
        self.name = name

    def _record_signal_name(self, signal_number: int, _: FrameType | None) -> None:
        if signal_number == signal.SIGINT and self.acknowledges and not self.name:
            with suppress(OSError):
                os.write(2, STOPPING_MESSAGE)  # print is not safe in a signal handler
        # A handler must not touch files or MPI, which may be in the middle of a call.
        self.name = signal.Signals(signal_number).name


class RankCommunication(Protocol):
    """Communication of a rank with other ranks during a solve and between points."""

    def poll_messages(self) -> None: ...

    def report_position(self, position: SolvePosition) -> None: ...


class SingleRankCommunication:
    """`RankCommunication` of a run with a single rank; `show_position` gets the progress of a long solve."""

    def __init__(self, show_position: Callable[[SolvePosition], object] | None = None):
        self.show_position = show_position

    def poll_messages(self) -> None: ...

    def report_position(self, position: SolvePosition) -> None:
        """Passes the progress within a long point to `show_position`, if given."""
        if self.show_position:
            self.show_position(position)


class SolverReportListener:
    """Listens to the reports of a solver on a rank: polls MPI messages, forwards the progress, and ends the
    solve after a stop request. A new listener is created for every point or other work item of the sweep."""

    def __init__(
        self, communication: RankCommunication, stop: StopRequest, item_label: Callable[[], str] = str
    ):
        """item_label: function that returns a text for the solved work item, which precedes the solver's
        progress text."""
        self.communication = communication
        self.stop = stop
        self.item_label = item_label
        self.next_poll = 0.0
        self.next_report = time.monotonic() + SECONDS_BETWEEN_PROGRESS_REPORTS

    def __call__(self, make_position: PositionMaker) -> None:
        """Handles a solver's report at `make_position()`; raises SolveStopped if the solve must end."""
        now = time.monotonic()
        # The text is made only when it is due, as solvers report thousands of times a second.
        if now >= self.next_report and (position := make_position()).text:
            self.next_report = now + SECONDS_BETWEEN_PROGRESS_REPORTS
            self.communication.report_position(
                SolvePosition(
                    ": ".join(filter(None, (self.item_label(), position.text))), position.completed_fraction
                )
            )
        # A poll is an MPI call, too slow for every iteration of a solver.
        if now >= self.next_poll:
            self.next_poll = now + POLL_SECONDS
            self.communication.poll_messages()
            if self.stop.must_abandon_point:
                raise SolveStopped
