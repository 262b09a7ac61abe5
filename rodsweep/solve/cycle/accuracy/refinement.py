"""The cycle near an approximate orbit, solved to a requested accuracy on automatically chosen meshes.

The coefficient tails of a nearby orbit determine the first mesh (`orbit_mesh`). If the measured errors
(`finer_meshes`) exceed the accuracy, these errors determine the cheapest sufficient mesh.
"""

from contextlib import suppress
from dataclasses import replace
from math import inf

import numpy as np

from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.measures import CycleMotion
from ...orbit.mesh_choice import (
    cheapest_stage_count,
    coarser_regraded_mesh,
    finer_orbit_mesh,
    mesh_from_coefficient_tails,
)
from ...orbit.newton import (
    ORBIT_NEWTON_SETTINGS,
    ConvergedOrbit,
    newton_step,
    newton_step_if_matrix_distant,
    nontrivial_multipliers_and_error,
    solve_by_newton,
)
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh, mesh_limit_error
from ...unsolvable import Unsolvable
from .amplitude_errors import (
    multiplier_change_per_relative_exponent,
    relative_largest_y_rounding_error,
    with_largest_y_rounding_error,
)
from .calibration import MeshErrorCalibration
from .cheapest_mesh import cheapest_mesh
from .coarser_meshes import CoarserMeshes
from .error_indicators import error_indicators
from .finer_meshes import measured_mesh_error_calibration, with_error_indicators
from .minimal_period import MINIMAL_PERIOD_SETTINGS, common_harmonic_divisor, restricted_to_minimal_period
from .newton_tolerances import newton_tolerance, require_similar_size
from .refined_cycle import RefinedCycle
from .settings import REFINEMENT_SETTINGS


def cycle_with_calibrated_errors(
    calibration: MeshErrorCalibration,
    solved: ConvergedOrbit,
    accuracy: float,
    motion: CycleMotion | None = None,
) -> RefinedCycle:
    """The solved orbit `solved` as a cycle, with measures, multipliers and the errors of a calibration that
    is scaled to this orbit. The error of the largest multiplier includes the effect of a matrix that was
    assembled at a nearby orbit, and the effect of the amplitude error. The errors of the extrema include
    rounding near a Hopf point or a fold. accuracy: requested relative accuracy. motion: motion of the orbit,
    if known."""

    motion = motion or CycleMotion(solved.orbit)
    measures = motion.measures
    errors = with_largest_y_rounding_error(calibration.estimated_cycle_errors(accuracy), solved, measures)
    multipliers, trivial_error = nontrivial_multipliers_and_error(solved)
    max_modulus = max(float(np.abs(multipliers[0])), 1.0) if len(multipliers) else 1.0
    # The matrix was assembled at a nearby orbit; the error of the trivial multiplier shows the effect.
    matrix_error = (
        REFINEMENT_SETTINGS.multiplier_error_per_matrix_distance
        * max_modulus
        * (solved.distance_from_matrix_orbit + trivial_error)
    )
    exponent_error = 2 * errors.amplitude_error * multiplier_change_per_relative_exponent(multipliers)
    errors = replace(errors, multiplier_error=max(errors.multiplier_error, exponent_error) + matrix_error)
    return RefinedCycle(solved, calibration, motion, measures, multipliers, trivial_error, errors)


