"""Nonzero eigenvalues of a matrix of low rank, such as the derivative of a flow over a period.

Few directions survive a period. The factorisation A = Q R of this rank, by pivoted Gram-Schmidt, has the
nonzero eigenvalues of the small matrix R Q. For this purpose Q need not be orthogonal. A = Q R must hold to
rounding, which it does even if the columns of A differ much in size.
"""

from dataclasses import dataclass

import numpy as np

from ....arrays import Array, Complex
from ....model.compiled.compilation import compiled_for_vectors
from ...backend.small_eigenvalues import eigenvalues


@dataclass(frozen=True, slots=True, kw_only=True)
class MultiplierSettings:
    """Settings for the compression of the flow's derivative."""

    negligible: float = 1e-17
    """Largest norm of a negligible column, in units of the largest column of the flow's derivative."""


MULTIPLIERS = MultiplierSettings()


def nonzero_eigenvalues(A: Array) -> Complex:
    """Eigenvalues, (rank,), of a matrix (n, n) of low rank, without those that are 0 to rounding.

    Raises LinAlgError if A has entries that are not finite.
    """
    values: Complex = _eigenvalues_by_rank(np.ascontiguousarray(A), MULTIPLIERS.negligible)
    if not len(values):
        raise np.linalg.LinAlgError("the derivative of the flow is not finite")
    return values


@compiled_for_vectors
def _eigenvalues_by_rank(A: Array, negligible: float) -> Complex:
    """Eigenvalues of A after `compressed`, (rank,); empty, (0,), if A has entries that are not finite."""
    small = compressed(A, negligible)
    for value in small.flat:
        if not np.isfinite(value):
            return np.empty(0, np.complex128)
    return eigenvalues(small)


@compiled_for_vectors
def compressed(A: Array, negligible: float) -> Array:
    """Matrix (rank, rank) with the eigenvalues of A, (n, n), apart from zeros of a slightly changed A.

    negligible: largest column of this change in units of A's largest column.
    """
    n = len(A)
    columns = A.T.copy()
    norms = np.empty(n)
    for j in range(n):
        norms[j] = np.sqrt((columns[j] ** 2).sum())
    # The rows q and r of A = sum q r^T: rows are contiguous.
    Q = np.empty((n, n))
    R = np.zeros((n, n))
    least = negligible * norms.max()
    rank = 0
    while rank < n:
        p = np.argmax(norms)
        size = norms[p]
        if rank > 0 and size <= least:
            break
        q = Q[rank]
        r = R[rank]
        # Gram-Schmidt with the largest remaining column as pivot, which reveals the rank; the tiny divisor
        # keeps a zero matrix from dividing by 0.
        q[:] = columns[p] / max(size, 1e-300)
        for j in range(n):
            if norms[j] > least:
                norms[j] = _without(columns[j], q, r, j)
        # The remaining pivot column is rounding error: its norm is set to 0.
        r[p] = size
        norms[p] = 0.0
        rank += 1
    small = np.zeros((rank, rank))
    for a in range(rank):
        for b in range(rank):
            total = 0.0
            for j in range(n):
                # A = Q R has the nonzero eigenvalues of R Q, a matrix of the size of the rank.
                total += R[a, j] * Q[b, j]
            small[a, b] = total
    return small


@compiled_for_vectors
def _without(column: Array, q: Array, r: Array, j: int) -> float:
    """Moves a column's component along q into r[j], and returns the norm of the remaining column."""
    along = 0.0
    left = 0.0
    for i in range(len(q)):
        along += q[i] * column[i]
    for i in range(len(q)):
        column[i] -= along * q[i]
        left += column[i] ** 2
    r[j] = along
    return np.sqrt(left)
