"""Summary of a result file, for `rodsweep show` and `rodsweep report`: answer, reliability, further results,
parameters and provenance."""

import os
from collections.abc import Callable, Iterable, Sequence

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from ...config.arm.status import NOT_SLENDER
from ...config.values import printable
from ...model.arm.drag import DRAG_ESTIMATE_NAMES
from ...model.arm.quantities import ARM_FILE_VARIABLES
from ...model.units import value_in_unit
from ...results.file.provenance import FAILURE_REASONS_ATTRIBUTE, example_failure_sentence
from ...results.file.view import ResultView
from ...results.layouts import lacks_sweep_wide_variables
from ...results.layouts.dimensions import UNIT_AND_LONG_NAME_OF_DIMENSION
from ...results.layouts.variables import MISSING_STATUS
from ...wording import counted, is_or_are, plural
from ..cost_and_provenance import computing_time_lines, last_run_lines, provenance_lines
from ..material_texts import material_lines
from ..tables.alignment import aligned_at_decimal_points, aligned_column_cells, rewrap_line, table_blocks
from .arm.arm_answer_lines import arm_answer
from .arm.arm_texts import arm_variable_lines
from .branch import branch_summary
from .criticality import criticality_summary
from .limit_cycle import limit_cycle_summary
from .modes import modes_summary
from .phase_diagram import phase_diagram_summary
from .selection import PointSelection
from .spectrum import spectrum_summary
from .summary_lines import Summary, SummaryLines, TextTable
from .thresholds import thresholds_summary

SUMMARY_FUNCTION_BY_TASK: dict[str, Callable[[PointSelection], SummaryLines]] = {
    "spectrum": spectrum_summary,
    "thresholds": thresholds_summary,
    "phase_diagram": phase_diagram_summary,
    "modes": modes_summary,
    "limit_cycle": limit_cycle_summary,
    "criticality": criticality_summary,
    "branch": branch_summary,
}
"""For each task, the function that returns the lines of the summary from the computed points."""
MAX_TABLE_WIDTH = 1000
"""Largest width, in characters, of a table of numbers that is printed into a pipe or a file."""
ARM_QUANTITY_DIGITS = 6
"""Significant digits of the quantities of an arm, and of the parameters computed from them."""
DIGITS_OF_EQUAL_PARAMETERS = 12
"""Parameters that agree to this number of significant digits are equal: values computed from an arm differ by
rounding."""
POINT_NOUNS = {"thresholds": "rod", "criticality": "rod", "branch": "rod", "phase_diagram": "row"}
"""Noun for a point of a task's result, for tasks whose noun is not "point"."""


def summary_of(view: ResultView, every_status: bool = False) -> Summary:
    """Summary of a result file. every_status: whether the list of statuses includes statuses that no point
    has."""
    view = view.as_list
    status = view.variables["status"]
    computed = status != MISSING_STATUS
    noun = POINT_NOUNS.get(view.task, "point")
    rods = computed & (status < NOT_SLENDER)
    no_points_lines = SummaryLines([] if computed.any() else [f"no {noun} is computed yet"])
    lines = SUMMARY_FUNCTION_BY_TASK[view.task](PointSelection(view, rods)) if rods.any() else no_points_lines
    attributes = view.attributes
    return Summary(
        answer=_answer_lines(view, computed, lines),
        reliability=[
            *_unfinished_lines(view, int((~computed).sum()), noun),
            *lines.reliability,
            *_failure_sentences(view),
        ],
        statuses=_status_table(view, status, every_status, noun),
        details=lines.details,
        material=material_lines(view),
        axes_table=_axes_table(view),
        numbers_table=lines.numbers_table,
        cost_and_provenance_lines=[
            *computing_time_lines(view, computed, noun),
            *last_run_lines(attributes, noun),
            *provenance_lines(attributes),
        ],
    )


