"""Cells as text in aligned columns, no line longer than a given width."""

import re
import textwrap
from collections.abc import Iterator, Sequence

WIDTH = 80
"""Largest length of a printed line, in characters: the width of a terminal's window."""
GAP = "  "
"""Space between two columns."""
MIN_PROSE = 24
"""Smallest width of a last column of prose; narrower prose has a line of its own below the row."""
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|inf)")
NO_BREAK = "\xa0"
UNBREAKABLE = re.compile(r" = \S+| \(\+- [^)]*\)")
"""Parts of a sentence that stay on one line: a value beside its name, an error beside its number."""
Line = tuple[str, ...]


def folded(text: str, indent: str = "  ", width: int = WIDTH) -> str:
    """A text in lines of at most `width` characters, with an indent before every line but the first."""
    return textwrap.fill(text, width, subsequent_indent=indent, break_on_hyphens=False)


def refolded(line: str, width: int = WIDTH) -> str:
    """A line in lines of at most `width` characters, indented further than the line itself.

    A name and its value, and a number and its error, stay on one line. Names of files are not broken.
    """
    indent = " " * (len(line) - len(line.lstrip()) + 2)
    whole = UNBREAKABLE.sub(lambda match: match[0].replace(" ", NO_BREAK), line)
    lines = textwrap.wrap(
        whole, width, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )
    return "\n".join(lines).replace(NO_BREAK, " ")


def point_aligned(cells: Sequence[str]) -> list[str]:
    """Cells of a column of equal length, numbers with aligned decimal points, words at the left."""
    if not all(NUMBER.fullmatch(cell) for cell in cells if cell):
        width = max(map(len, cells), default=0)
        return [f"{cell:{width}}" for cell in cells]
    places = [re.search(r"[.e]|$", cell) for cell in cells]
    before = [0 if place is None else place.start() for place in places]
    left = max(before, default=0)
    right = max((len(cell) - place for cell, place in zip(cells, before, strict=True)), default=0)
    return [
        f"{' ' * (left - place)}{cell}{' ' * (right - len(cell) + place)}"
        for cell, place in zip(cells, before, strict=True)
    ]


def column_cells(heads: Sequence[str], cells: Sequence[str]) -> list[str]:
    """A column: heading lines above aligned cells, all of one width."""
    aligned = point_aligned(cells)
    width = max(map(len, (*heads, *aligned)))
    return [f"{cell:{width}}" for cell in (*heads, *aligned)]


def blocks(columns: Sequence[Sequence[str]], width: int = WIDTH) -> Iterator[list[str]]:
    """Yields blocks of lines at most `width` wide. Each block has the first column and some of the others.

    columns: cells of every column, as made by `column_cells`.
    """
    first, *others = columns
    block = [first]
    for column in others:
        taken = sum(len(each[0]) + len(GAP) for each in block)
        if len(block) > 1 and taken + len(column[0]) > width:
            yield _lines(block)
            block = [first]
        block.append(column)
    yield _lines(block)


def _lines(columns: Sequence[Sequence[str]]) -> list[str]:
    """Columns side by side, without empty lines."""
    lines = (GAP.join(cells).rstrip() for cells in zip(*columns, strict=True))
    return [line for line in lines if line]


def rows_with_prose(rows: Sequence[Line], width: int = WIDTH) -> list[str]:
    """Lines of a table whose last cells are prose, folded beside the other columns, or below them."""
    if not rows:
        return []
    *columns, prose = zip(*rows, strict=True)
    aligned = zip(*(point_aligned(column) if any(column) else column for column in columns), strict=True)
    before = [GAP.join(cells) for cells in aligned]
    room = width - max(map(len, before)) - len(GAP)
    lines = []
    for begin, text in zip(before, prose, strict=True):
        if room >= MIN_PROSE:
            first, *further = textwrap.wrap(text, room) or [""]
            lines.append(f"{begin}{GAP}{first}".rstrip())
            lines += [" " * (width - room) + line for line in further]
        else:
            lines += (
                [begin.rstrip(), *textwrap.wrap(text, width - 4, initial_indent=" " * 4)]
                if text
                else [begin.rstrip()]
            )
    return lines
