"""What `rodsweep show` says of branches of cycles: where they lead and change, where two states coexist."""

import json
from collections.abc import Iterable, Iterator

import numpy as np

from ...results.file.view import View
from ...wording import counted, is_or_are, some_of
from ..branch_curves import (
    CurveOfCycles,
    Range,
    both,
    branches_not_told,
    curves_of,
    followed_parameter,
    straight_ranges,
    union,
)
from .ranges import listed, rounded, span, to_error
from .told import Told

SPECIAL_ACCURACY = 2.0
"""Error of the cycle at a special point, which the file does not tell, in units of the accuracy asked for."""
NAMED_RODS = 8
"""Rods whose coexistence is named."""
FULL = "they have more special points than the list holds; raise branch.special"
SPECIAL_WORDS = {
    "fold": "fold",
    "torus": "torus point",
    "symmetry_breaking": "symmetry breaking",
    "left_the_model": "place where h1 = 0",
    "end": "end of a branch",
    "period_doubling": "period doubling",
}
"""What special points other than Hopf points are called."""
ENDS = {
    "range_end": "the end of the range",
    "crushed": "where F all but reaches k1",
    "no_cycle_found": "where no further cycle is found",
    "list_full": "the last cycle that is stored",
    "none": "an end",
}


def branch_summary(view: View, done: np.ndarray) -> Told:
    """The task's sentences about the points that are `done`, a mask of the points' shape."""
    if done.size == 1:
        return Told(list(_one_rod(view, 0)), [_searched(view, done)])
    v, rods = view.variables, np.flatnonzero(done.ravel())
    counts = v["branch_count"][done]
    branches = counted(int(counts.clip(min=0).sum()), "branch")
    cycles = counted(int(v["point_count"][done].clip(min=0).sum()), "cycle")
    line = f"{branches} at {some_of((counts > 0).sum(), len(rods), 'rod')}, {cycles}"
    return Told([line, *_specials(view, rods), *_coexistence(view, rods)], [_searched(view, done)])


def _one_rod(view: View, rod: int) -> Iterator[str]:
    """Every branch of the one rod of a file, with its special points to their errors."""
    along, curves, v = followed_parameter(view), curves_of(view, rod), view.variables
    accuracy = float(json.loads(view.attributes["config_resolved"])["accuracy"])
    hidden = branches_not_told(view, rod)
    if hidden:
        yield f"{some_of(hidden, hidden + len(curves), 'branch')} {is_or_are(hidden)} not told: {FULL}"
    elif v["branch_count"].max() < 0:
        yield "nothing is known of its branches"
    elif not curves:
        yield f"no Hopf point in the range of {along}: no branch is born there"
    for number, curve in enumerate(curves, 1):
        cycles = curve.cycles
        sizes, errors = curve.y[cycles], v["amplitude_error"].ravel()[v["branch"].ravel() == number]
        extent = f"{along} = {span(curve.at[cycles])}, largest tip y {span(sizes, errors * sizes)} L"
        yield f"branch {number}, {_ends(curve, along)}: {counted(int(cycles.sum()), 'cycle')}, {extent}"
        for special in curve.special:
            if special.kind in ("hopf", "end"):
                continue
            if special in (curve.special[0], curve.special[-1]) and special.kind == "symmetry_breaking":
                continue
            at, kind = to_error(special.at, special.error), special.kind.replace("_", " ")
            kind += f", where branch {special.meets} meets it," * (special.meets > 0)
            period, y = (
                rounded(value, SPECIAL_ACCURACY * accuracy * abs(value))
                for value in (special.period, special.tip_y_max)
            )
            size = f"period {period} tau2, largest tip y {y} L"
            yield f"  {kind} at {along} = {at}, {size}"
        if curve.stable_ranges:
            yield f"  stable cycles at {along} = {listed(curve.stable_ranges, errors_of([curve]))}"
        else:
            yield "  no stable cycle"
    if curves and not hidden:
        common = coexistence(view, rod)
        words = f"{along} = {listed(common, errors_of(curves))}" if common else "nowhere in the range"
        yield f"stable cycles beside a stable straight rod: {words}"


def _ends(curve: CurveOfCycles, along: str) -> str:
    """From where to where a branch leads."""
    first, last = curve.special[0], curve.special[-1]
    start = f"from the Hopf point at {along} = {to_error(first.at, first.error)}"
    if first.kind == "symmetry_breaking":
        where = f"{along} = {to_error(first.at, first.error)}"
        start = f"without mirror symmetry, from branch {first.meets} at {where}"
    there = f"{along} = {to_error(last.at, last.error)}"
    if last.kind == "hopf":
        return f"{start} to that at {there}"
    if last.kind == "symmetry_breaking":
        return f"{start} to branch {last.meets} at {there}"
    if last.kind == "left_the_model":
        return f"{start} to where h1 = 0, {there}"
    return f"{start} to {ENDS[last.reason]}, {along} = {rounded(last.at, last.error)}"


def coexistence(view: View, rod: int) -> list[Range]:
    """The ranges of the parameter in which a rod has stable cycles on a branch and is stable at rest."""
    stable = union(piece for curve in curves_of(view, rod) for piece in curve.stable_ranges)
    return both(stable, straight_ranges(view, rod, ends_of(view))[0])


def errors_of(curves: Iterable[CurveOfCycles]) -> dict[float, float]:
    """The absolute errors of the special points of branches, by their places."""
    return {float(special.at): special.error for curve in curves for special in curve.special}


def ends_of(view: View) -> Range:
    """The range of the parameter that is followed."""
    options = json.loads(view.attributes["config_resolved"])["branch"]
    return float(options["start"]), float(options["stop"])


def _specials(view: View, rods: np.ndarray) -> Iterator[str]:
    """How many special points of each kind all rods have, and where."""
    along = followed_parameter(view)
    found: dict[str, list[tuple[float, float]]] = {}
    for rod in rods:
        for curve in curves_of(view, int(rod)):
            for special in curve.special:
                found.setdefault(special.kind, []).append((special.at, special.error))
    for kind, located in found.items():
        if kind != "hopf":
            places, errors = np.array(located).T
            yield f"{counted(len(places), SPECIAL_WORDS[kind])}: {along} = {span(places, errors)}"


def _coexistence(view: View, rods: np.ndarray) -> Iterator[str]:
    """The rods that have two stable states somewhere, some by name."""
    along, columns = followed_parameter(view), view.point_columns
    told = [int(rod) for rod in rods if not branches_not_told(view, int(rod))]
    having = [(rod, ranges) for rod in told if (ranges := coexistence(view, rod))]
    if len(told) < len(rods):
        yield f"not told of {counted(len(rods) - len(told), 'rod')}: {FULL}"
    yield f"stable cycles beside a stable straight rod at {some_of(len(having), len(told), 'rod')}"
    for rod, ranges in having[:NAMED_RODS]:
        name = ", ".join(f"{key} = {column[rod]:.6g}" for key, column in columns.items())
        yield f"  {name}: {along} = {listed(ranges, errors_of(curves_of(view, rod)))}"
    if len(having) > NAMED_RODS:
        yield f"  and {counted(len(having) - NAMED_RODS, 'rod')} more"


def _searched(view: View, done: np.ndarray) -> str:
    """How far was followed, and what is known to be complete."""
    v, (start, stop) = view.variables, ends_of(view)
    along, proved = followed_parameter(view), some_of(v["certified"][done].sum(), done.sum(), "rod")
    return (
        f"followed in {along} from {start:g} to {stop:g}; that no Hopf point is missing is proved at "
        f"{proved}; cycles that lie on no branch from a Hopf point are not found"
    )
