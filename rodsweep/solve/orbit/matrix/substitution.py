"""Solutions with an eliminated matrix (`elimination`), compiled, for several right sides at once.

The first two stages of an interval need their inverses only; the other stages need the interval's blocks.
"""

import numpy as np

from ....arrays import Array
from ....model.compiled.compilation import compiled_for_vectors
from ..semidiscrete import Semidiscrete
from .workspace import Factors


@compiled_for_vectors
def reduce(B: Array, columns: Array, p: Semidiscrete) -> None:
    """Reduces the right sides of one interval, (s, columns, n), in place; those of the first two stages stay.

    The last stage's right side becomes the change of the interval's end for a fixed start.
    """
    s, count, n = columns.shape
    d = p.differentiation
    mass = p.mass
    t = np.empty((count, n))
    u = np.empty((count, n))
    _first_two(B, columns, p, t, u)
    for i in range(2, s):
        for m in range(count):
            for r in range(n):
                columns[i, m, r] -= mass[r] * (d[i, 1] * t[m, r] + d[i, 2] * u[m, r])
        for a in range(2, i):
            add_products(B[i, a], columns[a], columns[i], -1.0)
    # The last stage is solved for at once: the end of the interval is all that the next one needs.
    t[:] = columns[s - 1]
    columns[s - 1] = 0.0
    add_products(B[s - 1, s - 1], t, columns[s - 1], 1.0)


@compiled_for_vectors
def to_end(B: Array, columns: Array, p: Semidiscrete, ends: Array) -> None:
    """Replaces `ends`, changes of an interval's start, (columns, n), by the changes of its end.

    columns: reduced right sides of the stages.
    """
    # The map of an interval acts on M x_0, as in `eliminate`.
    scaled = ends * p.mass
    ends[:] = columns[-1]
    add_products(B[0, 1], scaled, ends, 1.0)


@compiled_for_vectors
def _first_two(B: Array, y: Array, p: Semidiscrete, t: Array, u: Array) -> None:
    """First two stages, t and u, (columns, n), for right sides y, (s, columns, n), and other stages of 0."""
    d = p.differentiation
    mass = p.mass
    (count, n) = t.shape
    side = np.empty((count, n))
    t[:] = 0.0
    u[:] = 0.0
    add_products(B[0, 0], y[0], t, 1.0)
    for m in range(count):
        for r in range(n):
            side[m, r] = y[1, m, r] - d[1, 1] * mass[r] * t[m, r]
    # B[1, 1] holds the inverse of the Schur complement; t still lacks the coupling to u, subtracted below.
    add_products(B[1, 1], side, u, 1.0)
    for m in range(count):
        for r in range(n):
            side[m, r] = d[0, 2] * mass[r] * u[m, r]
    add_products(B[0, 0], side, t, -1.0)


@compiled_for_vectors
def add_products(A: Array, x: Array, y: Array, factor: float) -> None:
    """Adds factor A x to y for columns x and y, (columns, n) each, two columns at a time."""
    count, n = x.shape
    # Each entry of A is loaded once for two columns: the product is bound by memory, not by arithmetic.
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


@compiled_for_vectors
def substitute(start: Array, columns: Array, p: Semidiscrete, factors: Factors, out: Array) -> None:
    """Changes of all stages, into out, from changes of the start and reduced right sides.

    start: (columns, n); columns and out: (K, s, columns, n).
    """
    K, s, count, n = columns.shape
    y = np.empty((2, count, n))
    first = start.copy()
    scaled = np.empty((count, n))
    d = p.differentiation
    mass = p.mass
    for k in range(K):
        B = factors.blocks[k]
        for m in range(count):
            for r in range(n):
                scaled[m, r] = mass[r] * first[m, r]
                for i in range(2):
                    y[i, m, r] = columns[k, i, m, r] - d[i, 0] * scaled[m, r]
        # Backwards: a stage depends on the later ones, whose blocks were eliminated after it.
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
    """Stage a >= 2 (the third or a later one), into out, from reduced right sides, (s, columns, n) both.

    scaled: M times the changes of the start, (columns, n).
    """
    s = len(B)
    out[a] = 0.0
    # The last stage was solved for in `reduce`; only the effect of the start is missing.
    if a == s - 1:
        out[a] = columns[a]
        add_products(B[0, 1], scaled, out[a], 1.0)
        return
    side = columns[a].copy()
    add_products(B[0, a], scaled, side, 1.0)
    for j in range(a + 1, s):
        add_products(B[a, j], out[j], side, -1.0)
    add_products(B[a, a], side, out[a], 1.0)
