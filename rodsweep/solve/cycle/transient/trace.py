"""The tip's path from a start to where its motion is left, from the integrator's steps.

Kept of each step are the tip and its velocity, whose cubics have an error below the integrator's own; a state
is some hundred numbers, the tip with its velocity six.
"""

import numpy as np

from ....arrays import Array
from ....discretization.beam import TINY, Beam
from ...motion.integrator import Trajectory


class TipTrace:
    """Tip and velocity of one motion at the steps of its runs, which follow each other."""

    def __init__(self, beam: Beam) -> None:
        self.beam = beam
        self.times: list[Array] = []
        self.tips: list[Array] = []
        """Tip (x, y, theta) and velocity of each run, (6, steps)."""

    def begin(self, z: Array, relaxed: Array, duration: float) -> None:
        """The start z and the state it relaxes to, both (unknowns,): a straight line between their tips.

        Rates of what relaxes are so large, 1e10/tau2, that they say nothing of the way.
        """
        tips = self.beam.tip(np.stack([z, relaxed]))
        slope = (tips[:, 1:] - tips[:, :1]) / duration
        self.times.append(np.array([0.0, duration]))
        self.tips.append(np.concatenate([tips, np.repeat(slope, 2, axis=1)]))

    def add(self, run: Trajectory, clock: float) -> None:
        """The run that begins at the time clock, in tau2."""
        there = np.isfinite(run.states).all(axis=1)
        states = run.states[there]
        moved = states + 1j * TINY * self.beam.rate(states)
        tips = self.beam.tip(moved)
        self.times.append(clock + run.times[there])
        self.tips.append(np.concatenate([tips.real, tips.imag / TINY]))

    def at_equal_times(self, count: int) -> Array:
        """Time in tau2 and x, y, theta of the tip, (4, count), from the start to the end of the last run."""
        from scipy.interpolate import CubicHermiteSpline  # a tenth of a second of every start

        times = np.linspace(0.0, self.times[-1][-1], count)
        starts = np.array([run[0] for run in self.times])
        of = np.searchsorted(starts, times, side="right") - 1
        out = np.empty((4, count))
        out[0] = times
        for number, (at, tips) in enumerate(zip(self.times, self.tips, strict=True)):
            here = of == number
            if len(at) > 1 and here.any():
                out[1:, here] = CubicHermiteSpline(at, tips[:3], tips[3:], axis=1)(times[here])
            else:
                out[1:, here] = tips[:3, :1]
        return out
