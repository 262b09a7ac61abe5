"""Measurement of the errors of a cycle of a branch by cycles on two finer meshes.

The principle is described in `rodsweep.solve.branch.branch_errors`.
"""

import numpy as np

from ...arrays import Array, Complex
from ...determinant.exponents import EXPONENT_SETTINGS
from ..cycle.accuracy.calibration import MeshErrorCalibration, mesh_error_calibration
from ..cycle.accuracy.cycle_errors import LARGEST_MULTIPLIER_ERROR_INDEX
from ..cycle.accuracy.finer_meshes import FINER_MESH_SETTINGS, finer_meshes_and_removed_time_error
from ..cycle.cycles_along_parameter import interpolated_change
from ..orbit.measures import CycleMotion
from ..orbit.newton import ConvergedOrbit, error_of_largest_multiplier, nontrivial_multipliers_and_error
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import mesh_of_orbit
from ..orbit.tip_path_differences import tip_path_differences
from ..unsolvable import Unsolvable
from .bordered.border_condition import BorderCondition, moved_orbit
from .bordered.scale import PARAMETER_DIRECTION
from .branch_errors import BranchDerivatives, BranchErrorCalibration, branch_newton_tolerance
from .multiplier_sensitivity import MultiplierErrorAmplification
from .settings import BRANCH_ERROR_SETTINGS


def measured_branch_error_calibration(
    solved: ConvergedOrbit,
    derivatives: BranchDerivatives,
    accuracy: float,
    previous_calibration: MeshErrorCalibration | None,
) -> BranchErrorCalibration:
    """Errors of the mesh of the cycle `solved`, measured by comparison with two finer meshes; raises
    Unsolvable. derivatives: derivatives of the branch at `solved`. accuracy: relative accuracy of `solved`.
    previous_calibration: calibration at a previous cycle, for the convergence rates; None if there is no
    previous cycle."""
    mesh = mesh_of_orbit(solved.orbit)
    orbit = solved.orbit
    target_meshes, fraction = finer_meshes_and_removed_time_error(mesh)
    border = _border_of_comparison(orbit, derivatives)
    condition = BorderCondition.at_arc_length(derivatives.scale, border, orbit)
    rough = CycleMotion(orbit)
    multipliers = nontrivial_multipliers_and_error(solved)[0]
    differences = np.empty((2, LARGEST_MULTIPLIER_ERROR_INDEX + 2))
    for difference, target in zip(differences, target_meshes, strict=True):
        fine_orbit = condition.solve_on_mesh(
            target,
            solved,
            branch_newton_tolerance(accuracy),
            FINER_MESH_SETTINGS.max_distance_from_matrix_orbit,
        )
        difference[:] = _differences_between_meshes(rough, multipliers, fine_orbit, derivatives)
    sensitivity = MultiplierErrorAmplification.of_cycle(solved)
    multiplier_errors = [
        sensitivity.error_from_mesh_difference(float(difference[LARGEST_MULTIPLIER_ERROR_INDEX]), removed)
        for difference, removed in zip(differences, (1.0, fraction), strict=True)
    ]
    # The mesh that is finer in time removes only a fraction of the error in time.
    differences[1] /= fraction
    differences[:, LARGEST_MULTIPLIER_ERROR_INDEX] = multiplier_errors
    calibration = mesh_error_calibration(mesh, differences[:, :-1].copy(), orbit, previous_calibration)
    return BranchErrorCalibration(
        calibration,
        differences[:, -1],
        *parameter_sensitivities(rough, derivatives),
        sensitivity,
    )


def _border_of_comparison(orbit: Orbit, derivatives: BranchDerivatives) -> Array:
    """Border, (3,), of the condition under which the cycle `orbit` is solved on a finer mesh, in components
    (deflection, log period, parameter): the unit tangent of the branch, so that the arc length is equal.
    Close to the parameter coordinate 0 (coordinate: 1/k of a stiffness k, else the value), the direction of
    the parameter: at an equal arc length the finer mesh might have a negative coordinate, which no rod
    has."""
    scale = derivatives.scale
    coordinate = orbit.form.rod.coordinate(scale.parameter_name)
    is_near_zero = abs(coordinate) < scale.min_coordinate_unit
    is_steep = (
        abs(derivatives.parameter_per_arc_length)
        > BRANCH_ERROR_SETTINGS.min_slope_for_equal_parameter_near_zero
    )
    return PARAMETER_DIRECTION if is_near_zero and is_steep else derivatives.unit_tangent


