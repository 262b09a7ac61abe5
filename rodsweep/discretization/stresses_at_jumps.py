"""Stresses of a rod on both sides of the jumps of its material.

S is the stress of a linear rod with the same strain. For a nonlinear law S has different values on the two
sides of a jump (`rodsweep.model.material.jump`); the unknown at the node of the jump is the mean of both
values. S is smooth within each element.
"""

from functools import lru_cache

import numpy as np

from ..arrays import Array
from ..model.balance import Values
from ..model.compiled.compilation import compiled
from ..model.material.jump import LawUnknowns, unknowns_before_jump, unknowns_behind_jump
from ..model.material.laws import LINEAR_CONSTITUTIVE_LAW
from ..model.rod import Rod
from .coefficients_on_mesh import jumps_on_mesh
from .element_strains import index_before_jump
from .elements.basis import lagrange_interpolation_matrix
from .elements.elements import ELEMENT_SETTINGS
from .elements.mesh import Mesh, interpolation_matrix
from .elements.quadrature import gauss_lobatto_rule
from .nodal_rod import NO_JUMPS, IntegerArray, NodalRod

STRETCHING_STRESS_INDEX = 0
BENDING_STRESS_INDEX = 2
"""STRETCHING_STRESS_INDEX, BENDING_STRESS_INDEX: indices of the stretching stress S1 and of the bending
stress S3, the components of S that jump."""
DISCONTINUOUS_STRESS_COMPONENTS = STRETCHING_STRESS_INDEX, BENDING_STRESS_INDEX
"""Indices of the components of S that are discontinuous at a jump."""
SIDE_WEIGHT_COLUMNS = 3, 4
"""Indices in JUMP_SIDE_COLUMNS of the weights of a side in the means of S1 and of S3 over both sides."""


@compiled
def write_law_unknowns_beside_jump(law: int, sides: Array, q1: Array, q3: Array, out: Array) -> None:
    """Writes the unknowns q1 and q3 of a law (see `LawUnknowns`) on both sides of a jump into out, (4, m):
    q1, q3 before the jump, then q1, q3 behind the jump. law: number of the constitutive law. sides: the
    material on both sides, (2, 7), with the columns JUMP_SIDE_COLUMNS. q1, q3: means over both sides,
    (m,)."""
    for i in range(len(q1)):
        q = LawUnknowns(q1[i], q3[i])
        a = unknowns_before_jump(law, sides, q)
        b = unknowns_behind_jump(sides, q, a)
        out[0, i] = a.q1
        out[1, i] = a.q3
        out[2, i] = b.q1
        out[3, i] = b.q3


def stresses_at_both_sides(rod: NodalRod, S: Array) -> Array:
    """S1 and S3 on both sides of each jump, (k, 2, 2, ...), with axes (jump, side, stress, ...). S: (3, ...,
    nodes + 1), with the mean of both sides at a jump."""
    side_stresses = np.empty((len(rod.jump_nodes), 2, 2, *S.shape[1:-1]))
    for stresses, node, sides in zip(side_stresses, rod.jump_nodes, rod.jump_side_coefficients, strict=True):
        q1, q3 = (
            np.ascontiguousarray(S[a, ..., node]).ravel()
            for a in (STRETCHING_STRESS_INDEX, BENDING_STRESS_INDEX)
        )
        columns = np.empty((4, q1.size))
        write_law_unknowns_beside_jump(rod.law_number, sides, q1, q3, columns)
        stresses[...] = columns.reshape(stresses.shape)
    return side_stresses


def stresses_by_element(rod: NodalRod, mesh: Mesh, S: Array) -> Array:
    """S at the nodes of every element, (3, ..., nodes + elements); the elements left and right of a jump have
    the values of the left and the right side. S: (3, ..., nodes + 1), with the mean of both sides at a
    jump."""
    element_stresses: Array = S[..., mesh.element_node_indices]
    for node, sides in zip(rod.jump_nodes, stresses_at_both_sides(rod, S), strict=True):
        index = index_before_jump(int(node), mesh.element_node_indices)
        for side, values in enumerate(sides):
            for component, value in zip(DISCONTINUOUS_STRESS_COMPONENTS, values, strict=True):
                element_stresses[component, ..., index + side] = value
    return element_stresses


def interpolate_stress(rod: Rod, S: Values, source: Mesh, target: Mesh) -> Values:
    """S at all nodes of the mesh `target`, (3, ..., target nodes + 1), from S at all nodes of `source`,
    (3, ..., nodes + 1).

    The map is linear. At a jump of `source`, S is a mean and not a value of the polynomial on either side;
    these polynomials are therefore interpolated from the other nodes of their elements. At a jump of
    `target`, the new S is the mean of the values of the polynomials on both sides.
    """
    E = interpolation_matrix(source, target)
    target_S = S @ E.T
    target_jumps = (
        NO_JUMPS if rod.material.constitutive_law is LINEAR_CONSTITUTIVE_LAW else jumps_on_mesh(rod, target)
    )
    if len(target_jumps.jump_nodes):
        source_nodes = jumps_on_mesh(rod, source).jump_nodes
        for column, component in zip(SIDE_WEIGHT_COLUMNS, DISCONTINUOUS_STRESS_COMPONENTS, strict=True):
            target_S[component] = (
                S[component]
                @ _interpolation_matrix_with_jumps(
                    E,
                    source,
                    target,
                    source_nodes,
                    target_jumps.jump_nodes,
                    target_jumps.jump_side_coefficients[..., column],
                ).T
            )
    return target_S


