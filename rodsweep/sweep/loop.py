"""The loop that every rank runs: claim a chunk, solve its units, keep the points, give back what is left."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from .handout import GIVE_BACK_AFTER, OVER, FirstRankClaims, OtherRankClaims, Report, chunk_seconds
from .ranges import IndexRange
from .stop import StopRequest
from .team import Team

Result = TypeVar("Result")
Indices = int | NDArray[np.int64]
"""The index of a point, or those of points that are kept together, shape (n,)."""


@dataclass(frozen=True, slots=True)
class Share:
    """What one rank did: points, and seconds spent on them and on waiting for more or for the others."""

    points: int
    busy: float
    idle: float


def sweep(
    team: Team,
    todo: list[IndexRange],
    solve: Callable[[int], Iterable[tuple[Indices, Result]]],
    keep: Callable[[Indices, Result], None],
    tell: Callable[[int], None],
    stop: StopRequest,
) -> Share:
    """Solves every unit of the ranges `todo`, each on some rank; returns when all ranks are done.

    `solve` maps a unit to its points, each an index and a result, one after another: a unit is a
    point or a chain of them, or a stretch, whose points come all at once. `keep` makes a point durable
    before the next is asked for, on the rank that solves it; `tell` hears on the first rank how many points
    are done in all. What they raise ends all ranks. Once any rank has been asked to `stop`,
    each ends with the unit or the point of a chain that it is at.
    """
    started = time.monotonic()
    busy, points = 0.0, 0
    claims = FirstRankClaims(team, todo, stop) if team.first else OtherRankClaims(team, stop)
    patience = GIVE_BACK_AFTER * chunk_seconds(team.size)
    chunk = claims.claim(Report())
    while chunk != OVER:
        began = time.monotonic()
        at, end = chunk
        before = points
        while at < end and not stop:
            for index, result in solve(at):
                keep(index, result)
                points += 1 if isinstance(index, int) else len(index)
                claims.between_points()
                if isinstance(claims, FirstRankClaims):
                    tell(claims.handout.points + points - before)
            if stop:  # in the middle of the unit, perhaps
                break
            at += 1
            if time.monotonic() - began > patience:
                break
        spent = time.monotonic() - began
        busy += spent
        chunk = claims.claim(Report(at - chunk[0], spent, (at, end), points - before, stop=stop.name))
    if isinstance(claims, FirstRankClaims):
        claims.close()
    team.comm.Barrier()
    return Share(points, busy, time.monotonic() - started - busy)
