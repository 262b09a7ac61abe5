"""Arc-length continuation of a branch of cycles: the step from one cycle to the next.

The polynomial through the last three cycles and their tangents predicts the next cycle
(`branch_prediction`). Newton's method corrects the prediction at a prescribed arc length (`bordered`). The
step length is chosen from the prediction error and from the angle between successive tangents. N is the
number of orbit values; a tangent also has the parameter coordinate.
"""

from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from ...arrays import Array, Complex
from ..continuation.curve import StepControl, StepResult, next_solution_and_step_length
from ..cycle.accuracy.newton_tolerances import allowed_distance_from_matrix_orbit
from ..cycle.accuracy.refined_cycle import RefinedCycle
from ..cycle.accuracy.refinement import cycle_with_calibrated_errors
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.newton import ConvergedOrbit, error_of_largest_multiplier, relative_change
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import OrbitMesh
from .bordered.border_condition import BorderCondition, moved_orbit
from .bordered.corrected_linearisation import CorrectedLinearisation, linearisation_of
from .bordered.matrix import BorderedMatrix
from .bordered.scale import ArcLengthScale
from .branch_errors import BranchDerivatives, BranchErrorCalibration, branch_newton_tolerance
from .branch_prediction import HermiteNode, PreviousCycle, hermite_nodes, predicted_change

ARC_STEP_CONTROL = StepControl(
    first_length=0.02,
    max_length=0.25,
    min_length=5e-6,
    target_prediction_error=5e-4,
    max_prediction_error=0.1,
    prediction_order=4,
    max_angle=0.45,
    max_successive_length_ratio=2.0,
)
"""Control of the arc-length steps along a branch. Arc length is dimensionless (`ArcLengthScale`): on a step
of 0.1 the deflection, the period and the parameter each change by at most about a tenth."""


@dataclass(frozen=True, eq=False, kw_only=True)
class BranchCycle:
    """A cycle of a branch, with the derivatives of the branch at this cycle, the error calibration, and the
    length of the next step."""

    cycle: RefinedCycle
    derivatives: BranchDerivatives
    next_step_length: float
    """Arc length of the step to the next cycle."""
    calibration: BranchErrorCalibration
    """Errors of the mesh, from which the errors of this cycle are estimated: measured or interpolated at this
    cycle, or measured at an earlier cycle of the branch."""
    steps_since_error_measurement: int = 0
    """Number of steps since the last cycle with measured errors; 0 if the errors of this cycle are
    measured."""
    arc_length_since_error_measurement: float = 0.0
    """Arc length of the branch since the last cycle with measured errors; 0 if the errors of this cycle are
    measured or interpolated."""
    next_mesh: OrbitMesh | None = None
    """The mesh of the next cycle; None for the mesh of this cycle."""
    previous: PreviousCycle | None = None
    """The previous cycle of the branch, which also holds the cycle before it; None for the first cycle."""
    prediction_error: float = 0.0
    """Relative distance of this cycle from its prediction by the previous cycle; 0 if the meshes of the two
    cycles differ, because the distance would contain the difference between the meshes."""

    @property
    def scale(self) -> ArcLengthScale:
        return self.derivatives.scale

    @property
    def tangent(self) -> Array:
        """Tangent of the branch with unit arc length, (N + 1,): derivatives of the N orbit values, then of
        the parameter coordinate."""
        return self.derivatives.tangent

    @property
    def unit_tangent(self) -> Array:
        """The tangent in components (deflection, log period, parameter), (3,), a unit vector."""
        return self.derivatives.unit_tangent

    @property
    def orbit(self) -> Orbit:
        return self.cycle.orbit

    @property
    def workspace(self) -> NewtonWorkspace:
        """Memory of Newton's matrices, in which the matrix of this cycle was assembled."""
        return self.cycle.converged_orbit.workspace

    @property
    def parameter_coordinate(self) -> float:
        """Coordinate of the continuation parameter: 1/k for a stiffness k, otherwise the value itself."""
        return self.orbit.form.rod.coordinate(self.scale.parameter_name)

    @property
    def parameter_per_arc_length(self) -> float:
        """Derivative of the parameter coordinate (1/k for a stiffness k), in units of `scale`, with respect
        to arc length; changes sign at a fold."""
        return self.derivatives.parameter_per_arc_length

    @cached_property
    def multipliers_over_solved_time_interval(self) -> Complex:
        """Nontrivial multipliers over the solved part of the period, (m,). Asymmetric cycle: eigenvalues of
        the map over the period. Symmetric cycle: eigenvalues of the map over half a period, composed with the
        reflection."""
        values = self.cycle.converged_orbit.matrix.multipliers_over_solved_time_interval
        # The multiplier nearest to 1 belongs to the motion along the orbit itself.
        return np.delete(values, int(np.argmin(np.abs(values - 1))))

    def arc_length_condition(self, length: float) -> BorderCondition:
        """The condition that the next cycle has the arc length `length` from this cycle."""
        return BorderCondition.at_arc_length(self.scale, self.unit_tangent, self.orbit, length)

    @cached_property
    def earlier_cycles(self) -> list[HermiteNode]:
        """The last one or two cycles before this cycle, the nearest first, for predictions."""
        return hermite_nodes(self.orbit, self.scale, self.unit_tangent, self.previous)

    def predicted_orbit(self, length: float, max_earlier_cycles: int = 2) -> Orbit:
        """Predicted orbit at the arc length `length` ahead, by the polynomial through this cycle and at most
        `max_earlier_cycles` earlier cycles; raises Unsolvable."""
        change = predicted_change(self.tangent, self.earlier_cycles[:max_earlier_cycles], length)
        return moved_orbit(self.orbit, self.scale.parameter_name, change)

    def predicted_on_next_mesh(self, length: float, max_earlier_cycles: int = 2) -> Orbit:
        """The prediction of `predicted_orbit` for the same arguments, on the mesh of the next cycle; raises
        Unsolvable."""
        predicted = self.predicted_orbit(length, max_earlier_cycles)
        return self.next_mesh.interpolated_orbit(predicted) if self.next_mesh else predicted


