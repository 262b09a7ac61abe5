"""Memory for the factors of Newton matrices: a solver owns a workspace and hands it to each matrix it makes.

New pages take as long as half an elimination, so the matrices of a solver share one buffer. Only the matrix
made last has factors there; an earlier one raises when they are needed.
"""

from math import prod
from typing import NamedTuple

import numpy as np

from ....arrays import Array

KEPT_NUMBERS = 2**23
"""Numbers, 64 MB, that a workspace keeps when a rod is done: most rods need fewer."""


class Factors(NamedTuple):
    """Newton's matrix of all K intervals, eliminated.

    blocks: (K, s, s, n, n), inverses of the pivots on the diagonal, row multipliers below, Schur-updated
    blocks above. The first two rows and columns hold in the first row only, at column 1, how x_0 = M^-1 moves
    the end, and at the columns of the stages from the third to the last but one, their right sides for it.
    propagator: P, (n, n). inverse: of the matrix that is left for start and period, (n + 1, n + 1).
    """

    blocks: Array
    propagator: Array
    inverse: Array


class NewtonWorkspace:
    """A buffer for the factors of one Newton matrix at a time; it grows to the largest that was asked for."""

    def __init__(self) -> None:
        self._buffer, self._claim = np.empty(0), 0

    def claim(self, size: int) -> int:
        """The number of a claim on the buffer, for a matrix of a size; earlier claims end."""
        if len(self._buffer) < size:
            self._buffer = np.empty(0)  # else both buffers would be in memory at once
            self._buffer = np.empty(size)
        self._claim += 1
        return self._claim

    def buffer(self, claim: int) -> Array:
        """The buffer, (size,) or longer, of a claim; raises RuntimeError once the claim has ended."""
        if claim != self._claim:
            raise RuntimeError("the factors of this matrix are overwritten: its workspace was used again")
        return self._buffer

    def release(self) -> None:
        """Ends the last claim and gives a buffer of more than KEPT_NUMBERS back."""
        self._claim += 1
        if len(self._buffer) > KEPT_NUMBERS:
            self._buffer = np.empty(0)


class MatrixMemory:
    """The factors of one Newton matrix: blocks in a workspace, all else its own."""

    def __init__(self, workspace: NewtonWorkspace, intervals: int, stages: int, unknowns: int) -> None:
        self.workspace = workspace
        self._shape = (intervals, stages, stages, unknowns, unknowns)
        self._claim = workspace.claim(prod(self._shape))
        self.propagator = np.zeros((unknowns, unknowns))
        """P, (n, n), which stays."""
        self._inverse = np.zeros((unknowns + 1, unknowns + 1))

    @property
    def factors(self) -> Factors:
        """The factors; raises RuntimeError once another matrix was made in the workspace."""
        blocks = self.workspace.buffer(self._claim)[: prod(self._shape)].reshape(self._shape)
        return Factors(blocks, self.propagator, self._inverse)
