"""Data of the discretised equations of a periodic orbit, for compiled code."""

from typing import NamedTuple

from ...arrays import Array
from ...discretization.elements.mesh import NodeMatrices
from ...discretization.nodal_rod import NodalRod


class OrbitEquations(NamedTuple):
    """Data of the equations of an orbit: rod and mesh in space, collocation in time, closing condition x(T/p)
    = S x(0), x: state, T: period.

    mass_diagonal: diagonal of the mass matrix, (n,). stage_differentiation_matrix: differentiation matrix of
    the collocation, (s, s + 1). time_interval_lengths: lengths of the time intervals, with sum 1, (K,).
    symmetry_matrix: S, (n, n). solved_parts_per_period: p, 1 or 2."""

    rod: NodalRod
    node_matrices: NodeMatrices
    """Differentiation matrices and quadrature weights at the nodes of the mesh in space."""
    mass_diagonal: Array
    stage_differentiation_matrix: Array
    time_interval_lengths: Array
    symmetry_matrix: Array
    solved_parts_per_period: float
