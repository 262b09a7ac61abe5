"""Prediction of a stage: a polynomial in time through stages of the present and the last step.

PETSc's own prediction is linear, with errors of thousands of tolerances. The polynomial has errors of ten
tolerances and saves every second Newton iteration. Stages of a method have different errors, so the best
extrapolation points depend on the method's tableau: `time_scheme.EXTRAPOLATION_POINTS`.
"""

from dataclasses import dataclass
from math import inf
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.compiled.settings import CompiledSettings
from ..backend.c_functions import POINTER, c_function, floats, integers, record_at
from .context import AT_BASE, CONTEXT, MAX_STAGE_POINTS, MAX_STAGES, OUTPUTS, states_of, times_of
from .petsc_calls import context_of_ts, read_array, release_read, solution_of, step_of, time_of
from .time_scheme import EXTRAPOLATION_POINTS


@dataclass(frozen=True, slots=True, kw_only=True)
class StagePredictorSettings(CompiledSettings):
    """Settings for the prediction of stages."""

    largest_step_ratio: float = 2.0
    """Largest ratio of a step and the last one for which stages are extrapolated. At 1 no growing step would
    be, and errors of a motion grow by a factor of five: Newton's method stops too early at PETSc's guess."""
    middle: float = 0.5
    """Time in a step at which the matrix is made, in units of the step; 0 for methods of a single stage."""
    ranges: ClassVar = {"largest_step_ratio": (1.0, inf)}


STAGE_PREDICTOR = StagePredictorSettings()

NO_POINT = -1
"""Entry of the points behind the last point of a stage."""


def points_of(variant: str) -> NDArray[np.int64]:
    """Extrapolation points of all stages, (MAX_STAGES, MAX_STAGE_POINTS), filled up with NO_POINT.

    Points of the last step have MAX_STAGES added.
    """
    points = np.full((MAX_STAGES, MAX_STAGE_POINTS), NO_POINT)
    for stage, (this, last) in EXTRAPOLATION_POINTS.get(variant, {}).items():
        known = [*this, *(MAX_STAGES + k for k in last)]
        points[stage, : len(known)] = known
    return points


@c_function(POINTER)
def begin_step(ts: int) -> int:
    """Before a step: the present step becomes the last one, and a matrix at the new middle becomes due."""
    address = np.empty(1, np.int64)
    context_of_ts(ts, address.ctypes.data)
    context = address[0]
    c = record_at(context, CONTEXT)
    at = context + OUTPUTS
    outputs = integers(at, 3)
    real = floats(at, 3)
    times = times_of(c)
    states = states_of(c)
    base = floats(c.base, c.unknowns)
    last = c.current * MAX_STAGES
    # Two halves of one memory take turns: this step's stages and the last one's.
    c.current = 1 - c.current
    now = c.current * MAX_STAGES
    time_of(ts, at)
    times[now] = real[0]
    solution_of(ts, at)
    solution = outputs[0]
    read_array(solution, at)
    states[now] = floats(outputs[0], c.unknowns)
    release_read(solution, at)
    step_of(ts, at)
    c.length = real[0]
    base[:] = states[now]
    if c.stages > 0:
        # A matrix at the predicted middle of the step contracts better at all stages than one at the start.
        base += (states[now] - states[last]) * (c.middle * c.length / (times[now] - times[last]))
    c.steps = min(c.stages, 1)
    c.stages = 1
    c.matrix_due = AT_BASE
    if c.middle > 0:  # a method of many stages, of which the first measures the contraction of the new matrix
        c.contraction = 1.0
        c.measured = 0
    return 0


@compiled
def extrapolate(points: NDArray[np.int64], times: Array, states: Array, t: float, out: Array) -> None:
    """Value at time t of the polynomial through states[points] at times[points], into out, (unknowns,)."""
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
    """Predicted stage at c.time into guess, (unknowns,); unchanged if no extrapolation is possible."""
    if c.stages >= MAX_STAGES or not c.steps:
        return
    points = integers(c.points, MAX_STAGES * MAX_STAGE_POINTS).reshape(MAX_STAGES, MAX_STAGE_POINTS)[c.stages]
    points = points[: np.sum(points != NO_POINT)]
    times = times_of(c)
    now = c.current * MAX_STAGES
    last = MAX_STAGES - now
    # Beyond this ratio the last step is too short to extrapolate from, and PETSc's own guess stays.
    if len(points) and c.length <= STAGE_PREDICTOR.largest_step_ratio * (times[now] - times[last]):
        # Points count from the present half; those of the last step are MAX_STAGES on, which the modulus
        # wraps.
        extrapolate((points + now) % (2 * MAX_STAGES), times, states_of(c), c.time, guess)


@compiled
def remember(c: Any, stage: Array) -> None:
    """Stores a solved stage, (unknowns,), at c.time."""
    if c.stages < MAX_STAGES:
        at = c.current * MAX_STAGES + c.stages
        times_of(c)[at] = c.time
        states_of(c)[at] = stage
        c.stages += 1
