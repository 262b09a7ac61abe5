"""Recognition of quasiperiodic motions, which lie on a torus, have two frequencies and never repeat.

A torus surrounds a cycle whose largest multipliers are a complex pair outside the unit circle. The returns of
the motion to the Poincare section lie on a closed curve around the return of the cycle, and advance on this
curve by the same angle on average. The bending moments at the k-th return are therefore a Fourier series in k
times this angle. The series is fitted to the earlier returns and must predict the later returns, which
excludes growing, decaying and irregular motions. The earlier returns must fill the closed curve: a periodic
motion that closes after several returns leaves gaps, as does a short motion. A motion that closes after
`TORUS_TEST_SETTINGS.min_distinct_returns` or more returns cannot be distinguished from a torus.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import ceil

import numpy as np

from ....arrays import Array
from ...unsolvable import Unsolvable
from ..accuracy.refined_cycle import RefinedCycle
from ..accuracy.refinement import refined_cycle
from ..cycle_outcome import TransientOutcome
from ..hopf_start import hopf_point_below_force, orbit_from_hopf
from ..status import CycleStatus
from .transient_integration import TransientIntegration


@dataclass(frozen=True, slots=True, kw_only=True)
class TorusTestSettings:
    """Settings for the test whether a motion lies on a torus."""

    second_frequency_harmonic_count: int = 6
    """Number of harmonics of the second frequency in the fitted Fourier series. On the studied tori each
    harmonic was a fifth of the previous harmonic, and the sum of all harmonics beyond the sixth was 6e-4."""
    min_distinct_returns: int = 16
    """Smallest number of returns after which a motion on a torus may close: the returns must leave no gap
    larger than 1/`min_distinct_returns` of the closed curve. The returns then determine the 13 terms of the
    Fourier series."""
    max_prediction_error_per_modulation: float = 0.05
    """Largest rms error of the predicted returns on a torus, divided by the rms modulation. Errors of 7e-4 to
    0.03 were measured on tori, and 0.11 for a growing modulation."""
    skipped_return_fraction: float = 1 / 3
    """Fraction of the returns, counted from the start, that the test ignores, because the motion still
    approaches the torus."""
    max_angle_difference_from_multiplier: float = 0.3
    """Largest difference, in rad, between the angle per return on a torus and the argument of the cycle's
    complex multipliers. The difference is 0 at the torus point; 0.18 was observed far from this point."""
    trial_angles_per_minimum_width: int = 13
    """Number of trial angles per width of a minimum of the residual, before the best angle is refined. The
    width is 2 pi/k for k returns and one harmonic."""
    angle_tolerance_over_half_width: float = 1e-4
    """Tolerance of the fitted angle divided by half the width of the residual's minimum."""
    max_relative_period_difference: float = 0.1
    """Largest relative difference between the mean return time on a torus and the period of the cycle; the
    difference is 0 at the torus point."""


TORUS_TEST_SETTINGS = TorusTestSettings()


@dataclass(frozen=True, slots=True)
class TorusFrequency:
    """Second frequency of a quasiperiodic motion. angle_per_return: advance on the closed curve per return,
    in rad. prediction_error: relative rms error of the predicted returns."""

    angle_per_return: float
    prediction_error: float


def classify_quasiperiodic(outcome: TransientOutcome, transient: TransientIntegration) -> TransientOutcome:
    """An outcome with the status `torus` if the motion of `transient` is on a torus; otherwise the outcome
    `outcome` of this motion, unchanged."""
    if outcome.status != CycleStatus.not_settled or outcome.cycle is not None:
        return outcome
    # Only the last returns are stored, so some or all of the skipped returns may not be stored.
    skipped_count = max(
        0,
        int(TORUS_TEST_SETTINGS.skipped_return_fraction * transient.returns)
        - (transient.returns - len(transient.past_returns)),
    )
    past_returns = list(transient.past_returns)[skipped_count:]
    if len(past_returns) < 2 * TORUS_TEST_SETTINGS.min_distinct_returns:
        return outcome
    times = np.array([time for time, _ in past_returns])
    moments = np.array([moment for _, moment in past_returns])
    for cycle in _unstable_cycles(transient):
        is_near = (
            abs(np.ptp(times) / (len(times) - 1) / cycle.orbit.period - 1)
            <= TORUS_TEST_SETTINGS.max_relative_period_difference
        )
        angle = unstable_pair_angle(cycle)
        modulation = torus_frequency_of(moments, angle) if is_near and angle else None
        if (
            modulation
            and modulation.prediction_error <= TORUS_TEST_SETTINGS.max_prediction_error_per_modulation
        ):
            ratio = modulation.angle_per_return / (2 * np.pi)
            message = (
                f"the motion is modulated at {ratio:.3f} times the frequency of its oscillation; the "
                "unstable cycle inside the torus has a Floquet multiplier of modulus "
                f"{cycle.largest_multiplier_modulus:.3g}"
            )
            return TransientOutcome(
                CycleStatus.torus,
                message,
                outcome.return_count,
                unstable_cycle=cycle,
                modulation_ratio=ratio,
            )
    return outcome


