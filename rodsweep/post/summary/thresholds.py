"""Thresholds of the straight rod in `rodsweep show`: positions, completeness, and cost of the search."""

from collections.abc import Mapping, Sequence

import numpy as np

from ...model.parameters import PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts.rod_properties import has_uniform_linear_rods
from ...results.layouts.thresholds import CROSSING_KINDS, CROSSING_MEANINGS
from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import counted, is_or_are, plural
from .arm.arm_texts import single_arm_threshold_lines
from .number_texts import error_text, rounded_text, value_range_text
from .selection import PointSelection, in_brackets
from .stability import FORCE_THRESHOLD_WORDS
from .summary_lines import SummaryLines, TextTable, completeness_predicate, number_table, point_text
from .threshold_trends import monotonicity_lines

RATE_VARIABLE_BY_THRESHOLD_KIND = {
    "hopf": ("hopf_frequency", "frequency", ANGULAR_UNIT),
    "restabilization": ("restabilization_frequency", "frequency", ANGULAR_UNIT),
    "onset": ("onset_growth_rate", "growth rate", "1/tau2"),
}
"""(second variable of the first threshold, name and unit of this variable), by kind of threshold."""
ENDED_EARLY_STATUS = "ended_early"
"""Status of a search that stopped before the requested force."""
FIRST_CROSSING_WORDS = {
    "onset": "decaying oscillation from",
    "hopf": "flutter from",
    "restabilization": "stable again from",
}
"""Phrase before the force of the first crossing of each kind, in the summary of a single rod."""
LATER_CROSSING_WORDS = {"hopf": "flutter again from", "restabilization": "stable again from"}
"""Phrase before the force at which a later window of flutter starts ("hopf") or ends ("restabilization")."""
OSCILLATION_END_KINDS = ("real_again", "real_leads")
"""Kinds of thresholds of a stable rod at which the leading pair of eigenvalues becomes real, or is overtaken
by a real eigenvalue."""


def oscillation_end_index(kinds: Sequence[str]) -> int | None:
    """Index, in a list of crossings, of the crossing that ends, without flutter, the oscillation that starts
    at the first onset; None if there is no such crossing. kinds: kinds of the crossings, in the order of the
    force."""
    after_onset = list(kinds).index("onset") + 1 if "onset" in kinds else len(kinds)
    return after_onset if after_onset < len(kinds) and kinds[after_onset] in OSCILLATION_END_KINDS else None


def later_flutter_change_indices(kinds: Sequence[str]) -> list[int]:
    """Indices, in a list of crossings, of the starts and ends of all windows of flutter after the first
    window. kinds: kinds of the crossings, in the order of the force."""
    indices = []
    expected = "restabilization"
    for index, kind in enumerate(kinds):
        if kind == expected:
            indices.append(index)
            expected = "hopf" if expected == "restabilization" else "restabilization"
    return indices[1:]  # the first is the end of the first window


def thresholds_summary(points: PointSelection) -> SummaryLines:
    """Summary of thresholds at the computed points."""
    view = points.view
    costs = search_cost_lines(points)
    if points.mask.size == 1:
        return SummaryLines(
            single_rod_crossing_lines(view),
            completeness_lines(view),
            costs,
            single_arm_threshold_lines(view),
            crossing_table(view),
        )
    answer = [first_threshold_line(points, event) for event in RATE_VARIABLE_BY_THRESHOLD_KIND]
    reliability = search_reliability_lines(points, "rod")
    if np.isfinite(points.values("F_end")).any():
        reliability.append(points.sentence_with_ranges("searched up to F = {F_end}"))
    return SummaryLines(answer, reliability, [*monotonicity_lines(view), *costs])


