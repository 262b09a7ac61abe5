"""Chain of cycles over the rods of a sweep: the cycle of a rod predicts the cycle of the next, neighbouring
rod.

The prediction is a polynomial through a cycle, its tangent along the varied parameter, and earlier cycles.
From the prediction, a single matrix factorisation usually gives the next cycle with its multipliers. A step
too long for Newton's method is divided, on a coarser mesh. Mesh and calibrated errors are passed along the
chain, too. The next cycle depends only on the data in `CycleStart`, so that an interrupted chain resumes
with the same results.
"""

from dataclasses import dataclass, field, replace
from math import inf, isnan, nan
from typing import Any

import numpy as np

from ...arrays import Array, Complex, list_of
from ...discretization.stress.form import StressForm
from ..orbit.element_order_choice import without_excess_orders
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.measures import CycleMotion
from ..orbit.mesh_choice import coarser_regraded_mesh
from ..orbit.newton import ConvergedOrbit, newton_step_if_matrix_distant, solve_by_newton
from ..orbit.orbit_mesh import OrbitMesh, mesh_of_orbit
from ..orbit.stored_orbit import orbit_arrays, orbit_from_arrays
from ..spectrum.path.leader_in_range import NO_RANGE, ArmRange
from ..unsolvable import Unsolvable
from .accuracy.calibration import MeshErrorCalibration
from .accuracy.cheapest_mesh import cheapest_mesh
from .accuracy.error_indicators import error_indicators
from .accuracy.newton_tolerances import allowed_distance_from_matrix_orbit, newton_tolerance
from .accuracy.refined_cycle import RefinedCycle
from .accuracy.refinement import cycle_with_calibrated_errors, cycle_with_measured_errors
from .cycles_along_parameter import (
    CyclePredictor,
    orbit_followed_in_parameter_steps,
    orbit_near_prediction,
    predictor_from,
    relative_parameter_difference,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class NextMeshSettings:
    """Settings for the choice of the next mesh in a chain of cycles."""

    max_error_ratio_of_same_mesh: float = 0.9
    """A mesh is sufficient for the next cycle if the error of the current cycle is at most this fraction of
    the accuracy."""
    max_new_mesh_cost_ratio: float = 0.85
    """A sufficient mesh is replaced by a new mesh if the cost of eliminating Newton's matrix on the new mesh
    is at most this fraction of the cost on the sufficient mesh."""
    max_new_mesh_cost_ratio_if_measured: float = 0.5
    """This limit replaces `max_new_mesh_cost_ratio` if the errors were measured at the current cycle:
    measuring the errors of a new mesh costs as much as three cycles."""


NEXT_MESH_SETTINGS = NextMeshSettings()


UNKNOWN_EIGENVALUES: Complex = np.array([complex(nan, nan)])
"""Value of `CycleStart.eigenvalues` if the eigenvalues are not known."""
CheckpointArrays = dict[str, Array]
"""Data of the previous rod of a chain in a checkpoint: arrays by name, as `CycleStart.arrays` returns
them."""


@dataclass(frozen=True, eq=False)
class CycleStart:
    """Data of a solved cycle from which the next rod of a chain starts.

    predictor: polynomial for the next cycle. next_mesh: mesh for the next cycle. calibration: measured errors
    of a mesh, perhaps outdated. eigenvalues: eigenvalues of the straight rod in 1/tau2 with Im >= 0, (n,),
    the leading eigenvalue first; NaN if not known. arm_range: parameter range with interpolated propagators
    that contains the next rod, or None.
    """

    predictor: CyclePredictor
    next_mesh: OrbitMesh
    calibration: MeshErrorCalibration
    eigenvalues: Complex = field(default_factory=UNKNOWN_EIGENVALUES.copy)
    arm_range: ArmRange | None = None

    @classmethod
    def from_cycle(
        cls,
        refined: RefinedCycle,
        previous: "CycleStart | None",
        name: str,
        accuracy: float,
        eigenvalues: Complex = UNKNOWN_EIGENVALUES,
    ) -> "CycleStart":
        """Data of the cycle `refined`, which was solved with its tangent. previous: data of the previous rod
        of the chain, or None. name: varied parameter. accuracy: requested relative accuracy.
        eigenvalues: as in `CycleStart`."""
        predictor = predictor_from(refined.converged_orbit, previous.predictor if previous else None, name)
        return cls(predictor, *_next_mesh_and_calibration(refined, previous, name, accuracy), eigenvalues)

    def arrays(self) -> CheckpointArrays:
        """All data as named arrays, for a checkpoint. In the notation of `CyclePredictor`: orbit (N,), values
        and derivatives under the name data (m, N + 1), parameter offsets under the name places (m,),
        derivative orders under the name orders (m,). Further arrays: eigenvalues (n,), the fields of the
        range of arms (5,), meshes, symmetry, rod with its material, and calibration."""
        predictor = self.predictor
        arrays: dict[str, Any] = {
            "places": predictor.parameter_offsets,
            "orders": predictor.derivative_orders,
            "data": predictor.values_and_derivatives,
            "next_mesh": self.next_mesh.as_array,
            "eigenvalues": self.eigenvalues,
            "arm_range": np.array(self.arm_range or NO_RANGE),
        }
        return orbit_arrays(predictor.orbit) | arrays | self.calibration.arrays()

    @classmethod
    def from_arrays(cls, arrays: CheckpointArrays) -> "CycleStart":
        """The data of the previous rod of a chain, from the named arrays that `CycleStart.arrays` returns."""
        next_mesh = OrbitMesh.from_array(arrays["next_mesh"])
        orbit = orbit_from_arrays(arrays)
        predictor = CyclePredictor(orbit, *(arrays[name] for name in ("places", "orders", "data")))
        eigenvalues = arrays["eigenvalues"].astype(complex)
        start = cls(predictor, next_mesh, MeshErrorCalibration.from_arrays(arrays), eigenvalues)
        arm_range = ArmRange(*list_of(arrays["arm_range"]))
        return start if isnan(arm_range.low) else replace(start, arm_range=arm_range)


def _next_mesh_and_calibration(
    refined: RefinedCycle, previous: "CycleStart | None", name: str, accuracy: float
) -> tuple[OrbitMesh, MeshErrorCalibration]:
    """Returns (mesh, calibration) for the next cycle of a chain, after the cycle `refined`. The calibration
    is outdated if the errors must be measured again at the next cycle. previous: data of the previous rod, or
    None. name: varied parameter. accuracy: requested relative accuracy."""
    current_mesh = mesh_of_orbit(refined.orbit)
    calibration = refined.calibration
    is_accurate = (
        refined.errors.largest_weighted_error <= NEXT_MESH_SETTINGS.max_error_ratio_of_same_mesh * accuracy
    )
    if not calibration.is_measured_at_orbit and not is_accurate:
        # Errors scaled from an earlier cycle, if too large, are first measured on this mesh.
        return (
            current_mesh,
            calibration if calibration.can_reuse_space_errors else calibration.with_outdated_errors,
        )
    max_cost = inf if not is_accurate else _max_new_mesh_cost_ratio(refined, previous, name)
    if max_cost:
        cheapest = coarser_regraded_mesh(cheapest_mesh(calibration, accuracy), refined.orbit)
        target_mesh = without_excess_orders(cheapest, refined.orbit)
        if target_mesh.elimination_cost <= max_cost * current_mesh.elimination_cost:
            return target_mesh, calibration.with_outdated_errors
    return current_mesh, calibration


def _max_new_mesh_cost_ratio(refined: RefinedCycle, previous: "CycleStart | None", name: str) -> float:
    """Largest cost of eliminating Newton's matrix on a new mesh, divided by the cost on the current,
    sufficient mesh of the cycle `refined`, for the new mesh to be used; 0 if the current mesh remains in use.
    previous: data of the previous rod, or None. name: varied parameter."""
    if previous is None:
        # Coefficient tails, not measured errors, determined the first mesh of a chain.
        return NEXT_MESH_SETTINGS.max_new_mesh_cost_ratio
    if refined.calibration.is_measured_at_orbit:
        return NEXT_MESH_SETTINGS.max_new_mesh_cost_ratio_if_measured
    relative_parameter_change = relative_parameter_difference(
        previous.predictor.orbit.form, refined.orbit.form, name
    )
    # If the errors must be measured again anyway, another mesh needs no additional measurement.
    return (
        0.0
        if refined.calibration.is_valid_after_parameter_change(relative_parameter_change)
        else NEXT_MESH_SETTINGS.max_new_mesh_cost_ratio
    )


def cycle_from_neighbour(
    neighbour: CycleStart, form: StressForm, name: str, accuracy: float, workspace: NewtonWorkspace
) -> RefinedCycle:
    """The cycle of a rod that differs from the neighbour's rod in the parameter `name` only; raises
    Unsolvable. The errors are scaled from the neighbour's calibration, or measured if the calibration no
    longer applies or the scaled errors exceed the accuracy.

    form: the rod, on any mesh. accuracy: requested relative accuracy. workspace: memory of Newton's matrices.
    """
    if form.rod.material != neighbour.predictor.orbit.form.rod.material:
        raise Unsolvable("the neighbouring rod has another constitutive law or another profile along the rod")
    if form.unknown_velocity_components != neighbour.predictor.orbit.form.unknown_velocity_components:
        raise Unsolvable(
            "the rods have different unknowns: velocities are unknowns only at small axial or rotational drag"
        )
    solved = _cycle_on_next_mesh(neighbour, form, name, accuracy, workspace)
    motion = CycleMotion(solved.orbit)
    relative_parameter_change = relative_parameter_difference(neighbour.predictor.orbit.form, form, name)
    calibration = neighbour.calibration.with_errors_scaled_on_chain(
        solved.orbit, relative_parameter_change, error_indicators(solved, motion)
    )
    if calibration.is_valid:
        cycle = cycle_with_calibrated_errors(calibration, solved, accuracy, motion)
        if cycle.errors.largest_weighted_error <= accuracy:
            return cycle
    return cycle_with_measured_errors(solved, calibration, accuracy, name)


def _cycle_on_next_mesh(
    neighbour: CycleStart, form: StressForm, name: str, accuracy: float, workspace: NewtonWorkspace
) -> ConvergedOrbit:
    """The cycle of the rod in `form` on the neighbour's `next_mesh`, with a matrix for multipliers and for
    the tangent along the parameter `name`; raises Unsolvable. If Newton's method fails from the prediction,
    the branch is first followed in steps on a coarser mesh. accuracy: requested relative accuracy."""
    tolerance = newton_tolerance(accuracy)
    target = neighbour.next_mesh
    try:
        solved = orbit_near_prediction(
            neighbour.predictor.on_mesh(target).predicted_orbit(form, name), tolerance, workspace, name
        )
    except Unsolvable:
        # The steps are made on a coarser mesh; only the last correction is made on `next_mesh`.
        start = orbit_followed_in_parameter_steps(
            neighbour.predictor.on_mesh(target.coarser_mesh), form, name, tolerance, workspace
        )
        solved = solve_by_newton(target.interpolated_orbit(start.orbit), tolerance, workspace, name)
    return newton_step_if_matrix_distant(solved, allowed_distance_from_matrix_orbit(accuracy), name)
