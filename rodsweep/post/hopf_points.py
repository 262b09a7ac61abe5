"""Where the straight rod changes along a line of points of a file: located, or between two points.

Of limit cycles the file holds the Hopf points of its lines, found by the task. Nothing is solved here, and
nothing is interpolated: a change that no solver has located lies between two points, and no more is said.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import inf, nan

import numpy as np

from ..arrays import Array
from ..model.parameters import LINEAR_PARAMETERS
from ..results.file.view import View
from ..results.layouts.limit_cycle import HOPF_ALONG
from ..results.layouts.thresholds import CROSSING_KINDS

SAME_PLACE = 1e-9
"""Relative distance below which a point of a file lies on a Hopf point: the growth rate there is rounding."""
STABILITY_CHANGES = {("hopf", 2): True, ("restabilization", 0): False}
"""Whether the straight rod is unstable beyond a Hopf point, by its kind and the number of modes that grow
there; at all others further modes join those that grow, or leave them."""
HOPF_FIELDS = ("along", "kind", "error", "frequency", "unstable_after", *LINEAR_PARAMETERS)


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


@dataclass(frozen=True, slots=True)
class OscillationOnset(Located):
    """Where the two leading real eigenvalues become a pair: above it the rod oscillates, and decays yet."""

    @property
    def kind(self) -> str:
        return "onset"


@dataclass(frozen=True, slots=True)
class HopfPoint(Located):
    """A place where a pair crosses the imaginary axis, and the straight rod changes its stability."""

    destabilises: bool
    """Whether the rod is unstable above it; below it otherwise, and above it stable again."""
    frequency: float = nan
    """Of the modes that cross, in 1/tau2; nan where it is not known."""

    @property
    def kind(self) -> str:
        return kind_of_change(self.destabilises)


@dataclass(frozen=True, slots=True)
class Bracket:
    """Two neighbouring points of a line between which the straight rod changes its stability, somewhere."""

    low: float
    high: float
    destabilises: bool

    @property
    def kind(self) -> str:
        return kind_of_change(self.destabilises)


Change = HopfPoint | Bracket
"""A change of stability of the straight rod along a line, in the direction in which the parameter grows."""


def kind_of_change(destabilises: bool) -> str:
    """What a change of stability is called."""
    return "hopf" if destabilises else "restabilization"


def place_of(change: Located | Bracket) -> float:
    """By which changes along a line are ordered."""
    return change.position if isinstance(change, Located) else change.low


@dataclass(frozen=True, slots=True)
class ParameterLine:
    """The points of a file that differ in one parameter only, in the order of the file."""

    name: str
    """The parameter."""
    parameters: dict[str, float]
    """The other ones, by name."""
    x: Array
    """The values of the one, shape (n,)."""
    at: np.ndarray
    """The indices of the points, shape (n,)."""


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
        others = dict(zip(columns, table[first[number]].tolist(), strict=True))
        yield ParameterLine(name, others, x[at], at)


class StoredHopfPoints:
    """The changes of stability that a file of limit cycles holds of its lines over a parameter."""

    def __init__(self, view: View, name: str):
        self.growth = view.variables["linear_growth_rate"].ravel()
        self.others = [other for other in LINEAR_PARAMETERS if other != name]
        self.by_rod: dict[tuple[float, ...], list[HopfPoint]] = {}
        if "hopf_along" in view.variables:  # which a user may have dropped from a Dataset
            self._read(view, name)

    def _read(self, view: View, name: str) -> None:
        v = {field: view.variables[f"hopf_{field}"] for field in HOPF_FIELDS}
        rods = np.stack([v[other] for other in self.others], axis=-1)
        for i in np.flatnonzero(v["along"] == HOPF_ALONG.index(name)):
            change = STABILITY_CHANGES.get((CROSSING_KINDS[int(v["kind"][i])], int(v["unstable_after"][i])))
            if change is not None:
                at = float(v[name][i])
                point = HopfPoint(at, float(v["error"][i]) * abs(at), change, float(v["frequency"][i]))
                self.by_rod.setdefault(tuple(rods[i].tolist()), []).append(point)

    def up_to(self, line: ParameterLine) -> list[Change]:
        """The changes of stability on a line and at smaller values, as far as these were searched."""
        return sorted({*self.on(line), *self._stored(line, -inf)}, key=place_of)

    def _stored(self, line: ParameterLine, low: float) -> list[HopfPoint]:
        """The stored changes from a value up to the last of a line."""
        rod = tuple(line.parameters[other] for other in self.others)
        high = line.x.max(initial=-inf)
        return [point for point in self.by_rod.get(rod, []) if _within(point, low, high)]

    def on(self, line: ParameterLine) -> list[Change]:
        """The changes of stability on a line in increasing order.

        Where the stored growth rates of two neighbours differ in sign and no Hopf point between them explains
        it, as where a search failed, the change is only known to lie between the two.
        """
        if not len(line.x):
            return []
        stored = self._stored(line, line.x.min())
        found: list[Change] = [*stored]
        known = np.flatnonzero(np.isfinite(self.growth[line.at]))
        ordered = known[np.argsort(line.x[known], kind="stable")]
        for i, j in pairwise(ordered):
            low, high = float(line.x[i]), float(line.x[j])
            before, after = self.growth[line.at[[i, j]]] > 0
            if before != after and sum(_within(point, low, high) for point in stored) % 2 == 0:
                found.append(Bracket(low, high, bool(after)))
        return sorted(found, key=place_of)


def _within(point: HopfPoint, low: float, high: float) -> bool:
    """Whether a Hopf point lies between two values, or on one of them within rounding."""
    margin = max(point.error, SAME_PLACE * abs(point.position))
    return bool(low - margin <= point.position <= high + margin)