def first_threshold_line(points: PointSelection, event: str) -> str:
    """Line on the forces and rates at the first threshold of the kind `event`, and on the numbers of rods
    with this threshold and with an unknown result."""
    view = points.view
    phrase = FORCE_THRESHOLD_WORDS[event]
    rate_name, noun, unit = RATE_VARIABLE_BY_THRESHOLD_KIND[event]
    rods_text = counted(points.count, "rod")
    with_threshold = points.where(np.isfinite(points.variables[f"F_{event}"]))
    decided = (points.variables["crossing_count"] >= 0) & ~np.isfinite(points.variables["open_from"])
    decided &= ~view.has_status(ENDED_EARLY_STATUS)
    unknown_text = failed_search_count_clause(points.where(~(with_threshold.mask | decided)).count)
    if not with_threshold.count:
        return f"{phrase}: at none of {rods_text}{unknown_text}"
    F = with_threshold.values(f"F_{event}")
    is_first = with_threshold.values("crossing_F") == F[:, np.newaxis]
    errors = np.where(is_first, with_threshold.values("crossing_error"), 0.0).max(axis=1)
    indices = np.flatnonzero(with_threshold.mask)
    extremes = [
        f"{rounded_text(F[i], errors[i])}{in_brackets(point_text(view, indices[i]))}"
        for i in (F.argmin(), F.argmax())
    ]
    forces_text = " to ".join(dict.fromkeys(extremes))
    if with_threshold.count < points.count:
        rods_text = with_threshold.count_of_total_text(points, "rod")
    else:
        rods_text = f"all {rods_text}"
    rates_text = points.sentence_with_ranges(f"{noun} {{{rate_name}}} {unit}")
    return f"{phrase}: F = {forces_text}, at {rods_text}{unknown_text}; {rates_text}"


def early_search_end_clause(view: ResultView, F: float) -> str:
    """Clause that says that the search for a single rod ended early at the force F; empty for a complete
    search."""
    clause = f"; not known beyond F = {F:.6g}, where the search ended early"
    return clause if view.has_status(ENDED_EARLY_STATUS).all() else ""


def single_rod_crossing_lines(view: ResultView) -> list[str]:
    """Lines about the first thresholds and the number of crossings of the only rod in a file, and the meaning
    of the kinds of crossings."""
    variables = view.point_values(0)
    if variables["crossing_count"] < 0:
        return ["the thresholds of this rod are not known"]
    end_text = f"F = {variables['F_end']:.15g}{early_search_end_clause(view, float(variables['F_end']))}"
    kinds = stored_crossing_kinds(variables)
    if not kinds:
        is_undecided = np.isfinite(variables["open_from"])
        return [f"{'no threshold is located' if is_undecided else 'no threshold'} up to {end_text}"]
    first_forces = {event: f"{variables[f'F_{event}']:.6g}" for event in FIRST_CROSSING_WORDS}
    if (end := oscillation_end_index(kinds)) is not None:
        first_forces["onset"] += f" to {variables['crossing_F'][end]:.6g}"
    changes = [
        f"{word} F = {first_forces[event]}"
        for event, word in FIRST_CROSSING_WORDS.items()
        if np.isfinite(variables[f"F_{event}"])
    ]
    for i in later_flutter_change_indices(kinds):
        changes.append(f"{LATER_CROSSING_WORDS[kinds[i]]} F = {variables['crossing_F'][i]:.6g}")
    count_text = f"{counted(int(variables['crossing_count']), 'crossing')} up to {end_text}"
    meanings = (f"{kind}: {CROSSING_MEANINGS[kind]}" for kind in dict.fromkeys(kinds))
    return ["; ".join(filter(None, (", ".join(changes), count_text))), *meanings]


def stored_crossing_kinds(variables: Mapping[str, np.ndarray]) -> list[str]:
    """Kinds of the stored crossings of a single rod. variables: variables of the rod by name;
    lists have the shape (crossings,)."""
    return [CROSSING_KINDS[int(kind)] for kind in variables["crossing_kind"] if kind > 0]


def crossing_table(view: ResultView) -> TextTable | None:
    """Table of the crossings of the only rod in a file; None if there is no crossing."""
    variables = view.point_values(0)
    stored = variables["crossing_kind"] > 0
    growth_rates, frequencies = (
        [f"{value + 0.0:.6g}" for value in variables[f"crossing_{name}"][stored]]
        for name in ("growth_rate", "frequency")
    )
    unstable_counts = variables["unstable_after"][stored]
    return number_table(
        ("kind", stored_crossing_kinds(variables), None),
        (f"F\n{PARAMETERS['F'].unit}", variables["crossing_F"][stored], variables["crossing_error"][stored]),
        ("growth rate\n1/tau2", growth_rates, None),
        (f"frequency\n{ANGULAR_UNIT}", frequencies, None),
        ("unstable\nabove", [str(n) if n >= 0 else "not known" for n in unstable_counts], None),
    )


