"""Where the straight rod starts to beat, F**, from the growth rates that a file of limit cycles holds.

A Hopf point lies wherever the leading growth rate changes sign from a point to the next: D(0) = 1, so no
eigenvalue passes through 0 and those that reach the imaginary axis are a pair. Nothing is solved here.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import floor, log10, nan

import numpy as np

from ..arrays import Array
from ..results.file.view import View

NODES = 4
"""Growth rates through which a polynomial is laid."""
HALVINGS = 60
"""Of the bracket around a zero: as many as a number has digits."""
MOST_DIGITS = 9
"""Digits to which a Hopf point is ever given."""


@dataclass(frozen=True, slots=True)
class Located:
    """A place along a parameter with an estimate of its error, in its unit."""

    position: float
    error: float

    @property
    def kind(self) -> str:
        """What is there."""
        raise NotImplementedError

    def agrees(self, other: "Located") -> bool:
        """Whether the two may be one: of a kind, and within their errors."""
        return self.kind == other.kind and abs(self.position - other.position) <= self.error + other.error

    @property
    def text(self) -> str:
        """The position to the last decimal that is larger than the error."""
        return f"{self.position:.{max(0, floor(-log10(self.error)))}f}"


@dataclass(frozen=True, slots=True)
class OscillationOnset(Located):
    """Where the two leading real eigenvalues become a pair: above it the rod oscillates, and decays yet."""

    @property
    def kind(self) -> str:
        return "onset"


@dataclass(frozen=True, slots=True)
class HopfPoint(Located):
    """A zero of the leading growth rate."""

    destabilises: bool
    """Whether the rod is unstable above it; below it otherwise, and above it stable again."""
    frequency: float = nan
    """Of the modes that cross, in 1/tau2; nan where it is not known."""

    @property
    def kind(self) -> str:
        return "hopf" if self.destabilises else "restabilization"


def hopf_points(x: Array, growth: Array, frequency: Array) -> list[HopfPoint]:
    """The zeros of the growth rate along a parameter, in increasing order; all arrays have the shape (n,).

    Each is the zero of the cubic through the growth rates of the bracketing points and the next two where the
    leading root oscillates. Its error falls like h^4 for points h apart: F** = 27.43 of the paper's rod is
    found to 5e-6 from forces in steps of 1, to 4e-3 in steps of 5. It is estimated, some ten times too large,
    by what leaving one of them out changes. Where an end of the bracket does not oscillate, its growth rate
    is another root's: then the zero of the chord is given, and the whole bracket as its error.
    """
    x, first = np.unique(x, return_index=True)
    growth, frequency = growth[first], frequency[first]
    known = np.isfinite(x) & np.isfinite(growth)
    x, growth, frequency = x[known], growth[known], frequency[known]
    return [_between(x, growth, frequency > 0, int(i)) for i in np.flatnonzero(np.diff(growth > 0))]


def _between(x: Array, growth: Array, oscillates: np.ndarray, i: int) -> HopfPoint:
    """The Hopf point between the points i and i + 1."""
    destabilises = bool(growth[i + 1] > 0)
    ends = slice(i, i + 2)
    chord = _zero(x[ends], growth[ends], (x[i], x[i + 1]))
    if not oscillates[ends].all():
        return HopfPoint(chord, float(x[i + 1] - x[i]), destabilises)
    low, high = i, i + 1
    while low > max(0, i - 2) and oscillates[low - 1]:
        low -= 1
    while high < min(len(x) - 1, i + 3) and oscillates[high + 1]:
        high += 1
    others = [k for k in range(low, high + 1) if k not in (i, i + 1)]
    nearest = sorted(others, key=lambda k: abs(x[k] - chord))[: NODES - 2]
    sets = [sorted((i, i + 1, *nearest[:count])) for count in range(len(nearest) + 1)]
    zeros = [_zero(x[nodes], growth[nodes], (x[i], x[i + 1])) for nodes in sets]
    error = abs(zeros[-1] - zeros[-2]) if nearest else float(x[i + 1] - x[i]) / 2
    # Growth rates are not known to the last digit, and two neighbours may agree by chance.
    known = 10.0**-MOST_DIGITS * max(abs(zeros[-1]), float(x[i + 1] - x[i]))
    return HopfPoint(zeros[-1], max(error, known), destabilises)


def _zero(x: Array, growth: Array, bracket: Sequence[float]) -> float:
    """A zero in the bracket, whose ends are nodes, of the polynomial through the nodes, shape (n,)."""
    low, high = map(float, bracket)
    differences = growth.astype(float)
    for order in range(1, len(x)):  # Newton's divided differences
        differences[order:] = (differences[order:] - differences[order - 1 : -1]) / (x[order:] - x[:-order])

    def positive(at: float) -> bool:
        value = 0.0
        for node, difference in zip(x[::-1], differences[::-1], strict=True):
            value = value * (at - node) + difference
        return bool(value > 0)

    end = float(growth[x == high][0]) > 0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if positive(middle) == end else (middle, high)
    return (low + high) / 2


@dataclass(frozen=True, slots=True)
class ParameterLine:
    """The points of a file that differ in one parameter only, in the order of the file."""

    parameters: dict[str, float]
    """The other ones, by name."""
    x: Array
    """The values of the one, shape (n,)."""
    at: np.ndarray
    """The indices of the points, shape (n,)."""

    def hopf_points(self, view: View) -> list[HopfPoint]:
        """The Hopf points along the line in the file from which it is."""
        names = ("linear_growth_rate", "linear_frequency")
        growth, frequency = (view.variables[name].ravel()[self.at] for name in names)
        return hopf_points(self.x, growth, frequency)


def lines_over(view: View, name: str) -> Iterator[ParameterLine]:
    """The lines over a parameter in the order of their first points, without points where it is inf."""
    columns = view.point_columns
    x = columns.pop(name)
    table = np.stack(list(columns.values()), axis=-1)
    _, first, line = np.unique(table, axis=0, return_index=True, return_inverse=True)
    by_line = np.argsort(line.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(line.ravel()))
    for number in np.argsort(first):
        at = by_line[ends[number - 1] if number else 0 : ends[number]]
        at = at[np.isfinite(x[at])]
        yield ParameterLine(dict(zip(columns, table[first[number]].tolist(), strict=True)), x[at], at)
