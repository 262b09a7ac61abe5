"""Limit cycles in `rodsweep show`: which rods oscillate, variables of the cycles, and reliability."""

from collections.abc import Callable

import numpy as np

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from ...results.layouts.limit_cycle import SECOND_STABLE_STATES, STATUS_NAMES_WITH_CYCLE
from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import count_of_total, counted
from ..located_thresholds import StoredThresholds
from .arm.arm_texts import arm_quantity_ranges_text
from .number_texts import error_text, value_range_text
from .selection import PointSelection, counts_and_ranges_text, varied_parameters_at_points
from .stability import rod_and_arm_stability_lines
from .summary_lines import SummaryLines, TextTable, completeness_predicate, number_table

OUTCOME_WORDS = {
    "cycle": "beats",
    "straight": "stays straight",
    "unstable": "has an unstable cycle",
    "torus": "beats quasiperiodically (two frequencies)",
    "not_settled": "does not settle",
    "left_the_model": "leaves the model",
    "failed": "is not solved",
}
"""Predicate for the rod at a point, by status; for other statuses the name of the status is used."""
SINGLE_CYCLE_TABLE_ROWS = (
    ("period", "period", "tau2"),
    ("frequency", "frequency", ANGULAR_UNIT),
    ("largest y of the tip", "tip_y_max", "L"),
    ("largest Floquet multiplier", "multiplier", ""),
)
"""(printed name, variable, unit) of the numbers printed for a single cycle."""
STRAIGHT_ROD_EIGENVALUE_SENTENCE = (
    "straight rod: leading growth rate {linear_growth_rate} 1/tau2, frequency {linear_frequency} rad/tau2"
)
"""Sentence on the eigenvalues of the straight rod."""
TORUS_SENTENCE = (
    "quasiperiodic motions: modulated at {modulation_ratio} times the frequency of the oscillation; the "
    "unstable cycles inside the tori have a largest |Floquet multiplier| of {multiplier}"
)
"""Sentence on the motions on tori."""
CYCLES_SENTENCE = "period: {period} tau2; largest y of the tip: {tip_y_max} L"
"""Sentence of the summary on the period and amplitude of the cycles of several points."""
CYCLE_DETAIL_SENTENCES = (
    "tip: least x {tip_x_min} L, largest x {tip_x_max} L, largest |theta| {tip_theta_max} rad",
    "mean power of the force: {injection_mean} k3/(L tau2)",
    "largest |Floquet multiplier|: {multiplier}; returns of the tip in the integration: {periods}; smallest "
    "stretch h1: {least_stretch}",
)
"""Further sentences of the summary on cycles: extrema, power, multipliers, returns and stretch."""
POSSIBLE_CYCLE_REASON = (
    "the Hopf point at F = {subcritical_F} is subcritical, so a larger initial deflection may lead to a "
    "cycle; `task: branch` follows the branch of these cycles"
)
"""Reason why a stable cycle may exist beside the stable straight rod."""
VARIABLES_OF_LARGEST_ERRORS = {
    "period": "period_error",
    "largest y of the tip": "amplitude_error",
    "other extrema of the tip": "extrema_error",
    "energy balance": "energy_imbalance",
    "multiplier": "multiplier_error",
}
"""Variables of which the largest absolute value is printed as error, by printed name."""


def limit_cycle_summary(points: PointSelection) -> SummaryLines:
    """Summary of limit cycles at the computed points."""
    view = points.view
    cycles = points.with_status("cycle")
    tori = points.with_status("torus")
    is_single = points.mask.size == 1
    stability_lines, arm_sentences = _threshold_lines(points)
    if view.quantities and not is_single and cycles.count < points.count:
        arm_sentences.insert(0, outcome_count_line(points, arm_quantity_ranges_text))
    answer = [outcome_count_line(points)]
    reliability = _hopf_completeness_lines(points)
    numbers = None
    if is_single and points.with_status(*STATUS_NAMES_WITH_CYCLE).count:
        answer.append(single_cycle_stability_line(points))
        numbers = single_cycle_table(points)
    elif cycles.count:
        answer.append(cycles.sentence_with_ranges(CYCLES_SENTENCE))
        reliability.insert(0, _error_line(cycles))
    details = [points.sentence_with_ranges(STRAIGHT_ROD_EIGENVALUE_SENTENCE)]
    details += [tori.sentence_with_ranges(TORUS_SENTENCE)] if tori.count else []
    details += _cycle_lines(cycles) if cycles.count else []
    answer += [*stability_lines, *_second_state_lines(points)]
    return SummaryLines(answer, reliability, details, arm_sentences, numbers)


def outcome_count_line(
    points: PointSelection, region: Callable[[PointSelection], str] = PointSelection.parameter_ranges_text
) -> str:
    """Line on the number of points with each outcome, and on their regions of parameters.

    region: function that describes the region of a selection of points.
    """
    view = points.view
    points_text = counted(points.count, "point")
    names = {
        name: OUTCOME_WORDS.get(name, name.replace("_", " "))
        for value, name in view.status_flags.items()
        if value >= 0
    }
    outcomes = points.parts_by_word({word: view.has_status(name) for name, word in names.items()})
    if len(outcomes) > 1:
        return f"of {points_text}: {counts_and_ranges_text(outcomes, region)}"
    (word,) = outcomes
    outcome_text = f"the rod {word}" if word in OUTCOME_WORDS.values() else word
    place_text = f"at all {points_text}" if points.count > 1 else "at the only solved point"
    return outcome_text if points.mask.size == 1 else f"{outcome_text} {place_text}"


