"""Tangent and Floquet multipliers of a cycle near the orbit at which a bordered matrix was assembled.

The matrix at the prediction of a cycle serves for Newton's method, but its tangent and its multipliers have
errors of the size of the prediction error. Both are corrected with derivatives of the residual at the cycle
itself and with the factors of the matrix, so that no further matrix is factorised. The multipliers are Ritz
values of the map G = S^-1 P of the cycle on the right and left invariant subspaces of the matrix. S:
symmetry. P: propagator over the solved part of the period, which is half a period for a symmetric orbit. The
error of the Ritz values is of second order in the distance of the cycle from the orbit of the matrix, because
it is the product of the errors of both subspaces. Each correction multiplies the right subspace by G, which
reduces its error. The size of the last corrections gives the error estimate. Shapes: as in `matrix`.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dgees

from ....arrays import Array, Complex
from ...orbit.matrix.multipliers import (
    FLOQUET_MULTIPLIER_SETTINGS,
    low_rank_factors,
    multipliers_over_period,
)
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.newton import ConvergedOrbit
from ...orbit.orbit import Orbit
from .corrected_tangent import corrected_tangent
from .matrix import BorderedMatrix


@dataclass(frozen=True, slots=True, kw_only=True)
class LinearisationCorrectionSettings:
    """Settings for the correction of tangent and multipliers with the matrix of a nearby orbit."""

    max_distance_from_matrix_orbit: float = 1e-2
    """Largest relative distance between a cycle and the orbit at which the nearby matrix was assembled, for a
    correction to be tried; at larger distances corrections rarely converge."""
    min_corrected_multiplier_modulus: float = 1e-3
    """Multipliers over the solved part of the period, half a period for a symmetric orbit, are not corrected
    if their moduli are smaller: the errors of these multipliers have no effect on stability or special
    points."""
    max_corrected_multiplier_modulus: float = 1e4
    """No multiplier is corrected if one over the solved part of the period has a larger modulus: beside a
    modulus of 1e6 rounding scatters multipliers near 1 by 1e-4."""
    tangent_tolerance: float = 1e-5
    """Relative tolerance of the tangent, which serves for predictions and for the signs at folds."""
    max_correction_steps: int = 4
    """Maximum number of corrections; each takes a tenth of the time for a new matrix."""


LINEARISATION_CORRECTION_SETTINGS = LinearisationCorrectionSettings()


@dataclass(frozen=True, eq=False)
class CorrectedLinearisation:
    """Tangent and multipliers at `orbit`, corrected with the factors of the nearby matrix `nearby_matrix`.
    corrected_tangent: tangent of the branch, (N + 1,), of unit arc length.
    multipliers_over_solved_time_interval: multipliers over half a period for a symmetric orbit, else over the
    whole period, (multipliers,). relative_error: estimate of the largest error of a multiplier, each divided
    by the larger of 1 and its own modulus."""

    orbit: Orbit
    nearby_matrix: BorderedMatrix
    corrected_tangent: Array
    multipliers_over_solved_time_interval: Complex
    relative_error: float
    tangent: Array | None = None  # as in `BorderedMatrix`

    @property
    def workspace(self) -> NewtonWorkspace:
        """Memory of Newton's matrices, in which `nearby_matrix` was assembled."""
        return self.nearby_matrix.workspace

    def multipliers(self) -> Complex:
        """Floquet multipliers larger than rounding error, with the trivial multiplier, by descending modulus,
        (multipliers,)."""
        return multipliers_over_period(self.multipliers_over_solved_time_interval, self.orbit)

    def branch_tangent(self, border: Array) -> Array:
        """Tangent of the branch, (N + 1,), of unit arc length, which makes an acute angle with `border`, in
        components (deflection, log period, parameter), (3,)."""
        derivative = self.nearby_matrix.scale.directional_derivative(self.orbit, self.corrected_tangent)
        return self.corrected_tangent if derivative @ border > 0 else -self.corrected_tangent


