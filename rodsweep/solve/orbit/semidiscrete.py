"""The equations of a periodic orbit: the rod on its mesh, a method in time, and how the orbit closes."""

from typing import NamedTuple

from ...arrays import Array
from ...discretization.elements.mesh import NodeMatrices
from ...discretization.nodal_rod import NodalRod


class Semidiscrete(NamedTuple):
    """The rod on its mesh, the method in time, and how an orbit closes.

    mass (n,); differentiation (s, s + 1); lengths: of the intervals, of sum 1, (K,); symmetry: S, by which
    the state has changed at the end, (n, n); parts: of the period that are equal but for it, 1 or 2.
    """

    rod: NodalRod
    matrices: NodeMatrices
    mass: Array
    differentiation: Array
    lengths: Array
    symmetry: Array
    parts: float
