"""Stretches: neighbouring points of a grid solved at once, cut from lines along an axis.

The cuts follow from the grid alone. Results therefore depend neither on the number of ranks nor on points of
an earlier run: a stretch with any missing point is solved again as a whole.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .ranges import IndexRange, IndexSet, index_count, indices_along, merged_ranges

STRETCH_POINTS = 64
"""Largest number of points in a stretch."""
SHORTEST_AXIS = 8
"""Minimum number of values on the axis of stretches. On shorter axes neighbours are too far apart for
following eigenvalues from point to point."""
STRETCHES_PER_BLOCK = 1 << 12
"""Number of stretches tested for missing points in one array operation, to bound the memory."""


@dataclass(frozen=True, slots=True)
class StretchResult:
    """Result of the n points of a stretch.

    values: every variable of the file, shape (n, ...). succeeded: whether each point succeeded, (n,).
    message: function from the position of a failed point in the stretch to its status and message.
    """

    values: dict[str, NDArray]
    succeeded: NDArray[np.bool_]
    message: Callable[[int], str]

    def at(self, places: NDArray[np.int64]) -> dict[str, NDArray]:
        """Values of every variable at the points with positions `places` in the stretch, (places,)."""
        return {name: column[places] for name, column in self.values.items()}


SolveStretch = Callable[[NDArray[np.int64]], StretchResult]
"""Function that solves the points with flat indices (n,) of one stretch and returns their `StretchResult`."""


@dataclass(frozen=True, slots=True)
class Stretches:
    """Stretches that cut a grid of `shape` points along `axis`."""

    shape: tuple[int, ...]
    axis: int

    @property
    def lines(self) -> int:
        """Number of grid lines parallel to the axis."""
        return math.prod(self.shape) // self.shape[self.axis]

    @property
    def count(self) -> int:
        """Number of stretches.

        Stretches are numbered first by position on the grid line, then in row-major order of the other axes.
        Consecutive stretches are therefore neighbours in the file.
        """
        return self.lines * -(-self.shape[self.axis] // STRETCH_POINTS)

    def indices(self, stretch: int) -> NDArray[np.int64]:
        """Flat indices of the points of a stretch, shape (n,)."""
        part, line = divmod(stretch, self.lines)
        along = np.arange(part * STRETCH_POINTS, min((part + 1) * STRETCH_POINTS, self.shape[self.axis]))
        return indices_along(self.shape, self.axis, line, along)

    def missing_of(self, stretches: IndexRange, missing: IndexSet) -> NDArray[np.int64]:
        """Number of missing points of each stretch in a range, shape (stretches,)."""
        part, line = np.divmod(np.arange(*stretches)[:, None], self.lines)
        along = part * STRETCH_POINTS + np.arange(STRETCH_POINTS)
        index = indices_along(self.shape, self.axis, line, along)
        return (missing[index] & (along < self.shape[self.axis])).sum(axis=1)

    def todo(self, missing: Sequence[IndexRange]) -> list[IndexRange]:
        """Ranges of the numbers of stretches with missing points; missing: ranges of flat indices."""
        if index_count(missing) == math.prod(self.shape):
            return [(0, self.count)]
        missing_points = IndexSet(missing)
        ranges: list[IndexRange] = []
        for first in range(0, self.count, STRETCHES_PER_BLOCK):
            last = min(first + STRETCHES_PER_BLOCK, self.count)
            incomplete = self.missing_of((first, last), missing_points) > 0
            edges = first + np.flatnonzero(np.diff(incomplete, prepend=False, append=False))
            ranges += zip(map(int, edges[::2]), map(int, edges[1::2]), strict=True)
        return merged_ranges(ranges)

    def missing_in(self, stretches: Sequence[IndexRange], missing: Sequence[IndexRange]) -> int:
        """Total number of missing points in `stretches`, ranges of stretch numbers."""
        missing_points = IndexSet(missing)
        number = 0
        for first, end in stretches:
            for at in range(first, end, STRETCHES_PER_BLOCK):
                block = (at, min(at + STRETCHES_PER_BLOCK, end))
                number += int(self.missing_of(block, missing_points).sum())
        return number


def stretches_along_longest_axis(shape: tuple[int, ...], moved: Sequence[str]) -> Stretches | None:
    """Stretches along the longest usable axis of a grid; None if shorter than SHORTEST_AXIS.

    moved: the parameter that varies along each axis; empty for an axis of several parameters, which is not
    usable.
    """
    able = [axis for axis, name in enumerate(moved) if name]
    axis = max(able, key=lambda i: shape[i], default=None)
    return Stretches(shape, axis) if axis is not None and shape[axis] >= SHORTEST_AXIS else None


@dataclass(frozen=True, slots=True)
class StretchSolver:
    """Function that solves a stretch of a run; yields only `missing` points, for storage."""

    stretches: Stretches
    solve_stretch: SolveStretch
    missing: IndexSet

    def __call__(self, stretch: int) -> Iterator[tuple[NDArray[np.int64], Any]]:
        """Yields (flat indices, `StretchResult`) of the missing points of a stretch, once."""
        indices = self.stretches.indices(stretch)
        result = self.solve_stretch(indices)
        places = np.flatnonzero(self.missing[indices])
        missing = StretchResult(
            result.at(places), result.succeeded[places], lambda i: result.message(int(places[i]))
        )
        yield indices[places], missing
