"""Phase diagrams in `rodsweep show`: fraction of the plane in each class, and changes along the rows."""

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.phase_diagram import STABILITY_CLASSES
from ...results.layouts.rods import has_standard_rods
from ...results.layouts.thresholds import CROSSING_KINDS
from ...results.layouts.variables import flag_number
from ...wording import count_of_total, counted
from ..plane_curves import PlaneParameters, plane_parameters
from .arm.arm import load_range_text
from .diagram_curves import (
    criticality_lines,
    curve_count_lines,
    diagram_curve_lines,
    incomplete_curve_lines,
)
from .followed_ranges import followed_beyond_range_text
from .number_texts import axis_values_text, span_text
from .stable_states import stable_state_lines
from .summary_lines import SummaryLines
from .thresholds import cost_lines, search_lines

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
COMPARED_GRID_SPACING = 1e-8
"""Spacing, in the unit of the parameter, of a uniform grid with which the cost of the rows is compared."""


def phase_diagram_summary(view: ResultView, computed: np.ndarray) -> SummaryLines:
    """Summary of a phase diagram. computed: mask of the computed rows, of the shape of the rows."""
    variables = view.variables
    parameters = plane_parameters(view)
    classes = variables["class"][computed]
    counts = {word: int((classes == value).sum()) for value, word in STABILITY_CLASSES}
    counts = {word: count for word, count in counts.items() if count}
    percents = ", ".join(f"{100 * count / classes.size:.1f} % {word}" for word, count in counts.items())
    answer = [
        f"behaviour of the straight rod, in % of the grid points: {percents}",
        *lines_about_rows(view, computed, parameters),
    ]
    if "stable_states" in variables:
        answer += stable_state_lines(view, computed, parameters)
    reliability = search_lines(view, computed, "row")
    if "stable_states" in variables:
        followed_text = followed_beyond_range_text(view, computed, parameters.line, "cycle_followed_")
        reliability.append(f"{followed_text}, unless a curve of folds or torus points crosses the row there")
    counts_text = ", ".join(f"{count} {word}" for word, count in counts.items())
    details = [
        f"of {counted(classes.size, 'grid point')} on the rows: {counts_text}",
        *cost_lines(view, computed),
        *cost_saving_lines(view, computed, parameters),
    ]
    if "curve_number" in variables:
        answer += diagram_curve_lines(view, parameters)
        reliability += [
            *curve_count_lines(view, parameters),
            *incomplete_curve_lines(view, parameters),
        ]
    if "curve_criticality" in variables:
        details += criticality_lines(view)
    return SummaryLines(answer, reliability, details, straight_arm_threshold_lines(view, computed))


def cost_saving_lines(view: ResultView, computed: np.ndarray, parameters: PlaneParameters) -> list[str]:
    """List with a line that compares the cost of the rows with the cost of a uniform grid; empty if the cost
    is not stored.

    computed: mask of the computed rows, of the shape of the rows.
    """
    if not has_standard_rods(view.config):
        return []
    variables = view.variables
    row_count = int(computed.sum())
    solve_count = int(variables["solves"][computed].sum())
    boxes = int(variables["boxes"][computed].sum())
    uniform = float(np.ptp(variables[parameters.line])) / COMPARED_GRID_SPACING * row_count
    return [
        f"in all {counted(solve_count, 'eigenproblem')} and {counted(boxes, 'evaluation')} of D; a uniform "
        f"grid that resolves {parameters.line} to {COMPARED_GRID_SPACING:g} on these rows has {uniform:.2g} "
        f"points, {float(f'{uniform / max(solve_count + boxes, 1):.1g}'):g} times as many"
    ]


def row_start_lines(view: ResultView, computed: np.ndarray, parameters: PlaneParameters) -> list[str]:
    """List with a line on the classes at the starts of the rows; empty if all these classes are monotone.
    computed: mask of the computed rows, (...,)."""
    start_classes = view.variables["class"][computed][:, 0]
    texts = [
        f"{word} on {int((start_classes == value).sum())}"
        for value, word in STABILITY_CLASSES
        if (start_classes == value).any()
    ]
    if texts == [f"monotone on {len(start_classes)}"]:
        return []
    place_text = f"{parameters.line} = {view.variables[parameters.line][0]:.6g}, where the rows begin"
    return [f"the straight rod at {place_text}: {', '.join(texts)} of {counted(len(start_classes), 'row')}"]


