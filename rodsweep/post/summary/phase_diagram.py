"""Phase diagrams in `rodsweep show`: fraction of the plane in each class, and changes along the rows."""

import numpy as np

from ...results.layouts.phase_diagram import STABILITY_CLASSES
from ...results.layouts.thresholds import CROSSING_KINDS
from ...results.layouts.variables import stored_number_of_word
from ...wording import counted
from ..plane_curves import plane_parameters
from .arm.arm_texts import load_range_text
from .diagram_curves import (
    criticality_lines,
    curve_count_lines,
    diagram_curve_lines,
    incomplete_curve_lines,
)
from .followed_ranges import followed_beyond_range_text
from .number_texts import value_range_text
from .selection import DiagramRows, PointSelection, counts_by_word_text, percents_by_word_text
from .stable_states import stable_state_lines
from .summary_lines import SummaryLines
from .thresholds import search_cost_lines, search_reliability_lines

CROSSING_KIND_REMARKS = {
    "onset": " of oscillations",
    "hopf": " (a pair becomes unstable)",
    "hopf_reverse": " (a pair becomes stable, other modes stay unstable)",
    "restabilization": " (the last unstable pair becomes stable)",
    "real_again": " (the leading pair becomes two real eigenvalues)",
    "real_leads": " (a real eigenvalue becomes the leading eigenvalue)",
    "pair_leads": " (a complex pair becomes the leading pair)",
}
"""Explanation printed after the name of a kind of crossing."""
FLUTTER, UNDECIDED = (stored_number_of_word(word, STABILITY_CLASSES) for word in ("flutter", "undecided"))
"""Stored numbers of the classes flutter and undecided."""


def phase_diagram_summary(points: PointSelection) -> SummaryLines:
    """Summary of the computed rows of a phase diagram; a row contains the rods that differ in one parameter
    only."""
    view = points.view
    rows = DiagramRows(view, points.mask, plane_parameters(view))
    classes = rows.values("class")
    percents_text = percents_by_word_text(classes, dict(STABILITY_CLASSES))
    answer = [
        f"behaviour of the straight rod, in % of the grid points: {percents_text}",
        *diagram_row_lines(rows),
    ]
    reliability = search_reliability_lines(rows, "row")
    if "stable_states" in rows.variables:
        answer += stable_state_lines(rows)
        followed_text = followed_beyond_range_text(rows, rows.parameters.line_parameter, "cycle_followed_")
        reliability.append(f"{followed_text}, unless a curve of folds or torus points crosses the row there")
    counts_text = counts_by_word_text(classes, dict(STABILITY_CLASSES))
    details = [
        f"of {counted(classes.size, 'grid point')} on the rows: {counts_text}",
        *search_cost_lines(rows),
    ]
    if "curve_number" in rows.variables:
        answer += diagram_curve_lines(view, rows.parameters)
        reliability += curve_count_lines(view, rows.parameters)
        reliability += incomplete_curve_lines(view, rows.parameters)
    if "curve_criticality" in rows.variables:
        details += criticality_lines(view)
    return SummaryLines(answer, reliability, details, straight_arm_threshold_lines(rows))


def diagram_row_lines(rows: DiagramRows) -> list[str]:
    """Lines about the stability classes at the starts of the rows, about crossings by kind, about ranges in
    which the behaviour is undecided, and about rows with and without flutter."""
    variables = rows.variables
    stored_counts = (variables["crossing_kind"] > 0).sum(axis=-1)
    has_unknown = (variables["crossing_count"] != stored_counts) | np.isfinite(variables["open_from"])
    incomplete = rows.mask & has_unknown
    return [
        *_row_start_lines(rows),
        *_crossing_lines(rows, incomplete),
        *_undecided_and_flutter_lines(rows, incomplete),
    ]


