"""Changes of a rod's stability between two forces, from the leading eigenvalues at both.

Where the leading growth rate changes its sign a pair crosses the imaginary axis: D(0) = 1, so no eigenvalue
passes through 0. The eigenvalues on both sides are starts for Newton's method on D(i eta; F) = 0. Where the
two leading real eigenvalues are a pair at the next force, a double eigenvalue D = D_w = 0 lies between.
What opens and closes between two forces is not seen; the task thresholds proves that nothing is missing.
"""

from typing import NamedTuple

import numpy as np

from ..arrays import Array, Complex
from ..model.compiled.compilation import compiled
from ..model.rod import Coefficients
from .newton import crossing_newton, double_newton

SAME_CROSSING = 1e-8
"""Relative distance within which two zeros are one: Newton's method repeats itself to rounding."""


class ForceChange(NamedTuple):
    """A change of the rod between two forces, in the words of `rodsweep.results.layouts.thresholds`.

    F with the estimate of its absolute error, in k3/L^2; growth rate and frequency of the modes that change,
    in 1/tau2.
    """

    kind: str
    F: float
    error: float
    growth_rate: float
    frequency: float


RodsOverForce = tuple[Coefficients, Coefficients]
"""Rods along F: their coefficients at F = 0, and what these change by as F grows by 1."""


def onset_between(
    rods: RodsOverForce, ends: tuple[float, float], before: Complex, after: Complex
) -> ForceChange | None:
    """The double eigenvalue between two forces: two real leading ones before, (modes,), a pair behind.

    Their squared half difference passes through 0 about linearly. None where no double one lies there.
    """
    low, high = ends
    first, second, pair = before[0].item(), before[1].item(), after[0].item()  # Python's numbers, for speed
    gap, rise = ((first.real - second.real) / 2) ** 2, pair.imag**2
    guess = low + (high - low) * gap / (gap + rise)
    centre = ((first.real + second.real) / 2 + pair.real) / 2
    zero = double_newton(centre, guess, *rods, high - low)
    if not low <= zero.p <= high:
        return None
    return ForceChange("onset", zero.p, zero.error_of_p, zero.eta_or_x, 0.0)


def stability_change_between(
    rods: RodsOverForce, ends: tuple[float, float], before: Complex, after: Complex, unstable: int
) -> ForceChange | None:
    """The change between two forces, with the leading eigenvalues at each, (modes,).

    unstable: how many modes grow on the unstable side. None where the zeros of D found are not exactly as
    many as these ask for.
    """
    zeros = sorted(crossings_between(*ends, before, after, *rods).tolist())
    if not zeros or 2 * len(zeros) != unstable:
        return None
    destabilises = after[0].real > 0
    F, eta, error = zeros[0 if destabilises else -1]
    return ForceChange("hopf" if destabilises else "restabilization", F, error, 0.0, eta)


@compiled
def crossings_between(
    low: float, high: float, before: Complex, after: Complex, origin: Coefficients, direction: Coefficients
) -> Array:
    """(F, frequency, error of F) of the zeros of D(i eta; F) that Newton's method reaches, each once, (n, 3).

    It starts from the frequencies of all eigenvalues, (modes,), at both forces and at that where the chord of
    the leading growth rate crosses 0.
    """
    a, b = before[0].real, after[0].real
    chord = low + (high - low) * a / (a - b)
    found, n = np.empty((6 * len(before), 3)), 0
    for F in (chord, low, high):
        for eigenvalues in (before, after):
            for w in eigenvalues:
                if not w.imag > 0:
                    continue
                zero = crossing_newton(w.imag, F, origin, direction, (w.imag, max(abs(F), high - low)))
                if not low <= zero.p <= high:
                    continue
                is_new = True
                for i in range(n):
                    same_F = abs(zero.p - found[i, 0]) <= SAME_CROSSING * (1 + abs(found[i, 0]))
                    same_eta = abs(zero.eta_or_x - found[i, 1]) <= SAME_CROSSING * (1 + abs(found[i, 1]))
                    is_new = is_new and not (same_F and same_eta)
                if is_new:
                    found[n] = zero.p, zero.eta_or_x, zero.error_of_p
                    n += 1
    return found[:n]