def show_summary(view: ResultView, every_status: bool = False) -> None:
    """Prints the summary of a result file. every_status: whether the list of statuses includes statuses that
    no point has.

    The answer comes first, for an arm also in SI units. Reliability, further results, parameters and
    provenance follow, each below a heading. Lines are wrapped at the width of a terminal window, and not
    wrapped in a pipe.
    """
    console = Console(highlight=False, markup=False)
    summary = summary_of(view, every_status)
    title = view.attributes.get("title", "")
    console.print(f"{printable(str(view.path))}: {title}, task {view.task}", soft_wrap=True)
    print_lines(console, summary.answer)
    if summary.numbers_table is not None:
        _print_numbers(console, summary.numbers_table)
    groups: tuple[tuple[str, Sequence[str], TextTable | None], ...] = (
        ("Reliability", summary.reliability, summary.statuses),
        ("Further results", summary.details, None),
        ("Parameters", summary.material, summary.axes_table),
        ("Provenance", summary.cost_and_provenance_lines, None),
    )
    for heading, lines, table in groups:
        if not lines and table is None:
            continue
        console.print()
        console.print(heading, style="bold")
        print_lines(console, lines)
        if table is not None:
            console.print(_terminal_table(table))


def print_lines(console: Console, lines: Sequence[str]) -> None:
    """Prints lines; if `wraps_lines`, they are wrapped at the width of the terminal window."""
    for line in lines:
        console.print(rewrap_line(line, console.width) if wraps_lines(console) else line, soft_wrap=True)


def wraps_lines(console: Console) -> bool:
    """Whether lines are wrapped: true for a terminal, or if the environment variable COLUMNS is set."""
    return console.is_terminal or "COLUMNS" in os.environ


def _print_numbers(console: Console, table: TextTable) -> None:
    """Prints a table of numbers in blocks of columns that fit into the window, each after an empty line."""
    heading_lines = [(*heading.split("\n"), "")[:2] for heading in table.headings]
    cells = zip(heading_lines, zip(*table.rows, strict=True), strict=True)
    columns = [aligned_column_cells(heading_pair, column) for heading_pair, column in cells]
    for block in table_blocks(columns, console.width if wraps_lines(console) else MAX_TABLE_WIDTH):
        for line in ("", *block):
            console.print(line, soft_wrap=True)


def _answer_lines(view: ResultView, computed: np.ndarray, summary: SummaryLines) -> list[str]:
    """Lines of the answer; for an arm first in SI units, then dimensionless. computed: mask of the computed
    points, of the shape of the points."""
    if not view.quantities or not computed.any():
        return [*summary.answer]
    points = PointSelection(view, computed)
    lines = [*arm_answer(points), *summary.arm_sentences, *arm_variable_lines(points)]
    return [*lines, "", "the same in dimensionless numbers:", *summary.answer] if summary.answer else lines


def _unfinished_lines(view: ResultView, missing_count: int, noun: str) -> list[str]:
    """Lines about points and curves that are not computed yet, and about points that only the journal holds.
    missing_count: number of missing points. noun: word for a point."""
    lines = []
    count_phrase = f"{counted(missing_count, noun)} {is_or_are(missing_count)}"
    if missing_count and (shard := view.attributes.get("shard")):
        lines.append(
            f"{count_phrase} not in this file: it is shard {shard}, and `rodsweep merge` combines the "
            "shards; if the run of this shard was interrupted, the same command continues the run"
        )
    elif missing_count:
        lines.append(f"{count_phrase} missing; if no run is in progress, the same command continues")
    elif lacks_sweep_wide_variables(view.attributes):
        lines.append(
            f"all {plural(noun)} are computed; the curves are missing; repeat the command to add the curves"
        )
    if waiting := view.journalled_count:
        lines.append(
            f"{waiting} of the computed {plural(noun)} {is_or_are(waiting)} so far only in the journal of "
            "the run, which writes the file later"
        )
    return lines


