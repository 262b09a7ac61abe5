"""Mesh for the next cycles of a branch, from the errors that are expected there.

A mesh that is chosen before a cycle is solved costs nothing; a cycle whose errors turn out too large is
solved again. Errors grow along a branch about as fast as over the steps before.
"""

from collections.abc import Sequence

import numpy as np

from ...arrays import Array
from ..cycle.accuracy.error_indicators import coefficient_tails_and_orbit_size, error_growth_factors
from ..orbit.mesh_choice import coarser_regraded_mesh, finer_orbit_mesh
from ..orbit.orbit_mesh import OrbitMesh, mesh_of_orbit
from .arc_length_step import BranchCycle
from .settings import BRANCH_ERROR_SETTINGS, BRANCH_MESH_SETTINGS


def expected_error_growth(
    measured: BranchCycle, points: Sequence[BranchCycle], measured_end: BranchCycle
) -> Array:
    """Factors by which the errors in space and in time, (2,), are expected to grow from the last cycle of
    `points` to the next cycle whose errors are measured: the growth of the coefficient tails over the last
    steps, or the growth of the measured errors of the parameter if larger. measured: the cycle before
    `points`, whose errors were measured. measured_end: the last cycle of `points`, with measured errors."""
    end = points[-1]
    # Tails are compared on one mesh.
    known = next(
        point for point in (measured, *points) if mesh_of_orbit(point.orbit) == mesh_of_orbit(end.orbit)
    )
    length = end.arc_length_since_error_measurement - known.arc_length_since_error_measurement
    if not length > 0:
        return np.ones(2)
    # A branch is followed by arc length: the size of an orbit does not matter.
    tails = [np.append(coefficient_tails_and_orbit_size(point.orbit)[:-1], 1.0) for point in (known, end)]
    steps = BRANCH_MESH_SETTINGS.max_steps_between_measurements
    growth: Array = error_growth_factors(*tails)
    if known is measured:
        errors = [
            np.maximum(
                point.calibration.parameter_errors_at_equal_deflection,
                BRANCH_ERROR_SETTINGS.min_error_for_logarithm,
            )
            for point in (measured, measured_end)
        ]
        growth = np.maximum(growth, errors[1] / errors[0])
    growth = growth ** (steps * end.next_step_length / length)
    return np.minimum(growth, BRANCH_MESH_SETTINGS.max_planned_error_growth)


def mesh_for_next_cycles(end: BranchCycle, growth: Array, accuracy: float) -> OrbitMesh | None:
    """The mesh for the next cycles of the branch after `end`, whose errors were measured; None if the mesh of
    `end` remains in use, because it is expected to suffice up to the next measured cycle and no much cheaper
    mesh does, or because no sufficient mesh is allowed. growth: expected growth factors of the errors in
    space and in time up to the next measured cycle, (2,). accuracy: relative accuracy of the cycles."""
    mesh = end.calibration.mesh
    expected = end.calibration.with_grown_errors(growth)
    cheapest = expected.cheapest_mesh(BRANCH_MESH_SETTINGS.planned_error_per_accuracy * accuracy)
    if expected.largest_weighted_error(accuracy) > accuracy:
        target = coarser_regraded_mesh(finer_orbit_mesh(mesh, cheapest), end.orbit)
        return target if target.is_allowed else None
    # A sufficient mesh is replaced only by a much cheaper mesh, which is likely to suffice for many cycles.
    cheaper = expected.cheapest_mesh(BRANCH_MESH_SETTINGS.planned_error_per_accuracy_if_cheaper * accuracy)
    target = coarser_regraded_mesh(cheaper, end.orbit)
    return (
        target
        if target.elimination_cost
        <= BRANCH_MESH_SETTINGS.max_cost_ratio_of_cheaper_mesh * mesh.elimination_cost
        else None
    )
