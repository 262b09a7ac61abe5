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
from ...discretization.straight.pencil import factors_to_unit_tip_displacement
from ...model.rod import Rod


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeIterationSettings:
    """Settings of the inverse iteration that computes the right and left mode of an eigenvalue."""

    iteration_count: int = 4
    """Number of inverse iterations per eigenvalue; two suffice unless the eigenvalue is nearly double."""
    conjugate_tolerance: float = 1e-12
    """An eigenvalue w is the conjugate v* of its predecessor v if |w - v*|/|w| is at most this."""
    rounding_safety_factor: float = 20.0
    """Rounding error of modes, divided by the effect of one sample of rounding errors; measured: at most
    12."""


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
    eigenvalue_rounding: Array
    """Rounding errors of the eigenvalues w of the mesh, estimated from the rounding of (A - w B) x for the
    right mode x, in 1/tau2, (modes,)."""
    mode_error: Array
    """Largest relative error of Y, Theta, h2, Pi, Y+ and Theta+, (modes,): error divided by the field's
    largest value; on one mesh the rounding error alone."""
    condition_error: Array
    """Relative error of `condition`, (modes,); on one mesh the rounding error alone."""

    def errors_by_name(self) -> dict[str, float]:
        """Largest relative errors over all modes, by name ("modes", "condition numbers"); inf if unknown."""
        errors = {"modes": self.mode_error.max(), "condition numbers": self.condition_error.max()}
        return {name: inf if np.isnan(error) else float(error) for name, error in errors.items()}


def mode_vectors(rod: Rod, pencil: AnyPencil, eigenvalues: Complex, points: Array) -> ModeVectors:
    """Right and left modes of `eigenvalues` on the mesh of `pencil`, at `points` in [0, 1], (n,)."""
    form = dense_eigenproblem(rod, pencil)
    X, Z = _eigenvectors(form, eigenvalues)
    modes = _modes_of_vectors(form, X, Z, points)
    perturbed = _modes_of_vectors(form, *_perturbed_by_rounding(form, eigenvalues, X, Z), points)
    factor = MODE_ITERATION_SETTINGS.rounding_safety_factor
    return replace(
        modes,
        eigenvalue_rounding=eigenvalue_rounding(form.A, form.B, X, Z),
        mode_error=factor * largest_relative_change(perturbed, modes),
        condition_error=factor * (np.abs(perturbed.condition / modes.condition - 1) + MACHINE_EPSILON),
    )


def _modes_of_vectors(form: DenseEigenproblem, X: Complex, Z: Complex, points: Array) -> ModeVectors:
    """Modes of right and left eigenvectors `X` and `Z`, (unknowns, modes) each, at `points`, (n,); all errors
    NaN."""
    X, Z = (V * factors_to_unit_tip_displacement(*form.displacements(V)) for V in (X, Z))
    evaluation = form.mesh.evaluation_matrix(points)
    B = form.B[:, None]
    pairing = (B * Z * X).sum(axis=0)
    norms = [np.sqrt((B * np.abs(V) ** 2).sum(axis=0)) for V in (X, Z)]
    return replace(
        nan_mode_vectors(Resolution(form.mesh.element_count, form.mesh.order), X.shape[1], len(points)),
        right_modes=np.stack([(evaluation @ field).T for field in form.displacements(X)]),
        mode_strains=form.strains(X, points),
        # Z are left vectors for w; the adjoint modes belong to the conjugate of w, hence the conjugates.
        left_modes=np.stack([(evaluation @ field).T for field in form.displacements(Z.conj())]),
        pairing=pairing,
        condition=norms[0] * norms[1] / np.abs(pairing),
    )


def largest_relative_change(modes: ModeVectors, reference: ModeVectors) -> Array:
    """Largest change of a field between two results, divided by the largest value of the field in
    `reference`, (modes,)."""
    largest_change = np.zeros(len(reference.condition))
    pairs = (
        (modes.right_modes, reference.right_modes),
        (modes.mode_strains, reference.mode_strains),
        (modes.left_modes, reference.left_modes),
    )
    for field, reference_field in pairs:
        field_size = np.abs(reference_field).max(axis=2)
        field_change = np.abs(field - reference_field).max(axis=2)
        # The inner where keeps the quotient that is not used from being 0/0.
        relative_change = np.where(
            field_size > 0, field_change / np.where(field_size > 0, field_size, 1.0), field_change
        )
        largest_change = np.maximum(largest_change, relative_change.max(axis=0))
    return largest_change


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
        eigenvalue_rounding=nan_per_mode,
        mode_error=nan_per_mode,
        condition_error=nan_per_mode,
    )


def _eigenvectors(form: DenseEigenproblem, eigenvalues: Complex) -> tuple[Complex, Complex]:
    """Returns (right eigenvectors, left eigenvectors), (unknowns, modes) each."""
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
    return X, Z


def eigenvalue_rounding(A: Array, B: Array, X: Complex, Z: Complex) -> Array:
    """Rounding errors of the eigenvalues of A - w diag(B) with right and left eigenvectors `X` and `Z`,
    (unknowns, modes) each: (modes,). A: (unknowns, unknowns). B: (unknowns,)."""
    # Random rounding errors of the entries of A add up in squares: an rms estimate, not a bound.
    squared_rounding = (np.abs(Z) ** 2 * (np.abs(A) ** 2 @ np.abs(X) ** 2)).sum(axis=0)
    rounding: Array = MACHINE_EPSILON * np.sqrt(squared_rounding) / np.abs((B[:, None] * Z * X).sum(axis=0))
    return rounding


def _perturbed_by_rounding(
    form: DenseEigenproblem, eigenvalues: Complex, X: Complex, Z: Complex
) -> tuple[Complex, Complex]:
    """The right and left eigenvectors `X` and `Z`, (unknowns, modes) each, of a pencil whose entries have
    random relative errors of the size of rounding errors, to first order, in the same random pattern for
    every mesh size."""
    signs = np.random.default_rng(0).choice([-1.0, 1.0], (2, len(form.B)))
    squared_A = np.abs(form.A) ** 2
    perturbed = [X.copy(), Z.copy()]
    for i, w in enumerate(eigenvalues):
        x, z = X[:, i], Z[:, i]
        # The border makes the singular matrix regular and keeps the perturbation orthogonal to the vector.
        bordered = np.block([[form.A - np.diag(w * form.B), (form.B * x)[:, None]], [form.B * z, 0.0]])
        for j, (vector, matrix, squares) in enumerate(
            ((x, bordered, squared_A), (z, bordered.T, squared_A.T))
        ):
            residual = MACHINE_EPSILON * signs[0] * np.sqrt(squares @ np.abs(vector) ** 2)
            perturbed[j][:, i] += (
                np.linalg.solve(matrix, np.append(residual, 0.0))[:-1] + MACHINE_EPSILON * signs[1] * vector
            )
    return perturbed[0], perturbed[1]


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
