"""Branches of cycles in a result file of the task `branch`: curves, stability, and ranges of the parameter.

A branch is a curve through cycles and special points. Floquet multipliers cross the unit circle only at
special points. A cycle with a multiplier that lies on the circle within its error therefore has the stability
of the other cycles between the same two special points, if these cycles have equal stability.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from itertools import combinations, pairwise
from math import nan

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model.floquet import min_unstable_count
from ..model.parameters import PARAMETERS
from ..results.file.view import ResultView
from ..results.layouts.branch import END_REASONS, SPECIAL_KINDS
from .range_unions import ParameterRange, intersection_of_ranges, union_of_ranges

HOPF, FOLD, END = (SPECIAL_KINDS.index(kind) for kind in ("hopf", "fold", "end"))
"""Codes of the kinds of special points in a result file."""
EARLY_STOP_REASONS = ("no_cycle_found", "list_full")
"""Reasons for which the continuation of a branch stopped before the end of the branch."""


@dataclass(frozen=True, slots=True)
class StoredSpecialPoint:
    """Special point of a branch. Each field is the variable special_FIELD; `kind` and `reason` are words."""

    kind: str
    at: float
    error: float
    period: float
    tip_y_max: float
    reason: str
    unstable_after: int
    meets: int
    amplitude_coefficient: float = nan
    period_error: float = nan
    tip_y_max_error: float = nan


@dataclass(frozen=True, slots=True)
class StoredBranch:
    """Branch of cycles: a curve through n vertices, which are stored cycles and special points.

    parameter, y, period: followed parameter, largest y of the tip, and period at the vertices, (n,).
    Between two special points the parameter changes in one direction; a cycle beyond one of them, by less
    than twice its error, has the parameter of this point.
    """

    parameter: Array
    y: Array
    period: Array
    stable: NDArray[np.integer]
    """Stability between neighbouring vertices, (n - 1,): 1 stable, 0 unstable, -1 unknown."""
    cycles: NDArray[np.bool_]
    """Mask of the vertices that are stored cycles, (n,)."""
    special: tuple[StoredSpecialPoint, ...]
    """Special points of the branch, in order along the branch."""

    @property
    def enters_range(self) -> bool:
        """Whether the branch begins at an end of the range, to which it leads from beyond."""
        return self.special[0].kind == "end"

    @property
    def stable_ranges(self) -> list[ParameterRange]:
        """Ranges of the parameter in which the branch has a stable cycle."""
        pairs = [self.parameter[i : i + 2] for i in np.flatnonzero(self.stable == 1)]
        return union_of_ranges((min(pair), max(pair)) for pair in pairs)

    @property
    def parameter_errors(self) -> dict[float, float]:
        """Absolute error of the parameter at each special point, by parameter value."""
        return {float(special.at): special.error for special in self.special}

    @property
    def is_decided(self) -> bool:
        """Whether the branch was followed to its end and the stability of all cycles is known."""
        return self.special[-1].reason not in EARLY_STOP_REASONS and bool((self.stable >= 0).all())

    def scaled_curves_near_hopf_points(self) -> list[tuple[Array, Array, NDArray[np.integer]]]:
        """For each Hopf point at an end of the branch: (|at/at_H - 1|, y/|a|, stability) to the first fold.

        at_H, a: parameter and amplitude coefficient of the Hopf point. Hopf points with unknown or zero a are
        skipped, and the vertex of the Hopf point is left out. Shapes (n,), (n,) and (n - 1,), n > 1.
        """
        curves = []
        for special, order in ((self.special[0], slice(None)), (self.special[-1], slice(None, None, -1))):
            a = special.amplitude_coefficient
            y = self.y[order]
            if special.kind != "hopf" or y[0] != 0 or not np.isfinite(a) or a == 0:
                continue
            relative_distance = np.sign(a) * (self.parameter[order] / special.at - 1)
            turning_indices = np.flatnonzero(np.diff(relative_distance) <= 0)
            end = int(turning_indices[0]) + 1 if len(turning_indices) else len(relative_distance)
            if end > 2:
                curves.append((relative_distance[1:end], y[1:end] / abs(a), self.stable[order][1 : end - 1]))
        return curves


def followed_parameter(view: ResultView) -> str:
    """Name of the parameter along which the branches in a result file are followed."""
    return next(name for name in PARAMETERS if f"branch_{name}" in view.variables)


def branch_ends(view: ResultView) -> ParameterRange:
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
        self.curves = [_stored_branch(self._v, parameter, number) for number in range(1, complete + 1)]

    @property
    def parameter_errors(self) -> dict[float, float]:
        """Absolute error of the parameter at each special point of all branches, by parameter value."""
        return {value: error for curve in self.curves for value, error in curve.parameter_errors.items()}

    @property
    def stable_cycle_ranges(self) -> list[ParameterRange]:
        """Ranges of the parameter in which the rod has a stable cycle."""
        return union_of_ranges(stable_range for curve in self.curves for stable_range in curve.stable_ranges)

    @property
    def two_cycle_ranges(self) -> list[ParameterRange]:
        """Ranges of the parameter in which stable cycles exist on two branches."""
        pairs = combinations([curve.stable_ranges for curve in self.curves], 2)
        return union_of_ranges(
            common for first, second in pairs for common in intersection_of_ranges(first, second)
        )

    @property
    def coexistence_ranges(self) -> list[ParameterRange]:
        """Ranges of the parameter in which a stable cycle exists and the straight rod is stable."""
        stable_straight, _ = self.straight_ranges(branch_ends(self.view))
        return intersection_of_ranges(self.stable_cycle_ranges, stable_straight)

    @property
    def coexistence_is_decided(self) -> bool:
        """Whether the stability of all cycles and of the straight rod is known in the followed range."""
        counts = self._v["special_unstable_after"][self._v["special_kind"] == HOPF]
        straight = int(self._v["unstable_at_start"]) >= 0 and bool((counts >= 0).all())
        return straight and all(curve.is_decided for curve in self.curves)

    def straight_ranges(self, span: ParameterRange) -> tuple[list[ParameterRange], list[ParameterRange]]:
        """Returns (stable, unstable): ranges within `span` in which the straight rod is stable, or unstable.
        Both lists are empty if special points of some branch are not stored."""
        intervals = [] if self.hidden_count else self.straight_rod_intervals(span)
        stable, unstable = ([(a, b) for a, b, value in intervals if value == kind] for kind in (1, 0))
        return union_of_ranges(stable), union_of_ranges(unstable)

    def straight_rod_intervals(self, span: ParameterRange) -> list[tuple[float, float, int]]:
        """Intervals (low, high, stability of the straight rod: 1, 0, -1 if unknown) between Hopf points."""
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


def stability_runs(stable: NDArray[np.integer]) -> Iterator[tuple[slice, int]]:
    """Yields (vertices, stability) of each run of equal values in `stable`, (n - 1,). vertices: a slice."""
    starts = [0, *(np.flatnonzero(np.diff(stable)) + 1), len(stable)]
    yield from ((slice(start, end + 1), int(stable[start])) for start, end in pairwise(starts) if end > start)


def _stored_branch(v: dict[str, Array], parameter_name: str, number: int) -> StoredBranch:
    """Branch with the given number, from 1."""
    cycles = np.flatnonzero(v["branch"] == number)
    special = np.flatnonzero(v["special_branch"] == number)
    special_before = special[v["special_point"][special] == 0]
    order: list[tuple[bool, int]] = [(False, int(i)) for i in special_before]
    for index in cycles:
        order.append((True, int(index)))
        order += [(False, int(i)) for i in special[v["special_point"][special] == index + 1]]
    values = [
        (v[f"branch_{parameter_name}"][i], v["tip_y_max"][i], v["period"][i])
        if is_cycle
        else (v["special_at"][i], v["special_tip_y_max"][i], v["special_period"][i])
        for is_cycle, i in order
    ]
    x, y, period = np.array(values, dtype=float).reshape(-1, 3).T
    errors = np.array([v[f"branch_{parameter_name}_error"][i] if is_cycle else 0.0 for is_cycle, i in order])
    x = _within_special_points(x, errors * np.abs(x), np.array([not is_cycle for is_cycle, _ in order]))
    crossing = zip(v["unstable_multipliers"], v["multiplier"], v["multiplier_error"], strict=True)
    outside = [min_unstable_count(int(count), float(size), float(error)) for count, size, error in crossing]
    counts = [outside[i] if is_cycle else None for is_cycle, i in order]
    is_cycle = np.array([cycle for cycle, _ in order], dtype=bool)
    points = tuple(_special_point(v, int(i)) for i in special)
    return StoredBranch(x, y, period, stability_between_vertices(counts), is_cycle, points)


def _within_special_points(x: Array, error: Array, is_special: NDArray[np.bool_]) -> Array:
    """The parameter at the vertices of a branch, (n,); cycles are moved by at most twice their absolute error
    into the range between the special points before and after them. is_special: mask of the special points,
    (n,)."""
    x = x.copy()
    for start, end in pairwise(np.flatnonzero(is_special)):
        interior = slice(start + 1, end)
        inner_x = np.clip(x[interior], *sorted((x[start], x[end])))
        x[interior] = np.where(np.abs(inner_x - x[interior]) <= 2 * error[interior], inner_x, x[interior])
    return x


def _special_point(v: dict[str, Array], index: int) -> StoredSpecialPoint:
    """Special point at index `index` of the stored list."""
    values = {field.name: v[f"special_{field.name}"][index].item() for field in fields(StoredSpecialPoint)}
    texts = {"kind": SPECIAL_KINDS[values["kind"]], "reason": END_REASONS[values["reason"]]}
    return StoredSpecialPoint(**values | texts)


def stability_between_vertices(counts: list[int | None]) -> NDArray[np.integer]:
    """Stability between neighbouring vertices of a branch, (n - 1,): 1 stable, 0 unstable, -1 unknown.

    counts: least number of unstable multipliers at n vertices; -1 if unknown, None at special points.
    """
    stable = [-1] * (len(counts) - 1)
    unknown_indices = [i for i, count in enumerate(counts) if count is None]
    for start, end in pairwise([0, *unknown_indices, len(counts) - 1]):
        known_counts = [count for count in counts[start : end + 1] if count is not None and count >= 0]
        for i in range(start, end):
            neighbours = [count for count in counts[i : i + 2] if count in known_counts] or known_counts
            if len({count == 0 for count in neighbours}) == 1:
                stable[i] = int(neighbours[0] == 0)
    return np.array(stable, dtype=int)
