"""Points that start one from the other: the chains of a grid along one of its axes, and how one is solved.

A chain is solved by one rank, point after point. What the next point starts from is kept after each,
so a chain that was killed goes on where it stood and ends in the same numbers.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from .handout import Range

State = NDArray[np.float64] | None
"""What a point starts from where its neighbour has something to offer; None otherwise."""


class Checkpoints(Protocol):
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
        outer, rest = divmod(chain, inner)
        along = outer * self.length * inner + rest + inner * np.arange(self.length)
        return along if self.upward else along[::-1]

    def todo(self, missing: NDArray[np.bool_]) -> list[Range]:
        """Ranges of the chains that miss a point; `missing` says it of every point, flat."""
        lines = np.moveaxis(missing.reshape(self.shape), self.axis, -1).reshape(-1, self.length)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], lines.any(axis=1), [False]])))
        return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def mask(ranges: Sequence[Range], count: int) -> NDArray[np.bool_]:
    """Which of `count` points lie in the ranges, shape (count,)."""
    there = np.zeros(count, bool)
    for start, stop in ranges:
        there[start:stop] = True
    return there


@dataclass(frozen=True, slots=True)
class ChainSolver:
    """Solves the chains of a run; `missing` says of every point, flat, whether it is to be kept."""

    chains: Chains
    missing: NDArray[np.bool_]
    solve_from: Callable[[int, State], tuple[Any, State]]
    """From an index and what the point starts from to its outcome and what its neighbour starts from."""
    checkpoints: Checkpoints

    def __call__(self, chain: int) -> Iterator[tuple[int, Any]]:
        """The missing points of a chain, each with its outcome.

        The state is kept after the point, so a kill in between costs one point that is solved again;
        the other way round its state could be lost.
        """
        order = self.chains.indices(chain).tolist()
        first, state = self._resume(chain, order)
        for index in order[first:]:
            outcome, state = self.solve_from(index, state)
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
