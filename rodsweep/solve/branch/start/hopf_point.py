"""A Hopf point with its normal form, as the start of a branch of cycles."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....determinant.parameter_path import ParameterPath
from ....model.rod import Rod
from ...changes.arm.path import path_problem
from ...changes.threshold_kinds import Threshold
from ...cycle.hopf_start_settings import normal_form_accuracy
from ...hopf.hopf_coefficients import HopfCoefficients, hopf_coefficients
from ...hopf.normal_form import NormalForm, normal_form_by_mesh_rule
from ...unsolvable import Unsolvable
from ..settings import BRANCH_START_SETTINGS
from ..special.special_point import SpecialPoint, SpecialPointKind


@dataclass(frozen=True, eq=False, kw_only=True)
class HopfBranchStart:
    """A Hopf point along the continuation parameter `parameter_name`, with the normal form of the cycles that
    branch off. crossing: parameter value, frequency and errors of the Hopf point. rod: the rod at the Hopf
    point."""

    crossing: Threshold
    rod: Rod
    parameter_name: str
    parameter_coordinate: float
    """Coordinate of the parameter at the Hopf point: 1/k for a stiffness k, otherwise the value itself."""
    eigenvalue_slope_by_coordinate: complex
    """Derivative dw/d(coordinate) of the critical eigenvalue w at the Hopf point; w in 1/tau2."""
    normal_form: NormalForm
    """Normal form on a mesh that suffices for the prediction of the first cycle."""
    normal_form_coefficients: HopfCoefficients
    """Coefficients of the normal form with error estimates, from a comparison of meshes."""
    is_omega_always_unknown: bool = False
    """Whether the angular velocity Omega is an unknown for all cycles of the branch, see `StressForm`."""
    min_coordinate_unit: float = 0.0
    """Smallest unit of the parameter coordinate in arc lengths on the branch, see `ArcLengthScale`."""

    @property
    def period(self) -> float:
        """Period of the cycles in the limit of zero amplitude, in tau2."""
        return 2 * np.pi / self.crossing.frequency

    @property
    def amplitude_coefficient(self) -> float:
        """Amplitude coefficient a, in L, of the branch that starts at the Hopf point with the parameter value
        p.

        The cycle at a nearby parameter value p' has a largest tip y of |a| sqrt(|p' - p|/p). a < 0 if the
        cycles exist at p' < p, otherwise a > 0.
        """
        # Along a stiffness the coordinate is 1/k, which falls as the parameter rises.
        sign = -1.0 if ParameterPath(self.rod, self.parameter_name).is_compliance_path else 1.0
        # 0 = Re slope dp + Re c a^2, so a^2 = -Re slope p/Re c per relative change of p; a negative value
        # means cycles at smaller p.
        squared_amplitude = (
            -sign
            * self.eigenvalue_slope_by_coordinate.real
            * self.parameter_coordinate
            / self.normal_form_coefficients.landau.real
        )
        return float(np.copysign(abs(squared_amplitude) ** 0.5, squared_amplitude))

    @property
    def relative_amplitude_coefficient_error(self) -> float:
        """Relative error of the amplitude coefficient: half the sum of three relative errors, of Re c (c:
        Landau coefficient), of Re `eigenvalue_slope_by_coordinate`, and of the parameter at the Hopf
        point."""
        c = self.normal_form_coefficients.landau
        slope = self.eigenvalue_slope_by_coordinate
        landau_error = self.normal_form_coefficients.landau_error * abs(c) / abs(c.real)
        slope_error = self.normal_form_coefficients.growth_slope_error * abs(slope) / abs(slope.real)
        # Half, because a is a square root.
        return (landau_error + slope_error + self.crossing.error / abs(self.crossing.value)) / 2

    @property
    def period_error(self) -> float:
        """Relative error of `period`: the relative change of the frequency when the parameter changes by its
        error at the Hopf point, plus the rounding error."""
        parameter_error = self.crossing.error / abs(self.crossing.value) * abs(self.parameter_coordinate)
        return (
            abs(self.eigenvalue_slope_by_coordinate) * parameter_error / self.crossing.frequency
            + BRANCH_START_SETTINGS.relative_frequency_rounding_error
        )

    @property
    def parameter_direction(self) -> int:
        """Sign of the change of the parameter coordinate along the branch at the Hopf point; 0 if the error
        of Re c exceeds |Re c| (c: Landau coefficient)."""
        c = self.normal_form_coefficients.landau
        # Negated, so that a nan coefficient gives no direction.
        if not abs(c.real) > self.normal_form_coefficients.landau_error * abs(c):
            return 0
        return int(np.sign(-c.real / self.eigenvalue_slope_by_coordinate.real))

    def parameter_change_and_frequency(self, amplitude: float) -> tuple[float, float]:
        """Returns (change of the parameter coordinate from the Hopf point, frequency in 1/tau2), by the
        normal form, of the cycle whose largest tip y is `amplitude`, in L."""
        c = self.normal_form.landau
        # The growth rate of the cycle vanishes: Re slope dp + Re c a^2 = 0.
        change = -c.real * amplitude**2 / self.eigenvalue_slope_by_coordinate.real
        return (
            change,
            self.crossing.frequency
            + self.eigenvalue_slope_by_coordinate.imag * change
            + c.imag * amplitude**2,
        )

    def period_and_amplitude_at(self, coordinate: float) -> tuple[float, float]:
        """(period in tau2, largest tip y in L), by the normal form, of the cycle at the parameter coordinate
        `coordinate` on the side of the Hopf point where the cycles exist; amplitude 0 on the other side."""
        c = self.normal_form_coefficients.landau
        change = coordinate - self.parameter_coordinate
        # A negative square means that no cycle exists on this side.
        squared = max(-self.eigenvalue_slope_by_coordinate.real * change / c.real, 0.0)
        frequency = (
            self.crossing.frequency + self.eigenvalue_slope_by_coordinate.imag * change + c.imag * squared
        )
        return 2 * np.pi / frequency, squared**0.5


def hopf_branch_start(
    path: ParameterPath,
    crossing: Threshold,
    is_omega_always_unknown: bool = False,
    min_coordinate_unit: float = 0.0,
) -> HopfBranchStart:
    """The start of a branch at a Hopf point, with its normal form; raises Unsolvable. path: rods along the
    continuation parameter. crossing: the Hopf point on this path. is_omega_always_unknown,
    min_coordinate_unit: fields of the result, see `HopfBranchStart`."""
    w = complex(0.0, crossing.frequency)
    rod = path.rod_at(path.coordinate(crossing.value))
    # Started at the located frequency, so the same eigenvalue is found again, now with its slope.
    _, slope, _ = path_problem(path).eigenvalue_with_slope_and_error(w, path.coordinate(crossing.value))
    normal = normal_form_by_mesh_rule(rod, w, normal_form_accuracy(rod))
    return HopfBranchStart(
        crossing=crossing,
        rod=rod,
        parameter_name=path.parameter_name,
        parameter_coordinate=path.coordinate(crossing.value),
        eigenvalue_slope_by_coordinate=complex(slope),
        normal_form=normal,
        # Two meshes give these coefficients with their errors; one mesh suffices for the start of the branch.
        normal_form_coefficients=_accurate_coefficients(rod, crossing),
        is_omega_always_unknown=is_omega_always_unknown,
        min_coordinate_unit=min_coordinate_unit,
    )


def _accurate_coefficients(rod: Rod, crossing: Threshold) -> HopfCoefficients:
    """The coefficients of the normal form at the Hopf point `crossing`, to the first of the relative
    accuracies `landau_coefficient_accuracies` that can be reached; raises Unsolvable if none can. rod: the
    rod there."""
    reason = Unsolvable()
    for accuracy in BRANCH_START_SETTINGS.landau_coefficient_accuracies:
        try:
            return hopf_coefficients(rod, crossing, accuracy)
        except Unsolvable as error:
            reason = error
    raise reason


def accuracy_near_hopf_points(hopfs: Sequence[HopfBranchStart], accuracy: float) -> float:
    """Relative accuracy to which the cycles of a rod with the given Hopf points are solved: the requested
    `accuracy`, or a smaller number if a Hopf point is close to a generalised Hopf point, where the amplitude
    is sensitive."""
    max_coefficient = max((abs(hopf.amplitude_coefficient) for hopf in hopfs), default=0.0)
    # Negated, so that a nan coefficient does not set the accuracy.
    if not max_coefficient > BRANCH_START_SETTINGS.max_nondegenerate_amplitude_coefficient:
        return accuracy
    ratio = (BRANCH_START_SETTINGS.max_nondegenerate_amplitude_coefficient / max_coefficient) ** 2
    required_accuracy = BRANCH_START_SETTINGS.max_accuracy_if_degenerate * ratio
    return min(accuracy, max(required_accuracy, BRANCH_START_SETTINGS.finest_accuracy_if_degenerate))


def hopf_as_special_point(hopf: HopfBranchStart) -> SpecialPoint:
    """The Hopf point as a special point, for the start or the end of a branch."""
    return SpecialPoint(
        kind=SpecialPointKind.hopf,
        parameter_value=hopf.crossing.value,
        period=hopf.period,
        tip_y_max=0.0,
        error=hopf.crossing.error,
        period_error=hopf.period_error,
        tip_y_max_error=0.0,
        amplitude_coefficient=hopf.amplitude_coefficient,
        relative_amplitude_coefficient_error=hopf.relative_amplitude_coefficient_error,
    )
