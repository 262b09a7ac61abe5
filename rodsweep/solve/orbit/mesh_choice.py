"""Choice of the mesh of an orbit for a requested accuracy, from the coefficient tails of a nearby orbit."""

from dataclasses import replace
from math import ceil, log

from ...discretization.elements.elements import halve_elements
from ...discretization.elements.resolution import RESOLUTION_SETTINGS
from .element_order_ratios import element_order_ratios
from .orbit import Orbit
from .orbit_mesh import ORBIT_MESH_SETTINGS, OrbitMesh, mesh_of, ratios_of_halves
from .tails import tails_of


def cheapest_stage_count(accuracy: float) -> int:
    """Number of collocation stages with the smallest cost for the relative accuracy `accuracy`."""
    return ORBIT_MESH_SETTINGS.min_stages + sum(
        accuracy <= limit for limit in ORBIT_MESH_SETTINGS.max_accuracies_for_more_stages
    )


def mesh_from_tails(orbit: Orbit, accuracy: float, stages: int) -> OrbitMesh:
    """The coarsest mesh with `stages` stages that is expected to reach the relative accuracy `accuracy`, from
    the tails of the nearby orbit `orbit`; by `ORBIT_MESH_SETTINGS` not coarser than `min_order` and
    `min_intervals`, and finer than the mesh of `orbit` at most by `max_order_increase` and
    `max_interval_ratio`."""
    current_mesh = mesh_of(orbit)
    tails = tails_of(orbit)
    max_space_tail = (
        ORBIT_MESH_SETTINGS.accuracy_share * accuracy / ORBIT_MESH_SETTINGS.space_error_factor
    ) ** 0.5
    max_time_tail = (
        ORBIT_MESH_SETTINGS.accuracy_share * accuracy / ORBIT_MESH_SETTINGS.time_error_factor
    ) ** 0.5
    # Below `min_tail` a tail is rounding error.
    order = current_mesh.order + ceil(
        log(max(tails.space, ORBIT_MESH_SETTINGS.min_tail) / max_space_tail) / tails.space_decay
    )
    edges = current_mesh.edges
    ratios = element_order_ratios(orbit, order, max_space_tail)
    while order > RESOLUTION_SETTINGS.max_order:
        order = ceil(ORBIT_MESH_SETTINGS.halving_order_ratio * order)
        edges = halve_elements(edges)
        ratios = ratios_of_halves(ratios)
    # A tail is proportional to intervals**-stages. For a different number of stages the tail on the present
    # number of intervals is about a power of the known tail.
    time_tail = max(tails.time, ORBIT_MESH_SETTINGS.min_tail) ** (stages / current_mesh.stage_count)
    intervals = ceil(current_mesh.interval_count * (time_tail / max_time_tail) ** (1 / stages))
    order = min(
        max(order, ORBIT_MESH_SETTINGS.min_order), current_mesh.order + ORBIT_MESH_SETTINGS.max_order_increase
    )
    intervals = min(
        max(intervals, ORBIT_MESH_SETTINGS.min_intervals),
        ORBIT_MESH_SETTINGS.max_interval_ratio * current_mesh.interval_count,
    )
    return OrbitMesh(edges, order, intervals, stages, ratios)


def finer_mesh(mesh: OrbitMesh, target: OrbitMesh) -> OrbitMesh:
    """A mesh that is at least as fine as `target` and finer than the current mesh `mesh`."""
    order = max(target.order, mesh.order) if target.has_elements_of(mesh) else target.order
    intervals = max(target.interval_count, mesh.interval_count)
    stages = max(target.stage_count, mesh.stage_count)
    refined = replace(target, order=order, interval_count=intervals, stage_count=stages)
    if refined != mesh:
        return refined
    return replace(
        mesh.finer_in_space, interval_count=ceil(ORBIT_MESH_SETTINGS.interval_factor * mesh.interval_count)
    )
