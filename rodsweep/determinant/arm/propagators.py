"""Propagators of the transverse problem over elements of a non-uniform arm, as polynomials in w.

With the state X = (y, theta, s, m) the eigenproblem of an arm with profiles reads (physics: the arm as it
is built)

    y' = nu theta + c2 s,   theta' = c3 m,   s' = w gamma2 y + F c3 m,   m' = w gamma3 theta - g s.

Over one element X(b) = Phi(w) X(a), with Phi entire in w. Its Taylor polynomial in w comes from collocation
at the Gauss points of the element. Coefficients are sampled at these points alone, so that any profile and
law costs the same. The terms satisfy Phi_n' = A_0 Phi_n + A_1 Phi_(n-1): a linear system gives (s, m), then
quadrature gives theta and y.
"""

from functools import cache

import numpy as np

from ...arrays import Array
from ...model.material.build import LocalCoefficients

STAGES = 12
"""Gauss points of an element. Ten leave 1e-17 of exp(2.4); two more cover what the coefficients vary."""
MAX_TERMS = 24
NEGLIGIBLE = 1e-18
"""Most terms in w/W, and the size of a term, relative to the first one, behind which none is needed."""
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


def element_propagators(F: float, local: LocalCoefficients, lengths: Array, W: float) -> Array:
    """The coefficients of Phi in powers of w/W, shape (elements, terms, 4, 4).

    local: at the Gauss points, each (elements, stages). lengths: of the elements, in L, (elements,).
    """
    elements, stages = local.nu.shape
    _, Q, weights = gauss_method(stages)
    h = lengths[:, None, None]
    nu, c2, c3, gamma2, gamma3, g = (values[:, :, None] for values in local)
    system = np.zeros((elements, 2 * stages, 2 * stages))
    system[:, :stages, stages:] = -h * Q * (F * local.c3)[:, None, :]
    system[:, stages:, :stages] = h * Q * local.g[:, None, :]
    system += np.eye(2 * stages)
    inverse = np.linalg.inv(system)
    terms: list[Array] = []
    y: Array = np.zeros((elements, stages, 4))
    theta: Array = np.zeros((elements, stages, 4))
    start = np.eye(4)  # the initial values belong to the term of w^0
    while len(terms) < MAX_TERMS:
        push, turn = W * gamma2 * y, W * gamma3 * theta
        right = np.concatenate([start[2] + h * (Q @ push), start[3] + h * (Q @ turn)], axis=1)
        solved = inverse @ right
        s, m = solved[:, :stages], solved[:, stages:]
        slopes = (c3 * m, push + F * c3 * m, turn - g * s)
        theta = start[1] + h * (Q @ slopes[0])
        rise = nu * theta + c2 * s
        y = start[0] + h * (Q @ rise)
        ends = [lengths[:, None] * (weights @ slope) for slope in (rise, *slopes)]
        terms.append(start + np.stack(ends, axis=1))
        start = np.zeros((4, 4))
        if np.abs(terms[-1]).max() <= NEGLIGIBLE * np.abs(terms[0]).max():
            break
    return np.stack(terms, axis=1)


@cache
def _last_terms(stages: int) -> Array:
    """Matrix from values at the Gauss points to the last two Legendre coefficients, (stages, 2)."""
    x, weights = np.polynomial.legendre.leggauss(stages)
    last = np.polynomial.legendre.legvander(x, stages - 1)[:, -2:] * (np.arange(stages)[-2:] + 0.5)
    terms: Array = weights[:, None] * last
    return terms


def tail_of(local: LocalCoefficients) -> Array:
    """The last two coefficients of the Legendre series of the coefficients, relative, (elements,)."""
    values = np.array(local[:5])
    size = np.maximum(np.abs(values).max(axis=-1), TINY)  # a compliance or a drag may be 0
    largest: Array = (np.abs(values @ _last_terms(values.shape[-1])).max(axis=-1) / size).max(axis=0)
    return largest
