"""The linear systems of a periodic orbit, condensed: Newton's matrix of a Radau collocation, compiled.

On each of the intervals, from the state x_0 at its start, the stages x_1 ... x_s satisfy

    sum_j d_ij M x_j = h F(x_i),        j = 0 ... s,

with the method's differentiation matrix d (s is at least 3), the diagonal mass matrix M (0 where an unknown
has no time derivative) and the balance F. The blocks of Newton's matrix off its diagonal are d_ij M: diagonal
matrices. So the first stage is eliminated at the price of an inverse X, the second at that of an inverse Y
and three products, for all that both leave of the other blocks is a combination of Z = M X, W = M Y, Z W, W Z
and Z W Z. The others are eliminated by products of blocks, and the interval becomes a map of its start to its
end. The maps' product P is the derivative of the flow over all intervals. A block's pivots are its own; the
blocks on the diagonal, d_ii M - h F', are regular while h is short against what grows.
"""

from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...discretization.mesh import NodeMatrices
from ...discretization.nodal_rod import NodalRod
from ...discretization.plane import balance, jacobian
from ...model.compilation import compiled_for_vectors
from ..backend.products import product, square_product

PANEL = 12
"""Columns that `invert` treats one by one before it updates the others by a product."""
LEAST_PIVOT = 0.1
"""Pivots smaller than this share of the largest in their column are exchanged for it."""
ROWS = 8
"""Rows of several blocks that stay in the fastest memory together."""


class Semidiscrete(NamedTuple):
    """The rod on its mesh, the method in time, and how an orbit closes.

    mass (n,); differentiation (s, s + 1); lengths: of the intervals, of sum 1, (K,); symmetry: S, by which
    the state has changed at the end, (n, n); parts: of the period that are equal but for it, 1 or 2.
    """

    rod: NodalRod
    matrices: NodeMatrices
    mass: Array
    differentiation: Array
    lengths: Array
    symmetry: Array
    parts: float


class Factors(NamedTuple):
    """Newton's matrix of all K intervals, eliminated.

    blocks: (K, s, s, n, n), inverses of the pivots on the diagonal, multipliers below, what is left above;
    of the first two rows and columns nothing is left, and the first row has what x_0 = M^-1 makes of the end,
    at column 1, and of the right sides of the stages from the third to the last but one, at their columns.
    propagator: P, (n, n). inverse: of the matrix that is left for start and period, (n + 1, n + 1).
    """

    blocks: Array
    propagator: Array
    inverse: Array


@compiled_for_vectors
def invert(A: Array, pivots: Any, rows: Array) -> None:
    """A^-1 in place, by Gauss and Jordan with partial pivoting, PANEL columns at a time.

    A: (n, n); work arrays: pivots (n,) of integers, rows (n, PANEL). A row of A is read as a column of its
    transpose, whose inverse is the transpose of the inverse.
    """
    n = len(A)
    ones, extents = np.ones(2), np.empty(6, np.int32)
    for first in range(0, n, PANEL):
        last = min(n, first + PANEL)
        _sweep_panel(A, first, last, pivots)
        for j in range(n):
            if j < first or j >= last:
                for i in range(last - first):
                    rows[j, i] = A[j, first + i]
                    A[j, first + i] = 0.0
        extents[:] = first, n, last - first, PANEL, n, n
        panel, row = A.ctypes.data + 8 * n * first, 8 * n * last
        product(rows.ctypes.data, panel, A.ctypes.data, extents, ones)
        extents[0] = n - last
        product(rows.ctypes.data + 8 * PANEL * last, panel, A.ctypes.data + row, extents, ones)
    for k in range(n - 1, -1, -1):
        if pivots[k] != k:
            p = pivots[k]
            for i in range(n):
                A[k, i], A[p, i] = A[p, i], A[k, i]


