"""The loop that every rank runs: claim a chunk, solve its points, keep each, give slow rest back."""

import time
from collections.abc import Callable
from typing import TypeVar

from .handout import GIVE_BACK_AFTER, OVER, Range, Report, claims_of
from .team import Team

Result = TypeVar("Result")


def sweep(
    team: Team,
    todo: list[Range],
    solve: Callable[[int], Result],
    keep: Callable[[int, Result], None],
    tell: Callable[[int], None],
) -> None:
    """Solves every index of the ranges `todo`, each on some rank; returns when all ranks are done.

    `solve` maps an index to a result and `keep` makes it durable, both on the rank that solves it;
    `tell` hears on the first rank how many points are done in all. What they raise ends all ranks.
    """
    claims = claims_of(team, todo)
    chunk = claims.claim(Report())
    while chunk != OVER:
        began = time.monotonic()
        at, stop = chunk
        while at < stop:
            keep(at, solve(at))
            at += 1
            claims.serve()
            if team.first:
                tell(claims.done + at - chunk[0])
            if time.monotonic() - began > GIVE_BACK_AFTER:
                break
        chunk = claims.claim(Report(at - chunk[0], time.monotonic() - began, (at, stop)))
    claims.close()
    team.barrier()
