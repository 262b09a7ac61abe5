"""Stresses of a rod on both sides of the jumps of its material, where the stresses S of a law are not smooth.

S are the stresses that a linear rod needs for the same strain. With another law S has different values on the
two sides of a jump (`rodsweep.model.material.jump`), and the unknown at its node is the mean of both.
Everywhere else S is smooth within each element.
"""

from functools import lru_cache

import numpy as np

from ..arrays import Array
from ..model.balance import Values
from ..model.compiled.compilation import compiled
from ..model.material.jump import Unknowns, unknowns_before_jump, unknowns_behind_jump
from ..model.material.laws import LINEAR
from ..model.rod import Rod
from .arm_on_mesh import jumps_on
from .elements.basis import interpolation
from .elements.elements import ELEMENTS
from .elements.mesh import Mesh, interpolation_matrix
from .elements.quadrature import gauss_lobatto
from .nodal_rod import NO_JUMPS, IntegerArray, NodalRod

STRETCHING = 0
BENDING = 2
"""Components of S that are not smooth at a jump: indices of the stretching stress S1 and of the bending
stress S3."""


@compiled
def split_at_jump(law: int, sides: Array, q1: Array, q3: Array, out: Array) -> None:
    """Writes (q1, q3) before a jump and (q1, q3) behind it into out, (4, m), from the means q1, q3 of both
    sides, (m,).

    sides: the material of both sides, (2, 7).
    """
    for i in range(len(q1)):
        q = Unknowns(q1[i], q3[i])
        a = unknowns_before_jump(law, sides, q)
        b = unknowns_behind_jump(sides, q, a)
        out[0, i] = a.q1
        out[1, i] = a.q3
        out[2, i] = b.q1
        out[3, i] = b.q3


def stresses_beside_jumps(rod: NodalRod, S: Array) -> Array:
    """S1 and S3 on both sides of each jump, (k, 2, 2, ...), with axes (jump, side, stress, ...).

    S: (3, ..., nodes + 1), with the mean of both sides at a jump.
    """
    out = np.empty((len(rod.jumps), 2, 2, *S.shape[1:-1]))
    for found, node, sides in zip(out, rod.jumps, rod.sides, strict=True):
        q1, q3 = (np.ascontiguousarray(S[a, ..., node]).ravel() for a in (STRETCHING, BENDING))
        flat = np.empty((4, q1.size))
        split_at_jump(rod.law, sides, q1, q3, flat)
        found[...] = flat.reshape(found.shape)
    return out


def stresses_by_element(rod: NodalRod, grid: Mesh, S: Array) -> Array:
    """S at the nodes of each element, (3, ..., elements, order + 1); at a jump each element has the S of its
    own side.

    S: (3, ..., nodes + 1).
    """
    fields: Array = S[..., grid.element_nodes]
    for node, sides in zip(rod.jumps, stresses_beside_jumps(rod, S), strict=True):
        e = node // grid.order
        for component, before, behind in zip((STRETCHING, BENDING), sides[0], sides[1], strict=True):
            fields[component, ..., e - 1, -1] = before
            fields[component, ..., e, 0] = behind
    return fields


def interpolate_stress(rod: Rod, S: Values, source: Mesh, target: Mesh) -> Values:
    """S at all nodes of the mesh `target`, (3, ..., target.nodes + 1), from S on `source`,
    (3, ..., nodes + 1).

    The map is linear. The unknown at a jump is not a value of the polynomials on either side. These
    polynomials are taken from the other nodes of their elements, and the means of their ends are the unknowns
    at the jumps of the target.
    """
    E = interpolation_matrix(source, target)
    out = S @ E.T
    there = NO_JUMPS if rod.build.constitutive_law is LINEAR else jumps_on(rod, target)
    if len(there.nodes):
        here = jumps_on(rod, source).nodes
        for column, component in ((3, STRETCHING), (4, BENDING)):
            out[component] = (
                S[component]
                @ _interpolation_at_jumps(E, source, target, here, there.nodes, there.sides[..., column]).T
            )
    return out


def _interpolation_at_jumps(  # noqa: PLR0913, PLR0917 - of both meshes
    E: Array, source: Mesh, target: Mesh, here: IntegerArray, there: IntegerArray, shares: Array
) -> Array:
    """Interpolation matrix E between two meshes, (target nodes, source nodes), changed for a field with
    jumps.

    here, there: nodes of the jumps in source and target, (k,) each. shares: of both sides in the unknown at a
    jump, (k, 2).
    """
    # E interpolates the mean at a jump; rows of elements beside one extrapolate from inside instead.
    out = E.copy()
    p = source.order
    element = np.searchsorted(source.edges, target.positions, side="right") - 1
    at_jumps = [int(node) // p for node in here]
    for e, node in zip(at_jumps, here, strict=True):
        for side in (e - 1, e):
            rows = element == side
            columns = slice(side * p, (side + 1) * p + 1)
            row = _extrapolation_weights(p, side in at_jumps, side + 1 in at_jumps, first=side == e)
            weights = out[rows, node].copy()
            out[rows, node] = 0.0
            out[rows, columns] += weights[:, None] * row
    for e, node, (before, behind) in zip(at_jumps, there, shares, strict=True):
        # The new node at the jump gets the mean of both sides, as all states hold it.
        out[node] = 0.0
        for side, share in ((e - 1, before), (e, behind)):
            row = _extrapolation_weights(p, side in at_jumps, side + 1 in at_jumps, first=side == e)
            out[node, side * p : (side + 1) * p + 1] += share * row
    return out


@lru_cache(maxsize=ELEMENTS.max_meshes)
def _extrapolation_weights(order: int, starts: bool, stops: bool, first: bool) -> Array:
    """Weights, (p + 1,), that extrapolate from the nodes of an element, without those at jumps, to one end.

    starts, stops: whether the element starts, and stops, at a jump. first: whether to its first node, else
    the last.
    """
    x = gauss_lobatto(order)[0]
    # Nodes at jumps hold means over both sides, which belong to neither polynomial.
    used = slice(int(starts), order + 1 - int(stops))
    row = np.zeros(order + 1)
    row[used] = interpolation(x[used], np.array([-1.0 if first else 1.0]))[0]
    return row
