"""Contents of an HTML page about one result as plain text, tables and pictures, before conversion to HTML:
all figures of `rodsweep plot` that can be drawn from the result, and its tables."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ...config.document.reading import tree_yaml
from ...config.values import printable
from ...errors import InputError
from ...results.file.view import ResultView
from ..figures import draw
from ..figures.request import FIGURE_KINDS_BY_TASK, CycleShapeSolver
from ..summary import summary_of
from ..summary.selection import PointSelection
from ..summary.summary_lines import Summary, TextTable
from ..tables.column import Column
from ..tables.table_names import DEFAULT_TABLE, POINTS_TABLE
from ..tables.tables import Table, Tables
from .vector_picture import VectorPicture, vector_picture

ANIMATION_KIND = "animation"
"""Kind of figure that the page leaves out, because it is an animation."""
PLACEHOLDER_SVG_NAME = Path("figure.svg")
"""Output name with which figures for the page are requested; no file with this name is written."""


@dataclass(frozen=True, slots=True)
class CaptionedPicture:
    """A picture with its caption."""

    caption: str
    picture: VectorPicture


@dataclass(frozen=True, slots=True)
class Pictures:
    """Pictures of a result. captioned_pictures: pictures in their order on the page. reason_without_pictures:
    reason for which there is no picture; empty if there are pictures."""

    captioned_pictures: tuple[CaptionedPicture, ...]
    reason_without_pictures: str = ""


def pictures_of(
    views: Sequence[ResultView], shapes: CycleShapeSolver | None, numbers: "count[int]"
) -> Pictures:
    """Figures of every kind that show all `views`, the default figure of `rodsweep plot` first.

    shapes: function that computes the shapes of cycles for the default figure, if the file has no shapes.
    numbers: counter that numbers the pictures of the page.
    """
    # Remove the folders from the paths, so that no sentence on the page names a folder.
    views = [replace(view, path=Path(view.path.name)) for view in views]
    figure_kinds = [kind for kind in FIGURE_KINDS_BY_TASK.get(views[0].task, ()) if kind != ANIMATION_KIND]
    by_kind: dict[str, CaptionedPicture] = {}
    first_refusal_text = ""
    for kind in (None, *figure_kinds):
        figures: list[Figure] = []
        drawn_shapes = shapes if kind is None else None

        def keep(figure: Figure, figures: list[Figure] = figures) -> None:
            figures.append(figure)

        try:
            sentence = draw(views, PLACEHOLDER_SVG_NAME, what=kind, shapes=drawn_shapes, figure_callback=keep)
        except InputError as error:
            first_refusal_text = first_refusal_text or str(error)
            continue
        caption = sentence.removeprefix(f"wrote {PLACEHOLDER_SVG_NAME}: ")
        if caption not in by_kind:
            by_kind[caption] = CaptionedPicture(caption, vector_picture(figures[0], next(numbers), caption))
    return Pictures(tuple(by_kind.values()), "" if by_kind else first_refusal_text)


MAX_TABLE_ROWS = 60
"""Largest number of rows of a table on the page. `rodsweep export` writes all rows."""
CELL_DIGITS = 6
"""Number of significant digits of a number in a table; all digits are shown under the pointer."""


@dataclass(frozen=True, slots=True)
class Cell:
    """Cell of a table. text: rounded value. full_text: value with all digits; empty if `text` has all
    digits."""

    text: str
    full_text: str = ""


@dataclass(frozen=True, slots=True)
class PageTable:
    """Table on the page: columns, and cells of the shown rows. result_row_count: number of rows of the
    result, of which at most MAX_TABLE_ROWS are shown. constant_columns: (column, cell) for each column with
    equal values in all rows; these columns are listed outside the table."""

    name: str
    """Name of the table, as in `rodsweep export --table`."""
    columns: Sequence[Column]
    rows: Sequence[tuple[Cell, ...]]
    result_row_count: int
    constant_columns: Sequence[tuple[Column, Cell]]


def page_tables(view: ResultView) -> Iterator[PageTable]:
    """Yields all nonempty tables of a result: first the default table of the task, then the table of points,
    then the other tables."""
    tables = Tables(view)
    for name in dict.fromkeys((DEFAULT_TABLE[view.task], POINTS_TABLE, *tables.contents.table_names)):
        if name in tables.contents.table_names and (table := tables.table(name)).row_count:
            yield _table_for_page(table)


def _table_for_page(table: Table) -> PageTable:
    """The table in a form for the page: without empty columns; columns with equal values in all rows are
    listed separately."""
    filled_columns = [column for column in table.columns if not column.missing_mask.all()]
    is_constant = {
        column.name: table.row_count > 1
        and column.name != "status"
        and not column.missing_mask.any()
        and len(np.unique(column.values)) == 1
        for column in filled_columns
    }
    columns = [column for column in filled_columns if not is_constant[column.name]]
    cells = [_cells(column.with_rows(slice(0, MAX_TABLE_ROWS))) for column in columns]
    constants = [
        (column, _cells(column.with_rows(slice(0, 1)))[0])
        for column in filled_columns
        if is_constant[column.name]
    ]
    return PageTable(table.name, columns, list(zip(*cells, strict=True)), table.row_count, constants)


def _cells(column: Column) -> list[Cell]:
    """Cells for all values of a column; the text of a missing value is empty."""
    texts = column.csv_texts()
    if column.values.dtype.kind != "f" or column.flag_meanings or column.is_estimate:
        return list(map(Cell, texts))
    rounded_texts = [f"{value:.{CELL_DIGITS}g}" for value in column.values]
    return [
        Cell(rounded, text) if len(rounded) < len(text) else Cell(text)
        for rounded, text in zip(rounded_texts, texts, strict=True)
    ]


FILE_ATTRIBUTES_ON_PAGE = ("git_commit", "format", "petsc_options", "started", "finished", "fingerprint")
"""Attributes of the result file that the page lists below the versions of the software. None contains the
name of a machine or a user."""
VERSION_SUFFIX = "_version"
"""Ending of the attributes with versions of the software."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportContents:
    """Contents of the page about one result."""

    name: str
    """Name of the result file."""
    title: str
    """Title in the config; the name of the result file if there is no title."""
    task: str
    """Name of the task."""
    summary: Summary
    """Lines and tables that `rodsweep show` prints about the result."""
    statuses: TextTable
    """Table of statuses, numbers of points and meanings; with several statuses also the parameter ranges of
    each."""
    pictures: Pictures
    """Figures of the result."""
    tables: Sequence[PageTable]
    """All nonempty tables of the result, the default table of the task first."""
    given_config: str
    """Config as the user typed it."""
    complete_config: str
    """Config with the defaults of all keys filled in."""
    versions: Sequence[tuple[str, str]]
    """(printed name, value) of the versions of the software and of the attributes in
    FILE_ATTRIBUTES_ON_PAGE."""


