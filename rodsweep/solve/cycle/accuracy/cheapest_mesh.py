"""Choice of the cheapest mesh of a cycle for a requested accuracy, from the measured errors and convergence
rates of a calibrated mesh."""

from dataclasses import replace
from math import ceil

import numpy as np

from ....discretization.elements.resolution import RESOLUTION_SETTINGS
from ...orbit.orbit_mesh import ORBIT_MESH_SETTINGS, OrbitMesh
from ...orbit.path_differences import PATH_INDEX
from .calibration import Calibration
from .calibration_settings import CALIBRATION_SETTINGS
from .cycle_errors import errors_with_safety_factors, largest_weighted_error


def cheapest_mesh(calibration: Calibration, accuracy: float) -> OrbitMesh:
    """The cheapest mesh with the elements and stages of a calibrated mesh, for which the convergence rates
    predict errors within a fraction of the relative accuracy; the next finer mesh if no such mesh is allowed.
    """
    present = calibration.mesh
    allowed = ORBIT_MESH_SETTINGS
    lowest = max(allowed.min_order, present.order - CALIBRATION_SETTINGS.max_order_decrease)
    highest = min(RESOLUTION_SETTINGS.max_order, present.order + CALIBRATION_SETTINGS.max_order_increase)
    orders = np.arange(lowest, highest + 1)
    fewest = max(
        allowed.min_intervals, ceil(CALIBRATION_SETTINGS.min_interval_ratio * present.interval_count)
    )
    most = min(CALIBRATION_SETTINGS.max_interval_ratio * present.interval_count, allowed.max_intervals)
    intervals = np.arange(fewest, most + 1)
    # Rates are measured up to the present mesh. On finer meshes errors in space may decrease no faster
    # than the distance of the tip's paths, and errors in time with the smallest order.
    least = np.minimum(calibration.space_decay, calibration.space_decay[PATH_INDEX])
    fall = np.where(orders < present.order, calibration.space_decay[:, None], least[:, None])
    space = calibration.space_errors[:, None] * np.exp(fall * (present.order - orders))
    power = np.where(
        intervals < present.interval_count, calibration.time_order[:, None], present.stage_count + 1
    )
    time = calibration.time_errors[:, None] * (present.full_intervals / (intervals - 1)) ** power
    errors = errors_with_safety_factors(space[:, :, None], time[:, None, :], accuracy)
    enough = largest_weighted_error(*errors[:3]) <= CALIBRATION_SETTINGS.planned_error_ratio * accuracy
    meshes = [
        replace(present, order=int(orders[i]), interval_count=int(intervals[np.argmax(enough[i])]))
        for i in np.flatnonzero(enough.any(axis=1))
    ]
    return min(meshes, key=lambda mesh: mesh.cost, default=present.finer)
