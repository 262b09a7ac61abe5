"""Layout of an answer in a terminal and in a notebook: first the numbers, then the lists in full."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from ...post.tables.columns import Column

PRINTED_DIGITS = 8
"""Significant digits printed; the stored values keep full precision."""
PRINTED_ERROR_DIGITS = 2
"""Significant digits of error estimates."""
REPR_WIDTH = 110
"""Maximum width, in characters, of a list printed with one item per line. A wider list gets one line per
variable, with the items side by side, if this is narrower."""
YES_NO = ("no", "yes")

Line = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Printed:
    """Content of a printed answer.

    numbers: columns with one row. absent: variables without a value for this rod. lists: columns by the name
    of the list; the first column numbers the items. named: lists not printed, with their number of rows.
    totals: number of items of a list, stored or not; of modes the number requested.
    """

    heading: str
    outcome: str
    numbers: tuple[Column, ...]
    absent: tuple[str, ...]
    lists: Mapping[str, tuple[Column, ...]]
    named: Mapping[str, int]
    totals: Mapping[str, int]

    @property
    def ends(self) -> Iterator[str]:
        """Lines below the tables: lists that are not printed, and variables without a value."""
        if self.named:
            yield "; ".join(f"{name}: {rows} row{'s' * (rows != 1)}" for name, rows in self.named.items())
        if self.absent:
            yield f"none: {', '.join(self.absent)}"


def text_of(printed: Printed) -> str:
    """An answer as text: every number with its unit and meaning, then the lists."""
    parts = [f"{printed.heading}\n{printed.outcome}", _aligned(_number_lines(printed.numbers))]
    for name, columns in printed.lists.items():
        title = _title(name, columns, printed.totals.get(name, 0))
        parts.append("\n".join(filter(None, (title, _aligned(_narrowest(columns))))))
    return "\n\n".join(filter(None, [*parts, "\n".join(printed.ends)]))


def html_of(printed: Printed) -> str:
    """An answer as HTML, with the content of `text_of`."""
    parts = [f"<p><b>{escape(printed.heading)}</b><br>{escape(printed.outcome)}</p>"]
    heads = (("variable", "value", "unit", "meaning"),)
    parts.append(_html_table(heads, _number_lines(printed.numbers)))
    for name, columns in printed.lists.items():
        parts.append(f"<p>{escape(_title(name, columns, printed.totals.get(name, 0)))}</p>")
        lines = _upright(columns)
        parts.append(_html_table(lines[:2], lines[2:]) if len(columns[0].values) else "")
    return "".join([*parts, *(f"<p>{escape(end)}</p>" for end in printed.ends)])


def _title(name: str, columns: Sequence[Column], total: int) -> str:
    """Heading of a list: name and number of items, and the total if this is larger."""
    count = len(columns[0].values)
    return f"{name}: {count or 'none'}{f' of {total}' if total > count else ''}" + (
        f", {columns[0].meaning}" if count > 1 else ""
    )


def _number_lines(columns: Sequence[Column]) -> list[Line]:
    """(name, value, unit, meaning) of columns with one row."""
    return [(c.name, *_texts(c), _unit(c), c.meaning) for c in columns]


def _narrowest(columns: Sequence[Column]) -> list[Line]:
    """Lines of a list; empty for an empty list.

    One item per line if this fits `REPR_WIDTH` or is the narrower layout, otherwise one variable per line.
    """
    if not len(columns[0].values):
        return []
    there = [column for column in columns if not column.absent.all()]
    upright = _upright(there)
    turned = [(c.name, *_texts(c), _unit(c)) for c in there]
    return upright if _width(upright) <= max(REPR_WIDTH, _width(turned)) else turned


def _upright(columns: Sequence[Column]) -> list[Line]:
    """Lines of a list with one item per line, below a line of names and a line of units."""
    heads = [tuple(c.name for c in columns), tuple(map(_unit, columns))]
    return [*heads, *zip(*map(_texts, columns), strict=True)]


def _texts(column: Column) -> list[str]:
    """Values of a column as printed: words, rounded numbers, and "" for missing values."""
    if column.is_boolean:
        return [YES_NO[int(value)] for value in column.values]
    if column.words or column.values.dtype.kind != "f":
        return column.text()
    digits = PRINTED_ERROR_DIGITS if column.is_estimate else PRINTED_DIGITS
    texts = (f"{value + 0.0:.{digits}g}" for value in column.values)
    return ["" if none else text for text, none in zip(texts, column.absent, strict=True)]


def _unit(column: Column) -> str:
    return "" if column.unit == "1" else column.unit


def _width(lines: Sequence[Line]) -> int:
    return sum(widths_of(lines)) + 2 * len(lines[0])


def widths_of(lines: Sequence[Line]) -> list[int]:
    """Width of every column, in characters, of lines of cells."""
    return [max(map(len, cells)) for cells in zip(*lines, strict=True)]


def _aligned(lines: Sequence[Line]) -> str:
    """Lines of cells as text in aligned columns."""
    widths = widths_of(lines)
    rows = ("  ".join(f"{c:{w}}" for c, w in zip(line, widths, strict=True)).rstrip() for line in lines)
    return "\n".join(rows)


def _html_table(heads: Sequence[Line], lines: Sequence[Line]) -> str:
    def row(cells: Line, tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join([*(row(line, "th") for line in heads), *(row(line, "td") for line in lines)])
    return f"<table>{body}</table>"
