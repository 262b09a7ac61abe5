"""Leading modes of one rod, their adjoints, and the transient growth due to non-normality.

Eigenvalues come from `rodsweep.solve.spectrum`, certified and with their own error estimate; modes from
`convergence`; numerical abscissa and transient growth from `transient_growth`. Each module chooses its own
meshes; the reported mesh is the mesh of the modes.

Normalisation: right modes have Y(1) = 1 and left modes Y+(1) = 1. Right and left modes are therefore equal at
F = 0, where the operator L is self-adjoint. With the right mode xi_n and the left mode psi_n, the coefficient
of mode n in a state xi is (psi_n, xi)/(psi_n, xi_n); the denominator is `pairing`. A left mode belongs to the
eigenvalue w* of the adjoint (Appendix B), so that (psi_m, xi_n) = int gamma2 Y+_m* Y_n + gamma3 Theta+_m*
Theta_n = 0 for m != n.
"""

from dataclasses import dataclass, replace
from math import nan

import numpy as np

from ...determinant.arm.determinant import eigenfunction_wave_number
from ...discretization.elements.quadrature import lobatto_points
from ...discretization.elements.resolution import Resolution
from ...discretization.straight.transverse_mesh import mesh_for
from ...model.rod import Rod
from ..point_outcome import outcome_or_failure
from ..spectrum.search import Spectrum, SpectrumRequest, solve_spectrum
from ..spectrum.status import SpectrumStatus
from .convergence import MODE_MESH_SETTINGS, converged_modes
from .inverse_iteration import ModeVectors, nan_mode_vectors
from .transient_growth import TransientGrowth, converged_transient_growth


@dataclass(frozen=True, slots=True, kw_only=True)
class LeadingModeSettings:
    """Settings for the transient growth, and for the test whether a rod is unstable."""

    min_wave_number_for_transient_growth: float = 24.0
    """The mesh for the growth resolves at least this wave number, in 1/L, the wave number of the eighth mode
    without load, because growth at short times needs more modes than are requested."""
    min_growth_rate_over_error: float = 4.0
    """A rod is treated as unstable if a growth rate exceeds this multiple of its error estimate."""


LEADING_MODE_SETTINGS = LeadingModeSettings()


@dataclass(frozen=True, slots=True)
class ModesRequest:
    """Request for the leading modes. mode_count: number of modes. accuracy: relative accuracy of eigenvalues,
    modes, condition numbers and growth. node_count: number of Lobatto nodes at which the modes are stored.
    certify: whether the list of eigenvalues must be proved complete."""

    mode_count: int
    accuracy: float
    node_count: int
    computes_growth: bool
    """Whether to compute the numerical abscissa and the transient growth."""
    certify: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Modes:
    """Result for one rod: leading eigenvalues, modes and transient growth, in the order defined in
    `rodsweep.model`. status: status of the spectrum, unless modes or growth failed or are inaccurate."""

    status: SpectrumStatus
    spectrum: Spectrum
    mode_vectors: ModeVectors
    """Right and left modes with their condition numbers and errors; NaN after a failure."""
    growth: TransientGrowth = TransientGrowth()
    seconds: float = 0.0
    """Wall-clock time of the solve, in s."""
    message: str = ""
    """Cause of a failure or of a missed accuracy; empty otherwise."""


def solve_modes(rod: Rod, request: ModesRequest) -> Modes:
    """The leading `request.mode_count` modes of a rod; a failure is returned as a status, never raised."""
    if rod.is_uniform and not rod.is_uniform_and_linear:
        return _modes_by_equivalent_rod(rod, request)
    spectrum = solve_spectrum(rod, SpectrumRequest(request.mode_count, request.accuracy, request.certify))
    vectors = nan_mode_vectors(
        Resolution(spectrum.elements, spectrum.order), request.mode_count, request.node_count
    )
    outcome = Modes(
        status=spectrum.status,
        spectrum=spectrum,
        mode_vectors=vectors,
        seconds=spectrum.seconds,
        message=spectrum.message,
    )
    # Without all eigenvalues no mode can be refined, and the status of the spectrum says why.
    if not np.isfinite(spectrum.eigenvalues).all():
        return outcome
    modes = outcome_or_failure(
        lambda: _with_modes(rod, request, outcome),
        lambda cause: replace(outcome, status=SpectrumStatus.failed, message=cause),
    )
    return replace(modes, seconds=spectrum.seconds + modes.seconds)


