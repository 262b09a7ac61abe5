"""Lines and tables of the summary of a result file."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.rod_properties import has_uniform_linear_rods
from ...wording import counted
from .number_texts import number_and_error_texts
from .selection import varied_parameters_at_points

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
    numbers_table: TextTable | None = None
    """Table of numbers below the answer."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary(SummaryLines):
    """All lines and tables that `rodsweep show` prints about a file: the summary of the task's result, with
    lines about unfinished points, and the parts that are printed for every task."""

    statuses: TextTable
    """Number of points with each status, and the meaning of the status."""
    material: Sequence[str]
    """Lines about law, profile and segments of the arms; empty for uniform arms of linear material."""
    axes_table: TextTable
    """Values or ranges of the parameters."""
    cost_and_provenance_lines: Sequence[str]
    """Lines about computing time, MPI ranks, dates and versions."""


def number_table(*columns: tuple[str, Iterable[Any], np.ndarray | None]) -> TextTable | None:
    """Table of numbers, with their errors in columns of their own; None without rows.

    columns: (heading, numbers, absolute errors of the numbers, (rows,)), or (heading, texts, None).
    """
    headings = list[str]()
    cells = list[Sequence[str]]()
    for heading, values, errors in columns:
        headings.append(heading)
        if errors is None:
            cells.append(list(values))
            continue
        headings.append("+-")
        cells += zip(*map(number_and_error_texts, map(float, values), map(float, errors)), strict=True)
    rows = tuple(zip(*cells, strict=True))
    return TextTable(tuple(headings), rows) if rows else None


def point_text(view: ResultView, index: int) -> str:
    """Varied parameters at the point with the given index, as text."""
    columns = varied_parameters_at_points(view)
    return ", ".join(f"{name} = {column[index]:.6g}" for name, column in columns.items())


def truncated_lines(lines: Sequence[str], noun: str) -> Iterator[str]:
    """Yields the first MAX_LISTED_ITEMS of `lines`, indented, and a line with the number of further lines.
    noun: noun for the subject of a line."""
    yield from (f"  {line}" for line in lines[:MAX_LISTED_ITEMS])
    if len(lines) > MAX_LISTED_ITEMS:
        yield f"  and {counted(len(lines) - MAX_LISTED_ITEMS, noun)} more"


def completeness_predicate(view: ResultView) -> str:
    """Predicate for the list of crossings of a result: "is proved complete" if all its rods are uniform and
    of linear material, else "is confirmed by counts of unstable modes"."""
    is_proved = has_uniform_linear_rods(view.config)
    return "is proved complete" if is_proved else "is confirmed by counts of unstable modes"
