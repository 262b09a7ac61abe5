"""Thresholds of the straight rod in `rodsweep show`: positions, completeness, and cost of the search."""

from collections.abc import Sequence

import numpy as np

from ...model.parameters import PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts.rods import has_standard_rods
from ...results.layouts.thresholds import CROSSING_KINDS, CROSSING_MEANINGS
from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import count_of_total, counted, plural
from .arm.arm import crossings_of_arm
from .number_texts import error_text, number_and_error, rounded_text, span_text
from .stability import FORCE_THRESHOLD_WORDS
from .summary_lines import SummaryLines, TextTable, in_brackets, point_text, proof_clause
from .threshold_trends import monotonicity_lines

RATE_VARIABLE_BY_THRESHOLD_KIND = {
    "hopf": ("hopf_frequency", "frequency", ANGULAR_UNIT),
    "restabilization": ("restabilization_frequency", "frequency", ANGULAR_UNIT),
    "onset": ("onset_growth_rate", "growth rate", "1/tau2"),
}
"""(second variable of the first threshold, name and unit of this variable), by kind of threshold."""
ENDED_EARLY = "ended_early"
"""Status of a search that stopped before the requested force."""
FIRST_CROSSING_WORDS = {
    "onset": "decaying oscillation from",
    "hopf": "flutter from",
    "restabilization": "stable again from",
}
"""Phrase before the force of the first crossing of each kind, in the summary of a single rod."""
LATER_CROSSING_WORDS = {"hopf": "flutter again from", "restabilization": "stable again from"}
"""Phrase before the force of a later window of flutter: of its start and of its end."""


def later_flutter_changes(kinds: Sequence[str]) -> list[int]:
    """Indices, in a list of crossings, of the starts and ends of all windows of flutter after the first
    window. kinds: kinds of the crossings, in the order of the force."""
    indices = []
    expected = "restabilization"
    for index, kind in enumerate(kinds):
        if kind == expected:
            indices.append(index)
            expected = "hopf" if expected == "restabilization" else "restabilization"
    return indices[1:]  # the first is the end of the first window


def thresholds_summary(view: ResultView, computed: np.ndarray) -> SummaryLines:
    """Summary of thresholds. computed: mask of the computed points, of the shape of the points."""
    if computed.size == 1:
        details = cost_lines(view, computed)
        arm_sentences = crossings_of_arm(view)
        return SummaryLines(
            single_rod_crossing_lines(view),
            completeness_lines(view),
            details,
            arm_sentences,
            crossing_table(view),
        )
    answer = [first_threshold_line(view, computed, event) for event in RATE_VARIABLE_BY_THRESHOLD_KIND]
    reliability = search_lines(view, computed, "rod")
    ends = view.variables["F_end"][computed]
    if np.isfinite(ends).any():
        reliability.append(f"searched up to F = {span_text(ends)}")
    return SummaryLines(answer, reliability, [*monotonicity_lines(view), *cost_lines(view, computed)])


def first_threshold_line(view: ResultView, computed: np.ndarray, event: str) -> str:
    """Line on the forces and rates at the first threshold of the kind `event`, and on the numbers of rods
    with this threshold and with an unknown result. computed: mask of the computed points, of the shape of the
    points."""
    phrase = FORCE_THRESHOLD_WORDS[event]
    rate_name, noun, unit = RATE_VARIABLE_BY_THRESHOLD_KIND[event]
    variables = view.variables
    F = np.where(computed, variables[f"F_{event}"], np.nan).ravel()
    mask = np.isfinite(F)
    rods = int(computed.sum())
    searched = variables["crossing_count"].ravel() >= 0
    decided = searched & ~np.isfinite(variables["open_from"].ravel()) & ~view.has_status(ENDED_EARLY).ravel()
    unknown_text = unknown_clause(int((computed.ravel() & ~mask & ~decided).sum()))
    if not mask.any():
        return f"{phrase}: at none of {counted(rods, 'rod')}{unknown_text}"
    table, stored_errors = map(view.by_point, ("crossing_F", "crossing_error"))
    errors = np.where(table == F[:, None], stored_errors, 0.0).max(axis=1)
    ends = (int(np.nanargmin(F)), int(np.nanargmax(F)))
    extremes = [f"{rounded_text(F[i], errors[i])}{in_brackets(point_text(view, i))}" for i in ends]
    forces_text = " to ".join(extremes if extremes[0] != extremes[1] else extremes[:1])
    every_rod_text = f"all {counted(rods, 'rod')}"
    rods_text = every_rod_text if mask.sum() == rods else count_of_total(int(mask.sum()), rods, "rod")
    rates_text = span_text(variables[rate_name][computed])
    return f"{phrase}: F = {forces_text}, at {rods_text}{unknown_text}; {noun} {rates_text} {unit}"


def unknown_beyond_clause(view: ResultView, F: float) -> str:
    """Clause that says that the search for a single rod ended early at the force F; empty for a complete
    search."""
    clause = f"; not known beyond F = {F:.6g}, where the search ended early"
    return clause if view.has_status(ENDED_EARLY).all() else ""


