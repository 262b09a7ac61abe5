"""The finest of the initial meshes of a sweep's rods, which `rodsweep check` reports."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from itertools import product

import numpy as np

from ..arrays import Array, list_of
from ..discretization.elements.elements import Elements, equal_edges
from ..discretization.straight.arm_resolution import arm_mesh
from ..discretization.straight.uniform_resolution import first_resolution
from ..model.rod import Crushed, Rod
from ..solve.changes.search_range import search_end_below_crushing
from .cost_estimate import sampled_points_with_rod
from .points.points import Points


def spectrum_mesh(rod: Rod, mode_count: int, accuracy: float) -> Elements:
    """Initial mesh for the `mode_count` leading eigenvalues of a rod; accuracy: relative error due to the
    mesh."""
    if not rod.is_uniform:
        return arm_mesh(rod, mode_count, accuracy)
    resolution = first_resolution(rod.equivalent_linear_rod_and_rate_factor[0], mode_count, accuracy)
    return Elements(equal_edges(resolution.element_count), resolution.order)


def finest_initial_mesh(
    points: Points, mesh_of: Callable[[Rod], Elements], parameter_ends: Mapping[str, Array] | None = None
) -> Elements | None:
    """The initial mesh with the most nodes among sampled points of a sweep and the corners of its grid; None
    if the rod model applies to no point.

    mesh_of: function from a rod to its initial mesh. parameter_ends: for each parameter along which rods are
    searched, by name: values at the ends of the range, (n,), at which meshes are compared too.
    """
    # The finest meshes belong to extreme parameter values, which evenly spaced points may miss.
    indices = {*list_of(sampled_points_with_rod(points)), *_grid_corner_indices(points)}
    rods = (
        rod
        for point_rod in _uncrushed_rods(points, sorted(indices))
        for rod in _rods_at_range_corners(point_rod, parameter_ends or {})
    )
    return max(map(mesh_of, rods), key=lambda mesh: mesh.node_count, default=None)


def _uncrushed_rods(points: Points, indices: Iterable[int]) -> Iterator[Rod]:
    """Yields the rods of the points at flat `indices`; rods crushed by their force, as in some rows of a
    diagram, are omitted."""
    for index in indices:
        with suppress(Crushed):
            yield points.rod(index)


def _rods_at_range_corners(rod: Rod, parameter_ends: Mapping[str, Array]) -> Iterator[Rod]:
    """Yields the rod with every combination of the parameter values in `parameter_ends`, by name, (n,) each.
    A force is lowered to just below the crushing force. Combinations outside the model are omitted."""
    for values in product(*(list_of(column) for column in parameter_ends.values())):
        end_values = dict(zip(parameter_ends, values, strict=True))
        if "F" in end_values:
            # The other parameters come first, because they set the crushing force.
            force = end_values.pop("F")
            end_rod = rod.with_values(**end_values)
            yield end_rod.with_values(F=search_end_below_crushing(end_rod, force))
            continue
        try:
            yield rod.with_values(**end_values)
        except ValueError:
            continue


def _grid_corner_indices(points: Points) -> Iterator[int]:
    """Yields the flat indices of the corners of a grid at which the rod model applies; none for a list."""
    if not points.axes:
        return
    ends = [sorted({0, size - 1}) for size in points.shape]
    for corner in product(*ends):
        index = int(np.ravel_multi_index(corner, points.shape))
        if points.is_in_model(index):
            yield index
