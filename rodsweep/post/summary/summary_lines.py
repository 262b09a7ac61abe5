"""Lines and tables of the summary of a result file."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.rods import has_standard_rods
from ...wording import counted
from .number_texts import axis_values_text

MAX_LISTED_ITEMS = 8
"""Largest number of rods, branches or points that are listed one by one."""


@dataclass(frozen=True, slots=True)
class TextTable:
    """Table of texts. headings: one heading per column, of one or two lines. rows: one cell per column."""

    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class SummaryLines:
    """Summary of the result of a task, as lines and a table."""

    answer: Sequence[str]
    """Lines with the main results of the task."""
    reliability: Sequence[str] = ()
    """Lines about accuracy and proved completeness."""
    details: Sequence[str] = ()
    """Lines about further results."""
    arm_sentences: Sequence[str] = ()
    """Sentences of the answer in the units of an arm."""
    numbers: TextTable | None = None
    """Table of numbers below the answer."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary(SummaryLines):
    """All lines and tables that `rodsweep show` prints about a file: the summary of the task's result, with
    lines about unfinished points, and what is printed for every task."""

    statuses: TextTable
    """Number of points with each status, and the meaning of the status."""
    material: Sequence[str]
    """Lines about law, profile and segments of the arms; empty for uniform arms of linear material."""
    axes: TextTable
    """Values or ranges of the parameters."""
    provenance: Sequence[str]
    """Lines about computing time, MPI ranks, dates and versions."""


def varied_parameters_at_points(view: ResultView) -> dict[str, np.ndarray]:
    """Parameters that differ between points of a file, by name: values at all points, (points,)."""
    return {name: column for name, column in view.point_columns.items() if len(np.unique(column)) > 1}


def region_text(view: ResultView, mask: np.ndarray) -> str:
    """Ranges of the varied parameters over the points in `mask`, (...,), as text; empty if no parameter
    varies."""
    columns = varied_parameters_at_points(view)
    return ", ".join(f"{name} = {axis_values_text(column[mask.ravel()])}" for name, column in columns.items())


def point_text(view: ResultView, index: int) -> str:
    """Varied parameters at the point with the given index, as text."""
    columns = varied_parameters_at_points(view)
    return ", ".join(f"{name} = {column[index]:.6g}" for name, column in columns.items())


def first_lines(lines: Sequence[str], noun: str) -> Iterator[str]:
    """Yields the first MAX_LISTED_ITEMS of `lines`, indented, and a line with the number of further lines.
    noun: noun for the subject of a line."""
    yield from (f"  {line}" for line in lines[:MAX_LISTED_ITEMS])
    if len(lines) > MAX_LISTED_ITEMS:
        yield f"  and {counted(len(lines) - MAX_LISTED_ITEMS, noun)} more"


def in_brackets(text: str) -> str:
    """`text` in brackets, preceded by a space; an empty text if `text` is empty."""
    return f" ({text})" if text else ""


def proof_clause(view: ResultView) -> str:
    """Predicate for the list of crossings in a file: "is proved complete" for uniform rods of linear
    material, else "is confirmed by counts of unstable modes"."""
    is_proved = has_standard_rods(view.config)
    return "is proved complete" if is_proved else "is confirmed by counts of unstable modes"
