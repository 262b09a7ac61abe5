"""What `rodsweep show` prints: the answer, how far it is to be trusted, all else, and the bookkeeping."""

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
from .thresholds import thresholds_summary
from .told import Told

SUMMARIES: dict[str, Callable[[View, np.ndarray], Told]] = {
    "spectrum": spectrum_summary,
    "thresholds": thresholds_summary,
    "phase_diagram": phase_diagram_summary,
    "modes": modes_summary,
    "limit_cycle": limit_cycle_summary,
    "criticality": criticality_summary,
    "branch": branch_summary,
}
"""What each task has to tell of its computed points, from (view, which points are computed)."""
NOUNS = {"thresholds": "rod", "criticality": "rod", "branch": "rod", "phase_diagram": "row"}
"""What a point of a file is called, where it is not one of a force."""


def show_summary(view: View, every_status: bool = False) -> None:
    """Prints a summary of a result file; `every_status` lists those of no point, too.

    First the answer in words, of an arm in its units too; then what is needed to trust it, what else the file
    says, and last by what it was computed.
    """
    view, console = view.listed, Console(highlight=False, markup=False)
    a, status = view.attributes, view.variables["status"]
    done, noun = status != MISSING, NOUNS.get(view.task, "point")
    rods = done & (status < NOT_SLENDER)
    nothing = Told([] if done.any() else [f"no {noun} is computed yet"])
    told = SUMMARIES[view.task](view, rods) if rods.any() else nothing
    console.print(f"{printable(str(view.path))}: {a.get('title', '')}, task {view.task}", soft_wrap=True)
    for line in _answer(view, done, told):
        console.print(line, soft_wrap=True)
    console.print()
    for line in [*_unfinished(view, int((~done).sum()), noun), *told.trust]:
        console.print(line, soft_wrap=True)
    console.print(_table(("status", plural(noun), "meaning"), _statuses(view, status, every_status)))
    console.print()
    for line in told.details:
        console.print(line, soft_wrap=True)
    console.print(_table(("parameter", "values", "from", "to", "unit"), _axes(view)))
    console.print()
    for line in [*_times(view, done, noun), *_ranks(a, noun), *_origin(a)]:
        console.print(line, soft_wrap=True)


def _answer(view: View, done: np.ndarray, told: Told) -> list[str]:
    """The answer; of an arm in its own units, then without dimension."""
    if not view.quantities or not done.any():
        return [*told.answer]
    lines = [*arm_answer(view, done), *told.of_arm, *arm_lines(view, done)]
    return [*lines, "", "the rods without dimension:", *told.answer] if told.answer else lines


def _unfinished(view: View, missing: int, noun: str) -> list[str]:
    """What is not in the file yet."""
    lines = []
    if missing and (shard := view.attributes.get("shard")):
        lines.append(
            f"{counted(missing, noun)} {is_or_are(missing)} not here: the file is shard {shard}, `rodsweep "
            "merge` puts the shards together; where this one was interrupted, its own command continues"
        )
    elif missing:
        lines.append(
            f"{counted(missing, noun)} {is_or_are(missing)} missing; where no run goes on, the same command "
            "continues"
        )
    elif lacks_curves(view.attributes):
        lines.append(
            f"all {plural(noun)} are there; the curves through them are missing, the same command adds them"
        )
    if waiting := view.journalled:
        verb = "waits" if waiting == 1 else "wait"
        lines.append(
            f"{waiting} of the {plural(noun)} that are done {verb} in the journal for the end of the run"
        )
    return lines


def _times(view: View, done: np.ndarray, noun: str) -> list[str]:
    """How long the points took; none where none is computed."""
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
    """When and by what a file was computed."""
    return [
        f"computed {_when(a)}; rodsweep {a.get('rodsweep_version')}, PETSc {a.get('petsc_version')}, "
        f"SLEPc {a.get('slepc_version')}, commit {str(a.get('git_commit'))[:12]}",
        f"BLAS: {'; '.join(kernels_of(a))}",
    ]


def _when(a: dict[str, Any]) -> str:
    """From when to when a file was computed; of a shard, that the run of its own part has come to its end."""
    if "started" not in a:
        return "not finished yet"
    if "finished" in a:
        return f"{a['started']} to {a['finished']}"
    whole = a.get("shard") and not a.get("stopped")
    return f"from {a['started']} on, all points of shard {a['shard']}" if whole else "not finished yet"


def _ranks(a: dict[str, Any], noun: str) -> list[str]:
    """What the ranks of the last run did: how much of the time they solved, and how many points."""
    if RANK_SHARES[0] not in a:
        return []
    points, busy, idle = (np.atleast_1d(a[name]) for name in RANK_SHARES)
    share = 100 * busy / np.maximum(busy + idle, 1e-9)
    least = int(share.argmin())
    ranks, hosts = counted(int(a["ranks"]), "rank"), counted(len(str(a["hosts"]).split()), "host")
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
    table = Table(*headings, box=None, pad_edge=False)
    for row in rows:
        table.add_row(*map(Text, row))
    return table


def _axes(view: View) -> Iterable[tuple[str, ...]]:
    """(name, different values, from, to, unit) of an arm's quantities, as typed, and of every parameter."""
    for name, values in view.quantities.items():
        si = ALL_QUANTITIES[name].unit
        unit = view.typed.get(name, si)
        yield name, *_extent(np.vectorize(lambda x, to=unit, of=si: written_in(x, to, of))(values)), unit
    for name, values in view.axes.items():
        yield name, *_extent(values), DIMENSIONS[name][0]


def _extent(values: np.ndarray) -> tuple[str, str, str]:
    """How many different values there are, of any shape, the smallest and the largest; NaN is none."""
    there = {f"{value:.12g}" for value in values[~np.isnan(values)]}  # scales differ by rounding only
    ends = sorted(map(float, there))
    return (str(len(ends)), f"{ends[0]:.6g}", f"{ends[-1]:.6g}") if ends else ("0", "", "")


def _statuses(view: View, status: np.ndarray, every: bool) -> Iterable[tuple[str, ...]]:
    lines = str(view.attributes.get("status_sentences", "")).splitlines()
    sentences = dict(line.split(": ", 1) for line in lines if ": " in line) | {"missing": "not computed yet"}
    found = dict(zip(*(a.tolist() for a in np.unique(status, return_counts=True)), strict=True))
    for value in sorted(view.flags.keys() | found.keys()) if every else found:
        name = view.flags.get(value, f"unknown ({value})")
        yield name, str(found.get(value, 0)), sentences.get(name, "")
