"""Indices of the unknowns of equal elements of a straight rod, inside elements and at their ends."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..elements.elements import ELEMENT_SETTINGS
from ..state_layout import SE2_DIMENSION

Indices = NDArray[np.int_]


@dataclass(frozen=True, eq=False)
class ElementNumbering:
    """Indices of the unknowns of every element, for static condensation.

    An element has `local` unknowns. state_indices: index of each unknown in a state, (elements, local);
    stresses at the tip are not unknowns and have an index one beyond the state. interior_positions,
    interface_positions: local indices of interior unknowns, and of unknowns at both ends, the left end first;
    for a single element `interior_positions` is empty and `interface_positions` contains all unknowns.
    interface_indices: indices of an element's end unknowns in the list of the end unknowns of all elements,
    (elements, ends). is_unknown: one entry for each end unknown of all elements, False for stresses at the
    tip.
    """

    state_indices: Indices
    interior_positions: Indices
    interface_positions: Indices
    interface_indices: Indices
    is_unknown: NDArray[np.bool_]


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def element_numbering(element_count: int, order: int, components: tuple[int, ...]) -> ElementNumbering:
    """Numbering of `element_count` equal elements of the order `order`. components: indices of the components
    of stresses and velocities that are unknowns."""
    last_node = element_count * order
    nodes = np.arange(element_count)[:, None] * order + np.arange(order + 1)
    unknown_count = SE2_DIMENSION * (2 * last_node + 1)
    stresses = [np.where(nodes == last_node, unknown_count, c * last_node + nodes) for c in components]
    velocities = [SE2_DIMENSION * last_node + c * (last_node + 1) + nodes for c in components]
    unknowns_per_node = 2 * len(components)
    node = np.tile(np.arange(order + 1), unknowns_per_node)
    # A single element is not condensed: a factorisation of all its unknowns can pivot freely.
    interior_nodes = np.flatnonzero((node > 0) & (node < order)) if element_count > 1 else np.array([], int)
    ends = np.setdiff1d(np.arange(len(node)), interior_nodes)
    # A stable sort keeps the components in order at each end, so that right ends match the next left ends.
    ends = ends[np.argsort(node[ends], kind="stable")]
    interface_indices = np.arange(element_count)[:, None] * unknowns_per_node + np.arange(len(ends))
    unknowns = np.concatenate([*stresses, *velocities], axis=1)
    is_unknown = np.ones(interface_indices[-1, -1] + 1, bool)
    is_unknown[interface_indices[-1]] = unknowns[-1, ends] < unknown_count
    return ElementNumbering(unknowns, interior_nodes, ends, interface_indices, is_unknown)
