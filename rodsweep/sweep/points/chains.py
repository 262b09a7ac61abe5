"""Chains: points of a grid along an axis, where each point starts from the state of the previous point.

A rank solves a whole chain, point after point. The start state of the next point is stored after each point.
A killed chain therefore resumes after the last point and gives the same numbers.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ..stop import StopRequest
from .ranges import IndexRange, IndexSet, indices_along, merged_ranges

Arrays = dict[str, Array]


class ChainState(Protocol):
    """State of the previous point in a chain, from which the next point starts."""

    def arrays(self) -> Arrays:
        """The whole state as named arrays of any shape, for a checkpoint."""


State = ChainState | None
"""State of the previous point of the chain; None for a cold start."""
ChainStep = Callable[[int, Any], tuple[Any, Any]]
"""Function from (flat index, start state) of a point to (outcome, start state of the next point)."""


class ChainStates(Protocol):
    """Interface of checkpoints: last solved point of each unfinished chain, and the state after it."""

    def write(self, chain: int, index: int, state: State) -> None: ...

    def read(self, chain: int) -> tuple[int, State] | None: ...

    def remove(self, chain: int) -> None: ...


@dataclass(frozen=True, slots=True)
class Chains:
    """Chains of a grid of `shape` points along `axis`, solved in increasing order if `upward`."""

    shape: tuple[int, ...]
    axis: int
    upward: bool

    @property
    def length(self) -> int:
        """Number of points in a chain."""
        return self.shape[self.axis]

    @property
    def count(self) -> int:
        """Number of chains, numbered in row-major order of the remaining axes."""
        return math.prod(self.shape) // self.length

    def indices(self, chain: int) -> NDArray[np.int64]:
        """Flat indices of the points of a chain in the order of solution, shape (length,)."""
        along = np.arange(self.length)
        return indices_along(self.shape, self.axis, chain, along if self.upward else along[::-1])

    def todo(self, missing: IndexSet) -> list[IndexRange]:
        """Ranges of the numbers of chains with missing points; missing: ranges of flat indices of points."""
        return merged_ranges((n, n + 1) for n in range(self.count) if missing[self.indices(n)].any())


@dataclass(frozen=True, slots=True)
class ChainedWork:
    """Chains, and the functions that solve one point and that restore a state from its arrays."""

    chains: Chains
    solve_from: ChainStep
    state_of: Callable[[Arrays], ChainState]


@dataclass(frozen=True, slots=True)
class ChainSolver:
    """Function that solves a chain of a run; yields only `missing` points, for storage."""

    work: ChainedWork
    missing: IndexSet
    checkpoints: ChainStates
    stop: StopRequest

    def __call__(self, chain: int) -> Iterator[tuple[int, Any]]:
        """Yields (flat index, outcome) of the missing points of a chain, until a stop request.

        The caller stores the point before the checkpoint of the chain is written. A kill between the two
        writes
        therefore makes a later run solve the point again; in reverse order a kill would lose the point for
        good.
        """
        order = list(map(int, self.work.chains.indices(chain)))
        first, state = self._resume(chain, order)
        for index in order[first:]:
            if self.stop:
                return
            outcome, state = self.work.solve_from(index, state)
            if self.missing[index]:
                yield index, outcome
            if index != order[-1]:
                self.checkpoints.write(chain, index, state)
        self.checkpoints.remove(chain)

    def _resume(self, chain: int, order: list[int]) -> tuple[int, State]:
        """(position in `order` of the first point to solve, its start state).

        The checkpoint is used if no point before it is missing; otherwise the chain starts again from a cold
        start.
        """
        found = self.checkpoints.read(chain)
        if found is None or found[0] not in order:
            return 0, None
        place = order.index(found[0]) + 1
        if self.missing[order[:place]].any():
            return 0, None
        return place, found[1]
