"""Lines of points of a sweep: on each line only one parameter varies."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ...arrays import Array


@dataclass(frozen=True, slots=True)
class ParameterLine:
    """Points that differ in one parameter only, in the order of the sweep."""

    name: str
    """The parameter that varies."""
    parameters: dict[str, float]
    """Values of the fixed parameters, by name."""
    x: Array
    """Values of the varying parameter, shape (n,)."""
    at: np.ndarray
    """Flat indices of the points, shape (n,)."""


def lines_over(columns: Mapping[str, Array], name: str) -> Iterator[ParameterLine]:
    """Lines over a parameter in the order of their first points, without points where the parameter is inf.

    columns: every parameter at every point, (points,).
    """
    x = columns[name]
    others = [other for other in columns if other != name]
    table = np.stack([columns[other] for other in others], axis=-1)
    _, first, line = np.unique(table, axis=0, return_index=True, return_inverse=True)
    by_line = np.argsort(line.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(line.ravel()))
    for number in np.argsort(first):
        at = by_line[ends[number - 1] if number else 0 : ends[number]]
        at = at[np.isfinite(x[at])]
        fixed = dict(zip(others, table[first[number]].tolist(), strict=True))
        yield ParameterLine(name, fixed, x[at], at)
