"""Equal elements on the rod, and what a field on their Lobatto nodes is at other points."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from .basis import interpolation
from .quadrature import gauss_lobatto


@dataclass(frozen=True, eq=False)
class EqualElements:
    """`elements` equal elements of order `order` on [0, 1]."""

    elements: int
    order: int

    @property
    def nodes(self) -> int:
        """Nodes but for one end, the clamp or the tip."""
        return self.elements * self.order

    @cached_property
    def positions(self) -> Array:
        """u of all nodes, both ends included, shape (nodes + 1,)."""
        inner = (gauss_lobatto(self.order)[0][1:] + 1) / 2
        return np.append(0.0, (np.arange(self.elements)[:, None] + inner).ravel() / self.elements)

    def evaluation(self, points: Array) -> Array:
        """Matrix from values at all nodes to values at `points` in [0, 1], shape (points, nodes + 1)."""
        nodes = gauss_lobatto(self.order)[0]
        matrix = np.zeros((len(points), self.nodes + 1))
        for first, here, local in self.by_element(points):
            matrix[here, first : first + self.order + 1] = interpolation(nodes, local)
        return matrix

    def by_element(self, points: Array) -> Iterator[tuple[int, NDArray[np.integer], Array]]:
        """(first node, numbers of the points in it, these in [-1, 1]) of each element with points, (n,)."""
        element = np.clip((points * self.elements).astype(int), 0, self.elements - 1)
        for e in np.unique(element):
            here = np.nonzero(element == e)[0]
            yield int(e) * self.order, here, 2 * (points[here] * self.elements - e) - 1