def corrected_linearisation(
    nearby: BorderedMatrix, orbit: Orbit, border: Array, tolerance: float
) -> CorrectedLinearisation | None:
    """Tangent and multipliers at the cycle `orbit`, the multipliers to the relative tolerance `tolerance`;
    None if the corrections do not converge. nearby: matrix at a nearby orbit, the last matrix of its
    workspace. border: direction of the branch in components (deflection, log period, parameter), (3,)."""
    # The invariant subspaces of a strongly unstable orbit are not those of a single propagator.
    if nearby.has_several_shooting_intervals:
        return None
    subspace = _CorrectedInvariantSubspaces.at_matrix(nearby)
    if subspace is None:
        return None
    first = nearby.branch_tangent(border)
    tangent: Array = first / (nearby.scale.directional_derivative(orbit, first) @ border)
    changes: Array = np.full(2, np.inf)
    errors = changes
    for number in range(LINEARISATION_CORRECTION_SETTINGS.max_correction_steps):
        columns, ends = nearby.residual_variations(orbit, np.vstack([tangent, subspace.increments]))
        corrected = corrected_tangent(nearby, orbit, border, tangent, (columns[:, :, :1], ends[:1]))
        previous_changes = changes
        changes = np.array(
            [
                subspace.correct_ritz_values(orbit, ends[1:]),
                _relative_tangent_change(nearby, orbit, corrected, tangent),
            ]
        )
        tangent = corrected
        # A correction leaves errors of second order; those of the multipliers are seen in the trivial
        # multiplier, too.
        errors = changes**2
        errors[0] = max(errors[0], subspace.trivial_multiplier_error)
        if number > 0:
            # Successive changes decrease by a rate; the next change would be the error that is left.
            errors = np.minimum(errors, changes * changes / previous_changes)
        if errors[0] <= tolerance and errors[1] <= max(
            tolerance, LINEARISATION_CORRECTION_SETTINGS.tangent_tolerance
        ):
            unit = np.linalg.norm(nearby.scale.directional_derivative(orbit, tangent))
            return CorrectedLinearisation(
                orbit, nearby, tangent / unit, subspace.multipliers, float(errors[0])
            )
        if not np.isfinite(errors).all():
            return None
        subspace.apply_map_to_right_subspace(columns[:, :, 1:])
    return None


def _relative_tangent_change(matrix: BorderedMatrix, orbit: Orbit, tangent: Array, previous: Array) -> float:
    """Relative change from the approximation `previous` of the tangent at `orbit` to the approximation
    `tangent`, (N + 1,) each, in the components (deflection, log period, parameter) of the scale of
    `matrix`."""
    derivative = matrix.scale.directional_derivative(orbit, tangent)
    change = matrix.scale.directional_derivative(orbit, tangent - previous)
    return float(np.linalg.norm(change) / np.linalg.norm(derivative))


