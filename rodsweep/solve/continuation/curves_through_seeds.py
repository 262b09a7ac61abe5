"""Search for all curves through given points (seed points) on rows of a parameter plane, lines along which
one parameter varies; each curve is traced only once.

The search does not depend on the kind of the curves or on the process that traces a curve. If the result of a
work item (a part of a curve) is missing, the search stops and names this item. The caller then repeats the
search with more results.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

AnyCurve = TypeVar("AnyCurve")


class CurveTracingProblem(Protocol[AnyCurve]):
    """Interface of `trace_all_curves` to the curves through seed points. A seed point is identified by its
    index."""

    def next_seed(self, untraced: Sequence[int]) -> int:
        """Index of the seed point from which the next curve is traced, one of the indices `untraced`."""

    def missing_work_items(self, seed: int) -> list[int]:
        """Numbers of the work items (parts of a curve) whose results are missing for the curve through the
        seed point `seed`."""

    def curve(self, seed: int) -> AnyCurve | None:
        """The curve through the seed point `seed`; None if this curve cannot be traced."""

    def distance_along_row(self, curve: AnyCurve, seed: int) -> float:
        """Distance between the seed point `seed` and a curve along the row of the parameter plane through
        this point, as a fraction of the length of a row; inf if no point of the curve is near."""

    def are_identical(self, first: AnyCurve, second: AnyCurve) -> bool:
        """Whether the curves `first` and `second` are identical."""


@dataclass(frozen=True, slots=True)
class TracedCurves(Generic[AnyCurve]):
    """All curves through the seed points of a plane. max_seed_distance_per_row_length: largest distance of a
    seed point from its curve, along its row of the plane, divided by the length of a row; 0 if no seed point
    lies on a curve. untraced_seed_count: number of seed points that lie on no traced curve."""

    curves: tuple[AnyCurve, ...]
    max_seed_distance_per_row_length: float
    untraced_seed_count: int


@dataclass(slots=True)
class CurveTracingState(Generic[AnyCurve]):
    """State of the search for curves through seed points. Distances are along a row of the plane, as
    fractions of its length.

    seed_distance_tolerance: a seed point lies on a curve if its distance is at most this number.
    seed_distances_along_row: distance of each seed point from the nearest curve so far, by index. curves:
    curves traced so far, each only once. missing_items: numbers of the work items whose missing results
    stopped the search. untried_seeds: indices of the seed points that lie on no curve so far and were not
    tried, without the seed point at which the search stopped.
    """

    seed_distance_tolerance: float
    seed_distances_along_row: dict[int, float]
    curves: list[AnyCurve] = field(default_factory=list)
    missing_items: list[int] = field(default_factory=list)
    untried_seeds: list[int] = field(default_factory=list)

    @property
    def traced_curves(self) -> TracedCurves[AnyCurve]:
        """All curves, with the largest distance of a seed point from its curve and the number of untraced
        seed points; valid if `missing_items` is empty."""
        # Distances beyond the tolerance belong to seeds on no curve.
        seed_distances = [
            distance
            for distance in self.seed_distances_along_row.values()
            if distance <= self.seed_distance_tolerance
        ]
        return TracedCurves(
            tuple(self.curves),
            max(seed_distances, default=0.0),
            len(self.seed_distances_along_row) - len(seed_distances),
        )


def trace_all_curves(
    problem: CurveTracingProblem[AnyCurve], seeds: Iterable[int], tolerance: float
) -> CurveTracingState[AnyCurve]:
    """State of a search after curves were traced until every seed point lies on a curve or was tried, or
    until the result of a work item is missing. seeds: indices of the seed points. tolerance: a seed point
    lies on a curve if its distance, divided by the length of a row, is at most this number."""
    search: CurveTracingState[AnyCurve] = CurveTracingState(tolerance, dict.fromkeys(seeds, math.inf))
    tried_seeds: set[int] = set()
    while untraced := [
        i
        for i, distance in search.seed_distances_along_row.items()
        if distance > tolerance and i not in tried_seeds
    ]:
        seed = problem.next_seed(untraced)
        search.missing_items = problem.missing_work_items(seed)
        if search.missing_items:
            # Idle processes may trace curves from these seeds meanwhile. Some seeds may lie on the missing
            # curve.
            search.untried_seeds = [i for i in untraced if i != seed]
            break
        # A seed whose own curve misses it would otherwise be chosen forever.
        tried_seeds.add(seed)
        curve = problem.curve(seed)
        if curve is None:
            continue
        for i, distance in search.seed_distances_along_row.items():
            if distance > tolerance:
                search.seed_distances_along_row[i] = min(distance, problem.distance_along_row(curve, i))
        # A seed just beyond the tolerance leads to a curve that is known already.
        if not any(problem.are_identical(curve, other) for other in search.curves):
            search.curves.append(curve)
    return search
