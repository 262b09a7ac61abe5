"""Right and left modes of given eigenvalues on one mesh, by inverse iteration on the dense pencil.

The shift is the eigenvalue; the pencil gives the right mode, the transposed pencil the left mode. The
normalisation is defined in `rodsweep.solve.modes.leading_modes`.
"""

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from ...arrays import COMPLEX_NAN, Array, Complex
from ...determinant.exponents import MACHINE_EPSILON
from ...discretization.elements.resolution import Resolution
from ...discretization.straight.dense_eigenproblem import AnyPencil, DenseEigenproblem, dense_eigenproblem
from ...discretization.straight.pencil import factors_to_unit_tip
from ...model.rod import Rod


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeIterationSettings:
    """Settings of the inverse iteration that computes the right and left mode of an eigenvalue."""

    iteration_count: int = 4
    """Number of inverse iterations per eigenvalue; two suffice unless the eigenvalue is nearly double."""
    conjugate_tolerance: float = 1e-12
    """An eigenvalue w is the conjugate v* of its predecessor v if |w - v*|/|w| is at most this."""


MODE_ITERATION_SETTINGS = ModeIterationSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeVectors:
    """Right and left modes computed on the mesh `resolution`, at given points of the rod, with errors. The
    fields of modes are complex, (2, modes, points), NaN if the tip does not move."""

    resolution: Resolution
    right_modes: Complex
    """Right modes (Y, Theta) with Y(1) = 1, in L and rad for a tip deflection L."""
    mode_strains: Complex
    """Shear and curvature (h2, Pi) = (Y' - nu Theta, Theta') of the right modes (Sec. V); h2 is exactly 0 in
    an unshearable rod. At a jump of a stiffness: the value behind the jump."""
    left_modes: Complex
    """Left modes (Y+, Theta+) with Y+(1) = 1, in L and rad for a tip deflection L."""
    pairing: Complex
    """(psi_n, xi_n) in the Gamma inner product, complex, (modes,)."""
    condition: Array
    """Condition number |psi| |xi|/|(psi, xi)| >= 1, (modes,): largest ratio, to first order, of the change of
    an eigenvalue to the Gamma norm of a perturbation of the operator; inf where two eigenvalues merge. For
    gamma3 = 0 the state contains no theta, and the norm is the norm of y."""
    rounding: Array
    """Rounding errors of the eigenvalues w of the mesh, estimated from the rounding of (A - w B) x for the
    right mode x, in 1/tau2, (modes,)."""
    mode_error: Array
    """Largest relative error of Y, Theta, h2, Pi, Y+ and Theta+, (modes,): error divided by the field's
    largest value."""
    condition_error: Array
    """Relative error of `condition`, (modes,); NaN, like `mode_error`, until two meshes are compared."""

    def errors_by_name(self) -> dict[str, float]:
        """Largest relative errors over all modes, by name ("modes", "condition numbers"); inf if unknown."""
        errors = {"modes": self.mode_error.max(), "condition numbers": self.condition_error.max()}
        return {name: inf if np.isnan(error) else float(error) for name, error in errors.items()}


def mode_vectors(rod: Rod, pencil: AnyPencil, eigenvalues: Complex, points: Array) -> ModeVectors:
    """Right and left modes of `eigenvalues` on the mesh of `pencil`, at `points` in [0, 1], (n,)."""
    form = dense_eigenproblem(rod, pencil)
    X, Z, rounding_errors = _eigenvectors(form, eigenvalues)
    evaluation = form.mesh.evaluation_matrix(points)
    B = form.B[:, None]
    pairing = (B * Z * X).sum(axis=0)
    norms = [np.sqrt((B * np.abs(V) ** 2).sum(axis=0)) for V in (X, Z)]
    return replace(
        nan_mode_vectors(Resolution(form.mesh.element_count, form.mesh.order), len(eigenvalues), len(points)),
        right_modes=np.stack([(evaluation @ field).T for field in form.displacements(X)]),
        mode_strains=form.strains(X, points),
        # Z are left vectors for w; the adjoint modes belong to the conjugate of w, hence the conjugates.
        left_modes=np.stack([(evaluation @ field).T for field in form.displacements(Z.conj())]),
        pairing=pairing,
        condition=norms[0] * norms[1] / np.abs(pairing),
        rounding=rounding_errors,
    )


