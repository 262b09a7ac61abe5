"""Amplitude equation of slow motions about the straight rod, which predicts the final amplitude of a motion.

The logarithm of the amplitude a grows per return by g = g0 - c a^2, with the exact linear growth g0, so that
a cycle has the amplitude a* = sqrt(g0/c). The coefficient c is measured from a motion at amplitudes where c
a^2 exceeds the error of the integrator. For a limiting rod, such as a rod with k1 = inf, a nearby rod is
integrated; the measured growth is corrected by the difference of the two linear growth rates. A slowly
growing motion is scaled to the amplitude a*, or scaled up step by step if its growth increases with the
amplitude (c < 0). A slowly decaying motion is scaled down until the motion decays at the linear rate. For a
slow motion that approaches a cycle near a fold, the term -d a^4 is added.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan, nan

import numpy as np

from ....arrays import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class AmplitudeEquationSettings:
    """Settings for the prediction of the amplitude of a slowly growing motion."""

    max_slow_growth_per_return: float = 0.2
    """The final amplitude of a motion is predicted instead of integrated if the linear and the measured
    growth per return are at most this number in modulus."""
    min_cubic_growth_over_noise: float = 10.0
    """A new measurement of c in the growth g = g0 - c a^2, a: amplitude, replaces an earlier c if |c| a^2
    exceeds this number times the noise (`AmplitudeEquation.growth_error`), so that the noise is at most a
    tenth of c a^2. A c measured within the noise may have the wrong sign."""
    min_scaling_factor_change: float = 0.1
    """The state is not scaled if the factor to the predicted amplitude differs from 1 by less than this
    number, because Newton's method then converges from the state as it is."""
    decaying_state_scaling_factor: float = 0.7
    """Factor by which a slowly decaying motion is scaled; a growing motion whose growth increases with the
    amplitude (c < 0 in g = g0 - c a^2) is scaled by the inverse. The factor is close enough to 1 not to miss
    a cycle."""
    max_state_scaling_factor: float = 4.0
    """Largest factor by which a state is scaled in one jump; the smallest factor is the inverse."""
    min_returns_for_slow_limit: int = 10
    """Smallest number of returns from which c and d of the amplitude equation g = g0 - c |z|^2 - d |z|^4 of a
    slow motion are determined."""
    linear_decay_tolerance: float = 0.05
    """A decaying motion ends at the straight rod if its decay rate and period differ by less than this
    fraction from the decay rate and the period of the leading mode."""


AMPLITUDE_EQUATION_SETTINGS = AmplitudeEquationSettings()


