"""Prediction of a cycle and its errors on a fine mesh, from the cycle on three coarser meshes.

The first mesh is coarse in space, the second in time, the third in space and time. The sum of the first two
orbits minus the third equals the orbit on the fine mesh up to a product of two small errors (combination
technique: Griebel, Schneider, Zenger 1992). One matrix factorisation on the fine mesh then gives the cycle
and its multipliers. The differences between the three orbits measure the errors of the coarse meshes;
pessimistic convergence rates bound the errors of the fine mesh.
"""

from dataclasses import dataclass, replace
from math import ceil

import numpy as np

from ....arrays import Array
from ...orbit.coefficient_tails import coefficient_tails_of
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.newton import error_of_largest_multiplier, solve_by_newton
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import ORBIT_MESH_SETTINGS, OrbitMesh
from ...orbit.tip_path_differences import PERIOD_INDEX, Y_INDEX, tip_path_differences
from .amplitude_errors import relative_largest_y_rounding_error
from .calibration import MeshErrorCalibration, mesh_error_calibration
from .finer_meshes import FINER_MESH_SETTINGS, ComparedCycle
from .settings import MESH_ERROR_CALIBRATION_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class CoarserMeshSettings:
    """Settings for the coarser meshes that predict a cycle on a fine mesh."""

    min_fine_to_coarse_order_difference: int = 2
    """Smallest difference between the orders of a fine mesh and of its coarse mesh."""
    max_fine_to_coarse_order_difference: int = 4
    """Largest difference between the orders of a fine mesh and of its coarse mesh."""
    min_log_error_decrease: float = 1.5
    """The difference of the orders is chosen, up to `max_fine_to_coarse_order_difference`, so that ln(error)
    in space is expected to decrease by at least this number from the coarse mesh to the fine mesh. Where
    coefficients decay slowly, errors oscillate with the order, and meshes of nearly the same order may agree
    by coincidence. With a difference of 2 orders, 16 of 112 errors of slender cones exceeded their estimates,
    by factors up to 2.2. With this decrease no error exceeded 0.4 times its estimate."""
    added_time_interval_fraction: float = 0.4
    """Additional time intervals of the fine mesh, as a fraction of the number of intervals of the coarse
    mesh."""
    max_order_above_intended_mesh: int = 2
    """A coarse mesh made for a fine mesh of order p predicts cycles on meshes of orders up to p +
    max_order_above_intended_mesh."""
    max_time_interval_count_ratio: float = 2.0
    """A coarse mesh predicts the cycle on a fine mesh only if the ratio of the numbers of time intervals,
    fine mesh to coarse mesh, is at most this number."""
    min_predicted_error_over_accuracy: float = 0.033
    """Lower limit of a predicted error in space or in time of period and largest y, divided by the accuracy:
    the coarse cycles are solved to a tenth of the accuracy, and their difference may be small because an
    error changes its sign between their meshes. Without this limit two of 400 errors of the largest y
    exceeded their estimates, by factors of 1.2 and 1.5."""
    pessimistic_error_to_coefficient_decay_ratio: float = 1.2
    """Pessimistic decrease of ln(error) in space per order, divided by the decrease of ln(coefficient) per
    order."""


COARSER_MESH_SETTINGS = CoarserMeshSettings()


