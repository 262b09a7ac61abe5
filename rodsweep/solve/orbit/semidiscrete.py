"""Equations of a periodic orbit: the rod on its mesh, the method in time, and the closing condition."""

from typing import NamedTuple

from ...arrays import Array
from ...discretization.elements.mesh import NodeMatrices
from ...discretization.nodal_rod import NodalRod


class Semidiscrete(NamedTuple):
    """The rod on its mesh, the method in time, and the closing condition x(T/p) = S x(0) of an orbit.

    mass: (n,). differentiation: (s, s + 1). lengths: lengths of the intervals, with sum 1, (K,). symmetry: S,
    (n, n). parts: p, 1 or 2.
    """

    rod: NodalRod
    matrices: NodeMatrices
    mass: Array
    differentiation: Array
    lengths: Array
    symmetry: Array
    parts: float