@compiled_for_vectors
def _sweep_panel(A: Array, first: int, last: int, pivots: Any) -> None:
    """The steps of Gauss and Jordan for the columns from first to last, within these."""
    n = len(A)
    for k in range(first, last):
        row, largest, p = A[k], 0.0, k
        for i in range(k, n):
            largest = max(largest, abs(row[i]))
        if abs(row[k]) < LEAST_PIVOT * largest:
            for i in range(k, n):
                if abs(row[i]) == largest:
                    p = i
        pivots[k] = p
        if p != k:
            for j in range(n):
                A[j, k], A[j, p] = A[j, p], A[j, k]
        inverse = 1.0 / row[k]
        for i in range(n):
            row[i] *= -inverse
        for j in range(first, last):
            if j != k:
                factor = A[j, k]
                for i in range(n):
                    A[j, i] += factor * row[i]
                A[j, k] = factor * inverse
        row[k] = inverse


@compiled_for_vectors
def eliminate(
    points: Array, V: Array, duration: float, p: Semidiscrete, factors: Factors, columns: Array
) -> Array:
    """Newton's matrix at the points, (1 + K s, n), into the factors; raises nothing.

    V: of the stages, (K, s, 3, nodes + 1). columns: right sides, (K, s, columns, n), which become `reduced`.
    Returns what they make of the last end where the start stays, (columns, n).
    """
    K, s, n = columns.shape[0], columns.shape[1], columns.shape[3]
    tip, right, parts = np.empty((3, n)), np.empty((s, n, n)), np.empty((5, n, n))
    so_far, ends = np.diag(p.mass), np.zeros(columns.shape[2:])
    for k in range(K):
        B, h = factors.blocks[k], duration * p.lengths[k]
        for i in range(s):
            jacobian(points[1 + k * s + i], V[k, i], B[i, i], tip, p.rod, p.matrices)
            for r in range(n):
                for q in range(n):
                    B[i, i, r, q] *= -h
                B[i, i, r, r] += p.differentiation[i, i + 1] * p.mass[r]
        _eliminate_interval(B, right, parts, p)
        square_product(B[s - 1, s - 1], right[s - 1], B[0, 1], 1.0, 0.0)
        for a in range(2, s - 1):
            B[0, a] = right[a]
        reduce(B, columns[k], p)
        to_end(B, columns[k], p, ends)
        square_product(B[0, 1], so_far, factors.propagator, 1.0, 0.0)
        for r in range(n):
            for q in range(n):
                so_far[r, q] = p.mass[r] * factors.propagator[r, q]
    return ends


@compiled_for_vectors
def _eliminate_interval(B: Array, right: Array, parts: Array, p: Semidiscrete) -> None:
    """The blocks of one interval, (s, s, n, n), of which the diagonal is given; right side for x_0 = M^-1.

    parts: work array, (5, n, n).
    """
    s, n = B.shape[0], B.shape[2]
    pivots, rows = np.empty(n, np.int64), np.empty((n, PANEL))
    end, d, mass, Z = np.empty((n, n)), p.differentiation, p.mass, parts[0]
    invert(B[0, 0], pivots, rows)
    factor = d[1, 1] * d[0, 2]
    for r in range(n):
        for q in range(n):
            Z[r, q] = mass[r] * B[0, 0, r, q]
            B[1, 1, r, q] -= factor * Z[r, q] * mass[q]
    invert(B[1, 1], pivots, rows)
    _eliminate_two(B, right, parts, p)
    for a in range(2, s):
        invert(B[a, a], pivots, rows)
        for i in range(a + 1, s):
            square_product(B[i, a], B[a, a], end, 1.0, 0.0)
            B[i, a] = end
            for j in range(a + 1, s):
                square_product(end, B[a, j], B[i, j], -1.0, 1.0)
            square_product(end, right[a], right[i], -1.0, 1.0)


