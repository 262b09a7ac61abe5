"""Contribution of each rank to a run, and attributes of the file made from all contributions."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...results.file import provenance
from ...results.file.creation import Plan
from ...sweep.loop import Share

MAX_FAILURES_PRINTED = 3
"""Maximum number of failed points named at the end of a run; the file has the status of all points."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Contribution:
    """Report of a rank to the first rank: host, a failed point of each distinct reason in words, and
    statistics of the rank's work.
    """

    host: str
    failures: list[str]
    share: Share


def of_the_last_run(plan: Plan) -> dict[str, Any]:
    """Attributes of a plan that describe the last run with computed points."""
    names = ("_version", "_commit", "_options")
    return {k: v for k, v in plan.attributes.items() if k.endswith(names) or k == "shard"}


def reasons_of(contributions: Sequence[Contribution], before: Mapping[str, Any]) -> dict[str, str]:
    """Attribute with the reasons of failed points; before: attributes with the reasons of earlier runs."""
    found = "\n".join(failure for contribution in contributions for failure in contribution.failures)
    return provenance.united_reasons(str(before.get(provenance.FAILURE_REASONS, "")), found)


def history_of(contributions: Sequence[Contribution], mpi_library: str) -> dict[str, Any]:
    """Attributes with the hosts, versions and ranks that computed the points of a run."""
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
