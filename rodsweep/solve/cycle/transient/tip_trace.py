"""Path of the tip from the start of a motion to the end of its integration, interpolated between time steps.

Only position and velocity of the tip are recorded at each time step: six numbers instead of a state of
several hundred numbers. Cubic interpolation has errors ten times as large as the integrator's where a motion
decays and the time steps grow; quintic interpolation has smaller errors than the integrator.
"""

import numpy as np
from numpy.typing import NDArray

from ....arrays import Array
from ....discretization.explicit_system import ExplicitSystem
from ...motion.integrator import Trajectory

MAX_TIME_STEP_RATIO_FOR_QUINTIC = 8.0
"""A time step that is more than this number of times as long as a neighbouring step is interpolated by the
cubic polynomial: second derivatives from unequal steps multiply errors of the values by the squared ratio of
the steps. The integrator changes a step by a factor of at most 5, except a last step, which ends on time."""


class TipTrace:
    """Record of the tip's path: position and velocity at all time steps of the successive runs of one
    motion."""

    def __init__(self, system: ExplicitSystem) -> None:
        self.system = system
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
        tips = self.system.tip_coordinates(np.stack([z, relaxed]))
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
            np.concatenate(
                self.system.tip_position_and_velocity(states, self.system.state_derivative(states))
            )
        )

    def path_at_equidistant_times(self, count: int) -> Array:
        """Time in tau2, and x, y (in L) and theta of the tip, (4, count), at equidistant times from the start
        to the end of the last run."""
        times = np.linspace(0.0, self.run_times[-1][-1], count)
        starts = np.array([run[0] for run in self.run_times])
        run_indices = np.searchsorted(starts, times, side="right") - 1
        time_and_tip = np.empty((4, count))
        time_and_tip[0] = times
        for number, (step_times, tips) in enumerate(zip(self.run_times, self.run_tip_motions, strict=True)):
            is_in_run = run_indices == number
            if len(step_times) > 1 and is_in_run.any():
                time_and_tip[1:, is_in_run] = interpolated_between_steps(
                    step_times, tips[:3], tips[3:], times[is_in_run]
                )
            else:
                time_and_tip[1:, is_in_run] = tips[:3, :1]
        return time_and_tip


def interpolated_between_steps(steps: Array, values: Array, rates: Array, times: Array) -> Array:
    """Values at `times`, (m, k), by the quintic polynomial of each time step, which has the values, rates and
    second derivatives of its two ends; by the cubic polynomial for a run with a single step, and for a step
    that is more than MAX_TIME_STEP_RATIO_FOR_QUINTIC times as long as a neighbouring step.

    steps: times of the ends of the steps, increasing, (n,), n >= 2. values, rates: values and time
    derivatives at these times, (m, n). times: times between the first and the last of `steps`, (k,).
    """
    left_steps = np.clip(np.searchsorted(steps, times, side="right") - 1, 0, len(steps) - 2)
    h = steps[left_steps + 1] - steps[left_steps]
    x = (times - steps[left_steps]) / h
    ends = (
        values[:, left_steps],
        values[:, left_steps + 1],
        h * rates[:, left_steps],
        h * rates[:, left_steps + 1],
    )
    to_end = x**2 * (3 - 2 * x)
    cubic: Array = (1 - to_end) * ends[0] + to_end * ends[1] + x * (1 - x) * ((1 - x) * ends[2] - x * ends[3])
    if len(steps) < 3:
        return cubic
    # Neighbouring steps share their ends, so each second derivative is computed once.
    step_indices, inverse = np.unique(np.concatenate((left_steps, left_steps + 1)), return_inverse=True)
    second_derivatives = (
        _second_derivatives(steps, values, rates, step_indices)[:, inverse] * np.tile(h, 2) ** 2
    )
    increment = 6 * (ends[1] - ends[0])
    # The cubic polynomial lacks these parts of the second derivatives at the two ends.
    left_defect = second_derivatives[:, : len(times)] - (increment - 4 * ends[2] - 2 * ends[3])
    right_defect = second_derivatives[:, len(times) :] - (2 * ends[2] + 4 * ends[3] - increment)
    quintic = cubic + (x * (1 - x)) ** 2 / 2 * ((1 - x) * left_defect + x * right_defect)
    inner_steps = np.clip(np.stack((left_steps, left_steps + 1)), 1, len(steps) - 2)
    shortest = np.minimum(
        steps[inner_steps] - steps[inner_steps - 1], steps[inner_steps + 1] - steps[inner_steps]
    ).min(axis=0)
    return np.where(h <= MAX_TIME_STEP_RATIO_FOR_QUINTIC * shortest, quintic, cubic)


def _second_derivatives(
    steps: Array, values: Array, rates: Array, step_indices: NDArray[np.integer]
) -> Array:
    """Second derivatives at the times steps[step_indices], (m, used). The quintic polynomial for each time
    has the values and rates at this time and at its two neighbours (at an end of the run, the two nearest
    times).

    steps: increasing times, (n,), n >= 3. values, rates: values and time derivatives at these times, (m, n).
    step_indices: indices of the times at which the second derivatives are computed, (used,).
    """
    neighbours = np.clip(step_indices, 1, len(steps) - 2)[:, None] + np.array([-1, 0, 1])
    x = steps[neighbours] - steps[step_indices][:, None]
    # Scaled to at most 1, so that the powers up to the fifth are comparable.
    scale = np.abs(x).max(axis=1)
    x = (x / scale[:, None])[..., None]
    exponents = np.arange(6)
    matrices = np.concatenate((x**exponents, exponents * x ** np.maximum(exponents - 1, 0)), axis=1)
    data = np.concatenate((values[:, neighbours], rates[:, neighbours] * scale[:, None]), axis=2)
    coefficients = np.linalg.solve(matrices, data.transpose(1, 2, 0))
    second_derivatives: Array = 2 * coefficients[:, 2].T / scale**2
    return second_derivatives