def _differences_between_meshes(
    rough: CycleMotion, multipliers: Complex, fine: ConvergedOrbit, derivatives: BranchDerivatives
) -> Array:
    """Differences, (6,), between a cycle on a rough mesh and the same cycle on a fine mesh. The first five,
    at the parameter value of the rough cycle, are `tip_path_differences` and the difference of the largest
    multipliers; the last is the parameter difference at equal deflection. rough: motion of the rough cycle.
    multipliers: its nontrivial multipliers, (m,). derivatives: derivatives of the branch at this cycle."""
    orbit = rough.orbit
    scale = derivatives.scale
    deflection, _, parameter_change = scale.components(orbit) - scale.components(fine.orbit)
    length = derivatives.arc_length_for_parameter_change(parameter_change)
    target = mesh_of_orbit(fine.orbit)
    tangent = np.append(interpolated_change(orbit, derivatives.tangent[:-1], target), derivatives.tangent[-1])
    # The fine cycle is moved along the branch to the parameter value of the rough cycle.
    moved_fine = moved_orbit(fine.orbit, scale.parameter_name, length * tangent)
    multiplier_difference = error_of_largest_multiplier(
        multipliers, nontrivial_multipliers_and_error(fine)[0]
    ) + abs(length * derivatives.multiplier_change_per_arc_length)
    deflection_rate = abs(derivatives.unit_tangent[0])
    parameter_rate = abs(derivatives.parameter_per_arc_length)
    # Distance of the two branches across their common tangent, in (deflection, parameter).
    branch_distance = abs(
        parameter_change * derivatives.unit_tangent[0] - deflection * derivatives.parameter_per_arc_length
    )
    parameter_difference = branch_distance / max(
        deflection_rate, BRANCH_ERROR_SETTINGS.min_deflection_per_parameter_change * parameter_rate
    )
    return np.array(
        [*tip_path_differences(rough, CycleMotion(moved_fine)), multiplier_difference, parameter_difference]
    )


def parameter_sensitivities(motion: CycleMotion, derivatives: BranchDerivatives) -> tuple[float, float]:
    """Sensitivities |(p/y) dy/dp| of the largest tip y and |(p/T) dT/dp| of the period T to the parameter p
    along a branch at the cycle `motion`. derivatives: derivatives of the branch at this cycle."""
    moved_motion = motion_displaced_along_tangent(
        motion.orbit, derivatives.scale.parameter_name, derivatives.tangent
    )
    y = motion.tip_extrema["tip_y_max"]
    moved_y = moved_motion.tip_extrema["tip_y_max"]
    parameter_rate = max(abs(derivatives.parameter_per_arc_length), EXPONENT_SETTINGS.min_divisor)
    y_rate = abs((moved_y - y) / (BRANCH_ERROR_SETTINGS.sensitivity_arc_length * y))
    return y_rate / parameter_rate, abs(float(derivatives.unit_tangent[1])) / parameter_rate


def motion_displaced_along_tangent(orbit: Orbit, name: str, tangent: Array) -> CycleMotion:
    """The motion of the orbit after a displacement by `sensitivity_arc_length` along the tangent of its
    branch, (N + 1,), or in the opposite direction if no rod has the parameters ahead; raises Unsolvable.
    name: name of the parameter."""
    step = BRANCH_ERROR_SETTINGS.sensitivity_arc_length * tangent
    if 0 <= orbit.form.rod.coordinate(name) < -step[-1]:  # no rod has a negative coordinate
        step = -step
    try:
        return CycleMotion(moved_orbit(orbit, name, step))
    except Unsolvable:  # at the end of a branch the force crushes the rod ahead, but not the rod behind
        return CycleMotion(moved_orbit(orbit, name, -step))
