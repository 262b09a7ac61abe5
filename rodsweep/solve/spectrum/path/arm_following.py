"""Eigenvalues of arms followed along a path, and proved complete at every point of the path.

The method is described in `rodsweep.solve.spectrum.path.eigenvalue_following`; here the determinant D is
computed from the interpolated propagators of a family of arms. The proof at a point
(`rodsweep.determinant.arm.completeness`) uses only the eigenvalues at this point.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array, Complex
from ....determinant.arm.arm_family import ArmFamily
from ....determinant.arm.arm_family_values import write_propagators
from ....determinant.arm.completeness import (
    COMPLETENESS_SETTINGS,
    points_right_of_hull,
    proves_completeness,
    sum_over_unknown_eigenvalues,
)
from ....determinant.arm.hull.region import EigenvalueHull, PathHulls, hull_at
from ....determinant.arm.rounding import error_from_interpolated_propagators
from ....determinant.arm.value import determinant_from_propagators, path_value_from_propagators
from ....determinant.roots.roots import roots_of_parabola, sort_indices_descending
from ....determinant.value import DETERMINANT_SETTINGS, scaled_second_derivative_between
from ....model.compiled.compilation import compiled
from ..candidates import EIGENVALUE_CANDIDATE_SETTINGS
from .eigenvalue_following import (
    EIGENVALUE_FOLLOWING_SETTINGS,
    CorrectedEigenvalue,
    are_distinct_roots,
    converged_error,
    eigenvalue_crowding_estimate,
    eigenvalue_newton_step,
    store_root,
)
from .eigenvalue_prediction import FollowedEigenvalues, find_conjugates, predict_eigenvalues, set_two_guesses


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmFollowingSettings:
    """Settings for following the eigenvalues of arms along a path: number of modes, families of arms with
    interpolated propagators (`ArmFamily`), and hulls of the spectra (`EigenvalueHull`)."""

    further_mode_counts: tuple[int, ...] = (3, 9)
    """Numbers of modes followed in addition to the wanted modes. The second number is tried if the first
    number proves a smaller fraction of the points than `min_proved_fraction_without_more_modes`, or is too
    small to prove all growing modes complete."""
    min_proved_fraction_without_more_modes: float = 0.5
    """More modes are followed if the modes are proved complete at less than this fraction of the points, if
    no winding numbers are computed afterwards, and if more modes would prove a further point."""
    min_unproved_points_for_more_hulls: int = 64
    """Minimum number of points without a proof of completeness for which the hulls of the spectra are
    computed at `hulls_per_unproved_interval` arms."""
    hulls_per_unproved_interval: int = 49
    """Number of arms of an interval at which the hull of the spectrum is computed, instead of
    `hulls_per_interval`, if at least `min_unproved_points_for_more_hulls` points have no proof."""
    family_W_over_max_abs_eigenvalue: float = 2.0
    """The propagators of a new family of arms are valid for |w| up to W, at least
    `family_W_over_max_abs_eigenvalue` * (largest |w| at the first point)."""
    min_reused_W_over_max_w: float = 1.25
    """The family of arms of the previous interval is used again if its bound W, up to which its propagators
    are valid in |w|, is at least this number times the largest |w| at the first point of the new interval."""
    max_points_over_previous_family: int = 2
    """Maximum number of points for which a new family of arms is made, divided by the number of points that
    were followed with the previous family."""
    min_family_points: int = 4
    """Minimum number of points of a path for which a family of arms (interpolated propagators) is made."""
    eigenvalue_accuracy: float = 1e-8
    """Relative accuracy of the eigenvalues of `FollowedArms`."""
    modes_beyond_growing: int = 2
    """Number of modes that a search for crossings requests in addition to the growing modes."""
    step_counts_from_nearest_point: tuple[int, ...] = (1, 4)
    """Eigenvalues at a path variable p are followed from the nearest solved point in this number of equal
    steps; the numbers are tried in turn."""
    hulls_per_interval: int = 13
    """Number of equally spaced arms of an interval of the path at which the hull of the spectrum
    (`EigenvalueHull`) is computed; the hulls of all other arms are interpolated."""


ARM_FOLLOWING_SETTINGS = ArmFollowingSettings()


PropagatorsWithPathSlopes = tuple[float, Array, Array, Array]
"""(bound W of |w|, propagators valid for |w| <= W, derivatives of the propagators with respect to the path
variable p, `reference_entry_sizes` of the propagators as in `ArmFamily`). Propagators and derivatives:
(elements, terms, PROPAGATOR_LENGTH)."""


@compiled
def newton_step_of_arm_eigenvalue(w: complex, level: PropagatorsWithPathSlopes) -> CorrectedEigenvalue:
    """One Newton step for a root of D from w; a real w stays real. level: bound W of |w|, and propagators of
    the arm. The error estimate contains only the rounding errors of the products of propagators; it is no
    bound of the rounding error of D, see `rounding_error_from_propagators`."""
    value = path_value_from_propagators(w, level[0], level[1], level[2])
    return eigenvalue_newton_step(w, value, value.rounding_error)


@compiled
def _converged_step_and_error(
    first: CorrectedEigenvalue, crowding: float, exact: bool, level: PropagatorsWithPathSlopes
) -> tuple[CorrectedEigenvalue, float]:
    """(last Newton step, error) of an arm's eigenvalue, after Newton steps until `converged_error` is finite.

    first: result of the first step. crowding: upper estimate of |D''/(2 D')| at the eigenvalue. exact:
    whether the quadratic remainder of the last step must be below the rounding error, and the error must
    contain rounding and interpolation along the whole arm. level: bound W of |w|, and propagators of the arm.
    The error is inf without convergence.
    """
    step = first
    for _ in range(EIGENVALUE_FOLLOWING_SETTINGS.max_newton_steps):
        error = converged_error(step, crowding, exact)
        if error < math.inf:
            if exact:
                error_of_D = error_from_interpolated_propagators(
                    step.w, level[0], level[1], step.log_scale, level[3]
                )
                error = max(error, error_of_D / step.D_slope_modulus_before_step)
            return step, error
        step = newton_step_of_arm_eigenvalue(step.w, level)
    return step, math.inf


@compiled
def taylor_parabola_roots_of_arm(
    middle: complex, level: PropagatorsWithPathSlopes
) -> tuple[complex, complex]:
    """The two roots of D near a real `middle`, from the quadratic Taylor polynomial of D about `middle`.
    level: bound W of |w|, and propagators of the arm."""
    D, D_w, S, _ = determinant_from_propagators(middle, level[0], level[1])
    h = DETERMINANT_SETTINGS.second_derivative_step_over_w * abs(middle)
    value_after = determinant_from_propagators(middle + h, level[0], level[1])
    value_before = determinant_from_propagators(middle - h, level[0], level[1])
    D_ww = scaled_second_derivative_between(value_after, value_before, S, h)
    return roots_of_parabola(middle, complex(D.real, 0.0), complex(D_w.real, 0.0), complex(D_ww.real, 0.0))


@compiled
def _refine_all_eigenvalues(
    track: FollowedEigenvalues, i: int, guess: Complex, modes: int, level: PropagatorsWithPathSlopes
) -> bool:
    """Refines the guesses for all eigenvalues of point i, and writes the eigenvalues to `track`, the
    eigenvalues along the path. guess: (m,). The `modes` + 1 leading eigenvalues converge to rounding error.
    level: bound W of |w|, and propagators of the arm. Returns True if all eigenvalues converged, no two
    coincide, and every complex pair stayed complex."""
    w = track.w[i]
    error = track.error[i]
    order = track.descending_order[i]
    m = len(w)
    conjugate_index = np.empty(m, np.int64)
    find_conjugates(guess, conjugate_index)
    w[:] = guess
    sort_indices_descending(w, order)
    for rank in range(m):
        k = order[rank]
        if guess[k].imag != 0 and conjugate_index[k] < 0:
            return False
        # Eigenvalues in the lower half plane follow by conjugation.
        if guess[k].imag >= 0:
            first = newton_step_of_arm_eigenvalue(guess[k], level)
            w[k] = first.w
            if conjugate_index[k] >= 0:
                w[conjugate_index[k]] = w[k].conjugate()
            last, error[k] = _converged_step_and_error(
                first, eigenvalue_crowding_estimate(w, k), rank <= modes, level
            )
            if not store_root(track, i, k, conjugate_index[k], last):
                return False
    # The refinement may have changed the order.
    sort_indices_descending(w, order)
    return are_distinct_roots(w, error) and np.abs(w).max() <= level[0]


@compiled
def proved_count_right_of_line(
    track: FollowedEigenvalues, i: int, modes: int, hull: EigenvalueHull, level: PropagatorsWithPathSlopes
) -> int:
    """Number of leading eigenvalues of point i that are proved to be all eigenvalues to the right of a
    vertical line; 0 without a proof.

    The line lies at Re w <= 0, to the left of the `modes` leading eigenvalues, so that the proof includes all
    unstable eigenvalues. track: eigenvalues along the path. hull: region that contains the spectrum. level:
    bound W of |w|, and propagators of the arm.
    """
    w = track.w[i]
    error = track.error[i]
    k = track.descending_order[i, modes - 1]
    line = min(
        w[k].real
        - EIGENVALUE_CANDIDATE_SETTINGS.proof_line_distance_in_errors * error[k]
        - EIGENVALUE_CANDIDATE_SETTINGS.relative_proof_line_distance * abs(w[k]),
        0.0,
    )
    count = 0
    for j in range(len(w)):
        if abs(w[j].real - line) <= 2 * error[j]:
            return 0
        count += w[j].real > line
    for point_count in COMPLETENESS_SETTINGS.real_point_counts:
        points = points_right_of_hull(line, hull.a, hull.c, point_count)
        if len(points) == 0 or points[-1] > level[0]:
            continue
        if proves_completeness(
            sum_over_unknown_eigenvalues(line, w, error, hull, points, (level[0], level[1]))
        ):
            return count
    return 0


@compiled
def follow_eigenvalues_of_arms(
    track: FollowedEigenvalues,
    family: ArmFamily,
    hulls: PathHulls,
    p: Array,
    modes: int,
    proved_counts: NDArray,
) -> int:
    """Follows eigenvalues of arms along the path variables p, (points,), and returns the number of points
    reached.

    track: `w` and `descending_order` of the first point are given, the remaining points are filled. family:
    family of arms that contains all p. hulls: regions that contain the spectra of all arms of the family.
    modes: number of requested modes. proved_counts: output, the number from `proved_count_right_of_line` at
    each point, (points,).
    """
    shape = family.chebyshev_coefficients.shape[1:]
    polynomials = np.empty(shape)
    changes = np.empty(shape)
    level = (family.largest_w, polynomials, changes, family.reference_entry_sizes)
    guess = track.w[0].copy()
    partner = np.empty(len(guess), np.int64)
    for i in range(len(p)):
        write_propagators(family, p[i], polynomials, changes)
        if i > 0:
            predict_eigenvalues(track, i, p, guess, partner)
            for k in range(len(guess)):
                if partner[k] >= 0:
                    two = (k, partner[k])
                    set_two_guesses(track.w[i - 1], two, taylor_parabola_roots_of_arm(guess[k], level), guess)
            track.descending_order[i] = track.descending_order[i - 1]
        if not _refine_all_eigenvalues(track, i, guess, modes, level):
            return i
        proved_counts[i] = proved_count_right_of_line(track, i, modes, hull_at(hulls, p[i]), level)
    return len(p)
