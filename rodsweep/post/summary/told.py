"""What a task's module tells of its results, in the order in which `rodsweep show` prints it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...results.file.view import View
from .ranges import span


@dataclass(frozen=True, slots=True)
class Told:
    """Sentences of one result.

    answer: what was asked for, in words; trust: how far that is accurate, complete and proved; details: all
    else that the file says of it; of_arm: of the answer of an arm what is told in its own units.
    """

    answer: Sequence[str]
    trust: Sequence[str] = ()
    details: Sequence[str] = ()
    of_arm: Sequence[str] = ()


def varied(view: View) -> dict[str, np.ndarray]:
    """The parameters that differ among the points of a file, at every point, each (points,)."""
    return {name: column for name, column in view.point_columns.items() if len(np.unique(column)) > 1}


def region(view: View, there: np.ndarray) -> str:
    """The ranges of the varied parameters over some points, a mask of their shape; empty for a single rod."""
    columns, chosen = varied(view), there.ravel()
    return ", ".join(f"{name} = {_extent(column[chosen])}" for name, column in columns.items())


def _extent(values: np.ndarray) -> str:
    """The range of values of a parameter, which may be inf."""
    if np.isfinite(values).all():
        return span(values)
    return " and ".join(filter(None, (span(values) if np.isfinite(values).any() else "", "inf")))


def at_point(view: View, index: int) -> str:
    """The varied parameters at a point of the file, by its place among all."""
    return ", ".join(f"{name} = {column[index]:.6g}" for name, column in varied(view).items())


def in_brackets(text: str) -> str:
    """A text in brackets behind another; nothing where it is empty."""
    return f" ({text})" if text else ""
