"""Newton's method on D of an arm without a closed form, and the errors of roots of D.

Compiled functions take a propagator set, a pair (W, propagators that are valid for |w| <= W), as the argument
`level`; the public functions choose the propagator set by |w|.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...arrays import Array, Complex, list_of
from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ..exponents import EXPONENT_SETTINGS, MACHINE_EPSILON
from ..roots.roots import roots_of_parabola
from ..roots.settings import ROOT_NEWTON_SETTINGS, ROOT_SETTINGS
from ..value import DETERMINANT_SETTINGS, DeterminantValue, scaled_second_derivative_between
from .determinant import ArmDeterminant, PropagatorsUpToW
from .rounding import rounding_error_from_propagators
from .value import determinant_from_propagators


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmRootSettings(KernelConstants):
    """Settings for the refinement of eigenvalues of arms."""

    residual_factor_in_error_of_D: float = 2.0
    """Factor of |D|, the residual after Newton's method, in the error of D at a root."""
    max_remainder_for_restart_at_zero: float = 1e-8
    """If a Newton step leaves at most this fraction of |w|, the next step starts from w = 0: the remainder
    has lost half of its digits. The leading eigenvalue of a strongly pulled arm is exponentially small."""
    max_later_w_over_root_w: float = 16.0
    """If D is needed later at a larger |w|, the roots already use the elements for it, but only if it is at
    most this number times |w| of the roots, so that the elements are at most four times as many. Rounding
    errors grow with the number of elements."""


ARM_ROOT_SETTINGS = ArmRootSettings()


@compiled
def _second_derivative_by_propagators(w: complex, S: float, level: PropagatorsUpToW) -> complex:
    """D'' exp(-S) at w, by a central difference of D', from `level`: W, and propagators valid for |w| <=
    W."""
    h = DETERMINANT_SETTINGS.second_derivative_step_over_w * abs(w)
    value_after = determinant_from_propagators(w + h, level[0], level[1])
    value_before = determinant_from_propagators(w - h, level[0], level[1])
    D_ww = scaled_second_derivative_between(value_after, value_before, S, h)
    return complex(D_ww.real, 0.0) if w.imag == 0 else D_ww


@compiled
def _root_error_from_value(w: complex, value: DeterminantValue, level: PropagatorsUpToW) -> float:
    """`root_error` at w, from the value of D at w and from `level`: W, and propagators valid for |w| <= W."""
    rounding = rounding_error_from_propagators(w, level[0], level[1], value.log_scale)
    e = ARM_ROOT_SETTINGS.residual_factor_in_error_of_D * abs(value.D) + rounding
    size = abs(value.D_w)
    error = e / max(size, EXPONENT_SETTINGS.min_divisor)
    if error > ROOT_SETTINGS.min_double_root_correction_over_w * abs(w):
        # Near a double root e/|D'| is unbounded, but a root of the second-order polynomial is near.
        D_ww = abs(_second_derivative_by_propagators(w, value.log_scale, level))
        if size**2 < ROOT_SETTINGS.min_half_root_distance_in_corrections * e * D_ww:
            root_distance = math.sqrt(2 * e / D_ww)
            error = min(max(error, root_distance), size / D_ww + root_distance)
    return error + MACHINE_EPSILON * abs(w)


@compiled
def _root_error_by_propagators(w: complex, level: PropagatorsUpToW) -> float:
    """`root_error` at w, from `level`: W, and propagators valid for |w| <= W."""
    return _root_error_from_value(w, determinant_from_propagators(w, level[0], level[1]), level)


@compiled
def _newton_from_guess(guess: complex, level: PropagatorsUpToW, last: float) -> tuple[complex, float, float]:
    """Returns (w, error of w, length of the last step) after Newton's method from `guess`, with the
    propagators of `level`, valid for |w| <= W.

    last: length of the previous step; the iteration ends at a step that hardly decreases
    (`ROOT_NEWTON_SETTINGS.min_stagnant_step_ratio`). The error is -1 if |w| exceeds W, the bound of the
    propagators.
    """
    w = guess
    for _ in range(ROOT_NEWTON_SETTINGS.max_steps_to_eigenvalue):
        value = determinant_from_propagators(w, level[0], level[1])
        # An infinite step ends the iteration where it is.
        step = value.D / value.D_w if value.D_w != 0 else complex(math.inf, 0.0)
        if guess.imag == 0:
            step = complex(step.real, 0.0)
        # w stays where D was just evaluated, so that its error needs no further value.
        if not abs(step) < ROOT_NEWTON_SETTINGS.min_stagnant_step_ratio * last:
            return w, _root_error_from_value(w, value, level), last
        last = abs(step)
        # D(0) = 1 and D'(0) are exact where the digits of w are lost.
        w = w - step if abs(w - step) > ARM_ROOT_SETTINGS.max_remainder_for_restart_at_zero * abs(w) else 0j
        if abs(w.imag) <= ROOT_NEWTON_SETTINGS.real_axis_tolerance * abs(w):
            w = complex(w.real, 0.0)
        # The error needs D' at w + h too, which must also lie within W.
        if not (1 + DETERMINANT_SETTINGS.second_derivative_step_over_w) * abs(w) <= level[0]:
            return w, -1.0, last
    return w, _root_error_by_propagators(w, level), last


