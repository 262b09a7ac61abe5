"""How an orbit closes: after a part of its period the state is S times the first one, x(T/p) = S x(0).

S turns or reflects the body frame, at all nodes alike. Reflecting the plane on the line of the straight rod
leaves n1 and v1 and reverses n2 and m3, v2 and Omega; it maps motions to motions. One condition of phase goes
with either symmetry of the plane, that of `phase`.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...arrays import Array
from ...discretization.state_layout import StateLayout
from ...model.balance import Values


@dataclass(frozen=True, eq=False)
class Symmetry:
    """S by what it does to the components of a stress, orthogonal, (d, d), and p.

    Velocities, of the dual, are turned alike.
    """

    turn: Array
    parts: int

    def of(self, x: Values, layout: StateLayout) -> Values:
        """S x of states (..., unknowns)."""
        S, V = layout.stresses(x), np.zeros((layout.components, *x.shape[:-1], layout.nodes + 1), x.dtype)
        V[list(layout.kept)] = layout.velocities(x)
        return layout.state(np.tensordot(self.turn, S, 1), np.tensordot(self.turn, V, 1))

    def matrix(self, layout: StateLayout) -> Array:
        """S, (unknowns, unknowns), which no caller may change."""
        return _matrix(self, layout)

    def returned(self, flow: Array, layout: StateLayout) -> Array:
        """S^-1 times the derivative of the flow over a part of the period, (unknowns, unknowns)."""
        returned: Array = self.matrix(layout).T @ flow
        return returned

    def reversed(self, layout: StateLayout) -> Array:
        """1 for what S reverses of a state, and 0 for what it leaves, (unknowns,)."""
        return (1 - self.of(np.ones(layout.unknowns), layout)) / 2


@lru_cache(maxsize=64)
def _matrix(symmetry: Symmetry, layout: StateLayout) -> Array:
    """`Symmetry.matrix`, (unknowns, unknowns)."""
    return np.ascontiguousarray(symmetry.of(np.eye(layout.unknowns), layout).T)


NONE = Symmetry(np.eye(3), 1)
"""The orbit closes after its whole period, no earlier."""
REFLECTION = Symmetry(np.diag([1.0, -1.0, -1.0]), 2)
"""Half a period later the orbit is its own mirror image."""
