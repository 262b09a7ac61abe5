"""Hopf points in `rodsweep show`: criticality, coefficients of the normal form, and errors.
variables: variables of a single rod, by name."""

from collections.abc import Iterator, Mapping

import numpy as np

from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import counted
from .arm.arm_texts import single_arm_threshold_lines
from .number_texts import rounded_text, value_range_text
from .selection import PointSelection, counts_by_word_text, in_brackets
from .summary_lines import MAX_LISTED_ITEMS, SummaryLines, TextTable, number_table
from .thresholds import (
    ENDED_EARLY_STATUS,
    early_search_end_clause,
    failed_search_count_clause,
    proved_rod_count_text,
    stored_crossing_kinds,
    unstored_crossing_count,
    unstored_crossings_clause,
)
from .variable_errors import absolute_errors

CRITICALITY_WORDS = {-1: "supercritical", 1: "subcritical", 0: "undecided"}
"""Word for the criticality of a Hopf point, by sign of Re c (c: cubic coefficient of the normal form)."""
HOPF_SYMBOLS_AND_UNITS = {
    "crossing_F": "F, k3/L^2",
    "crossing_frequency": f"frequency, {ANGULAR_UNIT}",
    "landau_real": "Re c, 1/(tau2 L^2)",
    "landau_imag": "Im c, 1/(tau2 L^2)",
    "growth_slope_real": "Re dw/dF, L^2/(k3 tau2)",
    "growth_slope_imag": "Im dw/dF, L^2/(k3 tau2)",
    "amplitude_coefficient": "a, L",
    "frequency_slope": "b, L^2/(k3 tau2)",
}
"""Symbol and unit of each number of a Hopf point, by variable."""
COEFFICIENT_SYMBOL_BY_ERROR = {
    "landau_error": "c",
    "growth_slope_error": "dw/dF",
    "amplitude_coefficient_error": "a",
    "frequency_slope_error": "b",
}
"""Symbol of the coefficient, by variable of its relative error."""
FIRST_HOPF_POINTS_SENTENCE = "F = {first crossing_F}, a = {first amplitude_coefficient} L"
"""Sentence on the first Hopf points of several rods."""
ALL_HOPF_POINTS_SENTENCE = "a = {amplitude_coefficient} L, b = {frequency_slope} L^2/(k3 tau2)"
"""Sentence on all Hopf points of several rods."""


def criticality_summary(points: PointSelection) -> SummaryLines:
    """Summary of Hopf points at the computed points."""
    reliability = [_searched_range_line(points)]
    if points.mask.size == 1:
        return _single_rod_summary(points, reliability)
    variables = points.variables
    with_hopf = points.where(variables["crossing_count"] > 0)
    unknown = points.where(
        (variables["crossing_count"] < 0) | (points.view.has_status(ENDED_EARLY_STATUS) & ~with_hopf.mask)
    )
    place_text = in_brackets(with_hopf.parameter_ranges_text()) if with_hopf.count else ""
    answer = [
        f"Hopf points at {with_hopf.count_of_total_text(points, 'rod')}{place_text}"
        f"{failed_search_count_clause(unknown.count)}"
    ]
    criticality = points.values("criticality")
    known_counts = np.isfinite(criticality).sum(axis=-1)
    if not known_counts.any():
        return SummaryLines(answer, reliability)
    first_text = _criticality_counts_text(criticality[:, 0])
    ranges_text = points.sentence_with_ranges(FIRST_HOPF_POINTS_SENTENCE)
    answer += [f"first Hopf point of each rod: {first_text}; {ranges_text}", *_subcritical_lines(points)]
    worst = [
        f"{symbol} {_maximum_text(points.values(name))}"
        for name, symbol in COEFFICIENT_SYMBOL_BY_ERROR.items()
    ]
    reliability.append(f"worst relative errors: {', '.join(worst)}")
    scope = "stored" if (points.values("crossing_count") > known_counts).any() else "all"
    all_text = (
        f"{_criticality_counts_text(criticality)}; {points.sentence_with_ranges(ALL_HOPF_POINTS_SENTENCE)}"
    )
    return SummaryLines(answer, reliability, [f"{scope} Hopf points: {all_text}"])


def _single_rod_summary(points: PointSelection, reliability: list[str]) -> SummaryLines:
    """Summary of the Hopf points of the only rod in a file. reliability: lines of the summary about
    reliability."""
    view = points.view
    variables = view.point_values(0)
    lines = list(_hopf_lines(variables))
    if not lines and variables["crossing_count"] < 0:
        lines = ["the Hopf points of this rod are not known"]
    elif not lines:
        lines = [f"no Hopf point up to F = {value_range_text(variables['F_end'])}"]
    lines[0] += early_search_end_clause(view, float(variables["F_end"]))
    return SummaryLines(
        lines,
        reliability,
        arm_sentences=single_arm_threshold_lines(view),
        numbers_table=_hopf_table(variables),
    )


