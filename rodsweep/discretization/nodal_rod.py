"""One rod at the nodes of a mesh: compliances and drags as arrays over these, for compiled functions."""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..model.balance import Material
from .mesh import NodeMatrices


class NodalRod(NamedTuple):
    """A rod at all nodes of a mesh, the tip included, as the compiled functions take it; of d components.

    tip_stress: Sigma(1), (d,). rest: E0, with compliance and drag (d, nodes + 1); mobility: 1/drag, but 0
    where V is unknown. second: -D^T W mobility D, (d, nodes + 1, nodes + 1). kept: which components of V are
    unknowns.
    """

    tip_stress: Array
    rest: Array
    compliance: Array
    drag: Array
    mobility: Array
    second: Array
    kept: Array


class NodalChange(NamedTuple):
    """The derivative of a `NodalRod` along a parameter, of what the equations have of it."""

    tip_stress: Array
    rest: Array
    compliance: Array
    drag: Array


def nodal_rod(material: Material, m: NodeMatrices, kept: tuple[int, ...] = ()) -> NodalRod:
    """A material on a mesh, of which these components of V are unknowns."""
    rest, compliance, drag, mobility = _at_nodes(material, len(m.weights))
    for a in range(len(drag)):
        if a not in kept:
            mobility[a] = 1 / drag[a]
    second = m.weak @ (mobility[:, :, None] * m.D)
    known = material.tip_stress, rest, compliance, drag, mobility, second
    return NodalRod(*known, np.array(kept, np.int64))


def nodal_change(change: Material, m: NodeMatrices) -> NodalChange:
    """A change of a material on a mesh."""
    rest, compliance, drag, _ = _at_nodes(change, len(m.weights))
    return NodalChange(change.tip_stress, rest, compliance, drag)


def _at_nodes(material: Material, size: int) -> Array:
    """rest, compliance and drag of every component at every node, and zeros, (4, d, size)."""
    out = np.zeros((4, len(material.drag), size))
    for rows, field in zip(out, (material.rest, material.compliance, material.drag), strict=False):
        rows[:] = field.reshape(len(field), -1)
    return out
