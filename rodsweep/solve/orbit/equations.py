"""Data of the discretised equations of a periodic orbit, for compiled code."""

from typing import NamedTuple

from ...arrays import Array
from ...discretization.elements.mesh import NodeMatrices
from ...discretization.nodal_rod import NodalRod


class OrbitEquations(NamedTuple):
    """Data of the equations of an orbit: rod and mesh in space, collocation in time, closing condition x(T/p)
    = S x(0).

    mass: diagonal of the mass matrix, (n,). stage_differentiation: differentiation matrix of the collocation,
    (s, s + 1). interval_lengths: lengths of the time intervals, with sum 1, (K,). symmetry: S, (n, n).
    period_parts: p, 1 or 2."""

    rod: NodalRod
    node_matrices: NodeMatrices
    mass: Array
    stage_differentiation: Array
    interval_lengths: Array
    symmetry: Array
    period_parts: float
