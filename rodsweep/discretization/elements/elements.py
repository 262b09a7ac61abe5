"""Spectral elements on the rod, and interpolation from their Lobatto nodes to other points."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from .basis import interpolation
from .quadrature import gauss_lobatto


@dataclass(frozen=True, slots=True, kw_only=True)
class ElementSettings:
    """Settings of elements: points just inside their ends, and numbers of meshes and matrices cached in
    memory.
    """

    end_distance: float = 1e-15
    """Distance of `Elements.points_inside` from the ends of an element, in L: a few rounding errors of u.
    With 1e-9 instead, the largest y of cycles next to the Hopf point of a cone was off by 1e-8 on every
    mesh."""
    max_meshes: int = 64
    """Maximum number of meshes, and of matrices of each kind, that are cached; a sweep needs about ten."""
    max_pencils: int = 16
    """Maximum number of pencils that are cached; for 300 growing modes each takes 10 MB."""
    max_mesh_pairs: int = 256
    """Maximum number of pairs of meshes whose interpolation matrix is cached, and of cached lists of
    edges."""


ELEMENTS = ElementSettings()


@dataclass(frozen=True)
class Elements:
    """Elements of equal order on the rod: element e reaches from edges[e] to edges[e + 1]; edges go from 0 to
    1.
    """

    edges: tuple[float, ...]
    order: int

    @property
    def elements(self) -> int:
        """Number of elements."""
        return len(self.edges) - 1

    @property
    def nodes(self) -> int:
        """Number of nodes without one end of the rod; which end is left out depends on the equations."""
        return self.elements * self.order

    @cached_property
    def lengths(self) -> Array:
        """Lengths of the elements, (elements,)."""
        return np.diff(self.edges)

    @cached_property
    def positions(self) -> Array:
        """Material coordinate u of all nodes, both ends included, (nodes + 1,)."""
        inner = (gauss_lobatto(self.order)[0][1:] + 1) / 2
        starts: Array = np.array(self.edges[:-1])
        positions: Array = np.append(0.0, (starts[:, None] + self.lengths[:, None] * inner).ravel())
        # Edges to the last bit, since jumps of the material are looked up at them.
        positions[self.order :: self.order] = self.edges[1:]
        return positions

    @cached_property
    def element_nodes(self) -> NDArray[np.int64]:
        """Indices of the nodes of every element, (elements, order + 1)."""
        return np.arange(self.elements)[:, None] * self.order + np.arange(self.order + 1)

    @cached_property
    def points_inside(self) -> Array:
        """u of the nodes of every element, (elements, order + 1), with its end nodes moved just inside the
        element.

        At a jump between two elements each element therefore evaluates the coefficient on its own side.
        """
        edges: Array = np.array(self.edges)[:, None]
        points = edges[:-1] + self.lengths[:, None] * (gauss_lobatto(self.order)[0] + 1) / 2
        return np.clip(points, edges[:-1] + ELEMENTS.end_distance, edges[1:] - ELEMENTS.end_distance)

    def evaluation(self, points: Array) -> Array:
        """Matrix from values at all nodes to values at `points` in [0, 1], (n,): shape (n, nodes + 1)."""
        nodes = gauss_lobatto(self.order)[0]
        matrix = np.zeros((len(points), self.nodes + 1))
        for first, inside, local in self.by_element(points):
            matrix[inside, first : first + self.order + 1] = interpolation(nodes, local)
        return matrix

    def evaluation_by_element(self, points: Array) -> Array:
        """Matrix from values at the nodes of every element to values at `points` in [0, 1], (n,).

        Shape (n, elements (order + 1)); a node between two elements has a value in each.
        """
        nodes = gauss_lobatto(self.order)[0]
        matrix = np.zeros((len(points), self.element_nodes.size))
        for first, inside, local in self.by_element(points):
            start = first + first // self.order
            matrix[inside, start : start + self.order + 1] = interpolation(nodes, local)
        return matrix

    def by_element(self, points: Array) -> Iterator[tuple[int, NDArray[np.integer], Array]]:
        """Yields, for each element with points, (its first node, indices of its points, their coordinates in
        [-1, 1]).

        points: (n,). A point between two elements belongs to the right element.
        """
        element = np.clip(np.searchsorted(self.edges, points, side="right") - 1, 0, self.elements - 1)
        for e in np.unique(element):
            inside = np.nonzero(element == e)[0]
            yield int(e) * self.order, inside, 2 * (points[inside] - self.edges[e]) / self.lengths[e] - 1


@lru_cache(maxsize=ELEMENTS.max_mesh_pairs)
def equal_edges(elements: int) -> tuple[float, ...]:
    """Edges of `elements` elements of equal length on [0, 1]."""
    return tuple(k / elements for k in range(elements + 1))


def halve_elements(edges: tuple[float, ...]) -> tuple[float, ...]:
    """The edges of the elements after halving every element."""
    middles = [(a + b) / 2 for a, b in zip(edges[:-1], edges[1:], strict=True)]
    return tuple(sorted([*edges, *middles]))
