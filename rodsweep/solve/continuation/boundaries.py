"""Curves through the points of a plane's rows: each curve is traced once, and every point is then found on a
curve.

Knows neither the kind of the curves nor who traces them. If the result of a unit of work is lacking, the
search reports the unit, and is run again with more results.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

Curve = TypeVar("Curve")


class BoundaryProblem(Protocol[Curve]):
    """Interface to the curves through numbered points of rows, used by the search."""

    def next_seed(self, left: Sequence[int]) -> int:
        """Index of the point, among the points on no curve, from which the next curve starts."""

    def missing_units(self, seed: int) -> list[int]:
        """Units of work with results still needed for the curve from a point."""

    def curve(self, seed: int) -> Curve | None:
        """The curve from a point; None if not found."""

    def distance(self, curve: Curve, seed: int) -> float:
        """Distance of a point from a curve, in units of the rows' length."""

    def same(self, one: Curve, other: Curve) -> bool:
        """Whether two curves are identical."""


@dataclass(frozen=True, slots=True)
class Boundaries(Generic[Curve]):
    """All curves of a plane. agreement: largest distance of a point from its curve, in units of the rows'
    length.

    untraced: number of points through which no curve could be followed.
    """

    curves: tuple[Curve, ...]
    agreement: float
    untraced: int


@dataclass(slots=True)
class BoundarySearch(Generic[Curve]):
    """The curves through numbered points, as far as known.

    agree: distance within which a point lies on a curve. distances: distance of each point from the nearest
    curve. needed: units of work with results that the search lacks. left: further points that lie on no curve
    so far.
    """

    agree: float
    distances: dict[int, float]
    curves: list[Curve] = field(default_factory=list)
    needed: list[int] = field(default_factory=list)
    left: list[int] = field(default_factory=list)

    @property
    def boundaries(self) -> Boundaries[Curve]:
        """The curves, once no unit is needed."""
        found = [distance for distance in self.distances.values() if distance <= self.agree]
        return Boundaries(tuple(self.curves), max(found, default=0.0), len(self.distances) - len(found))


def boundary_search(
    problem: BoundaryProblem[Curve], seeds: Iterable[int], agree: float
) -> BoundarySearch[Curve]:
    """Traces curves until every point lies on a curve or was tried, or until a result is lacking."""
    search: BoundarySearch[Curve] = BoundarySearch(agree, dict.fromkeys(seeds, math.inf))
    tried: set[int] = set()
    while left := [i for i, off in search.distances.items() if off > agree and i not in tried]:
        seed = problem.next_seed(left)
        search.needed = problem.missing_units(seed)
        if search.needed:
            # Other units may run meanwhile: points that this curve may turn out to contain, too.
            search.left = [i for i in left if i != seed]
            break
        tried.add(seed)
        curve = problem.curve(seed)
        if curve is None:
            continue
        for i, off in search.distances.items():
            if off > agree:
                search.distances[i] = min(off, problem.distance(curve, i))
        if not any(problem.same(curve, other) for other in search.curves):
            search.curves.append(curve)
    return search
