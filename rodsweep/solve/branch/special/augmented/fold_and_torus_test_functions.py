"""Test functions of folds and torus points, for cycles near a cycle whose Newton matrix is factorised.

Minimally augmented systems (Govaerts 2000, ch. 4 and 10): the test function of a cycle is the solution of a
bordered linear system of the linearised equations. This module solves the bordered system iteratively. Each
correction uses the residual at the cycle itself and the matrix factors of the nearby cycle, so that no
further matrix is factorised. N is the number of orbit values.
"""

from dataclasses import dataclass

import numpy as np

from .....arrays import Array
from ....orbit.orbit import Orbit
from ....unsolvable import Unsolvable
from ...bordered.corrected_tangent import corrected_tangent
from ...bordered.matrix import BorderedMatrix
from ...bordered.scale import deflection_at_time_zero
from ..special_point import SPECIAL_POINT_SETTINGS


@dataclass(frozen=True, slots=True, kw_only=True)
class MinimallyAugmentedSettings:
    """Settings for correcting a cycle, its test function and its null vectors with the matrix factors of a
    nearby cycle."""

    relative_cycle_tolerance: float = 1e-9
    """Relative tolerance of a cycle and its test function; the test function then has an error of about
    1e-8."""
    cycle_tolerance_over_curve_distance: float = 0.01
    """A cycle is corrected to the larger of `relative_cycle_tolerance` and this fraction of its estimated
    distance from the curve of special points; the estimate is the test function divided by its slope."""
    min_assumed_contraction_rate: float = 10.0
    """Lower limit of the assumed contraction rate: the ratio of successive corrections, divided by the
    relative distance of the cycle from the orbit at which the matrix was assembled. The measured rate is 2 or
    3 for large cycles; a larger assumed rate is safe."""
    contraction_safety_factor: float = 3.0
    """The contraction rate assumed for the next cycle is the measured rate times this factor."""
    max_successive_correction_ratio: float = 0.3
    """A new matrix is assembled if the ratio of the sizes of successive corrections exceeds this number."""
    max_relative_correction_by_rounding: float = 1e-8
    """The iteration stops if a correction has at most this relative size but is not much smaller than the
    previous correction (ratio above `max_successive_correction_ratio`; for a test function at a fixed cycle,
    above `min_stagnant_step_ratio` of `SPECIAL_POINT_SETTINGS`): the correction is then rounding error."""
    max_corrections_per_cycle: int = 30
    """Maximum number of corrections of one cycle."""
    inverse_iteration_shift: float = 1e-9
    """Relative distance of the shift of inverse iteration from the eigenvalue; with this distance the shifted
    matrix is regular."""
    inverse_iteration_count: int = 2
    """Number of inverse iterations. Each iteration multiplies the components of other eigenvectors by the
    ratio of `inverse_iteration_shift` to the relative gap between the eigenvalues."""


MINIMALLY_AUGMENTED_SETTINGS = MinimallyAugmentedSettings()


class FoldTestFunction:
    """Test function of folds: derivative of the scaled parameter coordinate with respect to the arc length in
    the direction `border`, (3,). matrix: matrix of a nearby cycle, whose factors are used. has_small_cycles:
    whether the derivative is divided by the deflection; without this division the derivative vanishes at a
    Hopf point too. null_vectors: approximate tangent of the branch, (N + 1,), which `correct_null_vectors`
    improves."""

    def __init__(self, matrix: BorderedMatrix, border: Array, has_small_cycles: bool) -> None:
        self.matrix = matrix
        self.border = border
        self.has_small_cycles = has_small_cycles
        tangent = matrix.branch_tangent(border)
        rates = matrix.scale.directional_derivative(matrix.orbit, tangent)
        self.null_vectors: Array = tangent / (rates @ border)

    def value(self, orbit: Orbit) -> float:
        """The test function at an orbit, from the last corrected tangent: derivative of the scaled parameter
        coordinate with respect to arc length, divided by the scaled deflection if `has_small_cycles`; 0 at a
        fold."""
        parameter_rate = float(self.null_vectors[-1] / self.matrix.scale.coordinate_unit)
        # Near a Hopf point the derivative is proportional to the deflection; their ratio stays regular.
        return (
            parameter_rate * self.matrix.scale.deflection_unit / deflection_at_time_zero(orbit)
            if self.has_small_cycles
            else parameter_rate
        )

    def correct_null_vectors(self, orbit: Orbit) -> None:
        """Corrects the tangent at an orbit by one step of iterative refinement of its linear equation."""
        tangent = self.null_vectors
        residuals = self.matrix.residual_variations(orbit, tangent[None])
        self.null_vectors = corrected_tangent(self.matrix, orbit, self.border, tangent, residuals)


