"""Memory for the factors of Newton matrices, shared by all matrices of a solver.

New memory pages cost as much time as half an elimination; therefore the matrices of a solver share one
buffer. The buffer contains the factors of the last matrix. An earlier matrix raises an error if its factors
are needed.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled
from ...unsolvable import MeshLimitReached, WorkLimitReached


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkspaceSettings:
    """Settings for the memory of the matrices of orbits."""

    max_kept_buffer_doubles: int = 2**23
    """Largest size of a buffer that is not freed between rods, in double-precision numbers: 64 MB, enough for
    most rods."""
    max_buffer_size: int = 2**28
    """Largest size of a buffer, in double-precision numbers: 2.1 GB. The mesh with the most time intervals,
    unknowns and stages would need more than twice as much, more than many machines have for one rank."""
    doubles_per_cache_line: int = 8
    """Number of double-precision numbers of a cache line, at which a buffer starts: vectors of 32 bytes that
    cross the end of a line take longer, an elimination with 60 unknowns by 7 %."""
    max_matrix_work_fraction: float = 0.125
    """Largest work of a single matrix, divided by the limit of the work on a rod. Several matrices are needed
    for one cycle or special point; a matrix of a larger share would use up the limit, and the memory of the
    machine, before a result is found."""


WORKSPACE_SETTINGS = WorkspaceSettings()


FIRST_STAGE, SECOND_STAGE, INTERVAL_MAP = range(3)
"""Numbers of the blocks of an interval: for the first two stages, and for the map from its start to its end.
"""
MIN_STAGE_COUNT = 3
"""Smallest number of stages of an interval for which the blocks of Newton's matrix are arranged."""


def require_enough_stages(s: int) -> None:
    """Raises ValueError if Newton's matrix cannot be eliminated for intervals of s stages."""
    if s < MIN_STAGE_COUNT:
        raise ValueError(f"{s} stages per time interval are too few: at least {MIN_STAGE_COUNT} are needed")


def block_count(s: int) -> int:
    """Number of blocks of an interval of s stages; s must be at least `MIN_STAGE_COUNT`."""
    return int(s + (s - 2) ** 2)


@compiled
def start_to_stage_block_index(a: int) -> int:
    """Number of the block that contains the effect of the interval's start on stage a, 2 <= a <= s - 2; s:
    number of stages."""
    return a + 1


@compiled
def stage_block_index(i: int, j: int, s: int) -> int:
    """Number of the block in row i and column j of the later stages, 2 <= i, j < s; s: number of stages."""
    return s + (i - 2) * (s - 2) + j - 2


def factors_size_in_doubles(interval_count: int, stage_count: int, unknown_count: int) -> int:
    """Size of the factors of a Newton matrix, in double-precision numbers. Raises ValueError for too few
    stages, for which compiled code would write beyond the factors."""
    require_enough_stages(stage_count)
    return interval_count * block_count(stage_count) * unknown_count**2


class NewtonFactors(NamedTuple):
    """Eliminated Newton matrix of all K intervals.

    eliminated_blocks: (K, `block_count(s)`, n, n). Blocks `FIRST_STAGE` and `SECOND_STAGE` are the inverses
    of the pivot blocks of these stages. The blocks `stage_block_index` of later stages are the inverses of
    pivot blocks on the diagonal, row multipliers below, and Schur-updated blocks above. The remaining blocks
    multiply M x_0, x_0: state at the start; `INTERVAL_MAP` gives the increment of the end,
    `start_to_stage_block_index(a)` the right-hand side of stage a, 2 <= a <= s - 2. propagator: map P over
    all intervals, (n, n). closing_matrix_inverse: inverse of the remaining matrix for start and period, (n +
    1, n + 1).
    """

    eliminated_blocks: Array
    propagator: Array
    closing_matrix_inverse: Array


