"""Branches of cycles in `rodsweep show`: their ends and special points, and ranges with two stable states."""

from collections.abc import Callable, Iterable, Iterator
from itertools import combinations

import numpy as np

from ...arrays import Array
from ...results.file.view import View
from ...wording import counted, is_or_are, some_of
from ..branch_curves import (
    Range,
    StoredBranch,
    coexistence_is_decided,
    count_incomplete_branches,
    curves_of,
    followed_parameter,
    intersection,
    straight_ranges,
    union,
)
from .errors import span_of
from .ranges import listed, rounded, span, to_error
from .summary_lines import SummaryLines, at_point, completeness
from .thresholds import not_known

NAMED_RODS = 8
"""Largest number of rods listed individually."""
LIST_TOO_SHORT = "they have more special points than the list holds; raise branch.special"
"""Cause and remedy of branches not shown."""
BESIDE_STRAIGHT = "stable cycles beside a stable straight rod"
TWO_CYCLES = "stable cycles of two branches"
SPECIAL_WORDS = {
    "fold": "fold",
    "torus": "torus point",
    "symmetry_breaking": "symmetry breaking",
    "period_doubling": "period doubling",
}
"""Words for special points at which a branch changes; Hopf points and ends have separate sentences."""
ENDS = {
    "left_the_model": "a cycle with h1 = 0",
    "range_end": "the end of the range",
    "crushed": "a force that almost crushes the rod",
    "no_cycle_found": "a cycle beyond which none is found",
    "list_full": "the last cycle that is stored",
    "none": "an end",
}
"""Words for the end of a branch, by reason."""


def branch_summary(view: View, done: np.ndarray) -> SummaryLines:
    """Lines of the summary about the points in `done`, a mask of the points' shape."""
    if done.size == 1:
        return SummaryLines(list(_one_rod(view, 0)), [_searched(view, done)])
    v = view.variables
    rods = np.flatnonzero(done.ravel())
    counts = v["branch_count"][done]
    branches = counted(int(counts.clip(min=0).sum()), "branch")
    cycles = counted(int(v["point_count"][done].clip(min=0).sum()), "cycle")
    line = f"{branches} at {some_of((counts > 0).sum(), len(rods), 'rod')}, {cycles}{_sizes(view, done)}"
    answer = [line, *_special_lines(view, rods), *_coexistence(view, rods)]
    return SummaryLines(answer, [_searched(view, done)])


def _one_rod(view: View, rod: int) -> Iterator[str]:
    """Yields lines about every branch of the single rod of a file, with the errors of its special points."""
    along = followed_parameter(view)
    curves = curves_of(view, rod)
    v = view.variables
    hidden = count_incomplete_branches(view, rod)
    if hidden:
        part = some_of(hidden, hidden + len(curves), "branch")
        yield f"{part} {is_or_are(hidden)} not shown: {LIST_TOO_SHORT}"
    elif v["branch_count"].max() < 0:
        yield "its branches are not known"
    elif not curves:
        yield f"no Hopf point in the range of {along}, so that no branch begins there"
    for number, curve in enumerate(curves, 1):
        errors = v["amplitude_error"].ravel()[v["branch"].ravel() == number]
        yield f"branch {number}, {_ends(curve, along)}: {_extent(curve, errors, along)}"
        yield from _special_of_branch(curve, along)
        if curve.stable_ranges:
            yield f"  stable cycles at {along} = {listed(curve.stable_ranges, errors_of([curve]))}"
        else:
            yield "  no stable cycle" if curve.is_decided else "  no cycle is known to be stable"
    if curves and not hidden:
        common = coexistence(view, rod)
        nowhere = "nowhere in the range" if coexistence_is_decided(view, rod) else "not known"
        words = f"{along} = {listed(common, errors_of(curves))}" if common else nowhere
        yield f"{BESIDE_STRAIGHT}: {words}"
        if pairs := two_cycles(view, rod):
            yield f"{TWO_CYCLES}: {along} = {listed(pairs, errors_of(curves))}"


def _extent(curve: StoredBranch, errors: Array, along: str) -> str:
    """Number of cycles of a branch with their ranges; errors: relative, of the largest tip y, (cycles,)."""
    cycles = curve.cycles
    if not cycles.any():
        return "no cycle is stored"
    sizes = curve.y[cycles]
    ranges = f"{along} = {span(curve.at[cycles])}, largest tip y {span(sizes, errors * sizes)} L"
    return f"{counted(int(cycles.sum()), 'cycle')}, {ranges}"


def _special_of_branch(curve: StoredBranch, along: str) -> Iterator[str]:
    """Yields a line about each special point between the ends of a branch."""
    for special in curve.special:
        if special.kind in ("hopf", "end"):
            continue
        if special in (curve.special[0], curve.special[-1]) and special.kind == "symmetry_breaking":
            continue
        at = to_error(special.at, special.error)
        kind = special.kind.replace("_", " ")
        kind += f", where branch {special.meets} meets it," * (special.meets > 0)
        period = to_error(special.period, special.period * special.period_error)
        y = to_error(special.tip_y_max, special.tip_y_max * special.tip_y_max_error)
        yield f"  {kind} at {along} = {at}, period {period} tau2, largest tip y {y} L"


