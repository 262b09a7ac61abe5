"""What hears where a long solve is: it passes messages on, tells the place, and ends it if asked to."""

import time
from collections.abc import Callable
from typing import Protocol

from ..watch import MakeWhereabouts, Stopped, Whereabouts
from .stop import StopRequest

LOOK_SECONDS = 0.05
"""Seconds between two looks at messages and requests to stop."""
PLACE_SECONDS = 0.5
"""Seconds after which a solve is long and its place is told, and between two such places."""


class Claims(Protocol):
    """How a rank talks to the others while it solves."""

    def between_points(self) -> None: ...

    def tell_place(self, place: Whereabouts) -> None: ...


class NoClaims:
    """The claims of a rank that solves while no other does; `shown` takes the place of a long solve."""

    def __init__(self, shown: Callable[[Whereabouts], object] | None = None):
        self.shown = shown

    def between_points(self) -> None: ...

    def tell_place(self, place: Whereabouts) -> None:
        """Shows where this rank is in a long point, where that is wanted."""
        if self.shown:
            self.shown(place)


class RankListener:
    """Hears the solves of a rank; one for each unit."""

    def __init__(self, claims: Claims, stop: StopRequest, name: Callable[[], str] = str):
        """name: of the unit, in words."""
        self.claims, self.stop, self.name = claims, stop, name
        self.looks, self.tells = 0.0, time.monotonic() + PLACE_SECONDS

    def __call__(self, place: MakeWhereabouts) -> None:
        """Hears a report; raises Stopped where the solve is to end here."""
        now = time.monotonic()
        if now >= self.tells and (here := place()).words:
            self.tells = now + PLACE_SECONDS
            self.claims.tell_place(
                Whereabouts(": ".join(filter(None, (self.name(), here.words))), here.share)
            )
        if now >= self.looks:
            self.looks = now + LOOK_SECONDS
            self.claims.between_points()
            if self.stop.is_due:
                raise Stopped