def _empty_from_cache_line(size: int) -> Array:
    """New memory of `size` double-precision numbers that starts at a cache line, (size,)."""
    line = WORKSPACE_SETTINGS.doubles_per_cache_line
    memory = np.empty(size + line)
    first = -(memory.ctypes.data // memory.itemsize) % line
    return memory[first : first + size]


class NewtonWorkspace:
    """Buffer for the factors of one Newton matrix at a time; it grows to the largest requested size.

    The workspace also counts the work of the eliminations: K s^2 n^3 multiplications for K intervals of s
    stages with n unknowns. The work is proportional to the computing time on every machine."""

    def __init__(self) -> None:
        self._buffer: Array = np.empty(0)
        self._reservation = 0
        self._max_work = inf
        self._work = 0.0

    def limit_work(self, max_multiplications: float) -> None:
        """Starts to count the work anew. max_multiplications: limit of the work until `release`, in
        multiplications."""
        self._max_work = max_multiplications
        self._work = 0.0

    @property
    def work(self) -> float:
        """Work since the last call of `limit_work`, in multiplications."""
        return self._work

    @contextmanager
    def further_work_limit(self, further_work: float) -> Iterator[None]:
        """Context in which at most `further_work` more multiplications are done; the limit of `limit_work`
        stays in force if it allows fewer. A matrix beyond the limit raises WorkLimitReached."""
        previous_max_work = self._max_work
        self._max_work = min(previous_max_work, self._work + further_work)
        try:
            yield
        finally:
            self._max_work = previous_max_work

    def count_matrix_work_within_limit(self, work: float) -> None:
        """Counts the work of the next matrix; raises WorkLimitReached if the matrix exceeds the limit.
        work: number of multiplications."""
        if (
            work > WORKSPACE_SETTINGS.max_matrix_work_fraction * self._max_work
            or self._work + work > self._max_work
        ):
            raise WorkLimitReached("the limit of the work on a rod (option `work`) is reached")
        self._work += work

    def reserve(self, size: int) -> int:
        """Starts a new reservation of the buffer, ends earlier reservations, and returns the number of the
        new reservation. size: required size of the buffer. Raises MeshLimitReached beyond
        `max_buffer_size`."""
        if size > WORKSPACE_SETTINGS.max_buffer_size:
            required_GB, allowed_GB = (
                8e-9 * entries for entries in (size, WORKSPACE_SETTINGS.max_buffer_size)
            )
            raise MeshLimitReached(
                f"Newton's matrix on a mesh that is fine enough needs {required_GB:.1f} GB, more than the "
                f"{allowed_GB:.1f} GB allowed"
            )
        if len(self._buffer) < size:
            self._buffer = np.empty(0)  # frees the old buffer before the new one is allocated
            self._buffer = _empty_from_cache_line(size)
        self._reservation += 1
        return self._reservation

    def has_reservation(self, reservation: int) -> bool:
        """Whether the reservation with the number `reservation` has not ended."""
        return reservation == self._reservation

    def buffer(self, reservation: int) -> Array:
        """The buffer, (size,) or longer, for the reservation with the number `reservation`; raises
        RuntimeError if this reservation has ended."""
        if not self.has_reservation(reservation):
            raise RuntimeError("the factors of this matrix are overwritten: its workspace was used again")
        return self._buffer

    def release(self) -> None:
        """Ends the last reservation and the limit of the work, and frees the buffer if it is larger than
        WORKSPACE_SETTINGS.max_kept_buffer_doubles."""
        # A matrix that still holds the last reservation can no longer be used.
        self._reservation += 1
        self.limit_work(inf)
        if len(self._buffer) > WORKSPACE_SETTINGS.max_kept_buffer_doubles:
            self._buffer = np.empty(0)


class FactorStorage:
    """Memory of the factors of one Newton matrix: the blocks are in a workspace, propagator and inverse in
    separate arrays."""

    def __init__(
        self, workspace: NewtonWorkspace, interval_count: int, stage_count: int, unknown_count: int
    ) -> None:
        self.workspace = workspace
        self._shape = (interval_count, block_count(stage_count), unknown_count, unknown_count)
        self._size = factors_size_in_doubles(interval_count, stage_count, unknown_count)
        # Work is counted first: a matrix beyond the limit must not end the last reservation.
        workspace.count_matrix_work_within_limit(
            float(interval_count * stage_count**2) * float(unknown_count) ** 3
        )
        self._reservation = workspace.reserve(self._size)
        self.propagator = np.zeros((unknown_count, unknown_count))
        """P, (n, n), which stays valid when the workspace is used again."""
        self._inverse = np.zeros((unknown_count + 1, unknown_count + 1))

    @property
    def is_valid(self) -> bool:
        """Whether the factors are still in the workspace: no other matrix has been assembled there."""
        return self.workspace.has_reservation(self._reservation)

    @property
    def factors(self) -> NewtonFactors:
        """The factors; raises RuntimeError if another matrix was assembled in the workspace."""
        blocks = self.workspace.buffer(self._reservation)[: self._size].reshape(self._shape)
        return NewtonFactors(blocks, self.propagator, self._inverse)
