"""Nodes and weights of Gauss and Gauss-Lobatto-Legendre quadrature on [-1, 1]."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from ...arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class LobattoSettings:
    """Settings of Newton's method for the Lobatto and Gauss nodes."""

    max_steps: int = 50
    """Maximum number of Newton steps, in case rounding errors keep |step| above the tolerance."""
    tolerance: float = 4e-16
    """Newton's method stops when the largest |step| of all nodes is smaller than this."""


LOBATTO_SETTINGS = LobattoSettings()


@cache
def gauss_legendre_rule(n: int) -> tuple[Array, Array]:
    """Returns (nodes, weights), (n,) each, of the n-point Gauss-Legendre rule on [-1, 1], exact to degree
    2n - 1. The nodes are the zeros of P_n, by Newton's method. For n = 40, NumPy's `leggauss` loses four
    digits of the weights near the ends."""
    x = -np.cos(np.pi * (np.arange(n) + 0.75) / (n + 0.5))
    for _ in range(LOBATTO_SETTINGS.max_steps):
        P, Q = _two_highest_legendre_values(n, x)
        # (1 - x^2) P_n' = n (P_{n-1} - x P_n).
        step = P * (1 - x) * (1 + x) / (n * (Q - x * P))
        x = x - step
        if np.abs(step).max() < LOBATTO_SETTINGS.tolerance:
            break
    x = (x - x[::-1]) / 2
    P, Q = _two_highest_legendre_values(n, x)
    slope = n * (Q - x * P)
    # The last factor makes these the weights of the exact nodes: near the ends the rounding of a node would
    # change its weight by n^2 rounding errors.
    return x, 2 * (1 - x) * (1 + x) / slope**2 * (1 + 2 * x * P / slope)


@cache
def gauss_lobatto_rule(p: int) -> tuple[Array, Array]:
    """Returns (nodes, weights), (p + 1,) each, of the (p + 1)-point Lobatto rule on [-1, 1], exact to degree
    2p - 1. The inner nodes are the zeros of P_p', by Newton's method from Chebyshev points."""
    x = -np.cos(np.pi * np.arange(p + 1) / p)
    for _ in range(LOBATTO_SETTINGS.max_steps):
        # (1 - x^2) P_p' = p (P_{p-1} - x P_p) and its derivative -p (p + 1) P_p.
        P, Q = _two_highest_legendre_values(p, x)
        step = (x * P - Q) / ((p + 1) * P)
        x = x - step
        if np.abs(step).max() < LOBATTO_SETTINGS.tolerance:
            break
    # Nodes are exactly symmetric, so that mirror symmetry is preserved.
    x = (x - x[::-1]) / 2
    x[0] = -1.0
    x[-1] = 1.0
    return x, 2 / (p * (p + 1) * _two_highest_legendre_values(p, x)[0] ** 2)


def lobatto_points(node_count: int) -> Array:
    """Gauss-Lobatto points on [0, 1], (nodes,). node_count: number of points."""
    return (gauss_lobatto_rule(node_count - 1)[0] + 1) / 2


def _two_highest_legendre_values(p: int, x: Array) -> tuple[Array, Array]:
    """Returns (P_p(x), P_{p-1}(x)), Legendre polynomials at points x, (n,), by the three-term recurrence."""
    previous = np.ones_like(x)
    current = x.copy()
    for n in range(1, p):
        previous, current = current, ((2 * n + 1) * x * current - n * previous) / (n + 1)
    return current, previous
