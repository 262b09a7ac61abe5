"""The first cycle of a branch, from the normal form of the Hopf point where the branch starts.

The normal form relates the amplitude of a cycle to the distance of the parameter from the Hopf point.
Newton's method starts at the cycle predicted for a small amplitude. The deflection is prescribed and the
parameter is unknown; this system is regular at the Hopf point too.
"""

from dataclasses import dataclass

import numpy as np

from ...determinant.parameter_path import Path
from ...discretization.stress.form import StressForm
from ...model.rod import Rod
from ..changes.arm.path import path_problem
from ..changes.kinds import Threshold
from ..cycle.accuracy.refinement import max_matrix_distance, newton_tolerance
from ..cycle.accuracy.refinement_settings import REFINEMENT_SETTINGS
from ..cycle.hopf_start import HOPF_START_SETTINGS, orbit_of_amplitude
from ..hopf.hopf_coefficients import HopfCoefficients, hopf_coefficients
from ..hopf.normal_form import NormalForm, normal_form_by_mesh_rule
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import cheapest_stage_count, mesh_from_tails
from ..unsolvable import Unsolvable
from .arc_length_step import BranchCycle
from .bordered.condition import BorderCondition
from .bordered.scale import ArcLengthScale, deflection_of
from .mesh_choice import first_measured_cycle
from .special.special_point import SpecialKind, SpecialPoint


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchStartSettings:
    """Settings for the first cycle of a branch near its Hopf point."""

    first_amplitudes: tuple[float, ...] = (0.02, 0.008, 0.003)
    """Amplitudes (largest tip y, in L) of the first cycle, tried in this order."""
    max_amplitude_ratio: float = 0.05
    """Upper limit of the amplitude of the first cycle, divided by
    |`HopfBranchStart.amplitude_coefficient`|. At larger amplitudes the third-order normal form is too
    inaccurate."""
    min_deflection_amplitude: float = 0.1
    """The unit of deflection of an `ArcLengthScale` is at least the deflection that a cycle of this amplitude
    (largest tip y, in L) has by linear theory."""
    allowed_amplitude_ratios: tuple[float, float] = 0.5, 2.0
    """Smallest and largest allowed ratio of the solved amplitude of the first cycle to the amplitude
    predicted by the normal form."""
    frequency_rounding: float = 1e-14
    """Relative rounding error of the frequency at a Hopf point, which is computed as a root of the
    determinant D."""


BRANCH_START_SETTINGS = BranchStartSettings()


ALONG_DEFLECTION = np.array([1.0, 0.0, 0.0])
"""Unit vector along the deflection, (3,), in components (deflection, log period, parameter)."""


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
    growth_slope: complex
    """Derivative dw/d(coordinate) of the critical eigenvalue w at the Hopf point; w in 1/tau2."""
    normal_form: NormalForm
    """Normal form on a mesh that suffices for the prediction of the first cycle."""
    coefficients: HopfCoefficients
    """Coefficients of the normal form with error estimates, from a comparison of meshes."""

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
        turned = -1.0 if Path(self.rod, self.parameter_name).is_compliance_path else 1.0
        # 0 = Re slope dp + Re c a^2, so a^2 = -Re slope p/Re c per relative change of p; a negative value
        # means cycles at smaller p.
        squared = -turned * self.growth_slope.real * self.parameter_coordinate / self.coefficients.landau.real
        return float(np.copysign(abs(squared) ** 0.5, squared))

    @property
    def coefficient_error(self) -> float:
        """Relative error of the amplitude coefficient: half the sum of the relative errors of Re c, of
        Re(slope) and of the parameter at the Hopf point."""
        c = self.coefficients.landau
        slope = self.growth_slope
        landau = self.coefficients.landau_error * abs(c) / abs(c.real)
        slope_error = self.coefficients.growth_slope_error * abs(slope) / abs(slope.real)
        # Half, because a is a square root.
        return (landau + slope_error + self.crossing.error / abs(self.crossing.value)) / 2

    @property
    def period_error(self) -> float:
        """Relative error of `period`: the relative change of the frequency when the parameter changes by its
        error at the Hopf point, plus the rounding error."""
        parameter_error = self.crossing.error / abs(self.crossing.value) * abs(self.parameter_coordinate)
        return (
            abs(self.growth_slope) * parameter_error / self.crossing.frequency
            + BRANCH_START_SETTINGS.frequency_rounding
        )

    def parameter_change_and_frequency(self, amplitude: float) -> tuple[float, float]:
        """(change of the parameter coordinate from the Hopf point, frequency in 1/tau2), by the normal form,
        of the cycle whose largest tip y is `amplitude`, in L."""
        c = self.normal_form.landau
        # The growth rate of the cycle vanishes: Re slope dp + Re c a^2 = 0.
        change = -c.real * amplitude**2 / self.growth_slope.real
        return change, self.crossing.frequency + self.growth_slope.imag * change + c.imag * amplitude**2


