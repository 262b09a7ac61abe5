"""D(w) of an arm from the propagators of its elements: two columns, kept orthonormal from clamp to tip.

D is the determinant of the (s, m) x (s, m) block of the product of all propagators. The product loses all
digits where exponentials grow, but its action on the plane of the two clamped solutions does not. After
each element the two columns are made orthonormal; the factor R of this QR decomposition has a real positive
determinant, whose logarithm is summed. The derivatives of the columns, by w and along a path of arms, are
projected onto the complement of their plane; the trace of the removed part is a logarithmic derivative of D
and is summed, too. Without the projection a derivative grows like the fastest exponential and D' loses its
digits.

Columns and propagators are stored as real and imaginary parts, so that loops over them are vector
instructions: a column is (real or imaginary, 4), a propagator (real or imaginary, 16), column by column.
"""

import math

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled, compiled_for_vectors
from ..parameter_path import ValueAlong
from ..value import Value

UNIT = 4.440892098500626e-16
"""Unit of the noise of D: two relative rounding errors."""
ROOT_NOISE = 1.5
"""Rounding error of D at a root, in units of its noise, beside `ROOT_RESIDUAL`. The noise lacks the errors of
propagators, of which D is a small part."""
ROOT_RESIDUAL = 2.0
"""Rounding error of D at a root, in units of the D that is found there, which is rounding itself. Of 3800
eigenvalues and 520 crossings of random arms, against 34 digits, two then miss by more than what is stated,
and none by twice as much."""
BY_W, BY_P = range(2)
"""Places of the derivatives of the columns."""


@compiled_for_vectors
def _propagator(polynomial: Array, z: complex, value: Array, slope: Array) -> None:
    """Phi and dPhi/dz at z, both (2, 16), of a polynomial, (terms, 16)."""
    x = z.real
    y = z.imag
    terms = polynomial.shape[0]
    for k in range(16):
        value[0, k] = polynomial[terms - 1, k]
        value[1, k] = slope[0, k] = slope[1, k] = 0.0
    for n in range(terms - 2, -1, -1):
        for k in range(16):
            real = slope[0, k] * x - slope[1, k] * y + value[0, k]
            slope[1, k] = slope[0, k] * y + slope[1, k] * x + value[1, k]
            slope[0, k] = real
            real = value[0, k] * x - value[1, k] * y + polynomial[n, k]
            value[1, k] = value[0, k] * y + value[1, k] * x
            value[0, k] = real


@compiled_for_vectors
def _propagator_alone(polynomial: Array, z: complex, value: Array) -> None:
    """Phi at z, (2, 16), of a polynomial, (terms, 16)."""
    x = z.real
    y = z.imag
    terms = polynomial.shape[0]
    for k in range(16):
        value[0, k] = polynomial[terms - 1, k]
        value[1, k] = 0.0
    for n in range(terms - 2, -1, -1):
        for k in range(16):
            real = value[0, k] * x - value[1, k] * y + polynomial[n, k]
            value[1, k] = value[0, k] * y + value[1, k] * x
            value[0, k] = real


@compiled_for_vectors
def _add_product(Phi: Array, x: Array, out: Array) -> None:
    """Adds Phi x to `out`; Phi: (2, 16), columns: (2, 4)."""
    for j in range(4):
        a = x[0, j]
        b = x[1, j]
        for i in range(4):
            out[0, i] += Phi[0, 4 * j + i] * a - Phi[1, 4 * j + i] * b
            out[1, i] += Phi[0, 4 * j + i] * b + Phi[1, 4 * j + i] * a


@compiled_for_vectors
def _inner(a: Array, b: Array) -> tuple[float, float]:
    """Real and imaginary part of the inner product of two columns, (2, 4)."""
    real = 0.0
    imag = 0.0
    for i in range(4):
        real += a[0, i] * b[0, i] + a[1, i] * b[1, i]
        imag += a[0, i] * b[1, i] - a[1, i] * b[0, i]
    return real, imag


@compiled_for_vectors
def _subtract(x: float, y: float, a: Array, out: Array) -> None:
    """Subtracts (x + i y) a from `out`, columns, (2, 4)."""
    for i in range(4):
        out[0, i] -= x * a[0, i] - y * a[1, i]
        out[1, i] -= x * a[1, i] + y * a[0, i]


@compiled_for_vectors
def _scale(factor: float, out: Array) -> None:
    """Multiplies a column, (2, 4), by a real number."""
    for i in range(4):
        out[0, i] *= factor
        out[1, i] *= factor


@compiled
def _orthonormal(Q: Array, T: Array, traces: Array) -> float:
    """Makes the columns of Q, (2, 2, 4), orthonormal and those of T, (changes, 2, 2, 4), orthogonal to them.

    Returns the logarithm of the determinant taken off Q. Adds the traces of what is taken off T in the plane
    of Q to `traces`, (changes, 2).
    """
    # X -> X R^-1 changes the derivatives alike.
    first = math.sqrt(_inner(Q[0], Q[0])[0])
    x, y = _inner(Q[0], Q[1])
    x = x / first**2
    y = y / first**2
    _subtract(x, y, Q[0], Q[1])
    second = math.sqrt(_inner(Q[1], Q[1])[0])
    _scale(1 / first, Q[0])
    _scale(1 / second, Q[1])
    for k in range(len(T)):
        _subtract(x, y, T[k, 0], T[k, 1])
        _scale(1 / first, T[k, 0])
        _scale(1 / second, T[k, 1])
        for column in range(2):
            a, b = _inner(Q[0], T[k, column])
            c, d = _inner(Q[1], T[k, column])
            traces[k, 0] += a if column == 0 else c
            traces[k, 1] += b if column == 0 else d
            _subtract(a, b, Q[0], T[k, column])
            _subtract(c, d, Q[1], T[k, column])
    return math.log(first * second)


