"""Tables and words of the benchmarks' text, in Markdown."""

from collections.abc import Iterable, Mapping
from math import isnan


class Shown(float):
    """A number that is written as nothing where it is nan."""

    def __format__(self, form: str) -> str:
        return "" if isnan(self) else super().__format__(form)


def table(head: str, line: str, rows: Iterable[Mapping[str, object]]) -> str:
    """A table: its head, and the line that each row fills in, as in "{method} | {seconds:.2f}"."""
    lines = [f"| {head} |", "|" + "---|" * (head.count("|") + 1)]
    for row in rows:
        cells = {k: Shown(value) if isinstance(value, int | float) else value for k, value in row.items()}
        lines.append(f"| {line.format_map(cells)} |")
    return "\n".join(lines)


def plural(count: int, noun: str) -> str:
    """As in "1 round", "2 rounds"."""
    return f"{count} {noun}{'s' * (count != 1)}"
