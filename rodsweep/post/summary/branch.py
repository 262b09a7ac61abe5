"""Branches of cycles in `rodsweep show`: ends, special points, and ranges with two stable states.
parameter_name: name of the followed parameter."""

from collections.abc import Iterator, Sequence

import numpy as np

from ...arrays import Array
from ...wording import count_of_total, counted, is_or_are
from ..branch_curves import RodBranches, followed_parameter
from ..crushing import uncrushed_ranges
from ..range_unions import ParameterRange
from ..stored_branches import StoredBranch
from .followed_ranges import searched_range_line
from .number_texts import number_with_error_text, parameter_ranges_text, rounded_text, value_range_text
from .selection import PointSelection
from .summary_lines import SummaryLines, point_text, truncated_lines
from .thresholds import failed_search_count_clause

HIDDEN_BRANCHES_REASON = "the list of special points is full; raise branch.special"
"""Reason for which branches are not shown, and remedy."""
COEXISTENCE_WORDS = "stable cycles beside a stable straight rod"
"""Phrase for a range in which a stable cycle and the stable straight rod coexist."""
TWO_STABLE_CYCLES_WORDS = "two stable cycles, on different branches,"
"""Phrase for a range in which stable cycles of two branches coexist."""
CYCLE_RANGES_CLAUSE = ": period {period} tau2, largest tip y {tip_y_max} L"
"""Clause on the cycles of several rods."""
SPECIAL_POINT_WORDS = {
    "fold": "fold",
    "torus": "torus point",
    "symmetry_breaking": "symmetry breaking",
    "period_doubling": "period doubling",
}
"""Names of special points between the ends of a branch, by kind. Hopf points and ends are described in
separate sentences."""
BRANCH_END_WORDS = {
    "left_the_model": "a cycle that crushes a section of the rod",
    "range_end": "the end of the range",
    "crushed": "a force that almost crushes the rod",
    "no_cycle_found": "a cycle beyond which the branch was not followed",
    "list_full": "the last cycle within the limits branch.cycles and branch.work",
    "none": "an end for an unknown reason",
}
"""Phrase for the end of a branch, by reason of the end."""


def branch_summary(points: PointSelection) -> SummaryLines:
    """Summary of branches at the computed points."""
    view = points.view
    computed = points.mask
    reliability = [searched_range_line(points)]
    if computed.size == 1:
        return SummaryLines(list(_branch_lines_of_single_rod(RodBranches(view))), reliability)
    rods = [RodBranches(view, int(rod)) for rod in np.flatnonzero(computed.ravel())]
    counts = points.values("branch_count")
    branches_text, cycles_text = (
        counted(int(points.values(f"{name}_count").clip(min=0).sum()), noun)
        for name, noun in (("branch", "branch"), ("point", "cycle"))
    )
    line = f"{branches_text} at {count_of_total(int((counts > 0).sum()), len(rods), 'rod')}, {cycles_text}"
    if np.isfinite(points.values("period")).any():
        line += points.sentence_with_ranges(CYCLE_RANGES_CLAUSE)
    parameter = followed_parameter(view)
    answer = [line, *_special_point_lines(rods, parameter), *_coexistence_lines(rods, parameter)]
    ranges = uncrushed_ranges(view, (rod.index for rod in rods))
    if crushed_count := sum(low >= high for low, high in ranges):
        whole_range = f"everywhere in the range of {parameter}"
        answer.insert(1, f"the force crushes {count_of_total(crushed_count, len(rods), 'rod')} {whole_range}")
    return SummaryLines(answer, reliability)


