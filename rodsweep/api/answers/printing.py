"""Text and HTML of an answer: a short form of about ten lines, and a long form with all numbers and lists.

The short and the long form begin with the result in a sentence, the rod, and the meaning of the status. No
line of text is longer than 80 characters. Numbers have as many digits as their errors allow.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from ...model.arm.neglected import Validity
from ...post.headline.one_rod import SingleRodResult
from ...post.headline.sentences import HEADLINES, Headline
from ...post.summary.arm.validity_sentences import validity_caveat
from ...post.tables.alignment import (
    COLUMN_GAP,
    LINE_WIDTH,
    RowCells,
    aligned_column_cells,
    rows_with_prose,
    table_blocks,
    wrap_cell_text,
)
from ...post.tables.column import Column
from ...wording import counted

MAX_BRIEF_LINES = 11
"""Maximum number of lines of the short text of an answer. A long heading may exceed the maximum."""
MIN_PRINTED_ROWS = 3
"""Minimum number of printed numbers, or printed rows of a list, whatever the length of the heading."""
CERTIFIED_TEXTS = ("not certified", "certified")
"""Texts for the values 0 and 1 of the variable certified."""
ERROR_SEPARATOR = "+-"
"""Sign between a number and its error."""


@dataclass(frozen=True, slots=True)
class PrintedAnswerContents:
    """Everything that the text or HTML of an answer contains."""

    result: SingleRodResult
    """Numbers and lists of the answer, with the digits to print."""
    heading: tuple[str, ...]
    """Lines with the result in a sentence, the rod, and the meaning of the status."""
    headline: Headline
    """Main numbers and main list of the task."""
    single_value_columns: tuple[Column, ...]
    """Variables with a single value, as columns with one row."""
    names_without_value: tuple[str, ...]
    """Names of the variables that have no value for this rod; empty unless the status is 0, that is,
    success."""
    lists: Mapping[str, tuple[Column, ...]]
    """Columns of each list printed in full, by name of the list; the first column numbers the items."""
    row_counts: Mapping[str, int]
    """Number of rows of each list that has rows but is not printed in full, by name of the list."""
    found_counts: Mapping[str, int]
    """Number of items found, including items that are not stored, by name of the list; for modes, the number
    of requested modes."""

    @property
    def closing_lines(self) -> Iterator[str]:
        """Yields the lines below the tables: names of lists not printed, and of variables without a value."""
        if self.row_counts:
            yield "; ".join(f"{name}: {counted(rows, 'row')}" for name, rows in self.row_counts.items())
        if self.names_without_value:
            yield f"none: {', '.join(self.names_without_value)}"


def heading_lines(
    rod: SingleRodResult, name: str, status: str, sentence: str, message: str
) -> tuple[str, ...]:
    """Lines of the heading: the result in a sentence, the rod with its status, and the status's meaning. If
    the model does not apply to an arm, or its validity is doubtful, the first line says so.

    name: text of the rod. status: name. sentence, message: meaning of the status, and message on the rod.
    """
    task = rod.view.task
    meaning = "; ".join(filter(None, (sentence, message)))
    answer = HEADLINES[task].sentence(rod)
    certified = rod.integer_value("certified")
    proof_text = "" if certified is None else f", {CERTIFIED_TEXTS[certified]}"
    if not answer:
        return f"{task}: {meaning}", f"{name}, {task}: {status}"
    caveat = validity_caveat(rod.view.variables)
    if caveat and rod.integer_value("model_applies") == Validity.does_not_apply:
        answer = f"if the model applied: {answer}"
    return *filter(None, (caveat, answer)), f"{name}, {task}: {status}{proof_text}", meaning


def brief_text(printed: PrintedAnswerContents) -> str:
    """Short text of an answer, about ten lines: the heading, the main numbers and the main list."""
    lines = [*_wrapped_heading(printed), *_number_lines(printed)]
    remaining_line = _full_listing_hint(printed)
    lines += _brief_list(printed, MAX_BRIEF_LINES - len(lines) - remaining_line.count("\n") - 1)
    return "\n".join([*lines, remaining_line])


def brief_html(printed: PrintedAnswerContents) -> str:
    """Short HTML of an answer, with the content of `brief_text`."""
    blocks = [_html_heading(printed)]
    if pairs := _main_number_texts(printed):
        blocks.append(_html_table([], pairs))
    columns, _ = _main_list_columns_and_row_count(printed, MAX_BRIEF_LINES)
    if columns:
        name, unit, *rows = zip(*columns, strict=True)
        blocks.append(_html_table([name, unit], rows))
    return "".join([*blocks, f"<p>{escape(' '.join(_full_listing_hint(printed).split()))}</p>"])


def whole_text(printed: PrintedAnswerContents) -> str:
    """Long text of an answer: the heading, every number with its unit and meaning, the lists that are printed
    in full, and the numbers of rows of all other lists."""
    numbers_text = (
        "\n".join(["numbers", *rows_with_prose(_number_rows(printed))])
        if printed.single_value_columns
        else ""
    )
    blocks = ["\n".join(_wrapped_heading(printed)), numbers_text]
    for name, columns in printed.lists.items():
        lines = [wrap_cell_text(_list_title(name, columns, printed.found_counts.get(name, 0)))]
        if len(columns[0].values):
            digits = printed.result.list_texts[name]
            stored_columns = [column for column in columns if not column.missing_mask.all()]
            cells = [
                aligned_column_cells((c.name, c.printed_unit), digits.texts(c.name)) for c in stored_columns
            ]
            for block_index, block in enumerate(table_blocks(cells)):
                lines += ["", *block] if block_index else block
        blocks.append("\n".join(lines))
    return "\n\n".join(filter(None, [*blocks, "\n".join(map(wrap_cell_text, printed.closing_lines))]))


def whole_html(printed: PrintedAnswerContents) -> str:
    """Long HTML of an answer, with the content of `whole_text`."""
    headings: list[RowCells] = [("variable", "value", "unit", "meaning")]
    blocks = [_html_heading(printed), _html_table(headings, _number_rows(printed))]
    for name, columns in printed.lists.items():
        blocks.append(f"<p>{escape(_list_title(name, columns, printed.found_counts.get(name, 0)))}</p>")
        digits = printed.result.list_texts[name]
        headings = [tuple(column.name for column in columns), tuple(c.printed_unit for c in columns)]
        rows_of = list(zip(*(digits.texts(column.name) for column in columns), strict=True))
        blocks.append(_html_table(headings, rows_of) if rows_of else "")
    return "".join([*blocks, *(f"<p>{escape(end)}</p>" for end in printed.closing_lines)])


def _number_rows(printed: PrintedAnswerContents) -> list[tuple[str, str, str, str]]:
    """Texts (name, value, unit, meaning) of every number."""
    texts = printed.result.point_texts
    return [(c.name, texts.texts(c.name)[0], c.printed_unit, c.meaning) for c in printed.single_value_columns]


def _wrapped_heading(printed: PrintedAnswerContents) -> list[str]:
    """Lines of the heading, folded at the maximum width of a line."""
    return [line for text in printed.heading if text for line in wrap_cell_text(text).splitlines()]


def _list_title(name: str, columns: Sequence[Column], total: int) -> str:
    """Title of a list: name and number of rows. total: number of items found, printed if larger than the
    number of rows."""
    row_count = len(columns[0].values)
    meaning = f", {columns[0].meaning}" if row_count > 1 else ""
    return f"{name}: {row_count or 'none'}{f' of {total}' if total > row_count else ''}{meaning}"


def _main_number_texts(printed: PrintedAnswerContents) -> list[tuple[str, str, str, str]]:
    """(name, value, error with sign, unit), as texts, for each main number of the task that has a value."""
    name_and_number_texts = []
    for name in printed.headline.number_variables:
        column = printed.result.column(name)
        if column is not None:
            ((value, error),) = printed.result.point_texts.value_and_error_texts(column.name)
            name_and_number_texts.append(
                (column.name, value, f"{ERROR_SEPARATOR} {error}" if error else "", column.printed_unit)
            )
    return name_and_number_texts


def _number_lines(printed: PrintedAnswerContents) -> list[str]:
    """Aligned lines of the main numbers of the task, after an empty line; empty if no main number has a
    value."""
    max_lines = (
        MAX_BRIEF_LINES - len(_wrapped_heading(printed)) - 2
    )  # beside the empty line and the last line
    pairs = _main_number_texts(printed)[: max(max_lines, MIN_PRINTED_ROWS)]
    if not pairs:
        return []
    cells = [aligned_column_cells((), column) for column in zip(*pairs, strict=True)]
    filled_columns = [column for column in cells if column[0].strip() or any(map(str.strip, column))]
    return ["", *(COLUMN_GAP.join(row).rstrip() for row in zip(*filled_columns, strict=True))]


def _main_list_columns_and_row_count(
    printed: PrintedAnswerContents, max_rows: int
) -> tuple[list[list[str]], int]:
    """Returns (columns of the main list, number of rows of the complete list). A column has the cells name,
    unit and up to `max_rows` values; errors form a separate column. The first column that makes a line longer
    than LINE_WIDTH and all later columns are omitted. Returns ([], 0) for a task without a main list."""
    digits = printed.result.list_texts.get(printed.headline.list_name)
    if digits is None:
        return [], 0
    names = [printed.result.si_name_or_name(digits, name) for name in printed.headline.columns]
    columns = [digits.columns[name] for name in names if name in digits.columns]
    columns = [column for column in columns if not column.missing_mask.all()]
    row_count = len(columns[0].values) if columns else 0
    columns_of_cells: list[list[str]] = []
    width = -len(COLUMN_GAP)
    for column in columns if row_count else ():
        values, errors = zip(*digits.value_and_error_texts(column.name)[:max_rows], strict=True)
        added = [aligned_column_cells((column.name, column.printed_unit), values)]
        added += [aligned_column_cells((ERROR_SEPARATOR, ""), errors)] if any(errors) else []
        width += sum(len(cells[0]) + len(COLUMN_GAP) for cells in added)
        if width > LINE_WIDTH:
            break
        columns_of_cells += added
    return columns_of_cells, row_count


def _brief_list(printed: PrintedAnswerContents, max_lines: int) -> list[str]:
    """Lines of the main list, after an empty line; empty if the list has no rows. max_lines: desired maximum
    number of lines; at least MIN_PRINTED_ROWS rows are printed."""
    rows = max(max_lines - 3, MIN_PRINTED_ROWS)  # below an empty line, the names and the units
    columns, row_count = _main_list_columns_and_row_count(printed, rows)
    if row_count == rows + 1:  # the line "and 1 more" has room for the row
        columns, row_count = _main_list_columns_and_row_count(printed, row_count)
    if not columns:
        return []
    (block,) = table_blocks(columns)
    return ["", *block] + ([f"and {row_count - rows} more"] if row_count > rows + 1 else [])


def _full_listing_hint(printed: PrintedAnswerContents) -> str:
    """Line that names `.table()` for all numbers, and the lists with their numbers of rows."""
    row_counts = {name: len(columns[0].values) for name, columns in printed.lists.items()}
    row_counts.update(printed.row_counts)
    lists = [f".{name} ({counted(number, 'row')})" for name, number in row_counts.items() if number]
    return wrap_cell_text(f"all numbers: .table(){'; lists: ' if lists else ''}{', '.join(lists)}")


def _html_heading(printed: PrintedAnswerContents) -> str:
    """The heading as an HTML paragraph, its first line in bold letters."""
    answer, *other_lines = map(escape, filter(None, printed.heading))
    return f"<p><b>{answer}</b>{''.join(f'<br>{line}' for line in other_lines)}</p>"


def _html_table(headings: Sequence[RowCells], lines: Sequence[RowCells]) -> str:
    def row(cells: RowCells, tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell.strip())}</{tag}>" for cell in cells) + "</tr>"

    body = "".join([*(row(line, "th") for line in headings), *(row(line, "td") for line in lines)])
    return f"<table>{body}</table>"