def refined_cycle_of_any_period(
    orbit: Orbit, accuracy: float, workspace: NewtonWorkspace, parameter_name: str | None = None
) -> RefinedCycle:
    """The cycle near an approximate orbit, over one or more minimal periods, to a relative accuracy or on the
    finest allowed mesh; raises Unsolvable.

    workspace: memory of Newton's matrices. parameter_name: parameter along which the tangent of the cycle is
    computed; None for a single cycle, whose errors are predicted from coarser meshes if possible.

    Near a Hopf point a coarse mesh may have no cycle, because the mesh displaces the Hopf point. Finer meshes
    are then tried.
    """
    settings = REFINEMENT_SETTINGS
    mesh_accuracy = max(accuracy, settings.min_first_mesh_accuracy)
    start = orbit
    while True:
        try:
            rough_orbit = solve_by_newton(start, settings.nearby_orbit_newton_tolerance, workspace)
            near_orbit = require_similar_size(rough_orbit, orbit.max_energy_norm).orbit
            stages = cheapest_stage_count(accuracy)
            if parameter_name is None:
                first_accuracy = settings.first_mesh_accuracy_ratio * mesh_accuracy
                first_mesh = mesh_from_coefficient_tails(near_orbit, first_accuracy, stages)
                fewest = settings.min_time_intervals_for_prediction
                first_mesh = replace(first_mesh, interval_count=max(first_mesh.interval_count, fewest))
                with suppress(Unsolvable):
                    return _cycle_with_predicted_errors(first_mesh, near_orbit, accuracy, workspace)
            mesh = mesh_from_coefficient_tails(near_orbit, mesh_accuracy, stages)
            solved = _solve_on_mesh(mesh, rough_orbit, mesh_accuracy, parameter_name)
            return cycle_with_measured_errors(solved, None, accuracy, parameter_name)
        except Unsolvable:
            # Only symmetric cycles are born at Hopf points.
            if mesh_accuracy <= settings.finest_accuracy_for_mesh_choice or not orbit.is_symmetric:
                raise
            mesh_accuracy *= settings.accuracy_factor_after_mesh_without_cycle
            mesh_accuracy = max(mesh_accuracy, settings.finest_accuracy_for_mesh_choice)
            mesh = mesh_from_coefficient_tails(orbit, mesh_accuracy, orbit.stage_count)
            cost = mesh.interval_count * mesh.unknown_count**3
            if cost > settings.max_mesh_cost_after_mesh_without_cycle:
                raise
            start = mesh.interpolated_orbit(orbit)


def _cycle_with_predicted_errors(
    mesh: OrbitMesh, start: Orbit, accuracy: float, workspace: NewtonWorkspace
) -> RefinedCycle:
    """A single cycle with errors predicted from coarser meshes, on the mesh `mesh` or a finer mesh. start: an
    orbit near the cycle.

    The most accurate cycle is returned if no allowed mesh reaches the accuracy. Raises Unsolvable if a mesh
    has no cycle near `start`, if the errors do not decrease, or if the cycle is far from its prediction.
    """
    coarser_meshes = CoarserMeshes(mesh, start, accuracy, workspace)
    # No mesh reduces the effect of rounding, which other errors need not fall below.
    sufficient_error = max(accuracy, coarser_meshes.relative_largest_y_rounding_error)
    max_error = inf
    orbit, calibration = best = coarser_meshes.fine_mesh_prediction_and_errors(mesh)
    for _ in range(REFINEMENT_SETTINGS.max_meshes_per_cycle):
        error = calibration.estimated_cycle_errors(accuracy).largest_weighted_error
        if error < best[1].estimated_cycle_errors(accuracy).largest_weighted_error:
            best = orbit, calibration
        if error <= sufficient_error:
            break
        # A prediction that gets worse on a finer mesh has reached rounding errors, or another cycle.
        if error > max_error:
            raise Unsolvable("the errors do not decrease on finer meshes")
        mesh = finer_orbit_mesh(mesh, cheapest_mesh(calibration, sufficient_error))
        max_error = REFINEMENT_SETTINGS.max_error_increase_on_finer_mesh * error
        if not mesh.is_allowed:
            break
        if not coarser_meshes.can_predict(mesh):
            coarser_meshes = CoarserMeshes(mesh, orbit, accuracy, workspace)
        orbit, calibration = coarser_meshes.fine_mesh_prediction_and_errors(mesh)
    solved = require_similar_size(
        solve_by_newton(best[0], newton_tolerance(accuracy), workspace), start.max_energy_norm
    )
    if solved.distance_from_matrix_orbit > max(
        REFINEMENT_SETTINGS.max_prediction_distance_per_accuracy * accuracy,
        REFINEMENT_SETTINGS.always_accepted_prediction_distance,
    ):
        raise Unsolvable("the cycle is far from its prediction by coarser meshes")
    solved = newton_step_if_matrix_distant(
        solved, min(accuracy, REFINEMENT_SETTINGS.max_distance_from_matrix_orbit)
    )
    motion = CycleMotion(solved.orbit)
    calibration = with_error_indicators(best[1], error_indicators(solved, motion))
    if calibration.estimated_cycle_errors(accuracy).largest_weighted_error > sufficient_error >= error:
        raise Unsolvable("coarser meshes do not predict the error of the amplitude")
    return cycle_with_calibrated_errors(calibration, solved, accuracy, motion)


