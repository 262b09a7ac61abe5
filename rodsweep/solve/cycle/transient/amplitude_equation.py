"""Slow motions about the straight rod by their amplitude equation, which predicts where they go.

Per period they grow by g = g0 - c a^2 at amplitude a, with the exact linear growth g0, so that a cycle lies
at a*^2 = g0/c; c is measured where it shows in g, which near a* may be lost in the integrator's error. The
linear growth of a rod near a limit differs from that of the limit: what is measured is corrected by the
difference. What decays slowly is scaled down until it decays at the linear rate; what grows slowly, and the
faster the larger it is (c < 0), is scaled up.
"""

from math import isnan, nan

import numpy as np

from ....arrays import Array

SLOW_GROWTH = 0.2
"""Linear growth per period below which an amplitude is predicted rather than waited for."""
WELL_SHOWN = 10.0
"""What c must show in the growth, in units of the noise, to replace the c of a larger motion: a tenth of it
is noise then. In the noise itself c changes its sign."""
NEAR = 0.1
"""Relative distance from the predicted amplitude that is left to Newton's method."""
SHRINK, LARGEST_JUMP = 0.7, 4.0
"""The factor for what decays slowly (its inverse for what grows so), near enough to 1 to meet a cycle on the
way; the largest factor."""
LINEAR = 0.05
"""Relative distance from the linear decay rate and frequency at which a decaying rod is called straight."""


class AmplitudeEquation:
    """g = g0 - c |z|^2 of one rod, from the returns of its motion: times, (k,), and states, (k, unknowns).

    period: of the leading mode; linear_rate: g0 per time; excess: what the rod has of it more than the beam
    that is followed, both 1/tau2; noise: growth per period that the integrator may add.
    """

    def __init__(self, period: float, linear_rate: float, excess: float, noise: float) -> None:
        self.period, self.linear_rate, self.excess, self.noise = period, linear_rate, excess, noise
        self.bend = nan
        """c, once it has shown."""

    def growth(self, times: Array, states: Array) -> tuple[float, float]:
        """(growth of |z| over the last return, that of the leading mode), of the rod and not of the beam.

        times: (k,); states: (k, unknowns).
        """
        sizes, duration = np.linalg.norm(states[-2:], axis=1), float(times[-1] - times[-2])
        growth = float(np.log(sizes[1] / sizes[0]))
        return growth + self.excess * duration, self.linear_rate * duration

    def slow(self, times: Array, states: Array) -> bool:
        """Whether the motion is a slowly growing or decaying leading mode."""
        return max(map(abs, self.growth(times, states))) <= SLOW_GROWTH and self._in_time(times)

    def decays_as_linear(self, times: Array, states: Array) -> bool:
        """Whether the returns shrink steadily, at last as the leading mode does, or would but for noise."""
        growth, linear = self.growth(times, states)
        sizes, margin = np.linalg.norm(states, axis=1), LINEAR * abs(linear)
        falls = np.diff(np.log(sizes)) + self.excess * np.diff(times) < 0
        alike = bool(falls.all()) and abs(growth - linear) < margin
        faded = abs(self.bend) * sizes[-1] ** 2 < margin and growth - linear < margin + self.noise
        return linear < 0 and (alike or faded) and self._in_time(times)

    def decays_faster(self, times: Array, states: Array) -> bool:
        """Whether the motion decays faster than the leading mode, so that no cycle is near."""
        growth, linear = self.growth(times, states)
        known = self.bend > 0 and self.slow(times, states)
        return linear < 0 and growth < linear * (1 - SLOW_GROWTH) + (self.noise if known else 0)

    def jump(self, times: Array, states: Array) -> float | None:
        """The factor to where the growth should vanish, or towards it; None if that is here, or not known."""
        growth, linear = self.growth(times, states)
        if not self.slow(times, states):
            return None
        size = float(np.linalg.norm(states[-1]))
        here = (linear - growth) / size**2
        if abs(linear - growth) > self.noise * (1 if isnan(self.bend) else WELL_SHOWN):
            self.bend = here
        bend = here if isnan(self.bend) else self.bend
        if isnan(self.bend) and linear > 0:
            factor = LARGEST_JUMP  # too small to feel what bends its growth
        elif linear > 0 and bend > 0:
            factor = float(np.clip(np.sqrt(linear / bend) / size, 1 / LARGEST_JUMP, LARGEST_JUMP))
        elif linear > 0 or (bend < 0 and growth > self.noise):
            factor = 1 / SHRINK  # it grows the faster the larger it is
        elif bend > 0 or growth < -self.noise:
            factor = SHRINK
        else:
            return None
        return factor if abs(factor - 1) >= NEAR else None

    def _in_time(self, times: Array) -> bool:
        """Whether the tip returns as the leading mode does: elsewhere its growth predicts nothing."""
        return bool(abs((times[-1] - times[-2]) / self.period - 1) < LINEAR)
