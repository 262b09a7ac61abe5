"""Newton's method inside a stage of a time step: the whole of it, as PETSc's SNESSHELL, or its test.

C functions that PETSc calls, as those of `rodsweep.solve.motion.callbacks`. PETSc's own Newton method, which
options may ask for, takes three times as long for an iteration: the rod's rate and its linear system are
cheap beside what it does between them.
"""

from typing import Any

import numba
import numpy as np
from numba import types

from ...arrays import Array
from ...discretization.stress.rates import rate
from ...model.compiled.compilation import compiled
from ..backend.c_functions import INT, POINTER, c_function, floats, integers, pointer, record_at
from .context import AT_ITERATE, CONTEXT, TAKEN, UP_TO_DATE, matrices_of, rod_of, roots_of
from .petsc_calls import (
    context_of_snes,
    read_array,
    right_side_of,
    set_iterations,
    set_reason,
    solve_linear,
    stage_matrix,
    stage_residual,
    step_of,
    unread_array,
    unwrite_array,
    write_array,
)
from .predictor import predict, remember

SLUGGISH = 0.3
"""Contraction from which a new matrix, made at the iterate, is worth its price."""
STAGNANT = 0.5
"""Contraction that shows rounding, where steps are small."""
DIVERGING, MOST_GROWING = 2.0, 2
"""Contraction that counts as growth; growths in a row that end an iteration (one asks for a new matrix)."""
FORGET = 0.3
"""Share of the remembered contraction that a new iteration must beat."""
UNSURE = 3.0
"""How much worse than remembered the first iteration of a stage may contract; with 1 errors double."""
ITERATING, STEP_SMALL, NOT_FINITE, NOT_CONTRACTING = 0, 4, -4, -5
"""Values of SNESConvergedReason."""


@compiled
def judged(c: Any, iteration: int, dx: float) -> int:
    """Whether the error of a stage, contraction * last step, is small enough (Hairer & Wanner II, IV.8).

    The contraction is remembered from stage to stage, so that a good guess needs one iteration. It is
    measured from the second iteration on only, and forgotten with each new step of a method of many stages:
    else stages of one iteration each, which measure nothing, would go on for ever with a value that once was
    small, and errors a hundred times too large.
    """
    if not np.isfinite(dx):
        return NOT_FINITE
    theta = dx / c.last_step if iteration > 1 and c.last_step > 0 else 0.0
    if iteration > 1:
        c.contraction = max(FORGET * c.contraction if c.measured else 0.0, theta)
        c.measured = 1
    c.growing = c.growing + 1 if theta > DIVERGING else 0
    c.last_step = dx
    unsure = UNSURE if iteration == 1 else 1.0
    small = dx * min(1.0, unsure * c.contraction) <= c.small_error
    if small or (theta > STAGNANT and iteration > 2 and dx <= c.rounding):
        return STEP_SMALL
    if c.growing >= MOST_GROWING and iteration > 3:
        return NOT_CONTRACTING
    if theta > SLUGGISH:
        c.matrix_due = AT_ITERATE
    return ITERATING


@c_function(POINTER, INT, types.float64, types.float64, types.float64, POINTER, POINTER)
def newton_test(  # noqa: PLR0913, PLR0917 - PETSc's signature
    snes: int, iteration: int, x: float, dx: float, size: float, reason: int, context: int
) -> int:
    """The test where Newton's method is PETSc's: called after every iteration."""
    c = record_at(context, CONTEXT)
    answer = numba.carray(pointer(reason), (1,), np.int32)
    answer[0] = ITERATING
    if not np.isfinite(size):
        answer[0] = NOT_FINITE
    elif iteration > 0:
        answer[0] = judged(c, iteration, dx)
    return 0


@compiled
def state_equation(c: Any, at: int, snes: int, X: int) -> None:
    """Learns from PETSc the stage's equation, shift x + constant - f(x) = 0, and its time.

    Whatever the method, the slope that it asks for is affine in x. So the residual without f at any x, and
    the shift, which comes with the matrix, tell all.
    """
    n, taken = c.unknowns, integers(at, 3)
    c.without_rate = 1
    c.error = stage_residual(snes, X, c.residual, c.ts)
    c.without_rate = 0
    c.error |= stage_matrix(snes, X, c.matrix, c.matrix, c.ts)
    read_array(X, at)
    read_array(c.residual, at + 8)
    x, residual, constant = floats(taken[0], n), floats(taken[1], n), floats(c.constant, n)
    for i in range(n):
        constant[i] = residual[i] - c.shift * x[i]
    unread_array(X, at)
    unread_array(c.residual, at + 8)
    right_side_of(snes, at)
    right_side = taken[0]
    if right_side:
        read_array(right_side, at)
        constant -= floats(taken[0], n)
        unread_array(right_side, at)


@compiled
def norm(x: Array) -> float:
    """2-norm of x, (unknowns,)."""
    total = 0.0
    for value in x:
        total += value * value
    return total**0.5


@compiled
def corrected(c: Any, at: int, X: int) -> float:
    """One iteration; the 2-norm of its step."""
    n, taken = c.unknowns, integers(at, 3)
    constant, f = floats(c.constant, n), floats(c.rates, n)
    write_array(X, at)
    write_array(c.residual, at + 8)
    x, residual = floats(taken[0], n), floats(taken[1], n)
    rate(x, f, roots_of(c), rod_of(c), matrices_of(c))
    for i in range(n):
        residual[i] = c.shift * x[i] + constant[i] - f[i]
    unwrite_array(c.residual, at + 8)
    c.error |= solve_linear(c.ksp, c.residual, c.correction)
    read_array(c.correction, at + 16)
    step = floats(taken[2], n)
    x -= step
    size = norm(step)
    unread_array(c.correction, at + 16)
    unwrite_array(X, at)
    return size


@c_function(POINTER, POINTER)
def solve_stage(snes: int, X: int) -> int:
    """Newton's method in one stage, from the predicted X; PETSc is told how it ended."""
    handed = np.empty(1, np.int64)
    context_of_snes(snes, handed.ctypes.data)
    context = handed[0]
    c, at = record_at(context, CONTEXT), context + TAKEN
    step_of(c.ts, at)
    if floats(at, 1)[0] != c.length:  # the step failed, and is made again
        c.length, c.stages = floats(at, 1)[0], 1
    state_equation(c, at, snes, X)
    write_array(X, at)
    predict(c, floats(integers(at, 1)[0], c.unknowns))
    unwrite_array(X, at)
    reason, iteration = ITERATING, 0
    while reason == ITERATING and not c.error:
        if c.matrix_due != UP_TO_DATE:
            c.error |= stage_matrix(snes, X, c.matrix, c.matrix, c.ts)
        iteration += 1
        reason = judged(c, iteration, corrected(c, at, X))
        if reason == ITERATING and iteration >= c.most_iterations:
            reason = NOT_CONTRACTING
    read_array(X, at)
    remember(c, floats(integers(at, 1)[0], c.unknowns))
    unread_array(X, at)
    set_iterations(snes, iteration)
    set_reason(snes, reason)
    return c.error
