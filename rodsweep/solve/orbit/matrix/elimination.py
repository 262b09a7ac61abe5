"""Elimination of an orbit's Newton matrix, interval by interval, compiled.

In each interval, with the state x_0 at its start, the stages x_1 ... x_s satisfy

    sum_j d_ij M x_j = h F(x_i),        j = 0 ... s,

with the method's differentiation matrix d (s >= 3), the diagonal mass matrix M (0 where an unknown has no
time derivative) and the balance F. The off-diagonal blocks of Newton's matrix, d_ij M, are diagonal matrices.
Therefore the elimination of the first stage costs one inverse X, and the elimination of the second stage one
inverse Y and three products: the blocks of later stages change by combinations of Z = M X, W = M Y, Z W, W Z
and Z W Z. Later stages are eliminated by products of blocks. Each interval becomes a map from its start to
its end. The product P of these maps is the derivative of the flow over all intervals. Pivots are chosen
within a block: the diagonal blocks d_ii M - h F' are regular if h is short compared with the time of growth.
"""

import numpy as np

from ....arrays import Array
from ....discretization.plane_equations import write_jacobian
from ....model.compiled.compilation import compiled_with_reordered_sums
from ...backend.products import square_matrix_product
from ..equations import OrbitEquations
from .inversion import INVERSION_SETTINGS, invert_matrix
from .substitution import map_start_to_end, reduce_right_sides
from .workspace import (
    FIRST_STAGE,
    INTERVAL_MAP,
    SECOND_STAGE,
    NewtonFactors,
    stage_block_index,
    start_to_stage_block_index,
)


@compiled_with_reordered_sums
def eliminate_newton_matrix(
    points: Array, V: Array, duration: float, p: OrbitEquations, factors: NewtonFactors, columns: Array
) -> Array:
    """Eliminates Newton's matrix of an orbit and writes it into `factors`. Returns the changes that the
    right-hand sides cause at the end of the last interval for a fixed start, (k, n).

    points: states at the start and at all stages, (1 + K s, n): K intervals, s stages, n unknowns of a state.
    V: velocities of the stages, (K, s, 3, nodes + 1). duration: total length of the intervals, in tau2. p:
    equations of the orbit. columns: k right-hand sides, (K, s, k, n), which are reduced in place.
    """
    K = columns.shape[0]
    s = columns.shape[1]
    n = columns.shape[3]
    tip = np.empty((3, n))
    right_matrices = np.empty((s, n, n))
    parts = np.empty((5, n, n))
    # M times the product of the maps so far, which is the identity before the first interval.
    so_far = np.diag(p.mass_diagonal)
    ends = np.zeros(columns.shape[2:])
    for k in range(K):
        B = factors.eliminated_blocks[k]
        h = duration * p.time_interval_lengths[k]
        for i in range(s):
            diagonal = B[i] if i < 2 else B[stage_block_index(i, i, s)]
            write_jacobian(points[1 + k * s + i], V[k, i], diagonal, tip, p.rod, p.node_matrices)
            for r in range(n):
                for q in range(n):
                    # Diagonal block d_ii M - h F'. Column 0 of d is for the start of the interval, so stage i
                    # has the column i + 1.
                    diagonal[r, q] *= -h
                diagonal[r, r] += p.stage_differentiation_matrix[i, i + 1] * p.mass_diagonal[r]
        _eliminate_interval(B, right_matrices, parts, p)
        # The effect of the start on the end and on the later stages is stored for `substitute_stages`.
        square_matrix_product(
            B[stage_block_index(s - 1, s - 1, s)], right_matrices[s - 1], B[INTERVAL_MAP], 1.0, 0.0
        )
        for a in range(2, s - 1):
            B[start_to_stage_block_index(a)] = right_matrices[a]
        reduce_right_sides(B, columns[k], p)
        map_start_to_end(B, columns[k], p, ends)
        # `right_matrices` was computed for x_0 = M^-1, so that B[INTERVAL_MAP] acts on M x_0: M is between
        # the maps of two intervals.
        square_matrix_product(B[INTERVAL_MAP], so_far, factors.propagator, 1.0, 0.0)
        for r in range(n):
            for q in range(n):
                so_far[r, q] = p.mass_diagonal[r] * factors.propagator[r, q]
    return ends