def _ends(curve: StoredBranch, along: str) -> str:
    """Start and end of a branch, as text."""
    first = curve.special[0]
    last = curve.special[-1]
    start = f"from the Hopf point at {along} = {to_error(first.at, first.error)}"
    if first.kind == "symmetry_breaking":
        where = f"{along} = {to_error(first.at, first.error)}"
        start = f"without mirror symmetry, from branch {first.meets} at {where}"
    end = f"{along} = {to_error(last.at, last.error)}"
    if last.kind == "hopf":
        return f"{start} to that at {end}"
    if last.kind == "symmetry_breaking":
        return f"{start} to branch {last.meets} at {end}"
    if last.kind == "left_the_model":
        return f"{start} to a cycle with h1 = 0, {end}"
    return f"{start} to {ENDS[last.reason]}, {along} = {rounded(last.at, last.error)}"


def coexistence(view: View, rod: int) -> list[Range]:
    """Ranges of the parameter with a stable cycle on a branch and a stable straight rod."""
    stable = union(piece for curve in curves_of(view, rod) for piece in curve.stable_ranges)
    return intersection(stable, straight_ranges(view, rod, ends_of(view))[0])


def two_cycles(view: View, rod: int) -> list[Range]:
    """Ranges of the parameter in which cycles on two branches are stable."""
    pairs = combinations([curve.stable_ranges for curve in curves_of(view, rod)], 2)
    return union(piece for one, other in pairs for piece in intersection(one, other))


def errors_of(curves: Iterable[StoredBranch]) -> dict[float, float]:
    """Absolute errors of the special points of branches, by their positions."""
    return {float(special.at): special.error for curve in curves for special in curve.special}


def ends_of(view: View) -> Range:
    """(start, stop) of the followed parameter."""
    options = view.config["branch"]
    return float(options["start"]), float(options["stop"])


def _sizes(view: View, done: np.ndarray) -> str:
    """Clause on the period and the amplitude of all cycles of the points in `done`; may be empty."""
    v = view.variables
    if not np.isfinite(v["period"][done]).any():
        return ""
    period, y = (span_of(v, name, done) for name in ("period", "tip_y_max"))
    return f": period {period} tau2, largest tip y {y} L"


def _special_lines(view: View, rods: np.ndarray) -> Iterator[str]:
    """Yields lines about the special points of each kind, and about ends of branches."""
    along = followed_parameter(view)
    found: dict[str, list[tuple[float, float]]] = {word: [] for word in (*SPECIAL_WORDS, *ENDS)}
    for rod in rods:
        for number, curve in enumerate(curves_of(view, int(rod)), 1):
            for special in curve.special:
                kind = special.reason if special.kind == "end" else special.kind
                is_counted = 0 < special.meets < number  # with the other branch at this point
                if kind in found and not is_counted:
                    found[kind].append((special.at, special.error))
    for kind, located in found.items():
        if not located:
            continue
        where = f"{along} = {span(*np.array(located).T)}"
        if kind in SPECIAL_WORDS:
            yield f"{counted(len(located), SPECIAL_WORDS[kind])}: {where}"
        else:
            verb = "leads" if len(located) == 1 else "lead"
            yield f"{counted(len(located), 'branch')} {verb} to {ENDS[kind]}: {where}"
    yield from _stopped(view, rods)


def _stopped(view: View, rods: np.ndarray) -> Iterator[str]:
    """Yields lines about branches that could not be followed to the end, some with the rod's parameters."""
    along = followed_parameter(view)
    ends = [
        (int(rod), number, curve.special[-1])
        for rod in rods
        for number, curve in enumerate(curves_of(view, int(rod)), 1)
        if curve.special[-1].reason == "no_cycle_found"
    ]
    for rod, number, end in ends[:NAMED_RODS]:
        yield f"  {at_point(view, rod)}: branch {number}, at {along} = {rounded(end.at, end.error)}"
    if len(ends) > NAMED_RODS:
        yield f"  and {counted(len(ends) - NAMED_RODS, 'branch')} more"


def _coexistence(view: View, rods: np.ndarray) -> Iterator[str]:
    """Yields lines about rods with two stable states, some with parameters."""
    complete = [int(rod) for rod in rods if not count_incomplete_branches(view, int(rod))]
    if len(complete) < len(rods):
        yield f"not known for {counted(len(rods) - len(complete), 'rod')}: {LIST_TOO_SHORT}"
    if not complete:
        return
    yield from _rods_with(view, complete, BESIDE_STRAIGHT, coexistence)
    if any(two_cycles(view, rod) for rod in complete):
        yield from _rods_with(view, complete, TWO_CYCLES, two_cycles)


def _rods_with(
    view: View, rods: list[int], words: str, ranges_of: Callable[[View, int], list[Range]]
) -> Iterator[str]:
    """Yields the number of rods with a property, and ranges of the parameter for some rods."""
    along = followed_parameter(view)
    having = [(rod, ranges) for rod in rods if (ranges := ranges_of(view, rod))]
    others = set(rods).difference(rod for rod, _ in having)
    unknown = sum(not coexistence_is_decided(view, rod) for rod in others)
    yield f"{words} at {some_of(len(having), len(rods), 'rod')}{not_known(unknown)}"
    for rod, ranges in having[:NAMED_RODS]:
        where = f"{along} = {listed(ranges, errors_of(curves_of(view, rod)))}"
        yield f"  {': '.join(filter(None, (at_point(view, rod), where)))}"
    if len(having) > NAMED_RODS:
        yield f"  and {counted(len(having) - NAMED_RODS, 'rod')} more"


def _searched(view: View, done: np.ndarray) -> str:
    """Line on the followed range and the completeness of the branches."""
    start, stop = ends_of(view)
    along = followed_parameter(view)
    proved = some_of(view.variables["certified"][done].sum(), done.sum(), "rod")
    return (
        f"followed in {along} from {start:g} to {stop:g}; the list of Hopf points {completeness(view)} at "
        f"{proved}; cycles that lie on no branch from a Hopf point are not found"
    )
