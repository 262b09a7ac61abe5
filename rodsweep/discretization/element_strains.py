"""Compiled strains at the nodes of every element; at a jump of the material, the strains of both sides.

At a jump the stress is continuous and the strain is not. The unknown at the node of a jump gives the mean
strain of both sides. The error of a shape that is integrated from mean strains decreases only with the fifth
power of the order. The strains of both sides follow from the stress (`rodsweep.model.material.jump`); a shape
that is integrated from these strains converges exponentially.

Arrays over the nodes of every element contain the elements one after the other; a node between two elements
appears twice.
"""

import numpy as np

from ..arrays import Array
from ..model.compiled.compilation import compiled, compiled_with_reordered_sums
from ..model.material.jump import (
    SHEAR_COMPLIANCE_COLUMN,
    LawUnknowns,
    side_increments_at_jump,
    unknowns_before_jump,
    unknowns_behind_jump,
)
from .nodal_rod import IntegerArray, NodalRod


@compiled
def index_before_jump(node: int, element_nodes: IntegerArray) -> int:
    """Index of the last node of the element before the jump at `node`, in arrays over the nodes of every
    element. The first node of the element behind the jump has the next index. element_nodes: indices of the
    nodes of every element, one element after the other, (nodes + elements,)."""
    # The node occurs twice; searchsorted returns the first place.
    return int(np.searchsorted(element_nodes, node))


@compiled_with_reordered_sums
def write_element_strains(S: Array, rod: NodalRod, element_nodes: IntegerArray, out: Array) -> None:
    """Writes the strains (h1, h2, Pi) at the nodes of every element into out, (3, m, nodes + elements). S:
    stresses of m states at all nodes, (3, m, nodes + 1), with the strain E = E0 + C S; at a jump, the strains
    of both sides are written. element_nodes: indices of the nodes of every element, (nodes + elements,)."""
    for a in range(len(S)):
        for k in range(S.shape[1]):
            for i in range(out.shape[2]):
                node = element_nodes[i]
                out[a, k, i] = rod.straight_state_strain[a, node] + rod.compliance[a, node] * S[a, k, node]
    for j in range(len(rod.jump_nodes)):
        node = rod.jump_nodes[j]
        sides = rod.jump_side_coefficients[j]
        index = index_before_jump(node, element_nodes)
        for k in range(S.shape[1]):
            q = LawUnknowns(S[0, k, node], S[2, k, node])
            first = unknowns_before_jump(rod.law_number, sides, q)
            unknowns_of_sides = first, unknowns_behind_jump(sides, q, first)
            for side in range(2):
                out[0, k, index + side] = sides[side, 0] + sides[side, 1] * unknowns_of_sides[side].q1
                out[1, k, index + side] = sides[side, SHEAR_COMPLIANCE_COLUMN] * S[1, k, node]
                out[2, k, index + side] = sides[side, 2] * unknowns_of_sides[side].q3


@compiled_with_reordered_sums
def write_element_strain_rates(
    S: Array, rates: Array, rod: NodalRod, element_nodes: IntegerArray, out: Array
) -> None:
    """Writes derivatives of the strains (with respect to time or along a variation) at the nodes of every
    element into out, (3, m, nodes + elements); at a jump, the derivatives on both sides.

    S: stresses of m states at all nodes, (3, m, nodes + 1). rates: derivatives of the strains at all nodes,
    at a jump the derivative of the mean strain, (3, m, nodes + 1). element_nodes: indices of the nodes of
    every element, (nodes + elements,).
    """
    for a in range(len(rates)):
        for k in range(rates.shape[1]):
            for i in range(out.shape[2]):
                out[a, k, i] = rates[a, k, element_nodes[i]]
    for j in range(len(rod.jump_nodes)):
        node = rod.jump_nodes[j]
        sides = rod.jump_side_coefficients[j]
        index = index_before_jump(node, element_nodes)
        c1 = rod.compliance[0, node]
        c2 = rod.compliance[1, node]
        c3 = rod.compliance[2, node]
        for k in range(rates.shape[1]):
            q = LawUnknowns(S[0, k, node], S[2, k, node])
            # The strain of a rigid component is constant for every stress.
            dq1 = rates[0, k, node] / c1 if c1 > 0 else 0.0
            dq2 = rates[1, k, node] / c2 if c2 > 0 else 0.0
            # c3 needs no test: only k1 and k2 may be infinite.
            changes = side_increments_at_jump(
                rod.law_number, sides, q, LawUnknowns(dq1, rates[2, k, node] / c3)
            )
            for side in range(2):
                out[0, k, index + side] = sides[side, 1] * changes[side].q1
                out[1, k, index + side] = sides[side, SHEAR_COMPLIANCE_COLUMN] * dq2
                out[2, k, index + side] = sides[side, 2] * changes[side].q3