def report_contents(view: ResultView, pictures: Pictures) -> ReportContents:
    """Contents of the page about the result `view`."""
    attributes = view.attributes
    summary = summary_of(view)
    name = printable(view.path.name)
    version_keys = [key for key in attributes if key.endswith(VERSION_SUFFIX)]
    return ReportContents(
        name=name,
        title=str(attributes.get("title", "")) or name,
        task=view.task,
        summary=summary,
        statuses=_statuses_with_parameter_ranges(view, summary.statuses),
        pictures=pictures,
        tables=list(page_tables(view)),
        given_config=str(attributes.get("config", "")).strip("\n"),
        complete_config=tree_yaml(view.config).strip("\n"),
        versions=[
            (key.removesuffix(VERSION_SUFFIX).replace("_", " "), str(attributes[key]))
            for key in (*version_keys, *FILE_ATTRIBUTES_ON_PAGE)
            if str(attributes.get(key, ""))
        ],
    )


def _statuses_with_parameter_ranges(view: ResultView, statuses: TextTable) -> TextTable:
    """Table of statuses. If there are several statuses, a column with the parameter ranges of each status is
    added."""
    if len(statuses.rows) == 1:
        return statuses
    list_view = view.as_list
    rows = []
    for word, count_text, meaning in statuses.rows:
        ranges_text = (
            PointSelection(list_view, list_view.has_status(word)).parameter_ranges_text()
            if word in view.status_flags.values()
            else ""
        )
        rows.append((word, count_text, ranges_text, meaning))
    status_heading, count_heading, meaning_heading = statuses.headings
    return TextTable((status_heading, count_heading, "where", meaning_heading), tuple(rows))
