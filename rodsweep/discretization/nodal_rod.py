"""One rod at the nodes of a mesh: compliances and drags as arrays over these, for compiled functions."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model.balance import Material
from ..model.material.jump import COLUMNS
from .elements.mesh import Mesh

Integers = NDArray[np.int64]


class NodalRod(NamedTuple):
    """A rod at all nodes of a mesh, the tip included, as the compiled functions take it; of d components.

    tip_stress: Sigma(1), (d,). rest: E0, with compliance and drag (d, nodes + 1); mobility: 1/drag, but 0
    where V is unknown. second: -D^T W mobility D, (d, nodes + 1, nodes + 1). kept: which components of V are
    unknowns. law: number of the constitutive law, see `rodsweep.model.material.response`. jumps: nodes at
    which the material of a rod jumps whose law is not linear, increasing, (k,). sides: of these nodes, see
    `rodsweep.model.material.jump`, (k, 2, 6).
    """

    tip_stress: Array
    rest: Array
    compliance: Array
    drag: Array
    mobility: Array
    second: Array
    kept: Integers
    law: int
    jumps: Integers
    sides: Array


class Jumps(NamedTuple):
    """`jumps` and `sides` of a `NodalRod`."""

    nodes: Integers
    sides: Array


NO_JUMPS = Jumps(np.zeros(0, np.int64), np.zeros((0, 2, len(COLUMNS))))
"""Of a rod without jumps, or of linear material, of which the mean over both sides is all that counts."""
NO_CHANGE = np.zeros((0, 2, 3))
"""`sides` of a change of such a rod."""


class NodalChange(NamedTuple):
    """The derivative of a `NodalRod` along a parameter, of what the equations have of it."""

    tip_stress: Array
    rest: Array
    compliance: Array
    drag: Array
    sides: Array
    """Of nu, c1 and c3 on both sides of each jump, (k, 2, 3)."""


def nodal_rod(
    material: Material, grid: Mesh, kept: tuple[int, ...] = (), law: int = 0, jumps: Jumps = NO_JUMPS
) -> NodalRod:
    """A material on a mesh, of which these components of V are unknowns."""
    size = grid.nodes + 1
    rest, compliance = _at_nodes(material.rest, size), _at_nodes(material.compliance, size)
    resistance = _resistance_of(material.drag.tobytes(), material.drag.shape, grid, kept)
    return NodalRod(material.tip_stress, rest, compliance, *resistance, law, *jumps)


def nodal_change(change: Material, grid: Mesh, sides: Array = NO_CHANGE) -> NodalChange:
    """A change of a material on a mesh; sides: as in `NodalChange`, (k, 2, 3)."""
    fields = change.rest, change.compliance, change.drag
    rest, compliance, drag = (_at_nodes(field, grid.nodes + 1) for field in fields)
    return NodalChange(change.tip_stress, rest, compliance, drag, sides)


@lru_cache(maxsize=64)
def _resistance_of(
    drag: bytes, shape: tuple[int, ...], grid: Mesh, kept: tuple[int, ...]
) -> tuple[Array, Array, Array, Integers]:
    """`_resistance` of a drag as bytes: rods of a chain over F share it."""
    values = np.frombuffer(drag).reshape(shape)
    return _resistance(values if len(shape) > 1 else values[:, None], grid, kept)


def _resistance(drag: Array, grid: Mesh, kept: tuple[int, ...]) -> tuple[Array, Array, Array, Integers]:
    """drag, mobility, second and kept of a `NodalRod`."""
    drag = _at_nodes(drag, grid.nodes + 1)
    mobility, eliminated = np.zeros(drag.shape), [a for a in range(len(drag)) if a not in kept]
    mobility[eliminated] = 1 / drag[eliminated]
    second = grid.matrices.weak @ (mobility[:, :, None] * grid.matrices.D)
    return drag, mobility, second, np.array(kept, np.int64)


def _at_nodes(field: Array, size: int) -> Array:
    """A constant of each component, or one at each node, at all nodes, (d, size)."""
    out = np.empty((len(field), size))
    out[:] = field.reshape(len(field), -1)
    return out