def _threshold_lines(points: PointSelection) -> tuple[list[str], list[str]]:
    """Returns (lines, lines in an arm's units) about thresholds of the straight rod along F, or along all
    varied parameters if F is not varied."""
    view = points.view
    names = [
        name for name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES if name in varied_parameters_at_points(view)
    ]
    lines = list[str]()
    arm_sentences = list[str]()
    for name in names[:1] if "F" in names else names:
        thresholds_on = StoredThresholds(view, name).thresholds_up_to_end
        rod_lines, arm_lines = rod_and_arm_stability_lines(view, name, thresholds_on)
        lines += rod_lines
        arm_sentences += arm_lines
    return lines, arm_sentences


def _hopf_completeness_lines(points: PointSelection) -> list[str]:
    """Sentence, in a list, on whether the Hopf points are proved complete; empty if no line of points was
    searched."""
    variables = points.variables
    line_count = int(variables["hopf_lines"]) if "hopf_lines" in variables else 0
    if not line_count:
        return []
    proved_text = count_of_total(int(variables["hopf_lines_proved"]), line_count, "line")
    subject = "the list of Hopf points between neighbouring points"
    return [f"{subject} {completeness_predicate(points.view)} for {proved_text}"]


def single_cycle_stability_line(points: PointSelection) -> str:
    """Line that says whether the only cycle in a file is stable, or that no Floquet multiplier is
    computed."""
    if np.isnan(points.variables["multiplier"]).all():
        return "the motion in time settles on the cycle; no Floquet multiplier is computed"
    if points.with_status("cycle").count:
        return "the cycle is stable in the plane: its largest nontrivial Floquet multiplier is below 1"
    return "the cycle is unstable: its largest nontrivial Floquet multiplier is above 1"


def single_cycle_table(points: PointSelection) -> TextTable | None:
    """Table of the numbers of the only cycle in a file, with errors; None if no number is known."""
    known = [row for row in SINGLE_CYCLE_TABLE_ROWS if np.isfinite(points.values(row[1])).all()]
    numbers = [points.values(name).max() for _, name, _ in known]
    errors = np.array([points.absolute_errors(name).max() for _, name, _ in known])
    labels = [label for label, _, _ in known]
    units = [unit for _, _, unit in known]
    return number_table(("", labels, None), ("value", numbers, errors), ("unit", units, None))


def _second_state_lines(points: PointSelection) -> list[str]:
    """Lines about points at which a second stable state is certain or possible, or at which the straight rod
    is stable but the motion ended in no stable state."""
    states = points.variables["second_state"]
    numbers = {word: number for number, word in SECOND_STABLE_STATES}
    straight = points.where(states == numbers["straight"])
    bistable = straight.with_status("cycle", "torus")
    straight_only = straight.where(~bistable.mask)
    possible = points.where(states == numbers["cycle_possible"])
    lines = []
    if bistable.count:
        lines.append(
            f"two stable states{_point_count_clause(bistable, points)}: the straight rod is stable as well"
        )
    if straight_only.count:
        place_text = _point_count_clause(straight_only, points)
        lines.append(f"the straight rod is stable{place_text} where the motion reached no stable state")
    if possible.count:
        place_text = _point_count_clause(possible, points)
        reason = possible.sentence_with_ranges(POSSIBLE_CYCLE_REASON)
        lines.append(f"a stable cycle may exist beside the straight rod{place_text}: {reason}")
    return lines


def _point_count_clause(part: PointSelection, points: PointSelection) -> str:
    """Clause " at m of n points", m: number of points of `part`, n: number of `points`, which contain `part`;
    empty if n = 1."""
    return "" if points.count == 1 else f" at {part.count_of_total_text(points)}"


def _cycle_lines(cycles: PointSelection) -> list[str]:
    """Lines on frequency, period in tau1, extrema of the tip, power, multiplier, returns of the tip in the
    integration, and smallest h1 of the cycles."""
    lines = [
        cycles.sentence_with_ranges("frequency of the cycle: {frequency} rad/tau2")
        + _mode_frequency_clause(cycles)
    ]
    if "period_tau1" in cycles.variables:
        lines.append(cycles.sentence_with_ranges("period: {period_tau1} tau1"))
    return [*lines, *map(cycles.sentence_with_ranges, CYCLE_DETAIL_SENTENCES)]


def _mode_frequency_clause(cycles: PointSelection) -> str:
    """Clause that compares the frequencies of the cycles with the frequencies of the leading modes; empty if
    no frequency of a leading mode is known."""
    mode_frequencies = cycles.variables["linear_frequency"]
    oscillating = cycles.where(np.abs(mode_frequencies) > 0)
    steady = cycles.where(mode_frequencies == 0)
    clause = ""
    if oscillating.count:
        ratio = oscillating.values("frequency") / oscillating.values("linear_frequency")
        ratio_text = value_range_text(ratio, ratio * oscillating.values("period_error"))
        clause = f", {ratio_text} times that of the leading mode of the straight rod"
    if steady.count:
        clause += (
            f"; the leading mode of the straight rod does not oscillate{_point_count_clause(steady, cycles)}"
        )
    return clause


def _error_line(cycles: PointSelection) -> str:
    """Line on the largest errors of the cycles."""
    errors = []
    for word, name in VARIABLES_OF_LARGEST_ERRORS.items():
        values = np.abs(cycles.values(name))
        known_errors = values[np.isfinite(values)]
        largest_text = error_text(float(known_errors.max())) if known_errors.size else "not known"
        errors.append(f"{word} {largest_text}")
    return f"worst errors: {', '.join(errors)}; multiplier errors are absolute, all other errors are relative"