def _branch_lines_of_single_rod(rod: RodBranches) -> Iterator[str]:
    """Yields lines about every branch of the only rod in a file, with the errors of its special points."""
    parameter = followed_parameter(rod.view)
    variables = rod.view.variables
    if rod.hidden_count:
        count_text = count_of_total(rod.hidden_count, rod.hidden_count + len(rod.curves), "branch")
        yield f"{count_text} {is_or_are(rod.hidden_count)} not shown: {HIDDEN_BRANCHES_REASON}"
    elif variables["branch_count"].max() < 0:
        yield "the branches of this rod are not known: its solve failed"
    elif not rod.curves:
        [(low, high)] = uncrushed_ranges(rod.view, [rod.index])
        if not low < high:
            yield f"the force crushes the rod everywhere in the range of {parameter}"
            return
        yield f"no Hopf point in the range of {parameter}, so that no branch begins there"
    for number, curve in enumerate(rod.curves, 1):
        errors = variables["amplitude_error"].ravel()[variables["branch"].ravel() == number]
        cycles_text = _cycles_and_ranges_text(curve, errors, parameter)
        yield f"branch {number}, {_ends_phrase(curve, parameter)}: {cycles_text}"
        yield from _special_point_lines_between_ends(curve, parameter)
        if curve.stable_ranges:
            text = parameter_ranges_text(curve.stable_ranges, curve.special_point_parameter_errors)
            yield f"  stable cycles at {parameter} = {text}"
        else:
            yield "  no stable cycle" if curve.is_fully_known else "  no cycle is known to be stable"
    if rod.curves and not rod.hidden_count:
        nowhere_text = "nowhere in the range" if rod.is_coexistence_known else "not known"
        ranges = rod.coexistence_ranges
        errors = rod.special_point_parameter_errors
        text = f"{parameter} = {parameter_ranges_text(ranges, errors)}" if ranges else nowhere_text
        yield f"{COEXISTENCE_WORDS}: {text}"
        if pairs := rod.two_stable_cycle_ranges:
            yield f"{TWO_STABLE_CYCLES_WORDS} at {parameter} = {parameter_ranges_text(pairs, errors)}"


def _cycles_and_ranges_text(curve: StoredBranch, errors: Array, parameter_name: str) -> str:
    """Number of cycles on a branch, range of the parameter `parameter_name`, and range of the largest tip y,
    as text. errors: relative errors of y, (cycles,)."""
    cycles = curve.is_cycle
    if not cycles.any():
        return "no cycle is stored"
    sizes = curve.tip_y_max[cycles]
    y_text = f"largest tip y {value_range_text(sizes, errors * sizes)} L"
    text = f"{parameter_name} = {value_range_text(curve.parameter[cycles])}, {y_text}"
    return f"{counted(int(cycles.sum()), 'cycle')}, {text}"


def _special_point_lines_between_ends(curve: StoredBranch, parameter_name: str) -> Iterator[str]:
    """Yields one line for each special point between the ends of a branch."""
    for special in curve.special_points:
        if special.kind in ("hopf", "end"):
            continue
        if (
            special in (curve.special_points[0], curve.special_points[-1])
            and special.kind == "symmetry_breaking"
        ):
            continue
        position_text = number_with_error_text(special.at, special.error)
        kind = special.kind.replace("_", " ")
        kind += f", where branch {special.meets} meets it," * (special.meets > 0)
        period_text = number_with_error_text(special.period, special.period * special.period_error)
        y_text = number_with_error_text(special.tip_y_max, special.tip_y_max * special.tip_y_max_error)
        yield (
            f"  {kind} at {parameter_name} = {position_text}, period {period_text} tau2, "
            f"largest tip y {y_text} L"
        )


def _ends_phrase(curve: StoredBranch, parameter_name: str) -> str:
    """Phrase for the start and the end of a branch: "from ... to ..."."""
    first = curve.special_points[0]
    last = curve.special_points[-1]
    position_text = f"{parameter_name} = {number_with_error_text(first.at, first.error)}"
    start_text = f"from the Hopf point at {position_text}"
    if first.kind == "symmetry_breaking":
        start_text = f"without mirror symmetry, from branch {first.meets} at {position_text}"
    if curve.starts_outside_range:
        position_text = f"{parameter_name} = {rounded_text(first.at, first.error)}"
        start_text = f"from beyond {BRANCH_END_WORDS[first.reason]}, {position_text},"
    end_text = f"{parameter_name} = {number_with_error_text(last.at, last.error)}"
    if last.kind == "hopf":
        return f"{start_text} to that at {end_text}"
    if last.kind == "symmetry_breaking":
        return f"{start_text} to branch {last.meets} at {end_text}"
    if last.kind == "left_the_model":
        return f"{start_text} to {BRANCH_END_WORDS[last.kind]}, {end_text}"
    return (
        f"{start_text} to {BRANCH_END_WORDS[last.reason]}, {parameter_name} = "
        f"{rounded_text(last.at, last.error)}"
    )


