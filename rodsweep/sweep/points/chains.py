"""Chains: points of a grid along an axis, where the solve of each point starts from the solver state of the
previous point.

A rank solves a complete chain, point after point. The start state of the next point is stored after each
point. A killed chain therefore resumes after the last point and gives the same numbers.
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

ArraysByName = dict[str, Array]


class ChainState(Protocol):
    """State of the solver after a point of a chain, from which the solve of the next point starts."""

    def arrays(self) -> ArraysByName:
        """The complete state as arrays of any shape, (...,), by name, for a checkpoint."""


State = ChainState | None
"""Solver state after the previous point of the chain; None at the first point."""
ChainStep = Callable[[int, Any], tuple[Any, Any]]
"""Function from (flat index of a point, initial state) to (outcome, initial state of the next point)."""


class CheckpointStore(Protocol):
    """Store of checkpoints: (flat index of the last solved point, solver state after this point) of each
    unfinished chain of points."""

    def write(self, chain: int, index: int, state: State) -> None: ...

    def read(self, chain: int) -> tuple[int, State] | None: ...

    def remove(self, chain: int) -> None: ...


@dataclass(frozen=True, slots=True)
class Chains:
    """All chains of a grid of shape `shape` along its axis number `axis`. A chain is a line of points, each
    started from its neighbour's solution. is_upward: whether points are solved in order of increasing values
    on the axis."""

    shape: tuple[int, ...]
    axis: int
    is_upward: bool

    @property
    def points_per_chain(self) -> int:
        """Number of points in a chain."""
        return self.shape[self.axis]

    @property
    def count(self) -> int:
        """Number of chains, numbered in row-major order of the remaining axes."""
        return math.prod(self.shape) // self.points_per_chain

    def indices(self, chain_number: int) -> NDArray[np.int64]:
        """Flat indices of the points of a chain in the order of solution, shape (length,)."""
        positions = np.arange(self.points_per_chain)
        return indices_along(
            self.shape, self.axis, chain_number, positions if self.is_upward else positions[::-1]
        )

    def unsolved_ranges(self, missing: IndexSet) -> list[IndexRange]:
        """Ranges of chain numbers: the chains with at least one missing point. missing: flat indices of the
        missing points."""
        return merged_ranges((n, n + 1) for n in range(self.count) if missing[self.indices(n)].any())


@dataclass(frozen=True, slots=True)
class SweepChains:
    """The chains of a sweep, and how to solve them. solve_from: solves a point from a state.
    state_from_arrays: makes a state from the arrays of `ChainState.arrays`."""

    chains: Chains
    solve_from: ChainStep
    state_from_arrays: Callable[[ArraysByName], ChainState]


@dataclass(frozen=True, slots=True)
class ChainSolver:
    """Function from the number of a chain to the outcomes of its missing points; resumes from checkpoints.
    sweep_chains: the chains and the functions that solve them. missing_points: flat indices of the missing
    points. checkpoints: store of solver states. stop: a stop request ends the chain after the current
    point."""

    sweep_chains: SweepChains
    missing_points: IndexSet
    checkpoints: CheckpointStore
    stop: StopRequest

    def __call__(self, chain_number: int) -> Iterator[tuple[int, Any]]:
        """Yields (flat index, outcome) of each missing point of a chain; ends early after a stop request.
        Points that are not missing are solved too, from the checkpoint on, because later points start from
        them.

        The caller stores an outcome before the state of the chain after this point is stored. A kill in
        between costs a second solve of the point; in the reverse order the point could be lost.
        """
        order = list(map(int, self.sweep_chains.chains.indices(chain_number)))
        first_position, state = self._resume_position_and_state(chain_number, order)
        for index in order[first_position:]:
            if self.stop:
                return
            outcome, state = self.sweep_chains.solve_from(index, state)
            # A point is stored before its checkpoint: a killed run repeats a point rather than losing it.
            if self.missing_points[index]:
                yield index, outcome
            if index != order[-1]:
                self.checkpoints.write(chain_number, index, state)
        self.checkpoints.remove(chain_number)

    def _resume_position_and_state(self, chain_number: int, order: list[int]) -> tuple[int, State]:
        """Returns (position, within the chain, of the first point to be solved; initial state of its solve).
        order: flat indices of the points of the chain in the order of solution. The checkpoint is used if no
        point up to the checkpoint is missing; otherwise the chain starts again without an initial state."""
        checkpoint = self.checkpoints.read(chain_number)
        # The grid may have been extended or reversed since the checkpoint was written.
        if checkpoint is None or checkpoint[0] not in order:
            return 0, None
        position = order.index(checkpoint[0]) + 1
        # A missing point before the checkpoint can be reached only from the start of the chain.
        if self.missing_points[order[:position]].any():
            return 0, None
        return position, checkpoint[1]
