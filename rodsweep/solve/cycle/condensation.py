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
from ...discretization.stress_balance import (
    BeamParameters,
    NodeMatrices,
    balance,
    jacobian,
    torque_balance,
)
from ...model.compilation import compiled_for_vectors
from ..backend.products import product, square_product

PANEL = 12
"""Columns that `invert` treats one by one before it updates the others by a product."""
LEAST_PIVOT = 0.1
"""Pivots smaller than this share of the largest in their column are exchanged for it."""


class Semidiscrete(NamedTuple):
    """The rod on its mesh, the method in time, and how an orbit closes.

    mass (n,); differentiation (s, s + 1); lengths: of the intervals, of sum 1, (K,); signs: what the state is
    multiplied with at the end, (n,); parts: of the period that are equal but for the signs, 1 or 2.
    """

    parameters: BeamParameters
    matrices: NodeMatrices
    mass: Array
    differentiation: Array
    lengths: Array
    signs: Array
    parts: float


class Factors(NamedTuple):
    """Newton's matrix of all K intervals, eliminated.

    blocks: (K, s, s, n, n), inverses of the pivots on the diagonal, multipliers below, what is left above;
    but for the pivots nothing is stored of the first two rows and columns. propagator: P, (n, n).
    inverse: of the matrix that is left for start and period, (n + 1, n + 1).
    """

    blocks: Array
    propagator: Array
    inverse: Array


@compiled_for_vectors
def equations(x: Array, F: Array, V: Array, G: Array, p: Semidiscrete) -> None:
    """F(x), shape (n,), with V and G, (3, nodes + 1), on the way."""
    nodes = G.shape[1] - 1
    balance(x, V, G, p.parameters, p.matrices)
    for a in range(3):
        for i in range(nodes):
            F[a * nodes + i] = G[a, i]
    if len(x) > 3 * nodes:
        torque_balance(x, F[3 * nodes :], p.parameters, p.matrices)


@compiled_for_vectors
def residuals(points: Array, duration: float, p: Semidiscrete, slopes: Array, out: Array) -> None:
    """h F(x_i) - sum_j d_ij M x_j into out, and F(x_i) into slopes; both as stages, (K, s, n).

    points: the start and the stages one after the other, (1 + K s, n).
    """
    K, s, n = out.shape
    V, G = np.empty((3, len(p.matrices.weights))), np.empty((3, len(p.matrices.weights)))
    d = p.differentiation
    for k in range(K):
        here, h = points[k * s : (k + 1) * s + 1], duration * p.lengths[k]
        for i in range(s):
            equations(here[i + 1], slopes[k, i], V, G, p)
            for r in range(n):
                change = 0.0
                for j in range(s + 1):
                    change += d[i, j] * here[j, r]
                out[k, i, r] = h * slopes[k, i, r] - p.mass[r] * change


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
def eliminate(points: Array, duration: float, p: Semidiscrete, factors: Factors, columns: Array) -> Array:
    """Newton's matrix at the points, (1 + K s, n), into the factors.

    columns: right sides, (K, s, columns, n). Returns what they make of the last end where the start stays,
    (columns, n).
    """
    K, s, n = columns.shape[0], columns.shape[1], columns.shape[3]
    size = len(p.matrices.weights)
    V, G, tip, F = np.empty((3, size)), np.empty((3, size)), np.empty((3, n)), np.empty(n)
    right, parts, end = np.empty((s, n, n)), np.empty((5, n, n)), np.empty((n, n))
    so_far, ends = np.diag(p.mass), np.zeros(columns.shape[2:])
    for k in range(K):
        B, h = factors.blocks[k], duration * p.lengths[k]
        for i in range(s):
            x = points[1 + k * s + i]
            equations(x, F, V, G, p)
            jacobian(x, V, B[i, i], tip, p.parameters, p.matrices)
            for r in range(n):
                for q in range(n):
                    B[i, i, r, q] *= -h
                B[i, i, r, r] += p.differentiation[i, i + 1] * p.mass[r]
        _eliminate_interval(B, right, parts, p)
        forward(B, columns[k], p, ends)
        square_product(B[s - 1, s - 1], right[s - 1], end, 1.0, 0.0)
        square_product(end, so_far, factors.propagator, 1.0, 0.0)
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
        _subtract_parts(right[i], parts, i, 0, d, minus)
        for j in range(2, s):
            if i != j:
                B[i, j] = 0.0
            _subtract_parts(B[i, j], parts, i, j + 1, d, mass)
        for r in range(n):
            right[i, r, r] -= d[i, 0]
            for j in range(2, s):
                B[i, j, r, r] += d[i, j + 1] * mass[r] if i != j else 0.0