def hopf_branch_start(path: Path, crossing: Threshold) -> HopfBranchStart:
    """The Hopf point with its normal form, at a crossing of the imaginary axis along the parameter path
    `path`; raises Unsolvable."""
    w = complex(0.0, crossing.frequency)
    at = path.rod_at(path.coordinate(crossing.value))
    _, slope, _ = path_problem(path).eigenvalue(w, path.coordinate(crossing.value))
    normal = normal_form_by_mesh_rule(at, w, HOPF_START_SETTINGS.normal_form_accuracy)
    return HopfBranchStart(
        crossing=crossing,
        rod=at,
        parameter_name=path.name,
        parameter_coordinate=path.coordinate(crossing.value),
        growth_slope=complex(slope),
        normal_form=normal,
        coefficients=hopf_coefficients(at, crossing, HOPF_START_SETTINGS.normal_form_accuracy),
    )


def hopf_as_special_point(hopf: HopfBranchStart) -> SpecialPoint:
    """The Hopf point as a special point, for the start or the end of a branch."""
    return SpecialPoint(
        kind=SpecialKind.hopf,
        at=hopf.crossing.value,
        period=hopf.period,
        tip_y_max=0.0,
        error=hopf.crossing.error,
        period_error=hopf.period_error,
        size_error=0.0,
        amplitude_coefficient=hopf.amplitude_coefficient,
        coefficient_error=hopf.coefficient_error,
    )


def first_cycle(hopf: HopfBranchStart, accuracy: float, workspace: NewtonWorkspace) -> BranchCycle:
    """The first cycle of the branch from the Hopf point `hopf`, to a relative accuracy; raises Unsolvable.

    workspace: memory of Newton's matrices.
    """
    a = abs(hopf.amplitude_coefficient)
    usual = max(accuracy, REFINEMENT_SETTINGS.min_first_mesh_accuracy)
    # On a coarse mesh the Hopf point is displaced, so that this mesh may have no cycle here.
    for aim, finer in ((usual, False), (REFINEMENT_SETTINGS.min_first_mesh_accuracy, True)):
        for share in BRANCH_START_SETTINGS.first_amplitudes:
            amplitude = min(share, BRANCH_START_SETTINGS.max_amplitude_ratio * a)
            try:
                return _cycle_of_amplitude(hopf, amplitude, aim, finer, accuracy, workspace)
            except Unsolvable as error:
                why = error
    raise Unsolvable(f"no cycle is found near the Hopf point: {why}") from why


def _cycle_of_amplitude(
    hopf: HopfBranchStart,
    amplitude: float,
    mesh_accuracy: float,
    finer: bool,
    accuracy: float,
    workspace: NewtonWorkspace,
) -> BranchCycle:
    """The cycle near the cycle that the normal form of `hopf` predicts for the largest tip y `amplitude`, in
    L, solved to the relative `accuracy`; raises Unsolvable.

    The cycle is solved first on the starting mesh, then on a mesh chosen for the accuracy `mesh_accuracy`.
    finer: whether the starting mesh is chosen for `mesh_accuracy` too; otherwise the starting mesh is the
    coarser mesh of the normal form."""
    start = predicted_cycle(hopf, amplitude)
    if finer:
        start = mesh_from_tails(start, mesh_accuracy, cheapest_stage_count(mesh_accuracy)).interpolated_orbit(
            start
        )
    least = abs(deflection_of(start)) * BRANCH_START_SETTINGS.min_deflection_amplitude / amplitude
    scale = ArcLengthScale.at_orbit(start, hopf.parameter_name, least)
    # With the deflection prescribed, not the parameter, the cycle cannot collapse onto the straight rod.
    border = np.sign(deflection_of(start)) * ALONG_DEFLECTION
    condition = BorderCondition.at_arc_length(scale, border, start)
    rough = condition.solve_cycle(start, REFINEMENT_SETTINGS.nearby_orbit_tolerance, workspace)
    near = rough.orbit
    y = float(near.form.tip_coordinates(near.start_state)[1])
    # A different cycle with the same deflection would have an amplitude far from the normal form's.
    least_ratio, largest_ratio = BRANCH_START_SETTINGS.allowed_amplitude_ratios
    if not least_ratio < y / amplitude < largest_ratio:
        raise Unsolvable("Newton's method converged far from the cycle that the normal form predicts")
    mesh = mesh_from_tails(near, mesh_accuracy, cheapest_stage_count(accuracy))
    first = condition.solve_on_mesh(mesh, rough, newton_tolerance(accuracy), max_matrix_distance(accuracy))
    arc_from_start = abs(deflection_of(first.orbit)) / scale.deflection_unit
    return first_measured_cycle(first, scale, border, arc_from_start, accuracy)


def predicted_cycle(hopf: HopfBranchStart, amplitude: float) -> Orbit:
    """The cycle that the normal form predicts for the largest tip y `amplitude`, in L, on the normal form's
    mesh in space and a coarse mesh in time; raises Unsolvable."""
    change, frequency = hopf.parameter_change_and_frequency(amplitude)
    form = StressForm(hopf.rod, hopf.normal_form.form.mesh)
    try:
        form = form.with_coordinate(hopf.parameter_name, hopf.parameter_coordinate + change)
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the branch leaves the allowed range of the parameters: {error}") from error
    return orbit_of_amplitude(hopf.normal_form, form, amplitude, frequency)
