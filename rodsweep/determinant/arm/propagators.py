"""Propagators of the transverse problem over elements of a non-uniform arm, as polynomials in w.

With the state X = (y, theta, s, m) the eigenproblem of an arm with profiles reads (physics: the arm as it
is built)

    y' = nu theta + c2 s,   theta' = c3 m,   s' = w gamma2 y + F c3 m,   m' = w gamma3 theta - g s.

Over one element X(b) = Phi(w) X(a), with Phi entire in w. The Taylor polynomial of Phi in w comes from
collocation at the Gauss points of the element. Coefficients are sampled at the Gauss points alone, so every
profile and law costs the same. The terms satisfy Phi_n' = A_0 Phi_n + A_1 Phi_(n-1): a linear system gives
(s, m), then quadrature gives theta and y.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled, compiled_for_vectors
from ...model.material.build import LocalCoefficients

STAGES = 12
"""Gauss points of an element. Ten integrate exp(2.4) to 1e-17; two more allow for varying coefficients."""
MAX_TERMS = 24
NEGLIGIBLE = 1e-18
"""Size of a term, relative to the first term, at which the polynomial is truncated."""
TINY = 1e-300
"""Divisor in place of 0."""


@cache
def gauss_method(stages: int) -> tuple[Array, Array, Array]:
    """(points, integrals from 0 to each point, weights) on [0, 1], shapes (s,), (s, s), (s,)."""
    x, weights = np.polynomial.legendre.leggauss(stages)
    # The Legendre coefficients of a function's interpolant, integrated exactly.
    vandermonde = np.polynomial.legendre.legvander(x, stages - 1)
    to_series = vandermonde.T * weights * (np.arange(stages)[:, None] + 0.5)
    integrals = np.empty((stages, stages))
    for column in range(stages):
        integral = np.polynomial.legendre.legint(to_series[:, column], lbnd=-1)
        integrals[:, column] = np.polynomial.legendre.legval(x, integral)
    return (x + 1) / 2, integrals / 2, weights / 2


def element_propagators(F: Sequence[float], local: LocalCoefficients, lengths: Array, W: float) -> Array:
    """The coefficients of Phi in powers of w/W, shape (n, elements, terms, 16), each Phi column by column.

    F: forces of n arms. local: coefficients at the Gauss points, each (n, elements, STAGES). lengths: lengths
    of the elements, in L, (elements,).
    """
    _, integrals, weights = gauss_method(STAGES)
    terms = np.zeros((len(F), len(lengths), MAX_TERMS, 16))
    coefficients = np.ascontiguousarray(np.array(local).transpose(1, 2, 0, 3))
    method = np.ascontiguousarray(integrals.T), weights
    most = max(_fill_terms((F[i], W), coefficients[i], lengths, method, terms[i]) for i in range(len(F)))
    return np.ascontiguousarray(terms[:, :, :most])


@compiled
def _fill_terms(
    load: tuple[float, float], coefficients: Array, lengths: Array, method: tuple[Array, Array], terms: Array
) -> int:
    """Fills the terms of all elements, (elements, MAX_TERMS, 16); returns how many are needed at most.

    load: (F, W). coefficients: in the order of `LocalCoefficients`, (elements, 6, STAGES). method: transposed
    integrals and weights of `gauss_method`.
    """
    most = 1
    for e in range(len(lengths)):
        h = lengths[e]
        scaled = h * method[0], h * method[1]
        most = max(most, _fill_element(load, coefficients[e], scaled, terms[e]))
    return most


@compiled
def _fill_element(load: tuple[float, float], local: Array, method: tuple[Array, Array], terms: Array) -> int:
    """Fills the terms of one element, (MAX_TERMS, 16); returns how many are needed.

    method: transposed integrals, (STAGES, STAGES), and weights, (STAGES,), times the length of the element.
    Functions along the element have the shape (4, STAGES): one row for each initial value.
    """
    F, W = load
    Q, weights = method
    c3, gamma2, gamma3, g = local[2], local[3], local[4], local[5]
    inverse = _inverse_of_moments(F, c3, g, Q)
    along = np.zeros((10, 4, STAGES))
    y, theta, push, turn, m = along[0], along[1], along[2], along[3], along[4]
    s, rise, slopes, loads, moments = along[5], along[6], along[7], along[8], along[9]
    largest = 0.0
    for n in range(terms.shape[0]):
        start = 1.0 if n == 0 else 0.0  # the initial values belong to the term of w^0
        for k in range(4):
            for i in range(STAGES):
                loads[k, i] = W * gamma2[i] * y[k, i]
                moments[k, i] = W * gamma3[i] * theta[k, i]
        _integrate(Q, loads, 2, start, push)
        for k in range(4):
            for i in range(STAGES):
                s[k, i] = moments[k, i] - g[i] * push[k, i]
        _integrate(Q, s, 3, start, turn)
        _integrate(inverse, turn, 0, 0.0, m)
        for k in range(4):
            for i in range(STAGES):
                slopes[k, i] = c3[i] * m[k, i]
        _integrate(Q, slopes, 1, start, theta)
        _shear_and_rise((F, start), local, (push, theta, slopes), (s, rise, loads, moments))
        _integrate(Q, rise, 0, start, y)
        size = _end_values(weights, (rise, slopes, loads, moments), start, terms[n])
        largest = size if n == 0 else largest
        if size <= NEGLIGIBLE * largest:
            return n + 1
    return len(terms)


@compiled_for_vectors
def _integrate(Q: Array, values: Array, column: int, start: float, out: Array) -> None:
    """out = the integrals of values, both (4, STAGES), to each stage, plus a start value in one row.

    Q: transposed integrals, (STAGES, STAGES).
    """
    for k in range(4):
        for i in range(STAGES):
            out[k, i] = start if k == column else 0.0
        for j in range(STAGES):
            for i in range(STAGES):
                out[k, i] += values[k, j] * Q[j, i]


@compiled_for_vectors
def _shear_and_rise(
    load: tuple[float, float],
    local: Array,
    known: tuple[Array, Array, Array],
    rates: tuple[Array, Array, Array, Array],
) -> None:
    """Computes s and y' of one power of w, and completes s' and m', all (4, STAGES).

    load: (F, start value of theta in its row). known: s without the part by bending, theta, theta'. rates: s
    and y', and the parts of s' and m' that the previous power of w contributes.
    """
    F, start = load
    push, theta, slopes = known
    s, rise, loads, moments = rates
    for k in range(4):
        own = start if k == 1 else 0.0
        for i in range(STAGES):
            s[k, i] = push[k, i] + F * (theta[k, i] - own)
            rise[k, i] = local[0, i] * theta[k, i] + local[1, i] * s[k, i]
            loads[k, i] += F * slopes[k, i]
            moments[k, i] -= local[5, i] * s[k, i]


@compiled_for_vectors
def _end_values(weights: Array, rates: tuple[Array, Array, Array, Array], start: float, term: Array) -> float:
    """Fills one term, (16,), from the rates (y', theta', s', m'), (4, STAGES); returns its largest entry."""
    size = 0.0
    for row in range(4):
        values = rates[row]
        for k in range(4):
            total = start if k == row else 0.0
            for i in range(STAGES):
                total += weights[i] * values[k, i]
            term[4 * k + row] = total
            size = max(size, abs(total))
    return size


@compiled
def _inverse_of_moments(F: float, c3: Array, g: Array, Q: Array) -> Array:
    """The transposed inverse of 1 + Q g Q F c3, which gives m with s eliminated, (STAGES, STAGES).

    Q: transposed integrals times the length of the element.
    """
    system = np.zeros((STAGES, STAGES))
    for i in range(STAGES):
        system[i, i] = 1.0
        for k in range(STAGES):
            for j in range(STAGES):
                system[i, j] += F * c3[i] * Q[i, k] * g[k] * Q[k, j]
    inverse = np.empty((STAGES, STAGES))
    _invert(system, inverse)
    return inverse


@compiled_for_vectors
def _invert(A: Array, inverse: Array) -> None:
    """Fills `inverse` with that of A, both (STAGES, STAGES), by elimination with pivoting, in place of A."""
    inverse[:] = 0.0
    for i in range(STAGES):
        inverse[i, i] = 1.0
    for column in range(STAGES):
        pivot = column
        for i in range(column + 1, STAGES):
            if abs(A[i, column]) > abs(A[pivot, column]):
                pivot = i
        for j in range(STAGES):
            A[column, j], A[pivot, j] = A[pivot, j], A[column, j]
            inverse[column, j], inverse[pivot, j] = inverse[pivot, j], inverse[column, j]
        scale = 1 / A[column, column]
        for j in range(STAGES):
            A[column, j] *= scale
            inverse[column, j] *= scale
        for i in range(STAGES):
            if i != column:
                factor = A[i, column]
                for j in range(STAGES):
                    A[i, j] -= factor * A[column, j]
                    inverse[i, j] -= factor * inverse[column, j]


@cache
def _last_terms(stages: int) -> Array:
    """Matrix from values at the Gauss points to the two highest Legendre coefficients, (stages, 2)."""
    x, weights = np.polynomial.legendre.leggauss(stages)
    last = np.polynomial.legendre.legvander(x, stages - 1)[:, -2:] * (np.arange(stages)[-2:] + 0.5)
    terms: Array = weights[:, None] * last
    return terms


def tail_of(local: LocalCoefficients) -> Array:
    """The last two coefficients of the Legendre series of the coefficients, relative, (n, elements).

    local: at Gauss points, (n, elements, stages).
    """
    values = np.array(local[:5])
    size = np.maximum(np.abs(values).max(axis=-1), TINY)  # a compliance or a drag may be 0
    largest: Array = (np.abs(values @ _last_terms(values.shape[-1])).max(axis=-1) / size).max(axis=0)
    return largest
