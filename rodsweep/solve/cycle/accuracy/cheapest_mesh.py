"""Choice of the cheapest mesh of a cycle for a requested accuracy, from the measured errors and convergence
rates of a calibrated mesh."""

from dataclasses import replace
from math import ceil

import numpy as np

from ....discretization.elements.resolution import RESOLUTION_SETTINGS
from ...orbit.orbit_mesh import ORBIT_MESH_SETTINGS, OrbitMesh
from ...orbit.tip_path_differences import PATH_INDEX
from .calibration import MeshErrorCalibration
from .cycle_errors import errors_with_safety_factors, largest_weighted_error
from .settings import MESH_ERROR_CALIBRATION_SETTINGS


def cheapest_mesh(calibration: MeshErrorCalibration, accuracy: float) -> OrbitMesh:
    """The cheapest mesh that differs from the calibrated mesh only in the order of its elements and the
    number of its time intervals, and for which the convergence rates predict errors within a fraction of the
    relative accuracy; the next finer mesh if no such mesh is allowed.
    """
    calibrated = calibration.mesh
    limits = ORBIT_MESH_SETTINGS
    settings = MESH_ERROR_CALIBRATION_SETTINGS
    min_order = max(limits.min_element_order, calibrated.order - settings.max_element_order_decrease)
    max_order = min(RESOLUTION_SETTINGS.max_order, calibrated.order + settings.max_element_order_increase)
    orders = np.arange(min_order, max_order + 1)
    min_intervals = ceil(settings.min_planned_over_current_intervals * calibrated.interval_count)
    min_intervals = max(limits.min_time_interval_count, min_intervals)
    max_intervals = settings.max_time_interval_count_ratio * calibrated.interval_count
    max_intervals = min(max_intervals, limits.max_time_interval_count)
    interval_counts = np.arange(min_intervals, max_intervals + 1)
    # Rates are measured up to the current mesh. On finer meshes errors in space may decrease no faster
    # than the distance of the tip's paths, and errors in time with the smallest order.
    measured_decay = calibration.log_space_error_decay_per_order
    min_decay = np.minimum(measured_decay, measured_decay[PATH_INDEX])
    decay = np.where(orders < calibrated.order, measured_decay[:, None], min_decay[:, None])
    errors_in_space, errors_in_time = calibration.mesh_errors
    space_errors = errors_in_space[:, None] * np.exp(decay * (calibrated.order - orders))
    time_convergence_order = np.where(
        interval_counts < calibrated.interval_count,
        calibration.time_convergence_order[:, None],
        calibrated.stage_count + 1,
    )
    length_ratio = calibrated.solved_duration_in_full_intervals / (interval_counts - 1)
    time_errors = errors_in_time[:, None] * length_ratio**time_convergence_order
    errors = errors_with_safety_factors(space_errors[:, :, None], time_errors[:, None, :], accuracy)
    period_error, y_error = errors[:2] / settings.planned_error_per_accuracy
    extrema_error = errors[2] / settings.planned_extrema_error_over_tolerance
    is_accurate = largest_weighted_error(period_error, y_error, extrema_error) <= accuracy
    # For each order the smallest number of intervals that suffices, which argmax finds as the first True.
    meshes = [
        replace(
            calibrated, order=int(orders[i]), interval_count=int(interval_counts[np.argmax(is_accurate[i])])
        )
        for i in np.flatnonzero(is_accurate.any(axis=1))
    ]
    return min(meshes, key=lambda mesh: mesh.elimination_cost, default=calibrated.finer_mesh)
