"""Path of the tip from the start of a motion to the end of its integration, from the integrator's steps.

Tip and velocity are kept for each step. Their cubics have errors below the integrator's own, and six numbers
replace a state of several hundred.
"""

import numpy as np

from ....arrays import Array
from ....discretization.beam import Beam
from ...motion.integrator import Trajectory


class TipTrace:
    """Tip and velocity at the steps of successive runs of one motion."""

    def __init__(self, beam: Beam) -> None:
        self.beam = beam
        self.times: list[Array] = []
        self.tips: list[Array] = []
        """Tip (x, y, theta) and velocity of each run, (6, steps)."""

    is_full = False
    """A path has any length."""

    def records_on(self, z: Array) -> bool:
        """Always False: unlike a moving picture, the path ends as soon as the outcome is known. z: state,
        (unknowns,).
        """
        return False

    def begin(self, z: Array, relaxed: Array, duration: float) -> None:
        """Adds a straight line between the tips of the start z and of its relaxed state, both (unknowns,).

        The relaxation rates, up to 1e10/tau2, are too large for a cubic.
        """
        tips = self.beam.tip(np.stack([z, relaxed]))
        slope = (tips[:, 1:] - tips[:, :1]) / duration
        self.times.append(np.array([0.0, duration]))
        self.tips.append(np.concatenate([tips, np.repeat(slope, 2, axis=1)]))

    def add(self, run: Trajectory, clock: float) -> None:
        """Adds a run that begins at the time `clock`, in tau2."""
        # A run that left the model may end with a state that is not finite.
        finite = np.isfinite(run.states).all(axis=1)
        states = run.states[finite]
        self.times.append(clock + run.times[finite])
        self.tips.append(np.concatenate(self.beam.tip_motion(states, self.beam.rate(states))))

    def at_equal_times(self, count: int) -> Array:
        """Time in tau2 and x, y, theta of the tip, (4, count), from the start to the end of the last run."""
        from scipy.interpolate import CubicHermiteSpline  # slow import: 0.1 s, for few runs

        times = np.linspace(0.0, self.times[-1][-1], count)
        starts = np.array([run[0] for run in self.times])
        runs = np.searchsorted(starts, times, side="right") - 1
        out = np.empty((4, count))
        out[0] = times
        for number, (at, tips) in enumerate(zip(self.times, self.tips, strict=True)):
            within = runs == number
            if len(at) > 1 and within.any():
                out[1:, within] = CubicHermiteSpline(at, tips[:3], tips[3:], axis=1)(times[within])
            else:
                out[1:, within] = tips[:3, :1]
        return out