def _special_point_lines(rods: Sequence[RodBranches], parameter_name: str) -> Iterator[str]:
    """Yields lines on the number and range of special points of each kind, and of branch ends, over all rods;
    then a line for each branch that was not followed to its end."""
    points: dict[str, list[tuple[float, float]]] = {w: [] for w in (*SPECIAL_POINT_WORDS, *BRANCH_END_WORDS)}
    rods_and_curves = [(rod, number, curve) for rod in rods for number, curve in enumerate(rod.curves, 1)]
    entries = [curve.special_points[0] for _, _, curve in rods_and_curves if curve.starts_outside_range]
    for _, number, curve in rods_and_curves:
        for special in curve.special_points[curve.starts_outside_range :]:
            kind = special.reason if special.kind == "end" else special.kind
            is_counted = 0 < special.meets < number  # already counted on the other branch at this point
            if kind in points and not is_counted:
                points[kind].append((special.at, special.error))
    for kind, located in points.items():
        if not located:
            continue
        span = f"{parameter_name} = {value_range_text(*np.array(located).T)}"
        if kind in SPECIAL_POINT_WORDS:
            yield f"{counted(len(located), SPECIAL_POINT_WORDS[kind])}: {span}"
        else:
            verb = "ends" if len(located) == 1 else "end"
            yield f"{counted(len(located), 'branch')} {verb} at {BRANCH_END_WORDS[kind]}: {span}"
    if entries:
        span = value_range_text(*np.array([(entry.at, entry.error) for entry in entries]).T)
        verb = "enters" if len(entries) == 1 else "enter"
        yield f"{counted(len(entries), 'branch')} {verb} the range from beyond: {parameter_name} = {span}"
    stopped = []
    for rod, number, curve in rods_and_curves:
        if (end := curve.special_points[-1]).reason == "no_cycle_found":
            position_text = f"{parameter_name} = {rounded_text(end.at, end.error)}"
            stopped.append(f"{point_text(rod.view, rod.index)}: branch {number}, at {position_text}")
    yield from truncated_lines(stopped, "branch")


def _coexistence_lines(rods: Sequence[RodBranches], parameter_name: str) -> Iterator[str]:
    """Yields lines on the number of rods with two stable states, and on the ranges of the first such rods."""
    complete = [rod for rod in rods if not rod.hidden_count]
    if len(complete) < len(rods):
        unknown_rods_text = counted(len(rods) - len(complete), "rod")
        yield f"whether two states are stable is not known for {unknown_rods_text}: {HIDDEN_BRANCHES_REASON}"
    if complete:
        coexistence = [rod.coexistence_ranges for rod in complete]
        yield from _lines_on_rods_with_ranges(complete, parameter_name, COEXISTENCE_WORDS, coexistence)
    two_cycles = [rod.two_stable_cycle_ranges for rod in complete]
    if any(two_cycles):
        yield from _lines_on_rods_with_ranges(complete, parameter_name, TWO_STABLE_CYCLES_WORDS, two_cycles)


def _lines_on_rods_with_ranges(
    rods: Sequence[RodBranches], parameter_name: str, phrase: str, ranges: Sequence[list[ParameterRange]]
) -> Iterator[str]:
    """Yields a line with the number of rods that have ranges with the property `phrase`, and a line for each
    of the first such rods. ranges: for each rod, ranges of the parameter `parameter_name` with the
    property."""
    unknown = 0
    texts = []
    for rod, rod_ranges in zip(rods, ranges, strict=True):
        unknown += not (rod_ranges or rod.is_coexistence_known)
        if rod_ranges:
            text = (
                f"{parameter_name} = {parameter_ranges_text(rod_ranges, rod.special_point_parameter_errors)}"
            )
            texts.append(": ".join(filter(None, (point_text(rod.view, rod.index), text))))
    yield f"{phrase} at {count_of_total(len(texts), len(rods), 'rod')}{failed_search_count_clause(unknown)}"
    yield from truncated_lines(texts, "rod")
