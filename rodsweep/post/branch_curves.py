"""Branches of cycles of a rod in a result file of the task `branch`, and ranges of the parameter in which the
cycles and the straight rod are stable."""

from collections.abc import Iterator
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from ..model.parameters import PARAMETERS
from ..results.file.view import ResultView
from ..results.layouts.branch import SPECIAL_KINDS
from .range_unions import ParameterRange, intersection_of_ranges, union_of_ranges
from .stored_branches import stored_branch

HOPF = SPECIAL_KINDS.index("hopf")
"""Code of a Hopf point in a result file."""


def followed_parameter(view: ResultView) -> str:
    """Name of the parameter along which the branches in a result file are followed."""
    return next(name for name in PARAMETERS if f"branch_{name}" in view.variables)


def followed_range(view: ResultView) -> ParameterRange:
    """(start, stop) of the range in which the branches in a result file are followed."""
    options = view.config["branch"]
    return float(options["start"]), float(options["stop"])


class RodBranches:
    """Branches of cycles of one rod, and ranges of the parameter in which states of the rod are stable. rod:
    index among the points of the file. curves: branches whose special points are all stored. hidden_count:
    number of the remaining branches."""

    def __init__(self, view: ResultView, rod: int = 0):
        self.view = view
        self.index = rod
        self._v = view.point_values(rod)
        count = max(int(self._v["branch_count"]), 0)
        numbers = self._v["special_branch"][self._v["special_kind"] > 0]
        # If the list is full, special points of the last listed branch and of later branches may be missing.
        complete = count if len(numbers) >= self._v["special_count"] else int(numbers.max(initial=1)) - 1
        self.hidden_count = count - complete
        parameter = followed_parameter(view)
        self.curves = [stored_branch(self._v, parameter, number) for number in range(1, complete + 1)]

    @property
    def special_point_parameter_errors(self) -> dict[float, float]:
        """Absolute error of the parameter at each special point of all branches, by parameter value."""
        return {
            value: error
            for curve in self.curves
            for value, error in curve.special_point_parameter_errors.items()
        }

    @property
    def stable_cycle_ranges(self) -> list[ParameterRange]:
        """Ranges of the parameter in which the rod has a stable cycle."""
        return union_of_ranges(stable_range for curve in self.curves for stable_range in curve.stable_ranges)

    @property
    def two_stable_cycle_ranges(self) -> list[ParameterRange]:
        """Ranges of the parameter in which stable cycles exist on two branches."""
        pairs = combinations([curve.stable_ranges for curve in self.curves], 2)
        return union_of_ranges(
            common for first, second in pairs for common in intersection_of_ranges(first, second)
        )

    @property
    def coexistence_ranges(self) -> list[ParameterRange]:
        """Ranges of the parameter in which a stable cycle exists and the straight rod is stable."""
        stable_straight, _ = self.straight_rod_stable_unstable_ranges(followed_range(self.view))
        return intersection_of_ranges(self.stable_cycle_ranges, stable_straight)

    @property
    def is_coexistence_known(self) -> bool:
        """Whether the stability of the straight rod at every parameter value, and of all listed cycles, is
        known."""
        counts = self._v["special_unstable_after"][self._v["special_kind"] == HOPF]
        straight = int(self._v["unstable_at_start"]) >= 0 and bool((counts >= 0).all())
        return straight and all(curve.is_fully_known for curve in self.curves)

    def straight_rod_stable_unstable_ranges(
        self, span: ParameterRange
    ) -> tuple[list[ParameterRange], list[ParameterRange]]:
        """Returns (stable, unstable): ranges of the parameter within `span` in which the straight rod is
        stable, or unstable. Both lists are empty if a branch is hidden, whose special points are not all
        stored."""
        intervals = [] if self.hidden_count else self.straight_rod_stability_intervals(span)
        stable, unstable = ([(a, b) for a, b, value in intervals if value == kind] for kind in (1, 0))
        return union_of_ranges(stable), union_of_ranges(unstable)

    def straight_rod_stability_intervals(self, span: ParameterRange) -> list[tuple[float, float, int]]:
        """Intervals (low, high, stability of the straight rod) between successive Hopf points. The intervals
        reach from `span[0]` to `span[1]`, or farther, to the last Hopf point, if this lies beyond `span[1]`.
        Stability: 1 stable, 0 unstable, -1 unknown."""
        stored = self._v
        is_hopf = stored["special_kind"] == HOPF
        values, indices = np.unique(stored["special_at"][is_hopf], return_index=True)
        after_counts = stored["special_unstable_after"][is_hopf][indices]
        edges = [span[0], *(float(a) for a in values), max(span[1], *values) if len(values) else span[1]]
        counts = [int(stored["unstable_at_start"]), *(int(count) for count in after_counts)]
        return [
            (low, high, -1 if count < 0 else int(count == 0))
            for (low, high), count in zip(pairwise(edges), counts, strict=True)
        ]


def runs_of_equal_stability(stable: NDArray[np.integer]) -> Iterator[tuple[slice, int]]:
    """Yields (vertices, stability) of each part of a curve of n points with equal stability. stable:
    stability of each chord between successive points, (n - 1,). vertices: slice of the points of the part,
    both ends included."""
    starts = [0, *(np.flatnonzero(np.diff(stable)) + 1), len(stable)]
    yield from ((slice(start, end + 1), int(stable[start])) for start, end in pairwise(starts) if end > start)
