"""Nonzero eigenvalues of a matrix of low rank, such as the derivative of a flow over a period.

Most directions decay to rounding error over a period, so that the numerical rank of the derivative A is
small. If A = Q R is a factorisation of this rank, the nonzero eigenvalues of A are the eigenvalues of the
small matrix R Q. Pivoted Gram-Schmidt gives A = Q R to rounding error, even if the columns of A differ much
in size. Q need not be orthogonal to rounding error. The multipliers of a strongly unstable orbit, whose
derivative is not formed, come from `shooting_intervals`.
"""

from dataclasses import dataclass

import numpy as np

from ....arrays import Array, Complex
from ....determinant.exponents import EXPONENT_SETTINGS
from ....model.compiled.compilation import compiled_with_reordered_sums
from ...backend.small_matrix_eigenvalues import small_matrix_eigenvalues
from ..orbit import Orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class FloquetMultiplierSettings:
    """Settings for the factorisation of the derivative of a flow."""

    negligible_column_ratio: float = 1e-17
    """The factorisation of the derivative of a flow ends, and neglects the columns that are left, if their
    norms are at most this number times the largest column norm of the derivative."""


FLOQUET_MULTIPLIER_SETTINGS = FloquetMultiplierSettings()


def nonzero_eigenvalues(A: Array) -> Complex:
    """Eigenvalues, (rank,), of a matrix A of low rank, (n, n), without the eigenvalues that are 0 within
    rounding error.

    Raises LinAlgError if A has entries that are not finite.
    """
    eigenvalues: Complex = _eigenvalues_of_compressed_matrix(
        np.ascontiguousarray(A), FLOQUET_MULTIPLIER_SETTINGS.negligible_column_ratio
    )
    if not len(eigenvalues):
        raise np.linalg.LinAlgError("the flow derivative of the cycle is not finite")
    return eigenvalues


def multipliers_over_solved_time_interval(propagator: Array, orbit: Orbit) -> Complex:
    """Nonzero eigenvalues, (rank,), of the map S^-1 P over the solved part of the period, S: symmetry.
    propagator: P, (n, n). Raises LinAlgError as `nonzero_eigenvalues`."""
    return nonzero_eigenvalues(orbit.symmetry.apply_inverse_to_flow(propagator, orbit.form.layout))


def multipliers_over_period(solved_multipliers: Complex, orbit: Orbit) -> Complex:
    """Floquet multipliers, (m,), by descending modulus. solved_multipliers: multipliers over the solved part,
    (m,)."""
    multipliers: Complex = solved_multipliers**orbit.symmetry.solved_parts_per_period
    # Stable, because conjugate multipliers have equal moduli.
    return multipliers[np.argsort(-np.abs(multipliers), kind="stable")]


@compiled_with_reordered_sums
def _eigenvalues_of_compressed_matrix(A: Array, negligible: float) -> Complex:
    """Eigenvalues of `compressed_matrix(A, negligible)`, (rank,); empty, (0,), if A has entries that are not
    finite."""
    compressed = compressed_matrix(A, negligible)
    for value in compressed.flat:
        if not np.isfinite(value):
            return np.empty(0, np.complex128)
    return small_matrix_eigenvalues(compressed)


@compiled_with_reordered_sums
def compressed_matrix(A: Array, negligible: float) -> Array:
    """Matrix R Q, (rank, rank), with the nonzero eigenvalues of A = Q R, (n, n), after small columns are
    neglected.

    negligible: limit of the norm of a neglected column, divided by the largest column norm of A.
    """
    Q, R = low_rank_factors(A, negligible)
    rank, n = Q.shape
    small = np.zeros((rank, rank))
    for a in range(rank):
        for b in range(rank):
            total = 0.0
            for j in range(n):
                # A = Q R has the nonzero eigenvalues of R Q, a matrix of the size of the rank.
                total += R[a, j] * Q[b, j]
            small[a, b] = total
    return small


@compiled_with_reordered_sums
def low_rank_factors(A: Array, negligible: float) -> tuple[Array, Array]:
    """Returns (q, r): vectors, (rank, n) each, with A = sum over i of q_i r_i^T, (n, n), after small columns
    are neglected. negligible: as in `compressed_matrix`."""
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
        # At least one vector, even of a matrix that is 0.
        if rank > 0 and size <= least:
            break
        q = Q[rank]
        r = R[rank]
        # Gram-Schmidt with the largest remaining column as pivot, which reveals the rank; `min_divisor`
        # avoids a division by 0 for a zero matrix.
        q[:] = columns[p] / max(size, EXPONENT_SETTINGS.min_divisor)
        for j in range(n):
            if norms[j] > least:
                norms[j] = _subtract_component_along(columns[j], q, r, j)
        # The rest of the pivot column is rounding error: its norm is set to 0.
        r[p] = size
        norms[p] = 0.0
        rank += 1
    return Q[:rank], R[:rank]


@compiled_with_reordered_sums
def _subtract_component_along(column: Array, q: Array, r: Array, j: int) -> float:
    """Subtracts from `column`, (n,), in place, its component along the unit vector q, (n,), stores this
    component in r[j], and returns the norm of the remaining column. j: index of the column."""
    along = 0.0
    left = 0.0
    for i in range(len(q)):
        along += q[i] * column[i]
    for i in range(len(q)):
        column[i] -= along * q[i]
        left += column[i] ** 2
    r[j] = along
    return np.sqrt(left)
