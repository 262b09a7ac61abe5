"""Compliances, drags and straight state of an arm at the nodes of a mesh, and their parameter derivatives.

A coefficient may jump at a node between two elements. The mass is lumped, so the equations of the node
contain the mean of both sides, weighted by the quadrature. For a linear law this keeps the accuracy of the
mesh if elements end at the jumps. For another law s(S) differs on both sides, and jumps are refused.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model.balance import Material
from ..model.material.build import Sections
from ..model.material.laws import LINEAR
from ..model.rod import Rod
from .elements.mesh import Mesh
from .elements.quadrature import gauss_lobatto


def material_on(rod: Rod, grid: Mesh) -> Material:
    """The material of a rod on a mesh: (3,) arrays for a standard rod, (3, nodes + 1) for other arms.

    The elements must end at the breaks of the profile. Raises ValueError for a jump combined with a law that
    is not linear.
    """
    if not (rod.build.continuous or rod.build.constitutive_law is LINEAR):
        raise ValueError("the nonlinear motion of an arm whose profile jumps needs law = linear")
    if rod.standard:
        return rod.material
    compliance, drag, rest = _at_nodes(rod.sections(grid.points_inside.ravel()), grid)
    return Material(compliance, drag, rod.F, rest)


def material_change_on(rod: Rod, name: str, grid: Mesh) -> Material:
    """The derivative of `material_on` with respect to the coordinate of a parameter."""
    if rod.standard and name != "taper":
        return rod.material_change(name)
    compliance, drag, rest = _at_nodes(rod.section_changes(name, grid.points_inside.ravel()), grid)
    return Material(compliance, drag, 1.0 if name == "F" else 0.0, rest)


def _at_nodes(sections: Sections, grid: Mesh) -> tuple[Array, Array, Array]:
    """Compliance, drag and strain at rest, or their derivatives, at all nodes, (3, nodes + 1) each."""
    node, weights = _node_weights(grid)

    def mean(values: Array) -> Array:
        return np.array([np.bincount(node, weights * row) for row in values]) / grid.quadrature

    rest = np.zeros_like(sections.drag)
    rest[0] = sections.nu
    return mean(sections.compliance), mean(sections.drag), mean(rest)


@lru_cache(maxsize=64)
def _node_weights(grid: Mesh) -> tuple[NDArray[np.int64], Array]:
    """(node, quadrature weight) of each of the mesh's `points_inside`, (elements (order + 1),) each."""
    nodes = np.arange(grid.elements)[:, None] * grid.order + np.arange(grid.order + 1)
    weights = grid.lengths[:, None] / 2 * gauss_lobatto(grid.order)[1]
    return nodes.ravel(), weights.ravel()
