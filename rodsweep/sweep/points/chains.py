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
"""Function from a point's index and start state to the outcome and the neighbour's start state."""


class ChainStates(Protocol):
    """Checkpoints: for each unfinished chain, the index of the last point and the state after that point."""

    def write(self, chain: int, index: int, state: State) -> None: ...

    def read(self, chain: int) -> tuple[int, State] | None: ...

    def remove(self, chain: int) -> None: ...


@dataclass(frozen=True, slots=True)
class Chains:
    """Chains of a grid of the given shape along one axis, solved upward or downward."""

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
        """Ranges of the chains with missing points."""
        return merged_ranges((n, n + 1) for n in range(self.count) if missing[self.indices(n)].any())


@dataclass(frozen=True, slots=True)
class ChainedWork:
    """Solver of the points of chains. state_of: inverse of `ChainState.arrays`."""

    chains: Chains
    solve_from: ChainStep
    state_of: Callable[[Arrays], ChainState]


@dataclass(frozen=True, slots=True)
class ChainSolver:
    """Solves the chains of a run; only `missing` points are stored."""

    work: ChainedWork
    missing: IndexSet
    checkpoints: ChainStates
    stop: StopRequest

    def __call__(self, chain: int) -> Iterator[tuple[int, Any]]:
        """Yields the missing points of a chain, each with an outcome; fewer after a stop request.

        The state is stored after the point. A kill in between then costs a point, which is solved again; in
        the reverse order a kill could lose the point for good.
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
        """(place in the chain, state) from which to resume.

        A checkpoint is valid if no earlier point is missing; otherwise the chain starts again.
        """
        found = self.checkpoints.read(chain)
        if found is None or found[0] not in order:
            return 0, None
        place = order.index(found[0]) + 1
        if self.missing[order[:place]].any():
            return 0, None
        return place, found[1]
