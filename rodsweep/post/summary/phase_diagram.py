"""Phase diagrams in `rodsweep show`: fraction of the plane in each class, and changes along the rows. line:
parameter that varies along a row. row: parameter that is constant on a row."""

import numpy as np

from ...model.parameters import LINEAR_PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts.phase_diagram import STABILITY_CLASSES
from ...results.layouts.rods import has_standard_rods
from ...results.layouts.thresholds import CROSSING_KINDS
from ...results.layouts.variables import flag_number
from ...wording import count_of_total, counted
from .arm.arm import load_range_text
from .diagram_curves import (
    criticality_lines,
    curve_count_lines,
    curve_lines,
    incomplete_curve_lines,
)
from .followed_ranges import followed_range_text
from .number_texts import axis_values_text, span_text
from .stable_states import state_lines
from .summary_lines import SummaryLines
from .thresholds import cost_lines, search_lines

CROSSING_REMARKS = {
    "onset": " of oscillations",
    "hopf": " (a pair becomes unstable)",
    "hopf_reverse": " (a pair becomes stable, other modes stay unstable)",
    "restabilization": " (the last unstable pair becomes stable)",
    "real_again": " (the leading pair becomes two real eigenvalues)",
    "real_leads": " (a real eigenvalue becomes the leading eigenvalue)",
    "pair_leads": " (a complex pair becomes the leading pair)",
}
"""Explanation printed after the name of a kind of crossing."""
GRID_RESOLUTION = 1e-8
"""Spacing, in the unit of the parameter, of a uniform grid with which the cost of the rows is compared."""


def phase_diagram_summary(view: ResultView, computed: np.ndarray) -> SummaryLines:
    """Summary of a phase diagram. computed: mask of the computed rows, of the shape of the rows."""
    v = view.variables
    line = next(name for name in LINEAR_PARAMETERS if name not in view.parameters)
    row = next(name for name in view.parameters if len(view.parameter_values[name]) > 1)
    answer = [*class_fraction_lines(v["class"][computed]), *lines_about_rows(view, computed, line, row)]
    if "stable_states" in v:
        answer += state_lines(view, computed, line, row)
    reliability = search_lines(view, computed, "row")
    if "stable_states" in v:
        followed = followed_range_text(view, computed, line, "cycle_followed_")
        reliability.append(f"{followed}, unless a curve of folds or torus points crosses the row there")
    details = [
        *count_lines(v["class"][computed]),
        *cost_lines(view, computed),
        *cost_saving_lines(view, computed, line),
    ]
    if "curve_number" in v:
        answer += curve_lines(view, line, row)
        reliability += [*curve_count_lines(view, line), *incomplete_curve_lines(view, line, row)]
    if "curve_criticality" in v:
        details += criticality_lines(view)
    return SummaryLines(answer, reliability, details, crossings_of_arms(view, computed))


def count_lines(classes: np.ndarray) -> list[str]:
    """List with a line on the number of grid points in each class. classes: class of each point, of any
    shape."""
    counts = ((int((classes == value).sum()), word) for value, word in STABILITY_CLASSES)
    texts = ", ".join(f"{count} {word}" for count, word in counts if count)
    return [f"of {counted(classes.size, 'grid point')} on the rows: {texts}"]


def cost_saving_lines(view: ResultView, computed: np.ndarray, line_parameter: str) -> list[str]:
    """List with a line that compares the cost of the rows with the cost of a uniform grid; empty if the cost
    is not stored.

    computed: mask of the computed rows, of the shape of the rows.
    """
    if not has_standard_rods(view.config):
        return []
    v = view.variables
    rows = int(computed.sum())
    count = int(v["solves"][computed].sum())
    boxes = int(v["boxes"][computed].sum())
    uniform = float(np.ptp(v[line_parameter])) / GRID_RESOLUTION * rows
    return [
        f"in all {counted(count, 'eigenproblem')} and {counted(boxes, 'evaluation')} of D; a uniform grid "
        f"that resolves {line_parameter} to {GRID_RESOLUTION:g} on these rows has {uniform:.2g} points, "
        f"{float(f'{uniform / max(count + boxes, 1):.1g}'):g} times as many"
    ]


def class_fraction_lines(classes: np.ndarray) -> list[str]:
    """List with a line on the fraction of the grid points in each class. classes: class of each point, of any
    shape."""
    percents = ((100 * float((classes == value).mean()), word) for value, word in STABILITY_CLASSES)
    texts = ", ".join(f"{percent:.1f} % {word}" for percent, word in percents if percent)
    return [f"behaviour of the straight rod, in % of the grid points: {texts}"]


def row_start_lines(view: ResultView, computed: np.ndarray, line_parameter: str) -> list[str]:
    """List with a line on the classes at the starts of the rows; empty if all these classes are monotone.
    computed: mask of the computed rows, (...,)."""
    start = view.variables["class"][computed][:, 0]
    texts = [f"{word} on {int((start == n).sum())}" for n, word in STABILITY_CLASSES if (start == n).any()]
    if texts == [f"monotone on {len(start)}"]:
        return []
    rows = f"of {counted(len(start), 'row')}"
    return [
        f"at {line_parameter} = {view.variables[line_parameter][0]:.6g}, where the rows begin, {rows}: "
        f"{', '.join(texts)}"
    ]


