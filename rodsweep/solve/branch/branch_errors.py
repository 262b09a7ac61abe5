"""Error estimates for the cycles of a branch: errors of period, extrema and multiplier at equal parameter,
and the error of the parameter.

The cycle is solved at the same arc length on two finer meshes, the first finer in space, the second finer in
time; this system is regular at a fold. The two cycles on finer meshes are then moved along the branch to the
parameter value of the given cycle. The remaining differences are the errors of period, extrema and multiplier
at equal parameter. The error of the parameter is the parameter difference of the cycles at equal deflection.
This error stays small near a Hopf point and near a fold, where all other quantities vary steeply with the
parameter.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ...arrays import Array
from ...determinant.exponents import EXPONENT_SETTINGS
from ..cycle.accuracy.calibration import ERROR_COUNT, MeshErrorCalibration
from ..cycle.accuracy.cheapest_mesh import cheapest_mesh
from ..cycle.accuracy.cycle_errors import CYCLE_ERROR_SETTINGS, LARGEST_MULTIPLIER_ERROR_INDEX
from ..cycle.accuracy.newton_tolerances import newton_tolerance
from ..cycle.accuracy.settings import MESH_ERROR_CALIBRATION_SETTINGS
from ..orbit.orbit_mesh import OrbitMesh
from ..orbit.tip_path_differences import EXTREMUM_INDEX, PATH_INDEX, PERIOD_INDEX, Y_INDEX
from .bordered.scale import ArcLengthScale
from .multiplier_sensitivity import MultiplierErrorAmplification
from .settings import BRANCH_ERROR_SETTINGS


def branch_newton_tolerance(accuracy: float) -> float:
    """Relative tolerance of Newton's method for a cycle of a branch of a given relative accuracy."""
    tolerance = max(
        BRANCH_ERROR_SETTINGS.newton_tolerance_per_accuracy * accuracy,
        BRANCH_ERROR_SETTINGS.min_newton_tolerance,
    )
    return min(tolerance, newton_tolerance(accuracy))


@dataclass(frozen=True, eq=False)
class BranchDerivatives:
    """Derivatives of a branch with respect to arc length at a cycle, in the units of `scale`."""

    scale: ArcLengthScale
    tangent: Array
    """Tangent of the branch with unit arc length, (N + 1,): derivatives of orbit values and parameter
    coordinate."""
    unit_tangent: Array
    """The tangent in components (deflection, log period, parameter), (3,), a unit vector."""
    parameter_second_derivative: float
    """Second derivative of the scaled parameter coordinate with respect to arc length."""
    multiplier_change_per_arc_length: float
    """Modulus of the derivative of the largest multiplier with respect to arc length."""

    @property
    def parameter_per_arc_length(self) -> float:
        """Derivative of the scaled parameter coordinate with respect to arc length; 0 at a fold."""
        return float(self.unit_tangent[2])

    def arc_length_for_parameter_change(self, change: float) -> float:
        """Signed arc length over which the scaled parameter coordinate changes by `change`, to first order:
        `change` / `parameter_per_arc_length`. Near a fold, where the parameter may never change that much, an
        upper bound of the length, with the same sign: 2 sqrt(|change / `parameter_second_derivative`|)."""
        # Away from a fold the quadratic term changes the linear solution by an eighth at most.
        if self.parameter_per_arc_length**2 >= 4 * abs(self.parameter_second_derivative * change):
            return change / self.parameter_per_arc_length
        direction = np.copysign(1.0, change * self.parameter_per_arc_length)
        # Near a fold: an upper bound of the root s of rate s + curvature s^2/2 = change.
        curvature = max(abs(self.parameter_second_derivative), EXPONENT_SETTINGS.min_divisor)
        return float(direction * 2 * (abs(change) / curvature) ** 0.5)