@compiled_for_vectors
def _subtract_parts(out: Array, parts: Array, i: int, c: int, d: Array, scale: Array) -> None:
    """What the first two stages leave in the equations of stage i, of column c of d, out of a block, (n, n).

    parts: Z, W, Z W, W Z and Z W Z, (5, n, n); d: (s, s + 1); scale: of the block's columns, (n,).
    """
    n, first, second = len(out), d[0, c], d[1, c]
    z, w = d[i, 1] * first, d[i, 2] * second
    zw, wz = -d[i, 1] * d[0, 2] * second, -d[i, 2] * d[1, 1] * first
    zwz = d[i, 1] * d[0, 2] * d[1, 1] * first
    for r in range(n):
        Z, W, ZW, WZ, ZWZ = parts[0, r], parts[1, r], parts[2, r], parts[3, r], parts[4, r]
        for q in range(n):
            left = z * Z[q] + w * W[q] + zw * ZW[q] + wz * WZ[q] + zwz * ZWZ[q]
            out[r, q] -= left * scale[q]


@compiled_for_vectors
def forward(B: Array, columns: Array, p: Semidiscrete, ends: Array) -> None:
    """From what right sides, (s, columns, n), make of the start of one interval to its end; in place."""
    s, y = B.shape[0], np.empty(columns.shape)
    _downwards(B, columns, p, ends, y)
    ends[:] = 0.0
    _add_products(B[s - 1, s - 1], y[s - 1], ends, 1.0)


@compiled_for_vectors
def _downwards(B: Array, columns: Array, p: Semidiscrete, start: Array, y: Array) -> None:
    """The right sides of one interval, eliminated, into y; both (s, columns, n).

    start: changes at the interval's start, (columns, n). Those of the first two stages stay as they are.
    """
    d, mass = p.differentiation, p.mass
    t, u = np.empty(start.shape), np.empty(start.shape)
    for i in range(len(B)):
        y[i] = columns[i] - d[i, 0] * mass * start
    _first_two(B, y, p, t, u)
    for i in range(2, len(B)):
        y[i] -= mass * (d[i, 1] * t + d[i, 2] * u)
        for a in range(2, i):
            _add_products(B[i, a], y[a], y[i], -1.0)


@compiled_for_vectors
def _first_two(B: Array, y: Array, p: Semidiscrete, t: Array, u: Array) -> None:
    """The first two stages, t and u, (columns, n), for right sides y, (s, columns, n), where others are 0."""
    d, mass = p.differentiation, p.mass
    t[:], u[:] = 0.0, 0.0
    _add_products(B[0, 0], y[0], t, 1.0)
    _add_products(B[1, 1], y[1] - d[1, 1] * mass * t, u, 1.0)
    _add_products(B[0, 0], d[0, 2] * mass * u, t, -1.0)


@compiled_for_vectors
def _add_products(A: Array, x: Array, y: Array, factor: float) -> None:
    """y += factor A x for each of the columns x, y, both of shape (columns, n)."""
    n = x.shape[1]
    for i in range(n):
        for m in range(len(x)):
            total = 0.0
            for j in range(n):
                total += A[i, j] * x[m, j]
            y[m, i] += factor * total


@compiled_for_vectors
def substitute(start: Array, right: Array, p: Semidiscrete, factors: Factors, out: Array) -> None:
    """The changes of all stages, out, for changes of the start and right sides; several at once.

    start: (columns, n), right and out: (K, s, columns, n).
    """
    K, s, columns, n = right.shape
    y, first = np.empty((s, columns, n)), start.copy()
    d, mass = p.differentiation, p.mass
    for k in range(K):
        B = factors.blocks[k]
        _downwards(B, right[k], p, first, y)
        for a in range(s - 1, 1, -1):
            for j in range(a + 1, s):
                _add_products(B[a, j], out[k, j], y[a], -1.0)
            out[k, a] = 0.0
            _add_products(B[a, a], y[a], out[k, a], 1.0)
            y[0] -= d[0, a + 1] * mass * out[k, a]
            y[1] -= d[1, a + 1] * mass * out[k, a]
        _first_two(B, y, p, out[k, 0], out[k, 1])
        first[:] = out[k, s - 1]


@compiled_for_vectors
def strain_rates(states: Array, out: Array, p: Semidiscrete) -> None:
    """dE/dt at all nodes but the tip, where it vanishes, of states (m, n) into out, (3, m, nodes + 1)."""
    size = len(p.matrices.weights)
    V, G = np.empty((3, size)), np.empty((3, size))
    for k in range(len(states)):
        balance(states[k], V, G, p.parameters, p.matrices)
        for a in range(3):
            for i in range(size - 1):
                out[a, k, i] = G[a, i] / p.matrices.weights[i]
            out[a, k, size - 1] = 0.0


@compiled_for_vectors
def powers(states: Array, out: Array, p: Semidiscrete) -> None:
    """Power of the follower force, by the reaction, and power lost, of states (m, n) into out, (2, m)."""
    size = len(p.matrices.weights)
    V, G, c = np.empty((3, size)), np.empty((3, size)), p.parameters
    for k in range(len(states)):
        balance(states[k], V, G, c, p.matrices)
        lost = 0.0
        for i in range(size):
            drag = c.gamma1 * V[0, i] ** 2 + V[1, i] ** 2 + c.gamma3 * V[2, i] ** 2
            lost += p.matrices.weights[i] * drag
        out[0, k], out[1, k] = c.F * G[0, size - 1], lost
