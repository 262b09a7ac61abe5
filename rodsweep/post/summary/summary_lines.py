"""Lines and tables of the summary of a result, in the order of printing."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...results.file.view import View
from ...results.layouts.rods import has_covering
from ...wording import counted
from .ranges import span

NAMED_THINGS = 8
"""Largest number of things listed individually."""


@dataclass(frozen=True, slots=True)
class TextTable:
    """Table of texts: its headings, of one or two lines, and rows of as many cells."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class SummaryLines:
    """Sentences about a result."""

    answer: Sequence[str]
    """The results asked for."""
    trust: Sequence[str] = ()
    """Accuracy and proved completeness."""
    details: Sequence[str] = ()
    """Further results."""
    of_arm: Sequence[str] = ()
    """Parts of the answer in the units of an arm."""
    numbers: TextTable | None = None
    """Table below the answer."""


@dataclass(frozen=True, slots=True)
class Summary:
    """Everything that `rodsweep show` prints about a file, in the order of printing."""

    answer: Sequence[str]
    """The results asked for."""
    trust: Sequence[str]
    """Unfinished work, accuracy and proved completeness."""
    statuses: TextTable
    """Number of points and meaning of every status."""
    details: Sequence[str]
    """Further results."""
    axes: TextTable
    """Ranges of the parameters."""
    origin: Sequence[str]
    """Computing time, ranks, dates and versions."""
    numbers: TextTable | None = None
    """Table below the answer."""


def varied(view: View) -> dict[str, np.ndarray]:
    """Parameters that differ among the points of a file, at every point, each (points,)."""
    return {name: column for name, column in view.point_columns.items() if len(np.unique(column)) > 1}


def region(view: View, mask: np.ndarray) -> str:
    """Ranges of the varied parameters over points, a mask of their shape; empty for a single rod."""
    ranges = []
    for name, column in varied(view).items():
        values = column[mask.ravel()]
        is_finite = np.isfinite(values)
        ends = [span(values)] if is_finite.any() else []
        ranges.append(f"{name} = {' and '.join([*ends, *(['inf'] if not is_finite.all() else [])])}")
    return ", ".join(ranges)


def at_point(view: View, index: int) -> str:
    """Varied parameters at a point of the file, by its index."""
    return ", ".join(f"{name} = {column[index]:.6g}" for name, column in varied(view).items())


def first_lines(lines: Sequence[str], noun: str) -> Iterator[str]:
    """Yields the first of the lines about a thing each, indented, and the number of further things."""
    yield from (f"  {line}" for line in lines[:NAMED_THINGS])
    if len(lines) > NAMED_THINGS:
        yield f"  and {counted(len(lines) - NAMED_THINGS, noun)} more"


def in_brackets(text: str) -> str:
    """A text in brackets, to follow another text; an empty text stays empty."""
    return f" ({text})" if text else ""


def completeness(view: View) -> str:
    """How far the list of crossings in a file is known to be complete."""
    return "is proved complete" if has_covering(view.config) else "is confirmed by counts of unstable modes"
