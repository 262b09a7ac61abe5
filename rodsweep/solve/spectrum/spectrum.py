"""Leading eigenvalues of one rod or of several: the request and the outcome."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Complex
from ...determinant.exponents import ROUND_OFF
from ...discretization.elements.quadrature import lobatto_points
from ...discretization.straight.pencil import tip_scale
from ...discretization.straight.transverse_mesh import AnyMesh
from ...model.rod import Rod
from .problem import TransverseProblem
from .status import SpectrumStatus


@dataclass(frozen=True, slots=True)
class SpectrumRequest:
    """Request for every point: number of modes, relative accuracy, certification, vectors."""

    modes: int
    accuracy: float
    certify: bool
    vector_nodes: int = 0
    """Number of Lobatto nodes for (Y, Theta); 0 for no vectors."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpectrumErrorSettings:
    """Settings for rounding errors of eigenvalues, which are added to that of D."""

    rounding: float = 6.0
    """Rounding error of an eigenvalue, in units of the spacing of doubles at its modulus, from rounding of
    the number itself and of the coefficients of D."""
    rounding_of_arms: float = 24.0
    """The same for an arm with propagators: each rounds the coefficients of its element, and D may magnify
    this error. Of 3960 eigenvalues of random arms, compared with 34 digits, one is off by 1.6 times its
    stated error."""


SPECTRUM_ERRORS = SpectrumErrorSettings()

EachRod = Any
"""A number of a rod, or the numbers of n rods solved together, (n,)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spectrum:
    """Leading transverse eigenvalues of one rod, or of n rods: then every array has a leading axis (n,)."""

    status: EachRod
    """A `SpectrumStatus`."""
    eigenvalues: Complex
    """Eigenvalues w, complex, (modes,), in 1/tau2, in the order defined in `rodsweep.model`."""
    error_estimate: Array
    """Error estimates |D/D'|, (modes,): at least a tenth of the error, and at most ten times the error or the
    effect of rounding of the force or of w."""
    unstable_count: EachRod = -1
    """Number of eigenvalues with Re w > 0, -1 if unknown; proved if requested."""
    certified: EachRod = False
    """Whether the winding number proves that no eigenvalue right of the last mode is missing."""
    elements: EachRod = 0
    """Number of elements of the mesh, 0 without a mesh."""
    order: EachRod = 0
    """Order of the elements, 0 without a mesh."""
    seconds: EachRod = 0.0
    """Time of the solve, for several rods the mean."""
    vectors: Complex | None = None
    """Eigenmodes (Y, Theta), complex, (2, modes, vector_nodes), scaled to Y(1) = 1; None if not requested."""
    message: EachRod = ""

    @property
    def growth_rate(self) -> Array:
        """Re w, (modes,)."""
        return self.eigenvalues.real

    @property
    def frequency(self) -> Array:
        """Im w, (modes,)."""
        return self.eigenvalues.imag


@dataclass(frozen=True, slots=True)
class FollowedPoints:
    """Eigenvalues and errors, shape (n, modes), at the next n points of a stretch. unstable: number of
    unstable modes, (n,). good: whether a point is certified and accurate, (n,).
    """

    w: Complex
    error: Array
    unstable: NDArray[np.int64]
    good: NDArray[np.bool_]


def vectors_on_nodes(
    problem: TransverseProblem, request: SpectrumRequest, mesh: AnyMesh, found: Complex | None
) -> Complex | None:
    """(Y, Theta) on the Lobatto nodes, complex, (2, modes, nodes), from vectors of a mesh, (unknowns, k).

    NaN if Y(1) vanishes and cannot be scaled to 1.
    """
    if found is None:
        return None
    solver = problem.solver(mesh)
    y, theta = solver.fields(found[:, : request.modes], problem.rod)
    matrix = solver.pencil.evaluation(lobatto_points(request.vector_nodes))
    scale = tip_scale(y, theta)
    return np.stack([(matrix @ y * scale).T, (matrix @ theta * scale).T])


def stated_errors(w: Complex, error: Array, rod: Rod) -> Array:
    """Errors of eigenvalues w with the rounding of w itself; w and errors of roots of D: any equal shape.

    rod: the rod, or one of its path.
    """
    rounding = SPECTRUM_ERRORS.rounding if rod.standard else SPECTRUM_ERRORS.rounding_of_arms
    return error + rounding * ROUND_OFF * np.abs(w)


def no_spectrum(status: SpectrumStatus, request: SpectrumRequest, message: str) -> Spectrum:
    """The outcome of a failure: all numbers are NaN."""
    empty = np.full(request.modes, np.nan)
    shape = (2, request.modes, request.vector_nodes)
    vectors = np.full(shape, np.nan + 0j) if request.vector_nodes else None
    return Spectrum(
        status=status, eigenvalues=empty + 0j, error_estimate=empty, vectors=vectors, message=message
    )
