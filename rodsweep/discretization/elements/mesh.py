"""Meshes of the rod with their differentiation matrices, and the shape of a rod from its strains.

Fields are continuous and polynomials of degree p on each element, with Lobatto nodes and lumped mass. With
the bending strain Pi the shape is theta(u) = int Pi, r(u) = int R(theta) (h1, h2), where R(theta) is the
rotation by theta.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from .basis import differentiation_matrix, lagrange_interpolation_matrix
from .elements import ELEMENT_SETTINGS, Elements, equal_edges
from .node_spacing import position_slopes
from .quadrature import gauss_legendre_rule, gauss_lobatto_rule


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeQuadratureSettings:
    """Settings for the quadrature that computes the shape of a rod."""

    extra_point_count: int = 10
    """Number of Gauss points of an element beyond the largest order of an element, for the shape's integrals.
    Ten suffice if theta changes by up to two radians within an element."""


SHAPE_QUADRATURE_SETTINGS = ShapeQuadratureSettings()


class NodeMatrices(NamedTuple):
    """Matrices over all nodes of a mesh: D (`differentiation_matrix`), D^T and -D^T W
    (`weak_derivative_matrix`), (nodes + 1, nodes + 1), and the weights W, the lumped mass, (nodes + 1,). All
    arrays are contiguous, for inner loops over the nodes."""

    differentiation_matrix: Array
    transposed_differentiation_matrix: Array
    """Transposed differentiation matrix D^T, (nodes + 1, nodes + 1)."""
    weak_derivative_matrix: Array
    quadrature_weights: Array


@dataclass(frozen=True)
class Mesh(Elements):
    """Elements with matrices over all nodes. `node_count` is the number of nodes without the tip. Meshes with
    equal edges, orders and spacing compare equal, also in different processes."""

    # The matrices follow from the other fields, and an array comparison has no single truth value.
    node_matrices: NodeMatrices = field(compare=False, repr=False)

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        """Pickles only edges, orders and spacing; messages to other ranks are pickled too."""
        return mesh_with_edges, (self.edges, self.order, self.order_ratios, self.node_spacing_ratios)

    @property
    def quadrature_weights(self) -> Array:
        """Quadrature weights of all nodes, tip included, (nodes + 1,)."""
        return self.node_matrices.quadrature_weights


def uniform_mesh(element_count: int, order: int) -> Mesh:
    """The mesh of `element_count` elements of equal length and of order `order`."""
    return mesh_with_edges(equal_edges(element_count), order)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def mesh_with_edges(
    edges: tuple[float, ...],
    order: int,
    order_ratios: tuple[float, ...] = (),
    spacing_ratios: tuple[float, ...] = (),
) -> Mesh:
    """The mesh whose elements lie between neighbouring `edges`; cached. order: largest order of an element.
    order_ratios: order of each element divided by `order`; empty if all orders are equal. spacing_ratios: as
    in `Elements`."""
    ratios = {"order_ratios": order_ratios, "node_spacing_ratios": spacing_ratios}
    elements = Elements(edges, order, **ratios)
    node_count = elements.node_count
    weighted_D = np.zeros((node_count + 1, node_count + 1))
    node_weights = np.zeros(node_count + 1)
    for node_range, p, weights in zip(
        elements.node_ranges, elements.orders, elements.quadrature_weights_of_elements, strict=True
    ):
        x, w = gauss_lobatto_rule(p)
        # Length and spacing of the element cancel.
        weighted_D[node_range, node_range] += w[:, None] * differentiation_matrix(x)
        node_weights[node_range] += weights
    # At a node shared by two elements, D gives the mean of both slopes with the quadrature weights, so that W
    # D is the assembled matrix.
    D = weighted_D / node_weights[:, None]
    # -D^T W: `weighted_D` is W D.
    parts = D, D.T, -weighted_D.T, node_weights
    return Mesh(edges, order, NodeMatrices(*map(np.ascontiguousarray, parts)), **ratios)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_mesh_pairs)
def interpolation_matrix(source: Mesh, target: Mesh) -> Array:
    """Interpolation matrix from values at all nodes of `source` to values at all nodes of `target`. Shape
    (target nodes + 1, source nodes + 1); the numbers of nodes are without the tip."""
    return source.evaluation_matrix(target.node_positions)


def shape_from_strains(mesh: Mesh, strains: Array, clamp: Array) -> Array:
    """Shape (x, y, theta), in L and rad, of a rod at all nodes, (3, ..., nodes + 1), from its strains.
    strains: (h1, h2, Pi), Pi: bending strain, at the nodes of every element, (3, ..., nodes + elements).
    clamp: (x, y, theta) at u = 0, (3,)."""
    gauss_point_count = mesh.order + SHAPE_QUADRATURE_SETTINGS.extra_point_count
    shape = np.empty((*strains.shape[:-1], mesh.node_count + 1), strains.dtype)
    start = np.broadcast_to(clamp.reshape(3, *(1,) * (strains.ndim - 1)), (3, *strains.shape[1:-1], 1))
    for e, (element, length) in enumerate(zip(mesh.node_ranges, mesh.lengths, strict=True)):
        values, angles, integrals, ends = shape_integration_matrices(
            mesh.orders[e], gauss_point_count, mesh.node_spacing_ratio_of_elements[e]
        )
        h1, h2, Pi = (strain[..., element.start + e : element.stop + e] for strain in strains)
        # The angle comes first, because it turns the strains in the integrals of x and y.
        theta = start[2] + length * (Pi @ angles)
        cos = np.cos(theta)
        sin = np.sin(theta)
        slope_x = cos * (h1 @ values) - sin * (h2 @ values)
        slope_y = sin * (h1 @ values) + cos * (h2 @ values)
        shape[0][..., element] = start[0] + length * (slope_x @ integrals)
        shape[1][..., element] = start[1] + length * (slope_y @ integrals)
        shape[2][..., element] = start[2] + length * (Pi @ ends)
        # The end of this element is the start of the next element.
        start = shape[..., element][..., -1:]
    return shape


class ShapeIntegrationMatrices(NamedTuple):
    """Matrices that integrate strains to a shape on one element [0, 1] with p + 1 nodes and m Gauss points.

    All matrices are multiplied from the right. interpolation_to_gauss_points: interpolation from nodes to
    Gauss points, (p + 1, m). nodal_integrals_to_gauss_points: integrals of nodal polynomials from 0 to the
    Gauss points, (p + 1, m). gauss_integrals_to_nodes: integrals from 0 to the nodes, of functions given at
    the Gauss points, (m, p + 1). nodal_integrals_to_nodes: integrals of nodal polynomials from 0 to the
    nodes, (p + 1, p + 1)."""

    interpolation_to_gauss_points: Array
    nodal_integrals_to_gauss_points: Array
    gauss_integrals_to_nodes: Array
    nodal_integrals_to_nodes: Array


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def shape_integration_matrices(
    order: int, gauss_point_count: int = 0, spacing_ratio: float = 1.0
) -> ShapeIntegrationMatrices:
    """The `ShapeIntegrationMatrices` of elements of order `order`, cached. gauss_point_count: number of Gauss
    points; 0: `order` plus `SHAPE_QUADRATURE_SETTINGS.extra_point_count`. spacing_ratio: s of the module
    `node_spacing`."""
    x = gauss_lobatto_rule(order)[0]
    g = gauss_legendre_rule(gauss_point_count or order + SHAPE_QUADRATURE_SETTINGS.extra_point_count)[0]
    return ShapeIntegrationMatrices(
        lagrange_interpolation_matrix(x, g).T,
        integration_matrix(x, g, spacing_ratio).T,
        integration_matrix(g, x, spacing_ratio).T,
        integration_matrix(x, x, spacing_ratio).T,
    )


def integration_matrix(nodes: Array, upper_limits: Array, spacing_ratio: float = 1.0) -> Array:
    """Matrix (m, n) from values at `nodes`, (n,), to integrals of the interpolating polynomial along an
    element of length 1, from its start to `upper_limits`, (m,). All coordinates are in [-1, 1].
    spacing_ratio: s of the module `node_spacing`."""
    # n Gauss points are exact up to degree 2 n - 1: for the interpolant, of degree n - 1, times the first
    # n + 1 powers of the slope of the positions.
    points, weights = gauss_legendre_rule(len(nodes))
    rows = []
    for end in upper_limits:
        t = (end + 1) * (points + 1) / 4
        slopes = position_slopes(t, spacing_ratio)
        rows.append((end + 1) / 4 * (weights * slopes) @ lagrange_interpolation_matrix(nodes, 2 * t - 1))
    return np.array(rows)
