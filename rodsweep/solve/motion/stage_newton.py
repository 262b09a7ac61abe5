"""Newton's method for a stage of a time step: the complete method as a SNESSHELL, or the stopping test of
PETSc's method.

PETSc calls the C functions as in `rodsweep.solve.motion.callbacks`. PETSc's Newton method, which options may
select, takes three times as long per iteration: evaluation of f and solution of the linear system are cheap
compared with PETSc's overhead.
"""

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numba import types

from ...arrays import Array
from ...discretization.stress.rates import write_rate
from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants
from ..backend.petsc_c_functions import (
    ADDRESS_TYPE,
    PETSC_INT_TYPE,
    as_void_pointer,
    doubles_at,
    integers_at,
    petsc_callback,
    record_at,
)
from .callback_context import (
    AT_BASE,
    AT_ITERATE,
    CONTEXT_DTYPE,
    MAX_STORED_STAGES,
    OUTPUTS_OFFSET,
    UP_TO_DATE,
    matrices_of,
    rod_of,
    sqrt_compliance_of,
    stage_states_of,
)
from .petsc_calls import (
    context_of_snes,
    get_array_for_reading,
    get_array_for_writing,
    restore_array_after_reading,
    restore_array_after_writing,
    right_hand_side_of,
    set_iteration_number,
    set_snes_converged_reason,
    solve_linear_system,
    stage_jacobian,
    stage_residual,
    time_step_of,
)
from .stage_predictor import predict_stage, store_stage


@dataclass(frozen=True, slots=True, kw_only=True)
class StageNewtonSettings(KernelConstants):
    """Settings of Newton's method for a stage. The contraction is the ratio of successive Newton steps."""

    min_contraction_for_new_matrix: float = 0.3
    """If the contraction exceeds this, a new matrix is computed at the current iterate."""
    min_stagnant_contraction: float = 0.5
    """If the contraction exceeds this and the step is rounding error, the iteration ends as converged."""
    min_contraction_of_growing_step: float = 2.0
    """A Newton step is growing if the contraction exceeds this."""
    max_growing_steps: int = 2
    """Number of successive growing Newton steps after which the iteration has failed."""
    min_new_over_stored_contraction: float = 0.3
    """Smallest ratio of the new contraction to the stored contraction, so that one exceptionally small step
    does not reduce the stored contraction too much."""
    first_iteration_safety_factor: float = 3.0
    """Safety factor on the stored contraction, from the previous stage, at the first iteration of a stage;
    with 1 the errors of a motion double."""
    iterations_before_giving_up: int = 3
    """Growing Newton steps end the iteration only after more than this number of iterations."""


STAGE_NEWTON_SETTINGS = StageNewtonSettings()

ITERATING, STEP_SMALL, NOT_FINITE, NOT_CONTRACTING = 0, 4, -4, -5
"""Values of PETSc's SNESConvergedReason."""


@compiled
def request_matrix_after_failed_stage(c: Any) -> None:
    """After a failed stage, requests that the matrix of the repeated, shorter step be evaluated at the start
    of the step. c: context record (`CONTEXT_DTYPE`). The last matrix may belong to a diverged iterate and
    have entries that are not finite; with such a matrix all shorter steps would fail."""
    doubles_at(c.base, c.unknowns)[:] = stage_states_of(c)[c.current * MAX_STORED_STAGES]
    c.matrix_due = AT_BASE


@compiled
def convergence_reason(c: Any, iteration: int, dx: float) -> int:
    """SNESConvergedReason after a Newton step of 2-norm `dx`. The error estimate is contraction * dx (Hairer
    & Wanner II, IV.8). Updates the contraction in the context record `c`, and requests a new matrix if the
    contraction is slow or the stage has failed. iteration: counted from 1.
    The contraction is stored from stage to stage, so that after a good prediction a single iteration is
    enough. The contraction is measured from the second iteration on, and reset at each new step of a method
    of many stages. Otherwise stages with a single iteration, which cannot measure the contraction, would
    reuse a small old contraction, with errors a hundred times too large."""
    if not np.isfinite(dx):
        request_matrix_after_failed_stage(c)
        return NOT_FINITE
    # The first iteration of a stage has no previous step.
    theta = dx / c.last_step if iteration > 1 and c.last_step > 0 else 0.0
    if iteration > 1:
        stored = c.contraction if c.measured else 0.0
        c.contraction = max(STAGE_NEWTON_SETTINGS.min_new_over_stored_contraction * stored, theta)
        c.measured = 1
    c.growing = c.growing + 1 if theta > STAGE_NEWTON_SETTINGS.min_contraction_of_growing_step else 0
    c.last_step = dx
    # The contraction of an earlier stage is a guess for this one.
    safety = STAGE_NEWTON_SETTINGS.first_iteration_safety_factor if iteration == 1 else 1.0
    is_small = dx * min(1.0, safety * c.contraction) <= c.small_error
    is_stagnant = theta > STAGE_NEWTON_SETTINGS.min_stagnant_contraction and iteration > 2
    if is_small or (is_stagnant and dx <= c.rounding):
        return STEP_SMALL
    may_give_up = iteration > STAGE_NEWTON_SETTINGS.iterations_before_giving_up
    if may_give_up and c.growing >= STAGE_NEWTON_SETTINGS.max_growing_steps:
        request_matrix_after_failed_stage(c)
        return NOT_CONTRACTING
    if theta > STAGE_NEWTON_SETTINGS.min_contraction_for_new_matrix:
        c.matrix_due = AT_ITERATE
    return ITERATING


