"""Returns of the tip to the section theta = 0, theta rising, which most motions cross once per period.

A motion is integrated from return to return. A cycle is near where the states at returns repeat.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite, isnan
from operator import mul
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ....discretization.beam import Beam
from ....wording import counted
from ...motion.integrator import RunEnding, RunLimit, Trajectory


@dataclass(frozen=True, slots=True, kw_only=True)
class ReturnSettings:
    """Settings for the returns of the tip, by which a motion is classified."""

    straight_size: float = 1e-6
    """Norm of z below which a rod with a stable straight state is called straight, and norm of the bending
    and shear part of z below which a rod no longer swings. Smaller motions are governed by numerical
    damping."""
    same_return: float = 0.03
    """Largest relative distance of two returns at the same crossing of the orbit."""
    max_returns_per_period: int = 8
    """Maximum number of returns per period."""
    steps_per_run: int = 20_000
    """Maximum number of time steps in one run."""
    bisections: int = 50
    """Bisections of a time step for a crossing: all digits of the crossing time."""


RETURNS = ReturnSettings()


def angle_weights(beam: Beam) -> Array:
    """Row c, shape (unknowns,), with c z = theta of the tip."""
    return beam.layout.row({"m3": (beam.roots[2] * beam.mesh.quadrature)[:-1]})


def until_returns(row: Array, z: Array, wanted: int) -> RunLimit:
    """Limit that ends a run from z after `wanted` returns; row: `angle_weights`; both (unknowns,)."""
    count = 0
    last = float(row @ z)

    def enough(state: Array) -> bool:
        nonlocal count, last
        angle = float(row @ state)
        count += int(last < 0 <= angle)
        last = angle
        return count >= wanted

    return RunLimit(enough, RETURNS.steps_per_run)


class EarlyEnd(NamedTuple):
    """The end of a run before its limit: whether the rod has left the model, and the reason."""

    left_the_model: bool
    why: str


def early_end(beam: Beam, run: Trajectory, returns: int) -> EarlyEnd | None:
    """The early end of a run, `returns` returns after the start; None if the run is complete."""
    if run.ending in (RunEnding.reached, RunEnding.stopped):
        return None
    if run.ending == RunEnding.left_the_model:
        h1 = beam.least_stretch(run.states[-1])
        return EarlyEnd(True, f"h1 = {h1:.3g} somewhere, {returns} returns from the start")
    end = run.states[-1]
    if not run.message and np.isfinite(end).all() and not beam.is_convex(end):
        why = f"the energy of a section is not convex, {returns} returns from the start"
        return EarlyEnd(True, why)
    why = "the integrator finds no step of acceptable error"
    if run.ending == RunEnding.too_many_steps:
        why = "the integrator reached its maximum number of steps"
    return EarlyEnd(False, run.message or why)


def section_crossings(beam: Beam, run: Trajectory) -> tuple[Array, Array]:
    """Times, (k,), and states, (k, unknowns), of a run at which theta of the tip rises through 0.

    The cubic through two steps and their rates is interpolated.
    """
    row = angle_weights(beam)
    angle = run.states @ row
    times: list[float] = []
    states: list[Array] = []
    for k in np.nonzero((angle[:-1] < 0) & (angle[1:] >= 0))[0]:
        h = run.times[k + 1] - run.times[k]
        ends = run.states[k : k + 2]
        cubic = np.concatenate((ends, h * beam.rate(ends)))
        angles = (cubic @ row).tolist()
        low = 0.0
        high = 1.0
        # Bisection of a scalar cubic: no step can leave the interval, and the full state is evaluated once.
        for _ in range(RETURNS.bisections):
            middle = (low + high) / 2
            if sum(map(mul, _hermite_weights(middle), angles)) < 0:
                low = middle
            else:
                high = middle
        times.append(run.times[k] + h * low)
        states.append(np.array(_hermite_weights(low)) @ cubic)
    return np.array(times), np.array(states).reshape(len(times), beam.layout.unknowns)


def _hermite_weights(x: float) -> tuple[float, float, float, float]:
    """Weights of two values and two slopes, at 0 and 1, in the value at x of the cubic through these data."""
    rest = 1 - x
    # Cubic Hermite basis on [0, 1].
    return rest * rest * (1 + 2 * x), x * x * (3 - 2 * x), x * rest * rest, -x * x * rest


def repetition(moments: Sequence[Array]) -> tuple[int, float]:
    """(m, relative distance) for the number of returns m after which the last state repeats best.

    moments: bending moments at returns of the tip, (nodes,) each. Bending moments are compared because the
    interpolation between steps has errors in the stiff components, 1e-2 at k1 = 1e7. Of several good matches
    the smallest m is taken.
    """
    size = np.linalg.norm(moments[-1])
    if size < RETURNS.straight_size:  # moments of this size are rounding errors, which do not repeat
        return 1, inf
    found = [(float(np.linalg.norm(moments[-1] - moments[-1 - m]) / size), m) for m in range(1, len(moments))]
    # The first repetition that is nearly as good as the best: multiples of a period repeat as well.
    enough = max(2 * min(found)[0], RETURNS.same_return)
    return next((m, distance) for distance, m in found if distance <= enough)


def why_not_settled(waited: int, returns: int, last: float) -> str:
    """The reason why a motion has not settled after the time of `waited` returns.

    returns: how many are known. last: relative distance of the last of them from an earlier one, not finite
    if there are too few, or if the motion has decayed.
    """
    if isfinite(last):
        return f"{waited} returns of the tip, the last at a relative distance of {last:.1e}"
    if isnan(last):
        return f"the tip passes theta = 0 {counted(returns, 'time')} in all, so that no period is seen"
    return "the deflection has decayed to rounding error, but the straight rod is not stable"