def next_cycle(start: BranchCycle, accuracy: float) -> BranchCycle:
    """The next cycle of a branch after `start`, to a relative accuracy; raises Unsolvable if the shortest
    step fails."""
    end, length = next_solution_and_step_length(
        partial(_step_of_length, start, accuracy), start.next_step_length, ARC_STEP_CONTROL
    )
    # The cubic through two cycles with tangents errs in the fourth power of the step, hence the order.
    return replace(
        end.solution,
        next_step_length=ARC_STEP_CONTROL.next_length(length, end, ARC_STEP_CONTROL.prediction_order),
    )


def cycle_at_length(start: BranchCycle, length: float, accuracy: float) -> BranchCycle:
    """The cycle at the arc length `length` from `start`, to a relative accuracy; raises Unsolvable if no
    cycle is found, or if the prediction error or the angle between the tangents is so large that the cycle
    may lie on another branch."""
    return ARC_STEP_CONTROL.require_same_curve(_step_of_length(start, accuracy, length)).solution


def _step_of_length(start: BranchCycle, accuracy: float, length: float) -> StepResult[BranchCycle]:
    """The cycle at the arc length `length` from `start`, to a relative accuracy, with the prediction error
    and the cosine of the angle between the tangents; raises Unsolvable. On the first step of a branch, and on
    the first step on another mesh, the prediction error says nothing about the next step: if allowed, it is
    returned as `target_prediction_error`, so that the step length stays."""
    condition = start.arc_length_condition(length)
    predicted = start.predicted_on_next_mesh(length)
    # Steps are chosen by the error of the cubic, which is larger and varies less than that of the quintic.
    cubic = start.predicted_on_next_mesh(length, max_earlier_cycles=1)
    tolerance = branch_newton_tolerance(accuracy)
    solved = condition.solve_cycle(
        predicted, tolerance, start.workspace, allowed_distance_from_matrix_orbit(accuracy)
    )
    prediction_error = relative_change(cubic, solved.orbit.values - cubic.values)
    is_unknown = start.previous is None or start.next_mesh is not None
    control_error = prediction_error
    if is_unknown and prediction_error <= ARC_STEP_CONTROL.max_prediction_error:
        # The error of the tangent predictor does not predict the error of the cubic, and the error on another
        # mesh contains the difference between the meshes.
        control_error = ARC_STEP_CONTROL.target_prediction_error
    tangent = tangent_at(solved.orbit, start.scale, start.unit_tangent, linearisation_of(solved))
    cosine = float(
        start.scale.directional_derivative(solved.orbit, tangent) @ start.unit_tangent
    )  # both have unit length
    cycle = branch_cycle_with_calibrated_errors(start, solved, tangent, length, length, accuracy)
    # On another mesh the error contains the difference of the meshes and says little about the predictor.
    if start.next_mesh is None:
        cycle = replace(cycle, prediction_error=prediction_error)
    return StepResult(cycle, control_error, cosine)


