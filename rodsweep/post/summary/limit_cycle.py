"""Limit cycles in `rodsweep show`: which rods beat, variables of the cycles, and reliability. variables:
variables of the file, by name."""

from collections.abc import Callable, Mapping

import numpy as np

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts.limit_cycle import CYCLE_STATUSES, SECOND_STATES
from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import count_of_total, counted
from ..located_thresholds import StoredThresholds
from .arm.arm import region_of_arms
from .errors import absolute_errors, known_range_text
from .number_texts import error_text, number_and_error, span_text
from .stability import rod_and_arm_stability_lines
from .summary_lines import (
    SummaryLines,
    TextTable,
    in_brackets,
    proof_clause,
    region_text,
    varied_parameters_at_points,
)

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
CYCLE_NUMBERS = (
    ("period", "period", "tau2"),
    ("frequency", "frequency", ANGULAR_UNIT),
    ("largest y of the tip", "tip_y_max", "L"),
    ("largest Floquet multiplier", "multiplier", ""),
)
"""(printed name, variable, unit) of the numbers printed for a single cycle."""


def limit_cycle_summary(view: ResultView, computed: np.ndarray) -> SummaryLines:
    """Summary of limit cycles. computed: mask of the computed points, of the shape of the points."""
    variables = view.variables
    beats = computed & view.has_status("cycle")
    orbit = computed & view.has_status(*CYCLE_STATUSES)
    stability, arm_sentences = _threshold_lines(view)
    answer = [
        outcome_count_line(view, computed, region_text),
        *stability,
        *_second_state_lines(view, computed),
    ]
    if view.quantities and computed.size > 1 and not beats[computed].all():
        arm_sentences.insert(0, outcome_count_line(view, computed, region_of_arms))
    reliability = _hopf_completeness_lines(view)
    rate, frequency = (
        known_range_text(variables, f"linear_{name}", computed) for name in ("growth_rate", "frequency")
    )
    details = [f"straight rod: leading growth rate {rate} 1/tau2, frequency {frequency} rad/tau2"]
    numbers = None
    on_torus = computed & view.has_status("torus")
    if on_torus.any():
        ratio, modulus = (
            known_range_text(variables, name, on_torus) for name in ("modulation_ratio", "multiplier")
        )
        details.append(
            f"quasiperiodic motions: modulated at {ratio} times the frequency of the oscillation; the "
            f"unstable cycles inside the tori have a largest |Floquet multiplier| of {modulus}"
        )
    if computed.size == 1 and orbit.any():
        answer.insert(1, single_cycle_stability_line(variables, stable=bool(beats.any())))
        numbers = single_cycle_table(variables)
    elif beats.any():
        period_text, y_text = (known_range_text(variables, name, beats) for name in ("period", "tip_y_max"))
        answer.insert(1, f"period: {period_text} tau2; largest y of the tip: {y_text} L")
        reliability.insert(0, _error_line(variables, beats))
    details += _cycle_lines(variables, beats) if beats.any() else []
    return SummaryLines(answer, reliability, details, arm_sentences, numbers)


def outcome_count_line(
    view: ResultView, computed: np.ndarray, region: Callable[[ResultView, np.ndarray], str]
) -> str:
    """Line on the number of points with each outcome, and on the region of parameters of these points.

    computed: mask of the computed points, of the shape of the points. region: function that describes the
    points of a mask.
    """
    status = view.variables["status"]
    total_text = counted(int(computed.sum()), "point")
    masks = {word: computed & (status == value) for value, word in view.flags.items() if value >= 0}
    masks_of_outcomes = {
        OUTCOME_WORDS.get(status_word, status_word.replace("_", " ")): mask
        for status_word, mask in masks.items()
        if mask.any()
    }
    if len(masks_of_outcomes) == 1:
        word = next(iter(masks_of_outcomes))
        outcome_text = f"the rod {word}" if word in OUTCOME_WORDS.values() else word
        place_text = f" at all {total_text}" if computed.sum() > 1 else " at the only solved point"
        return outcome_text + place_text * (computed.size > 1)
    counts = (
        f"{word} at {int(mask.sum())}{in_brackets(region(view, mask))}"
        for word, mask in masks_of_outcomes.items()
    )
    return f"of {total_text}: {', '.join(counts)}"


def _threshold_lines(view: ResultView) -> tuple[list[str], list[str]]:
    """Returns (lines, lines in an arm's units) about thresholds of the straight rod along F, or along all
    varied parameters if F is not varied."""
    names = [name for name in NON_OPTIONAL_LINEAR_PARAMETERS if name in varied_parameters_at_points(view)]
    lines = list[str]()
    arm_sentences = list[str]()
    for name in names[:1] if "F" in names else names:
        thresholds_on = StoredThresholds(view, name).thresholds_up_to_end
        threshold_text, sentences = rod_and_arm_stability_lines(view, name, thresholds_on)
        lines += threshold_text
        arm_sentences += sentences
    return lines, arm_sentences


def _hopf_completeness_lines(view: ResultView) -> list[str]:
    """Sentence, in a list, on whether the Hopf points are proved complete; empty if no line of points was
    searched."""
    variables = view.variables
    line_count = int(variables["hopf_lines"]) if "hopf_lines" in variables else 0
    if not line_count:
        return []
    proved_text = count_of_total(int(variables["hopf_lines_proved"]), line_count, "line")
    return [f"the list of Hopf points between neighbouring points {proof_clause(view)} for {proved_text}"]


