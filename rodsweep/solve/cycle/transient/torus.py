"""Whether a motion that has not settled is one that never will: a torus, on which it keeps two frequencies.

A torus surrounds a cycle whose largest multipliers are a complex pair outside the circle. The returns of the
motion to the section lie on a closed curve about the cycle's own, and go round it by the same angle on the
average: with k the number of a return, its bending moments are a Fourier series in k times that angle. The
series is fitted to the earlier returns and has to predict the later ones, so that it is no torus what grows,
decays or is irregular. The earlier ones have to fill the curve: an orbit that closes after several returns
leaves gaps, and so does a motion that is watched too briefly. An orbit that closes only after `CLOSEST`
returns or more cannot be told from a torus so.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ....arrays import Array
from ...point import Unsolvable
from ..accuracy.refinement import RefinedCycle, refined_cycle
from ..hopf_start import hopf_point_below, orbit_from_hopf
from ..status import CycleStatus
from .transient import Transient, TransientOutcome

HARMONICS = 6
"""Of the second frequency, in the returns: each was a fifth of the one before, 6e-4 are left of them all."""
CLOSEST = 16
"""The largest gap that the returns may leave on the closed curve is 1/CLOSEST of it: the series of 13 terms
is then determined by them, and an orbit that closes after fewer returns does not pass."""
PREDICTED = 0.05
"""Largest error of the predicted returns in units of their modulation, both rms: 7e-4 to 0.03 were seen on
tori, 0.11 where the modulation still grew."""
SETTLING = 1 / 3
"""Share of the returns, the first ones, that are not looked at."""
ANGLE, PERIOD = 0.3, 0.1
"""How far the angle of a return, rad, and its mean time, relative, may be from those of the cycle: they are
equal where the torus is born; 0.18 rad were seen far from there."""


@dataclass(frozen=True, slots=True)
class Modulation:
    """Of successive returns: the angle of one in rad, and what the prediction of the later ones is off."""

    angle: float
    error: float


def torus_or(end: TransientOutcome, transient: Transient) -> TransientOutcome:
    """What became of a motion: `end`, or the torus on which it is."""
    if end.status != CycleStatus.not_settled or end.found is not None:
        return end
    skipped = max(0, int(SETTLING * transient.waited) - (transient.waited - len(transient.past)))
    past = list(transient.past)[skipped:]
    if len(past) < 2 * CLOSEST:
        return end
    times, moments = np.array([when for when, _ in past]), np.array([state for _, state in past])
    for cycle in _unstable_cycles(transient):
        near = abs(np.ptp(times) / (len(times) - 1) / cycle.orbit.period - 1) <= PERIOD
        angle = pair_outside(cycle)
        modulation = modulation_of(moments, angle) if near and angle else None
        if modulation and modulation.error <= PREDICTED:
            why = (
                f"modulated with {modulation.angle / (2 * np.pi):.3f} of the return frequency; "
                f"the cycle there is unstable, multiplier {cycle.largest_multiplier:.3g}"
            )
            return TransientOutcome(CycleStatus.torus, why, end.periods, around=cycle)
    return end


def _unstable_cycles(transient: Transient) -> Iterator[RefinedCycle]:
    """That which was met on the way, and that on the branch from the Hopf point."""
    if transient.unstable is not None:
        yield transient.unstable
    try:
        hopf = hopf_point_below(transient.form.rod)
        if hopf is not None:
            start = orbit_from_hopf(transient.form, hopf, transient.workspace)
            yield refined_cycle(start, transient.accuracy, transient.workspace)
    except (Unsolvable, ArithmeticError, np.linalg.LinAlgError):
        return


def pair_outside(cycle: RefinedCycle) -> float | None:
    """The angle in (0, pi) of the one complex pair outside the circle; None if anything else is outside."""
    outside = cycle.multipliers[np.abs(cycle.multipliers) > 1 - cycle.margin]
    if cycle.stable is not False or len(outside) != 2 or abs(outside[0].imag) <= cycle.margin:
        return None
    return float(abs(np.angle(outside[0])))


def modulation_of(returns: Array, angle: float) -> Modulation | None:
    """How successive states, (k, n), go round a closed curve, by about `angle` rad each; None if they do not.

    The first half of them is fitted and has to predict the second.
    """
    half = len(returns) // 2
    numbers, fitted, later = np.arange(len(returns)), returns[:half], returns[half:]
    best = fitted_angle(fitted, angle)
    size = float(np.linalg.norm(later - later.mean(axis=0)))
    if size == 0 or largest_gap(best * numbers[:half]) > 2 * np.pi / CLOSEST:
        return None
    basis = fourier(best * numbers, HARMONICS)
    series = np.linalg.lstsq(basis[:half], fitted, rcond=None)[0]
    return Modulation(best, float(np.linalg.norm(later - basis[half:] @ series)) / size)


def fitted_angle(returns: Array, angle: float) -> float:
    """The angle of a return, rad, next to the given one whose multiples leave least of states (k, n)."""
    from scipy.optimize import minimize_scalar  # a tenth of a second of every start

    numbers = np.arange(len(returns))

    def left(at: float, harmonics: int) -> float:
        basis = fourier(at * numbers, harmonics)
        return float(np.linalg.norm(returns - basis @ np.linalg.lstsq(basis, returns, rcond=None)[0]))

    # One harmonic has a minimum 2 pi/k wide, m of them have one that is m times narrower.
    tried = np.linspace(angle - ANGLE, angle + ANGLE, int(4 * ANGLE * len(returns)) + 1)
    best = min(map(float, tried), key=lambda at: left(at, 1))
    for harmonics in range(1, HARMONICS + 1):
        reach = np.pi / (len(returns) * harmonics)
        bounds = (best - reach, best + reach)
        found = minimize_scalar(
            left, bounds=bounds, args=(harmonics,), method="bounded", options={"xatol": 1e-4 * reach}
        )
        best = float(found.x)
    return best


def fourier(phases: Array, harmonics: int) -> Array:
    """1 and the cosines and sines of the multiples of phases (k,), shape (k, 2 harmonics + 1)."""
    multiples = np.outer(phases, np.arange(1, harmonics + 1))
    return np.hstack([np.ones((len(phases), 1)), np.cos(multiples), np.sin(multiples)])


def largest_gap(phases: Array) -> float:
    """The largest distance between neighbours on the circle, rad, of phases (k,)."""
    around = np.sort(phases % (2 * np.pi))
    return float(np.diff(around, append=around[0] + 2 * np.pi).max())
