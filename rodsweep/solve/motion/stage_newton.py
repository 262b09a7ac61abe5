"""When Newton's method inside a stage of a time step stops, and when its matrix is made anew.

A C function that PETSc calls after every iteration, as those of `rodsweep.solve.motion.callbacks`.
"""

import numba
import numpy as np
from numba import types

from ..backend.c_functions import INT, POINTER, c_function, pointer, record_at
from .context import AT_ITERATE, CONTEXT

SLUGGISH = 0.3
"""Contraction from which a new matrix, made at the iterate, is worth its price."""
STAGNANT = 0.5
"""Contraction that shows rounding, where steps are small."""
DIVERGING, MOST_GROWING = 2.0, 2
"""Contraction that counts as growth; growths in a row that end an iteration (one asks for a new matrix)."""
FORGET = 0.3
"""Share of the remembered contraction that a new iteration must beat."""
ITERATING, STEP_SMALL, RESIDUAL_NAN, NOT_CONTRACTING = 0, 4, -4, -5
"""Values of SNESConvergedReason."""


@c_function(POINTER, INT, types.float64, types.float64, types.float64, POINTER, POINTER)
def newton_test(  # noqa: PLR0913, PLR0917 - PETSc's signature
    snes: int, iteration: int, x: float, dx: float, size: float, reason: int, context: int
) -> int:
    """Whether the error of a stage, contraction * last step, is small enough (Hairer & Wanner II, IV.8).

    The contraction is remembered from stage to stage, so that a good guess needs one iteration. It is
    measured from the second iteration on only: letting it decay after stages of one locks into wrong
    answers.
    """
    c = record_at(context, CONTEXT)
    answer = numba.carray(pointer(reason), (1,), np.int32)
    answer[0] = ITERATING
    if not np.isfinite(size) or not np.isfinite(dx):
        answer[0] = RESIDUAL_NAN
    elif iteration > 0:
        theta = dx / c.last_step if iteration > 1 and c.last_step > 0 else 0.0
        if iteration > 1:
            c.contraction = max(FORGET * c.contraction, theta)
        c.growing = c.growing + 1 if theta > DIVERGING else 0
        small = dx * min(1.0, c.contraction) <= c.small_error
        if small or (theta > STAGNANT and iteration > 2 and dx <= c.rounding):
            answer[0] = STEP_SMALL
        elif c.growing >= MOST_GROWING and iteration > 3:
            answer[0] = NOT_CONTRACTING
        elif theta > SLUGGISH:
            c.matrix_due = AT_ITERATE
        c.last_step = dx
    return 0