@compiled
def _newton_from_guesses(
    guesses: Complex, level: PropagatorsUpToW, last: Array
) -> tuple[Complex, Array, Array]:
    """Results (w, errors, lengths of the last steps) of `_newton_from_guess` for all guesses, (n,) each.
    level: W and the propagators valid for |w| <= W. last: length of the previous step, (n,)."""
    w = np.empty(len(guesses), np.complex128)
    errors = np.empty(len(guesses))
    steps = np.empty(len(guesses))
    for k in range(len(guesses)):
        w[k], errors[k], steps[k] = _newton_from_guess(guesses[k], level, last[k])
    return w, errors, steps


@compiled
def _root_errors_by_propagators(w: Complex, level: PropagatorsUpToW) -> Array:
    """`root_error` at all w, (n,), from `level`: W, and propagators valid for |w| <= W."""
    errors = np.empty(len(w))
    for k in range(len(w)):
        # Conjugates, which stand next to each other, have the same error.
        is_conjugate = k > 0 and w[k] == w[k - 1].conjugate()
        errors[k] = errors[k - 1] if is_conjugate else _root_error_by_propagators(w[k], level)
    return errors


@compiled
def _parabola_roots_by_propagators(middle: complex, level: PropagatorsUpToW) -> tuple[complex, complex]:
    """`taylor_parabola_roots` about `middle`, from `level`: W, and propagators valid for |w| <= W."""
    D, D_w, S, _ = determinant_from_propagators(middle, level[0], level[1])
    if middle.imag == 0:
        D = complex(D.real, 0.0)
        D_w = complex(D_w.real, 0.0)
    return roots_of_parabola(middle, D, D_w, _second_derivative_by_propagators(middle, S, level))


def _propagators_for_second_derivative(w: complex, determinant: ArmDeterminant) -> PropagatorsUpToW:
    """Returns (W, propagators): the cached or new propagators of the arm that are valid for |v| <= W, with W
    large enough for D and D'' at w."""
    return determinant.propagators_for((1 + DETERMINANT_SETTINGS.second_derivative_step_over_w) * abs(w))


def second_derivative(w: complex, log_scale: float, determinant: ArmDeterminant) -> complex:
    """D'' exp(-S) of an arm at w, by a central difference of D'; real for real w. S: `log_scale`."""
    return _second_derivative_by_propagators(
        complex(w), log_scale, _propagators_for_second_derivative(w, determinant)
    )


def root_error(w: complex, determinant: ArmDeterminant) -> float:
    """Estimated distance from w to the nearest root of an arm's D, in 1/tau2; valid near double roots too."""
    return _root_error_by_propagators(complex(w), _propagators_for_second_derivative(w, determinant))


def root_errors(w: Sequence[complex], determinant: ArmDeterminant) -> Array:
    """`root_error` at all w, (n,), by one call of compiled code if the same elements serve all w."""
    level = _common_propagators(w, determinant)
    if level is None:
        return np.array([root_error(value, determinant) for value in w])
    return _root_errors_by_propagators(np.array(w, complex), level)


def refine_eigenvalue_and_error(
    w: complex, determinant: ArmDeterminant, max_first_step: float = math.inf
) -> tuple[complex, float]:
    """Returns (eigenvalue of an arm near w, error), by Newton's method until rounding error stops the
    convergence. A real guess w gives a real eigenvalue. max_first_step: if the first Newton step is at least
    this long, w is returned unchanged."""
    error = -1.0
    # A step must be below half of the last one, so this demands a first step below max_first_step.
    last = 2 * max_first_step
    # The loop ends because the steps keep halving across the restarts with other elements.
    while error < 0:
        w, error, last = _newton_from_guess(
            complex(w), _propagators_for_second_derivative(w, determinant), last
        )
    return w, error


def refine_eigenvalues_and_errors(
    w: Sequence[complex], determinant: ArmDeterminant, max_first_steps: Sequence[float]
) -> list[tuple[complex, float]]:
    """Results of `refine_eigenvalue_and_error` for all guesses w and their `max_first_steps`, (n,) each, by
    one call of compiled code if the same elements serve all w."""
    level = _common_propagators(w, determinant)
    if level is not None:
        last = np.array([2 * step for step in max_first_steps], float)
        roots, errors, _ = _newton_from_guesses(np.array(w, complex), level, last)
        if (errors >= 0).all():
            return list(zip(list_of(roots), list_of(errors), strict=True))
    # An iterate has left the common elements, so every guess now chooses its own.
    steps = zip(w, max_first_steps, strict=True)
    return [refine_eigenvalue_and_error(value, determinant, step) for value, step in steps]


def _common_propagators(w: Sequence[complex], determinant: ArmDeterminant) -> PropagatorsUpToW | None:
    """The propagators that `_propagators_for_second_derivative` gives for every w; None if they differ or
    there is no w."""
    if not w:
        return None
    # The propagators for all other w lie between the propagators for the smallest and the largest |w|.
    level = _propagators_for_second_derivative(max(w, key=abs), determinant)
    return level if level is _propagators_for_second_derivative(min(w, key=abs), determinant) else None


def taylor_parabola_roots(middle: complex, determinant: ArmDeterminant) -> tuple[complex, complex]:
    """The two roots of the quadratic Taylor polynomial of an arm's D about `middle`. For a real `middle` the
    roots are both real or complex conjugates."""
    return _parabola_roots_by_propagators(middle, _propagators_for_second_derivative(middle, determinant))