def _hopf_lines(variables: Mapping[str, np.ndarray]) -> Iterator[str]:
    """Yields one line for each Hopf point of the only rod in a file."""
    for i, kind in enumerate(stored_crossing_kinds(variables)):
        F_text = rounded_text(variables["crossing_F"][i], variables["crossing_error"][i])
        normal_form_text = "its normal form is not known"
        if np.isfinite(variables["landau_error"][i]):
            word = CRITICALITY_WORDS[int(variables["criticality"][i])]
            normal_form_text = f"{word}, {_nearby_cycles_clause(variables, i, kind)}"
        unstable_count = int(variables["unstable_after"][i])
        modes_sentence = f"the straight rod has {counted(unstable_count, 'unstable mode')} beyond it"
        if unstable_count < 0:
            modes_sentence = "the number of unstable modes beyond it is not known"
        yield f"{kind} at F = {F_text}: {normal_form_text}; {modes_sentence}"


def _hopf_table(variables: Mapping[str, np.ndarray]) -> TextTable | None:
    """Table with one column for each Hopf point of the only rod in a file; None if the rod has no Hopf
    point."""
    numbers = np.array([variables[name] for name in HOPF_SYMBOLS_AND_UNITS])
    errors = np.array([absolute_errors(variables, name) for name in HOPF_SYMBOLS_AND_UNITS])
    kinds = stored_crossing_kinds(variables)
    columns = [(kind, numbers[:, i], errors[:, i]) for i, kind in enumerate(kinds)]
    return number_table(("", HOPF_SYMBOLS_AND_UNITS.values(), None), *columns) if columns else None


def _nearby_cycles_clause(variables: Mapping[str, np.ndarray], i: int, kind: str) -> str:
    """Clause on the cycles near the i-th Hopf point of the only rod in a file: whether the cycles exist at
    larger or at smaller F, and whether they are stable. kind: kind of the Hopf point."""
    sign = int(variables["criticality"][i])
    if sign == 0:
        return "the sign of Re c is within its error"
    side_text = "larger F" if variables["amplitude_coefficient"][i] > 0 else "smaller F"
    if sign > 0:
        return f"unstable cycles at {side_text}"
    unstable_count = int(variables["unstable_after"][i])
    other_count = unstable_count - 2 if kind == "hopf" else unstable_count
    if unstable_count < 0:
        return f"cycles at {side_text}"
    if other_count:
        return f"cycles at {side_text}, unstable by {other_count} other modes"
    return f"stable cycles at {side_text}"


def _subcritical_lines(points: PointSelection) -> Iterator[str]:
    """Yields lines on rods with subcritical Hopf points; rods whose first Hopf point is subcritical come
    first."""
    view = points.view
    criticality = view.flattened_by_point("criticality")
    rods = np.flatnonzero((criticality == 1).any(axis=-1))
    rods = rods[np.argsort(criticality[rods, 0] != 1, kind="stable")]
    for rod in rods[:MAX_LISTED_ITEMS]:
        name = ", ".join(f"{key} = {column[rod]:.6g}" for key, column in view.point_columns.items())
        variables = view.point_values(int(rod))
        errors = absolute_errors(variables, "amplitude_coefficient")
        texts = ", ".join(
            f"F = {rounded_text(variables['crossing_F'][i], variables['crossing_error'][i])} (Hopf point "
            f"{i + 1}, a = {rounded_text(variables['amplitude_coefficient'][i], errors[i])} L)"
            for i in np.flatnonzero(criticality[rod] == 1)
        )
        yield f"subcritical Hopf points, with the amplitude coefficient a, for {name}: {texts}"
    if len(rods) > MAX_LISTED_ITEMS:
        yield f"and subcritical Hopf points for {counted(len(rods) - MAX_LISTED_ITEMS, 'rod')} more"


def _criticality_counts_text(signs: np.ndarray) -> str:
    """Numbers of supercritical, subcritical and undecided Hopf points, as text. signs: signs of Re c, of any
    shape."""
    return counts_by_word_text(signs, CRITICALITY_WORDS) or "none known"


def _searched_range_line(points: PointSelection) -> str:
    """Line on the searched range of F, and on the completeness of the list of Hopf points."""
    is_searched = np.isfinite(points.values("F_end")).any()
    search_clause = points.sentence_with_ranges("searched up to F = {F_end}; ") if is_searched else ""
    unlisted_clause = unstored_crossings_clause(unstored_crossing_count(points))
    return f"{search_clause}the list of Hopf points {proved_rod_count_text(points, 'rod')}{unlisted_clause}"


def _maximum_text(values: np.ndarray) -> str:
    """Largest of the values that are not NaN, as text; "not known" if all values are NaN."""
    known_values = values[~np.isnan(values)]
    return f"{known_values.max():.1e}" if known_values.size else "not known"
