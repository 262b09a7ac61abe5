"""Spectral elements on the rod, and interpolation from their Lobatto nodes to other points."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from math import ceil

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from .basis import lagrange_interpolation_matrix
from .node_spacing import coordinates_at_positions, position_slopes, positions_at_coordinates
from .quadrature import gauss_lobatto_rule


@dataclass(frozen=True, slots=True, kw_only=True)
class ElementSettings:
    """Settings of elements: points close to the ends of elements, smallest order, maximum sizes of caches."""

    one_sided_node_offset: float = 1e-15
    """Distance of the first and last `Elements.one_sided_nodes` from the ends of an element, in L: a
    few rounding errors of u. With 1e-9, the largest y of cycles near the Hopf point of a cone had an error of
    1e-8 on every mesh."""
    min_order_below_mesh_order: int = 2
    """Smallest order of an element whose order is less than the order of the mesh. Only coarse meshes, which
    predict cycles on fine meshes, have elements of orders below 4."""
    max_cached_meshes: int = 64
    """Maximum number of cached meshes, and of cached matrices of each kind; a sweep needs about ten."""
    max_cached_pencils: int = 16
    """Maximum number of cached pencils (10 MB for 300 growing modes), orbit equations and tail weights."""
    max_cached_mesh_pairs: int = 256
    """Maximum number of cached interpolation matrices between two meshes, and of cached lists of edges."""


ELEMENT_SETTINGS = ElementSettings()


@dataclass(frozen=True)
class Elements:
    """Elements on the rod. Element e reaches from edges[e] to edges[e + 1]; edges[0] is 0 and edges[-1] is 1.
    order: largest order of an element. order_ratios: order of each element divided by `order`, before
    `element_orders` rounds the order up; empty if all orders are equal. node_spacing_ratios: spacing ratio s
    of each element, see the module `node_spacing`; empty if all are 1. In shapes, `nodes` is `node_count`,
    which does not count one end of the rod, and `elements` is the number of elements."""

    edges: tuple[float, ...]
    order: int
    order_ratios: tuple[float, ...] = field(default=(), kw_only=True)
    node_spacing_ratios: tuple[float, ...] = field(default=(), kw_only=True)

    @property
    def element_count(self) -> int:
        """Number of elements."""
        return len(self.edges) - 1

    @cached_property
    def node_count(self) -> int:
        """Number of nodes, one end of the rod excluded. The equations determine which end is excluded."""
        return sum(self.orders)

    @cached_property
    def orders(self) -> tuple[int, ...]:
        """Order of each element."""
        return element_orders(self.element_count, self.order, self.order_ratios)

    @cached_property
    def node_ranges(self) -> tuple[slice, ...]:
        """Range of the nodes of each element, both ends included. Neighbours share a node."""
        ends = np.cumsum(self.orders).tolist()
        return tuple(slice(end - order, end + 1) for end, order in zip(ends, self.orders, strict=True))

    @cached_property
    def lengths(self) -> Array:
        """Lengths of the elements, (elements,)."""
        return np.diff(self.edges)

    @cached_property
    def node_spacing_ratio_of_elements(self) -> tuple[float, ...]:
        """Spacing ratio s of each element, see the module `node_spacing`."""
        return self.node_spacing_ratios or (1.0,) * self.element_count

    @cached_property
    def relative_node_positions(self) -> tuple[Array, ...]:
        """Positions of the nodes along each element, from 0 to 1, (p + 1,) each, p: order of the element."""
        return tuple(
            positions_at_coordinates((gauss_lobatto_rule(order)[0] + 1) / 2, s)
            for order, s in zip(self.orders, self.node_spacing_ratio_of_elements, strict=True)
        )

    @cached_property
    def quadrature_weights_of_elements(self) -> tuple[Array, ...]:
        """Quadrature weights of the nodes of each element, (p + 1,) each, p: order of the element."""
        weights = []
        for length, order, s in zip(
            self.lengths, self.orders, self.node_spacing_ratio_of_elements, strict=True
        ):
            x, w = gauss_lobatto_rule(order)
            weights.append(length / 2 * w * position_slopes((x + 1) / 2, s))
        return tuple(weights)

    @cached_property
    def node_positions(self) -> Array:
        """Material coordinate u of all nodes, both ends included, (nodes + 1,)."""
        positions = np.empty(self.node_count + 1)
        for e, (nodes, v) in enumerate(zip(self.node_ranges, self.relative_node_positions, strict=True)):
            positions[nodes] = self.edges[e] + self.lengths[e] * v
            # Nodes at edges must equal the edges exactly, because jumps of the material are compared with
            # these values.
            positions[nodes.start] = self.edges[e]
        positions[-1] = self.edges[-1]
        return positions

    @cached_property
    def element_node_indices(self) -> NDArray[np.int64]:
        """Indices of the nodes of every element, in turn, (nodes + elements,). Neighbours share a node."""
        return np.concatenate([np.arange(nodes.start, nodes.stop) for nodes in self.node_ranges])

    @cached_property
    def one_sided_nodes(self) -> Array:
        """Coordinates u of the nodes of every element, (nodes + elements,), with the end nodes moved just
        inside the element, so that at a jump each element evaluates a coefficient on its own side."""
        distance = ELEMENT_SETTINGS.one_sided_node_offset
        return np.concatenate(
            [
                np.clip(start + (end - start) * v, start + distance, end - distance)
                for start, end, v in zip(
                    self.edges[:-1], self.edges[1:], self.relative_node_positions, strict=True
                )
            ]
        )

    def evaluation_matrix(self, points: Array) -> Array:
        """Matrix (n, nodes + 1) from values at all nodes to values at `points`, (n,), in [0, 1]."""
        matrix = np.zeros((len(points), self.node_count + 1))
        for e, indices, coordinates in self.points_by_element(points):
            nodes = gauss_lobatto_rule(self.orders[e])[0]
            matrix[indices, self.node_ranges[e]] = lagrange_interpolation_matrix(nodes, coordinates)
        return matrix

    def one_sided_evaluation_matrix(self, points: Array) -> Array:
        """Matrix (n, nodes + elements) from values at the nodes of every element to values at `points`, (n,),
        in [0, 1]. A node between two elements has one value for each of the two elements."""
        matrix = np.zeros((len(points), self.element_node_indices.size))
        for e, indices, coordinates in self.points_by_element(points):
            nodes = gauss_lobatto_rule(self.orders[e])[0]
            # Each earlier element has added one column, since the node between two elements has two values.
            columns = slice(self.node_ranges[e].start + e, self.node_ranges[e].stop + e)
            matrix[indices, columns] = lagrange_interpolation_matrix(nodes, coordinates)
        return matrix

    def element_indices(self, points: Array) -> NDArray[np.integer]:
        """Index of the element of each of the `points`, (n,), in [0, 1]. A point between two elements belongs
        to the element on the right."""
        # The clip puts u = 1, which lies right of the last edge, into the last element.
        return np.clip(np.searchsorted(self.edges, points, side="right") - 1, 0, self.element_count - 1)

    def points_inside_elements(self, points: Array) -> Array:
        """The `points`, (n,), in [0, 1], each moved inside its element if it lies at an end, as for
        `one_sided_nodes`."""
        distance = ELEMENT_SETTINGS.one_sided_node_offset
        element = self.element_indices(points)
        edges = np.array(self.edges)
        return np.clip(points, edges[element] + distance, edges[element + 1] - distance)

    def points_by_element(self, points: Array) -> Iterator[tuple[int, NDArray[np.integer], Array]]:
        """Yields (element, indices, coordinates) for each element that contains some of the `points`, (n,).
        indices: indices of the points in the element. coordinates: coordinates of these points, from -1 to 1
        along the element (2 t - 1, t: the coordinate of `node_spacing` in which the nodes of an element are
        Lobatto points)."""
        element = self.element_indices(points)
        for e in np.unique(element):
            indices = np.nonzero(element == e)[0]
            v = (points[indices] - self.edges[e]) / self.lengths[e]
            yield int(e), indices, 2 * coordinates_at_positions(v, self.node_spacing_ratio_of_elements[e]) - 1


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_mesh_pairs)
def element_orders(element_count: int, order: int, ratios: tuple[float, ...]) -> tuple[int, ...]:
    """Orders of `element_count` elements: `order` times each of `ratios`, rounded up, between
    `ELEMENT_SETTINGS.min_order_below_mesh_order` and `order`; `order` for all elements if `ratios` is
    empty."""
    min_order = min(ELEMENT_SETTINGS.min_order_below_mesh_order, order)
    return tuple(max(min_order, ceil(ratio * order)) for ratio in ratios) or (order,) * element_count


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_mesh_pairs)
def equal_edges(element_count: int) -> tuple[float, ...]:
    """Edges of `element_count` elements of equal length on [0, 1]."""
    # A quotient is equal for equal edges of different meshes; a multiple of the rounded length is not.
    return tuple(k / element_count for k in range(element_count + 1))


def halved_element_edges(edges: tuple[float, ...]) -> tuple[float, ...]:
    """Edges of the elements after every element between `edges` is halved."""
    midpoints = [(a + b) / 2 for a, b in zip(edges[:-1], edges[1:], strict=True)]
    return tuple(sorted([*edges, *midpoints]))
