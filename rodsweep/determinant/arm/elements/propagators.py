"""Propagators of the transverse problem over elements of a nonuniform arm, as polynomials in w.

Over one element the minors of `rodsweep.determinant.arm.elements.collocation` are multiplied by a matrix
C(w), the propagator, which is entire in w. Collocation at the Gauss points of the element gives its Taylor
polynomial. Coefficients are evaluated at the Gauss points only, so every profile and law costs the same.
"""

from collections.abc import Sequence
from functools import cache

import numpy as np

from ....arrays import Array
from .collocation import IntegrationMatrices, propagator_polynomials
from .settings import ARM_ELEMENT_SETTINGS


@cache
def gauss_method(stage_count: int) -> tuple[Array, Array, Array]:
    """Returns (Gauss points on [0, 1], (s,); matrix of integrals from 0 to each Gauss point, (s, s); Gauss
    weights, (s,)); s: `stage_count`."""
    x, weights = np.polynomial.legendre.leggauss(stage_count)
    # The Legendre coefficients of a function's interpolant, integrated exactly.
    vandermonde = np.polynomial.legendre.legvander(x, stage_count - 1)
    to_series = vandermonde.T * weights * (np.arange(stage_count)[:, None] + 0.5)
    integrals = np.empty((stage_count, stage_count))
    for column in range(stage_count):
        integral = np.polynomial.legendre.legint(to_series[:, column], lbnd=-1)
        integrals[:, column] = np.polynomial.legendre.legval(x, integral)
    return (x + 1) / 2, integrals / 2, weights / 2


@cache
def _collocation_method() -> IntegrationMatrices:
    """The collocation method of `ARM_ELEMENT_SETTINGS.stage_count` Gauss points, as arrays for compiled
    code."""
    _, integrals, weights = gauss_method(ARM_ELEMENT_SETTINGS.stage_count)
    return IntegrationMatrices(np.ascontiguousarray(integrals), np.ascontiguousarray(weights))


def element_propagators(F: Sequence[float], coefficients: Array, lengths: Array, W: float) -> Array:
    """The propagators C of the elements of n arms in powers of w/W, (n, elements, terms, PROPAGATOR_LENGTH),
    C column by column.

    F: forces, (n,). coefficients: `LocalCoefficients` at the Gauss points, (6, n, elements, stages). lengths:
    lengths of the elements, in L, (elements,). Raises FloatingPointError if `max_terms` powers do not resolve
    C.
    """
    terms = propagator_polynomials(np.array(F, float), W, coefficients, lengths, _collocation_method())
    if not terms.size:
        raise FloatingPointError(
            f"the determinant of this arm at |w| = {W:g} needs more than the maximum of "
            f"{ARM_ELEMENT_SETTINGS.max_terms} powers of w in an element"
        )
    return terms