def lines_about_rows(view: ResultView, computed: np.ndarray, parameters: PlaneParameters) -> list[str]:
    """Lines about the rows in the mask `computed`, (...,): states at their starts, crossings by kind,
    undecided ranges, rows with and without flutter."""
    variables = view.variables
    stored = (variables["crossing_kind"] > 0).sum(axis=-1)
    is_incomplete = computed & ((variables["crossing_count"] != stored) | np.isfinite(variables["open_from"]))
    return [
        *row_start_lines(view, computed, parameters),
        *_crossing_lines(view, computed, is_incomplete, parameters),
        *_undecided_and_flutter_lines(view, computed, is_incomplete, parameters),
    ]


def _crossing_lines(
    view: ResultView, computed: np.ndarray, unknown: np.ndarray, parameters: PlaneParameters
) -> list[str]:
    """Lines about the crossings of each kind on the rows in the mask `computed`; `unknown`: mask of rows with
    further crossings that are not known."""
    variables = view.variables
    line, row = parameters
    row_values = view.point_columns[row].reshape(computed.shape)
    lines = []
    for number, word in enumerate(CROSSING_KINDS):
        of_kind = (variables["crossing_kind"] == number) & computed[..., np.newaxis]
        has_kind = of_kind.any(axis=-1)
        if number and has_kind.any():
            is_later = of_kind & (of_kind.cumsum(axis=-1) > 1)
            masks = (of_kind & ~is_later, is_later)
            first_text, later_text = (
                span_text(variables["crossing_at"][mask], variables["crossing_error"][mask]) for mask in masks
            )
            bound = "at least " * bool((unknown & ~has_kind).any())
            rows_text = f"on {bound}{count_of_total(has_kind.sum(), computed.sum(), 'row')}"
            text = f"{word}{CROSSING_KIND_REMARKS.get(word, '')}: {rows_text}, {line} = {first_text}"
            text += f", {row} = {axis_values_text(row_values[has_kind])}"
            if is_later.any():
                bound = "at least " * bool(unknown.any())
                later_rows_text = f"{bound}{int(is_later.any(axis=-1).sum())} of these rows"
                text += f"; again further along the row on {later_rows_text}, at {line} = {later_text}"
            lines.append(text)
    return lines


def _undecided_and_flutter_lines(
    view: ResultView, computed: np.ndarray, unknown: np.ndarray, parameters: PlaneParameters
) -> list[str]:
    """Lines about undecided ranges, and about the rows with and without flutter. The masks as in
    `_crossing_lines`."""
    variables = view.variables
    line, row = parameters
    row_values = view.point_columns[row].reshape(computed.shape)
    lines = []
    flutter, unknown_class = (flag_number(word, STABILITY_CLASSES) for word in ("flutter", "undecided"))
    undecided = (variables["class"] == unknown_class) & computed[..., np.newaxis]
    if undecided.any():
        has_undecided = undecided.any(axis=-1)
        values = np.broadcast_to(variables[line], undecided.shape)[undecided]
        rows_text = (
            f"on {count_of_total(has_undecided.sum(), computed.sum(), 'row')}, {line} = {span_text(values)}"
        )
        values_text = axis_values_text(row_values[has_undecided])
        lines.append(f"behaviour undecided: {rows_text}, {row} = {values_text}")
    # A window of flutter may lie between two grid points: the located crossings show it.
    flutters = (variables["class"] == flutter).any(axis=-1) | (variables["unstable_after"] > 0).any(axis=-1)
    never_flutters = ~flutters & ~unknown & (variables["class"] != unknown_class).all(axis=-1)
    flutters &= computed
    never_flutters &= computed
    if never_flutters.any() and flutters.any():
        with_flutter, without = (axis_values_text(row_values[mask]) for mask in (flutters, never_flutters))
        count_text = count_of_total(flutters.sum(), computed.sum(), "row")
        none = int(never_flutters.sum())
        lines.append(f"flutter: on {count_text}, {row} = {with_flutter}; none on {none}, {row} = {without}")
    return lines


def straight_arm_threshold_lines(view: ResultView, computed: np.ndarray) -> list[str]:
    """Lines about the thresholds of the straight arms along F, by kind, in the arms' units; an empty list for
    a rod, and for rows along another parameter. computed: mask of the computed rows, of the shape of the
    rows."""
    if not view.quantities or "F" in view.parameters:
        return []
    variables = view.variables
    lines = []
    for number, word in list(enumerate(CROSSING_KINDS))[1:]:
        is_of_kind = (variables["crossing_kind"] == number) & computed[..., np.newaxis]
        if is_of_kind.any():
            forces = variables["crossing_at"][is_of_kind]
            rows_text = count_of_total(is_of_kind.any(axis=-1).sum(), computed.sum(), "row")
            lines.append(
                f"{word}: on {rows_text}, at {load_range_text(view, forces, np.zeros(len(forces), int))}"
            )
    return lines
