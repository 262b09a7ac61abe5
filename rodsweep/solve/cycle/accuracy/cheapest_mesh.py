"""Choice of the cheapest mesh of a cycle for a requested accuracy, from the measured errors and convergence
rates of a calibrated mesh."""

from dataclasses import replace
from math import ceil

import numpy as np

from ....discretization.elements.resolution import RESOLUTION_SETTINGS
from ...orbit.orbit_mesh import ORBIT_MESH_SETTINGS, OrbitMesh
from ...orbit.path_differences import PATH_INDEX
from .calibration import Calibration
from .cycle_errors import errors_with_safety_factors, largest_weighted_error
from .settings import CALIBRATION_SETTINGS


def cheapest_mesh(calibration: Calibration, accuracy: float) -> OrbitMesh:
    """The cheapest mesh with the elements and stages of a calibrated mesh, for which the convergence rates
    predict errors within a fraction of the relative accuracy; the next finer mesh if no such mesh is allowed.
    """
    calibrated = calibration.mesh
    limits = ORBIT_MESH_SETTINGS
    min_order = max(limits.min_order, calibrated.order - CALIBRATION_SETTINGS.max_order_decrease)
    max_order = min(RESOLUTION_SETTINGS.max_order, calibrated.order + CALIBRATION_SETTINGS.max_order_increase)
    orders = np.arange(min_order, max_order + 1)
    min_intervals = max(
        limits.min_intervals, ceil(CALIBRATION_SETTINGS.min_interval_ratio * calibrated.interval_count)
    )
    max_intervals = min(
        CALIBRATION_SETTINGS.max_interval_ratio * calibrated.interval_count, limits.max_intervals
    )
    interval_counts = np.arange(min_intervals, max_intervals + 1)
    # Rates are measured up to the current mesh. On finer meshes errors in space may decrease no faster
    # than the distance of the tip's paths, and errors in time with the smallest order.
    min_decay = np.minimum(calibration.space_decay, calibration.space_decay[PATH_INDEX])
    decay = np.where(orders < calibrated.order, calibration.space_decay[:, None], min_decay[:, None])
    errors_in_space, errors_in_time = calibration.mesh_errors
    space_errors = errors_in_space[:, None] * np.exp(decay * (calibrated.order - orders))
    time_order = np.where(
        interval_counts < calibrated.interval_count,
        calibration.time_order[:, None],
        calibrated.stage_count + 1,
    )
    time_errors = (
        errors_in_time[:, None]
        * (calibrated.full_length_interval_count / (interval_counts - 1)) ** time_order
    )
    errors = errors_with_safety_factors(space_errors[:, :, None], time_errors[:, None, :], accuracy)
    period_error, y_error = errors[:2] / CALIBRATION_SETTINGS.planned_error_ratio
    extrema_error = errors[2] / CALIBRATION_SETTINGS.planned_extrema_error_over_tolerance
    is_accurate = largest_weighted_error(period_error, y_error, extrema_error) <= accuracy
    # For each order the smallest number of intervals that suffices, which argmax finds as the first True.
    meshes = [
        replace(
            calibrated, order=int(orders[i]), interval_count=int(interval_counts[np.argmax(is_accurate[i])])
        )
        for i in np.flatnonzero(is_accurate.any(axis=1))
    ]
    return min(meshes, key=lambda mesh: mesh.cost, default=calibrated.finer)