def _modes_by_equivalent_rod(rod: Rod, request: ModesRequest) -> Modes:
    """Modes of a uniform rod of nonlinear material, from the equivalent linear rod; times are rescaled."""
    linear, rate = rod.equivalent_linear_rod_and_rate_factor
    modes_of_linear = solve_modes(linear, request)
    spectrum = modes_of_linear.spectrum
    growth = modes_of_linear.growth
    return replace(
        modes_of_linear,
        spectrum=replace(
            spectrum, eigenvalues=rate * spectrum.eigenvalues, error_estimate=rate * spectrum.error_estimate
        ),
        # The modes themselves are equal, as only the unit of time differs.
        mode_vectors=replace(
            modes_of_linear.mode_vectors,
            eigenvalue_rounding=rate * modes_of_linear.mode_vectors.eigenvalue_rounding,
        ),
        growth=replace(
            growth,
            # Rates are multiplied by `rate`, times are divided.
            transient_time=growth.transient_time / rate,
            numerical_abscissa=rate * growth.numerical_abscissa,
            abscissa_error=rate * growth.abscissa_error,
        ),
    )


def _with_modes(rod: Rod, request: ModesRequest, outcome: Modes) -> Modes:
    """`outcome` with modes and, if requested, transient growth. The status changes if no mesh of an allowed
    size resolves the modes, or if the largest error exceeds the accuracy."""
    spectrum = outcome.spectrum
    # The mesh must resolve the shortest wave of all modes.
    max_q = max(eigenfunction_wave_number(rod, complex(w)) for w in spectrum.eigenvalues)
    points = lobatto_points(request.node_count)
    vectors = converged_modes(rod, spectrum.eigenvalues, points, max_q, request.accuracy)
    if vectors is None:
        return replace(
            outcome,
            status=SpectrumStatus.failed,
            message=f"no mesh of at most {MODE_MESH_SETTINGS.max_unknowns} unknowns resolves the modes; "
            "request fewer modes",
        )
    result = replace(outcome, mode_vectors=vectors)
    errors = vectors.relative_errors_by_name()
    if request.computes_growth:
        abs_w = float(abs(spectrum.eigenvalues[0]))
        settings = LEADING_MODE_SETTINGS
        mesh = mesh_for(rod, max(max_q, settings.min_wave_number_for_transient_growth), request.accuracy)
        min_growth_rates = settings.min_growth_rate_over_error * spectrum.error_estimate
        is_growing = (spectrum.eigenvalues.real > min_growth_rates).any()
        # An eigenvalue on the axis within its error neither decays nor grows for certain.
        is_proved = spectrum.status != SpectrumStatus.undecided
        is_stable = True if is_proved else None
        if is_growing or spectrum.unstable_count > 0:
            is_stable = False
        growth = converged_transient_growth(rod, mesh, request.accuracy, is_stable, abs_w)
        errors |= growth.relative_errors_by_name(abs_w)
        # With the stability undecided, the growth may be infinite, so its error is unknown.
        result = replace(
            result, growth=growth if is_stable is not None else replace(growth, growth_error=nan)
        )
    quantity, error = max(errors.items(), key=lambda item: item[1])
    if error <= request.accuracy:
        return result
    is_known = np.isfinite(error)
    message = (
        f"the error of the {quantity} is {error:.0e}, above the requested {request.accuracy:.0e}"
        if is_known
        else f"no digit of the {quantity} is known"
    )
    return replace(result, status=SpectrumStatus.accuracy_not_reached, message=message)
