"""Solution of linear systems with an eliminated matrix (`elimination`), compiled, for several right-hand
sides.

The first two stages of an interval need only the inverses of their diagonal blocks; later stages need all
blocks of the interval, B: (blocks, n, n), one interval's part of `NewtonFactors.eliminated_blocks`.
"""

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled_with_reordered_sums
from ..equations import OrbitEquations
from .workspace import (
    FIRST_STAGE,
    INTERVAL_MAP,
    SECOND_STAGE,
    NewtonFactors,
    stage_block_index,
    start_to_stage_block_index,
)


@compiled_with_reordered_sums
def reduce_right_sides(B: Array, columns: Array, p: OrbitEquations) -> None:
    """Reduces k right-hand sides of one interval, `columns`, (s, k, n), in place. The right-hand sides of the
    first two stages are unchanged. The right-hand side of the last stage becomes the increment of the state
    at the interval's end for a fixed start. B: eliminated blocks of the interval, (blocks, n, n). p:
    equations."""
    s, count, n = columns.shape
    d = p.stage_differentiation_matrix
    mass = p.mass_diagonal
    t = np.empty((count, n))
    u = np.empty((count, n))
    _write_first_two_stages(B, columns, p, t, u)
    for i in range(2, s):
        for m in range(count):
            for r in range(n):
                columns[i, m, r] -= mass[r] * (d[i, 1] * t[m, r] + d[i, 2] * u[m, r])
        for a in range(2, i):
            add_products(B[stage_block_index(i, a, s)], columns[a], columns[i], -1.0)
    # Only the last stage is solved here, because the next interval needs only the end of this interval.
    t[:] = columns[s - 1]
    columns[s - 1] = 0.0
    add_products(B[stage_block_index(s - 1, s - 1, s)], t, columns[s - 1], 1.0)


@compiled_with_reordered_sums
def map_start_to_end(B: Array, columns: Array, p: OrbitEquations, ends: Array) -> None:
    """Replaces `ends`, the increments of the state at the start of an interval, (k, n), by the increments at
    its end. B: eliminated blocks of the interval, (blocks, n, n). columns: reduced right-hand sides of the
    stages, (s, k, n). p: equations."""
    # The eliminated map of an interval acts on M x_0, not on x_0.
    scaled_ends = ends * p.mass_diagonal
    ends[:] = columns[-1]
    add_products(B[INTERVAL_MAP], scaled_ends, ends, 1.0)


@compiled_with_reordered_sums
def _write_first_two_stages(B: Array, y: Array, p: OrbitEquations, t: Array, u: Array) -> None:
    """Writes the increments of the first two stages into t and u, (k, n). B: eliminated blocks, (blocks, n,
    n). y: right-hand sides, of which only the first two stages are used, (s, k, n). The increments of later
    stages are taken as 0."""
    d = p.stage_differentiation_matrix
    mass = p.mass_diagonal
    (count, n) = t.shape
    side = np.empty((count, n))
    t[:] = 0.0
    u[:] = 0.0
    add_products(B[FIRST_STAGE], y[0], t, 1.0)
    for m in range(count):
        for r in range(n):
            side[m, r] = y[1, m, r] - d[1, 1] * mass[r] * t[m, r]
    # B[SECOND_STAGE] is the inverse of the Schur complement. The coupling of t to u is subtracted below.
    add_products(B[SECOND_STAGE], side, u, 1.0)
    for m in range(count):
        for r in range(n):
            side[m, r] = d[0, 2] * mass[r] * u[m, r]
    add_products(B[FIRST_STAGE], side, t, -1.0)


@compiled_with_reordered_sums
def add_products(A: Array, x: Array, y: Array, factor: float) -> None:
    """Adds `factor` A x to y, in place, for k columns x; x, y: (k, n), A: (n, n)."""
    count, n = x.shape
    # Two columns at a time, so that each entry of A is loaded once for both: memory access limits the speed.
    for m in range(0, count - 1, 2):
        for i in range(n):
            first = 0.0
            second = 0.0
            for j in range(n):
                first += A[i, j] * x[m, j]
                second += A[i, j] * x[m + 1, j]
            y[m, i] += factor * first
            y[m + 1, i] += factor * second
    if count % 2:
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += A[i, j] * x[count - 1, j]
            y[count - 1, i] += factor * total


@compiled_with_reordered_sums
def substitute_stages(
    initial_increment: Array, columns: Array, p: OrbitEquations, factors: NewtonFactors, out: Array
) -> None:
    """Writes the Newton increments of all stages into `out`, (K, s, k, n), for k right-hand sides.

    initial_increment: increments of the state at t = 0, (k, n). columns: reduced right-hand sides, (K, s, k,
    n). factors: eliminated matrix. p: equations."""
    K, s, count, n = columns.shape
    y = np.empty((2, count, n))
    first = initial_increment.copy()
    scaled_increment = np.empty((count, n))
    d = p.stage_differentiation_matrix
    mass = p.mass_diagonal
    for k in range(K):
        B = factors.eliminated_blocks[k]
        for m in range(count):
            for r in range(n):
                scaled_increment[m, r] = mass[r] * first[m, r]
                for i in range(2):
                    y[i, m, r] = columns[k, i, m, r] - d[i, 0] * scaled_increment[m, r]
        # In reverse order, because a stage depends on the later stages.
        for a in range(s - 1, 1, -1):
            _substitute_stage(B, a, columns[k], scaled_increment, out[k])
            for m in range(count):
                for r in range(n):
                    for i in range(2):
                        y[i, m, r] -= d[i, a + 1] * mass[r] * out[k, a, m, r]
        _write_first_two_stages(B, y, p, out[k, 0], out[k, 1])
        first[:] = out[k, s - 1]


@compiled_with_reordered_sums
def _substitute_stage(B: Array, a: int, columns: Array, scaled_increment: Array, out: Array) -> None:
    """Writes the increments of stage number a, counted from 0, a >= 2, into out[a]. B: eliminated blocks,
    (blocks, n, n). columns: reduced right-hand sides, (s, k, n). scaled_increment: M times the increments of
    the state at the start, (k, n). out: increments of all stages, (s, k, n), in which the increments of later
    stages are given."""
    s = len(columns)
    out[a] = 0.0
    # `reduce_right_sides` has solved the last stage for a fixed start; the effect of the start is added.
    if a == s - 1:
        out[a] = columns[a]
        add_products(B[INTERVAL_MAP], scaled_increment, out[a], 1.0)
        return
    side = columns[a].copy()
    add_products(B[start_to_stage_block_index(a)], scaled_increment, side, 1.0)
    for j in range(a + 1, s):
        add_products(B[stage_block_index(a, j, s)], out[j], side, -1.0)
    add_products(B[stage_block_index(a, a, s)], side, out[a], 1.0)
