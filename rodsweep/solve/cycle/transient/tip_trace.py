"""Path of the tip from the start of a motion to the end of its integration, interpolated between time steps.

Only position and velocity of the tip are recorded at each time step: six numbers instead of a state of
several hundred numbers. Cubic interpolation has errors ten times as large as the integrator's where a
motion decays and its steps grow; quintic interpolation has smaller errors than the integrator.
"""

import numpy as np

from ....arrays import Array
from ....discretization.beam import Beam
from ...motion.integrator import Trajectory

MAX_STEP_RATIO = 8.0
"""A time step that is longer than another step at one of its ends by more than this factor is interpolated by
the cubic polynomial: second derivatives from unequal steps multiply errors of the values by the squared
factor. The integrator changes a step by a factor of at most 5, except a last step, which ends on time."""


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
        times = np.linspace(0.0, self.run_times[-1][-1], count)
        starts = np.array([run[0] for run in self.run_times])
        runs = np.searchsorted(starts, times, side="right") - 1
        out = np.empty((4, count))
        out[0] = times
        for number, (at, tips) in enumerate(zip(self.run_times, self.run_tip_motions, strict=True)):
            within = runs == number
            if len(at) > 1 and within.any():
                out[1:, within] = interpolated_between_steps(at, tips[:3], tips[3:], times[within])
            else:
                out[1:, within] = tips[:3, :1]
        return out


def interpolated_between_steps(steps: Array, values: Array, rates: Array, times: Array) -> Array:
    """Values at `times`, (m, k), by the quintic polynomial of each time step, which has the values, rates and
    second derivatives of its two ends; by the cubic polynomial for a run with a single step, and for a step
    that is more than MAX_STEP_RATIO times as long as one beside it.

    steps: times of the ends of the steps, increasing, (n,), n >= 2. values, rates: at these times, (m, n).
    times: from the first to the last of `steps`, (k,).
    """
    left = np.clip(np.searchsorted(steps, times, side="right") - 1, 0, len(steps) - 2)
    h = steps[left + 1] - steps[left]
    x = (times - steps[left]) / h
    ends = (values[:, left], values[:, left + 1], h * rates[:, left], h * rates[:, left + 1])
    to_end = x**2 * (3 - 2 * x)
    cubic: Array = (1 - to_end) * ends[0] + to_end * ends[1] + x * (1 - x) * ((1 - x) * ends[2] - x * ends[3])
    if len(steps) < 3:
        return cubic
    used, where = np.unique(np.concatenate((left, left + 1)), return_inverse=True)
    second = _second_derivatives(steps, values, rates, used)[:, where] * np.tile(h, 2) ** 2
    rise = 6 * (ends[1] - ends[0])
    # The cubic polynomial lacks these parts of the second derivatives at the two ends.
    lacking_left = second[:, : len(times)] - (rise - 4 * ends[2] - 2 * ends[3])
    lacking_right = second[:, len(times) :] - (2 * ends[2] + 4 * ends[3] - rise)
    quintic = cubic + (x * (1 - x)) ** 2 / 2 * ((1 - x) * lacking_left + x * lacking_right)
    near = np.clip(np.stack((left, left + 1)), 1, len(steps) - 2)
    shortest = np.minimum(steps[near] - steps[near - 1], steps[near + 1] - steps[near]).min(axis=0)
    return np.where(h <= MAX_STEP_RATIO * shortest, quintic, cubic)


def _second_derivatives(steps: Array, values: Array, rates: Array, used: Array) -> Array:
    """Second derivatives at the times steps[used], (m, used), of the quintic polynomials through values and
    rates at each of these times and its two neighbours (at an end of the run, the two nearest times).

    steps: (n,), n >= 3. values, rates: (m, n). used: indices, (used,).
    """
    near = np.clip(used, 1, len(steps) - 2)[:, None] + np.array([-1, 0, 1])
    x = steps[near] - steps[used][:, None]
    scale = np.abs(x).max(axis=1)
    x = (x / scale[:, None])[..., None]
    powers = np.arange(6)
    matrices = np.concatenate((x**powers, powers * x ** np.maximum(powers - 1, 0)), axis=1)
    data = np.concatenate((values[:, near], rates[:, near] * scale[:, None]), axis=2)
    coefficients = np.linalg.solve(matrices, data.transpose(1, 2, 0))
    second: Array = 2 * coefficients[:, 2].T / scale**2
    return second