def interpolate_state_stress(nodal: NodalRod, S: Values, source: Mesh, rod: Rod, target: Mesh) -> Values:
    """S at all nodes of the mesh `target`, (3, ..., target nodes + 1), from the S of states at all nodes of
    `source`, (3, ..., nodes + 1). nodal: the rod `rod`, whose law is not linear, at the nodes of `source`.

    In the two elements at a jump, the value of the polynomial at the jump is the stress on the side of the
    element, computed from the mean of both sides. `interpolate_stress` extrapolates this value instead, which
    is less accurate by an order of magnitude, but linear.
    """
    E = interpolation_matrix(source, target)
    target_S = S @ E.T
    target_jumps = jumps_on_mesh(rod, target)
    element = np.searchsorted(source.edges, target.node_positions, side="right") - 1
    sides_of_jumps = stresses_at_both_sides(nodal, S)
    for node, values in zip(nodal.jump_nodes, sides_of_jumps, strict=True):
        for side, side_values in enumerate(values):
            rows = element == _element_starting_at(source, node) - 1 + side
            for component, value in zip(DISCONTINUOUS_STRESS_COMPONENTS, side_values, strict=True):
                # Each side has its own value at the node of the jump, so only the share of this node changes.
                target_S[component][..., rows] += (value - S[component, ..., node])[..., None] * E[rows, node]
    for node, sides, values in zip(
        target_jumps.jump_nodes, target_jumps.jump_side_coefficients, sides_of_jumps, strict=True
    ):
        for i, component in enumerate(DISCONTINUOUS_STRESS_COMPONENTS):
            fractions = sides[:, SIDE_WEIGHT_COLUMNS[i]]
            target_S[component, ..., node] = np.tensordot(fractions, values[:, i], 1)
    return target_S


def _interpolation_matrix_with_jumps(  # noqa: PLR0913, PLR0917 - of both meshes
    E: Array,
    source: Mesh,
    target: Mesh,
    source_nodes: IntegerArray,
    target_nodes: IntegerArray,
    fractions: Array,
) -> Array:
    """The interpolation matrix E, (target nodes, source nodes), modified for a field that is discontinuous at
    jumps. source_nodes, target_nodes: nodes of the jumps in `source` and `target`, (k,) each. fractions:
    weights of both sides in the mean at each jump, (k, 2)."""
    # In elements with an end at a jump, E uses the mean at this end. Extrapolation from the other nodes
    # replaces this value.
    matrix = E.copy()
    element = np.searchsorted(source.edges, target.node_positions, side="right") - 1
    elements_at_jumps = [_element_starting_at(source, node) for node in source_nodes]

    def row_of(element_index: int, *, to_first_node: bool) -> Array:
        p = source.orders[element_index]
        return _extrapolation_weights(
            p, element_index in elements_at_jumps, element_index + 1 in elements_at_jumps, to_first_node
        )

    for e, node in zip(elements_at_jumps, source_nodes, strict=True):
        for element_index in (e - 1, e):
            rows = element == element_index
            weights = matrix[rows, node].copy()
            matrix[rows, node] = 0.0
            matrix[rows, source.node_ranges[element_index]] += weights[:, None] * row_of(
                element_index, to_first_node=element_index == e
            )
    for e, node, (left_weight, right_weight) in zip(elements_at_jumps, target_nodes, fractions, strict=True):
        # States contain the mean of both sides at the node of a jump.
        matrix[node] = 0.0
        for element_index, weight in ((e - 1, left_weight), (e, right_weight)):
            matrix[node, source.node_ranges[element_index]] += weight * row_of(
                element_index, to_first_node=element_index == e
            )
    return matrix


def _element_starting_at(mesh: Mesh, node: int) -> int:
    """Index of the element that begins at the node `node` of a jump."""
    return index_before_jump(int(node), mesh.element_node_indices) + 1 - int(node)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _extrapolation_weights(order: int, jump_at_start: bool, jump_at_end: bool, to_start: bool) -> Array:
    """Weights, (p + 1,), of the nodes of an element of the order p = `order` in the extrapolation to one end;
    nodes at jumps have the weight 0. jump_at_start: whether a jump lies at the first node. jump_at_end:
    whether a jump lies at the last node. to_start: whether to extrapolate to the first node; otherwise to the
    last node."""
    x = gauss_lobatto_rule(order)[0]
    # A value at a jump is a mean over both sides, not a value of the polynomial.
    used_nodes = slice(int(jump_at_start), order + 1 - int(jump_at_end))
    weights = np.zeros(order + 1)
    weights[used_nodes] = lagrange_interpolation_matrix(x[used_nodes], np.array([-1.0 if to_start else 1.0]))[
        0
    ]
    return weights
