"""How the answer for one rod looks in a terminal and in a notebook: its numbers, then its lists in full."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from ...post.tables.columns import Column

DIGITS = 8
"""Significant digits that are shown; the values have all of theirs."""
ERROR_DIGITS = 2
"""The same of errors, which are estimates."""
WIDTH = 110
"""Columns of a terminal that a list may take before it is turned: its items side by side."""
YES_NO = ("no", "yes")

Line = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Printed:
    """What is shown of an answer.

    numbers: columns of one row; absent: names of variables that this rod has none of; lists: by name, columns
    of which the first numbers the items; named: lists that are too long to be shown, with their rows; totals:
    how many items there are of lists, stored or not, or were asked for.
    """

    heading: str
    told: str
    numbers: tuple[Column, ...]
    absent: tuple[str, ...]
    lists: Mapping[str, tuple[Column, ...]]
    named: Mapping[str, int]
    totals: Mapping[str, int]

    @property
    def ends(self) -> Iterator[str]:
        """What is said below the tables."""
        if self.named:
            yield "; ".join(f"{name}: {rows} row{'s' * (rows != 1)}" for name, rows in self.named.items())
        if self.absent:
            yield f"none: {', '.join(self.absent)}"


def text_of(printed: Printed) -> str:
    """An answer as text: every number with its unit and meaning, then the lists."""
    parts = [f"{printed.heading}\n{printed.told}", _aligned(_number_lines(printed.numbers))]
    for name, columns in printed.lists.items():
        title = _title(name, columns, printed.totals.get(name, 0))
        parts.append("\n".join(filter(None, (title, _aligned(_narrowest(columns))))))
    return "\n\n".join(filter(None, [*parts, "\n".join(printed.ends)]))


def html_of(printed: Printed) -> str:
    """The same as HTML."""
    parts = [f"<p><b>{escape(printed.heading)}</b><br>{escape(printed.told)}</p>"]
    heads = (("variable", "value", "unit", "meaning"),)
    parts.append(_html_table(heads, _number_lines(printed.numbers)))
    for name, columns in printed.lists.items():
        parts.append(f"<p>{escape(_title(name, columns, printed.totals.get(name, 0)))}</p>")
        lines = _upright(columns)
        parts.append(_html_table(lines[:2], lines[2:]) if len(columns[0].values) else "")
    return "".join([*parts, *(f"<p>{escape(end)}</p>" for end in printed.ends)])


def _title(name: str, columns: Sequence[Column], total: int) -> str:
    """The name of a list, how many items it has, and of how many where these are more."""
    count = len(columns[0].values)
    return f"{name}: {count or 'none'}{f' of {total}' if total > count else ''}" + (
        f", {columns[0].meaning}" if count > 1 else ""
    )


def _number_lines(columns: Sequence[Column]) -> list[Line]:
    """(name, value, unit, meaning) of columns of one row."""
    return [(c.name, *_texts(c), _unit(c), c.meaning) for c in columns]


def _narrowest(columns: Sequence[Column]) -> list[Line]:
    """The lines of a list: an item a line where that fits, else a variable a line, if there are few items."""
    if not len(columns[0].values):
        return []
    there = [column for column in columns if not column.absent.all()]
    upright = _upright(there)
    turned = [(c.name, *_texts(c), _unit(c)) for c in there]
    return upright if _width(upright) <= max(WIDTH, _width(turned)) else turned


def _upright(columns: Sequence[Column]) -> list[Line]:
    """The names, the units, and then an item a line."""
    heads = [tuple(c.name for c in columns), tuple(map(_unit, columns))]
    return [*heads, *zip(*map(_texts, columns), strict=True)]


def _texts(column: Column) -> list[str]:
    """The values of a column as they are shown: numbers with few digits, words, nothing for nothing."""
    if column.is_boolean:
        return [YES_NO[int(value)] for value in column.values]
    if column.words or column.values.dtype.kind != "f":
        return column.text()
    digits = ERROR_DIGITS if column.is_estimate else DIGITS
    texts = (f"{value + 0.0:.{digits}g}" for value in column.values)
    return ["" if none else text for text, none in zip(texts, column.absent, strict=True)]


def _unit(column: Column) -> str:
    return "" if column.unit == "1" else column.unit


def _width(lines: Sequence[Line]) -> int:
    return sum(widths_of(lines)) + 2 * len(lines[0])


def widths_of(lines: Sequence[Line]) -> list[int]:
    """The width of every column of lines of cells."""
    return [max(map(len, cells)) for cells in zip(*lines, strict=True)]


def _aligned(lines: Sequence[Line]) -> str:
    """Lines of cells as text in columns."""
    widths = widths_of(lines)
    rows = ("  ".join(f"{c:{w}}" for c, w in zip(line, widths, strict=True)).rstrip() for line in lines)
    return "\n".join(rows)


def _html_table(heads: Sequence[Line], lines: Sequence[Line]) -> str:
    def row(cells: Line, tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join([*(row(line, "th") for line in heads), *(row(line, "td") for line in lines)])
    return f"<table>{body}</table>"
