"""The leading modes of one rod, their adjoints, and what non-normality makes of them.

Eigenvalues come from `rodsweep.solve.spectrum`, certified and with their own error estimate; vectors from
`convergence`, abscissa and growth from `transient_growth`, each on meshes of their own. The mesh that is
reported is that of the vectors.

Normalisation, stated once: right modes have Y(1) = 1, and so do left modes, Y+(1) = 1, which makes both
equal at F = 0, where L is self-adjoint. `pairing` has the product (psi_n, xi_n) that this leaves: the share
of mode n in a state xi is (psi_n, xi)/(psi_n, xi_n). A left mode belongs to the eigenvalue w* of the
adjoint (Appendix B), so that (psi_m, xi_n) = int Y+_m* Y_n + gamma3 Theta+_m* Theta_n = 0 for m != n.
"""

import time
from dataclasses import dataclass, replace
from math import nan

import numpy as np
from numpy.typing import NDArray

from ...determinant.value import newton_correction
from ...discretization.quadrature import lobatto_points
from ...discretization.resolution import resolution_for
from ...model.rod import Rod
from ..spectrum.search import Spectrum, SpectrumRequest, solve_spectrum
from ..spectrum.status import Status
from .convergence import Vectors, resolved_vectors
from .transient_growth import growth_of

Complex = NDArray[np.complex128]

GROWTH_WAVE_NUMBER = 24.0
"""Wave number of the eighth mode at rest: the growth at short times needs more than the wanted modes."""
SURELY = 4.0
"""Error estimates that a growth rate must be from 0 to be called positive."""


@dataclass(frozen=True, slots=True)
class ModesRequest:
    """What is asked: the number of modes, a relative accuracy, Lobatto nodes, and the extras."""

    modes: int
    accuracy: float
    nodes: int
    growth: bool
    """Whether the numerical abscissa and the transient growth are wanted."""
    certify: bool = True


@dataclass(frozen=True, slots=True)
class Modes:
    """The leading modes of one rod, in the order that `rodsweep.model` states.

    eigenvalues, error_estimate: complex and real, shape (modes,), in 1/tau2; unstable_count, certified:
    as in `rodsweep.solve.spectrum.search.Spectrum`; elements, order: of the mesh of the vectors.
    right: (Y, Theta) with Y(1) = 1, left: (Y+, Theta+) with Y+(1) = 1, in L and 1 for a tip deflection of L;
    deformation: (h2, Pi) = (Y' - nu Theta, Theta') of the right modes (Sec. V), h2 = c2 s being exactly
    0 in an unshearable rod; complex, shape (2, modes, nodes), NaN where a tip does not move.
    mode_error: largest error of Y, Theta, h2, Pi, Y+ and Theta+, each in units of its largest value.
    pairing: (psi_n, xi_n) in the Gamma inner product, complex, shape (modes,).
    condition: |psi| |xi|/|(psi, xi)| >= 1, shape (modes,): how much farther than its size a perturbation of
    L, in the Gamma norm, moves the eigenvalue; inf at the onset F*. With gamma3 = 0 theta follows
    y at once, is no part of the state, and the norm is that of y. condition_error: relative.
    numerical_abscissa: sup Re (xi, L xi)/(xi, xi), the growth rate at t = 0+, in 1/tau2; abscissa_error.
    transient_growth: sup_t |exp(L t)| in the Gamma norm, transient_time: when, in tau2: 1 at 0 where it
    exceeds 1 by no more than growth_error, inf at inf for an unstable rod, NaN where stability is undecided
    or growth was not asked for; growth_error: relative. The time is as accurate as a flat maximum allows.
    """

    status: Status
    eigenvalues: Complex
    error_estimate: NDArray[np.float64]
    unstable_count: int
    certified: bool
    elements: int
    order: int
    seconds: float
    right: Complex
    deformation: Complex
    left: Complex
    mode_error: NDArray[np.float64]
    pairing: Complex
    condition: NDArray[np.float64]
    condition_error: NDArray[np.float64]
    numerical_abscissa: float = nan
    abscissa_error: float = nan
    transient_growth: float = nan
    transient_time: float = nan
    growth_error: float = nan
    message: str = ""


