"""The Lie algebras of the rigid motions of the plane, se(2), and of space, se(3), as structure constants.

Components are (v1, v2; Omega3) in the plane and (v; Omega), three each, in space, and

    (ad_E V)_a = sum over (b, c) of s_abc E_b V_c,    (ad*_E Sigma)_c = -sum over (a, b) of s_abc E_b Sigma_a.

se(2) has 4 and se(3) has 18 nonzero constants s_abc, all +1 or -1 and with a != c. Every nonlinear term of
the rod is a loop over the nonzero constants.
"""

from typing import NamedTuple

StructureConstant = tuple[int, int, int, float]
"""A nonzero structure constant s_abc of a Lie algebra with its indices, (a, b, c, s_abc)."""
SparsityPattern = tuple[tuple[bool, ...], ...]
"""Sparsity pattern of a matrix: pattern[row][column] is True where the matrix element may be nonzero."""


class LieAlgebra(NamedTuple):
    """Structure constants of a Lie algebra, and the sparsity patterns of ad and ad*.

    component_indices: indices of the components. structure_constants: the nonzero constants. ad_pattern:
    pattern of ad; ad_pattern[a][c] is True if (ad_E V)_a depends on V_c. coad_derivative_pattern: pattern of
    the derivative of ad*; coad_derivative_pattern[c][b] is True if (ad*_E Sigma)_c depends on Sigma_b or on
    E_b, which depends on Sigma_b."""

    component_indices: range
    structure_constants: tuple[StructureConstant, ...]
    ad_pattern: SparsityPattern
    coad_derivative_pattern: SparsityPattern

    @property
    def dimension(self) -> int:
        """Dimension of the algebra: 3 for se(2), 6 for se(3)."""
        return len(self.component_indices)

    @property
    def ordered_distinct_pairs(self) -> list[tuple[int, int]]:
        """All ordered pairs (a, b) of indices of components of the algebra with a != b."""
        return [(a, b) for a in self.component_indices for b in self.component_indices if a != b]


def algebra_from_constants(dimension: int, constants: list[StructureConstant]) -> LieAlgebra:
    """The Lie algebra of dimension `dimension` whose nonzero structure constants are `constants`."""
    # Loops over the Jacobian skip all blocks that are not in these patterns.
    ad_pairs = {(a, c) for a, _, c, _ in constants}
    # Component c of ad* contains products of components a and b, and depends on both.
    coad_pairs = {(c, component) for a, b, c, _ in constants for component in (a, b)}
    return LieAlgebra(
        range(dimension),
        tuple(constants),
        _sparsity_pattern(dimension, ad_pairs),
        _sparsity_pattern(dimension, coad_pairs),
    )


def _sparsity_pattern(dimension: int, pairs: set[tuple[int, int]]) -> SparsityPattern:
    """Sparsity pattern of a square matrix of the given dimension. pairs: (row, column) of the elements that
    may be nonzero."""
    return tuple(tuple((row, column) in pairs for column in range(dimension)) for row in range(dimension))


def _cross_product_constants(
    product_start: int, left_start: int, right_start: int
) -> list[StructureConstant]:
    """Structure constants of a cross product of two triples of components, as a part of ad_E V. The first
    factor is the triple of components of E that starts at index `left_start`, the second factor the triple of
    V that starts at `right_start`, and the product the triple of ad_E V that starts at `product_start`."""
    cyclic_orders = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
    positive = [(product_start + a, left_start + b, right_start + c, 1.0) for a, b, c in cyclic_orders]
    return positive + [
        (product_start + a, left_start + c, right_start + b, -1.0) for a, b, c in cyclic_orders
    ]


SE2 = algebra_from_constants(3, [(0, 1, 2, 1.0), (0, 2, 1, -1.0), (1, 2, 0, 1.0), (1, 0, 2, -1.0)])
"""The algebra se(2) of plane motions: ad_E V = (h2 Omega - kappa v2, kappa v1 - h1 Omega; 0)."""
SE3 = algebra_from_constants(
    6,
    _cross_product_constants(0, 3, 0) + _cross_product_constants(0, 0, 3) + _cross_product_constants(3, 3, 3),
)
"""The algebra se(3) of motions in space: ad_E V = (kappa x v + h x Omega; kappa x Omega)."""
ALGEBRAS = {3: SE2, 6: SE3}
"""The algebras se(2) and se(3), by dimension."""
