"""Compliances, drags and strains at rest of an arm at the nodes of a mesh, and their derivatives by a
parameter.

At a node between two elements a coefficient may jump. The mass is lumped, so the equations of such a node
contain the mean of the coefficient over both sides, weighted with the quadrature weights. If elements end at
the jumps, this mean does not reduce the order of accuracy. For a linear law the mean compliance gives the
mean strain for a given stress; for another law the strain of each side must be computed
(`rodsweep.model.material.jump`). Shapes need the strains of both sides for every law (`element_strains`).
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..model.balance import BalanceCoefficients
from ..model.material.jump import SHEAR_COMPLIANCE_COLUMN
from ..model.material.laws import LINEAR_CONSTITUTIVE_LAW
from ..model.material.rod_material import CrossSections, RodMaterial
from ..model.rod import Rod
from .elements.elements import ELEMENT_SETTINGS
from .elements.mesh import Mesh
from .nodal_rod import NO_JUMP_DERIVATIVE, NO_JUMPS, IntegerArray, Jumps


def balance_coefficients_at_nodes(rod: Rod, mesh: Mesh) -> BalanceCoefficients:
    """Coefficients of the balance of a rod at the nodes of a mesh; compliance, drag and straight_state_strain
    are constants, (3,), for a uniform rod of linear material, and (3, nodes + 1) for any other arm. Elements
    of the mesh must end at the breaks of the arm's profile."""
    if rod.is_uniform_and_linear:
        return rod.balance_coefficients
    compliance, drag, rest_strain = _mean_coefficients_at_nodes(_sections_inside_elements(rod, mesh), mesh)
    return BalanceCoefficients(compliance, drag, rod.F, rest_strain)


def balance_coefficient_derivatives_at_nodes(
    rod: Rod, parameter_name: str, mesh: Mesh
) -> BalanceCoefficients:
    """The derivative of `balance_coefficients_at_nodes` with respect to the coordinate of the parameter
    `parameter_name`: 1/k for a stiffness k, else the parameter itself."""
    if rod.is_uniform_and_linear and parameter_name != "taper":
        return rod.balance_coefficient_derivative(parameter_name)
    sections = _sections_inside_elements(rod, mesh)
    derivatives = rod.cross_section_derivatives(parameter_name, mesh.one_sided_nodes, sections)
    compliance, drag, rest_strain = _mean_coefficients_at_nodes(derivatives, mesh)
    return BalanceCoefficients(compliance, drag, 1.0 if parameter_name == "F" else 0.0, rest_strain)


def relative_bending_compliance_at_nodes(material: RodMaterial, mesh: Mesh) -> Array:
    """Bending compliance c3(u)/c3(0) at all nodes, (nodes + 1,), of an arm without taper and of the material
    `material`. At a jump the value is the mean of both sides; its product with m3 is the mean bending
    strain."""
    if material.profile is None:
        return np.ones(mesh.node_count + 1)
    return _mean_at_nodes(material.relative_compliances(1.0, mesh.one_sided_nodes)[2:], mesh)[0]


def jumps_on_mesh(rod: Rod, mesh: Mesh) -> Jumps:
    """The nodes of a mesh at which the material of a rod jumps, and the material on both sides of each
    jump."""
    indices, nodes = _jump_side_indices_and_nodes(rod.material, mesh)
    if not len(nodes):
        return NO_JUMPS
    sections = _sections_inside_elements(rod, mesh)
    c1, c2, c3 = sections.compliance
    # The cached array is shared by all rods with this taper, so its columns are filled in a copy.
    sides = _side_weights_at_jumps(rod.material, rod.taper, mesh).copy()
    for column, values in enumerate((sections.nu, c1, c3)):
        sides[..., column] = values[indices]
    sides[..., SHEAR_COMPLIANCE_COLUMN] = c2[indices]
    return Jumps(nodes, sides)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _side_weights_at_jumps(material: RodMaterial, taper: float, mesh: Mesh) -> Array:
    """Array in the order of `JUMP_SIDE_COLUMNS` for both sides of every jump of an arm, (k, 2, 7): the
    weights of the two sides in the mean strains and the mean stress at the jump; 0 for the coefficients,
    which depend on the rod. Cached, because the weights are independent of all parameters except the
    taper."""
    indices, _ = _jump_side_indices_and_nodes(material, mesh)
    points = mesh.one_sided_nodes[indices]
    weights = _one_sided_node_points(mesh).quadrature_weights[indices]
    relative_compliances = material.relative_compliances(taper, points.ravel()).reshape(3, *points.shape)
    # The mean strain is weighted by quadrature; in means of stresses the compliances of the sides count too.
    strain_weights = [
        values / values.sum(axis=1, keepdims=True)
        for values in (weights * relative_compliances[0], weights * relative_compliances[2])
    ]
    mean_weights = weights / weights.sum(axis=1, keepdims=True)
    coefficients = np.zeros(points.shape)
    # In the order of `JUMP_SIDE_COLUMNS`; the coefficients, here 0, are filled in for each rod.
    shares = [coefficients, coefficients, coefficients, *strain_weights, mean_weights, coefficients]
    return np.ascontiguousarray(np.stack(shares, axis=-1))


