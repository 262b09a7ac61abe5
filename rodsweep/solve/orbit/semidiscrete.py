"""Data of the discretised equations of a periodic orbit, for compiled code."""

from typing import NamedTuple

from ...arrays import Array
from ...discretization.elements.mesh import NodeMatrices
from ...discretization.nodal_rod import NodalRod


class Semidiscrete(NamedTuple):
    """Data of the equations of an orbit: rod and mesh in space, collocation in time, closing condition x(T/p)
    = S x(0).

    mass: diagonal of the mass matrix, (n,). differentiation: differentiation matrix of the collocation, (s, s
    + 1). lengths: lengths of the time intervals, with sum 1, (K,). symmetry: S, (n, n). parts: p, 1 or 2.
    """

    rod: NodalRod
    matrices: NodeMatrices
    mass: Array
    differentiation: Array
    lengths: Array
    symmetry: Array
    parts: float
