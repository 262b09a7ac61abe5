"""What `rodsweep show` says of branches of cycles: where they lead and change, where two states coexist."""

import json
from collections.abc import Iterator

import numpy as np

from ...results.file.view import View
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
from .ranges import span, to_error

NAMED_RODS = 8
"""Rods whose coexistence is named."""
FULL = "they have more special points than the list holds; raise branch.special"
ENDS = {
    "range_end": "the end of the range",
    "crushed": "where F all but reaches k1",
    "no_cycle_found": "where no further cycle is found",
    "list_full": "the last cycle that is stored",
    "none": "an end",
}


def branch_summary(view: View, done: np.ndarray) -> list[str]:
    """The task's lines about the points that are `done`, a mask of the points' shape."""
    if done.size == 1:
        return [*_one_rod(view, 0), _searched(view, done)]
    v, rods = view.variables, np.flatnonzero(done.ravel())
    counts = v["branch_count"][done]
    lines = [
        f"{int(counts.clip(min=0).sum())} branches at {int((counts > 0).sum())} of {len(rods)} rods, "
        f"{int(v['point_count'][done].clip(min=0).sum())} cycles"
    ]
    return [*lines, *_specials(view, rods), *_coexistence(view, rods), _searched(view, done)]


def _one_rod(view: View, rod: int) -> Iterator[str]:
    """Every branch of the one rod of a file, with its special points to their errors."""
    along, curves = followed_parameter(view), curves_of(view, rod)
    hidden = branches_not_told(view, rod)
    if hidden:
        yield f"{hidden} of {hidden + len(curves)} branches are not told: {FULL}"
    elif not curves:
        yield f"no Hopf point in the range of {along}: no branch is born there"
    for number, curve in enumerate(curves, 1):
        cycles = curve.cycles
        extent = f"{along} = {span(curve.at[cycles])}, largest tip y {span(curve.y[cycles])} L"
        yield f"branch {number}, {_ends(curve, along)}: {int(cycles.sum())} cycles, {extent}"
        for special in curve.special:
            if special.kind in ("hopf", "end"):
                continue
            if special in (curve.special[0], curve.special[-1]) and special.kind == "symmetry_breaking":
                continue
            at, kind = to_error(special.at, special.error), special.kind.replace("_", " ")
            kind += f", where branch {special.meets} meets it," * (special.meets > 0)
            size = f"period {special.period:.9g} tau2, largest tip y {special.tip_y_max:.9g} L"
            yield f"  {kind} at {along} = {at}, {size}"
        yield f"  stable cycles at {_words(along, curve.stable_ranges)}"
    if curves and not hidden:
        common = coexistence(view, rod)
        yield f"stable cycles beside a stable straight rod: {_words(along, common)}"


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
    return f"{start} to {ENDS[last.reason]}, {along} = {last.at:.9g}"


def coexistence(view: View, rod: int) -> list[Range]:
    """The ranges of the parameter in which a rod has stable cycles on a branch and is stable at rest."""
    stable = union(piece for curve in curves_of(view, rod) for piece in curve.stable_ranges)
    return both(stable, straight_ranges(view, rod, ends_of(view))[0])


def ends_of(view: View) -> Range:
    """The range of the parameter that is followed."""
    options = json.loads(view.attributes["config_resolved"])["branch"]
    return float(options["start"]), float(options["stop"])


def _specials(view: View, rods: np.ndarray) -> Iterator[str]:
    """How many special points of each kind all rods have, and where."""
    along = followed_parameter(view)
    found: dict[str, list[float]] = {}
    for rod in rods:
        for curve in curves_of(view, int(rod)):
            for special in curve.special:
                found.setdefault(special.kind, []).append(special.at)
    for kind, places in found.items():
        if kind != "hopf":
            yield f"{len(places)} of kind {kind}: {along} = {span(np.array(places))}"


def _coexistence(view: View, rods: np.ndarray) -> Iterator[str]:
    """The rods that have two stable states somewhere, some by name."""
    along, columns = followed_parameter(view), view.point_columns
    told = [int(rod) for rod in rods if not branches_not_told(view, int(rod))]
    having = [(rod, ranges) for rod in told if (ranges := coexistence(view, rod))]
    if len(told) < len(rods):
        yield f"not told of {len(rods) - len(told)} rods: {FULL}"
    yield f"stable cycles beside a stable straight rod at {len(having)} of {len(told)} rods"
    for rod, ranges in having[:NAMED_RODS]:
        name = ", ".join(f"{key} = {column[rod]:.6g}" for key, column in columns.items())
        yield f"  {name}: {_words(along, ranges)}"
    if len(having) > NAMED_RODS:
        yield f"  and {len(having) - NAMED_RODS} rods more"


def _words(along: str, ranges: list[Range]) -> str:
    """Ranges of a parameter in words."""
    return f"{along} = " + ", ".join(f"{a:.9g} to {b:.9g}" for a, b in ranges) if ranges else "none"


def _searched(view: View, done: np.ndarray) -> str:
    """How far was followed, and what is known to be complete."""
    v, (start, stop) = view.variables, ends_of(view)
    along, certified = followed_parameter(view), int(v["certified"][done].sum())
    return (
        f"followed in {along} from {start:g} to {stop:g}; that no Hopf point is missing is proved at "
        f"{certified} of {int(done.sum())} rods; cycles that lie on no branch from a Hopf point are not found"
    )