def lines_about_rows(
    view: ResultView, computed: np.ndarray, line_parameter: str, row_parameter: str
) -> list[str]:
    """Lines about the rows in the mask `computed`, (...,): states at their starts, crossings by kind,
    undecided ranges, rows with and without flutter."""
    v = view.variables
    stored = (v["crossing_kind"] > 0).sum(axis=-1)
    is_incomplete = computed & ((v["crossing_count"] != stored) | np.isfinite(v["open_from"]))
    return [
        *row_start_lines(view, computed, line_parameter),
        *_crossing_lines(view, computed, is_incomplete, line_parameter, row_parameter),
        *_lines_about_flutter(view, computed, is_incomplete, line_parameter, row_parameter),
    ]


def _crossing_lines(
    view: ResultView, computed: np.ndarray, unknown: np.ndarray, line_parameter: str, row_parameter: str
) -> list[str]:
    """Lines about the crossings of each kind on the rows in the mask `computed`; `unknown`: mask of rows with
    further crossings that are not known."""
    v = view.variables
    row_values = view.point_columns[row_parameter].reshape(computed.shape)
    lines = []
    for number, word in enumerate(CROSSING_KINDS):
        of_kind = (v["crossing_kind"] == number) & computed[..., np.newaxis]
        has_kind = of_kind.any(axis=-1)
        if number and has_kind.any():
            is_later = of_kind & (of_kind.cumsum(axis=-1) > 1)
            masks = (of_kind & ~is_later, is_later)
            first_text, later_text = (span_text(v["crossing_at"][m], v["crossing_error"][m]) for m in masks)
            bound = "at least " * bool((unknown & ~has_kind).any())
            on_rows = f"on {bound}{count_of_total(has_kind.sum(), computed.sum(), 'row')}"
            text = f"{word}{CROSSING_REMARKS.get(word, '')}: {on_rows}, {line_parameter} = {first_text}"
            text += f", {row_parameter} = {axis_values_text(row_values[has_kind])}"
            if is_later.any():
                bound = "at least " * bool(unknown.any())
                rows = f"{bound}{int(is_later.any(axis=-1).sum())} of these rows"
                text += f"; again further along the row on {rows}, at {line_parameter} = {later_text}"
            lines.append(text)
    return lines


def _lines_about_flutter(
    view: ResultView, computed: np.ndarray, unknown: np.ndarray, line_parameter: str, row_parameter: str
) -> list[str]:
    """Lines about undecided ranges, and about the rows with and without flutter. The masks as in
    `_crossing_lines`."""
    v = view.variables
    row_values = view.point_columns[row_parameter].reshape(computed.shape)
    lines = []
    flutter, unknown_class = (flag_number(word, STABILITY_CLASSES) for word in ("flutter", "undecided"))
    undecided = (v["class"] == unknown_class) & computed[..., np.newaxis]
    if undecided.any():
        rows = undecided.any(axis=-1)
        values = np.broadcast_to(v[line_parameter], undecided.shape)[undecided]
        on_rows = (
            f"on {count_of_total(rows.sum(), computed.sum(), 'row')}, {line_parameter} = {span_text(values)}"
        )
        lines.append(
            f"behaviour undecided: {on_rows}, {row_parameter} = {axis_values_text(row_values[rows])}"
        )
    # A window of flutter may lie between two grid points: the located crossings show it.
    flutters = (v["class"] == flutter).any(axis=-1) | (v["unstable_after"] > 0).any(axis=-1)
    never_flutters = ~flutters & ~unknown & (v["class"] != unknown_class).all(axis=-1)
    flutters &= computed
    never_flutters &= computed
    if never_flutters.any() and flutters.any():
        with_flutter, without = (axis_values_text(row_values[mask]) for mask in (flutters, never_flutters))
        count = count_of_total(flutters.sum(), computed.sum(), "row")
        none = int(never_flutters.sum())
        lines.append(
            f"flutter: on {count}, {row_parameter} = {with_flutter}; none on {none}, {row_parameter} = "
            f"{without}"
        )
    return lines


def crossings_of_arms(view: ResultView, computed: np.ndarray) -> list[str]:
    """Lines about the thresholds of the straight arms along F, by kind, in the arms' units; an empty list for
    a rod, and for rows along another parameter. computed: mask of the computed rows, of the shape of the
    rows."""
    if not view.quantities or "F" in view.parameters:
        return []
    v = view.variables
    lines = []
    for number, word in list(enumerate(CROSSING_KINDS))[1:]:
        is_of_kind = (v["crossing_kind"] == number) & computed[..., np.newaxis]
        if is_of_kind.any():
            forces = v["crossing_at"][is_of_kind]
            rows = count_of_total(is_of_kind.any(axis=-1).sum(), computed.sum(), "row")
            lines.append(f"{word}: on {rows}, at {load_range_text(view, forces, np.zeros(len(forces), int))}")
    return lines
