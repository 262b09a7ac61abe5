"""Leading eigenvalues of one rod or of several rods: the request and the outcome."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import COMPLEX_NAN, Array, Complex
from ...determinant.exponents import MACHINE_EPSILON
from ...discretization.elements.quadrature import lobatto_points
from ...discretization.straight.pencil import factors_to_unit_tip_displacement
from ...discretization.straight.transverse_mesh import AnyMesh
from ...model.rod import Rod
from ..backend.solver_pools import destroy_pooled_solvers
from ..point_outcome import outcome_or_failure
from .problem import TransverseProblem
from .status import SpectrumStatus


@dataclass(frozen=True, slots=True)
class SpectrumRequest:
    """Request for the leading eigenvalues of every rod of a sweep."""

    mode_count: int
    """Number of leading eigenvalues."""
    accuracy: float
    """Relative accuracy of every eigenvalue, and of every eigenmode if requested."""
    certify: bool
    """Whether it must be proved that no eigenvalue is missing."""
    vector_node_count: int = 0
    """Number of Lobatto nodes at which eigenmodes (Y, Theta) are stored; 0 for no eigenmodes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectrumErrorSettings:
    """Settings for the rounding errors of eigenvalues, which are added to the error from the determinant."""

    rounding_error_in_ulps: float = 6.0
    """Rounding error of an eigenvalue of a uniform rod, divided by the spacing of doubles at |w|: the
    rounding of w itself and of the coefficients of D."""
    rounding_error_of_arms_in_ulps: float = 24.0
    """Like `rounding_error_in_ulps`, for an arm, whose determinant D is computed with propagators. Every
    propagator rounds the coefficients of its element, and D may amplify these errors. Among 3960 eigenvalues
    of random arms, compared with results of 34 digits, the largest error is 1.6 times the stated error."""


SPECTRUM_ERROR_SETTINGS = SpectrumErrorSettings()

NumberPerRod = Any
"""A number of one rod, or an array, (n,), of the numbers of n rods solved together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spectrum:
    """Leading transverse eigenvalues of one rod, or of n rods, with an additional first axis of length n."""

    status: NumberPerRod
    """A `SpectrumStatus`, or an array of n integer values of `SpectrumStatus`, (n,)."""
    eigenvalues: Complex
    """Eigenvalues w, complex, (modes,), in 1/tau2, in the order defined in `rodsweep.model`."""
    error_estimate: Array
    """Absolute error estimates of the eigenvalues, from |D/D'|, D: determinant, (modes,), in 1/tau2. Bounds:
    estimate >= error/10, and estimate <= 10 max(error, effect of rounding of the force or of w)."""
    unstable_count: NumberPerRod = -1
    """Number of eigenvalues with Re w > 0; -1 if unknown. It is proved if a certificate was requested."""
    certified: NumberPerRod = False
    """Whether it is proved that no eigenvalue is missing to the right of the last mode."""
    elements: NumberPerRod = 0
    """Number of elements of the mesh, 0 without a mesh."""
    order: NumberPerRod = 0
    """Order of the elements, 0 without a mesh."""
    seconds: NumberPerRod = 0.0
    """Wall-clock time of the solve in seconds; for several rods, the mean time per rod."""
    vectors: Complex | None = None
    """Eigenmodes (Y, Theta), complex, (2, modes, vector_node_count), with Y(1) = 1; None if not requested."""
    message: NumberPerRod = ""
    """Cause of a failure, or the reason why a proof failed; empty otherwise."""

    @property
    def growth_rate(self) -> Array:
        """Growth rates Re w, (modes,), in 1/tau2."""
        return self.eigenvalues.real

    @property
    def frequency(self) -> Array:
        """Angular frequencies Im w, (modes,), in 1/tau2."""
        return self.eigenvalues.imag


@dataclass(frozen=True, slots=True)
class FollowedPoints:
    """Leading eigenvalues w and their absolute errors, (n, modes), at n successive points of a sweep.
    unstable_count: number of unstable modes, (n,). is_accepted: whether certified and accurate, (n,)."""

    w: Complex
    error: Array
    """Absolute errors of the eigenvalues w, (n, modes), in 1/tau2."""
    unstable_count: NDArray[np.int64]
    is_accepted: NDArray[np.bool_]


def modes_at_lobatto_nodes(
    problem: TransverseProblem, request: SpectrumRequest, mesh: AnyMesh, vectors: Complex | None
) -> Complex | None:
    """Eigenmodes (Y, Theta) on the Lobatto nodes, complex, (2, modes, vector_node_count); None if `vectors`
    is None. vectors: eigenvectors on `mesh`, (unknowns, k). A mode with Y(1) = 0 is NaN."""
    if vectors is None:
        return None
    solver = problem.solver(mesh)
    y, theta = solver.displacements(vectors[:, : request.mode_count], problem.rod)
    # Polynomials of the elements are evaluated exactly; interpolation between nodes would lose digits.
    evaluation_matrix = solver.pencil.evaluation_matrix(lobatto_points(request.vector_node_count))
    tip_factors = factors_to_unit_tip_displacement(y, theta)
    return np.stack([(evaluation_matrix @ y * tip_factors).T, (evaluation_matrix @ theta * tip_factors).T])


def errors_with_rounding(w: Complex, error: Array, rod: Rod) -> Array:
    """Absolute errors of eigenvalues: `error` of the root of D plus the rounding error of w. w, error: arrays
    of equal shape. rod: the rod, or any rod of the path of these eigenvalues."""
    settings = SPECTRUM_ERROR_SETTINGS
    rounding_in_ulps = (
        settings.rounding_error_in_ulps
        if rod.is_uniform_and_linear
        else settings.rounding_error_of_arms_in_ulps
    )
    # An exponentially small eigenvalue may underflow to 0; its error is then the smallest number.
    return np.maximum(error + rounding_in_ulps * MACHINE_EPSILON * np.abs(w), np.nextafter(0.0, 1.0))


def spectrum_or_failure(solve: Callable[[], Spectrum], request: SpectrumRequest) -> Spectrum:
    """The spectrum that `solve` returns; a failure is returned as a status, never raised."""

    def failed(cause: str) -> Spectrum:
        # A solver that failed may be left in a state in which its next solve fails too.
        destroy_pooled_solvers()
        return failed_spectrum(SpectrumStatus.failed, request, cause)

    return outcome_or_failure(solve, failed)


def failed_spectrum(status: SpectrumStatus, request: SpectrumRequest, message: str) -> Spectrum:
    """The outcome of a failed solve: all eigenvalues, errors and eigenmodes are NaN."""
    shape = (2, request.mode_count, request.vector_node_count)
    vectors = np.full(shape, COMPLEX_NAN) if request.vector_node_count else None
    return Spectrum(
        status=status,
        eigenvalues=np.full(request.mode_count, COMPLEX_NAN),
        error_estimate=np.full(request.mode_count, np.nan),
        vectors=vectors,
        message=message,
    )