def arc_length_between(start: BranchCycle, end: BranchCycle) -> float:
    """Arc length from the cycle `start` to the cycle `end`, measured along the tangent at `start`."""
    return float(
        start.unit_tangent @ (start.scale.components(end.orbit) - start.scale.components(start.orbit))
    )


def branch_cycle_with_calibrated_errors(
    start: BranchCycle,
    solved: ConvergedOrbit,
    tangent: Array,
    length: float,
    next_step_length: float,
    accuracy: float,
) -> BranchCycle:
    """The solved orbit `solved` as the cycle of the branch at the arc length `length` from `start`, with
    errors estimated from the calibration of `start`.

    tangent: tangent of the branch at the new cycle, (N + 1,). next_step_length: arc length of the step to the
    next cycle. accuracy: relative accuracy of `solved`.
    """
    cycle = cycle_with_calibrated_errors(start.calibration.errors_at_equal_parameter, solved, accuracy)
    derivatives = branch_derivatives(solved, start.scale, tangent)
    curvature = (derivatives.parameter_per_arc_length - start.parameter_per_arc_length) / length
    rate = error_of_largest_multiplier(cycle.multipliers, start.cycle.multipliers) / length
    return BranchCycle(
        cycle=cycle,
        derivatives=replace(
            derivatives, parameter_second_derivative=curvature, multiplier_change_per_arc_length=rate
        ),
        next_step_length=next_step_length,
        calibration=start.calibration,
        steps_since_error_measurement=start.steps_since_error_measurement + 1,
        arc_length_since_error_measurement=start.arc_length_since_error_measurement + length,
        previous=PreviousCycle(start.orbit, start.tangent, start.cycle.errors, start.previous),
    )


def branch_derivatives(solved: ConvergedOrbit, scale: ArcLengthScale, tangent: Array) -> BranchDerivatives:
    """Scale and unit tangent of a branch at the cycle `solved`. scale: scale at another cycle of the branch.
    tangent: tangent of any length, (N + 1,). In the result `parameter_second_derivative` and
    `multiplier_change_per_arc_length` are 0, to be set by the caller."""
    own_scale = ArcLengthScale.at_orbit(
        solved.orbit, scale.parameter_name, scale.min_deflection_unit, scale.min_coordinate_unit
    )
    derivative = own_scale.directional_derivative(solved.orbit, tangent)
    unit = float(np.linalg.norm(derivative))
    return BranchDerivatives(own_scale, tangent / unit, derivative / unit, 0.0, 0.0)


def tangent_at(
    orbit: Orbit, scale: ArcLengthScale, side: Array, matrix: BorderedMatrix | CorrectedLinearisation
) -> Array:
    """Tangent of the branch at an orbit, (N + 1,), from the orbit's bordered matrix. scale: units of the
    components. side: direction in components (deflection, log period, parameter), (3,); the tangent makes an
    acute angle with `side`."""
    tangent = matrix.branch_tangent(side)
    # A null vector has no sign; the branch must not turn back.
    return tangent if scale.directional_derivative(orbit, tangent) @ side > 0 else -tangent
