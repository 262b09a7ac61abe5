"""The Lie algebras of the rigid motions of the plane, se(2), and of space, se(3), as structure constants.

Components are (v1, v2; Omega3) in the plane and (v; Omega), three each, in space, and

    (ad_E V)_a = sum over (b, c) of s_abc E_b V_c,    (ad*_E Sigma)_c = -sum over (a, b) of s_abc E_b Sigma_a.

se(2) has 4 nonzero constants s_abc and se(3) has 18, each +1 or -1, none with a = c. Every nonlinear term of
the rod is a loop over the nonzero constants.
"""

from typing import NamedTuple

Term = tuple[int, int, int, float]
"""A nonzero structure constant: (a, b, c, s_abc)."""
Pattern = tuple[tuple[bool, ...], ...]
"""A sparsity pattern: [row][column] is True where the entry may be nonzero."""


class Algebra(NamedTuple):
    """Structure constants of a Lie algebra, and the sparsity patterns of ad and ad*.

    components: indices of the components. terms: nonzero structure constants. forward: [a][c] is True if
    (ad_E V)_a contains V_c. backward: [c][b] is True if (ad*_E Sigma)_c contains Sigma_b or E_b, and
    therefore depends on Sigma_b.
    """

    components: range
    terms: tuple[Term, ...]
    forward: Pattern
    backward: Pattern

    @property
    def dimension(self) -> int:
        return len(self.components)

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """All ordered pairs (a, b) of two different components."""
        return [(a, b) for a in self.components for b in self.components if a != b]


def algebra(size: int, terms: list[Term]) -> Algebra:
    """The algebra of `size` components whose nonzero structure constants are `terms`."""
    # Which blocks of the Jacobian can be nonzero for any E: loops skip the others.
    leads = {(a, c) for a, _, c, _ in terms}
    bends = {(c, other) for a, b, c, _ in terms for other in (a, b)}
    forward, backward = (
        tuple(tuple((i, j) in pairs for j in range(size)) for i in range(size)) for pairs in (leads, bends)
    )
    return Algebra(range(size), tuple(terms), forward, backward)


def _cross(out: int, left: int, right: int) -> list[Term]:
    """Structure constants of a cross product.

    The factors are the triples of components that begin at `left` (of E) and `right` (of V); the product is
    added to the triple that begins at `out`.
    """
    cyclic = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
    positive = [(out + a, left + b, right + c, 1.0) for a, b, c in cyclic]
    return positive + [(out + a, left + c, right + b, -1.0) for a, b, c in cyclic]


SE2 = algebra(3, [(0, 1, 2, 1.0), (0, 2, 1, -1.0), (1, 2, 0, 1.0), (1, 0, 2, -1.0)])
"""ad_E V = (h2 Omega - kappa v2, kappa v1 - h1 Omega; 0)."""
SE3 = algebra(6, _cross(0, 3, 0) + _cross(0, 0, 3) + _cross(3, 3, 3))
"""ad_E V = (kappa x v + h x Omega; kappa x Omega)."""
ALGEBRAS = {3: SE2, 6: SE3}
"""SE2 and SE3 by their number of components."""