@compiled_for_vectors
def _eliminate_two(B: Array, right: Array, parts: Array, p: Semidiscrete) -> None:
    """The first two stages out of one interval's others: their blocks, and their right side for x_0 = M^-1.

    parts: (5, n, n), of which the first is M X; the others are made.
    """
    s, n = B.shape[0], B.shape[2]
    d, mass, minus = p.differentiation, p.mass, -np.ones(n)
    Z, W, ZW = parts[0], parts[1], parts[2]
    for r in range(n):
        for q in range(n):
            W[r, q] = mass[r] * B[1, 1, r, q]
    square_product(Z, W, ZW, 1.0, 0.0)
    square_product(W, Z, parts[3], 1.0, 0.0)
    square_product(ZW, Z, parts[4], 1.0, 0.0)
    for i in range(2, s):
        right[i] = 0.0
        for j in range(2, s):
            if i != j:
                B[i, j] = 0.0
    for first in range(0, n, ROWS):
        last = min(n, first + ROWS)
        for i in range(2, s):
            _subtract_parts(right[i], parts, (i, 0), (first, last), d, minus)
            for j in range(2, s):
                _subtract_parts(B[i, j], parts, (i, j + 1), (first, last), d, mass)
    for i in range(2, s):
        for r in range(n):
            right[i, r, r] -= d[i, 0]
            for j in range(2, s):
                B[i, j, r, r] += d[i, j + 1] * mass[r] if i != j else 0.0


@compiled_for_vectors
def _subtract_parts(
    out: Array, parts: Array, place: tuple[int, int], rows: tuple[int, int], d: Array, scale: Array
) -> None:
    """What the first two stages leave in the equations of another one out of rows of a block, (n, n).

    parts: Z, W, Z W, W Z and Z W Z, (5, n, n); place: the stage, and the column of d, (s, s + 1), that the
    block is of; rows: from one to another; scale: of the block's columns, (n,).
    """
    i, c = place
    first, second = d[0, c], d[1, c]
    z, w = d[i, 1] * first, d[i, 2] * second
    zw, wz = -d[i, 1] * d[0, 2] * second, -d[i, 2] * d[1, 1] * first
    zwz = d[i, 1] * d[0, 2] * d[1, 1] * first
    for r in range(rows[0], rows[1]):
        Z, W, ZW, WZ, ZWZ = parts[0, r], parts[1, r], parts[2, r], parts[3, r], parts[4, r]
        for q in range(len(scale)):
            left = z * Z[q] + w * W[q] + zw * ZW[q] + wz * WZ[q] + zwz * ZWZ[q]
            out[r, q] -= left * scale[q]


@compiled_for_vectors
def reduce(B: Array, columns: Array, p: Semidiscrete) -> None:
    """Right sides of one interval, (s, columns, n), in place: those of the first two stages stay.

    The others are what elimination leaves, but the last ones what all make of its end where its start stays.
    """
    s, count, n = columns.shape
    d, mass = p.differentiation, p.mass
    t, u = np.empty((count, n)), np.empty((count, n))
    _first_two(B, columns, p, t, u)
    for i in range(2, s):
        for m in range(count):
            for r in range(n):
                columns[i, m, r] -= mass[r] * (d[i, 1] * t[m, r] + d[i, 2] * u[m, r])
        for a in range(2, i):
            add_products(B[i, a], columns[a], columns[i], -1.0)
    t[:] = columns[s - 1]
    columns[s - 1] = 0.0
    add_products(B[s - 1, s - 1], t, columns[s - 1], 1.0)


@compiled_for_vectors
def to_end(B: Array, columns: Array, p: Semidiscrete, ends: Array) -> None:
    """From changes of the start of one interval to its end, in place, (columns, n), for reduced columns."""
    scaled = ends * p.mass
    ends[:] = columns[-1]
    add_products(B[0, 1], scaled, ends, 1.0)


