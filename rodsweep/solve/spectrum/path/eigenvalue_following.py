"""Eigenvalues followed along the points of a path: predicted, then refined by Newton's method on the
determinant D.

Each followed eigenvalue is a root of D within its error, and no two are the same root. Following proves
neither that no eigenvalue is missing nor that no two eigenvalues have been exchanged; a count proves both.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ....arrays import Array, Complex
from ....determinant.exponents import MACHINE_EPSILON
from ....determinant.parameter_path import PathDeterminantValue, determinant_value_on_path
from ....determinant.roots.roots import sort_indices_descending, taylor_parabola_roots
from ....determinant.roots.settings import ROOT_NEWTON_SETTINGS, ROOT_SETTINGS
from ....determinant.rounding_at_root import rounding_error_at_root
from ....determinant.value import DETERMINANT_SETTINGS
from ....model.compiled.compilation import compiled
from ....model.compiled.kernel_constants import KernelConstants
from ....model.rod import Coefficients
from .eigenvalue_prediction import FollowedEigenvalues, find_conjugates, predict_eigenvalues, set_two_guesses


@dataclass(frozen=True, slots=True, kw_only=True)
class EigenvalueFollowingSettings(KernelConstants):
    """Settings of Newton's method for followed eigenvalues."""

    max_newton_steps: int = 8
    """Maximum number of Newton steps for one eigenvalue."""
    accuracy_beyond_leading_modes: float = 1e-9
    """Relative accuracy of eigenvalues beyond the leading modes. They are used only to choose the vertical
    line to the right of which eigenvalues are counted."""
    D_curvature_safety_factor: float = 4.0
    """Safety factor on |D''/(2 D')|: the modulus of the sum of 1/(w - w_j) over all other roots w_j,
    estimated from the followed roots alone."""
    final_step_over_rounding: float = 4.0
    """Newton's method stops when the step is at most this multiple of the eigenvalue's rounding error."""


EIGENVALUE_FOLLOWING_SETTINGS = EigenvalueFollowingSettings()


class CorrectedEigenvalue(NamedTuple):
    """An eigenvalue w after one Newton step: slope dw/dp, length of the step, and rounding error of w.
    D_slope_modulus_before_step: |dD/dw| exp(-S) before the step, S = `log_scale`."""

    w: complex
    slope: complex
    step_length: float
    """Modulus of the Newton step, in 1/tau2."""
    rounding_error: float
    """Absolute rounding error of w, in 1/tau2."""
    D_slope_modulus_before_step: float
    log_scale: float


@compiled
def newton_step_of_uniform_eigenvalue(
    w: complex, coefficients: Coefficients, direction: Coefficients
) -> CorrectedEigenvalue:
    """One Newton step for a root of D from w; a real w stays real. coefficients: (F, nu, c2, gamma3) of the
    rod. direction: d(F, nu, c2, gamma3)/dp."""
    value = determinant_value_on_path(w, coefficients, direction)
    return eigenvalue_newton_step(
        w, value, DETERMINANT_SETTINGS.typical_rounding_error_over_bound * value.rounding_error
    )


@compiled
def eigenvalue_newton_step(w: complex, value: PathDeterminantValue, rounding: float) -> CorrectedEigenvalue:
    """One Newton step from w, given D and its derivatives with respect to w and p; a real w stays real.
    rounding: rounding error of D, on the same scale as D. If D_w vanishes, w is returned unchanged, with step
    and rounding error inf."""
    size = abs(value.D_w)
    if not size > 0:
        return CorrectedEigenvalue(w, 0j, math.inf, math.inf, 0.0, value.log_scale)
    step = value.D / value.D_w
    slope = -value.D_p / value.D_w
    if w.imag == 0:
        step = complex(step.real, 0.0)
        slope = complex(slope.real, 0.0)
    return CorrectedEigenvalue(w - step, slope, abs(step), rounding / size, size, value.log_scale)


@compiled
def eigenvalue_crowding_estimate(w: Complex, k: int) -> float:
    """Upper estimate of |D''/(2 D')| at root w[k], from the distances to 0 and to the other roots w, (m,)."""
    total = 1 / abs(w[k])
    for j in range(len(w)):
        if j != k:
            total += 1 / abs(w[k] - w[j])
    return EIGENVALUE_FOLLOWING_SETTINGS.D_curvature_safety_factor * total


@compiled
def converged_error(step: CorrectedEigenvalue, crowding: float, exact: bool) -> float:
    """Absolute error of an eigenvalue after a Newton step; inf if the step was too large for the error to be
    known. crowding: upper estimate of |D''/(2 D')| at the eigenvalue; the error is crowding times the squared
    step. exact: whether this error must be below the rounding error, instead of
    `EIGENVALUE_FOLLOWING_SETTINGS.accuracy_beyond_leading_modes` |w|."""
    remainder = crowding * step.step_length * step.step_length
    allowed = (
        max(step.rounding_error, MACHINE_EPSILON * abs(step.w))
        if exact
        else EIGENVALUE_FOLLOWING_SETTINGS.accuracy_beyond_leading_modes * abs(step.w)
    )
    if (
        remainder <= allowed
        or step.step_length <= EIGENVALUE_FOLLOWING_SETTINGS.final_step_over_rounding * step.rounding_error
    ):
        return max(step.rounding_error, min(remainder, step.step_length))
    return math.inf