@compiled_with_reordered_sums
def _eliminate_interval(B: Array, right_matrices: Array, parts: Array, p: OrbitEquations) -> None:
    """Eliminates the blocks B of one interval, (blocks, n, n), whose diagonal blocks are given, stage by
    stage. p: equations of the orbit.

    right_matrices: output, (s, n, n). For each stage from the third on: the matrix whose product with M x_0,
    x_0 the state at the start, is the right-hand side of this stage. parts: work array, (5, n, n).
    """
    s = len(right_matrices)
    n = B.shape[2]
    pivots = np.empty(n, np.int64)
    rows = np.empty((n, INVERSION_SETTINGS.panel_width))
    end = np.empty((n, n))
    d = p.stage_differentiation_matrix
    mass = p.mass_diagonal
    Z = parts[0]
    invert_matrix(B[FIRST_STAGE], pivots, rows)
    # Schur complement of the second stage. It needs no product of matrices, because both off-diagonal blocks
    # are multiples of M.
    factor = d[1, 1] * d[0, 2]
    for r in range(n):
        for q in range(n):
            Z[r, q] = mass[r] * B[FIRST_STAGE, r, q]
            B[SECOND_STAGE, r, q] -= factor * Z[r, q] * mass[q]
    invert_matrix(B[SECOND_STAGE], pivots, rows)
    _eliminate_first_two_stages(B, right_matrices, parts, p)
    for a in range(2, s):
        pivot = B[stage_block_index(a, a, s)]
        invert_matrix(pivot, pivots, rows)
        for i in range(a + 1, s):
            square_matrix_product(B[stage_block_index(i, a, s)], pivot, end, 1.0, 0.0)
            B[stage_block_index(i, a, s)] = end
            for j in range(a + 1, s):
                square_matrix_product(
                    end, B[stage_block_index(a, j, s)], B[stage_block_index(i, j, s)], -1.0, 1.0
                )
            square_matrix_product(end, right_matrices[a], right_matrices[i], -1.0, 1.0)


@compiled_with_reordered_sums
def _eliminate_first_two_stages(B: Array, right_matrices: Array, parts: Array, p: OrbitEquations) -> None:
    """Eliminates the first two stages: computes the blocks of all later stages in B, (blocks, n, n), and
    their matrices in `right_matrices` (see `_eliminate_interval`). p: equations.

    parts: Z, W, Z W, W Z and Z W Z of the module docstring, (5, n, n); Z is given, the remaining products are
    computed.
    """
    s = len(right_matrices)
    n = B.shape[2]
    d = p.stage_differentiation_matrix
    mass = p.mass_diagonal
    # For x_0 = M^-1 the columns of `right_matrices` have the factor -1 instead of M.
    minus = -np.ones(n)
    Z = parts[0]
    W = parts[1]
    ZW = parts[2]
    for r in range(n):
        for q in range(n):
            W[r, q] = mass[r] * B[SECOND_STAGE, r, q]
    square_matrix_product(Z, W, ZW, 1.0, 0.0)
    square_matrix_product(W, Z, parts[3], 1.0, 0.0)
    square_matrix_product(ZW, Z, parts[4], 1.0, 0.0)
    for i in range(2, s):
        right_matrices[i] = 0.0
        for j in range(2, s):
            if i != j:
                B[stage_block_index(i, j, s)] = 0.0
    # A group of rows stays in the cache while all later stages use it.
    for first in range(0, n, INVERSION_SETTINGS.rows_in_cache):
        last = min(n, first + INVERSION_SETTINGS.rows_in_cache)
        for i in range(2, s):
            _subtract_first_stage_terms(right_matrices[i], parts, (i, 0), (first, last), d, minus)
            for j in range(2, s):
                _subtract_first_stage_terms(
                    B[stage_block_index(i, j, s)], parts, (i, j + 1), (first, last), d, mass
                )
    for i in range(2, s):
        for r in range(n):
            right_matrices[i, r, r] -= d[i, 0]
            for j in range(2, s):
                B[stage_block_index(i, j, s), r, r] += d[i, j + 1] * mass[r] if i != j else 0.0


@compiled_with_reordered_sums
def _subtract_first_stage_terms(
    out: Array, parts: Array, place: tuple[int, int], rows: tuple[int, int], d: Array, scale: Array
) -> None:
    """Subtracts from the block `out` of a later stage, (n, n), the terms from the elimination of the first
    two stages.

    parts: Z, W, Z W, W Z and Z W Z of the module docstring, (5, n, n). place: (stage, column of d) of the
    block. d: differentiation matrix, (s, s + 1). rows: first row, and last row plus 1. scale: factors of the
    columns of the block, (n,).
    """
    i, c = place
    first = d[0, c]
    second = d[1, c]
    z = d[i, 1] * first
    w = d[i, 2] * second
    zw = -d[i, 1] * d[0, 2] * second
    wz = -d[i, 2] * d[1, 1] * first
    zwz = d[i, 1] * d[0, 2] * d[1, 1] * first
    for r in range(rows[0], rows[1]):
        Z = parts[0, r]
        W = parts[1, r]
        ZW = parts[2, r]
        WZ = parts[3, r]
        ZWZ = parts[4, r]
        for q in range(len(scale)):
            left = z * Z[q] + w * W[q] + zw * ZW[q] + wz * WZ[q] + zwz * ZWZ[q]
            out[r, q] -= left * scale[q]