def _unstable_cycles(transient: TransientIntegration) -> Iterator[RefinedCycle]:
    """Candidates for the unstable cycle inside a torus: a cycle found during the motion, then the cycle on
    the branch from the Hopf point below the force."""
    search = transient.search
    if search.unstable_cycle is not None:
        yield search.unstable_cycle
    try:
        hopf = hopf_point_below_force(transient.form.rod)
        if hopf is not None:
            start = orbit_from_hopf(transient.form, hopf, search.workspace)
            yield refined_cycle(start, search.accuracy, search.workspace)
    except (Unsolvable, ArithmeticError, np.linalg.LinAlgError):
        return


def unstable_pair_angle(cycle: RefinedCycle) -> float | None:
    """Argument, in (0, pi), of the complex pair of Floquet multipliers outside the unit circle; None unless
    this pair is the only instability of the cycle."""
    # Multipliers on the circle within their error count as outside, or a second instability could be missed.
    outer_multipliers = cycle.multipliers[
        np.abs(cycle.multipliers) > 1 - cycle.largest_multiplier_modulus_error
    ]
    if (
        cycle.is_stable is not False
        or len(outer_multipliers) != 2
        or abs(outer_multipliers[0].imag) <= cycle.largest_multiplier_modulus_error
    ):
        return None
    return float(abs(np.angle(outer_multipliers[0])))


def torus_frequency_of(return_states: Array, angle: float) -> TorusFrequency | None:
    """Torus frequency of a motion whose returns advance on a closed curve by about `angle` rad per return;
    None if the returns do not fill a closed curve. return_states: states at successive returns, (k, n).

    The Fourier series is fitted to the first half of the returns, and predicts the second half.
    """
    half = len(return_states) // 2
    numbers = np.arange(len(return_states))
    first_half = return_states[:half]
    second_half = return_states[half:]
    best_angle = fitted_angle_per_return(first_half, angle)
    modulation_size = float(np.linalg.norm(second_half - second_half.mean(axis=0)))
    if (
        modulation_size == 0
        or largest_phase_gap(best_angle * numbers[:half])
        > 2 * np.pi / TORUS_TEST_SETTINGS.min_distinct_returns
    ):
        return None
    basis = fourier_basis(best_angle * numbers, TORUS_TEST_SETTINGS.second_frequency_harmonic_count)
    # The series is fitted to the first half and tested on the second: a fit alone would explain any motion.
    series = np.linalg.lstsq(basis[:half], first_half, rcond=None)[0]
    return TorusFrequency(
        best_angle, float(np.linalg.norm(second_half - basis[half:] @ series)) / modulation_size
    )


def fitted_angle_per_return(return_states: Array, angle: float) -> float:
    """Angle per return, in rad, near `angle`, for which a Fourier series fits the returns best in the
    least-squares sense. return_states: states at successive returns, (k, n)."""
    from scipy.optimize import minimize_scalar  # slow import: 0.1 s, for few runs

    numbers = np.arange(len(return_states))

    def residual(trial_angle: float, harmonic_count: int) -> float:
        basis = fourier_basis(trial_angle * numbers, harmonic_count)
        return float(
            np.linalg.norm(return_states - basis @ np.linalg.lstsq(basis, return_states, rcond=None)[0])
        )

    # With one harmonic the minimum is 2 pi/k wide, with m harmonics 2 pi/(k m); k: number of returns.
    max_difference = TORUS_TEST_SETTINGS.max_angle_difference_from_multiplier
    minimum_width = 2 * np.pi / len(return_states)
    angle_count = ceil(
        2 * max_difference / minimum_width * TORUS_TEST_SETTINGS.trial_angles_per_minimum_width
    )
    trial_angles = angle + np.linspace(-max_difference, max_difference, angle_count + 1)
    best_angle = min(map(float, trial_angles), key=lambda at: residual(at, 1))
    # Every further harmonic narrows the minimum, so the search continues around the last one.
    for harmonics in range(1, TORUS_TEST_SETTINGS.second_frequency_harmonic_count + 1):
        half_width = np.pi / (len(return_states) * harmonics)
        bounds = (best_angle - half_width, best_angle + half_width)
        minimum = minimize_scalar(
            residual,
            bounds=bounds,
            args=(harmonics,),
            method="bounded",
            options={"xatol": TORUS_TEST_SETTINGS.angle_tolerance_over_half_width * half_width},
        )
        best_angle = float(minimum.x)
    return best_angle


def fourier_basis(phases: Array, harmonic_count: int) -> Array:
    """Matrix of Fourier terms at phases, (k,), in rad: 1, cosines and sines of the multiples up to
    `harmonic_count`, (k, 2 `harmonic_count` + 1)."""
    multiples = np.outer(phases, np.arange(1, harmonic_count + 1))
    return np.hstack([np.ones((len(phases), 1)), np.cos(multiples), np.sin(multiples)])


def largest_phase_gap(phases: Array) -> float:
    """Largest distance, in rad, between neighbouring phases on the unit circle. phases: (k,), in rad."""
    sorted_phases = np.sort(phases % (2 * np.pi))
    return float(np.diff(sorted_phases, append=sorted_phases[0] + 2 * np.pi).max())
