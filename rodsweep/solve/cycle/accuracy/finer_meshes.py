"""Measurement of the errors of a mesh by comparison with a mesh finer in space and a mesh finer in time.

A comparison with a coarser mesh would measure only the error of the coarser mesh, and the error of the mesh
itself would need an assumed, pessimistic order. Two finer meshes measure the error directly.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np

from ....arrays import Array, Complex
from ...orbit.measures import CycleMotion
from ...orbit.newton import (
    ConvergedOrbit,
    error_of_largest_multiplier,
    newton_step_if_matrix_distant,
    nontrivial_multipliers_and_error,
    solve_by_newton,
)
from ...orbit.orbit_mesh import OrbitMesh, mesh_of_orbit
from ...orbit.tip_path_differences import Y_INDEX, tip_path_differences
from .calibration import MeshErrorCalibration, mesh_error_calibration
from .error_indicators import AMPLITUDE_ERROR_INDEX, error_indicators
from .settings import MESH_ERROR_CALIBRATION_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class FinerMeshSettings:
    """Settings for the two finer meshes by which the errors of a mesh are measured."""

    element_order_increase: int = 2
    """Increase of the order from a mesh to the mesh finer in space, so that the errors fall to a tenth or
    less."""
    added_time_interval_fraction: float = 0.4
    """Additional time intervals of the mesh finer in time, as a fraction of the number of intervals of the
    mesh. A known fraction of the error in time remains on the finer mesh."""
    newton_tolerance_per_accuracy: float = 0.1
    """Tolerance of Newton's method on the finer meshes, divided by the accuracy."""
    max_distance_from_matrix_orbit: float = 1e-3
    """Largest relative distance between a cycle and the orbit whose matrix gives its multipliers."""


FINER_MESH_SETTINGS = FinerMeshSettings()


def finer_meshes_and_removed_time_error(mesh: OrbitMesh) -> tuple[tuple[OrbitMesh, OrbitMesh], float]:
    """Returns ((space, time), fraction): the mesh finer in space, the mesh finer in time, and the fraction of
    the error in time that the mesh finer in time removes."""
    interval_count = ceil((1 + FINER_MESH_SETTINGS.added_time_interval_fraction) * mesh.interval_count)
    # Errors in time fall with this power of the full intervals; the last two intervals have half the length.
    removed_fraction = 1 - (mesh.solved_duration_in_full_intervals / (interval_count - 1)) ** (
        mesh.stage_count + 1
    )
    return (
        mesh.with_order(mesh.order + FINER_MESH_SETTINGS.element_order_increase),
        replace(mesh, interval_count=interval_count),
    ), removed_fraction


def measured_mesh_error_calibration(
    solved: ConvergedOrbit, accuracy: float, previous: MeshErrorCalibration | None
) -> MeshErrorCalibration:
    """Calibration of the mesh of the orbit `solved`, with errors measured on two finer meshes;
    raises Unsolvable.

    accuracy: requested relative accuracy. previous: calibration at a nearby orbit, on any mesh, from which
    the convergence rates follow (`mesh_error_calibration`) and, if its mesh is the same, lower limits of the
    errors; None: the rates are estimated from the coefficients of the orbit and the number of stages. If the
    errors in space of `previous` can be reused, only the errors in time are measured again, unless the
    resulting error estimate exceeds the accuracy.
    """
    mesh = mesh_of_orbit(solved.orbit)
    cycle = ComparedCycle(solved)
    (space_mesh, time_mesh), removed_fraction = finer_meshes_and_removed_time_error(mesh)
    tolerance = FINER_MESH_SETTINGS.newton_tolerance_per_accuracy * accuracy

    def errors_beside(finer_mesh: OrbitMesh) -> Array:
        start = finer_mesh.interpolated_orbit(solved.orbit)
        fine = ComparedCycle(solve_by_newton(start, tolerance, solved.workspace))
        change = error_of_largest_multiplier(cycle.multipliers, fine.multipliers)
        return np.append(tip_path_differences(cycle.motion, fine.motion), change)

    def calibration_with(space_errors: Array, time_errors: Array) -> MeshErrorCalibration:
        calibration = mesh_error_calibration(
            mesh, np.array([space_errors, time_errors]), solved.orbit, previous
        )
        return with_error_indicators(calibration, error_indicators(solved, cycle.motion))

    time_errors = errors_beside(time_mesh) / removed_fraction
    same_mesh = previous if previous is not None and previous.mesh == mesh else None
    if same_mesh is None:
        return calibration_with(errors_beside(space_mesh), time_errors)
    # A second measurement on the same mesh may be small only because an error changes its sign nearby.
    min_space_errors, min_time_errors = same_mesh.min_remeasured_errors(solved.orbit)
    time_errors = np.maximum(time_errors, min_time_errors)
    if same_mesh.can_reuse_space_errors:
        calibration = calibration_with(same_mesh.space_errors_scaled_to_orbit, time_errors)
        if calibration.estimated_cycle_errors(accuracy).largest_weighted_error <= accuracy:
            return replace(
                calibration, parameter_change_since_measurement=same_mesh.parameter_change_since_measurement
            )
    return calibration_with(np.maximum(errors_beside(space_mesh), min_space_errors), time_errors)


def with_error_indicators(calibration: MeshErrorCalibration, indicators: Array) -> MeshErrorCalibration:
    """The calibration of a mesh at an orbit with the `error_indicators` of this orbit, (3,). The estimated
    error of the amplitude, one of the indicators, is a lower limit of the error in time of the largest y,
    because the measured error may be small only because it changes its sign near the cycle."""
    errors = calibration.mesh_errors.copy()
    amplitude_error = indicators[AMPLITUDE_ERROR_INDEX] / MESH_ERROR_CALIBRATION_SETTINGS.error_safety_factor
    errors[1, Y_INDEX] = max(errors[1, Y_INDEX], amplitude_error)
    return replace(calibration, mesh_errors=errors, error_indicators=indicators)


class ComparedCycle:
    """A cycle solved on one of several meshes, with the quantities that are compared between the meshes."""

    def __init__(self, solved: ConvergedOrbit) -> None:
        self._converged_orbit = solved
        self.orbit = solved.orbit
        self.motion = CycleMotion(solved.orbit)

    @cached_property
    def multipliers(self) -> Complex:
        """Nontrivial multipliers of the cycle, (multipliers,), by descending modulus."""
        return nontrivial_multipliers_and_error(
            newton_step_if_matrix_distant(
                self._converged_orbit, FINER_MESH_SETTINGS.max_distance_from_matrix_orbit
            )
        )[0]
