"""The Lie algebras of the rigid motions of the plane, se(2), and of space, se(3), as structure constants.

With the components (v1, v2; Omega3) in the plane and (v; Omega), three each, in space

    (ad_E V)_a = sum over (b, c) of s_abc E_b V_c,    (ad*_E Sigma)_c = -sum over (a, b) of s_abc E_b Sigma_a,

of which 4 and 18 terms are not 0, each +1 or -1. All that is nonlinear in the rod is a loop over them; none
of them leads from a component to itself.
"""

from typing import NamedTuple

Term = tuple[int, int, int, float]
"""(a, b, c) and s_abc."""
Pattern = tuple[tuple[bool, ...], ...]


class Algebra(NamedTuple):
    """Structure constants, of as many components as `components` has.

    forward: whether component c of V occurs in component a of ad_E V, at [a][c]; backward: whether component
    b of Sigma, by itself or by way of E, does in component c of ad*_E Sigma, at [c][b].
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
        """Two components that are not the same."""
        return [(a, b) for a in self.components for b in self.components if a != b]


def algebra(size: int, terms: list[Term]) -> Algebra:
    """The algebra with these structure constants."""
    leads = {(a, c) for a, _, c, _ in terms}
    bends = {(c, other) for a, b, c, _ in terms for other in (a, b)}
    forward, backward = (
        tuple(tuple((i, j) in pairs for j in range(size)) for i in range(size)) for pairs in (leads, bends)
    )
    return Algebra(range(size), tuple(terms), forward, backward)


def _cross(out: int, left: int, right: int) -> list[Term]:
    """The terms of a cross product of the triples of components that begin at `left` and `right`."""
    cyclic = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
    positive = [(out + a, left + b, right + c, 1.0) for a, b, c in cyclic]
    return positive + [(out + a, left + c, right + b, -1.0) for a, b, c in cyclic]


SE2 = algebra(3, [(0, 1, 2, 1.0), (0, 2, 1, -1.0), (1, 2, 0, 1.0), (1, 0, 2, -1.0)])
"""ad_E V = (h2 Omega - kappa v2, kappa v1 - h1 Omega; 0)."""
SE3 = algebra(6, _cross(0, 3, 0) + _cross(0, 0, 3) + _cross(3, 3, 3))
"""ad_E V = (kappa x v + h x Omega; kappa x Omega)."""
ALGEBRAS = {3: SE2, 6: SE3}
"""Algebras by number of components."""