def completeness_lines(view: ResultView) -> list[str]:
    """Lines on the searched range, the completeness of the list of crossings, and the undecided range, for
    the only rod in a file."""
    variables = view.point_values(0)
    unlisted = int(variables["crossing_count"]) - len(stored_crossing_kinds(variables))
    proof_text = completeness_predicate(view)
    if not variables["certified"]:
        proof_text = proof_text.replace("is ", "is not ", 1)
    search_text = f"searched up to F = {variables['F_end']:.15g}; " if np.isfinite(variables["F_end"]) else ""
    lines = [f"{search_text}the list of crossings {proof_text}{unstored_crossings_clause(unlisted)}"]
    if np.isfinite(variables["open_from"]):
        lines.append(
            f"undecided from F = {variables['open_from']:.9g} to {variables['open_to']:.9g}: this range may "
            "contain a window of flutter that is too narrow to be resolved"
        )
    return lines


def failed_search_count_clause(rod_count: int) -> str:
    """Clause on the number of rods whose search failed or left a range of F unsearched; empty for 0."""
    return f", not known at {counted(rod_count, 'rod')}" if rod_count else ""


def unstored_crossings_clause(crossing_count: int) -> str:
    """Clause on the number `crossing_count` of crossings that are not stored because the list was full; empty
    for 0 and for an unknown number, -1."""
    text = f"; {crossing_count} more {is_or_are(crossing_count)} not stored, raise the option crossings"
    return text if crossing_count > 0 else ""


def proved_rod_count_text(points: PointSelection, noun: str) -> str:
    """Predicate for the lists of crossings of the points: "is proved complete for 2 of 4 rods". noun: word
    for a point."""
    certified = points.where(points.variables["certified"] > 0)
    return f"{completeness_predicate(points.view)} for {certified.count_of_total_text(points, noun)}"


def unstored_crossing_count(points: PointSelection) -> int:
    """Number of the crossings of all points that are not stored because the lists were full."""
    stored_counts = (points.values("crossing_kind") > 0).sum(axis=-1)
    return int((points.values("crossing_count") - stored_counts).clip(min=0).sum())


def search_reliability_lines(points: PointSelection, noun: str) -> list[str]:
    """Lines about completeness, undecided ranges, numbers of stored crossings and errors of the searches.
    noun: word for a point."""
    is_crossing = points.values("crossing_kind") > 0
    stored_counts = is_crossing.sum(axis=-1)
    errors = points.values("crossing_error")[is_crossing & np.isfinite(points.values("crossing_error"))]
    undecided = int(np.isfinite(points.values("open_from")).sum())
    window_text = f"; for {counted(undecided, noun)} a narrow window of flutter may be missing"
    lines = [f"the list of crossings {proved_rod_count_text(points, noun)}{window_text if undecided else ''}"]
    unlisted = unstored_crossing_count(points)
    if stored_counts.any() or unlisted:
        error_clause = f"; absolute error at most {error_text(float(errors.max()))}" if errors.size else ""
        lines.append(
            f"crossings stored: {int(stored_counts.sum())}, at most {int(stored_counts.max())} on a "
            f"{noun}{error_clause}{unstored_crossings_clause(unlisted)}"
        )
    return lines


def search_cost_lines(points: PointSelection) -> list[str]:
    """List with a line on the cost of the searches; empty for searches that count unstable modes, which store
    no cost."""
    if not has_uniform_linear_rods(points.view.config):
        return []
    boxes, solve_counts = (
        f"{text} {noun if text == '1' else plural(noun)}"
        for text, noun in (
            (value_range_text(points.values("boxes")), "evaluation"),
            (value_range_text(points.values("solves")), "eigenproblem"),
        )
    )
    return [f"cost of a search: {boxes} of the determinant D over a box, {solve_counts}"]
