"""The loop that every rank runs: claim a chunk, solve its units, keep the points, give back what is left."""

import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ..watch import Stopped, heard_by
from .claims import FirstRankClaims, OtherRankClaims
from .handout import GIVE_BACK_AFTER, OVER, Handout, Report, chunk_seconds
from .listener import RankListener
from .points.ranges import IndexRange
from .stop import StopRequest
from .team import Team

Indices = int | NDArray[np.int64]
"""The index of a point, or those of points that are kept together, shape (n,)."""


class Solve(Protocol):
    """From a unit to its points, each an index and a result, one after another.

    A unit is a point or a chain of them, or a stretch, whose points come all at once.
    """

    def __call__(self, unit: int, /) -> Iterable[tuple[Indices, Any]]: ...


class ProgressSink(Protocol):
    """What shows the first rank's user how far all are."""

    def __call__(self, done: int) -> None:
        """So many points are done in all."""

    def place(self, words: str, begun: float) -> None:
        """Where a rank is in a long point; how much is done of all that are being solved, in points."""


@dataclass(frozen=True, slots=True)
class Share:
    """What one rank did: points, and seconds spent on them and on waiting for more or for the others.

    ended: whether a stop ended what it was solving, which is to be solved again.
    """

    points: int
    busy: float
    idle: float
    ended: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Loop:
    """What every rank does with its units.

    prepare: what it does before the first. keep: makes a point durable before the next is asked for, on the
    rank that solves it. results: of what it has kept since, for the first rank where these decide what is to
    be done next. name: of a unit, in words.
    """

    solve: Solve
    keep: Callable[[Indices, Any], None]
    prepare: Callable[[], object] = lambda: None
    results: Callable[[], dict[int, Any]] = dict
    name: Callable[[int], str] = lambda unit: ""


def sweep(team: Team, todo: Handout, loop: Loop, shown: ProgressSink, stop: StopRequest) -> Share:
    """Solves every unit of `todo`, which only the first rank knows; returns when all ranks are done.

    What is raised ends all ranks. Once any rank has been asked to stop, each ends with the unit or the point
    of a chain that it is at, or within it where that takes longer than `stop.GRACE`.
    """
    claims = FirstRankClaims(team, todo, stop, shown.place) if team.first else OtherRankClaims(team, stop)
    with suppress(Stopped), heard_by(RankListener(claims, stop)):
        loop.prepare()
    shown(0)
    return _Rank(team, claims, loop, shown, stop).share()


class _Rank:
    """The loop on one rank."""

    def __init__(
        self,
        team: Team,
        claims: FirstRankClaims | OtherRankClaims,
        loop: Loop,
        shown: ProgressSink,
        stop: StopRequest,
    ):
        self.team, self.claims, self.loop, self.shown, self.stop = team, claims, loop, shown, stop
        self.points = 0
        self.ended = False

    def share(self) -> Share:
        """Solves chunk after chunk; returns what was done once all ranks are through."""
        started, busy = time.monotonic(), 0.0
        chunk = self.claims.claim(Report())
        while chunk != OVER:
            began, before = time.monotonic(), self.points
            at = self._solved_up_to(chunk)
            spent = time.monotonic() - began
            busy += spent
            report = Report(
                done=at - chunk[0],
                seconds=spent,
                given_back=(at, chunk[1]),
                points=self.points - before,
                stop=self.stop.name,
                results=self.loop.results(),
            )
            chunk = self.claims.claim(report)
        if isinstance(self.claims, FirstRankClaims):
            self.claims.close()
        self.team.meet()
        return Share(self.points, busy, time.monotonic() - started - busy, self.ended)

    def _solved_up_to(self, chunk: IndexRange) -> int:
        """Solves units of a chunk; returns the first that is left to others, or after a stop."""
        patience = time.monotonic() + GIVE_BACK_AFTER * chunk_seconds(self.team.size)
        at, before = chunk[0], self.points
        while at < chunk[1] and not self.stop:
            try:
                with heard_by(RankListener(self.claims, self.stop, partial(self.loop.name, at))):
                    self._solve(at, before)
            except Stopped:
                self.ended = True
            if self.stop:  # in the middle of the unit, perhaps
                break
            at += 1
            if time.monotonic() > patience:
                break
        return at

    def _solve(self, unit: int, before: int) -> None:
        """Solves a unit. before: the points that this rank had kept when its chunk began."""
        for index, result in self.loop.solve(unit):
            self.loop.keep(index, result)
            self.points += 1 if isinstance(index, int) else len(index)
            self.claims.between_points()
            if isinstance(self.claims, FirstRankClaims):
                self.shown(self.claims.handout.points + self.points - before)
