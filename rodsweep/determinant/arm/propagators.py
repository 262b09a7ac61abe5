"""Propagators of the transverse problem over elements of a non-uniform arm, as polynomials in w.

With the state (y, theta, s, m) the eigenproblem of an arm with profiles reads (physics: the arm as it is
built)

    y' = nu theta + c2 s,   theta' = c3 m,   s' = w gamma2 y + F c3 m,   m' = w gamma3 theta - g s.

D is the minor of the rows s and m of two solutions, those that start with s = 1 or m = 1 at the clamp. With
y^s for the minor of the rows y and s, and so on, y^s + theta^m - F y^theta is constant along the arm: 0 for
these two solutions. The other five minors then obey a linear system of their own,

    (s^m)'     = w (gamma2 y^m - gamma3 theta^s)
    (theta^s)' = F c3 theta^m - c3 s^m - w gamma2 y^theta
    (theta^m)' = -g theta^s
    (y^theta)' = c3 y^m - c2 theta^s
    (y^m)'     = (g + nu) theta^m + c2 s^m + (w gamma3 - F g) y^theta

from s^m = 1 at the clamp, the others 0, to D = s^m at the tip. A growing exponential of one solution cannot
hide the other one, as it does where the solutions themselves are integrated.

Over one element the minors are multiplied by a matrix C(w), entire in w. Its Taylor polynomial comes from
collocation at the Gauss points of the element. Coefficients are sampled at the Gauss points alone, so every
profile and law costs the same. The terms satisfy C_n' = A_0 C_n + A_1 C_(n-1).
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from ...arrays import Array
from ...model.compiled.compilation import compiled, compiled_for_vectors
from ...model.material.build import LocalCoefficients

STAGES = 12
"""Gauss points of an element. Ten integrate exp(2.4) to 1e-17; two more allow for varying coefficients."""
MINORS = 5
SM, TS, TM, YT, YM = range(MINORS)
"""Places of the minors s^m, theta^s, theta^m, y^theta and y^m."""
ENTRIES = MINORS * MINORS
MAX_TERMS = 28
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
    """The coefficients of C in powers of w/W, (n, elements, terms, ENTRIES), each C column by column.

    F: forces of n arms. local: coefficients at the Gauss points, each (n, elements, STAGES). lengths: lengths
    of the elements, in L, (elements,).
    """
    _, integrals, weights = gauss_method(STAGES)
    terms = np.zeros((len(F), len(lengths), MAX_TERMS, ENTRIES))
    coefficients = np.ascontiguousarray(np.array(local).transpose(1, 2, 0, 3))
    method = np.ascontiguousarray(integrals.T), weights
    most = max(_fill_terms((F[i], W), coefficients[i], lengths, method, terms[i]) for i in range(len(F)))
    return np.ascontiguousarray(terms[:, :, :most])


@compiled
def _fill_terms(
    load: tuple[float, float], coefficients: Array, lengths: Array, method: tuple[Array, Array], terms: Array
) -> int:
    """Fills the terms of all elements, (elements, MAX_TERMS, ENTRIES); returns how many are needed at most.

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
    """Fills the terms of one element, (MAX_TERMS, ENTRIES); returns how many are needed.

    method: transposed integrals, (STAGES, STAGES), and weights, (STAGES,), times the length of the element.
    Functions along the element have the shape (MINORS, STAGES): one row for each initial value.
    """
    F, W = load
    Q, weights = method
    turning = _eliminated(F, local[2], local[5], Q)
    values = np.zeros((MINORS, MINORS, STAGES))
    rates = np.zeros((MINORS, MINORS, STAGES))
    largest = 0.0
    for n in range(terms.shape[0]):
        start = 1.0 if n == 0 else 0.0  # the initial values belong to the term of w^0
        _loads_of_w(W, local, values, rates)
        _integrate(Q, rates[SM], values[SM])
        values[SM, SM] += start
        _add_pushes(F, start, local, values, rates)
        _integrate(turning[1:], rates[TS], values[TS])
        values[TS, TS] += start * turning[0]
        _turns(local, values, rates)
        _integrate(Q, rates[TM], values[TM])
        values[TM, TM] += start
        _add_turns(F, start, local, values, rates)
        _integrate(Q, rates[YM], values[YM])  # without the part by y^theta
        values[YM, YM] += start
        _rises(local, values, rates)
        _integrate(turning[1:], rates[YT], values[YT])
        values[YT, YT] += start * turning[0]
        _add_tilts(F, local, values, rates)
        _integrate(Q, rates[YM], values[YM])
        values[YM, YM] += start
        _rises(local, values, rates)
        size = _end_values(weights, rates, start, terms[n])
        largest = size if n == 0 else largest
        if size <= NEGLIGIBLE * largest:
            return n + 1
    return len(terms)


