"""What `rodsweep show` prints: axes, statuses with their meaning, cost and accuracy."""

import numpy as np
from rich.console import Console
from rich.table import Table

from ..results.schema import MISSING
from ..results.view import View


def show_summary(view: View) -> None:
    """Prints a summary of a result file."""
    console = Console(highlight=False)
    a = view.attributes
    console.print(f"{view.path}: {a.get('title', '')}, task {a.get('task', '')}", markup=False)
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
        _numbers(console, view, done)
    ran = (
        f"{a['started']} to {a['finished']} on {a['ranks']} ranks" if "finished" in a else "not finished yet"
    )
    console.print(
        f"computed {ran}; rodsweep {a.get('rodsweep_version')}, PETSc {a.get('petsc_version')}, "
        f"SLEPc {a.get('slepc_version')}, commit {str(a.get('git_commit'))[:12]}"
    )


def _axes(view: View) -> Table:
    table = Table(box=None, pad_edge=False)
    for heading in ("parameter", "values", "from", "to", "unit"):
        table.add_column(heading)
    units = {"gamma3": "gamma2 L^2"}
    for name, values in view.axes.items():
        low, high = values.min(), values.max()
        table.add_row(name, str(len(values)), f"{low:.6g}", f"{high:.6g}", units.get(name, "k3/L^2"))
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


def _numbers(console: Console, view: View, done: np.ndarray) -> None:
    v = view.variables
    seconds = v["seconds"][done]
    console.print(
        f"time a point: median {1e3 * np.median(seconds):.3g} ms, longest {1e3 * seconds.max():.3g} ms, "
        f"all together {seconds.sum():.3g} s"
    )
    size = np.hypot(v["growth_rate"][done], v["frequency"][done])
    relative = v["error_estimate"][done] / size
    if np.isfinite(relative).any():
        console.print(
            f"error estimate, relative: worst {np.nanmax(relative):.1e}, median {np.nanmedian(relative):.1e}"
        )
    unknowns = 3 * v["elements"][done].astype(int) * v["order"][done]
    console.print(f"unknowns a point: {unknowns.min()} to {unknowns.max()}")
    unstable = v["unstable_count"][done]
    console.print(
        f"certified: {int(v['certified'][done].sum())} of {int(done.sum())}; unstable modes: at most "
        f"{max(int(unstable.max()), 0)}, at {int((unstable > 0).sum())} points; not known at "
        f"{int((unstable < 0).sum())}"
    )
