"""Symmetry of an orbit: after a part of its period the state is S times the first state, x(T/p) = S x(0).

S rotates or reflects the body frame, alike at all nodes. The reflection on the line of the straight rod keeps
n1 and v1 and reverses n2, m3, v2 and Omega; it maps motions to motions. A single phase condition, that of
`phase`, serves both symmetries of the plane.
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
    """The symmetry S of an orbit, and the number p of its parts. S is stored as an orthogonal matrix, (d, d),
    for the components of a stress; the matrix also applies to velocities.
    """

    turn: Array
    parts: int

    def of(self, x: Values, layout: StateLayout) -> Values:
        """S x of states (..., unknowns)."""
        S = layout.stresses(x)
        V = np.zeros((layout.components, *x.shape[:-1], layout.nodes + 1), x.dtype)
        V[list(layout.unknown_velocities)] = layout.velocities(x)
        return layout.state(np.tensordot(self.turn, S, 1), np.tensordot(self.turn, V, 1))

    def matrix(self, layout: StateLayout) -> Array:
        """S, (unknowns, unknowns), shared by all callers and not to be changed."""
        return _matrix(self, layout)

    def returned(self, flow: Array, layout: StateLayout) -> Array:
        """S^-1 times the derivative of the flow over T/p, (unknowns, unknowns)."""
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
"""Symmetry of an orbit that closes only after its whole period."""
REFLECTION = Symmetry(np.diag([1.0, -1.0, -1.0]), 2)
"""Symmetry of an orbit that equals its mirror image half a period later."""
