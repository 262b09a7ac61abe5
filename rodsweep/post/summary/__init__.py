"""Summary printed by `rodsweep show`: the answer, the reliability, further results, and the provenance."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from ...config.arm.axes import NOT_SLENDER
from ...config.values import printable
from ...model.arm.quantities import ALL_QUANTITIES
from ...model.units import written_in
from ...results.file.provenance import RANK_SHARES, kernels_of
from ...results.file.view import View
from ...results.layouts import lacks_curves
from ...results.layouts.variables import DIMENSIONS, MISSING
from ...wording import counted, duration, is_or_are, plural
from .arm.answer import arm_answer
from .arm.arm import arm_lines
from .branch import branch_summary
from .criticality import criticality_summary
from .limit_cycle import limit_cycle_summary
from .modes import modes_summary
from .phase_diagram import phase_diagram_summary
from .ranges import span
from .spectrum import spectrum_summary
from .summary_lines import SummaryLines
from .thresholds import thresholds_summary

SUMMARIES: dict[str, Callable[[View, np.ndarray], SummaryLines]] = {
    "spectrum": spectrum_summary,
    "thresholds": thresholds_summary,
    "phase_diagram": phase_diagram_summary,
    "modes": modes_summary,
    "limit_cycle": limit_cycle_summary,
    "criticality": criticality_summary,
    "branch": branch_summary,
}
"""Function of each task from (view, mask of its computed points) to the lines of the summary."""
NOUNS = {"thresholds": "rod", "criticality": "rod", "branch": "rod", "phase_diagram": "row"}
"""Name of a point of each task, where it is not "point"."""


def show_summary(view: View, every_status: bool = False) -> None:
    """Prints a summary of a result file; every_status: whether statuses of no point are listed as well.

    The answer comes first, for an arm also in the arm's units. Then follow the reliability of the answer,
    further results, and last the provenance.
    """
    view = view.listed
    console = Console(highlight=False, markup=False)
    a = view.attributes
    status = view.variables["status"]
    done = status != MISSING
    noun = NOUNS.get(view.task, "point")
    rods = done & (status < NOT_SLENDER)
    nothing = SummaryLines([] if done.any() else [f"no {noun} is computed yet"])
    summary = SUMMARIES[view.task](view, rods) if rods.any() else nothing
    console.print(f"{printable(str(view.path))}: {a.get('title', '')}, task {view.task}", soft_wrap=True)
    for line in _answer(view, done, summary):
        console.print(line, soft_wrap=True)
    console.print()
    for line in [*_unfinished(view, int((~done).sum()), noun), *summary.trust]:
        console.print(line, soft_wrap=True)
    console.print(_table(("status", plural(noun), "meaning"), _statuses(view, status, every_status)))
    console.print()
    for line in summary.details:
        console.print(line, soft_wrap=True)
    console.print(_table(("parameter", "values", "from", "to", "unit"), _axes(view)))
    console.print()
    for line in [*_times(view, done, noun), *_ranks(a, noun), *_origin(a)]:
        console.print(line, soft_wrap=True)


def _answer(view: View, done: np.ndarray, summary: SummaryLines) -> list[str]:
    """Lines of the answer; for an arm first in its own units, then dimensionless."""
    if not view.quantities or not done.any():
        return [*summary.answer]
    lines = [*arm_answer(view, done), *summary.of_arm, *arm_lines(view, done)]
    return [*lines, "", "the rods without dimension:", *summary.answer] if summary.answer else lines


def _unfinished(view: View, missing: int, noun: str) -> list[str]:
    """Lines about points and curves that are not in the file yet."""
    lines = []
    if missing and (shard := view.attributes.get("shard")):
        lines.append(
            f"{counted(missing, noun)} {is_or_are(missing)} not here: the file is shard {shard}, and "
            "`rodsweep merge` combines the shards; if the run of this shard was interrupted, its command "
            "continues it"
        )
    elif missing:
        lines.append(
            f"{counted(missing, noun)} {is_or_are(missing)} missing; if no run is going on, the same command "
            "continues"
        )
    elif lacks_curves(view.attributes):
        lines.append(
            f"all {plural(noun)} are computed; the curves are missing, and the same command adds them"
        )
    if waiting := view.journalled:
        verb = "waits" if waiting == 1 else "wait"
        lines.append(
            f"{waiting} of the {plural(noun)} that are done {verb} in the journal for the end of the run"
        )
    return lines


def _times(view: View, done: np.ndarray, noun: str) -> list[str]:
    """Lines about the time that the points took; empty without a computed point."""
    if not done.any():
        return []
    seconds = view.variables["seconds"][done]
    if done.sum() == 1:
        return [f"time of the {noun}: {duration(float(seconds.max()))}"]
    return [
        f"time a {noun}: median {duration(float(np.median(seconds)))}, longest "
        f"{duration(float(seconds.max()))}, all together {duration(float(seconds.sum()))}"
    ]


def _origin(a: dict[str, Any]) -> list[str]:
    """Lines about the time, the versions and the BLAS kernels of the computation."""
    return [
        f"computed {_when(a)}; rodsweep {a.get('rodsweep_version')}, PETSc {a.get('petsc_version')}, "
        f"SLEPc {a.get('slepc_version')}, commit {str(a.get('git_commit'))[:12]}",
        f"BLAS: {'; '.join(kernels_of(a))}",
    ]


def _when(a: dict[str, Any]) -> str:
    """Period in which a file was computed; for a shard, also whether the run is complete."""
    if "started" not in a:
        return "not finished yet"
    if "finished" in a:
        return f"{a['started']} to {a['finished']}"
    whole = a.get("shard") and not a.get("stopped")
    return f"from {a['started']} on, all points of shard {a['shard']}" if whole else "not finished yet"


def _ranks(a: dict[str, Any], noun: str) -> list[str]:
    """Lines about the ranks of the last run: busy time and numbers of points."""
    if RANK_SHARES[0] not in a:
        return []
    points, busy, idle = (np.atleast_1d(a[name]) for name in RANK_SHARES)
    share = 100 * busy / np.maximum(busy + idle, 1e-9)
    least = int(share.argmin())
    ranks = counted(int(a["ranks"]), "rank")
    hosts = counted(len(str(a["hosts"]).split()), "host")
    text = f"last run: {ranks} on {hosts}, {counted(int(points.sum()), noun)}"
    text += f"; shard {a['shard']}" if a.get("shard") else ""
    text += f"; stopped by {a['stopped']}" if a.get("stopped") else ""
    if int(a["ranks"]) == 1:
        return [text, f"the rank was busy {share[0]:.1f} % of its time"]
    solved = f"{np.median(share):.1f} % of its time (median; least {share[least]:.1f} %, rank {least})"
    each = span(points)
    things = noun if each == "1" else plural(noun)
    return [text, f"a rank was busy {solved} and finished {each} {things}"]


def _table(headings: Iterable[str], rows: Iterable[tuple[str, ...]]) -> Table:
    """Table without borders."""
    table = Table(*headings, box=None, pad_edge=False)
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def _axes(view: View) -> Iterable[tuple[str, ...]]:
    """Yields (name, number of values, from, to, unit) of an arm's quantities and of every parameter."""
    for name, values in view.quantities.items():
        si = ALL_QUANTITIES[name].unit
        unit = view.typed.get(name, si)
        yield name, *_extent(np.vectorize(lambda x, to=unit, of=si: written_in(x, to, of))(values)), unit
    for name, values in view.axes.items():
        yield name, *_extent(values), DIMENSIONS[name][0]


def _extent(values: np.ndarray) -> tuple[str, str, str]:
    """(number of different values, smallest, largest) of values of any shape, as text; NaN does not count."""
    # Twelve digits, because values computed from an arm may differ by rounding.
    different = {f"{value:.12g}" for value in values[~np.isnan(values)]}
    ends = sorted(map(float, different))
    return (str(len(ends)), f"{ends[0]:.6g}", f"{ends[-1]:.6g}") if ends else ("0", "", "")


def _statuses(view: View, status: np.ndarray, every: bool) -> Iterable[tuple[str, ...]]:
    """Yields (status, number of points, meaning); every: whether statuses of no point are included."""
    lines = str(view.attributes.get("status_sentences", "")).splitlines()
    sentences = dict(line.split(": ", 1) for line in lines if ": " in line) | {"missing": "not computed yet"}
    found = dict(zip(*(a.tolist() for a in np.unique(status, return_counts=True)), strict=True))
    for value in sorted(view.flags.keys() | found.keys()) if every else found:
        name = view.flags.get(value, f"unknown ({value})")
        yield name, str(found.get(value, 0)), sentences.get(name, "")