def _failure_sentences(view: ResultView) -> Iterable[str]:
    """Yields one sentence for each distinct reason for which points failed, with one failed point as an
    example."""
    columns = view.point_columns
    for line in str(view.attributes.get(FAILURE_REASONS_ATTRIBUTE, "")).splitlines():
        points_text, _, outcome = line.partition(": ")
        name, _, reason = outcome.partition(" ")
        has_status = view.has_status(name).ravel()
        for parameter, _, text in (pair.partition("=") for pair in points_text.split(", ")):
            has_status &= columns.get(parameter, float(text)) == float(text)
        if has_status.any() and reason:  # a later run may have computed the point anew
            yield example_failure_sentence(line, columns)


def _terminal_table(table: TextTable) -> Table:
    """The table in a form for the terminal: without borders, numbers aligned at their decimal points."""
    rich_table = Table(*table.headings, box=None, pad_edge=False)
    if table.rows:
        for row in zip(*map(aligned_at_decimal_points, zip(*table.rows, strict=True)), strict=True):
            rich_table.add_row(*(Text(cell.rstrip()) for cell in row))
    return rich_table


def _axes_table(view: ResultView) -> TextTable:
    """Table of the quantities of an arm and of the parameters, with their values or ranges over the
    points."""
    rows = []
    for name, values in view.quantities.items():
        if name == "drag":
            names = [DRAG_ESTIMATE_NAMES[int(value)] for value in np.unique(values[~np.isnan(values)])]
            rows.append((name, str(len(names)), names[0], names[-1] if names[1:] else "", ""))
            continue
        si = ARM_FILE_VARIABLES[name].unit
        unit = view.typed_units.get(name, si)
        rows.append((name, *_count_and_range(np.vectorize(value_in_unit)(values, unit, si)), unit))
    # The parameters of an arm are computed; those of a rod are typed, and may differ in a late digit.
    digits = ARM_QUANTITY_DIGITS if view.quantities else DIGITS_OF_EQUAL_PARAMETERS
    for name, values in view.parameter_values.items():
        rows.append((name, *_count_and_range(values, digits), UNIT_AND_LONG_NAME_OF_DIMENSION[name][0]))
    if all(row[1] == "1" for row in rows):
        return TextTable(("parameter", "value", "unit"), tuple((row[0], row[2], row[4]) for row in rows))
    return TextTable(("parameter", "values", "from", "to", "unit"), tuple(rows))


def _count_and_range(values: np.ndarray, digits: int = ARM_QUANTITY_DIGITS) -> tuple[str, str, str]:
    """Returns (count, smallest, largest) of `values`, of any shape, as text. count: number of distinct
    values. NaN is ignored. The text of the largest value is empty if all values are equal. digits:
    significant digits of the texts."""
    distinct = {f"{value:.{DIGITS_OF_EQUAL_PARAMETERS}g}" for value in values[~np.isnan(values)]}
    range_ends = sorted(map(float, distinct))
    texts = [f"{end:.{digits}g}" for end in range_ends]
    return str(len(range_ends)), texts[0] if texts else "", texts[-1] if len(texts) > 1 else ""


def _status_table(view: ResultView, status: np.ndarray, is_every_shown: bool, noun: str) -> TextTable:
    """Table of statuses, numbers of points, and meanings. is_every_shown: whether statuses that no point has
    are included. noun: word for a point."""
    sentences = view.status_sentences | {"missing": "not computed yet"}
    rows = []
    counts = dict(zip(*(array.tolist() for array in np.unique(status, return_counts=True)), strict=True))
    for value in sorted(view.status_flags.keys() | counts.keys()) if is_every_shown else counts:
        name = view.status_flags.get(value, f"unknown ({value})")
        rows.append((name, str(counts.get(value, 0)), sentences.get(name, "")))
    return TextTable(("status", plural(noun), "meaning"), tuple(rows))
