"""Changes of a rod's stability between two forces, from the leading eigenvalues at both forces.

If the leading growth rate changes its sign, a complex pair crosses the imaginary axis, because D(0) = 1 keeps
real eigenvalues away from 0. The eigenvalues at both forces are starting points of Newton's method on
D(i eta; F) = 0. If the two leading eigenvalues are real at the first force and complex at the second, a
double eigenvalue D = D_w = 0 lies between the forces. Two changes between two forces may cancel and stay
unnoticed; the task `thresholds` proves completeness.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Complex, list_of
from ..model.compiled.compilation import compiled
from ..model.compiled.kernel_constants import KernelConstants
from ..model.rod import Coefficients
from .roots.newton import crossing_by_newton, double_eigenvalue_by_newton


@dataclass(frozen=True, slots=True, kw_only=True)
class StabilityChangeSettings(KernelConstants):
    """Settings for crossings of the imaginary axis between two forces."""

    same_crossing_relative_distance: float = 1e-8
    """Two zeros (eta, F) of D(i eta; F) are the same crossing if F and eta each differ by at most this times
    1 + |value|. Newton's method converges to rounding error, far below this number."""


STABILITY_CHANGE_SETTINGS = StabilityChangeSettings()


class StabilityChange(NamedTuple):
    """A change of stability at the force F.

    kind: a kind of change listed in `rodsweep.results.layouts.thresholds`. F, error_of_F: the force and its
    absolute error estimate, in k3/L^2. growth_rate, frequency: real and imaginary part, in 1/tau2, of the
    eigenvalue that crosses the imaginary axis or is double.
    """

    kind: str
    F: float
    error_of_F: float
    growth_rate: float
    frequency: float


CoefficientsLinearInForce = tuple[Coefficients, Coefficients]
"""Rods that differ in F only: (coefficients at F = 0, derivative of the coefficients by F)."""


def oscillation_onset_between(
    rods: CoefficientsLinearInForce, end_forces: tuple[float, float], before_w: Complex, after_w: Complex
) -> StabilityChange | None:
    """The double real eigenvalue between the two forces `end_forces`; None if Newton's method does not find
    it.

    before_w, after_w: leading eigenvalues at the first and second force, (modes,). The two leading
    eigenvalues w1, w2 are real at the first force and complex at the second. ((w1 - w2)/2)^2 is almost linear
    in F, and Newton's method starts at the zero of the line between the two forces. rods: coefficients at F =
    0 and their derivative by F.
    """
    low, high = end_forces
    first_w = before_w[0].item()  # Python's numbers, for speed
    second_w = before_w[1].item()
    complex_w = after_w[0].item()
    squared_half_gap = ((first_w.real - second_w.real) / 2) ** 2
    squared_frequency = complex_w.imag**2
    guess_F = low + (high - low) * squared_half_gap / (squared_half_gap + squared_frequency)
    centre = ((first_w.real + second_w.real) / 2 + complex_w.real) / 2
    zero = double_eigenvalue_by_newton(centre, guess_F, *rods, high - low)
    # The comparison is also false for nan, the result of a failure.
    if not low <= zero.p <= high:
        return None
    return StabilityChange("onset", zero.p, zero.error_of_p, zero.eta_or_x, 0.0)


def stability_change_between(
    rods: CoefficientsLinearInForce,
    end_forces: tuple[float, float],
    before_w: Complex,
    after_w: Complex,
    unstable_count: int,
) -> StabilityChange | None:
    """The loss or return of stability between the two forces `end_forces`: the first crossing if stability is
    lost, the last crossing if stability returns.

    before_w, after_w: leading eigenvalues at the first and second force, (modes,). unstable_count: number of
    growing modes at the unstable force. rods: coefficients at F = 0 and their derivative by F. Returns None
    unless the number of crossings found is unstable_count/2.
    """
    zeros = sorted(list_of(crossings_between(*end_forces, before_w, after_w, *rods)))
    # Each crossing makes two modes grow or decay; any other number means that one was missed or two cancel.
    if not zeros or 2 * len(zeros) != unstable_count:
        return None
    loses_stability = after_w[0].real > 0
    F, eta, error = zeros[0 if loses_stability else -1]
    return StabilityChange("hopf" if loses_stability else "restabilization", F, error, 0.0, eta)


@compiled
def crossings_between(
    low: float,
    high: float,
    before_w: Complex,
    after_w: Complex,
    origin: Coefficients,
    direction: Coefficients,
) -> Array:
    """Array of (F, frequency, error of F), (n, 3), of all distinct zeros of D(i eta; F) that Newton's method
    finds.

    before_w, after_w: eigenvalues at the forces `low` and `high`, (modes,). origin,
    direction: coefficients at F = 0 and their derivative by F. Newton's method starts from all frequencies of
    these eigenvalues at three forces: `low`, `high`, and the zero of the linear interpolant of the leading
    growth rate.
    """
    first_growth = before_w[0].real
    last_growth = after_w[0].real
    interpolated_F = low + (high - low) * first_growth / (first_growth - last_growth)
    crossings = np.empty((3 * (len(before_w) + len(after_w)), 3))
    n = 0
    for F in (interpolated_F, low, high):
        for eigenvalues in (before_w, after_w):
            for w in eigenvalues:
                if not w.imag > 0:
                    continue
                zero = crossing_by_newton(w.imag, F, origin, direction, (w.imag, max(abs(F), high - low)))
                # The comparison is also false for nan, the result of a failure.
                if not low <= zero.p <= high:
                    continue
                is_new = True
                for i in range(n):
                    same_F = abs(
                        zero.p - crossings[i, 0]
                    ) <= STABILITY_CHANGE_SETTINGS.same_crossing_relative_distance * (
                        1 + abs(crossings[i, 0])
                    )
                    same_eta = abs(
                        zero.eta_or_x - crossings[i, 1]
                    ) <= STABILITY_CHANGE_SETTINGS.same_crossing_relative_distance * (
                        1 + abs(crossings[i, 1])
                    )
                    is_new = is_new and not (same_F and same_eta)
                if is_new:
                    crossings[n] = zero.p, zero.eta_or_x, zero.error_of_p
                    n += 1
    return crossings[:n]
