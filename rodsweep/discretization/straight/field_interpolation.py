"""Matrices from the nodes of a mesh to fields of a mode at given points, cached: a sweep evaluates the modes
of every rod at the same points."""

from functools import lru_cache

import numpy as np

from ...arrays import Array
from ..elements.basis import lagrange_interpolation_matrix, lobatto_differentiation_matrix
from ..elements.elements import ELEMENT_SETTINGS, Elements
from ..elements.quadrature import gauss_legendre_rule, gauss_lobatto_rule


def value_and_slope_matrices(mesh: Elements, points: Array) -> tuple[Array, Array]:
    """Returns (value matrix, slope matrix), (n, nodes + 1) each: matrices from values of a field at all nodes
    to values, and to derivatives d/du, at `points`, (n,), in [0, 1]; cached and read-only. All elements of
    `mesh` have the order of the mesh."""
    return _cached_value_and_slope_matrices(mesh, points.tobytes())


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_pencils)
def _cached_value_and_slope_matrices(mesh: Elements, point_bytes: bytes) -> tuple[Array, Array]:
    """The result of `value_and_slope_matrices`. point_bytes: bytes of the array of points."""
    nodes, _ = gauss_lobatto_rule(mesh.order)
    derivative = lobatto_differentiation_matrix(mesh.order)
    points = np.frombuffer(point_bytes)
    value = np.zeros((len(points), mesh.node_count + 1))
    slope = np.zeros_like(value)
    for e, indices, coordinates in mesh.points_by_element(points):
        element_values = lagrange_interpolation_matrix(nodes, coordinates)
        value[indices, mesh.node_ranges[e]] = element_values
        slope[indices, mesh.node_ranges[e]] = element_values @ derivative * (2 / mesh.lengths[e])
    value.flags.writeable = slope.flags.writeable = False
    return value, slope


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_pencils)
def shear_interpolation_matrix(mesh: Elements, point_bytes: bytes) -> Array:
    """Matrix (n, nodes) from values of a field at all Gauss nodes to values at n points in [0, 1];
    read-only. point_bytes: bytes of the array of points."""
    nodes, _ = gauss_legendre_rule(mesh.order)
    points = np.frombuffer(point_bytes)
    matrix = np.zeros((len(points), mesh.node_count))
    for e, indices, coordinates in mesh.points_by_element(points):
        columns = slice(e * mesh.order, (e + 1) * mesh.order)
        matrix[indices, columns] = lagrange_interpolation_matrix(nodes, coordinates)
    matrix.flags.writeable = False
    return matrix
