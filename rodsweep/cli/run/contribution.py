"""What each rank did in a run, and what the file keeps of it."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...results.file import provenance
from ...results.file.creation import Plan
from ...sweep.loop import Indices, Share
from ...sweep.points.stretches import StretchResult

FAILURES_TOLD = 3
"""Failed points that are named at the end of a run; the file has the status of all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Contribution:
    """What a rank tells the first one: its host, failed points in words, its share."""

    host: str
    failures: list[str]
    share: Share


def failures_of(index: Indices, result: Any, where: Callable[[int], str]) -> list[str]:
    """What to tell of points that did not succeed, as many as are told. where: the parameters of one."""
    if isinstance(result, StretchResult):
        failed = np.flatnonzero(~result.succeeded)[:FAILURES_TOLD]
        told = [(int(np.asarray(index)[i]), result.message(int(i))) for i in failed]
    else:
        told = [] if result.status.succeeded else [(int(index), f"{result.status.name} {result.message}")]
    return [f"{where(at)}: {outcome}".rstrip() for at, outcome in told]


def of_the_last_run(plan: Plan) -> dict[str, Any]:
    """The attributes of a plan that are those of the last run that computed points."""
    names = ("_version", "_commit", "_options")
    return {k: v for k, v in plan.attributes.items() if k.endswith(names) or k == "shard"}


def history_of(contributions: Sequence[Contribution], mpi_library: str) -> dict[str, Any]:
    """Attributes that say where, by what and by whom the points of a run were computed."""
    hosts = {contribution.host for contribution in contributions}
    shares = [contribution.share for contribution in contributions[: provenance.MAX_RANK_SHARES]]
    points, busy, idle = zip(*((share.points, share.busy, share.idle) for share in shares), strict=True)
    numbers = (np.array(points, "i4"), np.array(busy, "f4"), np.array(idle, "f4"))
    return {
        "ranks": len(contributions),
        "hosts": " ".join(sorted(hosts))[: provenance.LONGEST_ATTRIBUTE],
        "mpi_library": mpi_library.split("\n", maxsplit=1)[0].strip("\0 "),
        "slurm_job": os.environ.get("SLURM_JOB_ID", ""),
        **dict(zip(provenance.RANK_SHARES, numbers, strict=True)),
    }
