"""Where the straight rod changes along a line of points of a file: located, or between two points.

The task has located the changes and stored them. Nothing is solved here, and nothing is interpolated: a
change that no solver has located lies between two points, and no more is said.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, nan

import numpy as np
from numpy.typing import NDArray

from ..model.parameters import all_but
from ..results.file.view import View
from ..results.layouts.limit_cycle import HOPF_ALONG
from ..results.layouts.thresholds import CROSSING_KINDS
from ..sweep.points.lines import ParameterLine

SAME_PLACE = 1e-9
"""Relative distance below which a point of a file lies on a Hopf point: the growth rate there is rounding."""
STABILITY_CHANGES = {("hopf", 2), ("restabilization", 0)}
"""Kinds of Hopf points at which the straight rod changes its stability, with the number of modes that grow
beyond; at all others further modes join those that grow, or leave them."""


@dataclass(frozen=True, slots=True)
class Located:
    """A change at a place along a parameter, with an estimate of its error, in its unit.

    kind: `hopf` where a pair crosses the imaginary axis and the rod is unstable above, `restabilization`
    where it is stable above; `onset` where two real eigenvalues become a pair and the rod stays stable.
    """

    position: float
    error: float
    kind: str
    frequency: float = nan
    """Of the modes that cross, in 1/tau2; nan where it is not known, and of an onset."""

    @property
    def is_hopf(self) -> bool:
        """Whether the straight rod changes its stability there."""
        return self.kind != "onset"

    def agrees(self, other: "Located") -> bool:
        """Whether the two may be one: of a kind, and within their errors."""
        return self.kind == other.kind and abs(self.position - other.position) <= self.error + other.error


@dataclass(frozen=True, slots=True)
class Bracket:
    """Two neighbouring points of a line between which the straight rod changes its stability, somewhere."""

    low: float
    high: float
    kind: str
    """`hopf` or `restabilization`."""


def place_of(change: Located | Bracket) -> float:
    """By which changes along a line are ordered."""
    return change.position if isinstance(change, Located) else change.low


class StoredChanges:
    """The changes of the straight rod that a file holds of its lines over a parameter.

    Of spectra and modes these are changes over F, with onsets of oscillation; of limit cycles Hopf points
    along any parameter. Both lie between the points of lines.
    """

    def __init__(self, view: View, name: str):
        v, points = view.variables, view.variables["status"].size
        growth = "linear_growth_rate" if "linear_growth_rate" in v else "growth_rate"
        self.growth = v[growth].reshape(points, -1)[:, 0]
        self.others = all_but(name)
        self.by_rod: dict[tuple[float, ...], list[Located]] = {}
        if "hopf_along" in v:  # which a user may have dropped from a Dataset
            self._read(v, name, "hopf", v["hopf_along"] == HOPF_ALONG.index(name))
        if "change_kind" in v and name == "F":
            self._read(v, name, "change", np.ones(len(v["change_kind"]), bool))

    def _read(self, v: Mapping[str, np.ndarray], name: str, prefix: str, along: NDArray[np.bool_]) -> None:
        """Reads what stands `along` the parameter, of variables with a prefix."""
        rods = np.stack([v[f"{prefix}_{other}"] for other in self.others], axis=-1)
        at, error, frequency, kind = (
            v[f"{prefix}_{field}"] for field in (name, "error", "frequency", "kind")
        )
        after = v["hopf_unstable_after"] if prefix == "hopf" else None
        for i in np.flatnonzero(along):
            place, word = float(at[i]), CROSSING_KINDS[int(kind[i])]
            if word == "onset":
                point = Located(place, float(error[i]) * (abs(place) or 1.0), word)
            elif after is None or (word, int(after[i])) in STABILITY_CHANGES:
                point = Located(place, float(error[i]) * (abs(place) or 1.0), word, float(frequency[i]))
            else:
                continue
            self.by_rod.setdefault(tuple(rods[i].tolist()), []).append(point)

    def up_to(self, line: ParameterLine) -> list[Located | Bracket]:
        """The changes on a line and at smaller values, as far as these were searched."""
        return sorted({*self.on(line), *self._stored(line, -inf)}, key=place_of)

    def _stored(self, line: ParameterLine, low: float) -> list[Located]:
        """The stored changes from a value up to the last of a line."""
        rod = tuple(line.parameters[other] for other in self.others)
        high = line.x.max(initial=-inf)
        return [point for point in self.by_rod.get(rod, []) if _within(point, low, high)]

    def on(self, line: ParameterLine) -> list[Located | Bracket]:
        """The changes on a line in increasing order.

        Where the stored growth rates of two neighbours differ in sign and no stored change between them
        explains it, as where a search failed, the change is only known to lie between the two.
        """
        if not len(line.x):
            return []
        stored = self._stored(line, line.x.min())
        found: list[Located | Bracket] = [*stored]
        changes = [point for point in stored if point.is_hopf]
        known = np.flatnonzero(np.isfinite(self.growth[line.at]))
        ordered = known[np.argsort(line.x[known], kind="stable")]
        x, grows = line.x[ordered], self.growth[line.at[ordered]] > 0
        for i in np.flatnonzero(grows[1:] != grows[:-1]):
            low, high = float(x[i]), float(x[i + 1])
            if sum(_within(point, low, high) for point in changes) % 2 == 0:
                found.append(Bracket(low, high, "hopf" if grows[i + 1] else "restabilization"))
        return sorted(found, key=place_of)


def _within(point: Located, low: float, high: float) -> bool:
    """Whether a change lies between two values, or on one of them within rounding."""
    margin = max(point.error, SAME_PLACE * abs(point.position))
    return bool(low - margin <= point.position <= high + margin)