class CoarserMeshes:
    """Solutions of a cycle on a coarse mesh, on meshes finer in space only and on meshes finer in time only,
    from which the cycle on a fine mesh is predicted. relative_largest_y_rounding_error: relative error of the
    largest y on any mesh, due to rounding."""

    def __init__(self, mesh: OrbitMesh, start: Orbit, accuracy: float, workspace: NewtonWorkspace) -> None:
        """Solves the cycle on the coarse mesh; raises Unsolvable. mesh: the fine mesh. start: an orbit near
        the cycle, on any mesh. accuracy: requested relative accuracy."""
        order_difference = _fine_to_coarse_order_difference(start)
        order = max(
            mesh.order - order_difference,
            ORBIT_MESH_SETTINGS.min_element_order - COARSER_MESH_SETTINGS.min_fine_to_coarse_order_difference,
        )
        self._max_predicted_order = (
            order + order_difference + COARSER_MESH_SETTINGS.max_order_above_intended_mesh
        )
        interval_count = (
            round(
                mesh.solved_duration_in_full_intervals
                / (1 + COARSER_MESH_SETTINGS.added_time_interval_fraction)
            )
            + 1
        )
        self._fine_mesh = mesh
        self.coarse_mesh = replace(mesh.with_order(order), interval_count=interval_count)
        self._min_error = COARSER_MESH_SETTINGS.min_predicted_error_over_accuracy * accuracy
        self._tolerance = FINER_MESH_SETTINGS.newton_tolerance_per_accuracy * accuracy
        self._workspace = workspace
        coarse_orbit = solve_by_newton(self.coarse_mesh.interpolated_orbit(start), self._tolerance, workspace)
        self.relative_largest_y_rounding_error = relative_largest_y_rounding_error(coarse_orbit)
        self._coarse_cycle = ComparedCycle(coarse_orbit)
        self._cycles_on_finer_meshes: dict[OrbitMesh, ComparedCycle] = {}

    def can_predict(self, mesh: OrbitMesh) -> bool:
        """Whether the cycle on `mesh` can be predicted: `mesh` has the element edges and the number of stages
        of the coarse mesh, and its order and its number of time intervals are not too large."""
        is_near = (
            mesh.order <= self._max_predicted_order
            and self._time_interval_count_ratio(mesh) <= COARSER_MESH_SETTINGS.max_time_interval_count_ratio
        )
        return (
            is_near
            and mesh.has_same_edges_and_order_ratios(self._fine_mesh)
            and mesh.stage_count == self.coarse_mesh.stage_count
        )

    def fine_mesh_prediction_and_errors(self, mesh: OrbitMesh) -> tuple[Orbit, MeshErrorCalibration]:
        """Returns (orbit, calibration): predicted orbit on the fine mesh `mesh`, and calibration of this mesh
        with predicted errors; raises Unsolvable."""
        space_cycle = self._cycle_on_mesh(replace(mesh, interval_count=self.coarse_mesh.interval_count))
        time_cycle = self._cycle_on_mesh(replace(self.coarse_mesh, interval_count=mesh.interval_count))
        fine_in_space = mesh.interpolated_orbit(space_cycle.orbit)
        fine_in_time = mesh.interpolated_orbit(time_cycle.orbit)
        coarse_orbit = mesh.interpolated_orbit(self._coarse_cycle.orbit)
        orbit = replace(
            fine_in_space, values=fine_in_space.values + fine_in_time.values - coarse_orbit.values
        )
        space_factor = np.exp(
            _pessimistic_log_space_error_decay(space_cycle.orbit) * (mesh.order - self.coarse_mesh.order)
        )
        # Between the time nodes the order is smaller: near the largest theta, local errors of fast modes
        # remain.
        time_orders = mesh.stage_count + np.array([1.0, 1.0, -1.0, -1.0])
        time_factors = self._time_interval_count_ratio(mesh) ** time_orders
        # The error of the multipliers may decrease more slowly than the errors of the paths. The difference
        # between the multipliers on the two finer meshes bounds this error.
        multiplier_error = error_of_largest_multiplier(space_cycle.multipliers, time_cycle.multipliers)
        space_errors = np.append(self._errors_of_finer_mesh(space_cycle, space_factor), 0.0)
        time_errors = np.append(self._errors_of_finer_mesh(time_cycle, time_factors), multiplier_error)
        return orbit, mesh_error_calibration(mesh, np.array([space_errors, time_errors]), orbit, None)

    def _cycle_on_mesh(self, mesh: OrbitMesh) -> ComparedCycle:
        if mesh not in self._cycles_on_finer_meshes:
            start = mesh.interpolated_orbit(self._coarse_cycle.orbit)
            solved = solve_by_newton(start, self._tolerance, self._workspace)
            self._cycles_on_finer_meshes[mesh] = ComparedCycle(solved)
        return self._cycles_on_finer_meshes[mesh]

    def _errors_of_finer_mesh(self, finer_cycle: ComparedCycle, error_ratio: Array | float) -> Array:
        """Errors of a finer mesh, (4,), of period, largest y, other extrema and path of the tip, from the
        difference between the cycle `finer_cycle` on this mesh and the cycle on the coarse mesh.

        error_ratio: errors of the coarse mesh divided by the errors of the finer mesh, for all errors or
        (4,).
        """
        # The difference of the cycles is the coarse error minus the fine one: ratio - 1 times the fine error.
        errors: Array = tip_path_differences(self._coarse_cycle.motion, finer_cycle.motion) / (
            error_ratio - 1
        )
        doubly_accurate = [PERIOD_INDEX, Y_INDEX]
        errors[doubly_accurate] = np.maximum(errors[doubly_accurate], self._min_error)
        return errors

    def _time_interval_count_ratio(self, mesh: OrbitMesh) -> float:
        """Ratio of the numbers of time intervals of `mesh` and of the coarse mesh, where the two last
        intervals, of half length, count as one."""
        return mesh.solved_duration_in_full_intervals / self.coarse_mesh.solved_duration_in_full_intervals


def _pessimistic_log_space_error_decay(orbit: Orbit) -> float:
    """Pessimistic estimate of how much ln(error in space) decreases when the order of the elements grows by 1
    (positive), from the decay of the coefficients of an orbit."""
    min_decay = (
        COARSER_MESH_SETTINGS.pessimistic_error_to_coefficient_decay_ratio
        * coefficient_tails_of(orbit).log_coefficient_decay_per_order
    )
    return min(
        max(min_decay, MESH_ERROR_CALIBRATION_SETTINGS.min_log_space_error_decay_per_order),
        MESH_ERROR_CALIBRATION_SETTINGS.max_log_space_error_decay_per_order,
    )


def _fine_to_coarse_order_difference(orbit: Orbit) -> int:
    """Difference between the orders of a fine mesh and its coarse mesh, for a cycle near the orbit
    `orbit`."""
    difference = ceil(
        COARSER_MESH_SETTINGS.min_log_error_decrease / _pessimistic_log_space_error_decay(orbit)
    )
    return min(
        max(difference, COARSER_MESH_SETTINGS.min_fine_to_coarse_order_difference),
        COARSER_MESH_SETTINGS.max_fine_to_coarse_order_difference,
    )