def solve_modes(rod: Rod, request: ModesRequest) -> Modes:
    """The leading `request.modes` modes of `rod`; failures are a status, never an exception."""
    started = time.perf_counter()
    spectrum = solve_spectrum(rod, SpectrumRequest(request.modes, request.accuracy, request.certify))
    outcome = _without_vectors(spectrum, request)
    if np.isfinite(spectrum.eigenvalues).all():
        try:
            with np.errstate(all="ignore"):
                outcome = _solve(rod, request, outcome)
        except (np.linalg.LinAlgError, ArithmeticError, MemoryError) as error:
            outcome = replace(outcome, status=Status.failed, message=str(error) or type(error).__name__)
    return replace(outcome, seconds=time.perf_counter() - started)


def _without_vectors(spectrum: Spectrum, request: ModesRequest) -> Modes:
    """The outcome as far as the spectrum goes."""
    shapes = np.full((2, request.modes, request.nodes), np.nan + 0j)
    numbers = np.full(request.modes, np.nan)
    return Modes(
        status=spectrum.status,
        eigenvalues=spectrum.eigenvalues,
        error_estimate=spectrum.error_estimate,
        unstable_count=spectrum.unstable_count,
        certified=spectrum.certified,
        elements=spectrum.elements,
        order=spectrum.order,
        seconds=0.0,
        right=shapes,
        deformation=shapes,
        left=shapes,
        mode_error=numbers,
        pairing=numbers + 0j,
        condition=numbers,
        condition_error=numbers,
        message=spectrum.message,
    )


def _solve(rod: Rod, request: ModesRequest, outcome: Modes) -> Modes:
    """The outcome with its vectors and, where wanted, its growth; the largest error decides on the status."""
    wave = max(newton_correction(complex(w), rod.coefficients)[2] for w in outcome.eigenvalues)
    points = lobatto_points(request.nodes)
    vectors = resolved_vectors(rod, outcome.eigenvalues, points, wave, request.accuracy)
    if vectors is None:
        return replace(outcome, status=Status.failed, message="no dense mesh resolves the modes")
    result, errors = _with_vectors(outcome, vectors), vectors.errors()
    if request.growth:
        result, more = _with_growth(rod, request, result, wave)
        errors |= more
    culprit, error = max(errors.items(), key=lambda item: item[1])
    if error <= request.accuracy:
        return result
    message = f"the error of the {culprit} is {error:.0e}"
    return replace(result, status=Status.accuracy_not_reached, message=message)


def _with_vectors(outcome: Modes, vectors: Vectors) -> Modes:
    """The outcome with its modes."""
    shapes = vectors.shapes
    return replace(
        outcome,
        elements=shapes.pencil.elements,
        order=shapes.pencil.order,
        right=shapes.right,
        deformation=shapes.deformation,
        left=shapes.left,
        mode_error=vectors.mode_error,
        pairing=shapes.pairing,
        condition=shapes.condition,
        condition_error=vectors.condition_error,
    )


def _with_growth(
    rod: Rod, request: ModesRequest, result: Modes, wave: float
) -> tuple[Modes, dict[str, float]]:
    """The outcome with its numerical abscissa and its transient growth, and their relative errors."""
    stable: bool | None = result.status != Status.undecided or None
    if (result.eigenvalues.real > SURELY * result.error_estimate).any() or result.unstable_count > 0:
        stable = False
    mesh = resolution_for(max(wave, GROWTH_WAVE_NUMBER), request.accuracy)
    growth = growth_of(rod, mesh, request.accuracy, stable, float(abs(result.eigenvalues[0])))
    result = replace(
        result,
        numerical_abscissa=growth.abscissa,
        abscissa_error=growth.abscissa_error,
        transient_growth=growth.largest,
        transient_time=growth.time,
        growth_error=nan if stable is None else growth.error,
    )
    return result, growth.errors(float(abs(result.eigenvalues[0])))