def single_rod_crossing_lines(view: ResultView) -> list[str]:
    """Lines about the first thresholds and the number of crossings of the only rod in a file, and the meaning
    of the kinds of crossings."""
    variables = view.point_values(0)
    end_text = f"F = {variables['F_end']:.15g}{unknown_beyond_clause(view, float(variables['F_end']))}"
    if kinds := [
        CROSSING_KINDS[int(kind)] for kind in variables["crossing_kind"][variables["crossing_kind"] > 0]
    ]:
        first_forces = {word: variables[f"F_{event}"] for event, word in FIRST_CROSSING_WORDS.items()}
        changes = [f"{word} F = {F:.6g}" for word, F in first_forces.items() if np.isfinite(F)]
        for i in later_flutter_changes(kinds):
            changes.append(f"{LATER_CROSSING_WORDS[kinds[i]]} F = {variables['crossing_F'][i]:.6g}")
        text = ", ".join(changes)
        count_text = f"{counted(int(variables['crossing_count']), 'crossing')} up to {end_text}"
        meanings = (f"{kind}: {CROSSING_MEANINGS[kind]}" for kind in dict.fromkeys(kinds))
        return ["; ".join(filter(None, (text, count_text))), *meanings]
    if variables["crossing_count"] < 0:
        return ["the thresholds of this rod are not known"]
    none_text = "no threshold is located" if np.isfinite(variables["open_from"]) else "no threshold"
    return [f"{none_text} up to {end_text}"]


def crossing_table(view: ResultView) -> TextTable | None:
    """Table of the crossings of the only rod in a file; None if there is no crossing."""
    variables = view.point_values(0)
    rows = []
    for i in np.flatnonzero(variables["crossing_kind"] > 0):
        F = number_and_error(float(variables["crossing_F"][i]), float(variables["crossing_error"][i]))
        rates = (f"{variables[f'crossing_{name}'][i] + 0.0:.6g}" for name in ("growth_rate", "frequency"))
        unstable_count = int(variables["unstable_after"][i])
        kind = CROSSING_KINDS[int(variables["crossing_kind"][i])]
        rows.append((kind, *F, *rates, str(unstable_count) if unstable_count >= 0 else "not known"))
    unit = PARAMETERS["F"].unit
    rate_headings = ("growth rate\n1/tau2", f"frequency\n{ANGULAR_UNIT}", "unstable\nabove")
    return TextTable(("kind", f"F\n{unit}", "+-", *rate_headings), tuple(rows)) if rows else None


def completeness_lines(view: ResultView) -> list[str]:
    """Lines on the searched range, the completeness of the list of crossings, and the undecided range, for
    the only rod in a file."""
    variables = view.point_values(0)
    unlisted = int(variables["crossing_count"]) - int((variables["crossing_kind"] > 0).sum())
    proof_text = proof_clause(view)
    if not variables["certified"]:
        proof_text = proof_text.replace("is ", "is not ", 1)
    search_text = f"searched up to F = {variables['F_end']:.15g}; " if np.isfinite(variables["F_end"]) else ""
    lines = [f"{search_text}the list of crossings {proof_text}{unstored_crossings_clause(max(unlisted, 0))}"]
    if np.isfinite(variables["open_from"]):
        lines.append(
            f"undecided from F = {variables['open_from']:.9g} to {variables['open_to']:.9g}: this range may "
            "contain a window of flutter that is too narrow to be resolved"
        )
    return lines


def unknown_clause(rod_count: int) -> str:
    """Clause on the number of rods whose search failed or left a range of F unsearched; empty for 0."""
    return f", not known at {counted(rod_count, 'rod')}" if rod_count else ""


def unstored_crossings_clause(crossing_count: int) -> str:
    """Clause on the number `crossing_count` of crossings that are not stored because the list was full; empty
    for 0."""
    verb_form = "is" if crossing_count == 1 else "are"
    return (
        f"; {crossing_count} more {verb_form} not stored, raise the option crossings"
        if crossing_count > 0
        else ""
    )


def search_lines(view: ResultView, computed: np.ndarray, noun: str) -> list[str]:
    """Lines about completeness, undecided ranges, numbers of stored crossings and errors of the searches.

    computed: mask of the computed points, of the shape of the points.
    """
    variables = view.variables
    searches = int(computed.sum())
    is_crossing = variables["crossing_kind"][computed] > 0
    stored_counts = is_crossing.sum(axis=-1)
    errors = variables["crossing_error"][computed][is_crossing]
    known_errors = errors[np.isfinite(errors)]
    error_bound_clause = (
        f"; absolute error at most {error_text(float(known_errors.max()))}" if known_errors.size else ""
    )
    undecided = int(np.isfinite(variables["open_from"][computed]).sum())
    proved_text = count_of_total(int(variables["certified"][computed].sum()), searches, noun)
    window = f"; for {counted(undecided, noun)} a narrow window of flutter may be missing" * (undecided > 0)
    unlisted = int((variables["crossing_count"][computed] - stored_counts).clip(min=0).sum())
    lines = [f"the list of crossings {proof_clause(view)} for {proved_text}{window}"]
    if stored_counts.any() or unlisted:
        lines.append(
            f"crossings stored: {int(stored_counts.sum())}, at most {int(stored_counts.max())} on a "
            f"{noun}{error_bound_clause}{unstored_crossings_clause(unlisted)}"
        )
    return lines


def cost_lines(view: ResultView, computed: np.ndarray) -> list[str]:
    """List with a line on the cost of the searches. computed: mask of the computed points, of the shape of
    the points.

    The list is empty for searches that count unstable modes, which store no cost.
    """
    if not has_standard_rods(view.config):
        return []
    variables = view.variables
    boxes, solve_counts = (variables[name][computed] for name in ("boxes", "solves"))
    return [
        f"cost of a search: {count_range(boxes, 'evaluation')} of the determinant D over a box, "
        f"{count_range(solve_counts, 'eigenproblem')}"
    ]


def count_range(values: np.ndarray, noun: str) -> str:
    """Range of the integer counts `values`, (n,), as text."""
    text = span_text(values)
    return f"{text} {noun if text == '1' else plural(noun)}"
