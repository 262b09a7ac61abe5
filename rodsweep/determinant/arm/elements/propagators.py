"""Propagators of the transverse problem over elements of a non-uniform arm, as polynomials in w.

Over one element the minors of `rodsweep.determinant.arm.elements.collocation` are multiplied by a matrix
C(w), entire in w. Its Taylor polynomial comes from collocation at the Gauss points of the element.
Coefficients are sampled at the Gauss points alone, so every profile and law costs the same.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from ....arrays import Array
from ....model.material.build import LocalCoefficients
from ...exponents import EXPONENTS
from .collocation import IntegrationMatrices, fill_terms
from .minor_rates import ENTRIES
from .settings import ARM_ELEMENTS


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


@cache
def _method() -> IntegrationMatrices:
    """The collocation method of `ARM_ELEMENTS.stages` Gauss points, as arrays for compiled code."""
    _, integrals, weights = gauss_method(ARM_ELEMENTS.stages)
    return IntegrationMatrices(np.ascontiguousarray(integrals), np.ascontiguousarray(weights))


def element_propagators(F: Sequence[float], local: LocalCoefficients, lengths: Array, W: float) -> Array:
    """The coefficients of C in powers of w/W, (n, elements, terms, ENTRIES), each C column by column.

    F: forces of n arms. local: coefficients at the Gauss points, each (n, elements, stages). lengths: lengths
    of the elements, in L, (elements,). Raises FloatingPointError if `max_terms` powers do not resolve C.
    """
    n = len(F)
    elements = len(lengths)
    together = ARM_ELEMENTS.lanes
    batches = -(-elements // together)
    # The last batch is filled up with the last element.
    lanes = np.minimum(np.arange(batches * together), elements - 1)
    scaled = np.array(local)[:, :, lanes] * lengths[lanes][:, None]
    coefficients = scaled.reshape(6, n, batches, together, ARM_ELEMENTS.stages).transpose(1, 2, 0, 4, 3)
    terms = np.zeros((n, batches * together, ARM_ELEMENTS.max_terms, ENTRIES))
    most = fill_terms(np.array(F, float), W, np.ascontiguousarray(coefficients), _method(), terms)
    if most > ARM_ELEMENTS.max_terms:
        raise FloatingPointError(f"{ARM_ELEMENTS.max_terms} powers of w are too few for these elements")
    return np.ascontiguousarray(terms[:, :elements, :most])


@cache
def _last_terms(stages: int) -> Array:
    """Matrix from values at the Gauss points to the two highest Legendre coefficients, (stages, 2)."""
    x, weights = np.polynomial.legendre.leggauss(stages)
    last = np.polynomial.legendre.legvander(x, stages - 1)[:, -2:] * (np.arange(stages)[-2:] + 0.5)
    terms: Array = weights[:, None] * last
    return terms


def tail_of(local: LocalCoefficients) -> Array:
    """Largest modulus of the last two Legendre coefficients of any coefficient on each element, relative to
    its values, (n, elements).

    local: coefficients at the Gauss points, (n, elements, stages).
    """
    # The sixth, g, follows from the others and the force.
    values = np.array(local[:5])
    size = np.maximum(np.abs(values).max(axis=-1), EXPONENTS.least_divisor)  # a compliance or a drag may be 0
    largest: Array = (np.abs(values @ _last_terms(values.shape[-1])).max(axis=-1) / size).max(axis=0)
    return largest