def single_cycle_stability_line(variables: Mapping[str, np.ndarray], stable: bool) -> str:
    """Line that says whether the only cycle in a file is stable, or that no Floquet multiplier is computed.
    variables: variables of the file, (1, ...) each. stable: whether the status is "cycle"."""
    if np.isnan(variables["multiplier"]).all():
        return "the motion in time settles on the cycle; no Floquet multiplier is computed"
    if stable:
        return "the cycle is stable in the plane: its largest nontrivial Floquet multiplier is below 1"
    return "the cycle is unstable: its largest nontrivial Floquet multiplier is above 1"


def single_cycle_table(variables: Mapping[str, np.ndarray]) -> TextTable:
    """Table of the numbers of the only cycle in a file, with errors. variables: variables of the
    file, (1, ...) each."""
    rows = []
    for label, name, unit in CYCLE_NUMBERS:
        value = float(np.nanmax(variables[name], initial=-np.inf))
        if np.isfinite(value):
            rows.append(
                (label, *number_and_error(value, float(absolute_errors(variables, name).max())), unit)
            )
    return TextTable(("", "value", "+-", "unit"), tuple(rows))


def _second_state_lines(view: ResultView, computed: np.ndarray) -> list[str]:
    """Lines about points at which a second stable state is certain or possible, or at which the straight rod
    is stable but the motion ended in no stable state."""
    variables = view.variables
    numbers = {word: number for number, word in SECOND_STATES}
    lines = []
    straight = computed & (variables["second_state"] == numbers["straight"])
    cycle = computed & (variables["second_state"] == numbers["cycle_possible"])
    are_bistable = straight & view.has_status("cycle", "torus")
    if are_bistable.any():
        at_points = _at_count(are_bistable, computed)
        lines.append(f"two stable states{at_points}: the straight rod is stable as well")
    if (straight_only := straight & ~are_bistable).any():
        at_points = _at_count(straight_only, computed)
        lines.append(f"the straight rod is stable{at_points} where the motion reached no stable state")
    if cycle.any():
        lines.append(
            f"a stable cycle may exist beside the straight rod{_at_count(cycle, computed)}: the Hopf point "
            f"at F = {span_text(variables['subcritical_F'][cycle])} is subcritical, so a larger initial "
            "deflection may lead to a cycle; `task: branch` follows the branch of these cycles"
        )
    return lines


def _at_count(mask: np.ndarray, computed: np.ndarray) -> str:
    """Clause on the number of points in the mask `computed` that are also in the mask `mask`; empty if
    `computed` has a single point."""
    return "" if computed.sum() == 1 else f" at {count_of_total(mask.sum(), computed.sum(), 'point')}"


def _cycle_lines(variables: Mapping[str, np.ndarray], is_cycle: np.ndarray) -> list[str]:
    """Lines on frequency, period in tau1, extrema of the tip, power, multiplier, integrated periods and least
    h1 of the cycles."""
    tips = (
        f"{label} {known_range_text(variables, f'tip_{name}', is_cycle)} {unit}"
        for label, name, unit in (
            ("least x", "x_min", "L"), ("largest x", "x_max", "L"), ("largest |theta|", "theta_max", "rad"),
        )
    )  # fmt: skip
    frequency_text = known_range_text(variables, "frequency", is_cycle)
    lines = [
        f"frequency of the cycle: {frequency_text} rad/tau2{_relative_frequency_clause(variables, is_cycle)}"
    ]
    if "period_tau1" in variables:
        lines.append(f"period: {known_range_text(variables, 'period_tau1', is_cycle)} tau1")
    return [
        *lines,
        f"tip: {', '.join(tips)}",
        f"mean power of the force: {known_range_text(variables, 'injection_mean', is_cycle)} k3/(L tau2)",
        f"largest |Floquet multiplier|: {known_range_text(variables, 'multiplier', is_cycle)}; returns of "
        f"the tip in the integration: {span_text(variables['periods'][is_cycle])}; smallest stretch h1: "
        f"{known_range_text(variables, 'least_stretch', is_cycle)}",
    ]


def _relative_frequency_clause(variables: Mapping[str, np.ndarray], is_cycle: np.ndarray) -> str:
    """Clause that compares the frequencies of the cycles with the frequencies of the leading modes; empty if
    no frequency of a leading mode is known."""
    oscillates = is_cycle & (np.abs(variables["linear_frequency"]) > 0)
    steady = is_cycle & (variables["linear_frequency"] == 0)
    clause = ""
    if oscillates.any():
        ratio = variables["frequency"][oscillates] / variables["linear_frequency"][oscillates]
        ratio_text = span_text(ratio, ratio * variables["period_error"][oscillates])
        clause = f", {ratio_text} times that of the leading mode of the straight rod"
    if steady.any():
        clause += f"; the leading mode of the straight rod does not oscillate{_at_count(steady, is_cycle)}"
    return clause


def _error_line(variables: Mapping[str, np.ndarray], is_cycle: np.ndarray) -> str:
    """Line on the largest errors of the cycles."""
    names = {
        "period": "period_error",
        "largest y of the tip": "amplitude_error",
        "other extrema of the tip": "extrema_error",
        "energy balance": "energy_imbalance",
        "multiplier": "multiplier_error",
    }
    errors = []
    for word, name in names.items():
        errors_of_cycles = np.abs(variables[name][is_cycle & np.isfinite(variables[name])])
        errors.append(
            f"{word} {error_text(float(errors_of_cycles.max())) if errors_of_cycles.size else 'not known'}"
        )
    return f"worst errors: {', '.join(errors)}; multiplier errors are absolute, all other errors are relative"
