"""Changes of a rod's stability between two forces, from the leading eigenvalues at both forces.

If the leading growth rate changes its sign, a pair crosses the imaginary axis: D(0) = 1, so no eigenvalue
passes through 0. The eigenvalues at both forces are starting points of Newton's method on D(i eta; F) = 0. If
the two leading eigenvalues are real at the first force and a pair at the next, a double eigenvalue
D = D_w = 0 lies between. Two changes between the same two forces may cancel and stay unnoticed; the task
`thresholds` proves completeness.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Complex
from ..model.compiled.compilation import compiled
from ..model.compiled.settings import CompiledSettings
from ..model.rod import Coefficients
from .roots.newton import crossing_newton, double_newton


@dataclass(frozen=True, slots=True, kw_only=True)
class StabilityChangeSettings(CompiledSettings):
    """Settings for crossings between two spectra."""

    same_crossing: float = 1e-8
    """Relative distance below which two zeros are equal, since Newton's method reaches rounding error."""


STABILITY_CHANGES = StabilityChangeSettings()


class ForceChange(NamedTuple):
    """A change of stability. `kind` is a word of `rodsweep.results.layouts.thresholds`.

    F, error: force of the change and its absolute error estimate, in k3/L^2. growth_rate, frequency: parts of
    the eigenvalues that change, in 1/tau2.
    """

    kind: str
    F: float
    error: float
    growth_rate: float
    frequency: float


RodsOverForce = tuple[Coefficients, Coefficients]
"""Rods along F: coefficients at F = 0, and their derivative with respect to F."""


def onset_between(
    rods: RodsOverForce, ends: tuple[float, float], before: Complex, after: Complex
) -> ForceChange | None:
    """The double eigenvalue between two forces; None if Newton's method finds none.

    ends: both forces. before, after: leading eigenvalues at both, (modes,); the two leading eigenvalues are
    real before and a pair after. The squared half difference of the two is almost linear in F and gives the
    starting point.
    """
    low, high = ends
    first = before[0].item()  # Python's numbers, for speed
    second = before[1].item()
    pair = after[0].item()
    gap = ((first.real - second.real) / 2) ** 2
    rise = pair.imag**2
    guess = low + (high - low) * gap / (gap + rise)
    centre = ((first.real + second.real) / 2 + pair.real) / 2
    zero = double_newton(centre, guess, *rods, high - low)
    if not low <= zero.p <= high:
        return None
    return ForceChange("onset", zero.p, zero.error_of_p, zero.eta_or_x, 0.0)


def stability_change_between(
    rods: RodsOverForce, ends: tuple[float, float], before: Complex, after: Complex, unstable: int
) -> ForceChange | None:
    """The loss or return of stability between two forces.

    ends: both forces. before, after: leading eigenvalues at both, (modes,). unstable: number of growing modes
    on the unstable side. None unless the number of crossings found, each a pair, explains `unstable`.
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
    """(F, frequency, error of F) of the distinct zeros of D(i eta; F) that Newton's method finds, (n, 3).

    before, after: eigenvalues at the forces low and high, (modes,). Starting points combine the frequencies
    of all eigenvalues with three forces: both ends, and the zero of the chord of the leading growth rate.
    """
    a = before[0].real
    b = after[0].real
    chord = low + (high - low) * a / (a - b)
    found = np.empty((3 * (len(before) + len(after)), 3))
    n = 0
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
                    same_F = abs(zero.p - found[i, 0]) <= STABILITY_CHANGES.same_crossing * (
                        1 + abs(found[i, 0])
                    )
                    same_eta = abs(zero.eta_or_x - found[i, 1]) <= STABILITY_CHANGES.same_crossing * (
                        1 + abs(found[i, 1])
                    )
                    is_new = is_new and not (same_F and same_eta)
                if is_new:
                    found[n] = zero.p, zero.eta_or_x, zero.error_of_p
                    n += 1
    return found[:n]