def cycle_with_measured_errors(
    solved: ConvergedOrbit,
    calibration: MeshErrorCalibration | None,
    accuracy: float,
    parameter_name: str | None,
) -> RefinedCycle:
    """The solved orbit `solved` as a cycle with measured errors, solved again on finer meshes if necessary;
    raises Unsolvable.

    calibration: calibration at a nearby cycle, or None. parameter_name: parameter along which the tangent of
    the cycle is computed, or None. The most accurate cycle is returned if no allowed mesh reaches the
    accuracy.
    """
    best_cycle = None
    max_error = inf
    for _ in range(REFINEMENT_SETTINGS.max_meshes_per_cycle):
        calibration = measured_mesh_error_calibration(solved, accuracy, calibration)
        cycle = cycle_with_calibrated_errors(calibration, solved, accuracy)
        error = cycle.errors.largest_weighted_error
        if best_cycle is None or error < best_cycle.errors.largest_weighted_error:
            best_cycle = cycle
        sufficient_error = max(accuracy, relative_largest_y_rounding_error(solved))
        if error <= sufficient_error or error > max_error:
            break
        max_error = REFINEMENT_SETTINGS.max_error_increase_on_finer_mesh * error
        target = coarser_regraded_mesh(cheapest_mesh(calibration, sufficient_error), solved.orbit)
        next_mesh = finer_orbit_mesh(calibration.mesh, target)
        if not next_mesh.is_allowed:
            break
        solved = _solve_on_mesh(next_mesh, solved, accuracy, parameter_name)
    if best_cycle is None:
        raise mesh_limit_error()
    return best_cycle


def _solve_on_mesh(
    mesh: OrbitMesh, solved: ConvergedOrbit, accuracy: float, parameter_name: str | None
) -> ConvergedOrbit:
    """The orbit `solved` solved again on the mesh `mesh`, with a matrix assembled at the solution, so that
    its multipliers are exact to rounding error; raises Unsolvable. accuracy: requested relative accuracy.
    parameter_name: parameter along which the tangent of the orbit is computed, or None."""
    # `newton_step` adds a quadratically convergent step, so half of the digits suffice here.
    first_change = (newton_tolerance(accuracy) / ORBIT_NEWTON_SETTINGS.max_error_per_squared_step) ** 0.5
    solution = solve_by_newton(mesh.interpolated_orbit(solved.orbit), first_change, solved.workspace)
    return newton_step(require_similar_size(solution, solved.orbit.max_energy_norm), parameter_name)


def refined_cycle(
    orbit: Orbit, accuracy: float, workspace: NewtonWorkspace, parameter_name: str | None = None
) -> RefinedCycle:
    """The cycle near an orbit, over its minimal period, to a relative accuracy; raises Unsolvable.

    workspace: memory of Newton's matrices. parameter_name: parameter along which the tangent of the cycle is
    computed, or None. If the stability is undecided, the cycle is solved again for a hundredth of the
    accuracy.
    """
    cycle = refined_cycle_of_any_period(
        restricted_to_minimal_period(orbit), accuracy, workspace, parameter_name
    )
    if common_harmonic_divisor(cycle.motion, MINIMAL_PERIOD_SETTINGS.min_harmonic_ratio) > 1:
        cycle = refined_cycle_of_any_period(
            restricted_to_minimal_period(cycle.orbit), accuracy, workspace, parameter_name
        )
    # The largest multiplier is 1 within its error; a hundredth of the error may show the stability.
    if cycle.is_stable is None:
        cycle = refined_cycle_of_any_period(
            cycle.orbit,
            max(
                accuracy / REFINEMENT_SETTINGS.accuracy_divisor_if_stability_undecided,
                REFINEMENT_SETTINGS.finest_accuracy_for_mesh_choice,
            ),
            workspace,
            parameter_name,
        )
    return cycle
