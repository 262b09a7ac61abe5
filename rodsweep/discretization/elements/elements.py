"""Spectral elements on the rod, and interpolation from their Lobatto nodes to other points."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from .basis import lagrange_interpolation_matrix
from .quadrature import gauss_lobatto_rule


@dataclass(frozen=True, slots=True, kw_only=True)
class ElementSettings:
    """Settings of elements: points close to the ends of elements, and maximum sizes of caches."""

    end_distance: float = 1e-15
    """Distance of the first and last `Elements.points_inside_elements` from the ends of an element, in L: a
    few rounding errors of u. With 1e-9, the largest y of cycles near the Hopf point of a cone had an error of
    1e-8 on every mesh."""
    max_cached_meshes: int = 64
    """Maximum number of cached meshes, and of cached matrices of each kind; a sweep needs about ten."""
    max_cached_pencils: int = 16
    """Maximum number of cached pencils; a pencil for 300 growing modes takes 10 MB."""
    max_cached_mesh_pairs: int = 256
    """Maximum number of cached interpolation matrices between two meshes, and of cached lists of edges."""


ELEMENT_SETTINGS = ElementSettings()


@dataclass(frozen=True)
class Elements:
    """Elements of equal order on the rod. Element e reaches from edges[e] to edges[e + 1]; edges[0] is 0 and
    edges[-1] is 1.
    """

    edges: tuple[float, ...]
    order: int

    @property
    def element_count(self) -> int:
        """Number of elements."""
        return len(self.edges) - 1

    @property
    def node_count(self) -> int:
        """Number of nodes, one end of the rod excluded. The equations determine which end is excluded."""
        return self.element_count * self.order

    @cached_property
    def lengths(self) -> Array:
        """Lengths of the elements, (elements,)."""
        return np.diff(self.edges)

    @cached_property
    def node_positions(self) -> Array:
        """Material coordinate u of all nodes, both ends included, (nodes + 1,)."""
        inner = (gauss_lobatto_rule(self.order)[0][1:] + 1) / 2
        starts: Array = np.array(self.edges[:-1])
        positions: Array = np.append(0.0, (starts[:, None] + self.lengths[:, None] * inner).ravel())
        # Nodes at edges must equal the edges exactly, because jumps of the material are compared with these
        # values.
        positions[self.order :: self.order] = self.edges[1:]
        return positions

    @cached_property
    def element_nodes(self) -> NDArray[np.int64]:
        """Indices of the nodes of every element, (elements, order + 1). Neighbours share a node."""
        return np.arange(self.element_count)[:, None] * self.order + np.arange(self.order + 1)

    @cached_property
    def points_inside_elements(self) -> Array:
        """Coordinates u of the nodes of every element, (elements, order + 1), with the end nodes moved just
        inside the element.

        At a jump between two elements, each element therefore evaluates a coefficient on its own side.
        """
        edges: Array = np.array(self.edges)[:, None]
        points = edges[:-1] + self.lengths[:, None] * (gauss_lobatto_rule(self.order)[0] + 1) / 2
        return np.clip(
            points, edges[:-1] + ELEMENT_SETTINGS.end_distance, edges[1:] - ELEMENT_SETTINGS.end_distance
        )

    def evaluation_matrix(self, points: Array) -> Array:
        """Matrix (n, nodes + 1) from values at all nodes to values at `points`, (n,), in [0, 1]."""
        nodes = gauss_lobatto_rule(self.order)[0]
        matrix = np.zeros((len(points), self.node_count + 1))
        for first, inside, local in self.points_by_element(points):
            matrix[inside, first : first + self.order + 1] = lagrange_interpolation_matrix(nodes, local)
        return matrix

    def element_evaluation_matrix(self, points: Array) -> Array:
        """Matrix (n, elements (order + 1)) from values at the nodes of every element to values at `points`,
        (n,), in [0, 1].

        A node between two elements has one value for each of the two elements.
        """
        nodes = gauss_lobatto_rule(self.order)[0]
        matrix = np.zeros((len(points), self.element_nodes.size))
        for first, inside, local in self.points_by_element(points):
            start = first + first // self.order
            matrix[inside, start : start + self.order + 1] = lagrange_interpolation_matrix(nodes, local)
        return matrix

    def points_by_element(self, points: Array) -> Iterator[tuple[int, NDArray[np.integer], Array]]:
        """Yields (first node, indices, coordinates) for each element that contains some of the `points`,
        (n,).

        indices: indices of the points in the element. coordinates: coordinates of these points, from -1 to 1
        along the element. A point between two elements belongs to the right element.
        """
        element = np.clip(np.searchsorted(self.edges, points, side="right") - 1, 0, self.element_count - 1)
        for e in np.unique(element):
            inside = np.nonzero(element == e)[0]
            yield int(e) * self.order, inside, 2 * (points[inside] - self.edges[e]) / self.lengths[e] - 1


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_mesh_pairs)
def equal_edges(elements: int) -> tuple[float, ...]:
    """Edges of `elements` elements of equal length on [0, 1]."""
    return tuple(k / elements for k in range(elements + 1))


def halve_elements(edges: tuple[float, ...]) -> tuple[float, ...]:
    """Edges of the elements after every element between `edges` is halved."""
    middles = [(a + b) / 2 for a, b in zip(edges[:-1], edges[1:], strict=True)]
    return tuple(sorted([*edges, *middles]))
