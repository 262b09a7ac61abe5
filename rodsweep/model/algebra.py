"""The Lie algebras of the rigid motions of the plane, se(2), and of space, se(3), as structure constants.

With the components (v1, v2; Omega3) in the plane and (v; Omega), three each, in space

    (ad_E V)_a = sum over (b, c) of s_abc E_b V_c,    (ad*_E Sigma)_c = -sum over (a, b) of s_abc E_b Sigma_a,

of which 4 and 18 terms are not 0, each +1 or -1. All that is nonlinear in the rod is a loop over them, with
the loop over its nodes inside; none of them leads from a component to itself.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .compilation import compiled_for_vectors

Integers = NDArray[np.int64]
Term = tuple[int, int, int, float]
"""(a, b, c) and s_abc."""


class Algebra(NamedTuple):
    """Structure constants as compiled functions take them, of d components.

    terms: (a, b, c) of each, (terms, 3); signs: s_abc, (terms,). forward: 1 where component c of V occurs in
    component a of ad_E V, at [a, c]; backward: where component b of Sigma, by itself or by way of E, does in
    component c of ad*_E Sigma, at [c, b]; both (d, d).
    """

    terms: Integers
    signs: Array
    forward: Integers
    backward: Integers


def algebra(components: int, terms: list[Term]) -> Algebra:
    """The algebra with these structure constants."""
    forward, backward = np.zeros((2, components, components), np.int64)
    for a, b, c, _ in terms:
        forward[a, c] = backward[c, a] = backward[c, b] = 1
    places = np.array([(a, b, c) for a, b, c, _ in terms], np.int64)
    return Algebra(places, np.array([sign for *_, sign in terms]), forward, backward)


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
"""By the number of components."""


@compiled_for_vectors
def add_ad(E: NDArray, V: NDArray, out: NDArray, g: Algebra) -> None:
    """Adds ad_E V to out, all of shape (d, points), real or complex."""
    for t in range(len(g.signs)):
        a, b, c, sign = g.terms[t, 0], g.terms[t, 1], g.terms[t, 2], g.signs[t]
        for i in range(E.shape[1]):
            out[a, i] += sign * E[b, i] * V[c, i]


@compiled_for_vectors
def add_coad(E: NDArray, Sigma: NDArray, out: NDArray, g: Algebra) -> None:
    """Adds ad*_E Sigma to out, all of shape (d, points), real or complex."""
    for t in range(len(g.signs)):
        a, b, c, sign = g.terms[t, 0], g.terms[t, 1], g.terms[t, 2], -g.signs[t]
        for i in range(E.shape[1]):
            out[c, i] += sign * E[b, i] * Sigma[a, i]