@petsc_callback(
    ADDRESS_TYPE, PETSC_INT_TYPE, types.float64, types.float64, types.float64, ADDRESS_TYPE, ADDRESS_TYPE
)
def test_newton_convergence(  # noqa: PLR0913, PLR0917 - PETSc's signature
    snes: int, iteration: int, x: float, dx: float, size: float, reason: int, context: int
) -> int:
    """Stopping test for PETSc's Newton method, called after every iteration: writes the SNESConvergedReason
    to the address `reason`. iteration: their number. x: not used. dx, size: 2-norms of step and residual."""
    c = record_at(context, CONTEXT_DTYPE)
    reason_array = numba.carray(as_void_pointer(reason), (1,), np.int32)
    reason_array[0] = ITERATING
    if not np.isfinite(size):
        request_matrix_after_failed_stage(c)
        reason_array[0] = NOT_FINITE
    elif iteration > 0:
        reason_array[0] = convergence_reason(c, iteration, dx)
    return 0


@compiled
def read_stage_equation(c: Any, scratch: int, snes: int, X: int) -> None:
    """Determines the equation of a stage, shift x + constant - f(x) = 0, by calls of PETSc, and stores the
    constant and the shift in the context record `c`. scratch: address of scratch memory, into which PETSc
    writes the addresses of three arrays. snes: handle of the stage's solver. X: handle of a vector with any
    value of x.

    In every time scheme the slope dx/dt is affine in x. The residual without f at any x and the shift, which
    PETSc passes with the matrix, therefore determine the equation.
    """
    n = c.unknowns
    outputs = integers_at(scratch, 3)
    # Without f, PETSc's stage residual is affine in x: one evaluation yields its constant.
    c.without_rate = 1
    c.error = stage_residual(snes, X, c.residual, c.ts)
    c.without_rate = 0
    c.error |= stage_jacobian(snes, X, c.matrix, c.matrix, c.ts)
    get_array_for_reading(X, scratch)
    get_array_for_reading(c.residual, scratch + 8)
    x = doubles_at(outputs[0], n)
    residual = doubles_at(outputs[1], n)
    constant = doubles_at(c.constant, n)
    for i in range(n):
        constant[i] = residual[i] - c.shift * x[i]
    restore_array_after_reading(X, scratch)
    restore_array_after_reading(c.residual, scratch + 8)
    right_hand_side_of(snes, scratch)
    right_side = outputs[0]
    if right_side:
        get_array_for_reading(right_side, scratch)
        constant -= doubles_at(outputs[0], n)
        restore_array_after_reading(right_side, scratch)


@compiled
def euclidean_norm(x: Array) -> float:
    """2-norm of x, (unknowns,)."""
    total = 0.0
    for value in x:
        total += value * value
    return total**0.5


@compiled
def newton_step(c: Any, scratch: int, X: int) -> float:
    """Makes one Newton step from the stage X and writes the result to X; returns the 2-norm of the step. c:
    context record. scratch: address of scratch memory, into which PETSc writes the addresses of three arrays.
    X: handle of the stage's vector."""
    n = c.unknowns
    outputs = integers_at(scratch, 3)
    constant = doubles_at(c.constant, n)
    f = doubles_at(c.rates, n)
    get_array_for_writing(X, scratch)
    get_array_for_writing(c.residual, scratch + 8)
    x = doubles_at(outputs[0], n)
    residual = doubles_at(outputs[1], n)
    write_rate(x, f, sqrt_compliance_of(c), rod_of(c), matrices_of(c))
    for i in range(n):
        residual[i] = c.shift * x[i] + constant[i] - f[i]
    restore_array_after_writing(c.residual, scratch + 8)
    c.error |= solve_linear_system(c.ksp, c.residual, c.correction)
    get_array_for_reading(c.correction, scratch + 16)
    step = doubles_at(outputs[2], n)
    x -= step
    size = euclidean_norm(step)
    restore_array_after_reading(c.correction, scratch + 16)
    restore_array_after_writing(X, scratch)
    return size


@petsc_callback(ADDRESS_TYPE, ADDRESS_TYPE)
def solve_stage(snes: int, X: int) -> int:
    """Solves for the stage X by Newton's method from its prediction; sets reason and iterations in `snes`."""
    address = np.empty(1, np.int64)
    context_of_snes(snes, address.ctypes.data)
    context = address[0]
    c = record_at(context, CONTEXT_DTYPE)
    scratch = context + OUTPUTS_OFFSET
    time_step_of(c.ts, scratch)
    if doubles_at(scratch, 1)[0] != c.length:  # the step was rejected and is repeated with another length
        c.length = doubles_at(scratch, 1)[0]
        c.stages = 1
    read_stage_equation(c, scratch, snes, X)
    get_array_for_writing(X, scratch)
    predict_stage(c, doubles_at(integers_at(scratch, 1)[0], c.unknowns))
    restore_array_after_writing(X, scratch)
    reason = ITERATING
    iteration = 0
    while reason == ITERATING and not c.error:
        if c.matrix_due != UP_TO_DATE:
            c.error |= stage_jacobian(snes, X, c.matrix, c.matrix, c.ts)
        iteration += 1
        reason = convergence_reason(c, iteration, newton_step(c, scratch, X))
        if reason == ITERATING and iteration >= c.most_iterations:
            request_matrix_after_failed_stage(c)
            reason = NOT_CONTRACTING
    get_array_for_reading(X, scratch)
    store_stage(c, doubles_at(integers_at(scratch, 1)[0], c.unknowns))
    restore_array_after_reading(X, scratch)
    set_iteration_number(snes, iteration)
    set_snes_converged_reason(snes, reason)
    return c.error
