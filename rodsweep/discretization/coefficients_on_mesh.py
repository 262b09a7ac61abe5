"""Compliances, drags and strains at rest of an arm at the nodes of a mesh, and their derivatives by a
parameter.

At a node between two elements a coefficient may jump. The mass is lumped, so the equations of such a node
contain the mean of the coefficient over both sides, weighted with the quadrature weights. If elements end at
the jumps, this mean does not reduce the order of accuracy. For a linear law the mean compliance gives the
mean strain for a given stress; for another law the strain of each side must be computed
(`rodsweep.model.material.jump`). Shapes need the strains of both sides for every law (`element_strains`).
"""

from functools import lru_cache

import numpy as np

from ..arrays import Array
from ..model.balance import BalanceCoefficients
from ..model.material.laws import LINEAR
from ..model.material.rod_material import CrossSections, RodMaterial
from ..model.rod import Rod
from .elements.elements import ELEMENT_SETTINGS
from .elements.mesh import Mesh
from .elements.quadrature import gauss_lobatto_rule
from .nodal_rod import NO_JUMP_DERIVATIVE, NO_JUMPS, IntegerArray, Jumps


def balance_coefficients_at_nodes(rod: Rod, mesh: Mesh) -> BalanceCoefficients:
    """Coefficients of the balance of a rod at the nodes of a mesh; compliance, drag and rest_strain are
    constants, (3,), for a uniform rod of linear material, and (3, nodes + 1) for any other arm. Elements of
    the mesh must end at the breaks of the arm's profile."""
    if rod.is_uniform_and_linear:
        return rod.balance_coefficients
    compliance, drag, rest_strain = _mean_coefficients_at_nodes(rod.sections(mesh.one_sided_nodes), mesh)
    return BalanceCoefficients(compliance, drag, rod.F, rest_strain)


def balance_coefficient_derivatives_at_nodes(rod: Rod, name: str, mesh: Mesh) -> BalanceCoefficients:
    """The derivative of `balance_coefficients_at_nodes` with respect to the coordinate of the parameter
    `name`: 1/k for a stiffness k, else the parameter itself."""
    if rod.is_uniform_and_linear and name != "taper":
        return rod.balance_coefficient_derivative(name)
    compliance, drag, rest = _mean_coefficients_at_nodes(
        rod.section_derivatives(name, mesh.one_sided_nodes), mesh
    )
    return BalanceCoefficients(compliance, drag, 1.0 if name == "F" else 0.0, rest)


def relative_bending_compliance_at_nodes(material: RodMaterial, mesh: Mesh) -> Array:
    """Bending compliance c3(u)/c3(0) at all nodes, (nodes + 1,), of an arm without taper and of the material
    `material`. At a jump the value is the mean of both sides, so that times m3 it is the mean bending
    strain."""
    if material.profile is None:
        return np.ones(mesh.node_count + 1)
    return _mean_at_nodes(material.relative_compliances(1.0, mesh.one_sided_nodes)[2:], mesh)[0]


def jumps_on_mesh(rod: Rod, mesh: Mesh) -> Jumps:
    """The nodes of a mesh at which the material of a rod jumps, and the material on both sides of them."""
    indices, nodes = _indices_beside_jumps(rod.material, mesh)
    if not len(nodes):
        return NO_JUMPS
    points = mesh.one_sided_nodes[indices]
    weights = _nodes_and_weights_of_points(mesh)[1][indices]
    sections = rod.sections(points.ravel())
    c1, c2, c3 = sections.compliance.reshape(3, *points.shape)
    relative_compliances = rod.material.relative_compliances(rod.taper, points.ravel()).reshape(
        3, *points.shape
    )
    fractions = [
        values / values.sum(axis=1, keepdims=True)
        for values in (weights * relative_compliances[0], weights * relative_compliances[2])
    ]
    mean = weights / weights.sum(axis=1, keepdims=True)
    sides = np.stack([sections.nu.reshape(points.shape), c1, c3, *fractions, mean, c2], axis=-1)
    return Jumps(nodes, np.ascontiguousarray(sides))


def jump_derivatives(rod: Rod, name: str, mesh: Mesh) -> Array:
    """Derivatives of nu, c1 and c3 on both sides of each jump with respect to the coordinate of the parameter
    `name`, (k, 2, 3). Returns `NO_JUMP_DERIVATIVE` for a rod without jumps and for a linear law, for which
    the stress at a jump depends only on the mean strain."""
    indices, nodes = _indices_beside_jumps(rod.material, mesh)
    if rod.material.constitutive_law is LINEAR or not len(nodes):
        return NO_JUMP_DERIVATIVE
    changes = rod.section_derivatives(name, mesh.one_sided_nodes[indices].ravel())
    c1, _, c3 = changes.compliance
    return np.ascontiguousarray(np.stack([changes.nu, c1, c3], axis=-1).reshape(*indices.shape, 3))


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _indices_beside_jumps(material: RodMaterial, mesh: Mesh) -> tuple[IntegerArray, IntegerArray]:
    """Returns (points, nodes) of the k jumps. points: indices in the `one_sided_nodes` of the
    points left and right of each jump, (k, 2). nodes: node of each jump, (k,). Cached."""
    jumps = material.jump_positions
    ends = np.array([e for e in range(1, mesh.element_count) if mesh.edges[e] in jumps], np.int64)
    nodes = np.array([mesh.node_ranges[e].start for e in ends], np.int64)
    right_indices = nodes + ends
    return np.stack([right_indices - 1, right_indices], axis=-1), nodes


def _mean_coefficients_at_nodes(sections: CrossSections, mesh: Mesh) -> tuple[Array, Array, Array]:
    """Returns (compliance, drag, strain at rest) at all nodes, (3, nodes + 1) each. sections: the
    coefficients at the `one_sided_nodes` of the mesh, or derivatives of the coefficients."""
    rest_strain = np.zeros_like(sections.drag)
    rest_strain[0] = sections.nu
    compliance, drag, rest_strain = (
        _mean_at_nodes(values, mesh) for values in (sections.compliance, sections.drag, rest_strain)
    )
    return compliance, drag, rest_strain


def _mean_at_nodes(values: Array, mesh: Mesh) -> Array:
    """Means over both sides of each node, (m, nodes + 1). values: m fields at the `one_sided_nodes`,
    (m, points)."""
    element, weights = _nodes_and_weights_of_points(mesh)
    mean: Array = np.array([np.bincount(element, weights * row) for row in values]) / mesh.quadrature
    return mean


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _nodes_and_weights_of_points(mesh: Mesh) -> tuple[IntegerArray, Array]:
    """Returns (nodes, weights) of all `one_sided_nodes`, (nodes + elements,) each: node of the mesh,
    and quadrature weight within the element."""
    parts = zip(mesh.lengths, mesh.orders, strict=True)
    weights = np.concatenate([length / 2 * gauss_lobatto_rule(order)[1] for length, order in parts])
    return mesh.element_nodes, weights
