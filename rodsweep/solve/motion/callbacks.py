"""The rod's equations as C functions that PETSc calls without passing through Python.

numba compiles them (`cfunc`), ctypes hands them to libpetsc: with Python between, a Newton iteration of 5 us
takes 200. PETSc gives each of them one pointer, to the table of addresses below; the memory behind it belongs
to a `Workspace`, which must outlive the TS.

The form is dz/dt - f(z) = 0, all of it implicit. An additive split does not pay: with the whole Jacobian of
the step implicit and only the rest explicit, the axial tension k1 Pi^2 still forces 500 to 1500 steps a
period.
"""

from typing import Any

import numba
import numpy as np
from numba import types
from numpy.typing import NDArray

from ...discretization.beam import Beam, Mesh
from ...discretization.body_frame import jacobian, rate
from ...model.compilation import compiled
from ..backend.c_functions import INT, POINTER, c_function, call, floats, integers, petsc_function, pointer
from ..backend.petsc import PETSc

Array = NDArray[np.float64]

# Slots of the table of addresses and sizes that every callback receives.
COEFFICIENTS, MATRICES, WEIGHTS, ORDER, UNKNOWNS, JACOBIAN, BASE, STATE, COUNTS, SCRATCH, FILLED = range(11)
SLOTS = 11
# Slots of STATE (floats): is the matrix out of date, and the shift it was made with; the last Newton step
# and the rate at which these shrink; the error that is small enough, and the largest that rounding leaves
# (2-norms); how many Newton steps in a row have grown.
STALE, SHIFT, LAST, CONTRACTION, ENOUGH, FLOOR, GROWING = range(7)
STATE_SLOTS = 7
# The integers of FILLED: the matrix that was last made here, and PETSc's number of its content, which rises
# with every change, PETSc's own included (from 3.20 on it scales the matrix in place for methods with an
# explicit first stage).
# Slots of COUNTS (integers).
RATES, JACOBIANS, FACTORS = range(3)

AT_BASE, AT_ITERATE = 1.0, 2.0
"""Values of STATE[STALE]: where the new matrix is to be made."""
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

_read, _unread = petsc_function("VecGetArrayRead"), petsc_function("VecRestoreArrayRead")
_write, _unwrite = petsc_function("VecGetArray"), petsc_function("VecRestoreArray")
_dense, _undense = petsc_function("MatDenseGetArray"), petsc_function("MatDenseRestoreArray")
_content = petsc_function("PetscObjectStateGet")


@compiled
def _beam(table: Any) -> Any:
    """(coefficients, matrices, weights) as `rodsweep.discretization.body_frame` takes them."""
    m = table[ORDER] + 1
    matrices = floats(table[MATRICES], 3 * m * m).reshape(3, m, m)
    return floats(table[COEFFICIENTS], 6), matrices, floats(table[WEIGHTS], m)


@c_function(POINTER, types.float64, POINTER, POINTER, POINTER, POINTER)
def residual(ts: int, t: float, U: int, Udot: int, R: int, context: int) -> int:
    """R = Udot - f(U)."""
    table = integers(context, SLOTS)
    c, d, w = _beam(table)
    n, at = table[UNKNOWNS], table[SCRATCH]
    arrays = integers(at, 3)
    _read(U, at)
    _read(Udot, at + 8)
    _write(R, at + 16)
    out, dot = floats(arrays[2], n), floats(arrays[1], n)
    rate(floats(arrays[0], n), out, c, d, w)
    for i in range(n):
        out[i] = dot[i] - out[i]
    _unread(U, at)
    _unread(Udot, at + 8)
    _unwrite(R, at + 16)
    integers(table[COUNTS], 3)[RATES] += 1
    return 0


@c_function(POINTER, types.float64, POINTER, POINTER, POINTER)
def no_explicit_part(ts: int, t: float, U: int, F: int, context: int) -> int:
    """F = 0: all of f is implicit.

    Without a right-hand side PETSc from 3.20 on takes the rod for a differential-algebraic system, and makes
    the first slope of each step by a Newton solve of its own.
    """
    table = integers(context, SLOTS)
    at = table[SCRATCH]
    _write(F, at)
    floats(integers(at, 1)[0], table[UNKNOWNS])[:] = 0.0
    _unwrite(F, at)
    return 0