@compiled
def _tip(Q: Array, row: int, column: int) -> complex:
    return complex(Q[column, 0, row], Q[column, 1, row])


@compiled
def _change_of_block(Q: Array, T: Array, D: complex, trace: Array) -> complex:
    """The derivative of the determinant D of the (s, m) rows; trace: (2,), as the frame of Q carries it."""
    bend = _tip(T, 2, 0) * _tip(Q, 3, 1) + _tip(Q, 2, 0) * _tip(T, 3, 1)
    bend -= _tip(T, 2, 1) * _tip(Q, 3, 0) + _tip(Q, 2, 1) * _tip(T, 3, 0)
    return bend + D * complex(trace[0], trace[1])


@compiled
def _swept(
    z: complex, W: float, polynomials: Array, changes: Array
) -> tuple[complex, complex, complex, float]:
    """(D, dD/dw, dD/dp, S) as of `chain_along`; no dD/dp where `changes` has no element."""
    elements = len(polynomials)
    along = 2 if len(changes) else 1
    Q = np.zeros((2, 2, 4))
    ahead = np.empty((2, 2, 4))
    T = np.zeros((along, 2, 2, 4))
    T_ahead = np.empty((along, 2, 2, 4))
    traces = np.zeros((along, 2))
    Phi = np.empty((2, 16))
    slope = np.empty((2, 16))
    change = np.empty((2, 16))
    unused = np.empty((2, 16))
    Q[0, 0, 2] = Q[1, 0, 3] = 1.0
    S = 0.0
    for e in range(elements):
        _propagator(polynomials[e], z, Phi, slope)
        ahead[:] = 0.0
        T_ahead[:] = 0.0
        for column in range(2):
            _add_product(Phi, Q[column], ahead[column])
            _add_product(Phi, T[BY_W, column], T_ahead[BY_W, column])
            _add_product(slope, Q[column], T_ahead[BY_W, column])
        if along == 2:
            _propagator(changes[e], z, change, unused)
            for column in range(2):
                _add_product(Phi, T[BY_P, column], T_ahead[BY_P, column])
                _add_product(change, Q[column], T_ahead[BY_P, column])
        S += _orthonormal(ahead, T_ahead, traces)
        Q, ahead = ahead, Q
        T, T_ahead = T_ahead, T
    D = _tip(Q, 2, 0) * _tip(Q, 3, 1) - _tip(Q, 2, 1) * _tip(Q, 3, 0)
    D_w = _change_of_block(Q, T[BY_W], D, traces[BY_W]) / W
    return D, D_w, _change_of_block(Q, T[BY_P], D, traces[BY_P]) if along == 2 else 0j, S


@compiled
def chain_size(w: complex, W: float, polynomials: Array) -> float:
    """log |D| at w, from propagators for |w| <= W, (elements, terms, 16); -inf where D is 0."""
    Q = np.zeros((2, 2, 4))
    ahead = np.empty((2, 2, 4))
    Phi = np.empty((2, 16))
    no_change = np.empty((0, 2, 2, 4))
    no_trace = np.empty((0, 2))
    Q[0, 0, 2] = Q[1, 0, 3] = 1.0
    S = 0.0
    for e in range(len(polynomials)):
        _propagator_alone(polynomials[e], w / W, Phi)
        ahead[:] = 0.0
        for column in range(2):
            _add_product(Phi, Q[column], ahead[column])
        S += _orthonormal(ahead, no_change, no_trace)
        Q, ahead = ahead, Q
    size = abs(_tip(Q, 2, 0) * _tip(Q, 3, 1) - _tip(Q, 2, 1) * _tip(Q, 3, 0))
    return S + math.log(size) if size > 0 else -math.inf


@compiled
def chain_value(w: complex, W: float, polynomials: Array) -> Value:
    """D and D' = dD/dw times exp(-S), from propagators for |w| <= W, shape (elements, terms, 16)."""
    D, D_w, _, S = _swept(w / W, W, polynomials, polynomials[:0])
    return Value(D, D_w, S, (len(polynomials) + 2) * UNIT)


@compiled
def chain_along(w: complex, W: float, polynomials: Array, changes: Array) -> ValueAlong:
    """D, dD/dw and dD/dp times exp(-S), from propagators and their derivatives by p.

    Both have the shape (elements, terms, 16) and hold for |w| <= W.
    """
    D, D_w, D_p, S = _swept(w / W, W, polynomials, changes)
    return ValueAlong(D, D_w, D_p, S, (len(polynomials) + 2) * UNIT)