class _CorrectedInvariantSubspaces:
    """Right and left invariant subspaces of the map G over the solved part of the period (see the module
    docstring) for the multipliers with moduli of at least
    `LINEARISATION_CORRECTION_SETTINGS.min_corrected_multiplier_modulus`, and the Ritz values of G on these
    subspaces. increments: changes of the orbit if its start changes by the basis vectors of the right
    subspace, (k, N + 1)."""

    def __init__(self, matrix: BorderedMatrix, right: Array, left: Array, values: Complex) -> None:
        """right, left: real bases of the subspaces at the orbit of `matrix`, (k, n) each. values: multipliers
        of the matrix over the solved part of the period, (multipliers,), with the k multipliers of the
        subspaces first."""
        self._matrix = matrix
        self._left = left
        self._products = left @ right.T
        self._values = values[: len(right)]
        self._neglected = values[len(right) :]
        K, s, n = matrix.orbit.stage_states.shape
        no_sides = np.zeros((K, s, len(right), n))
        self.increments = matrix.orbit_increments_at_fixed_parameter(right, no_sides)
        self._next_starts = right

    @classmethod
    def at_matrix(cls, matrix: BorderedMatrix) -> "_CorrectedInvariantSubspaces | None":
        """The subspaces at the orbit of `matrix`. None if no multiplier is large enough to be corrected, if
        one is too large, if the propagator is not finite, or if rounding errors put the two multipliers of a
        pair on different sides of the smallest corrected modulus."""
        orbit = matrix.orbit
        G = orbit.symmetry.apply_inverse_to_flow(matrix.propagator, orbit.form.layout)
        Q, R = low_rank_factors(np.ascontiguousarray(G), FLOQUET_MULTIPLIER_SETTINGS.negligible_column_ratio)
        small = R @ Q.T
        if not np.isfinite(small).all():
            return None
        # Schur vectors of the ordered form; the first `count` span the invariant subspace.
        _, count, real_parts, imaginary_parts, right, _, _ = dgees(_is_multiplier_corrected, small, sort_t=1)
        # The left invariant subspace of a matrix is the right one of its transpose.
        _, left_count, _, _, left, _, _ = dgees(_is_multiplier_corrected, small.T, sort_t=1)
        if count != left_count or count == 0:
            return None
        values = real_parts + 1j * imaginary_parts
        if np.abs(values).max() > LINEARISATION_CORRECTION_SETTINGS.max_corrected_multiplier_modulus:
            return None
        return cls(matrix, right[:, :count].T @ Q, left[:, :count].T @ R, values)

    @property
    def multipliers(self) -> Complex:
        """Multipliers over the solved part of the period, (multipliers,): the corrected Ritz values, then the
        multipliers that are too small to be corrected."""
        return np.append(self._values, self._neglected)

    @property
    def trivial_multiplier_error(self) -> float:
        """Distance of the trivial multiplier from 1."""
        return float(np.abs(self._values - 1).min())

    def correct_ritz_values(self, orbit: Orbit, end_changes: Array) -> float:
        """Corrects the Ritz values at the cycle `orbit`. Returns the largest change of a Ritz value, each
        divided by the larger of 1 and its own modulus, because a multiplier near the unit circle decides on
        stability, however large another multiplier is. end_changes: the `ends`
        that `BorderedMatrix.residual_variations` returns at this cycle for the variations `increments`,
        (k, n)."""
        n = self._left.shape[1]
        ends = np.ascontiguousarray((self.increments[:, -2 - n : -2] + end_changes).T)
        images = orbit.symmetry.apply_inverse_to_flow(ends, orbit.form.layout)
        ritz = np.linalg.solve(self._products, self._left @ images)
        values: Complex = np.linalg.eigvals(ritz).astype(complex)
        distances = np.abs(values[:, None] - self._values).min(axis=1)
        self._values = values
        # The image of the subspace, in the basis that the left subspace fixes.
        basis = self.increments[:, :n]
        self._next_starts = np.linalg.solve(ritz.T, images.T - ritz.T @ basis)
        return float((distances / np.maximum(1.0, np.abs(values))).max())

    def apply_map_to_right_subspace(self, columns: Array) -> None:
        """Replaces the right subspace by its image under G. columns: the `columns` that
        `BorderedMatrix.residual_variations` returned together with the `end_changes` of the last call of
        `correct_ritz_values`, (K, s, k, n), for s stages of each of the K time intervals."""
        starts = np.ascontiguousarray(self._next_starts)
        self.increments = self.increments + self._matrix.orbit_increments_at_fixed_parameter(
            starts, np.ascontiguousarray(columns)
        )


def _is_multiplier_corrected(real: float, imaginary: float) -> bool:
    """Whether a multiplier over the solved part of the period is corrected. real, imaginary: its real and
    imaginary part."""
    return bool(
        real**2 + imaginary**2 >= LINEARISATION_CORRECTION_SETTINGS.min_corrected_multiplier_modulus**2
    )


def linearisation_of(solved: ConvergedOrbit) -> BorderedMatrix | CorrectedLinearisation:
    """Tangent and multipliers of an orbit that was solved with the parameter as an unknown; raises TypeError
    if the parameter was fixed."""
    if not isinstance(solved.matrix, BorderedMatrix | CorrectedLinearisation):
        raise TypeError("the orbit has no bordered matrix: it was solved without the parameter as an unknown")
    return solved.matrix


def nearby_bordered_matrix(solved: ConvergedOrbit) -> BorderedMatrix:
    """The bordered matrix of an orbit that was solved with the parameter as an unknown, assembled at a nearby
    orbit; raises TypeError if the parameter was fixed."""
    linearisation = linearisation_of(solved)
    return linearisation.nearby_matrix if isinstance(linearisation, CorrectedLinearisation) else linearisation
