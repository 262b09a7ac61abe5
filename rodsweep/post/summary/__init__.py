"""What `rodsweep show` prints: axes, statuses with their meaning, cost, and what the task has to tell."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from ...config.values import printable
from ...results.file.provenance import RANK_SHARES, kernels_of
from ...results.file.view import View
from ...results.layouts import lacks_curves
from ...results.layouts.arm import QUANTITY_UNITS
from ...results.layouts.variables import DIMENSIONS, MISSING
from .arm import arm_lines
from .arm_answer import arm_answer
from .branch import branch_summary
from .criticality import criticality_summary
from .limit_cycle import limit_cycle_summary
from .modes import modes_summary
from .phase_diagram import phase_diagram_summary
from .spectrum import spectrum_summary
from .thresholds import thresholds_summary

SUMMARIES: dict[str, Callable[[View, np.ndarray], list[str]]] = {
    "spectrum": spectrum_summary,
    "thresholds": thresholds_summary,
    "phase_diagram": phase_diagram_summary,
    "modes": modes_summary,
    "limit_cycle": limit_cycle_summary,
    "criticality": criticality_summary,
    "branch": branch_summary,
}
"""What each task has to tell of its computed points, from (view, which points are computed)."""


def show_summary(view: View, every_status: bool = False) -> None:
    """Prints a summary of a result file; `every_status` lists those of no point, too."""
    view, console = view.listed, Console(highlight=False, markup=False)
    a, status = view.attributes, view.variables["status"]
    done = status != MISSING
    console.print(f"{printable(str(view.path))}: {a.get('title', '')}, task {view.task}")
    for line in arm_answer(view, done):
        console.print(line, soft_wrap=True)
    console.print(_table(("parameter", "values", "from", "to", "unit"), _axes(view)))
    console.print(_table(("status", "points", "meaning"), _statuses(view, status, every_status)))
    if not done.all():
        console.print(
            f"{int((~done).sum())} points are missing; where no run goes on, the same command continues"
        )
    elif lacks_curves(a):
        console.print("all points are there; the curves through them are missing, the same command adds them")
    if view.journalled:
        console.print(
            f"{view.journalled} of the points that are done wait in the journal for the end of the run"
        )
    if done.any():
        seconds = view.variables["seconds"][done]
        console.print(
            f"time a point: median {1e3 * np.median(seconds):.3g} ms, longest {1e3 * seconds.max():.3g} ms, "
            f"all together {seconds.sum():.3g} s"
        )
        for line in [*SUMMARIES[view.task](view, done), *arm_lines(view, done)]:
            console.print(line, soft_wrap=True)
    for line in _ranks(a):
        console.print(line, soft_wrap=True)
    ran = f"{a['started']} to {a['finished']}" if "finished" in a and "started" in a else "not finished yet"
    console.print(
        f"computed {ran}; rodsweep {a.get('rodsweep_version')}, PETSc {a.get('petsc_version')}, "
        f"SLEPc {a.get('slepc_version')}, commit {str(a.get('git_commit'))[:12]}"
    )
    console.print(f"BLAS: {'; '.join(kernels_of(a))}", soft_wrap=True)


def _ranks(a: dict[str, Any]) -> list[str]:
    """What the ranks of the last run did: how much of the time they solved, and how many points."""
    if RANK_SHARES[0] not in a:
        return []
    points, busy, idle = (np.atleast_1d(a[name]) for name in RANK_SHARES)
    hosts = len(str(a["hosts"]).split())
    share = 100 * busy / np.maximum(busy + idle, 1e-9)
    least = int(share.argmin())
    text = f"last run: {a['ranks']} ranks on {hosts} host{'s' * (hosts != 1)}, {points.sum()} points"
    text += f"; shard {a['shard']}" if a.get("shard") else ""
    text += f"; stopped by {a['stopped']}" if a.get("stopped") else ""
    solved = f"{np.median(share):.1f} % of its time (median; least {share[least]:.1f} %, rank {least})"
    return [text, f"a rank was busy {solved} and finished {points.min()} to {points.max()} points"]


def _table(headings: Iterable[str], rows: Iterable[tuple[str, ...]]) -> Table:
    table = Table(*headings, box=None, pad_edge=False)
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def _axes(view: View) -> Iterable[tuple[str, ...]]:
    for name, values in view.axes.items():
        low, high = values.min(), values.max()
        yield name, str(len(values)), f"{low:.6g}", f"{high:.6g}", DIMENSIONS[name][0]
    for name, values in view.quantities.items():
        yield name, str(values.size), f"{values.min():.6g}", f"{values.max():.6g}", QUANTITY_UNITS[name]


def _statuses(view: View, status: np.ndarray, every: bool) -> Iterable[tuple[str, ...]]:
    lines = str(view.attributes.get("status_sentences", "")).splitlines()
    sentences = dict(line.split(": ", 1) for line in lines if ": " in line) | {"missing": "not computed yet"}
    found = dict(zip(*(a.tolist() for a in np.unique(status, return_counts=True)), strict=True))
    for value in sorted(view.flags.keys() | found.keys()) if every else found:
        name = view.flags.get(value, f"unknown ({value})")
        yield name, str(found.get(value, 0)), sentences.get(name, "")
