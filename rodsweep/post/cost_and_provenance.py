"""Lines about the cost and the provenance of a result: computing time, MPI ranks, dates, versions, BLAS
kernels."""

from typing import Any

import numpy as np

from ..results.file.provenance import RANK_STATISTICS, blas_kernels_in
from ..results.file.view import ResultView
from ..wording import counted, duration, plural


def time_lines(view: ResultView, is_computed: np.ndarray, noun: str) -> list[str]:
    """Lines about the computing time of the points in the mask `is_computed`, of any shape; an empty list if
    no point is computed."""
    if not is_computed.any():
        return []
    seconds = view.variables["seconds"][is_computed]
    if is_computed.sum() == 1:
        return [f"time of the {noun}: {duration(float(seconds.max()))}"]
    return [
        f"time per {noun}: median {duration(float(np.median(seconds)))}, longest "
        f"{duration(float(seconds.max()))}, in total {duration(float(seconds.sum()))}"
    ]


def provenance_lines(a: dict[str, Any]) -> list[str]:
    """Lines about dates, versions of the software, and BLAS kernels."""
    return [
        f"computed {_dates_clause(a)}; rodsweep {a.get('rodsweep_version')}, PETSc {a.get('petsc_version')}, "
        f"SLEPc {a.get('slepc_version')}, commit {str(a.get('git_commit'))[:12]}",
        f"BLAS: {'; '.join(blas_kernels_in(a))}",
    ]


def _dates_clause(a: dict[str, Any]) -> str:
    """Clause with the dates of start and end of the computation. The file of a shard has no end; the clause
    then says whether all points of the shard are computed."""
    if "started" not in a:
        return "not finished yet"
    if "finished" in a:
        return f"{a['started']} to {a['finished']}"
    if a.get("shard") and not a.get("stopped"):
        return f"from {a['started']} on, all points of shard {a['shard']}"
    return "not finished yet"


def rank_lines(a: dict[str, Any], noun: str) -> list[str]:
    """Lines about the last run: ranks, hosts, points, shard, reason of a stop, and fraction of the time spent
    solving; empty if not stored."""
    if RANK_STATISTICS[0] not in a:
        return []
    points, busy_seconds, idle_seconds = (np.atleast_1d(a[name]) for name in RANK_STATISTICS)
    percent = 100 * busy_seconds / np.maximum(busy_seconds + idle_seconds, 1e-9)
    worst = int(percent.argmin())
    ranks = counted(int(a["ranks"]), "rank")
    hosts = counted(len(str(a["hosts"]).split()), "host")
    text = f"last run: {ranks} on {hosts}, {counted(int(points.sum()), noun)}"
    text += f"; shard {a['shard']}" if a.get("shard") else ""
    text += f"; stopped by {a['stopped']}" if a.get("stopped") else ""
    if int(a["ranks"]) == 1:
        return [text, f"the rank was busy {percent[0]:.1f} % of its time"]
    busy_text = f"{np.median(percent):.1f} % of the time (median; least {percent[worst]:.1f} %, rank {worst})"
    ends = dict.fromkeys(f"{number:.6g}" for number in (points.min(), points.max()))
    count_text = " to ".join(ends)
    points_noun = noun if count_text == "1" else plural(noun)
    return [text, f"the ranks were busy {busy_text}; each finished {count_text} {points_noun}"]
