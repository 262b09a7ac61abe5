"""Neighbouring points of a grid that are solved together: its lines along one axis, cut into stretches.

Where the cuts are follows from the grid alone, so that what is computed depends neither on ranks nor on what
was kept of an earlier run: a stretch of which any point is missing is solved again as a whole.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .ranges import IndexRange, IndexSet, joined, total

LONGEST = 64
"""Points of a stretch."""
SHORTEST_AXIS = 8
"""Values of an axis below which its neighbours are too far from each other to help."""
STRETCHES_AT_ONCE = 1 << 12
"""Stretches that are looked through together."""


@dataclass(frozen=True, slots=True)
class Together:
    """What came of points that were solved together.

    values: every variable of the file, shape (n, ...); succeeded: whether each ended as it should, (n,);
    told: the status's name and the message of a point that did not.
    """

    values: dict[str, NDArray]
    succeeded: NDArray[np.bool_]
    told: Callable[[int], str]

    def at(self, places: NDArray[np.int64]) -> dict[str, NDArray]:
        """The variables of some of the points, by their places."""
        return {name: column[places] for name, column in self.values.items()}


SolveTogether = Callable[[NDArray[np.int64]], Together]
"""From the flat indices of neighbours, (n,), to what came of them."""


@dataclass(frozen=True, slots=True)
class Stretches:
    """The points of a grid of some shape as stretches along one of its axes."""

    shape: tuple[int, ...]
    axis: int

    @property
    def lines(self) -> int:
        """Number of lines along the axis."""
        return math.prod(self.shape) // self.shape[self.axis]

    @property
    def count(self) -> int:
        """Number of stretches: the first of all lines, in row-major order of the other axes, the second, ...

        So those that are solved one after another are neighbours in the file.
        """
        return self.lines * -(-self.shape[self.axis] // LONGEST)

    def indices(self, stretch: int) -> NDArray[np.int64]:
        """The flat indices of a stretch's points, shape (n,)."""
        part, line = divmod(stretch, self.lines)
        along = np.arange(part * LONGEST, min((part + 1) * LONGEST, self.shape[self.axis]))
        inner = math.prod(self.shape[self.axis + 1 :])
        outer, within = divmod(line, inner)
        return outer * self.shape[self.axis] * inner + within + inner * along

    def missing_of(self, stretches: IndexRange, missing: IndexSet) -> NDArray[np.int64]:
        """How many points of each stretch of a range are missing, shape (stretches,)."""
        part, line = np.divmod(np.arange(*stretches)[:, None], self.lines)
        along = part * LONGEST + np.arange(LONGEST)
        inner = math.prod(self.shape[self.axis + 1 :])
        outer, within = np.divmod(line, inner)
        index = outer * self.shape[self.axis] * inner + within + inner * along
        return (missing[index] & (along < self.shape[self.axis])).sum(axis=1)

    def todo(self, missing: Sequence[IndexRange]) -> list[IndexRange]:
        """Ranges of the stretches that miss a point."""
        if total(missing) == math.prod(self.shape):
            return [(0, self.count)]
        lacks = IndexSet(missing)
        ranges: list[IndexRange] = []
        for first in range(0, self.count, STRETCHES_AT_ONCE):
            some = self.missing_of((first, min(first + STRETCHES_AT_ONCE, self.count)), lacks) > 0
            edges = first + np.flatnonzero(np.diff(some, prepend=False, append=False))
            ranges += zip(map(int, edges[::2]), map(int, edges[1::2]), strict=True)
        return joined(ranges)

    def missing_in(self, stretches: Sequence[IndexRange], missing: Sequence[IndexRange]) -> int:
        """How many points of ranges of stretches are missing."""
        lacks, number = IndexSet(missing), 0
        for first, end in stretches:
            for at in range(first, end, STRETCHES_AT_ONCE):
                number += int(self.missing_of((at, min(at + STRETCHES_AT_ONCE, end)), lacks).sum())
        return number


def along_the_longest(shape: tuple[int, ...], moved: Sequence[str]) -> Stretches | None:
    """The stretches of a grid along the first of its longest axes; None where it is too short.

    moved: the one parameter that each axis moves; empty where it moves several, along which none is followed.
    """
    able = [axis for axis, name in enumerate(moved) if name]
    axis = max(able, key=lambda i: shape[i], default=None)
    return Stretches(shape, axis) if axis is not None and shape[axis] >= SHORTEST_AXIS else None


@dataclass(frozen=True, slots=True)
class StretchSolver:
    """Solves the stretches of a run, of which only the `missing` points are to be kept."""

    stretches: Stretches
    solve_together: SolveTogether
    missing: IndexSet

    def __call__(self, stretch: int) -> Iterator[tuple[NDArray[np.int64], Any]]:
        """(flat indices of the missing points, what came of them as `Together` of these alone)."""
        indices = self.stretches.indices(stretch)
        found = self.solve_together(indices)
        places = np.flatnonzero(self.missing[indices])
        some = Together(found.at(places), found.succeeded[places], lambda i: found.told(int(places[i])))
        yield indices[places], some
