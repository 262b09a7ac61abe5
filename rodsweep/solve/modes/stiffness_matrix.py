"""The matrix A of a dense pencil with its bending stiffness kept as a product, and the rounding errors of its
products with vectors.

The block of A for theta is -G^T G. Rounding errors of its entries act like moments in proportion to the
largest bending stiffness along an arm, and deflect the softest part. Rounding errors of G theta, evaluated
first, act like strains, which are relative to theta however much the stiffness varies.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array


class SquaredRoundingErrors(NamedTuple):
    """Squares of the rms rounding errors of the product of A - w B and a vector, in units of the square of
    the machine epsilon."""

    residual: Array
    """Of the rows of the product, (unknowns,)."""
    strain: Array
    """Of the rows of G theta, (nodes,)."""


@dataclass(frozen=True, eq=False)
class StiffnessMatrix:
    """Matrix A = C - G^T G of a pencil, where G^T G belongs to the unknowns theta. A: (unknowns, unknowns).
    bending_factor: G, (nodes, nodes), as in `DenseEigenproblem`; (0, 0) if A is not split, C = A."""

    A: Array
    bending_factor: Array

    @property
    def theta(self) -> slice:
        """Range of the unknowns theta."""
        n = len(self.bending_factor)
        return slice(n, 2 * n)

    @cached_property
    def _other_terms(self) -> Array:
        """C: the matrix A without its bending stiffness, (unknowns, unknowns)."""
        C = self.A.copy()
        C[self.theta, self.theta] = 0.0
        return C

    @cached_property
    def _squared_other_terms(self) -> Array:
        return self._other_terms**2

    @cached_property
    def _squared_bending_factor(self) -> Array:
        return self.bending_factor**2

    def product(self, vector: NDArray, side: int) -> NDArray:
        """Product of A (side 0) or its transpose (side 1) and `vector`, (unknowns,)."""
        G = self.bending_factor
        result: NDArray = (self._other_terms.T if side else self._other_terms) @ vector
        result[self.theta] -= G.T @ (G @ vector[self.theta])
        return result

    def squared_rounding_errors(self, vector: NDArray, side: int, wB: NDArray) -> SquaredRoundingErrors:
        """Squared rounding errors of `product(vector, side)` - wB `vector`. wB: (unknowns,)."""
        squares = self._squared_other_terms.T if side else self._squared_other_terms
        theta = vector[self.theta]
        residual = squares @ np.abs(vector) ** 2 + np.abs(wB * vector) ** 2
        residual[self.theta] += self._squared_bending_factor.T @ np.abs(self.bending_factor @ theta) ** 2
        return SquaredRoundingErrors(residual, self._squared_bending_factor @ np.abs(theta) ** 2)

    def residual_sample(self, errors: SquaredRoundingErrors, signs: Array) -> Array:
        """A rounding error of a product with the rms values of `errors`, (unknowns,). signs: of the rows of
        the product and of the rows of G theta, (2, unknowns)."""
        residual = signs[0] * np.sqrt(errors.residual)
        strain = signs[1, : len(errors.strain)] * np.sqrt(errors.strain)
        residual[self.theta] += self.bending_factor.T @ strain
        return residual

    def squared_effect(self, errors: SquaredRoundingErrors, test_vector: NDArray) -> float:
        """Mean square of the product of `test_vector`, (unknowns,), and a rounding error of `errors`."""
        test_strain = self.bending_factor @ test_vector[self.theta]
        return float(np.abs(test_vector) ** 2 @ errors.residual + np.abs(test_strain) ** 2 @ errors.strain)
