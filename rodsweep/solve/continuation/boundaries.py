"""The curves through points that rows of a plane have: each is traced once, every point then found on one.

Knows nothing of what the curves are, nor who traces them: where the result of a unit of work is lacking, the
search says so and is run again when there are more.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

Curve = TypeVar("Curve")


class BoundaryProblem(Protocol[Curve]):
    """What the curves through numbered points of rows must know of themselves."""

    def next_seed(self, left: Sequence[int]) -> int:
        """Index of the point, among points on no curve, from which the next curve starts."""

    def lacking(self, seed: int) -> list[int]:
        """Units of work without whose results the curve from a point is not known."""

    def curve(self, seed: int) -> Curve | None:
        """The curve from a point; None where it cannot be followed."""

    def distance(self, curve: Curve, seed: int) -> float:
        """How far a point lies from a curve, in units of the rows' length."""

    def same(self, one: Curve, other: Curve) -> bool:
        """Whether two curves are one."""


@dataclass(frozen=True, slots=True)
class Boundaries(Generic[Curve]):
    """All curves of a plane; how far the points of rows lie from them, in units of the rows' length.

    untraced: points through which no curve could be followed.
    """

    curves: tuple[Curve, ...]
    agreement: float
    untraced: int


@dataclass(slots=True)
class BoundarySearch(Generic[Curve]):
    """The curves through some points, as far as they are known.

    agree: distance from a curve within which a point lies on it. distances: of each point from the nearest
    curve. needed: units of work without which the search cannot go on; left: the points on no curve then.
    """

    agree: float
    distances: dict[int, float]
    curves: list[Curve] = field(default_factory=list)
    needed: list[int] = field(default_factory=list)
    left: list[int] = field(default_factory=list)

    @property
    def boundaries(self) -> Boundaries[Curve]:
        """The curves, once nothing is needed."""
        found = [distance for distance in self.distances.values() if distance <= self.agree]
        return Boundaries(tuple(self.curves), max(found, default=0.0), len(self.distances) - len(found))


def boundary_search(
    problem: BoundaryProblem[Curve], seeds: Iterable[int], agree: float
) -> BoundarySearch[Curve]:
    """Traces curves until every point lies on one or was tried, or a result is lacking."""
    search: BoundarySearch[Curve] = BoundarySearch(agree, dict.fromkeys(seeds, math.inf))
    tried: set[int] = set()
    while left := [i for i, off in search.distances.items() if off > agree and i not in tried]:
        seed = problem.next_seed(left)
        search.needed = problem.lacking(seed)
        if search.needed:
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
