"""Propagators of the transverse problem over elements of a non-uniform arm, as polynomials in w.

With the state X = (y, theta, s, m) the eigenproblem of an arm with profiles reads (physics: the arm as it
is built)

    y' = nu theta + c2 s,   theta' = c3 m,   s' = w gamma2 y + F c3 m,   m' = w gamma3 theta - g s.

Over one element X(b) = Phi(w) X(a), with Phi entire in w. The Taylor polynomial of Phi in w comes from
collocation at the Gauss points of the element. Coefficients are sampled at the Gauss points alone, so every
profile and law costs the same. The terms satisfy Phi_n' = A_0 Phi_n + A_1 Phi_(n-1): a linear system gives
(s, m), then quadrature gives theta and y.
"""

from functools import cache

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.material.build import LocalCoefficients

STAGES = 12
"""Gauss points of an element. Ten integrate exp(2.4) to 1e-17; two more allow for varying coefficients."""
MAX_TERMS = 24
"""Maximum number of terms of a propagator in w/W."""
NEGLIGIBLE = 1e-18
"""Size of a term, relative to the first term, at which the polynomial is truncated."""
SMALLEST_DIVISOR = 1e-300
"""Lower bound of divisors, against division by zero."""


@cache
def gauss_method(stages: int) -> tuple[Array, Array, Array]:
    """(points, integrals from 0 to each point, weights) on [0, 1], shapes (s,), (s, s), (s,)."""
    x, weights = np.polynomial.legendre.leggauss(stages)
    # Integrals of the interpolant are exact integrals of its Legendre series.
    vandermonde = np.polynomial.legendre.legvander(x, stages - 1)
    to_series = vandermonde.T * weights * (np.arange(stages)[:, None] + 0.5)
    integrals = np.empty((stages, stages))
    for column in range(stages):
        integral = np.polynomial.legendre.legint(to_series[:, column], lbnd=-1)
        integrals[:, column] = np.polynomial.legendre.legval(x, integral)
    return (x + 1) / 2, integrals / 2, weights / 2


def element_propagators(F: float, local: LocalCoefficients, lengths: Array, W: float) -> Array:
    """The coefficients of Phi in powers of w/W, shape (elements, terms, 4, 4).

    local: coefficients at the Gauss points, each (elements, stages). lengths: lengths of the elements, in L,
    (elements,).
    """
    method = gauss_method(local.nu.shape[1])[1:]
    terms = np.zeros((len(lengths), MAX_TERMS, 4, 4))
    coefficients = np.ascontiguousarray(np.moveaxis(np.array(local), 0, 1))
    most = _fill_terms((F, W), coefficients, lengths, method, terms)
    return np.ascontiguousarray(terms[:, :most])


@compiled
def _fill_terms(
    load: tuple[float, float], coefficients: Array, lengths: Array, method: tuple[Array, Array], terms: Array
) -> int:
    """Fills the terms of all elements, (elements, MAX_TERMS, 4, 4); returns the largest number of terms.

    load: (F, W). coefficients: in the order of `LocalCoefficients`, (elements, 6, stages). lengths:
    (elements,). method: integrals and weights of `gauss_method`.
    """
    most = 1
    for e in range(len(lengths)):
        most = max(most, _fill_element(load, coefficients[e], lengths[e], method, terms[e]))
    return most


@compiled
def _fill_element(
    load: tuple[float, float], local: Array, h: float, method: tuple[Array, Array], terms: Array
) -> int:
    """Fills the terms of one element of length h, (MAX_TERMS, 4, 4); returns the number of terms.

    load: (F, W). local: coefficients at the Gauss points, (6, stages). method: integrals and weights.
    """
    F, W = load
    Q, weights = method
    nu, c2, c3, gamma2, gamma3, g = local[0], local[1], local[2], local[3], local[4], local[5]
    inverse = _inverse_of_moments(F, local, h, Q)
    stages = len(weights)
    y = np.zeros((stages, 4))
    theta = np.zeros((stages, 4))
    largest = 0.0
    for n in range(terms.shape[0]):
        start = 1.0 if n == 0 else 0.0  # the initial values belong to the term of w^0
        loads = _scaled(W * gamma2, y)
        moments = _scaled(W * gamma3, theta)
        push = _integrated(Q, h, loads, 2, start)
        turn = _integrated(Q, h, moments, 3, start)
        m = _product(inverse, turn - _integrated(Q, h, _scaled(g, push), 0, 0.0))
        slopes = _scaled(c3, m)
        s = push + _integrated(Q, h, F * slopes, 0, 0.0)
        loads += F * slopes
        moments -= _scaled(g, s)
        theta = _integrated(Q, h, slopes, 1, start)
        rise = _scaled(nu, theta) + _scaled(c2, s)
        y = _integrated(Q, h, rise, 0, start)
        size = 0.0
        for column in range(4):
            terms[n, 0, column] = h * (weights * rise[:, column]).sum()
            terms[n, 1, column] = h * (weights * slopes[:, column]).sum()
            terms[n, 2, column] = h * (weights * loads[:, column]).sum()
            terms[n, 3, column] = h * (weights * moments[:, column]).sum()
            terms[n, column, column] += start
            size = max(size, np.abs(terms[n, :, column]).max())
        largest = size if n == 0 else largest
        if size <= NEGLIGIBLE * largest:
            return n + 1
    return len(terms)


