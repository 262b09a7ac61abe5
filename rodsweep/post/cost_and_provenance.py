"""Lines about the cost and the provenance of a result: computing time, MPI ranks, dates, versions, BLAS
kernels."""

from typing import Any

import numpy as np

from ..results.file.provenance import RANK_STATISTICS_ATTRIBUTES, blas_kernels_in
from ..results.file.view import ResultView
from ..wording import counted, duration, plural


def computing_time_lines(view: ResultView, is_computed: np.ndarray, noun: str) -> list[str]:
    """Lines about the computing time of the points in the mask `is_computed`, of any shape; an empty list if
    no point is computed. noun: word for a point."""
    if not is_computed.any():
        return []
    seconds = view.variables["seconds"][is_computed]
    if is_computed.sum() == 1:
        return [f"time of the {noun}: {duration(float(seconds.max()))}"]
    return [
        f"time per {noun}: median {duration(float(np.median(seconds)))}, longest "
        f"{duration(float(seconds.max()))}, in total {duration(float(seconds.sum()))}"
    ]


def provenance_lines(attributes: dict[str, Any]) -> list[str]:
    """Lines about dates, versions of the software, and BLAS kernels."""
    return [
        f"computed {_dates_clause(attributes)}; rodsweep {attributes.get('rodsweep_version')}, PETSc "
        f"{attributes.get('petsc_version')}, "
        f"SLEPc {attributes.get('slepc_version')}, commit {str(attributes.get('git_commit'))[:12]}",
        f"BLAS: {'; '.join(blas_kernels_in(attributes))}",
    ]


def _dates_clause(attributes: dict[str, Any]) -> str:
    """Clause with the dates of start and end of the computation. The file of a shard has no end; the clause
    then says whether all points of the shard are computed."""
    if "started" not in attributes:
        return "not finished yet"
    if "finished" in attributes:
        return f"{attributes['started']} to {attributes['finished']}"
    if attributes.get("shard") and not attributes.get("stopped"):
        return f"from {attributes['started']} on, all points of shard {attributes['shard']}"
    return "not finished yet"


def last_run_lines(attributes: dict[str, Any], noun: str) -> list[str]:
    """Lines about the last run: ranks, hosts, points, shard, reason of a stop, and fraction of the time spent
    solving; empty if not stored. noun: word for a point."""
    if RANK_STATISTICS_ATTRIBUTES[0] not in attributes:
        return []
    points, busy_seconds, idle_seconds = (
        np.atleast_1d(attributes[name]) for name in RANK_STATISTICS_ATTRIBUTES
    )
    percent = 100 * busy_seconds / np.maximum(busy_seconds + idle_seconds, 1e-9)
    worst = int(percent.argmin())
    ranks_text = counted(int(attributes["ranks"]), "rank")
    hosts_text = counted(len(str(attributes["hosts"]).split()), "host")
    text = f"last run: {ranks_text} on {hosts_text}, {counted(int(points.sum()), noun)}"
    text += f"; shard {attributes['shard']}" if attributes.get("shard") else ""
    text += f"; stopped by {attributes['stopped']}" if attributes.get("stopped") else ""
    if int(attributes["ranks"]) == 1:
        return [text, f"the rank was busy {percent[0]:.1f} % of its time"]
    busy_text = f"{np.median(percent):.1f} % of the time (median; least {percent[worst]:.1f} %, rank {worst})"
    ends = dict.fromkeys(f"{number:.6g}" for number in (points.min(), points.max()))
    count_text = " to ".join(ends)
    points_noun = noun if count_text == "1" else plural(noun)
    return [text, f"the ranks were busy {busy_text}; each finished {count_text} {points_noun}"]
