"""Right and left modes of given eigenvalues on one mesh, by inverse iteration on the dense pencil.

The shift is the eigenvalue; the pencil gives the right mode, the transposed pencil the left mode. The
normalisation is defined in `rodsweep.solve.modes.leading_modes`.
"""

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from ...arrays import COMPLEX_NAN, Array, Complex
from ...determinant.exponents import MACHINE_EPSILON
from ...discretization.elements.resolution import Resolution
from ...discretization.straight.dense_eigenproblem import AnyPencil, DenseEigenproblem, dense_eigenproblem
from ...discretization.straight.pencil import factors_to_unit_tip_displacement
from ...model.rod import Rod
from .null_vectors import (
    MODE_ITERATION_SETTINGS,
    effects_of_rounding,
    eigenvalue_rounding,
    factorised_pencil,
    null_vectors,
)
from .stiffness_matrix import StiffnessMatrix


@dataclass(frozen=True, slots=True, kw_only=True)
class ModeVectors:
    """Right and left modes computed on the mesh `resolution`, at given points of the rod, with errors. The
    fields of modes are complex, (2, modes, points), NaN if the tip does not move."""

    resolution: Resolution
    right_modes: Complex
    """Right modes (Y, Theta) with Y(1) = 1, in L and rad for a tip deflection L."""
    mode_strains: Complex
    """Shear and curvature (h2, Pi) = (Y' - nu Theta, Theta') of the right modes (Sec. V); h2 is exactly 0 in
    an unshearable rod. At a jump of a stiffness: the value on the side of the tip."""
    left_modes: Complex
    """Left modes (Y+, Theta+) with Y+(1) = 1, in L and rad for a tip deflection L."""
    pairing: Complex
    """Gamma inner product (psi_n, xi_n) of the left mode psi_n and the right mode xi_n, complex, (modes,)."""
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

    @property
    def fields(self) -> Complex:
        """The fields Y, Theta, h2, Pi, Y+ and Theta+, complex, (6, modes, points)."""
        return np.concatenate([self.right_modes, self.mode_strains, self.left_modes])

    def relative_errors_by_name(self) -> dict[str, float]:
        """Largest relative errors over all modes, by name ("modes", "condition numbers"); inf if unknown."""
        errors = {"modes": self.mode_error.max(), "condition numbers": self.condition_error.max()}
        return {name: inf if np.isnan(error) else float(error) for name, error in errors.items()}


def mode_vectors(
    rod: Rod, pencil: AnyPencil, eigenvalues: Complex, points: Array, estimates_rounding: bool = True
) -> ModeVectors:
    """Right and left modes of `eigenvalues` on the mesh of `pencil`, at `points` in [0, 1], (n,).
    estimates_rounding: whether to estimate rounding errors; otherwise all errors are NaN."""
    form = dense_eigenproblem(rod, pencil)
    matrix = StiffnessMatrix(form.A, form.bending_factor)
    vectors, (tip_error, condition_rms) = _eigenvectors(form, matrix, eigenvalues, estimates_rounding)
    fields, pairing, condition = _evaluated_modes(form, vectors, points)
    m = len(eigenvalues)
    nan_per_mode = np.full(m, np.nan)
    modes = ModeVectors(
        resolution=Resolution(form.mesh.element_count, form.mesh.order),
        right_modes=fields[:2, :m],
        mode_strains=fields[2:4, :m],
        left_modes=fields[4:, :m],
        pairing=pairing[:m],
        condition=condition[:m],
        eigenvalue_rounding=nan_per_mode,
        mode_error=nan_per_mode,
        condition_error=nan_per_mode,
    )
    if not estimates_rounding:
        return modes
    factor = MODE_ITERATION_SETTINGS.rounding_safety_factor
    sample_change = largest_relative_change(fields[:, m:], fields[:, :m])
    curvature_rounding = form.relative_curvature_rounding(vectors[0, :, :m], points)
    return replace(
        modes,
        eigenvalue_rounding=np.array(
            [eigenvalue_rounding(matrix, form.B, *vectors[:, :, i]) for i in range(m)]
        ),
        mode_error=factor * (sample_change + tip_error + MACHINE_EPSILON * curvature_rounding),
        condition_error=factor * (condition_rms + MODE_ITERATION_SETTINGS.condition_sum_rounding),
    )


def _evaluated_modes(
    form: DenseEigenproblem, vectors: Complex, points: Array
) -> tuple[Complex, Complex, Array]:
    """Returns (fields, pairing, condition number) of k modes at `points`, (n,): (6, k, points), (k,) and
    (k,), as in `ModeVectors`. vectors: right and left eigenvectors, (2, unknowns, k)."""
    X, Z = (V * factors_to_unit_tip_displacement(*form.displacements(V)) for V in vectors)
    B = form.B[:, None]
    pairing = (B * Z * X).sum(axis=0)
    norms = [np.sqrt((B * np.abs(V) ** 2).sum(axis=0)) for V in (X, Z)]
    return form.fields_at(X, Z, points), pairing, norms[0] * norms[1] / np.abs(pairing)


def largest_relative_change(fields: Complex, reference: Complex) -> Array:
    """Largest change of a field from `reference` to `fields`, both as `ModeVectors.fields`, divided by the
    largest modulus of this field in `reference`; for each mode, (modes,)."""
    field_size = np.abs(reference).max(axis=2)
    field_change = np.abs(fields - reference).max(axis=2)
    relative_change = np.divide(field_change, field_size, out=field_change.copy(), where=field_size > 0)
    return np.asarray(relative_change.max(axis=0))


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


def _eigenvectors(
    form: DenseEigenproblem, matrix: StiffnessMatrix, eigenvalues: Complex, estimates_rounding: bool
) -> tuple[Complex, Array]:
    """Returns (vectors, errors). vectors: right and left eigenvectors, (2, unknowns, modes); if
    `estimates_rounding`, followed by the same eigenvectors perturbed by rounding errors, (2, unknowns, 2
    modes) together. errors: rms relative rounding errors of the tip displacement (the larger one of right and
    left) and of the condition number, (2, modes); NaN without the estimate. matrix: the matrix A of
    `form`."""
    settings = MODE_ITERATION_SETTINGS
    B = form.B
    mode_count = len(eigenvalues)
    vectors = np.empty((2, len(B), mode_count * (1 + estimates_rounding)), complex)
    rms_errors = np.full((2, mode_count), np.nan)
    for i, w in enumerate(eigenvalues):
        if i and w.imag < 0 and abs(w - eigenvalues[i - 1].conj()) <= settings.conjugate_tolerance * abs(w):
            vectors[:, :, i::mode_count] = vectors[:, :, i - 1 :: mode_count].conj()
            rms_errors[:, i] = rms_errors[:, i - 1]
            continue
        pencil = factorised_pencil(matrix, B, complex(w))
        pair = null_vectors(pencil)
        vectors[:, :, i] = pair
        if estimates_rounding:
            effects = effects_of_rounding(pencil, pair, form.mesh.node_count - 1)
            vectors[:, :, mode_count + i] = effects.vectors
            rms_errors[:, i] = effects.tip_error, effects.condition_error
    return vectors, rms_errors