@compiled
def store_root(track: FollowedEigenvalues, i: int, k: int, conjugate: int, step: CorrectedEigenvalue) -> bool:
    """Writes the eigenvalue with index k of point i to the track, and its conjugate to index `conjugate`
    unless `conjugate` is negative. step: the last Newton step of the eigenvalue. Returns False if a complex
    pair has become real. The error of eigenvalue k must already be in the track."""
    w = track.w[i]
    slope = track.slope[i]
    error = track.error[i]
    w[k] = step.w
    slope[k] = step.slope
    if conjugate >= 0:
        if not w[k].imag > ROOT_NEWTON_SETTINGS.real_axis_tolerance * abs(w[k]):
            return False
        w[conjugate] = w[k].conjugate()
        slope[conjugate] = slope[k].conjugate()
        error[conjugate] = error[k]
    return True


@compiled
def _iterate_to_convergence(
    first: CorrectedEigenvalue, crowding: float, exact: bool, rod: Coefficients, direction: Coefficients
) -> tuple[CorrectedEigenvalue, float]:
    """Returns (last Newton step, error) of an eigenvalue of a uniform rod, after Newton steps until
    `converged_error` is finite; the error is inf without convergence.

    first: result of the first step. crowding: upper estimate of |D''/(2 D')| at the eigenvalue. exact:
    whether crowding times the squared step must be below the rounding error, and the error must cover nearly
    all rounding errors of D. rod: coefficients of the rod. direction: d(F, nu, c2, gamma3)/dp.
    """
    step = first
    for _ in range(EIGENVALUE_FOLLOWING_SETTINGS.max_newton_steps):
        error = converged_error(step, crowding, exact)
        if error < math.inf:
            if exact and step.rounding_error > ROOT_SETTINGS.min_ill_conditioned_relative_error * abs(step.w):
                error = min(crowding * step.step_length * step.step_length, step.step_length)
                error_of_D = rounding_error_at_root(step.w, rod, step.log_scale)
                error = max(
                    error,
                    ROOT_SETTINGS.rounding_bound_fraction_at_root
                    * error_of_D
                    / step.D_slope_modulus_before_step,
                )
            return step, error
        step = newton_step_of_uniform_eigenvalue(step.w, rod, direction)
    return step, math.inf


@compiled
def are_distinct_roots(w: Complex, error: Array) -> bool:
    """Whether all eigenvalues w and their absolute errors `error`, (m,) each, are finite, and no two
    eigenvalues may be the same root. Two may be if they differ by a few errors or by
    `min_double_root_correction_over_w` times |w|; the second test is needed because an error estimate may be
    small by chance."""
    for k in range(len(w)):
        if not (abs(w[k]) < math.inf and error[k] < math.inf):
            return False
        min_distance = ROOT_SETTINGS.min_double_root_correction_over_w * abs(w[k])
        for j in range(k):
            if not abs(w[k] - w[j]) > max(
                ROOT_SETTINGS.same_root_distance_in_errors * (error[k] + error[j]), min_distance
            ):
                return False
    return True


@compiled
def _refine_all_eigenvalues(
    track: FollowedEigenvalues, i: int, guess: Complex, modes: int, rod: Coefficients, direction: Coefficients
) -> bool:
    """Refines the guesses `guess`, (m,), of all eigenvalues of point i by Newton's method, and writes the
    eigenvalues to the track: the `modes` + 1 leading eigenvalues to rounding error, all others to
    `accuracy_beyond_leading_modes`. Returns True if all converged, no two may coincide, and every complex
    pair stayed complex."""
    w = track.w[i]
    error = track.error[i]
    order = track.descending_order[i]
    m = len(w)
    conjugate = np.empty(m, np.int64)
    find_conjugates(guess, conjugate)
    # All eigenvalues take one step before further steps: the crowding of a root needs its neighbours.
    first = [CorrectedEigenvalue(0j, 0j, math.inf, math.inf, 0.0, 0.0) for _ in range(m)]
    for k in range(m):
        if guess[k].imag != 0 and conjugate[k] < 0:
            return False
        # Eigenvalues in the lower half plane follow by conjugation.
        if guess[k].imag >= 0:
            first[k] = newton_step_of_uniform_eigenvalue(guess[k], rod, direction)
            w[k] = first[k].w
            if conjugate[k] >= 0:
                w[conjugate[k]] = w[k].conjugate()
    sort_indices_descending(w, order)
    for rank in range(m):
        k = order[rank]
        if guess[k].imag >= 0:
            last, error[k] = _iterate_to_convergence(
                first[k], eigenvalue_crowding_estimate(w, k), rank <= modes, rod, direction
            )
            if not store_root(track, i, k, conjugate[k], last):
                return False
    # The further steps may have changed the order.
    sort_indices_descending(w, order)
    return are_distinct_roots(w, error)


@compiled
def follow_eigenvalues(
    track: FollowedEigenvalues, coefficients: Array, p: Array, direction: Coefficients, modes: int
) -> int:
    """Follows the eigenvalues of uniform rods along a path, and returns the number of points reached. p: path
    variable of the points, (points,).

    track: eigenvalues at every point; `w` and `descending_order` of the first point are given, the following
    points are filled. coefficients: (F, nu, c2, gamma3) at each point, (points, 4). direction: d(F, nu, c2,
    gamma3)/dp. modes: the `modes` + 1 leading eigenvalues are refined to rounding error.
    """
    guess = track.w[0].copy()
    partner = np.empty(len(guess), np.int64)
    for i in range(len(p)):
        F, nu, c2, gamma3 = coefficients[i]
        rod = Coefficients(F, nu, c2, gamma3)
        if i > 0:
            predict_eigenvalues(track, i, p, guess, partner)
            for k in range(len(guess)):
                if partner[k] >= 0:
                    two = (k, partner[k])
                    set_two_guesses(track.w[i - 1], two, taylor_parabola_roots(guess[k], rod), guess)
            track.descending_order[i] = track.descending_order[i - 1]
        if not _refine_all_eigenvalues(track, i, guess, modes, rod, direction):
            return i
    return len(p)
