"""What `rodsweep show` prints: axes, statuses with their meaning, cost, and what the task has to tell."""

from collections.abc import Callable
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from ...results.file.kernels import kernels_of
from ...results.file.view import View
from ...results.layouts.variables import DIMENSIONS, MISSING
from .limit_cycle import limit_cycle_lines
from .modes import modes_lines
from .phase_diagram import phase_diagram_lines
from .spectrum import spectrum_lines
from .thresholds import thresholds_lines

LINES: dict[str, Callable[[View, np.ndarray], list[str]]] = {
    "spectrum": spectrum_lines,
    "thresholds": thresholds_lines,
    "phase_diagram": phase_diagram_lines,
    "modes": modes_lines,
    "limit_cycle": limit_cycle_lines,
}
"""What each task has to tell of its computed points, from (view, which points are computed)."""
RANK_NUMBERS = ("points", "busy_seconds", "idle_seconds")
"""What is kept of every rank of the last run, in attributes named rank_*."""


def show_summary(view: View) -> None:
    """Prints a summary of a result file."""
    console = Console(highlight=False)
    a = view.attributes
    console.print(f"{view.path}: {a.get('title', '')}, task {view.task}", markup=False)
    console.print(_axes(view))
    status = view.variables["status"]
    console.print(_statuses(view, status))
    waiting = int((status == MISSING).sum())
    if waiting:
        console.print(
            f"{waiting} points are missing, of which {view.journalled} are done and wait in the journal; "
            "the same run again continues"
        )
    done = status != MISSING
    if done.any():
        seconds = view.variables["seconds"][done]
        console.print(
            f"time a point: median {1e3 * np.median(seconds):.3g} ms, longest {1e3 * seconds.max():.3g} ms, "
            f"all together {seconds.sum():.3g} s"
        )
        for line in LINES[view.task](view, done):
            console.print(line, soft_wrap=True)
    for line in _ranks(a):
        console.print(line, soft_wrap=True)
    ran = f"{a['started']} to {a['finished']}" if "finished" in a and "started" in a else "not finished yet"
    console.print(
        f"computed {ran}; rodsweep {a.get('rodsweep_version')}, PETSc {a.get('petsc_version')}, "
        f"SLEPc {a.get('slepc_version')}, commit {str(a.get('git_commit'))[:12]}"
    )
    kernels = kernels_of(a)
    console.print(f"BLAS: {'; '.join(kernels)}", soft_wrap=True, markup=False)


def _ranks(a: dict[str, Any]) -> list[str]:
    """What the ranks of the last run did: how much of the time they solved, and how many points."""
    if "rank_points" not in a:
        return []
    points, busy, idle = (np.atleast_1d(a[f"rank_{name}"]) for name in RANK_NUMBERS)
    hosts = len(str(a["hosts"]).split())
    share = 100 * busy / np.maximum(busy + idle, 1e-9)
    least = int(share.argmin())
    text = f"last run: {a['ranks']} ranks on {hosts} host{'s' * (hosts != 1)}, {points.sum()} points"
    text += f"; shard {a['shard']}" if a.get("shard") else ""
    text += f"; stopped by {a['stopped']}" if a.get("stopped") else ""
    solved = f"{np.median(share):.1f} % of its time (median; least {share[least]:.1f} %, rank {least})"
    return [text, f"a rank was busy {solved} and finished {points.min()} to {points.max()} points"]


def _axes(view: View) -> Table:
    table = Table(box=None, pad_edge=False)
    for heading in ("parameter", "values", "from", "to", "unit"):
        table.add_column(heading)
    for name, values in view.axes.items():
        low, high = values.min(), values.max()
        table.add_row(name, str(len(values)), f"{low:.6g}", f"{high:.6g}", DIMENSIONS[name][0])
    return table


def _statuses(view: View, status: np.ndarray) -> Table:
    table = Table(box=None, pad_edge=False)
    for heading in ("status", "points", "meaning"):
        table.add_column(heading)
    sentences = dict(
        line.split(": ", 1)
        for line in str(view.attributes.get("status_sentences", "")).splitlines()
        if ": " in line
    )
    sentences["missing"] = "not computed yet"
    for value, count in zip(*np.unique(status, return_counts=True), strict=True):
        name = view.flags.get(int(value), f"unknown ({value})")
        table.add_row(name, str(count), sentences.get(name, ""))
    return table