def _row_start_lines(rows: DiagramRows) -> list[str]:
    """List of one line that counts the stability classes of the straight rod at the starts of the rows; empty
    if all are monotone."""
    start_classes = rows.values("class")[:, 0]
    words = [(word, int((start_classes == value).sum())) for value, word in STABILITY_CLASSES]
    if ("monotone", rows.count) in words:
        return []
    line = rows.parameters.line_parameter
    place_text = f"{line} = {rows.variables[line][0]:.6g}, where the rows begin"
    counts_text = ", ".join(f"{word} on {count}" for word, count in words if count)
    return [f"the straight rod at {place_text}: {counts_text} of {counted(rows.count, 'row')}"]


def _crossing_lines(rows: DiagramRows, incomplete: np.ndarray) -> list[str]:
    """Lines about the crossings of each kind. incomplete: mask of the rows on which crossings are not stored
    or not found."""
    lines = []
    for number, word in enumerate(CROSSING_KINDS):
        of_kind = rows.item_mask(rows.variables["crossing_kind"] == number)
        if number == 0 or not of_kind.any():
            continue
        is_later = of_kind & (of_kind.cumsum(axis=-1) > 1)
        bound = "at least " if (incomplete & ~of_kind.any(axis=-1)).any() else ""
        first_text = rows.row_count_and_ranges_text(
            of_kind & ~is_later, "crossing_at", "crossing_error", bound
        )
        text = f"{word}{CROSSING_KIND_REMARKS.get(word, '')}: on {first_text}"
        if is_later.any():
            bound = "at least " if incomplete.any() else ""
            rows_text = f"{bound}{rows.rows_with_items(is_later).count} of these rows"
            positions, errors = (rows.variables[name][is_later] for name in ("crossing_at", "crossing_error"))
            positions_text = f"{rows.parameters.line_parameter} = {value_range_text(positions, errors)}"
            text += f"; again further along the row on {rows_text}, at {positions_text}"
        lines.append(text)
    return lines


def _undecided_and_flutter_lines(rows: DiagramRows, incomplete: np.ndarray) -> list[str]:
    """Lines about undecided ranges, and about the rows with and without flutter. incomplete: as in
    `_crossing_lines`."""
    classes = rows.variables["class"]
    is_undecided = classes == UNDECIDED
    undecided = rows.item_mask(is_undecided)
    lines = []
    if undecided.any():
        ranges_text = rows.row_count_and_ranges_text(undecided, rows.parameters.line_parameter)
        lines.append(f"behaviour undecided: on {ranges_text}")
    # A window of flutter may lie between two grid points: the located crossings show it.
    has_flutter = (classes == FLUTTER).any(axis=-1) | (rows.variables["unstable_after"] > 0).any(axis=-1)
    flutter = rows.where(has_flutter)
    no_flutter = rows.where(~has_flutter & ~incomplete & ~is_undecided.any(axis=-1))
    if flutter.count and no_flutter.count:
        lines.append(
            f"flutter: on {flutter.count_of_total_text(rows, 'row')}, {flutter.row_parameter_values_text}; "
            f"none on {no_flutter.count}, {no_flutter.row_parameter_values_text}"
        )
    return lines


def straight_arm_threshold_lines(rows: DiagramRows) -> list[str]:
    """Lines about the loads at which the straight arms have thresholds, by kind, in the units typed by the
    user. Empty for rods, and for rows along a parameter other than F."""
    view = rows.view
    if not view.quantities or "F" in view.parameters:
        return []
    lines = []
    for number, word in list(enumerate(CROSSING_KINDS))[1:]:
        of_kind = rows.item_mask(rows.variables["crossing_kind"] == number)
        if of_kind.any():
            forces = rows.variables["crossing_at"][of_kind]
            rows_text = rows.rows_with_items(of_kind).count_of_total_text(rows, "row")
            loads_text = load_range_text(view, forces, np.zeros(len(forces), int))
            lines.append(f"{word}: on {rows_text}, at {loads_text}")
    return lines