@compiled_for_vectors
def _first_two(B: Array, y: Array, p: Semidiscrete, t: Array, u: Array) -> None:
    """The first two stages, t and u, (columns, n), for right sides y, (s, columns, n), where others are 0."""
    d, mass, (count, n) = p.differentiation, p.mass, t.shape
    side = np.empty((count, n))
    t[:], u[:] = 0.0, 0.0
    add_products(B[0, 0], y[0], t, 1.0)
    for m in range(count):
        for r in range(n):
            side[m, r] = y[1, m, r] - d[1, 1] * mass[r] * t[m, r]
    add_products(B[1, 1], side, u, 1.0)
    for m in range(count):
        for r in range(n):
            side[m, r] = d[0, 2] * mass[r] * u[m, r]
    add_products(B[0, 0], side, t, -1.0)


@compiled_for_vectors
def add_products(A: Array, x: Array, y: Array, factor: float) -> None:
    """y += factor A x for each of the columns x, y, both of shape (columns, n); two columns at a time."""
    count, n = x.shape
    for m in range(0, count - 1, 2):
        for i in range(n):
            first, second = 0.0, 0.0
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


@compiled_for_vectors
def substitute(start: Array, columns: Array, p: Semidiscrete, factors: Factors, out: Array) -> None:
    """The changes of all stages, out, for changes of the start and reduced columns; several at once.

    start: (columns, n), columns and out: (K, s, columns, n).
    """
    K, s, count, n = columns.shape
    y, first, scaled = np.empty((2, count, n)), start.copy(), np.empty((count, n))
    d, mass = p.differentiation, p.mass
    for k in range(K):
        B = factors.blocks[k]
        for m in range(count):
            for r in range(n):
                scaled[m, r] = mass[r] * first[m, r]
                for i in range(2):
                    y[i, m, r] = columns[k, i, m, r] - d[i, 0] * scaled[m, r]
        for a in range(s - 1, 1, -1):
            _back_to(B, a, columns[k], scaled, out[k])
            for m in range(count):
                for r in range(n):
                    for i in range(2):
                        y[i, m, r] -= d[i, a + 1] * mass[r] * out[k, a, m, r]
        _first_two(B, y, p, out[k, 0], out[k, 1])
        first[:] = out[k, s - 1]


@compiled_for_vectors
def _back_to(B: Array, a: int, columns: Array, scaled: Array, out: Array) -> None:
    """Stage a, the third or a later one, into out, for reduced columns, both (s, columns, n).

    scaled: M times the changes of the start, (columns, n).
    """
    s = len(B)
    out[a] = 0.0
    if a == s - 1:
        out[a] = columns[a]
        add_products(B[0, 1], scaled, out[a], 1.0)
        return
    side = columns[a].copy()
    add_products(B[0, a], scaled, side, 1.0)
    for j in range(a + 1, s):
        add_products(B[a, j], out[j], side, -1.0)
    add_products(B[a, a], side, out[a], 1.0)


@compiled_for_vectors
def strain_rates(states: Array, out: Array, p: Semidiscrete) -> None:
    """dE/dt at all nodes but the tip, where it vanishes, of states (m, n) into out, (3, m, nodes + 1)."""
    size = len(p.matrices.weights)
    V, G = np.empty((3, size)), np.empty((3, size))
    for k in range(len(states)):
        balance(states[k], V, G, p.rod, p.matrices)
        for a in range(3):
            for i in range(size - 1):
                out[a, k, i] = G[a, i] / p.matrices.weights[i]
            out[a, k, size - 1] = 0.0


@compiled_for_vectors
def powers(states: Array, out: Array, p: Semidiscrete) -> None:
    """Power of the follower force, by the reaction, and power lost, of states (m, n) into out, (2, m)."""
    size = len(p.matrices.weights)
    V, G, c = np.empty((3, size)), np.empty((3, size)), p.rod
    for k in range(len(states)):
        balance(states[k], V, G, c, p.matrices)
        gained, lost = 0.0, 0.0
        for a in range(len(V)):
            gained -= c.tip_stress[a] * G[a, size - 1]
            for i in range(size):
                lost += p.matrices.weights[i] * c.drag[a, i] * V[a, i] ** 2
        out[0, k], out[1, k] = gained, lost
