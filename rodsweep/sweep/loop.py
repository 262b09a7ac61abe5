"""The loop that every rank runs: claim a chunk, solve its units, keep each point, give slow rest back."""

import time
from collections.abc import Callable, Iterable
from typing import TypeVar

from .handout import GIVE_BACK_AFTER, OVER, Range, Report, claims_of
from .team import Team

Result = TypeVar("Result")


def sweep(
    team: Team,
    todo: list[Range],
    solve: Callable[[int], Iterable[tuple[int, Result]]],
    keep: Callable[[int, Result], None],
    tell: Callable[[int], None],
) -> None:
    """Solves every unit of the ranges `todo`, each on some rank; returns when all ranks are done.

    `solve` maps a unit to its points, each an index and a result, one after another: a unit is a
    point or a chain of them. `keep` makes a point durable before the next is asked for, on the rank
    that solves it; `tell` hears on the first rank how many points are done in all. What they raise
    ends all ranks.
    """
    claims = claims_of(team, todo)
    chunk = claims.claim(Report())
    while chunk != OVER:
        began = time.monotonic()
        at, stop = chunk
        points = 0
        while at < stop:
            for index, result in solve(at):
                keep(index, result)
                points += 1
                claims.serve()
                if team.first:
                    tell(claims.points + points)
            at += 1
            if time.monotonic() - began > GIVE_BACK_AFTER:
                break
        chunk = claims.claim(Report(at - chunk[0], time.monotonic() - began, (at, stop), points))
    claims.close()
    team.barrier()
