"""Path of the tip from the start of a motion to the end of its integration, interpolated between time steps.

Only position and velocity of the tip are recorded at each time step: six numbers instead of a state of
several hundred numbers. Cubic interpolation has smaller errors than the integrator.
"""

import numpy as np

from ....arrays import Array
from ....discretization.beam import Beam
from ...motion.integrator import Trajectory


class TipTrace:
    """Record of the tip's path: position and velocity at all time steps of the successive runs of one
    motion."""

    def __init__(self, beam: Beam) -> None:
        self.beam = beam
        self.run_times: list[Array] = []
        self.run_tip_motions: list[Array] = []
        """For each run, x, y (in L) and theta of the tip, and their rates, (6, steps)."""

    is_full = False
    """Always False: the record has no maximum length."""

    def needs_more_motion(self, z: Array) -> bool:
        """Always False: unlike an animation, the path ends as soon as the outcome of the motion is known. z:
        state, (unknowns,)."""
        return False

    def begin_with_relaxation(self, z: Array, relaxed: Array, duration: float) -> None:
        """Records a straight line from the tip at the start state z to the tip at the state `relaxed`, both
        (unknowns,), over `duration`, in tau2.

        The relaxation rates, up to 1e10/tau2, are too large for cubic interpolation.
        """
        tips = self.beam.tip_coordinates(np.stack([z, relaxed]))
        slope = (tips[:, 1:] - tips[:, :1]) / duration
        self.run_times.append(np.array([0.0, duration]))
        self.run_tip_motions.append(np.concatenate([tips, np.repeat(slope, 2, axis=1)]))

    def add_run(self, run: Trajectory, clock: float) -> None:
        """Records the time steps of a run that begins at the time `clock`, in tau2."""
        # A run that left the model may end with a state that is not finite.
        finite = np.isfinite(run.states).all(axis=1)
        states = run.states[finite]
        self.run_times.append(clock + run.times[finite])
        self.run_tip_motions.append(
            np.concatenate(self.beam.tip_position_and_velocity(states, self.beam.state_derivative(states)))
        )

    def at_equal_times(self, count: int) -> Array:
        """Time in tau2, and x, y (in L) and theta of the tip, (4, count), at equidistant times from the start
        to the end of the last run."""
        from scipy.interpolate import CubicHermiteSpline  # slow import: 0.1 s, for few runs

        times = np.linspace(0.0, self.run_times[-1][-1], count)
        starts = np.array([run[0] for run in self.run_times])
        runs = np.searchsorted(starts, times, side="right") - 1
        out = np.empty((4, count))
        out[0] = times
        for number, (at, tips) in enumerate(zip(self.run_times, self.run_tip_motions, strict=True)):
            within = runs == number
            if len(at) > 1 and within.any():
                out[1:, within] = CubicHermiteSpline(at, tips[:3], tips[3:], axis=1)(times[within])
            else:
                out[1:, within] = tips[:3, :1]
        return out