@compiled
def _inverse_of_moments(F: float, local: Array, h: float, Q: Array) -> Array:
    """The inverse of 1 + h Q g h Q F c3, the matrix of the equation for m without s, (stages, stages).

    local: coefficients at the Gauss points, (6, stages). Q: integrals of `gauss_method`, (stages, stages).
    """
    c3 = local[2]
    g = local[5]
    stages = len(Q)
    system = np.zeros((stages, stages))
    for i in range(stages):
        system[i, i] = 1.0
        for k in range(stages):
            factor = h * h * F * Q[i, k] * g[k]
            for j in range(stages):
                system[i, j] += factor * Q[k, j] * c3[j]
    inverse = np.empty((stages, stages))
    _invert(system, inverse)
    return inverse


@compiled
def _scaled(factors: Array, values: Array) -> Array:
    """Each row of values, (stages, 4), times a factor, (stages,)."""
    out = np.empty_like(values)
    for i in range(len(factors)):
        for column in range(4):
            out[i, column] = factors[i] * values[i, column]
    return out


@compiled
def _product(A: Array, values: Array) -> Array:
    """The matrix product of A, (stages, stages), and values, (stages, 4)."""
    out = np.zeros_like(values)
    for i in range(len(A)):
        for k in range(len(A)):
            for column in range(4):
                out[i, column] += A[i, k] * values[k, column]
    return out


@compiled
def _integrated(Q: Array, h: float, values: Array, column: int, start: float) -> Array:
    """Integrals of values, (stages, 4), from the start of the element to each stage.

    start: initial value of the component `column`.
    """
    out = _product(Q, h * values)
    out[:, column] += start
    return out


@compiled
def _invert(A: Array, inverse: Array) -> None:
    """Fills `inverse` with the inverse of A, both (n, n), by elimination with pivoting; overwrites A."""
    n = len(A)
    inverse[:] = 0.0
    for i in range(n):
        inverse[i, i] = 1.0
    for column in range(n):
        pivot = column
        for i in range(column + 1, n):
            if abs(A[i, column]) > abs(A[pivot, column]):
                pivot = i
        if pivot != column:
            for j in range(n):
                A[column, j], A[pivot, j] = A[pivot, j], A[column, j]
                inverse[column, j], inverse[pivot, j] = inverse[pivot, j], inverse[column, j]
        for i in range(n):
            if i != column:
                factor = A[i, column] / A[column, column]
                for j in range(n):
                    A[i, j] -= factor * A[column, j]
                    inverse[i, j] -= factor * inverse[column, j]
    for i in range(n):
        for j in range(n):
            inverse[i, j] /= A[i, i]


@cache
def _last_terms(stages: int) -> Array:
    """Matrix from values at the Gauss points to the two highest Legendre coefficients, (stages, 2)."""
    x, weights = np.polynomial.legendre.leggauss(stages)
    last = np.polynomial.legendre.legvander(x, stages - 1)[:, -2:] * (np.arange(stages)[-2:] + 0.5)
    terms: Array = weights[:, None] * last
    return terms


def tail_of(local: LocalCoefficients) -> Array:
    """Truncation estimate: the two highest Legendre coefficients of nu, c2, c3, gamma2, gamma3, (elements,).

    Each is relative to the largest value in the element; the largest of all counts.
    """
    values = np.array(local[:5])
    size = np.maximum(np.abs(values).max(axis=-1), SMALLEST_DIVISOR)  # a compliance or a drag may be 0
    largest: Array = (np.abs(values @ _last_terms(values.shape[-1])).max(axis=-1) / size).max(axis=0)
    return largest