class TorusTestFunction:
    """Test function of torus points: |mu| - 1, mu: complex multiplier nearest to the unit circle, which is
    corrected together with its eigenvector. matrix: matrix of a nearby cycle, whose factors are used.
    null_vectors: real and imaginary part of the approximate eigenvector, (2, N + 1). shifted_propagator: P -
    (1 + shift) mu S, the matrix of inverse iteration (P: propagator, S: symmetry). bordered_propagator: P -
    mu S with the border of Newton's method for mu. Raises Unsolvable if all multipliers of this cycle are
    real."""

    def __init__(self, matrix: BorderedMatrix) -> None:
        self.matrix = matrix
        pair = multiplier_pair_nearest_unit_circle(matrix)
        if pair is None:
            raise Unsolvable("the multipliers that cross the unit circle have become real")
        self.multiplier = pair
        p = matrix.orbit.orbit_equations
        # At the multiplier itself the matrix would be singular, so inverse iteration needs a small shift.
        self.shifted_propagator = (
            matrix.propagator
            - (1 + MINIMALLY_AUGMENTED_SETTINGS.inverse_iteration_shift) * pair * p.symmetry_matrix
        )
        # Almost any start has a part along the eigenvector, and only this part grows.
        start = np.ones(len(p.mass_diagonal), dtype=complex)
        for _ in range(MINIMALLY_AUGMENTED_SETTINGS.inverse_iteration_count):
            start = np.linalg.solve(self.shifted_propagator, p.symmetry_matrix @ start)
            start /= np.linalg.norm(start)
        self.border = start.conj()
        # The eigenvector at t = 0 is continued to all stages, where the residual is evaluated.
        K, s, n = matrix.orbit.stage_states.shape
        self.null_vectors = matrix.orbit_increments_at_fixed_parameter(
            _real_and_imaginary(start), np.zeros((K, s, 2, n))
        )
        n = len(start)
        self.bordered_propagator = np.zeros((n + 1, n + 1), dtype=complex)
        # The border makes the matrix regular although its block is singular at the multiplier.
        self.bordered_propagator[:n, :n] = matrix.propagator - pair * p.symmetry_matrix
        self.bordered_propagator[:n, n] = -p.symmetry_matrix @ start
        self.bordered_propagator[n, :n] = self.border

    def value(self, orbit: Orbit) -> float:
        """The test function |mu| - 1, from the last corrected multiplier mu; `orbit` is not used."""
        return abs(self.multiplier) - 1

    def correct_null_vectors(self, orbit: Orbit) -> None:
        """Corrects the multiplier and its eigenvector at an orbit by one approximate Newton step."""
        columns, ends = self.matrix.residual_variations(orbit, self.null_vectors)
        n = ends.shape[1]
        start, end = (
            part[0] + 1j * part[1] for part in (self.null_vectors[:, :n], self.null_vectors[:, -2 - n : -2])
        )
        right_side = np.append(
            self.multiplier * (orbit.orbit_equations.symmetry_matrix @ start), 1 - self.border @ start
        )
        # The defect is taken at the cycle itself; only the correction uses the factors of the nearby cycle.
        right_side[:-1] -= end + ends[0] + 1j * ends[1]
        change = np.linalg.solve(self.bordered_propagator, right_side)
        self.multiplier += complex(change[-1])
        self.null_vectors = self.null_vectors + self.matrix.orbit_increments_at_fixed_parameter(
            _real_and_imaginary(change[:-1]), columns
        )


def correct_until_converged(function: FoldTestFunction | TorusTestFunction, orbit: Orbit) -> None:
    """Corrects a test function at an orbit until its value changes only by rounding error; raises
    Unsolvable."""
    value = function.value(orbit)
    previous_change = np.inf
    for correction_index in range(MINIMALLY_AUGMENTED_SETTINGS.max_corrections_per_cycle):
        function.correct_null_vectors(orbit)
        previous_value = value
        value = function.value(orbit)
        change = abs(value - previous_value)
        if change <= SPECIAL_POINT_SETTINGS.test_function_correction_tolerance or (
            change > SPECIAL_POINT_SETTINGS.min_stagnant_step_ratio * previous_change
            and change <= MINIMALLY_AUGMENTED_SETTINGS.max_relative_correction_by_rounding
        ):
            return
        # The iteration converges linearly, so a change that grows will not decrease later.
        if change > previous_change:
            break
        # The first value belongs to the cycle of the matrix; by chance it may be as close as the second.
        previous_change = change if correction_index > 0 else np.inf
    raise Unsolvable("the iteration for the test function of the special point does not converge")


def _real_and_imaginary(vector: Array) -> Array:
    """Real and imaginary part, (2, n), of a complex vector, (n,)."""
    return np.array([vector.real, vector.imag])


def multiplier_pair_nearest_unit_circle(matrix: BorderedMatrix) -> complex | None:
    """The complex multiplier nearest to the unit circle, of the map over the solved part of the period of the
    orbit of `matrix`; None if all multipliers are real."""
    multipliers = matrix.multipliers_over_solved_time_interval
    pairs = multipliers[
        np.abs(multipliers.imag) > SPECIAL_POINT_SETTINGS.real_multiplier_tolerance * np.abs(multipliers)
    ]
    return complex(pairs[np.argmin(np.abs(np.abs(pairs) - 1))]) if len(pairs) else None