def jump_derivatives(rod: Rod, parameter_name: str, mesh: Mesh) -> Array:
    """Derivatives of nu, c1 and c3 on both sides of each jump with respect to the coordinate of the parameter
    `parameter_name`, (k, 2, 3). Returns `NO_JUMP_DERIVATIVE` for a rod without jumps and for a linear law,
    for which the stress at a jump depends only on the mean strain."""
    indices, nodes = _jump_side_indices_and_nodes(rod.material, mesh)
    if rod.material.constitutive_law is LINEAR_CONSTITUTIVE_LAW or not len(nodes):
        return NO_JUMP_DERIVATIVE
    derivatives = rod.cross_section_derivatives(parameter_name, mesh.one_sided_nodes[indices].ravel())
    c1, _, c3 = derivatives.compliance
    return np.ascontiguousarray(np.stack([derivatives.nu, c1, c3], axis=-1).reshape(*indices.shape, 3))


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _sections_inside_elements(rod: Rod, mesh: Mesh) -> CrossSections:
    """Properties of the cross-sections of a rod at the `one_sided_nodes` of a mesh. Cached, because the
    coefficients at the nodes, the jumps and the derivatives all need them."""
    return rod.cross_sections_at(mesh.one_sided_nodes)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _jump_side_indices_and_nodes(material: RodMaterial, mesh: Mesh) -> tuple[IntegerArray, IntegerArray]:
    """Returns (indices, nodes) of the k jumps, cached. indices: index, in `Elements.one_sided_nodes`, of the
    last point of the element before each jump and of the first point of the element behind it, (k, 2). nodes:
    index of the node at each jump, (k,)."""
    jumps = material.jump_positions
    # The comparison is exact, because meshes take the positions of jumps as edges unchanged.
    elements_behind_jumps = np.array(
        [e for e in range(1, mesh.element_count) if mesh.edges[e] in jumps], np.int64
    )
    nodes = np.array([mesh.node_ranges[e].start for e in elements_behind_jumps], np.int64)
    # Each element before the jump has added one point, since its last node is listed twice.
    right_indices = nodes + elements_behind_jumps
    return np.stack([right_indices - 1, right_indices], axis=-1), nodes


def _mean_coefficients_at_nodes(sections: CrossSections, mesh: Mesh) -> tuple[Array, Array, Array]:
    """Returns (compliance, drag, strain at rest) at all nodes, (3, nodes + 1) each. sections: the
    coefficients at the `one_sided_nodes` of the mesh, or derivatives of the coefficients."""
    mean = _mean_at_nodes(np.concatenate([sections.compliance, sections.drag, sections.nu[None]]), mesh)
    rest_strain = np.zeros((3, mesh.node_count + 1))
    rest_strain[0] = mean[6]
    return mean[:3], mean[3:6], rest_strain


def _mean_at_nodes(values: Array, mesh: Mesh) -> Array:
    """Means over both sides of each node, (m, nodes + 1). values: m fields at the `one_sided_nodes`,
    (m, points)."""
    points = _one_sided_node_points(mesh)
    # The points of a node are neighbours, so `reduceat` adds the one or two sides of each node.
    mean: Array = (
        np.add.reduceat(points.quadrature_weights * values, points.first_point_indices, axis=1)
        / mesh.quadrature_weights
    )
    return mean


class OneSidedNodePoints(NamedTuple):
    """The points of `one_sided_nodes` of a mesh, in order: one at a node inside an element, two at a node
    between two elements. first_point_indices: index of the first point at each node, (nodes + 1,).
    quadrature_weights: quadrature weight of each point within its element, (nodes + elements,)."""

    first_point_indices: IntegerArray
    quadrature_weights: Array


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _one_sided_node_points(mesh: Mesh) -> OneSidedNodePoints:
    """The `OneSidedNodePoints` of a mesh, cached."""
    weights = np.concatenate(mesh.quadrature_weights_of_elements)
    return OneSidedNodePoints(np.unique(mesh.element_node_indices, return_index=True)[1], weights)
