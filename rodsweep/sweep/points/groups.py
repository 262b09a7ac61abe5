"""Groups of points: neighbouring points on a grid line of a sweep that are solved together.

The division of grid lines into groups depends only on the grid. Results therefore depend neither on the
number of ranks nor on points of an earlier run: if any point of a group is missing, eigenvalues are
followed again along the complete group.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .ranges import IndexRange, IndexSet, index_count, indices_along, merged_ranges

MAX_GROUP_POINTS = 128
"""Maximum number of points in a group. The arms of a group share quantities that are computed once per group;
longer groups would leave fewer work items to the ranks."""
MIN_GROUP_AXIS_VALUES = 8
"""Minimum number of values on the axis along which points are grouped. On a shorter axis, neighbouring points
differ too much."""
GROUPS_PER_MISSING_POINT_TEST = 1 << 12
"""Number of groups tested for missing points in a single array operation, which bounds the memory."""


@dataclass(frozen=True, slots=True)
class GroupResult:
    """Result of a group of n points solved together. variable_values: every variable of the result file at
    the points, (n, ...), by name. is_solved: mask of points solved together, (n,); the other points must be
    solved one by one."""

    variable_values: dict[str, NDArray]
    is_solved: NDArray[np.bool_]

    def part_at(self, indices: NDArray[np.int64]) -> "GroupResult":
        """The part of the result at the positions `indices` in the group, (m,)."""
        values = {name: column[indices] for name, column in self.variable_values.items()}
        return GroupResult(values, self.is_solved[indices])


GroupSolveFunction = Callable[[NDArray[np.int64]], GroupResult]
"""Function from the flat indices of the points of a group, (n,), to the result of the group."""


@dataclass(frozen=True, slots=True)
class PointGroups:
    """All groups of a grid of shape `shape` along its axis number `axis`. A group is a run of neighbouring
    points whose eigenvalues are followed from point to point."""

    shape: tuple[int, ...]
    axis: int

    @property
    def line_count(self) -> int:
        """Number of grid lines parallel to the axis along which points are grouped."""
        return math.prod(self.shape) // self.shape[self.axis]

    @property
    def count(self) -> int:
        """Number of groups in the grid. Groups are ordered by position along the axis, at equal positions in
        row-major order of the remaining axes. Consecutive groups are therefore neighbours in the file."""
        return self.line_count * -(-self.shape[self.axis] // MAX_GROUP_POINTS)

    def indices(self, group_number: int) -> NDArray[np.int64]:
        """Flat indices of the points of the group number `group_number`, (n,)."""
        position_of_group, line = divmod(group_number, self.line_count)
        positions = np.arange(
            position_of_group * MAX_GROUP_POINTS,
            min((position_of_group + 1) * MAX_GROUP_POINTS, self.shape[self.axis]),
        )
        return indices_along(self.shape, self.axis, line, positions)

    def missing_point_counts(self, groups: IndexRange, missing: IndexSet) -> NDArray[np.int64]:
        """For each group in a range of group numbers, how many of its points are in `missing`, (groups,)."""
        position_of_group, line = np.divmod(np.arange(*groups)[:, None], self.line_count)
        positions = position_of_group * MAX_GROUP_POINTS + np.arange(MAX_GROUP_POINTS)
        index = indices_along(self.shape, self.axis, line, positions)
        # Positions beyond the end of a line are indices of other points.
        return (missing[index] & (positions < self.shape[self.axis])).sum(axis=1)

    def unsolved_ranges(self, missing: Sequence[IndexRange]) -> list[IndexRange]:
        """Ranges of group numbers: the groups with at least one missing point. missing: ranges of flat
        indices of the missing points."""
        if index_count(missing) == math.prod(self.shape):
            return [(0, self.count)]
        missing_points = IndexSet(missing)
        ranges: list[IndexRange] = []
        for start in range(0, self.count, GROUPS_PER_MISSING_POINT_TEST):
            end = min(start + GROUPS_PER_MISSING_POINT_TEST, self.count)
            incomplete = self.missing_point_counts((start, end), missing_points) > 0
            edges = start + np.flatnonzero(np.diff(incomplete, prepend=False, append=False))
            ranges += zip(map(int, edges[::2]), map(int, edges[1::2]), strict=True)
        return merged_ranges(ranges)

    def missing_point_count(self, groups: Sequence[IndexRange], missing: Sequence[IndexRange]) -> int:
        """Number of missing points in groups. groups: ranges of group numbers. missing: ranges of flat
        indices."""
        missing_points = IndexSet(missing)
        missing_count = 0
        for start, end in groups:
            for block_start in range(start, end, GROUPS_PER_MISSING_POINT_TEST):
                block = (block_start, min(block_start + GROUPS_PER_MISSING_POINT_TEST, end))
                missing_count += int(self.missing_point_counts(block, missing_points).sum())
        return missing_count


def groups_along_longest_axis(shape: tuple[int, ...], varied_parameters: Sequence[str]) -> PointGroups | None:
    """Groups of a grid along the first of its longest usable axes; None if no usable axis has at least
    MIN_GROUP_AXIS_VALUES values. shape: shape of the grid. varied_parameters: the only parameter that varies
    along each axis; "" for an axis of several parameters, which is not usable."""
    followable_axes = [axis for axis, name in enumerate(varied_parameters) if name]
    axis = max(followable_axes, key=lambda i: shape[i], default=None)
    return PointGroups(shape, axis) if axis is not None and shape[axis] >= MIN_GROUP_AXIS_VALUES else None


@dataclass(frozen=True, slots=True)
class GroupSolver:
    """Function from the number of a group of points to the results of its missing points. groups: all groups
    of the grid. solve_group: solves the points of a group together. solve_single_point: solves the point at a
    flat index, if it could not be solved together with its group. missing_points: flat indices of the missing
    points."""

    groups: PointGroups
    solve_group: GroupSolveFunction
    solve_single_point: Callable[[int], Any]
    missing_points: IndexSet

    def __call__(self, group_number: int) -> Iterator[tuple[NDArray[np.int64] | int, Any]]:
        """Solves a group of points; yields (flat indices, (m,), `GroupResult`) of all missing points that are
        solved together, then (flat index, outcome) of each further missing point. A run that ends between two
        points loses no point that was yielded before."""
        indices = self.groups.indices(group_number)
        result = self.solve_group(indices)
        missing = self.missing_points[indices]
        solved_indices = np.flatnonzero(missing & result.is_solved)
        if len(solved_indices):
            yield indices[solved_indices], result.part_at(solved_indices)
        for index in indices[missing & ~result.is_solved].tolist():
            yield index, self.solve_single_point(index)
