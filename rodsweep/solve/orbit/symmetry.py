"""Symmetry of an orbit: the state after the p-th part of the period T is S times the first, x(T/p) = S x(0).

S rotates or reflects the body frame, alike at all nodes. The reflection on the line of the straight rod keeps
n1 and v1 and reverses n2, m3, v2 and Omega; it maps motions to motions. The phase condition of `phase` serves
orbits with and without the reflection.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...arrays import Array
from ...discretization.elements.elements import ELEMENTS
from ...discretization.state_layout import StateLayout
from ...model.balance import Values


@dataclass(frozen=True, eq=False)
class Symmetry:
    """Symmetry x(T/p) = S x(0) of an orbit. turn: orthogonal matrix, (d, d), by which S multiplies the
    components of every stress and velocity. parts: p.
    """

    turn: Array
    parts: int

    def of(self, x: Values, layout: StateLayout) -> Values:
        """S x for states x, (..., unknowns)."""
        S = layout.stresses(x)
        V = np.zeros((layout.components, *x.shape[:-1], layout.nodes + 1), x.dtype)
        V[list(layout.unknown_velocities)] = layout.velocities(x)
        return layout.state(np.tensordot(self.turn, S, 1), np.tensordot(self.turn, V, 1))

    def matrix(self, layout: StateLayout) -> Array:
        """The matrix S, (unknowns, unknowns); it is cached, so callers must not change it."""
        return _matrix(self, layout)

    def returned(self, flow: Array, layout: StateLayout) -> Array:
        """S^-1 `flow`, (unknowns, unknowns), where `flow` is the derivative of x(T/p) by x(0)."""
        # S is orthogonal, so its transpose is its inverse.
        returned: Array = self.matrix(layout).T @ flow
        return returned

    def reversed(self, layout: StateLayout) -> Array:
        """1 for components of a state that S reverses, 0 for components that S keeps, (unknowns,)."""
        return (1 - self.of(np.ones(layout.unknowns), layout)) / 2


@lru_cache(maxsize=ELEMENTS.max_meshes)
def _matrix(symmetry: Symmetry, layout: StateLayout) -> Array:
    """`Symmetry.matrix`, (unknowns, unknowns)."""
    return np.ascontiguousarray(symmetry.of(np.eye(layout.unknowns), layout).T)


NO_SYMMETRY = Symmetry(np.eye(3), 1)
"""Symmetry of an orbit that is not its own mirror image: p = 1, S = 1."""
REFLECTION = Symmetry(np.diag([1.0, -1.0, -1.0]), 2)
"""Symmetry of an orbit that equals its mirror image half a period later."""
