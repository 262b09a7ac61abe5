"""The first guess of a stage: a polynomial in time through stages of the step under way and of the last.

PETSc's own guess is linear and thousands of tolerances off; this one is ten off, and spares every second
iteration of Newton's method. The stages of a method differ in what they miss of the motion, so that which of
them extrapolate each other well is a matter of its tableau: `time_scheme.POINTS`.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ..backend.c_functions import POINTER, c_function, floats, integers, record_at
from .context import AT_BASE, CONTEXT, MOST_POINTS, MOST_STAGES, TAKEN, states_of, times_of
from .petsc_calls import context_of_ts, read_array, solution_of, step_of, time_of, unread_array
from .time_scheme import POINTS

LARGEST_GROWTH = 2.0
"""Of the step, beyond which it is not extrapolated from the last one."""
NONE = -1


def points_of(variant: str) -> NDArray[np.int64]:
    """The points of all stages, (MOST_STAGES, MOST_POINTS), those of the last step with MOST_STAGES added.

    Filled up with NONE.
    """
    points = np.full((MOST_STAGES, MOST_POINTS), NONE)
    for stage, (this, last) in POINTS.get(variant, {}).items():
        known = [*this, *(MOST_STAGES + k for k in last)]
        points[stage, : len(known)] = known
    return points


@c_function(POINTER)
def begin_step(ts: int) -> int:
    """Before a step: what was under way is the past, and a new matrix is due, of the state half-way."""
    handed = np.empty(1, np.int64)
    context_of_ts(ts, handed.ctypes.data)
    context = handed[0]
    c, at = record_at(context, CONTEXT), context + TAKEN
    taken, real = integers(at, 3), floats(at, 3)
    times, states, base = times_of(c), states_of(c), floats(c.base, c.unknowns)
    last = c.current * MOST_STAGES
    c.current = 1 - c.current
    now = c.current * MOST_STAGES
    time_of(ts, at)
    times[now] = real[0]
    solution_of(ts, at)
    solution = taken[0]
    read_array(solution, at)
    states[now] = floats(taken[0], c.unknowns)
    unread_array(solution, at)
    step_of(ts, at)
    c.length = real[0]
    base[:] = states[now]
    if c.stages > 0:
        base += (states[now] - states[last]) * (c.middle * c.length / (times[now] - times[last]))
    c.steps, c.stages = min(c.stages, 1), 1
    c.matrix_due = AT_BASE
    if c.middle > 0:  # many stages, of which the first can measure how well the new matrix does
        c.contraction, c.measured = 1.0, 0
    return 0


@compiled
def extrapolate(points: NDArray[np.int64], times: Array, states: Array, t: float, out: Array) -> None:
    """The polynomial through states[points] at times[points], at time t, into out, (unknowns,)."""
    out[:] = 0.0
    for i in points:
        weight = 1.0
        for j in points:
            if j != i:
                weight *= (t - times[j]) / (times[i] - times[j])
        for k in range(len(out)):
            out[k] += weight * states[i, k]


@compiled
def predict(c: Any, guess: Array) -> None:
    """The stage at c.time into guess, (unknowns,), which is left as it is where nothing better is known."""
    if c.stages >= MOST_STAGES or not c.steps:
        return
    points = integers(c.points, MOST_STAGES * MOST_POINTS).reshape(MOST_STAGES, MOST_POINTS)[c.stages]
    points = points[: np.sum(points != NONE)]
    times, now = times_of(c), c.current * MOST_STAGES
    last = MOST_STAGES - now
    if len(points) and c.length <= LARGEST_GROWTH * (times[now] - times[last]):
        extrapolate((points + now) % (2 * MOST_STAGES), times, states_of(c), c.time, guess)


@compiled
def remember(c: Any, stage: Array) -> None:
    """A stage that was found, (unknowns,), at c.time."""
    if c.stages < MOST_STAGES:
        at = c.current * MOST_STAGES + c.stages
        times_of(c)[at] = c.time
        states_of(c)[at] = stage
        c.stages += 1
