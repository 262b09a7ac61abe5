"""D(w) of an arm from the propagators of its elements, by continuous orthonormalisation from clamp to tip.

D is the determinant of the (s, m) x (s, m) block of the product of all propagators. The product itself loses
all digits where exponentials grow; its action on the plane of the two clamped solutions does not. The two
columns that span the plane are orthonormalised after each element; the factor R of this QR decomposition has
a real positive determinant, whose logarithm is summed. The derivative of the columns with respect to w is
projected onto the complement of the plane; the trace of the removed part is a logarithmic derivative of D,
and is summed too. Without the projection the derivative would grow like the fastest exponential and D' would
lose its digits.
"""

import math

import numpy as np

from ...arrays import Array, Complex
from ...model.compiled.compilation import compiled
from ..value import Value

UNIT = 4.440892098500626e-16
"""Unit of the noise of D: two relative rounding errors."""


@compiled
def _applied(polynomial: Array, z: complex, Q: Complex, T: Complex, out_Q: Complex, out_T: Complex) -> None:
    """out_Q = Phi Q and out_T = Phi T + Phi' Q at z, all (4, 2); polynomial: (terms, 4, 4)."""
    terms = polynomial.shape[0]
    for i in range(4):
        for k in range(2):
            out_Q[i, k] = 0.0
            out_T[i, k] = 0.0
        for j in range(4):
            value = complex(polynomial[terms - 1, i, j])
            slope = 0j
            for n in range(terms - 2, -1, -1):
                slope = slope * z + value
                value = value * z + polynomial[n, i, j]
            for k in range(2):
                out_Q[i, k] += value * Q[j, k]
                out_T[i, k] += value * T[j, k] + slope * Q[j, k]


@compiled
def _inner(A: Complex, i: int, B: Complex, j: int) -> complex:
    """The inner product of column i of A and column j of B, both (4, 2)."""
    total = 0j
    for row in range(4):
        total += A[row, i].conjugate() * B[row, j]
    return total


@compiled
def _orthonormal(Q: Complex, T: Complex) -> tuple[float, complex]:
    """Makes the columns of Q orthonormal and the columns of T orthogonal to Q, in place; both (4, 2).

    Returns (log det R of the factor removed from Q, trace of the part of T removed in the plane of Q).
    """
    # Q and its derivative T are both multiplied by R^-1.
    first = math.sqrt(_inner(Q, 0, Q, 0).real)
    for row in range(4):
        Q[row, 0] /= first
        T[row, 0] /= first
    overlap = _inner(Q, 0, Q, 1)
    for row in range(4):
        Q[row, 1] -= overlap * Q[row, 0]
        T[row, 1] -= overlap * T[row, 0]
    second = math.sqrt(_inner(Q, 1, Q, 1).real)
    for row in range(4):
        Q[row, 1] /= second
        T[row, 1] /= second
    trace = 0j
    for k in range(2):
        in_first = _inner(Q, 0, T, k)
        in_second = _inner(Q, 1, T, k)
        trace += in_first if k == 0 else in_second
        for row in range(4):
            T[row, k] -= in_first * Q[row, 0] + in_second * Q[row, 1]
    return math.log(first) + math.log(second), trace


@compiled
def chain_value(w: complex, W: float, polynomials: Array) -> Value:
    """D and D' = dD/dw times exp(-S), from propagators for |w| <= W, shape (elements, terms, 4, 4)."""
    z = w / W
    Q = np.zeros((4, 2), np.complex128)
    T = np.zeros((4, 2), np.complex128)
    next_Q = np.empty((4, 2), np.complex128)
    next_T = np.empty((4, 2), np.complex128)
    Q[2, 0] = Q[3, 1] = 1.0
    S = 0.0
    rate = 0j
    elements = polynomials.shape[0]
    for e in range(elements):
        _applied(polynomials[e], z, Q, T, next_Q, next_T)
        size, trace = _orthonormal(next_Q, next_T)
        S += size
        rate += trace
        Q, next_Q = next_Q, Q
        T, next_T = next_T, T
    D = Q[2, 0] * Q[3, 1] - Q[2, 1] * Q[3, 0]
    bend = T[2, 0] * Q[3, 1] + Q[2, 0] * T[3, 1] - T[2, 1] * Q[3, 0] - Q[2, 1] * T[3, 0]
    # `rate` is the logarithmic derivative of the determinants removed on the way.
    D_w = (bend + D * rate) / W
    return Value(D, D_w, S, (elements + 2) * UNIT)