@compiled_for_vectors
def _integrate(Q: Array, rates: Array, out: Array) -> None:
    """out = the integrals of rates, both (MINORS, STAGES), to each stage.

    Q: transposed integrals, (STAGES, STAGES).
    """
    for k in range(MINORS):
        for i in range(0, STAGES, 4):  # four sums at a time stay in one register
            a = b = c = d = 0.0
            for j in range(STAGES):
                rate = rates[k, j]
                a += rate * Q[j, i]
                b += rate * Q[j, i + 1]
                c += rate * Q[j, i + 2]
                d += rate * Q[j, i + 3]
            out[k, i] = a
            out[k, i + 1] = b
            out[k, i + 2] = c
            out[k, i + 3] = d


@compiled_for_vectors
def _loads_of_w(W: float, local: Array, values: Array, rates: Array) -> None:
    """Rates of one power of w by the values of the power before, both (MINORS, MINORS, STAGES)."""
    for k in range(MINORS):
        for i in range(STAGES):
            push = W * local[3, i]
            turn = W * local[4, i]
            rates[SM, k, i] = push * values[YM, k, i] - turn * values[TS, k, i]
            rates[TS, k, i] = -push * values[YT, k, i]
            rates[YM, k, i] = turn * values[YT, k, i]


@compiled_for_vectors
def _add_pushes(F: float, start: float, local: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of theta^s what s^m and the start value of theta^m contribute."""
    for k in range(MINORS):
        own = F * start if k == TM else 0.0
        for i in range(STAGES):
            rates[TS, k, i] += local[2, i] * (own - values[SM, k, i])


@compiled_for_vectors
def _turns(local: Array, values: Array, rates: Array) -> None:
    """The rates of theta^m."""
    for k in range(MINORS):
        for i in range(STAGES):
            rates[TM, k, i] = -local[5, i] * values[TS, k, i]


@compiled_for_vectors
def _add_turns(F: float, start: float, local: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of theta^s and y^m what theta^m and s^m contribute."""
    for k in range(MINORS):
        own = start if k == TM else 0.0
        for i in range(STAGES):
            turn = values[TM, k, i]
            rates[TS, k, i] += F * local[2, i] * (turn - own)
            rates[YM, k, i] += (local[5, i] + local[0, i]) * turn + local[1, i] * values[SM, k, i]


@compiled_for_vectors
def _rises(local: Array, values: Array, rates: Array) -> None:
    """The rates of y^theta."""
    for k in range(MINORS):
        for i in range(STAGES):
            rates[YT, k, i] = local[2, i] * values[YM, k, i] - local[1, i] * values[TS, k, i]


@compiled_for_vectors
def _add_tilts(F: float, local: Array, values: Array, rates: Array) -> None:
    """Adds to the rates of y^m what y^theta contributes by the force."""
    for k in range(MINORS):
        for i in range(STAGES):
            rates[YM, k, i] -= F * local[5, i] * values[YT, k, i]


@compiled_for_vectors
def _end_values(weights: Array, rates: Array, start: float, term: Array) -> float:
    """Fills one term, (ENTRIES,), from the rates, (MINORS, MINORS, STAGES); returns its largest entry."""
    size = 0.0
    for row in range(MINORS):
        for k in range(MINORS):
            total = start if k == row else 0.0
            for i in range(STAGES):
                total += weights[i] * rates[row, k, i]
            term[MINORS * k + row] = total
            size = max(size, abs(total))
    return size


@compiled
def _eliminated(F: float, c3: Array, g: Array, Q: Array) -> Array:
    """1 M and Q M, (1 + STAGES, STAGES), with the transposed inverse M of 1 + F Q c3 Q g.

    With it theta^m and y^m are eliminated: Q M integrates the rates of theta^s and y^theta, and 1 M belongs
    to a start value of 1. Q: transposed integrals times the length of the element.
    """
    system = np.zeros((STAGES, STAGES))
    _add_twice_integrated(F, c3, g, Q, system)
    inverse = np.empty((STAGES, STAGES))
    _invert(system, inverse)
    eliminated = np.zeros((1 + STAGES, STAGES))
    _add_integrated(Q, inverse, eliminated)
    return eliminated


@compiled_for_vectors
def _add_integrated(Q: Array, inverse: Array, out: Array) -> None:
    """Adds 1 M and Q M to `out`, (1 + STAGES, STAGES), for M = inverse and Q, (STAGES, STAGES)."""
    for k in range(STAGES):
        for j in range(STAGES):
            out[0, j] += inverse[k, j]
        for i in range(STAGES):
            factor = Q[i, k]
            for j in range(STAGES):
                out[1 + i, j] += factor * inverse[k, j]


@compiled_for_vectors
def _add_twice_integrated(F: float, c3: Array, g: Array, Q: Array, system: Array) -> None:
    """Adds 1 + F g Q c3 Q to a matrix, (STAGES, STAGES)."""
    for i in range(STAGES):
        system[i, i] += 1.0
        for k in range(STAGES):
            factor = F * g[i] * Q[i, k] * c3[k]
            for j in range(STAGES):
                system[i, j] += factor * Q[k, j]


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
