"""Symmetry of an orbit with period T: x(T/p) = S x(0), x: state, p: positive integer.

S is the same rotation or reflection of the body frame at all nodes. The reflection in the line of the
straight rod leaves n1 and v1 unchanged and changes the sign of n2, m3, v2 and Omega; the mirror image of a
motion is a motion. The phase condition (`phase_condition`) is the same for orbits with and without the
reflection.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...arrays import Array
from ...discretization.elements.elements import ELEMENT_SETTINGS
from ...discretization.state_layout import StateLayout
from ...model.balance import Values


@dataclass(frozen=True, eq=False)
class Symmetry:
    """Symmetry x(T/p) = S x(0) of an orbit. component_matrix: orthogonal matrix, (d, d), by which S
    multiplies the d stress components and the d velocity components at every node. solved_parts_per_period:
    p. In the methods, `layout` is the layout of the unknowns of a state."""

    component_matrix: Array
    solved_parts_per_period: int

    def apply(self, x: Values, layout: StateLayout) -> Values:
        """The states S x for the states x, (..., unknowns)."""
        S = layout.stresses(x)
        V = np.zeros((layout.component_count, *x.shape[:-1], layout.node_count + 1), x.dtype)
        V[list(layout.unknown_velocity_components)] = layout.velocities(x)
        return layout.state(
            np.tensordot(self.component_matrix, S, 1), np.tensordot(self.component_matrix, V, 1)
        )

    def matrix(self, layout: StateLayout) -> Array:
        """Matrix of the symmetry operation S on a state, (unknowns, unknowns). The matrix is cached; callers
        must not change it."""
        return _cached_matrix(self, layout)

    def apply_inverse_to_flow(self, flow: Array, layout: StateLayout) -> Array:
        """S^-1 `flow`, (unknowns, unknowns). flow: derivative of x(T/p) with respect to x(0), (unknowns,
        unknowns)."""
        # S is orthogonal, so its transpose is its inverse.
        product: Array = self.matrix(layout).T @ flow
        return product

    def reversal_mask(self, layout: StateLayout) -> Array:
        """1 for components of a state that change sign under S, 0 for components that S leaves unchanged,
        (unknowns,)."""
        return (1 - self.apply(np.ones(layout.unknown_count), layout)) / 2


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _cached_matrix(symmetry: Symmetry, layout: StateLayout) -> Array:
    """The cached matrix that `Symmetry.matrix` returns, (unknowns, unknowns)."""
    return np.ascontiguousarray(symmetry.apply(np.eye(layout.unknown_count), layout).T)


NO_SYMMETRY = Symmetry(np.eye(3), 1)
"""No symmetry: p = 1, and S is the identity."""
REFLECTION = Symmetry(np.diag([1.0, -1.0, -1.0]), 2)
"""Symmetry of an orbit that equals its own mirror image half a period later."""
