"""Points that start one from the other: the chains of a grid along one of its axes, and how one is solved.

A chain is solved by one rank, point after point. What the next point starts from is kept after each,
so a chain that was killed goes on where it stood and ends in the same numbers.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ..stop import StopRequest
from .ranges import IndexRange, IndexSet, joined

Arrays = dict[str, Array]


class ChainState(Protocol):
    """State of the previous point in a chain, from which the next point starts."""

    def arrays(self) -> Arrays:
        """All of it as named arrays, of any shapes, for a checkpoint."""


State = ChainState | None
"""State of the previous point in the chain from which a point starts; None for a cold start."""
ChainStep = Callable[[int, Any], tuple[Any, Any]]
"""Function from a point's index and start state to its outcome and the start state of its neighbour."""


class ChainStates(Protocol):
    """Where the state of a chain's last point is kept."""

    def write(self, chain: int, index: int, state: State) -> None: ...

    def read(self, chain: int) -> tuple[int, State] | None: ...

    def remove(self, chain: int) -> None: ...


@dataclass(frozen=True, slots=True)
class Chains:
    """The points of a grid of some shape as chains along an axis, upward or downward."""

    shape: tuple[int, ...]
    axis: int
    upward: bool

    @property
    def length(self) -> int:
        """Points of a chain."""
        return self.shape[self.axis]

    @property
    def count(self) -> int:
        """Number of chains, which are numbered in row-major order of the other axes."""
        return math.prod(self.shape) // self.length

    def indices(self, chain: int) -> NDArray[np.int64]:
        """The flat indices of a chain's points in the order in which they are solved, shape (length,)."""
        inner = math.prod(self.shape[self.axis + 1 :])
        outer, within = divmod(chain, inner)
        along = outer * self.length * inner + within + inner * np.arange(self.length)
        return along if self.upward else along[::-1]

    def todo(self, missing: IndexSet) -> list[IndexRange]:
        """Ranges of the chains with missing points."""
        chains = (n for n in range(self.count) if missing[self.indices(n)].any())
        return joined((n, n + 1) for n in chains)


@dataclass(frozen=True, slots=True)
class ChainedWork:
    """How the points of chains are solved. state_of: the inverse of `ChainState.arrays`."""

    chains: Chains
    solve_from: ChainStep
    state_of: Callable[[Arrays], ChainState]


@dataclass(frozen=True, slots=True)
class ChainSolver:
    """Solves the chains of a run, of which only the `missing` points are to be kept."""

    work: ChainedWork
    missing: IndexSet
    checkpoints: ChainStates
    stop: StopRequest

    def __call__(self, chain: int) -> Iterator[tuple[int, Any]]:
        """The missing points of a chain, each with its outcome; fewer once a stop is asked for.

        The state is kept after the point, so a kill in between costs one point that is solved again;
        if the state came first, a kill could lose the point for good.
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
        """(place in the chain, state) to go on from: its checkpoint, if all points before it are there."""
        found = self.checkpoints.read(chain)
        if found is None or found[0] not in order:
            return 0, None
        place = order.index(found[0]) + 1
        if self.missing[order[:place]].any():
            return 0, None
        return place, found[1]
