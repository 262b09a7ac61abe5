"""Returns of the tip: theta of the tip rises through 0, once in a period of most motions.

A motion is followed from return to return. A cycle is near where the states at its returns repeat.
"""

from collections.abc import Sequence
from math import inf
from operator import mul

import numpy as np

from ....arrays import Array
from ....discretization.beam import Beam
from ...motion.integrator import Ending, RunLimit, Trajectory

STRAIGHT_SIZE = 1e-6
"""Norm of z at which a rod that is stable when straight is called straight; of its part that bends and
shears, at which the rod no longer swings: numerical damping, not the rod, rules what is smaller."""
SAME_CROSSING = 0.03
"""Relative distance of two returns that are one and the same crossing of the orbit."""
LONGEST_ORBIT = 8
"""Returns to the section that one period may take."""
STEPS_PER_CHUNK = 20_000
CROSSING_BISECTIONS = 50


def angle_weights(beam: Beam) -> Array:
    """The row c, shape (unknowns,), with c z = theta of the tip."""
    return beam.layout.row({"m3": beam.mesh.quadrature[:-1]})


def until_returns(row: Array, z: Array, wanted: int) -> RunLimit:
    """Ends a run from z, (unknowns,), after so many returns; row: `angle_weights`, (unknowns,)."""
    count, last = 0, float(row @ z)

    def enough(state: Array) -> bool:
        nonlocal count, last
        here = float(row @ state)
        count, last = count + int(last < 0 <= here), here
        return count >= wanted

    return RunLimit(enough, STEPS_PER_CHUNK)


def trouble(beam: Beam, run: Trajectory, returns: int) -> str:
    """Why a run neither reached its end nor its limit, after so many returns from the start; else empty."""
    if run.ending in (Ending.reached, Ending.stopped):
        return ""
    if run.ending == Ending.left_the_model:
        return f"h1 = {beam.least_stretch(run.states[-1]):.3g} somewhere, {returns} returns from the start"
    return run.message or ("too many steps" if run.ending == Ending.too_many_steps else "no step succeeds")


def section_crossings(beam: Beam, run: Trajectory) -> tuple[Array, Array]:
    """Times, (k,), and states, (k, unknowns), at which theta of the tip rises through 0 between steps."""
    row = angle_weights(beam)
    angle = run.states @ row
    times: list[float] = []
    states: list[Array] = []
    for k in np.nonzero((angle[:-1] < 0) & (angle[1:] >= 0))[0]:
        h, ends = run.times[k + 1] - run.times[k], run.states[k : k + 2]
        cubic = np.concatenate((ends, h * beam.rate(ends)))
        angles = (cubic @ row).tolist()
        low, high = 0.0, 1.0
        for _ in range(CROSSING_BISECTIONS):
            middle = (low + high) / 2
            below = sum(map(mul, _hermite_weights(middle), angles)) < 0
            low, high = (middle, high) if below else (low, middle)
        times.append(run.times[k] + h * low)
        states.append(np.array(_hermite_weights(low)) @ cubic)
    return np.array(times), np.array(states).reshape(len(times), beam.layout.unknowns)


def _hermite_weights(x: float) -> tuple[float, float, float, float]:
    """Weights of values and slopes at 0 and 1 in the value of their cubic at x."""
    rest = 1 - x
    return rest * rest * (1 + 2 * x), x * x * (3 - 2 * x), x * rest * rest, -x * x * rest


def repetition(moments: Sequence[Array]) -> tuple[int, float]:
    """(m, relative distance): after how many returns the last of some states comes closest to itself.

    moments: the bending moments at returns of the tip, (nodes,) each. What the interpolation between two
    steps misses of the stiff components, 1e-2 at k1 = 1e7, is no distance.
    """
    size = np.linalg.norm(moments[-1])
    if size < STRAIGHT_SIZE:  # what is left of them is rounding, which repeats nothing
        return 1, inf
    found = [(float(np.linalg.norm(moments[-1] - moments[-1 - m]) / size), m) for m in range(1, len(moments))]
    enough = max(2 * min(found)[0], SAME_CROSSING)
    return next((m, distance) for distance, m in found if distance <= enough)
