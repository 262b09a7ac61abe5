"""Text of tables with aligned columns, and wrapping of lines at a given width."""

import re
import textwrap
from collections.abc import Iterator, Sequence

LINE_WIDTH = 80
"""Largest length of a printed line, in characters: the usual width of a terminal."""
COLUMN_GAP = "  "
"""Space between two columns."""
MIN_PROSE_WIDTH = 24
"""Smallest width, in characters, of a last column of prose. If less space remains, the prose is written on
separate lines below the row."""
NUMBER_PATTERN = re.compile(r"[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|inf)")
"""Pattern for a number in decimal notation, or inf."""
NO_BREAK_SPACE = "\xa0"
"""No-break space; a line is never broken at this character."""
UNBREAKABLE_PATTERN = re.compile(r" = \S+| \(\+- [^)]*\)")
"""Pattern for the parts of a sentence that stay on one line: "= value" after a name, and an error in brackets
after a number."""
RowCells = tuple[str, ...]
"""Cells of a row, or of one line of the headings."""


def wrap_cell_text(text: str, indent: str = "  ", width: int = LINE_WIDTH) -> str:
    """`text` wrapped to lines of at most `width` characters; all lines except the first start with
    `indent`."""
    return textwrap.fill(text, width, subsequent_indent=indent, break_on_hyphens=False)


def rewrap_line(line: str, width: int = LINE_WIDTH) -> str:
    """`line` wrapped to at most `width` characters; the following lines are indented by two more spaces.

    A name and its value stay on one line, as do a number and its error. File names are not broken.
    """
    indent = " " * (len(line) - len(line.lstrip()) + 2)
    unbroken = UNBREAKABLE_PATTERN.sub(lambda group: group[0].replace(" ", NO_BREAK_SPACE), line)
    lines = textwrap.wrap(
        unbroken, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )
    return "\n".join(lines).replace(NO_BREAK_SPACE, " ")


def aligned_at_decimal_points(cells: Sequence[str]) -> list[str]:
    """Cells of a column padded to equal length. Numbers are aligned at their decimal points; if a cell is not
    a number, all cells are aligned at the left."""
    if not all(NUMBER_PATTERN.fullmatch(cell) for cell in cells if cell):
        width = max(map(len, cells), default=0)
        return [f"{cell:{width}}" for cell in cells]
    point_matches = [re.search(r"[.e]|$", cell) for cell in cells]
    lengths_before = [0 if point is None else point.start() for point in point_matches]
    max_before = max(lengths_before, default=0)
    max_after = max((len(cell) - point for cell, point in zip(cells, lengths_before, strict=True)), default=0)
    return [
        f"{' ' * (max_before - point)}{cell}{' ' * (max_after - len(cell) + point)}"
        for cell, point in zip(cells, lengths_before, strict=True)
    ]


def aligned_column_cells(heading_lines: Sequence[str], cells: Sequence[str]) -> list[str]:
    """Heading lines and cells of a column, padded to equal length. The cells are aligned as in
    `aligned_at_decimal_points`."""
    aligned_cells = aligned_at_decimal_points(cells)
    width = max(map(len, (*heading_lines, *aligned_cells)))
    return [f"{cell:{width}}" for cell in (*heading_lines, *aligned_cells)]


def table_blocks(columns: Sequence[Sequence[str]], width: int = LINE_WIDTH) -> Iterator[list[str]]:
    """Yields blocks of lines at most `width` wide: the first column, and as many of the following columns as
    fit. columns: cells of every column, as from `aligned_column_cells`."""
    first_column, *other_columns = columns
    block = [first_column]
    for column in other_columns:
        used_width = sum(len(block_column[0]) + len(COLUMN_GAP) for block_column in block)
        if len(block) > 1 and used_width + len(column[0]) > width:
            yield _table_lines(block)
            block = [first_column]
        block.append(column)
    yield _table_lines(block)


def _table_lines(columns: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table with the given columns, without empty lines."""
    lines = (COLUMN_GAP.join(cells).rstrip() for cells in zip(*columns, strict=True))
    return [line for line in lines if line]


def rows_with_prose(rows: Sequence[RowCells], width: int = LINE_WIDTH) -> list[str]:
    """Lines of a table whose last column is prose. The prose is wrapped to the right of the other columns, or
    below the row if less than MIN_PROSE_WIDTH remains. width: largest length of a line."""
    if not rows:
        return []
    *columns, proses = zip(*rows, strict=True)
    aligned = (aligned_at_decimal_points(column) if any(column) else column for column in columns)
    row_starts = [COLUMN_GAP.join(cells) for cells in zip(*aligned, strict=True)]
    prose_width = width - max(map(len, row_starts)) - len(COLUMN_GAP)
    lines = []
    for row_start, text in zip(row_starts, proses, strict=True):
        if prose_width >= MIN_PROSE_WIDTH:
            first_line, *other_lines = textwrap.wrap(text, prose_width) or [""]
            lines.append(f"{row_start}{COLUMN_GAP}{first_line}".rstrip())
            lines += [" " * (width - prose_width) + line for line in other_lines]
        else:
            lines += [row_start.rstrip(), *textwrap.wrap(text, width - 4, initial_indent=" " * 4)]
    return lines
