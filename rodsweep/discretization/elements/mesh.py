"""Elements on the rod, the matrices on their nodes, and the way from strains to a shape.

Fields are continuous in P_p with Lobatto nodes and lumped mass. theta(u) = int Pi, r(u) = int R(theta) (h1,
h2).
"""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from .basis import differentiation, interpolation
from .elements import Elements, equal_edges
from .quadrature import gauss, gauss_lobatto

EXTRA_POINTS = 10
"""Gauss points of an element minus its order, for integrals of shapes: theta turns by a radian or two."""


class NodeMatrices(NamedTuple):
    """D, D^T and -D^T W on all nodes of a mesh, (nodes + 1, nodes + 1), and W, (nodes + 1,).

    All are contiguous, and so are the inner loops over the nodes.
    """

    D: Array
    D_transposed: Array
    weak: Array
    weights: Array


@dataclass(frozen=True)
class Mesh(Elements):
    """Elements, and the matrices on all their nodes; `nodes` is without the tip.

    The matrices follow from edges and order, by which meshes are equal, also that of another process.
    """

    matrices: NodeMatrices = field(compare=False, repr=False)

    def __reduce__(self) -> tuple[Any, tuple[tuple[float, ...], int]]:
        """Pickled, also in a message to another rank, as edges and order."""
        return mesh_on, (self.edges, self.order)

    @property
    def quadrature(self) -> Array:
        """Weights of all nodes, the tip included, shape (nodes + 1,)."""
        return self.matrices.weights


def mesh(elements: int, order: int) -> Mesh:
    """The mesh of `elements` equal elements of order `order`."""
    return mesh_on(equal_edges(elements), order)


@lru_cache(maxsize=64)
def mesh_on(edges: tuple[float, ...], order: int) -> Mesh:
    """The mesh of elements between `edges`, all of order `order`."""
    x, w = gauss_lobatto(order)
    slopes, lengths = differentiation(x), np.diff(edges)
    nodes = len(lengths) * order
    weighted, total = np.zeros((nodes + 1, nodes + 1)), np.zeros(nodes + 1)
    for length, first in zip(lengths, range(0, nodes, order), strict=True):
        here = slice(first, first + order + 1)
        weighted[here, here] += w[:, None] * slopes  # the lengths of the element cancel
        total[here] += length / 2 * w
    D = weighted / total[:, None]
    parts = D, D.T, -weighted.T, total
    return Mesh(edges, order, NodeMatrices(*map(np.ascontiguousarray, parts)))


@lru_cache(maxsize=256)
def transfer(source: Mesh, target: Mesh) -> Array:
    """Matrix from values at all nodes of one mesh to those of another, (target nodes, source nodes)."""
    return source.evaluation(target.positions)


def configuration(grid: Mesh, strains: Array, clamp: Array) -> Array:
    """(x, y, theta) at all nodes from strains (h1, h2, Pi), both (3, ..., nodes + 1), and `clamp`, (3,)."""
    values, angles, integrals, ends = reconstruction(grid.order)
    p = grid.order
    state = np.empty_like(strains)
    start = np.broadcast_to(clamp.reshape(3, *(1,) * (strains.ndim - 1)), (3, *strains.shape[1:-1], 1))
    for e, length in enumerate(grid.lengths):
        here = slice(e * p, (e + 1) * p + 1)
        h1, h2, Pi = (strain[..., here] for strain in strains)
        theta = start[2] + length * (Pi @ angles)
        cos, sin = np.cos(theta), np.sin(theta)
        state[0][..., here] = start[0] + length * ((cos * (h1 @ values) - sin * (h2 @ values)) @ integrals)
        state[1][..., here] = start[1] + length * ((sin * (h1 @ values) + cos * (h2 @ values)) @ integrals)
        state[2][..., here] = start[2] + length * (Pi @ ends)
        start = state[..., here][..., -1:]
    return state


@lru_cache(maxsize=64)
def reconstruction(order: int) -> tuple[Array, Array, Array, Array]:
    """Matrices, to be applied from the right, on an element [0, 1] with Gauss points finer than its nodes.

    values: nodes to Gauss points; angles: integrals of nodal polynomials from 0 to the Gauss points; both
    (p + 1, m). integrals: integrals from 0 to the nodes of functions given at the Gauss points, (m, p + 1);
    ends: integrals of nodal polynomials from 0 to the nodes, (p + 1, p + 1).
    """
    x, g = gauss_lobatto(order)[0], gauss(order + EXTRA_POINTS)[0]
    return interpolation(x, g).T, primitive(x, g).T, primitive(g, x).T, primitive(x, x).T


def primitive(nodes: Array, ends: Array) -> Array:
    """Matrix from values at `nodes` to half the integral of their polynomial from -1 to each end.

    Shape (ends, nodes).
    """
    points, weights = gauss(len(nodes))
    return np.array(
        [(end + 1) / 4 * weights @ interpolation(nodes, -1 + (end + 1) * (points + 1) / 2) for end in ends]
    )