class AmplitudeEquation:
    """Amplitude equation g = g0 - c |z|^2 of one rod, with c measured from returns of its motion. |z|: norm
    of the state z at a return of the tip to theta = 0.

    g: growth of ln |z| per return. g0: linear growth per return. period: period of the leading mode, in tau2.
    linear_growth_rate: exact linear growth rate of the rod, in 1/tau2. growth_excess: linear growth rate of
    the rod minus the linear growth rate of the integrated system, in 1/tau2. growth_error: growth per return
    that integration errors may add. Arguments of the methods: times of returns, (k,), and states z at the
    returns, (k, unknowns).
    """

    def __init__(
        self, period: float, linear_growth_rate: float, growth_excess: float, growth_error: float
    ) -> None:
        self.period = period
        self.linear_growth_rate = linear_growth_rate
        self.growth_excess = growth_excess
        self.growth_error = growth_error
        self.cubic_coefficient = nan
        """Coefficient c of the amplitude equation g = g0 - c |z|^2; NaN until c |z|^2 exceeds the noise in a
        measured growth."""

    def measured_and_linear_growth(self, times: Array, states: Array) -> tuple[float, float]:
        """Returns (growth, linear). growth: increase of ln |z|, z: state, over the last return, corrected
        from the integrated system to the rod. linear: increase by the linear growth rate over the same time.

        times: times of the returns, (k,). states: states at the returns, (k, unknowns).
        """
        sizes = np.linalg.norm(states[-2:], axis=1)
        duration = float(times[-1] - times[-2])
        growth = float(np.log(sizes[1] / sizes[0]))
        # The integrated system grows at a slightly different rate; `growth_excess` corrects the difference.
        return growth + self.growth_excess * duration, self.linear_growth_rate * duration

    def is_slow_mode(self, times: Array, states: Array) -> bool:
        """Whether a motion has the period of the leading mode, and both its growth of ln |z|, z: state, over
        the last return and the growth predicted by the linear rate are at most `max_slow_growth_per_return`
        in modulus. times: times of the returns, (k,). states: states at the returns, (k, unknowns)."""
        return max(
            map(abs, self.measured_and_linear_growth(times, states))
        ) <= AMPLITUDE_EQUATION_SETTINGS.max_slow_growth_per_return and self._has_period_of_mode(times)

    def decays_at_linear_rate(self, times: Array, states: Array) -> bool:
        """Whether a motion decays to the straight rod: the linear growth is negative, the last return took a
        period of the leading mode, and one of two conditions holds. First: c of the equation g = g0 - c |z|^2
        is not measured yet, the states shrink at every return, and the last growth equals the linear growth
        within `linear_decay_tolerance`. Second: |c| |z|^2 is below this tolerance with the measured c, and
        the last growth is not larger than the linear growth, within tolerance and noise. times: times of the
        returns, (k,). states: states z at the returns, (k, unknowns)."""
        growth, linear_growth = self.measured_and_linear_growth(times, states)
        sizes = np.linalg.norm(states, axis=1)
        tolerance = AMPLITUDE_EQUATION_SETTINGS.linear_decay_tolerance * abs(linear_growth)
        decreases = np.diff(np.log(sizes)) + self.growth_excess * np.diff(times) < 0
        # Where higher powers of |z| cancel c |z|^2, the rates agree although a cycle may lie at smaller |z|.
        is_linear = (
            isnan(self.cubic_coefficient)
            and bool(decreases.all())
            and abs(growth - linear_growth) < tolerance
        )
        # With a known c the deviation from the linear rate is |c| |z|^2, independent of the noise.
        is_small = (
            abs(self.cubic_coefficient) * sizes[-1] ** 2 < tolerance
            and growth - linear_growth < tolerance + self.growth_error
        )
        return linear_growth < 0 and (is_linear or is_small) and self._has_period_of_mode(times)

    def decays_no_slower_than_mode(self, times: Array, states: Array) -> bool:
        """Whether a motion decays at least (1 - `max_slow_growth_per_return`) times as fast as the leading
        mode, so that no cycle is near. Where c > 0 in the amplitude equation g = g0 - c |z|^2, the decay of a
        slow motion may be smaller by `growth_error`. times: times of the returns, (k,). states: states z at
        the returns, (k, unknowns)."""
        growth, linear_growth = self.measured_and_linear_growth(times, states)
        is_known = self.cubic_coefficient > 0 and self.is_slow_mode(times, states)
        return linear_growth < 0 and growth < linear_growth * (
            1 - AMPLITUDE_EQUATION_SETTINGS.max_slow_growth_per_return
        ) + (self.growth_error if is_known else 0)

    def scaling_factor_to_cycle(self, times: Array, states: Array) -> float | None:
        """Factor by which the state is to be scaled: to the predicted amplitude of the cycle, or by a fixed
        factor if no amplitude is predicted. Also measures c of the amplitude equation, if its contribution c
        |z|^2 to the growth exceeds the noise.

        None if the motion is not slow, if the factor is close to 1, or if the growth is within the noise.
        times: times of the returns, (k,). states: states at the returns, (k, unknowns).
        """
        growth, linear_growth = self.measured_and_linear_growth(times, states)
        if not self.is_slow_mode(times, states):
            return None
        amplitude = float(np.linalg.norm(states[-1]))
        # d|z|/dt = linear |z| - c |z|^3, so linear - growth = c |z|^2.
        cubic_coefficient = (linear_growth - growth) / amplitude**2
        if abs(linear_growth - growth) > self.growth_error * (
            1 if isnan(self.cubic_coefficient) else AMPLITUDE_EQUATION_SETTINGS.min_cubic_growth_over_noise
        ):
            self.cubic_coefficient = cubic_coefficient
        coefficient = cubic_coefficient if isnan(self.cubic_coefficient) else self.cubic_coefficient
        if isnan(self.cubic_coefficient) and linear_growth > 0:
            factor = (
                AMPLITUDE_EQUATION_SETTINGS.max_state_scaling_factor
            )  # c is within the noise at this small amplitude
        elif linear_growth > 0 and coefficient > 0:
            factor = float(
                np.clip(
                    # The amplitude at which linear = c |z|^2.
                    np.sqrt(linear_growth / coefficient) / amplitude,
                    1 / AMPLITUDE_EQUATION_SETTINGS.max_state_scaling_factor,
                    AMPLITUDE_EQUATION_SETTINGS.max_state_scaling_factor,
                )
            )
        elif linear_growth > 0 or (coefficient < 0 and growth > self.growth_error):
            # The growth increases with the amplitude.
            factor = 1 / AMPLITUDE_EQUATION_SETTINGS.decaying_state_scaling_factor
        elif coefficient > 0 or growth < -self.growth_error:
            factor = AMPLITUDE_EQUATION_SETTINGS.decaying_state_scaling_factor
        else:
            return None
        return factor if abs(factor - 1) >= AMPLITUDE_EQUATION_SETTINGS.min_scaling_factor_change else None

    def scaling_factor_to_slow_limit(self, returns: Sequence[tuple[float, Array]]) -> float | None:
        """Factor from the last state to the stable cycle that a slow motion approaches, by the amplitude
        equation g = g0 - c |z|^2 - d |z|^4 (g: growth of ln |z| per return, z: bending moments) with c and d
        from all `returns`; None if the motion is not slow or has no such limit. Near a fold of a branch the
        motion takes thousands of returns.

        returns: time and bending moments, (nodes,), of each of the last returns.
        """
        if len(returns) < AMPLITUDE_EQUATION_SETTINGS.min_returns_for_slow_limit:
            return None
        times, states = (np.array(column) for column in zip(*returns, strict=True))
        if not self.is_slow_mode(times, states):
            return None
        sizes = np.linalg.norm(states, axis=1)
        linear = self.linear_growth_rate * np.diff(times)
        growth = np.diff(np.log(sizes)) + self.growth_excess * np.diff(times)
        # The product of both ends is |z|^2 in the middle of the return, to second order.
        squares = sizes[:-1] * sizes[1:]
        # Divided by |z|^2, the amplitude equation is a straight line in |z|^2.
        slope, offset = np.polyfit(squares, (growth - linear) / squares, 1)
        roots = np.roots([slope, offset, linear[-1]])
        limits = [
            float(root.real)
            for root in roots
            # The growth must decrease with the amplitude at the root, or the cycle there is unstable.
            if root.imag == 0 and root.real > 0 and offset + 2 * slope * root.real < 0
        ]
        factors = [float(np.sqrt(limit) / sizes[-1]) for limit in limits]
        most = AMPLITUDE_EQUATION_SETTINGS.max_state_scaling_factor
        return next((factor for factor in factors if 1 / most < factor < most), None)

    def _has_period_of_mode(self, times: Array) -> bool:
        """Whether the last return took as long as a period of the leading mode, within the fraction
        `linear_decay_tolerance`. times: times of the returns, (k,)."""
        return bool(
            abs((times[-1] - times[-2]) / self.period - 1)
            < AMPLITUDE_EQUATION_SETTINGS.linear_decay_tolerance
        )