@dataclass(frozen=True, eq=False)
class BranchErrorCalibration:
    """Measured errors of a mesh at a cycle of a branch. errors_at_equal_parameter: errors at equal parameter.
    parameter_errors_at_equal_deflection: relative errors of the parameter at equal deflection, caused by the
    mesh in space and by the mesh in time, (2,). relative_tip_y_sensitivity, relative_period_sensitivity:
    |(p/y) dy/dp| and |(p/T) dT/dp|, p: parameter, y: largest tip y, T: period. multiplier_sensitivity:
    sensitivity of the largest multiplier at this cycle."""

    errors_at_equal_parameter: MeshErrorCalibration
    parameter_errors_at_equal_deflection: Array
    relative_tip_y_sensitivity: float
    relative_period_sensitivity: float
    multiplier_sensitivity: MultiplierErrorAmplification

    @property
    def mesh(self) -> OrbitMesh:
        return self.errors_at_equal_parameter.mesh

    def period_error(self, accuracy: float) -> float:
        """Estimated relative error of the period at equal parameter, at least a fraction of the relative
        accuracy `accuracy`. Where the largest tip y depends steeply on the parameter and the period does not,
        the error of y due to this slope is left out (`_errors_for_period_estimate`)."""
        return self._errors_for_period_estimate.estimated_cycle_errors(accuracy).period_error

    def parameter_error(self, accuracy: float) -> float:
        """Estimated relative error of the parameter at equal deflection, with a safety factor. The estimate
        is at least a fraction of the relative accuracy `accuracy`, and at least the rounding error."""
        return max(
            MESH_ERROR_CALIBRATION_SETTINGS.error_safety_factor
            * float(self.parameter_errors_at_equal_deflection.sum()),
            CYCLE_ERROR_SETTINGS.min_error_over_accuracy * accuracy,
            CYCLE_ERROR_SETTINGS.relative_rounding_error,
        )

    def largest_weighted_error(self, accuracy: float) -> float:
        """Error of the cycle that is compared with the relative accuracy `accuracy`: the larger of the
        parameter error at equal deflection and of `CycleErrors.largest_weighted_error` at equal parameter,
        the latter divided by `_allowed_errors_per_accuracy`."""
        return self._errors_for_mesh_choice.estimated_cycle_errors(accuracy).largest_weighted_error

    def cheapest_mesh(self, accuracy: float) -> OrbitMesh:
        """The cheapest mesh on which the predicted `largest_weighted_error` does not exceed `accuracy`; the
        next finer mesh if no mesh within the limits of planning suffices."""
        return cheapest_mesh(self._errors_for_mesh_choice, accuracy)

    def cheapest_mesh_at_equal_deflection(self, accuracy: float) -> OrbitMesh:
        """The cheapest mesh on which the predicted relative error of the parameter at equal deflection does
        not exceed `accuracy`; the next finer mesh if no mesh within the limits of planning suffices."""
        return cheapest_mesh(self._calibration_with_parameter_errors, accuracy)

    @property
    def _allowed_errors_per_accuracy(self) -> float:
        """Factor, at least 1, by which errors at equal parameter may exceed the accuracy of the cycle."""
        # Errors at equal p are proportional to the slope dy/dp; a steep slope is not a defect of the mesh.
        return max(1.0, self.relative_tip_y_sensitivity / BRANCH_ERROR_SETTINGS.max_tip_y_sensitivity)

    @cached_property
    def _errors_for_period_estimate(self) -> MeshErrorCalibration:
        """Errors from which the error of the period is estimated: errors at equal parameter, but the errors
        of the largest y and of the tip's path, which set a lower limit to the error of the period, without
        the part that a steep slope dy/dp causes. Near a Hopf point, which a mesh displaces, y at equal p
        changes by a large fraction, but the period does not; at a fold both change."""
        reduction = max(1.0, self._allowed_errors_per_accuracy / max(1.0, self.relative_period_sensitivity))
        errors = self.errors_at_equal_parameter.mesh_errors.copy()
        errors[:, [Y_INDEX, PATH_INDEX]] /= reduction
        return replace(self.errors_at_equal_parameter, mesh_errors=errors)

    @cached_property
    def _errors_for_mesh_choice(self) -> MeshErrorCalibration:
        """Errors from which the mesh is chosen: the errors at equal parameter, divided by
        `_allowed_errors_per_accuracy`; the error of the period is at least the parameter error."""
        errors = self.errors_at_equal_parameter.mesh_errors / self._allowed_errors_per_accuracy
        errors[:, PERIOD_INDEX] = np.maximum(
            errors[:, PERIOD_INDEX], self.parameter_errors_at_equal_deflection
        )
        return replace(self.errors_at_equal_parameter, mesh_errors=errors)

    @cached_property
    def _calibration_with_parameter_errors(self) -> MeshErrorCalibration:
        """Calibration for the choice of a mesh by the parameter alone: the relative errors of period, largest
        y, extrema and path are replaced by the error of the parameter at equal deflection."""
        # A copy, because many cycles share one calibration.
        errors = self.errors_at_equal_parameter.mesh_errors.copy()
        errors[:, [PERIOD_INDEX, Y_INDEX, EXTREMUM_INDEX, PATH_INDEX]] = (
            self.parameter_errors_at_equal_deflection[:, None]
        )
        return replace(self.errors_at_equal_parameter, mesh_errors=errors)

    def with_grown_errors(self, growth: Array) -> "BranchErrorCalibration":
        """The calibration with all errors due to the elements multiplied by `growth[0]`, and all errors due
        to the time intervals by `growth[1]`; growth: (2,)."""
        own = self.errors_at_equal_parameter
        calibration = replace(own, mesh_errors=growth[:, None] * own.mesh_errors)
        return replace(
            self,
            errors_at_equal_parameter=calibration,
            parameter_errors_at_equal_deflection=growth * self.parameter_errors_at_equal_deflection,
        )

    def interpolate(
        self,
        other: "BranchErrorCalibration",
        fraction: float,
        sensitivities: tuple[float, float],
        multiplier_sensitivity: MultiplierErrorAmplification,
    ) -> "BranchErrorCalibration":
        """Errors of a cycle between two measured cycles on one branch and one mesh, interpolated. self,
        other: errors of the first and of the second measured cycle. fraction: arc length from the first
        measured cycle to the interpolated cycle, divided by the arc length between the measured cycles.
        sensitivities: (`relative_tip_y_sensitivity`, `relative_period_sensitivity`) of the interpolated
        cycle. multiplier_sensitivity: of the interpolated cycle, too. Near a fold or a Hopf point errors at
        equal parameter are proportional to the sensitivity, which changes by factors between two cycles;
        therefore error divided by sensitivity is interpolated. The result is at least the smaller of the two
        measured errors.
        """
        first, second = (
            self.errors_at_equal_parameter.mesh_errors,
            other.errors_at_equal_parameter.mesh_errors,
        )
        parameter_errors = _log_interpolated_errors(
            self.parameter_errors_at_equal_deflection, other.parameter_errors_at_equal_deflection, fraction
        )
        quotients = _log_interpolated_errors(
            first / self._error_sensitivity_factors, second / other._error_sensitivity_factors, fraction
        )
        errors = max(sensitivities[0], 1.0) * quotients
        for part in errors:
            part[LARGEST_MULTIPLIER_ERROR_INDEX] = multiplier_sensitivity.error_from_quotient(
                float(part[LARGEST_MULTIPLIER_ERROR_INDEX])
            )
        # The interpolated errors contain their growth since the last measurement.
        calibration = replace(
            self.errors_at_equal_parameter,
            mesh_errors=np.maximum(errors, np.minimum(first, second)),
            error_growth_since_measurement=np.ones(2),
        )
        return BranchErrorCalibration(calibration, parameter_errors, *sensitivities, multiplier_sensitivity)

    @property
    def _error_sensitivity_factors(self) -> Array:
        """Sensitivities, (5,), to which the errors at equal parameter are proportional near a fold or a Hopf
        point: max(1, `relative_tip_y_sensitivity`); for the multiplier, this number times
        `error_growth_factor`."""
        factors = np.full(ERROR_COUNT, max(self.relative_tip_y_sensitivity, 1.0))
        factors[LARGEST_MULTIPLIER_ERROR_INDEX] *= self.multiplier_sensitivity.error_growth_factor
        return factors


def _log_interpolated_errors(first_errors: Array, second_errors: Array, fraction: float) -> Array:
    """Geometric interpolation between the errors `first_errors` and `second_errors`, arrays of equal shape,
    at the fraction `fraction` of the way from the first to the second. The result is multiplied by
    `interpolation_safety_factor`, but is at most the larger of the two errors."""
    larger_errors = np.maximum(first_errors, second_errors)
    smallest = larger_errors / BRANCH_ERROR_SETTINGS.max_error_ratio_for_interpolation
    # Errors of a mesh change by factors along a branch, so geometric means are interpolated.
    first, second = (np.maximum(errors, smallest) for errors in (first_errors, second_errors))
    means = first ** (1 - fraction) * second**fraction
    return np.asarray(np.minimum(BRANCH_ERROR_SETTINGS.interpolation_safety_factor * means, larger_errors))
