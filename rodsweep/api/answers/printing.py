"""Layout of an answer in a terminal and in a notebook: about ten lines, or on request all numbers and lists.

Both layouts begin with the answer in a sentence, the rod, and the meaning of the status. No line is longer
than 80 characters; numbers have as many digits as the error allows.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from ...post.headline.one_rod import OneRod
from ...post.headline.sentences import HEADLINES, Headline
from ...post.tables.alignment import COLUMN_GAP, WIDTH, Line, blocks, column_cells, folded, rows_with_prose
from ...post.tables.columns import Column
from ...wording import counted

BRIEF_LINES = 11
"""Largest number of lines of an answer at a prompt, unless the sentences above the numbers need more."""
MIN_ROWS = 3
"""Number of numbers, or of rows of a list, that are printed even if the lines above are many."""
PROOFS = ("not certified", "certified")
"""Words for the completeness of the list of an answer."""
ERROR_SIGN = "+-"
"""Sign between a number and its error."""


@dataclass(frozen=True, slots=True)
class PrintedAnswer:
    """Content of a printed answer."""

    rod: OneRod
    heading: tuple[str, ...]
    """Lines with the answer, the rod and the status."""
    headline: Headline
    numbers: tuple[Column, ...]
    """Variables with a single value, as columns with one row."""
    absent: tuple[str, ...]
    """Variables without a value for this rod."""
    lists: Mapping[str, tuple[Column, ...]]
    """Columns of each printed list, by the name of the list; the first column numbers the items."""
    named: Mapping[str, int]
    """Number of rows of each list that is not printed, by name."""
    totals: Mapping[str, int]
    """Number of items of each list, stored or not; of modes the number requested."""

    @property
    def closing_lines(self) -> Iterator[str]:
        """Lines below the tables: lists that are not printed, and variables without a value."""
        if self.named:
            yield "; ".join(f"{name}: {rows} row{'s' * (rows != 1)}" for name, rows in self.named.items())
        if self.absent:
            yield f"none: {', '.join(self.absent)}"


def first_lines(rod: OneRod, name: str, status: str, sentence: str, message: str) -> tuple[str, ...]:
    """(answer, rod, status with its meaning); without an answer the meaning of the status comes first."""
    task = rod.view.task
    meaning = "; ".join(filter(None, (sentence, message)))
    answer = HEADLINES[task].sentence(rod)
    certified = rod.count("certified")
    proof = "" if certified is None else f", {PROOFS[certified]}"
    if not answer:
        return f"{task}: {meaning}", f"{name}, {task}: {status}"
    return answer, f"{name}, {task}: {status}{proof}", meaning


def brief_text(printed: PrintedAnswer) -> str:
    """An answer in about ten lines: the sentence, the main numbers and the main list."""
    lines = [*_heads(printed), *_number_lines(printed)]
    more = _more(printed)
    lines += _brief_list(printed, BRIEF_LINES - len(lines) - more.count("\n") - 1)
    return "\n".join([*lines, more])


def brief_html(printed: PrintedAnswer) -> str:
    """An answer as HTML, with the content of `brief_text`."""
    parts = [_html_heading(printed)]
    if pairs := _number_pairs(printed):
        parts.append(_html_table([], [(name, value, error, unit) for name, value, error, unit in pairs]))
    columns, _ = _brief_cells(printed, BRIEF_LINES)
    if columns:
        name, unit, *rows = zip(*columns, strict=True)
        parts.append(_html_table([name, unit], rows))
    return "".join([*parts, f"<p>{escape(' '.join(_more(printed).split()))}</p>"])


def whole_text(printed: PrintedAnswer) -> str:
    """An answer as text: every number with its unit and meaning, then the lists."""
    rows = [(c.name, printed.rod.points.texts(c.name)[0], _unit(c), c.meaning) for c in printed.numbers]
    parts = ["\n".join(_heads(printed)), "\n".join(["numbers", *rows_with_prose(rows)]) if rows else ""]
    for name, columns in printed.lists.items():
        lines = [folded(_title(name, columns, printed.totals.get(name, 0)))]
        if len(columns[0].values):
            digits = printed.rod.lists[name]
            kept = [column for column in columns if not column.absent.all()]
            cells = [column_cells((c.name, _unit(c)), digits.texts(c.name)) for c in kept]
            for number, block in enumerate(blocks(cells)):
                lines += ["", *block] if number else block
        parts.append("\n".join(lines))
    return "\n\n".join(filter(None, [*parts, "\n".join(map(folded, printed.closing_lines))]))


def whole_html(printed: PrintedAnswer) -> str:
    """An answer as HTML, with the content of `whole_text`."""
    rows = [(c.name, printed.rod.points.texts(c.name)[0], _unit(c), c.meaning) for c in printed.numbers]
    parts = [_html_heading(printed), _html_table([("variable", "value", "unit", "meaning")], rows)]
    for name, columns in printed.lists.items():
        parts.append(f"<p>{escape(_title(name, columns, printed.totals.get(name, 0)))}</p>")
        digits = printed.rod.lists[name]
        heads = [tuple(column.name for column in columns), tuple(map(_unit, columns))]
        rows_of = list(zip(*(digits.texts(column.name) for column in columns), strict=True))
        parts.append(_html_table(heads, rows_of) if rows_of else "")
    return "".join([*parts, *(f"<p>{escape(end)}</p>" for end in printed.closing_lines)])


def _heads(printed: PrintedAnswer) -> list[str]:
    """Lines of the heading, folded at the width of the window."""
    return [line for text in printed.heading if text for line in folded(text).splitlines()]


def _title(name: str, columns: Sequence[Column], total: int) -> str:
    """Heading of a list: name and number of items, and the total if this is larger."""
    count = len(columns[0].values)
    return f"{name}: {count or 'none'}{f' of {total}' if total > count else ''}" + (
        f", {columns[0].meaning}" if count > 1 else ""
    )


def _number_pairs(printed: PrintedAnswer) -> list[tuple[str, str, str, str]]:
    """(name, value, error with sign, unit) of each number of the headline that is not missing."""
    pairs = []
    for name in printed.headline.numbers:
        column = printed.rod.column(name)
        if column is not None:
            ((value, error),) = printed.rod.points.pairs(column.name)
            pairs.append((column.name, value, f"{ERROR_SIGN} {error}" if error else "", _unit(column)))
    return pairs


def _number_lines(printed: PrintedAnswer) -> list[str]:
    """Aligned lines of the numbers of the headline, below an empty line."""
    room = BRIEF_LINES - len(_heads(printed)) - 2  # beside the empty line and the last line
    pairs = _number_pairs(printed)[: max(room, MIN_ROWS)]
    if not pairs:
        return []
    cells = [column_cells((), column) for column in zip(*pairs, strict=True)]
    kept = [column for column in cells if column[0].strip() or any(map(str.strip, column))]
    return ["", *(COLUMN_GAP.join(row).rstrip() for row in zip(*kept, strict=True))]


def _brief_cells(printed: PrintedAnswer, room: int) -> tuple[list[list[str]], int]:
    """(columns of the list of the headline, number of its items); room: largest number of rows.

    A column has the cells name, unit, and values; errors follow as a column of their own. As many columns are
    printed as the window is wide.
    """
    digits = printed.rod.lists.get(printed.headline.table)
    if digits is None:
        return [], 0
    names = [printed.rod.preferred(digits, name) for name in printed.headline.columns]
    columns = [digits.columns[name] for name in names if name in digits.columns]
    columns = [column for column in columns if not column.absent.all()]
    count = len(columns[0].values) if columns else 0
    found: list[list[str]] = []
    width = -len(COLUMN_GAP)
    for column in columns if count else ():
        values, errors = zip(*digits.pairs(column.name)[:room], strict=True)
        added = [column_cells((column.name, _unit(column)), values)]
        added += [column_cells((ERROR_SIGN, ""), errors)] if any(errors) else []
        width += sum(len(cells[0]) + len(COLUMN_GAP) for cells in added)
        if width > WIDTH:
            break
        found += added
    return found, count


def _brief_list(printed: PrintedAnswer, room: int) -> list[str]:
    """Lines of the list of the headline below an empty line; room: number of lines left."""
    rows = max(room - 3, MIN_ROWS)  # below an empty line, the names and the units
    columns, count = _brief_cells(printed, rows)
    if count == rows + 1:  # the line "and 1 more" has room for the row
        columns, count = _brief_cells(printed, count)
    if not columns:
        return []
    (block,) = blocks(columns)
    return ["", *block] + ([f"and {count - rows} more"] if count > rows + 1 else [])


def _more(printed: PrintedAnswer) -> str:
    """Line on how to see the rest: the whole table, and the lists with their numbers of items."""
    rows = {name: len(columns[0].values) for name, columns in printed.lists.items()}
    rows.update(printed.named)
    lists = [f".{name} ({counted(number, 'row')})" for name, number in rows.items() if number]
    return folded(f"everything: .table(){'; lists: ' if lists else ''}{', '.join(lists)}")


def _unit(column: Column) -> str:
    return "" if column.unit == "1" else column.unit


def _html_heading(printed: PrintedAnswer) -> str:
    """The heading as a paragraph, the answer in bold letters."""
    answer, *others = map(escape, filter(None, printed.heading))
    return f"<p><b>{answer}</b>{''.join(f'<br>{line}' for line in others)}</p>"


def _html_table(heads: Sequence[Line], lines: Sequence[Line]) -> str:
    def row(cells: Line, tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell.strip())}</{tag}>" for cell in cells) + "</tr>"

    body = "".join([*(row(line, "th") for line in heads), *(row(line, "td") for line in lines)])
    return f"<table>{body}</table>"
