"""Period and amplitude of a run, measured alike for every integrator.

The steps next to a return of the tip and next to the largest y are made again in small steps, so that an
error is that of the integration and not of an interpolant.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline

from ...arrays import Array
from ...discretization.beam import Beam
from ...solve.cycle.shooting import PERIOD_MAP, angle_weights
from ...solve.motion.integrator import RunLimit, Trajectory, integrator

SMALL_STEPS, DEGREE = 20, 7
"""Small steps about an event, and the degree of the spline through them."""
CORRECTIONS = 2
"""Newton steps from the spline's root to the event: the spline alone leaves 1e-8 rad."""
OVERSHOOT = 1.25
"""How far a step is made again, in units of it: its end is a little off and might miss the event."""


@dataclass(frozen=True, eq=False)
class Returns:
    """The returns of a run: theta of the tip rises through 0.

    times in tau2, (k,), states z, (k, unknowns); heights: the tip's largest y in L between two, (k - 1,).
    """

    times: Array
    states: Array
    heights: Array


def returns_of(beam: Beam, run: Trajectory) -> Returns:
    """All returns of a run."""
    row, y = angle_weights(beam), beam.tip(run.states)[1]
    angle = run.states @ row
    rising = np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0)).tolist()
    times, states, heights = [], [], []
    for k in rising:
        again = _again(beam, run.states[k], OVERSHOOT * (run.times[k + 1] - run.times[k]))
        when = float(_spline(again.times, again.states @ row).roots(extrapolate=False)[0])
        for _ in range(CORRECTIONS):
            there = _again(beam, run.states[k], when).states[-1]
            when -= float(row @ there) / float(row @ beam.rate(there))
        times.append(run.times[k] + when)
        states.append(_again(beam, run.states[k], when).states[-1])
    for first, last in pairwise(rising):
        k = first + int(np.argmax(y[first : last + 1]))
        again = _again(beam, run.states[k - 1], run.times[k + 1] - run.times[k - 1])
        height = _spline(again.times, beam.tip(again.states)[1])
        heights.append(height(height.derivative().roots(extrapolate=False)).max())
    return Returns(np.array(times), np.array(states), np.array(heights))


def _again(beam: Beam, z: Array, duration: float) -> Trajectory:
    """Equal small steps from a state of a run."""
    step = duration / SMALL_STEPS
    return integrator(beam.mesh, PERIOD_MAP).run(
        beam, z, duration, step, RunLimit(most_steps=SMALL_STEPS + 2)
    )


def _spline(times: Array, values: Array) -> PPoly:
    return PPoly.from_spline(make_interp_spline(times, values, DEGREE))
