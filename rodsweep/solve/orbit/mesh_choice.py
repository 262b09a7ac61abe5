"""Choice of the mesh of an orbit for a requested accuracy, from the coefficient tails of a nearby orbit: its
last spectral coefficients, divided by the largest."""

from dataclasses import replace
from math import ceil, log

import numpy as np

from ...discretization.elements.resolution import RESOLUTION_SETTINGS
from .coefficient_tails import coefficient_tails_of, time_tails_of_intervals
from .element_order_choice import element_order_ratios
from .node_spacing_of_arm import with_node_spacing_of_arm
from .orbit import Orbit, time_interval_lengths
from .orbit_mesh import ORBIT_MESH_SETTINGS, OrbitMesh, mesh_of_orbit
from .time_grading import UNIFORM_TIME_GRADING, TimeGrading, fitted_grading


def cheapest_stage_count(accuracy: float) -> int:
    """Number of collocation stages with the smallest cost for the relative accuracy `accuracy`."""
    return ORBIT_MESH_SETTINGS.min_stage_count + sum(
        accuracy <= limit for limit in ORBIT_MESH_SETTINGS.max_accuracies_for_more_stages
    )


def mesh_from_coefficient_tails(orbit: Orbit, accuracy: float, stage_count: int) -> OrbitMesh:
    """The coarsest mesh with `stage_count` stages that is expected to reach the relative accuracy `accuracy`,
    from the tails of the nearby orbit `orbit`. The order is at least `min_element_order`, and at most the
    order of `orbit` plus `max_element_order_increase`; the interval count is at least
    `min_time_interval_count`, and at most the interval count of `orbit` times `max_time_interval_count_ratio`
    (`ORBIT_MESH_SETTINGS`)."""
    orbit = with_node_spacing_of_arm(orbit)
    current_mesh = mesh_of_orbit(orbit)
    tails = coefficient_tails_of(orbit)
    # The errors are quadratic in the tails, hence the square roots.
    max_space_tail = (
        ORBIT_MESH_SETTINGS.accuracy_fraction_in_space_or_time
        * accuracy
        / ORBIT_MESH_SETTINGS.space_error_per_squared_tail
    ) ** 0.5
    max_time_tail = (
        ORBIT_MESH_SETTINGS.accuracy_fraction_in_space_or_time
        * accuracy
        / ORBIT_MESH_SETTINGS.time_error_per_squared_tail
    ) ** 0.5
    # Below `min_coefficient_tail` a tail is rounding error.
    order = current_mesh.order + ceil(
        log(max(tails.space_tail, ORBIT_MESH_SETTINGS.min_coefficient_tail) / max_space_tail)
        / tails.log_coefficient_decay_per_order
    )
    mesh = replace(current_mesh, order=order, order_ratios=element_order_ratios(orbit, order, max_space_tail))
    while mesh.order > RESOLUTION_SETTINGS.max_order:
        mesh = mesh.with_halved_elements
    grading, interval_ratio = grading_and_interval_count_ratio(orbit, max_time_tail, stage_count)
    interval_count = ceil(current_mesh.interval_count * interval_ratio)
    order = min(
        max(mesh.order, ORBIT_MESH_SETTINGS.min_element_order),
        current_mesh.order + ORBIT_MESH_SETTINGS.max_element_order_increase,
    )
    interval_count = min(
        max(interval_count, ORBIT_MESH_SETTINGS.min_time_interval_count),
        ORBIT_MESH_SETTINGS.max_time_interval_count_ratio * current_mesh.interval_count,
    )
    return replace(mesh, order=order, interval_count=interval_count, stage_count=stage_count, grading=grading)


def grading_and_interval_count_ratio(
    orbit: Orbit, max_tail: float, stage_count: int
) -> tuple[TimeGrading, float]:
    """Returns (grading, ratio): the grading of the time intervals that needs the fewest intervals, and the
    ratio of this number to the number of intervals of `orbit`. max_tail: largest allowed tail in time, see
    the module. stage_count: number of stages of an interval."""
    # For a different number of stages the tail in an interval is about a power of the known tail.
    tails = np.maximum(time_tails_of_intervals(orbit), ORBIT_MESH_SETTINGS.min_coefficient_tail) ** (
        stage_count / orbit.stage_count
    )
    edges = np.append(0.0, np.cumsum(time_interval_lengths(*orbit.time_mesh[::2])))
    # The tip turns twice a period: once in a solved half, twice in a whole period.
    fitted = fitted_grading(tails, edges, stage_count, 2 // orbit.symmetry.solved_parts_per_period)
    middles = (edges[1:] + edges[:-1]) / 2
    full_lengths = np.diff(edges) * (orbit.interval_count - 1)
    # A tail is proportional to (length of the interval)**stages.
    ratios = (tails / max_tail) ** (1 / stage_count) / full_lengths
    interval_ratio_of_grading = {
        grading: float((ratios * grading.time_slopes(grading.mesh_times(middles))).max())
        for grading in (orbit.grading, UNIFORM_TIME_GRADING, fitted)
    }
    best = min(interval_ratio_of_grading, key=lambda grading: interval_ratio_of_grading[grading])
    return best, interval_ratio_of_grading[best]


def coarser_regraded_mesh(mesh: OrbitMesh, orbit: Orbit) -> OrbitMesh:
    """`mesh` with the best grading of the time intervals for the solved `orbit` and fewer intervals; `mesh`
    itself if its grading, which is also the grading of `orbit`, is almost as good."""
    stage_count = orbit.stage_count
    # The present grading needs as many intervals as the orbit has with its own largest tail.
    grading, interval_ratio = grading_and_interval_count_ratio(
        orbit, float(time_tails_of_intervals(orbit).max()), stage_count
    )
    if interval_ratio > ORBIT_MESH_SETTINGS.max_regraded_interval_count_ratio or grading == mesh.grading:
        return mesh
    # One more interval, because the last two have half the length.
    interval_count = max(
        ORBIT_MESH_SETTINGS.min_time_interval_count,
        ceil(interval_ratio * mesh.solved_duration_in_full_intervals) + 1,
    )
    return replace(mesh, interval_count=interval_count, grading=grading)


def finer_orbit_mesh(mesh: OrbitMesh, target: OrbitMesh) -> OrbitMesh:
    """A mesh that is at least as fine as `target` and finer than the current mesh `mesh`."""
    order = max(target.order, mesh.order) if target.has_same_edges_and_order_ratios(mesh) else target.order
    # With another grading the target may be finer in time with fewer intervals.
    min_interval_count = mesh.interval_count if target.grading == mesh.grading else 0
    interval_count = max(target.interval_count, min_interval_count)
    stage_count = max(target.stage_count, mesh.stage_count)
    refined = replace(target, order=order, interval_count=interval_count, stage_count=stage_count)
    if refined != mesh:
        return refined
    return replace(
        mesh.mesh_finer_in_space,
        interval_count=ceil(ORBIT_MESH_SETTINGS.interval_count_ratio_of_finer_mesh * mesh.interval_count),
    )
