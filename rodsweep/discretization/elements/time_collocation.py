"""Radau IIA collocation in time: on each time interval the state is a polynomial in time.

The polynomial satisfies the equations at the s collocation nodes; the last node is the end of the interval.
The error at the ends of intervals is of order 2 s - 1, also for algebraic unknowns, which have no time
derivative.
"""

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from ...arrays import Array
from .basis import differentiation_matrix, lagrange_interpolation_matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class RadauSettings:
    """Settings for the collocation nodes of Radau IIA."""

    newton_step_count: int = 3
    """Number of Newton steps that correct the nodes from the eigenvalues of a companion matrix, which have
    errors of 1e-15. The first step already reaches rounding error."""


RADAU_SETTINGS = RadauSettings()


class CollocationMethod(NamedTuple):
    """A collocation method with s stages on the interval [0, 1]. nodes, weights: nodes and quadrature
    weights, (s,); the last node is 1. differentiation_matrix: (s, s + 1), matrix from values at 0 and at the
    nodes to derivatives at the nodes."""

    nodes: Array
    weights: Array
    differentiation_matrix: Array

    @property
    def stage_count(self) -> int:
        """Number of stages s."""
        return len(self.nodes)

    def evaluation_matrix(self, times: Array) -> Array:
        """Matrix (m, s + 1) from values at 0 and the nodes to values at `times`, (m,), in [0, 1]."""
        return lagrange_interpolation_matrix(np.append(0.0, self.nodes), times)


@cache
def radau_method(stage_count: int) -> CollocationMethod:
    """The Radau IIA method with s = `stage_count` stages; its nodes are the zeros of P_(s-1) - P_s, mapped to
    [0, 1]. P_s: Legendre polynomial."""
    legendre_coefficients = np.zeros(stage_count + 1)
    legendre_coefficients[-2:] = 1.0, -1.0
    x = np.sort(legendre.legroots(legendre_coefficients).real)
    for _ in range(RADAU_SETTINGS.newton_step_count):
        x = x - legendre.legval(x, legendre_coefficients) / legendre.legval(
            x, legendre.legder(legendre_coefficients)
        )
    # The end of the interval is exactly a node, so that the next interval starts from a computed state.
    x[-1] = 1.0
    moments = np.zeros(stage_count)
    moments[0] = 1.0
    # The weights integrate Legendre polynomials exactly; only the integral of P_0 is nonzero.
    weights = np.linalg.solve(legendre.legvander(x, stage_count - 1).T, moments)
    D = 2 * differentiation_matrix(np.append(-1.0, x))
    # The equations hold at the stages, not at the start, so the first row of D is not used.
    return CollocationMethod((x + 1) / 2, weights, np.ascontiguousarray(D[1:]))
