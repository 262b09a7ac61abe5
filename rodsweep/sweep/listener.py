"""Listener of long solves: exchanges messages, reports progress, and ends a solve after a stop request."""

import time
from collections.abc import Callable
from typing import Protocol

from ..watch import MakePosition, SolvePosition, Stopped
from .stop import StopRequest

POLL_SECONDS = 0.05
"""Seconds between two polls for messages and stop requests during a solve."""
PLACE_SECONDS = 0.5
"""Seconds after which a solve counts as long and progress is reported, and between two reports."""


class Claims(Protocol):
    """Communication between ranks during a solve."""

    def between_points(self) -> None: ...

    def report_place(self, place: SolvePosition) -> None: ...


class NoClaims:
    """Claims of a lone rank; `shown` receives the progress of a long solve."""

    def __init__(self, shown: Callable[[SolvePosition], object] | None = None):
        self.shown = shown

    def between_points(self) -> None: ...

    def report_place(self, place: SolvePosition) -> None:
        """Shows the progress within a long point if `shown` is given."""
        if self.shown:
            self.shown(place)


class RankListener:
    """Listener of the solves of a rank; every unit gets a new listener."""

    def __init__(self, claims: Claims, stop: StopRequest, name: Callable[[], str] = str):
        """name: describes the unit in words."""
        self.claims = claims
        self.stop = stop
        self.name = name
        self.next_poll = 0.0
        self.next_report = time.monotonic() + PLACE_SECONDS

    def __call__(self, place: MakePosition) -> None:
        """Receives a report of a solver; raises Stopped if the solve has to end here."""
        now = time.monotonic()
        if now >= self.next_report and (here := place()).words:
            self.next_report = now + PLACE_SECONDS
            self.claims.report_place(
                SolvePosition(": ".join(filter(None, (self.name(), here.words))), here.share)
            )
        if now >= self.next_poll:
            self.next_poll = now + POLL_SECONDS
            self.claims.between_points()
            if self.stop.is_due:
                raise Stopped
