"""Memory for the factors of Newton matrices: a solver owns a workspace and lends it to each of its matrices.

New memory pages cost as much time as half an elimination, so that the matrices of a solver share one buffer.
Only the last matrix has its factors in the buffer; an earlier matrix raises an error if they are needed.
"""

from dataclasses import dataclass
from math import prod
from typing import NamedTuple

import numpy as np

from ....arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkspaceSettings:
    """Settings for the memory of the matrices of orbits."""

    kept_numbers: int = 2**23
    """Numbers that a workspace keeps between rods, 64 MB: enough for most rods."""


WORKSPACE = WorkspaceSettings()


class Factors(NamedTuple):
    """Eliminated Newton matrix of all K intervals.

    blocks: (K, s, s, n, n), with inverses of the pivots on the diagonal, row multipliers below, Schur-updated
    blocks above. In the first two rows and columns, only the first row is used besides the diagonal: column 1
    holds the change of the end for x_0 = M^-1, and columns 2 to s - 2 hold the right sides of these stages
    for x_0 = M^-1. propagator: P, (n, n). inverse: inverse of the remaining matrix for start and period, (n +
    1, n + 1).
    """

    blocks: Array
    propagator: Array
    inverse: Array


class NewtonWorkspace:
    """Buffer for the factors of one Newton matrix at a time; it grows to the largest requested size."""

    def __init__(self) -> None:
        self._buffer = np.empty(0)
        self._claim = 0

    def claim(self, size: int) -> int:
        """Number of a new claim on the buffer, for a matrix of this size; earlier claims end."""
        if len(self._buffer) < size:
            self._buffer = np.empty(0)  # frees the old buffer before the new one is allocated
            self._buffer = np.empty(size)
        self._claim += 1
        return self._claim

    def buffer(self, claim: int) -> Array:
        """Buffer of a claim, (size,) or longer; raises RuntimeError if the claim has ended."""
        if claim != self._claim:
            raise RuntimeError("the factors of this matrix are overwritten: its workspace was used again")
        return self._buffer

    def release(self) -> None:
        """Ends the last claim, and frees a buffer of more than WORKSPACE.kept_numbers."""
        self._claim += 1
        if len(self._buffer) > WORKSPACE.kept_numbers:
            self._buffer = np.empty(0)


class MatrixMemory:
    """Factors of one Newton matrix: blocks in a workspace, and other factors in separate arrays."""

    def __init__(self, workspace: NewtonWorkspace, intervals: int, stages: int, unknowns: int) -> None:
        self.workspace = workspace
        self._shape = (intervals, stages, stages, unknowns, unknowns)
        self._claim = workspace.claim(prod(self._shape))
        self.propagator = np.zeros((unknowns, unknowns))
        """P, (n, n), which stays valid when the workspace is used again."""
        self._inverse = np.zeros((unknowns + 1, unknowns + 1))

    @property
    def factors(self) -> Factors:
        """The factors; raises RuntimeError if another matrix was made in the workspace."""
        blocks = self.workspace.buffer(self._claim)[: prod(self._shape)].reshape(self._shape)
        return Factors(blocks, self.propagator, self._inverse)
