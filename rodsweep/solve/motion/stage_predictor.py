"""Prediction of a Runge-Kutta stage by a polynomial in time through stages of this step and of the last step.

PETSc's prediction is linear; its error is thousands of tolerances. The error of the polynomial is ten
tolerances, which saves every second Newton iteration. Stages of a method have different errors, so the best
extrapolation points depend on the method's tableau: `time_scheme.EXTRAPOLATION_POINTS`.
"""

from dataclasses import dataclass
from math import inf
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ..backend.petsc_c_functions import ADDRESS_TYPE, doubles_at, integers_at, petsc_callback, record_at
from .callback_context import (
    AT_BASE,
    CONTEXT_DTYPE,
    MAX_EXTRAPOLATION_POINTS,
    MAX_STORED_STAGES,
    OUTPUTS_OFFSET,
    stage_states_of,
    stage_times_of,
)
from .petsc_calls import (
    context_of_ts,
    get_array_for_reading,
    restore_array_after_reading,
    solution_of,
    time_of,
    time_step_of,
)
from .time_scheme import EXTRAPOLATION_POINTS


@dataclass(frozen=True, slots=True, kw_only=True)
class StagePredictorSettings(KernelConstants):
    """Settings for the prediction of Runge-Kutta stages and of the state at which Newton's matrix is
    assembled."""

    max_extrapolated_step_ratio: float = 2.0
    """Stages are extrapolated only if this step is at most `max_extrapolated_step_ratio` times as long as the
    last step. With 1, no growing step would be extrapolated: Newton's method would stop too early at PETSc's
    prediction, with errors of a motion five times as large."""
    matrix_time_fraction: float = 0.5
    """Time at which the state for Newton's matrix is predicted, as a fraction of the step. TS types other
    than arkimex take the state at the start of the step."""
    field_ranges: ClassVar = {"max_extrapolated_step_ratio": (1.0, inf)}
    """Exclusive bounds (lower, upper) of a field, by name of the field."""


STAGE_PREDICTOR_SETTINGS = StagePredictorSettings()

UNUSED_POINT = -1
"""Value of the unused entries in the array of extrapolation points."""


def extrapolation_points_of(arkimex_type: str) -> NDArray[np.int64]:
    """Indices of the stages through which each stage is extrapolated, for the ARKIMEX type `arkimex_type`,
    (MAX_STORED_STAGES, MAX_EXTRAPOLATION_POINTS); unused entries are UNUSED_POINT. Stage k of this step has
    the index k, stage k of the previous step the index MAX_STORED_STAGES + k."""
    points = np.full((MAX_STORED_STAGES, MAX_EXTRAPOLATION_POINTS), UNUSED_POINT)
    for stage, (current_stages, last_stages) in EXTRAPOLATION_POINTS.get(arkimex_type, {}).items():
        known_points = [*current_stages, *(MAX_STORED_STAGES + k for k in last_stages)]
        points[stage, : len(known_points)] = known_points
    return points


@petsc_callback(ADDRESS_TYPE)
def begin_step(ts: int) -> int:
    """PETSc's pre-step function: the stages stored for the finished step become the stages of the last step,
    and a new Newton matrix is requested, for arkimex at the predicted middle of the new step, for other TS
    types at its start."""
    address = np.empty(1, np.int64)
    context_of_ts(ts, address.ctypes.data)
    context = address[0]
    c = record_at(context, CONTEXT_DTYPE)
    scratch = context + OUTPUTS_OFFSET
    outputs = integers_at(scratch, 3)
    real = doubles_at(scratch, 3)
    times = stage_times_of(c)
    states = stage_states_of(c)
    base_state = doubles_at(c.base, c.unknowns)
    last = c.current * MAX_STORED_STAGES
    # The two halves of the array take turns: stages of this step and of the last step.
    c.current = 1 - c.current
    current = c.current * MAX_STORED_STAGES
    time_of(ts, scratch)
    times[current] = real[0]
    solution_of(ts, scratch)
    solution = outputs[0]
    get_array_for_reading(solution, scratch)
    states[current] = doubles_at(outputs[0], c.unknowns)
    restore_array_after_reading(solution, scratch)
    time_step_of(ts, scratch)
    c.length = real[0]
    base_state[:] = states[current]
    if c.stages > 0:
        # A matrix at the predicted middle of the step contracts better than a matrix at the start.
        base_state += (states[current] - states[last]) * (
            c.middle * c.length / (times[current] - times[last])
        )
    c.steps = min(c.stages, 1)
    c.stages = 1
    c.matrix_due = AT_BASE
    if c.middle > 0:  # a method of many stages, of which the first measures the contraction of the new matrix
        c.contraction = 1.0
        c.measured = 0
    return 0


@compiled
def extrapolate(points: NDArray[np.int64], times: Array, states: Array, t: float, out: Array) -> None:
    """Writes into `out`, (unknowns,), the value at time t of the Lagrange polynomial through `states[points]`
    at `times[points]`. points: indices, (k,). times: (m,). states: (m, unknowns)."""
    out[:] = 0.0
    for i in points:
        weight = 1.0
        for j in points:
            if j != i:
                weight *= (t - times[j]) / (times[i] - times[j])
        for k in range(len(out)):
            out[k] += weight * states[i, k]


@compiled
def predict_stage(c: Any, guess: Array) -> None:
    """Writes the predicted stage at time `c.time` into `guess`, (unknowns,); `guess` is unchanged if no
    extrapolation is possible. c: context record (`CONTEXT_DTYPE`)."""
    if c.stages >= MAX_STORED_STAGES or not c.steps:
        return
    points = integers_at(c.points, MAX_STORED_STAGES * MAX_EXTRAPOLATION_POINTS).reshape(
        MAX_STORED_STAGES, MAX_EXTRAPOLATION_POINTS
    )[c.stages]
    points = points[: np.sum(points != UNUSED_POINT)]
    times = stage_times_of(c)
    current = c.current * MAX_STORED_STAGES
    last = MAX_STORED_STAGES - current
    # Beyond this ratio the last step is too short to extrapolate from, and PETSc's guess is used.
    if len(points) and c.length <= STAGE_PREDICTOR_SETTINGS.max_extrapolated_step_ratio * (
        times[current] - times[last]
    ):
        # Indices start at the current half; indices of the last step are larger by MAX_STORED_STAGES, modulo
        # 2 MAX_STORED_STAGES.
        extrapolate((points + current) % (2 * MAX_STORED_STAGES), times, stage_states_of(c), c.time, guess)


@compiled
def store_stage(c: Any, stage: Array) -> None:
    """Stores the solved `stage`, (unknowns,), and its time `c.time` in the context record `c`, for later
    extrapolation; nothing is stored beyond MAX_STORED_STAGES stages."""
    if c.stages < MAX_STORED_STAGES:
        row = c.current * MAX_STORED_STAGES + c.stages
        stage_times_of(c)[row] = c.time
        stage_states_of(c)[row] = stage
        c.stages += 1