def nan_mode_vectors(resolution: Resolution, mode_count: int, point_count: int) -> ModeVectors:
    """Placeholder for modes that were not computed: all entries NaN. mode_count, point_count: numbers of
    modes and of points."""
    nan_modes = np.full((2, mode_count, point_count), COMPLEX_NAN)
    nan_per_mode = np.full(mode_count, np.nan)
    return ModeVectors(
        resolution=resolution,
        right_modes=nan_modes,
        mode_strains=nan_modes,
        left_modes=nan_modes,
        pairing=np.full(mode_count, COMPLEX_NAN),
        condition=nan_per_mode,
        rounding=nan_per_mode,
        mode_error=nan_per_mode,
        condition_error=nan_per_mode,
    )


def _eigenvectors(form: DenseEigenproblem, eigenvalues: Complex) -> tuple[Complex, Complex, Array]:
    """Returns (right eigenvectors, left eigenvectors, rounding errors of `eigenvalues`), (unknowns, modes),
    (unknowns, modes) and (modes,). The eigenvectors have the tip deflection 1."""
    settings = MODE_ITERATION_SETTINGS
    A = form.A
    B = form.B
    mode_count = len(eigenvalues)
    X = np.empty((len(B), mode_count), complex)
    Z = np.empty((len(B), mode_count), complex)
    for i, w in enumerate(eigenvalues):
        if i and w.imag < 0 and abs(w - eigenvalues[i - 1].conj()) <= settings.conjugate_tolerance * abs(w):
            X[:, i] = X[:, i - 1].conj()
            Z[:, i] = Z[:, i - 1].conj()
        else:
            X[:, i], Z[:, i] = null_vectors(A, B, complex(w))
    # Random rounding errors of the entries of A add up in squares: an rms estimate, not a bound.
    squared_rounding = (np.abs(Z) ** 2 * (np.abs(A) ** 2 @ np.abs(X) ** 2)).sum(axis=0)
    rounding = MACHINE_EPSILON * np.sqrt(squared_rounding) / np.abs((B[:, None] * Z * X).sum(axis=0))
    right_vectors, left_vectors = (V * factors_to_unit_tip(*form.displacements(V)) for V in (X, Z))
    return right_vectors, left_vectors, rounding


def null_vectors(A: NDArray, B: NDArray, w: complex) -> tuple[NDArray, NDArray]:
    """Right and left null vector of A - w diag(B), (unknowns,) each, with largest entry 1; real for real w.
    A: (unknowns, unknowns). B: (unknowns,)."""
    # The matrix is singular to rounding, but the error of the inverse lies along the null vector.
    inverse = np.linalg.inv(A - np.diag((w if w.imag else w.real) * B))
    return _null_vector(inverse, B), _null_vector(inverse.T, B)


def _null_vector(inverse: NDArray, B: NDArray) -> NDArray:
    """Null vector of a nearly singular matrix by inverse iteration, (unknowns,), with largest entry 1.
    inverse: inverse of the matrix, (unknowns, unknowns). B: diagonal matrix of the pencil
    A - w B, (unknowns,).

    A larger growth in an iteration means a smaller residual of the result. At a double eigenvalue the inverse
    almost annihilates its last result, and the next iteration gives rounding errors: of the last two results,
    the result with the larger growth is returned.
    """
    x: NDArray = np.ones(len(B))
    previous_vector = x
    previous_growth = growth = 0.0
    for _ in range(MODE_ITERATION_SETTINGS.iteration_count):
        previous_vector = x
        previous_growth = growth
        x = inverse @ (B * x)
        growth = float(np.abs(x).max())
        x = x / growth
    # The growth falls once rounding errors of the iterate dominate.
    return x if growth >= previous_growth else previous_vector