@c_function(POINTER, types.float64, POINTER, POINTER, types.float64, POINTER, POINTER, POINTER)
def residual_jacobian(  # noqa: PLR0913, PLR0917
    ts: int, t: float, U: int, Udot: int, shift: float, A: int, B: int, context: int
) -> int:
    """shift - J, J made anew when STATE[STALE] says so; a B nobody touched keeps its factors in PETSc."""
    table = integers(context, SLOTS)
    state, counts = floats(table[STATE], STATE_SLOTS), integers(table[COUNTS], 3)
    n, at, filled = table[UNKNOWNS], table[SCRATCH], integers(table[FILLED], 2)
    _content(B, at)
    untouched = filled[0] == B and filled[1] == integers(at, 1)[0]
    if state[STALE] == 0 and state[SHIFT] == shift and untouched:
        return 0
    J = floats(table[JACOBIAN], n * n).reshape(n, n)
    if state[STALE] != 0:
        c, d, w = _beam(table)
        if state[STALE] == AT_ITERATE:
            _read(U, at)
            jacobian(floats(integers(at, 1)[0], n), J, c, d, w)
            _unread(U, at)
        else:
            jacobian(floats(table[BASE], n), J, c, d, w)
        counts[JACOBIANS] += 1
    _dense(B, at)
    M = floats(integers(at, 1)[0], n * n).reshape(n, n)
    M[:, :] = -J
    for i in range(n):
        M[i, i] += shift
    _undense(B, at)
    filled[0] = B
    _content(B, table[FILLED] + 8)
    state[STALE], state[SHIFT] = 0.0, shift
    counts[FACTORS] += 1
    return 0


@c_function(POINTER, INT, types.float64, types.float64, types.float64, POINTER, POINTER)
def newton_test(  # noqa: PLR0913, PLR0917
    snes: int, iteration: int, x: float, dx: float, size: float, reason: int, context: int
) -> int:
    """Whether the error of a stage, contraction * last step, is small enough (Hairer & Wanner II, IV.8).

    The contraction is remembered from stage to stage, so that a good guess needs one iteration. It is
    measured from the second iteration on only: letting it decay after stages of one locks into wrong
    answers.
    """
    table = integers(context, SLOTS)
    state, answer = floats(table[STATE], STATE_SLOTS), numba.carray(pointer(reason), (1,), np.int32)
    answer[0] = ITERATING
    if not np.isfinite(size) or not np.isfinite(dx):
        answer[0] = RESIDUAL_NAN
    elif iteration > 0:
        theta = dx / state[LAST] if iteration > 1 and state[LAST] > 0 else 0.0
        if iteration > 1:
            state[CONTRACTION] = max(FORGET * state[CONTRACTION], theta)
        state[GROWING] = state[GROWING] + 1 if theta > DIVERGING else 0.0
        small = dx * min(1.0, state[CONTRACTION]) <= state[ENOUGH]
        if small or (theta > STAGNANT and iteration > 2 and dx <= state[FLOOR]):
            answer[0] = STEP_SMALL
        elif state[GROWING] >= MOST_GROWING and iteration > 3:
            answer[0] = NOT_CONTRACTING
        elif theta > SLUGGISH:
            state[STALE] = AT_ITERATE
        state[LAST] = dx
    return 0


class Workspace:
    """The memory behind the callbacks of one TS; the rod in it may be changed, the mesh may not."""

    def __init__(self, mesh: Mesh) -> None:
        n = mesh.unknowns
        self.coefficients, self.base = np.zeros(6), np.zeros(n)
        self.state = np.array([AT_BASE, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
        self.counts = np.zeros(3, dtype=np.int64)
        self._jacobian, self._scratch = np.zeros((n, n)), np.zeros(3, dtype=np.int64)
        self._filled = np.zeros(2, dtype=np.int64)
        self._mesh = mesh
        self._table = np.zeros(SLOTS, dtype=np.int64)
        self._table[[ORDER, UNKNOWNS]] = mesh.order, n
        for slot, array in (
            (COEFFICIENTS, self.coefficients),
            (MATRICES, mesh.matrices),
            (WEIGHTS, mesh.weights),
            (JACOBIAN, self._jacobian),
            (BASE, self.base),
            (STATE, self.state),
            (COUNTS, self.counts),
            (SCRATCH, self._scratch),
            (FILLED, self._filled),
        ):
            self._table[slot] = array.ctypes.data

    def prepare(self, beam: Beam, error: float, floor: float) -> None:
        """Takes the rod, and the error of a stage (rms) at which Newton's method stops, or may stagnate."""
        root = beam.mesh.unknowns**0.5
        self.coefficients[:] = beam.coefficients
        self.state[:] = (AT_BASE, 0.0, 0.0, 1.0, error * root, floor * root, 0.0)

    def attach(self, ts: "PETSc.TS", matrix: "PETSc.Mat") -> None:
        """Gives the TS, whose type is set, its functions."""
        context, B = self._table.ctypes.data, matrix.handle
        if ts.getType() == "arkimex":
            call("TSSetRHSFunction", ts.handle, 0, no_explicit_part.address, context)
        call("TSSetIFunction", ts.handle, 0, residual.address, context)
        call("TSSetIJacobian", ts.handle, B, B, residual_jacobian.address, context)
        call("SNESSetConvergenceTest", ts.getSNES().handle, newton_test.address, context, 0)
