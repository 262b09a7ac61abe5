"""Amplitude equation of slow motions about the straight rod, which predicts their final amplitude.

The amplitude a grows per period by g = g0 - c a^2, with the exact linear growth g0, so that a cycle has the
amplitude a* = sqrt(g0/c). The coefficient c is measured where c a^2 exceeds the integrator's error, which it
may not near a*. A rod near a limit grows linearly at a slightly different rate than the rod in the limit; the
measured growth is corrected by the difference. A slowly decaying motion is scaled down until the motion
decays at the linear rate. A slowly growing motion with a growth that increases with the amplitude (c < 0) is
scaled up.
"""

from dataclasses import dataclass
from math import isnan, nan

import numpy as np

from ....arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class AmplitudeEquationSettings:
    """Settings for the prediction of the amplitude of a slowly growing motion."""

    slow_growth: float = 0.2
    """Linear growth per period below which the amplitude is predicted instead of integrated."""
    significant_growth: float = 10.0
    """Part of c in the growth, in units of the noise, at which a new c replaces the c of a larger motion. A
    tenth of the new c is noise then; a c measured within the noise may have the wrong sign."""
    near_amplitude: float = 0.1
    """Relative distance from the predicted amplitude within which Newton's method takes over."""
    shrink: float = 0.7
    """Factor on the state of a slowly decaying motion; the inverse applies to a growing motion. It is near
    enough to 1 not to jump over a cycle."""
    max_jump: float = 4.0
    """Largest factor on the state."""
    linear_tolerance: float = 0.05
    """Relative deviation from the linear decay rate and frequency up to which a rod is called straight."""


AMPLITUDE_EQUATION = AmplitudeEquationSettings()


class AmplitudeEquation:
    """g = g0 - c |z|^2 of one rod, from the returns of its motion: times, (k,), and states, (k, unknowns).

    period: period of the leading mode. linear_rate: g0 per time, 1/tau2. excess: linear growth rate of the
    rod minus that of the integrated beam, 1/tau2. noise: growth per period that the integrator may add.
    """

    def __init__(self, period: float, linear_rate: float, excess: float, noise: float) -> None:
        self.period = period
        self.linear_rate = linear_rate
        self.excess = excess
        self.noise = noise
        self.coefficient = nan
        """Coefficient c; NaN until the growth shows it."""

    def growth(self, times: Array, states: Array) -> tuple[float, float]:
        """(growth of |z| over the last return, linear growth over this time), of the rod, not of the beam.

        times: (k,); states: (k, unknowns).
        """
        sizes = np.linalg.norm(states[-2:], axis=1)
        duration = float(times[-1] - times[-2])
        growth = float(np.log(sizes[1] / sizes[0]))
        # The beam of a coarse mesh grows at a slightly different rate; the difference is taken out.
        return growth + self.excess * duration, self.linear_rate * duration

    def slow(self, times: Array, states: Array) -> bool:
        """Whether the motion is a slowly growing or decaying leading mode; arguments as of `growth`."""
        return max(
            map(abs, self.growth(times, states))
        ) <= AMPLITUDE_EQUATION.slow_growth and self._has_period_of_mode(times)

    def decays_as_linear(self, times: Array, states: Array) -> bool:
        """Whether the returns shrink steadily and the last as the leading mode, up to noise."""
        growth, linear = self.growth(times, states)
        sizes = np.linalg.norm(states, axis=1)
        margin = AMPLITUDE_EQUATION.linear_tolerance * abs(linear)
        falls = np.diff(np.log(sizes)) + self.excess * np.diff(times) < 0
        alike = bool(falls.all()) and abs(growth - linear) < margin
        # With a known c the distance from the linear rate is bounded by c |z|^2, whatever the noise.
        small = abs(self.coefficient) * sizes[-1] ** 2 < margin and growth - linear < margin + self.noise
        return linear < 0 and (alike or small) and self._has_period_of_mode(times)

    def decays_faster(self, times: Array, states: Array) -> bool:
        """Whether the motion decays faster than the leading mode; no cycle is near in this case."""
        growth, linear = self.growth(times, states)
        known = self.coefficient > 0 and self.slow(times, states)
        return linear < 0 and growth < linear * (1 - AMPLITUDE_EQUATION.slow_growth) + (
            self.noise if known else 0
        )

    def jump(self, times: Array, states: Array) -> float | None:
        """Factor on the state to the amplitude at which the growth vanishes, or towards this amplitude.

        None if the state has the right amplitude already, or if this amplitude is not known.
        """
        growth, linear = self.growth(times, states)
        if not self.slow(times, states):
            return None
        size = float(np.linalg.norm(states[-1]))
        # d|z|/dt = linear |z| - c |z|^3, so what the growth lacks is c |z|^2.
        measured = (linear - growth) / size**2
        if abs(linear - growth) > self.noise * (
            1 if isnan(self.coefficient) else AMPLITUDE_EQUATION.significant_growth
        ):
            self.coefficient = measured
        coefficient = measured if isnan(self.coefficient) else self.coefficient
        if isnan(self.coefficient) and linear > 0:
            factor = AMPLITUDE_EQUATION.max_jump  # at this small amplitude the growth does not show c
        elif linear > 0 and coefficient > 0:
            factor = float(
                np.clip(
                    # The amplitude at which linear = c |z|^2.
                    np.sqrt(linear / coefficient) / size,
                    1 / AMPLITUDE_EQUATION.max_jump,
                    AMPLITUDE_EQUATION.max_jump,
                )
            )
        elif linear > 0 or (coefficient < 0 and growth > self.noise):
            factor = 1 / AMPLITUDE_EQUATION.shrink  # the growth increases with the amplitude
        elif coefficient > 0 or growth < -self.noise:
            factor = AMPLITUDE_EQUATION.shrink
        else:
            return None
        return factor if abs(factor - 1) >= AMPLITUDE_EQUATION.near_amplitude else None

    def _has_period_of_mode(self, times: Array) -> bool:
        """Whether the return time is the leading mode's period; otherwise the growth predicts nothing."""
        return bool(abs((times[-1] - times[-2]) / self.period - 1) < AMPLITUDE_EQUATION.linear_tolerance)
