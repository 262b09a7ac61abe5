"""The rod's equations as C functions that PETSc calls without passing through Python.

numba compiles them (`cfunc`), ctypes hands them to libpetsc: with Python between, a Newton iteration of 5 us
takes 200. PETSc gives each of them one pointer, to the record `context.CONTEXT`; the memory behind it belongs
to a `Workspace`, which must outlive the TS.

The form is dz/dt - f(z) = 0, all of it implicit. An additive split does not pay: with the whole Jacobian of
the step implicit and only the rest explicit, the axial tension k1 Pi^2 still forces 500 to 1500 steps a
period.
"""

from typing import Any

import numpy as np
from numba import types

from ...discretization.beam import Beam, Mesh
from ...discretization.body_frame import BeamParameters, Element, jacobian, rate
from ...model.compilation import compiled
from ..backend.c_functions import POINTER, c_function, call, floats, integers, petsc_function, record_at
from ..backend.petsc import PETSc
from .context import AT_BASE, AT_ITERATE, CONTENT, CONTEXT, TAKEN, UP_TO_DATE
from .stage_newton import newton_test

_read, _unread = petsc_function("VecGetArrayRead"), petsc_function("VecRestoreArrayRead")
_write, _unwrite = petsc_function("VecGetArray"), petsc_function("VecRestoreArray")
_dense, _undense = petsc_function("MatDenseGetArray"), petsc_function("MatDenseRestoreArray")
_content = petsc_function("PetscObjectStateGet")


@compiled
def _parameters(c: Any) -> BeamParameters:
    return BeamParameters(c.F, c.nu, c.root_k1, c.root_k2, c.gamma1, c.gamma3)


@compiled
def _element(c: Any) -> Element:
    m = c.order + 1
    D, D_transposed = floats(c.D, m * m).reshape(m, m), floats(c.D_transposed, m * m).reshape(m, m)
    return Element(D, D_transposed, floats(c.weak_second, m * m).reshape(m, m), floats(c.weights, m))


@c_function(POINTER, types.float64, POINTER, POINTER, POINTER, POINTER)
def residual(ts: int, t: float, U: int, Udot: int, R: int, context: int) -> int:
    """R = Udot - f(U)."""
    c = record_at(context, CONTEXT)
    n, at = c.unknowns, context + TAKEN
    taken = integers(at, 3)
    _read(U, at)
    _read(Udot, at + 8)
    _write(R, at + 16)
    out, dot = floats(taken[2], n), floats(taken[1], n)
    rate(floats(taken[0], n), out, _parameters(c), _element(c))
    for i in range(n):
        out[i] = dot[i] - out[i]
    _unread(U, at)
    _unread(Udot, at + 8)
    _unwrite(R, at + 16)
    return 0


@c_function(POINTER, types.float64, POINTER, POINTER, POINTER)
def no_explicit_part(ts: int, t: float, U: int, F: int, context: int) -> int:
    """F = 0: all of f is implicit.

    Without a right-hand side PETSc from 3.20 on takes the rod for a differential-algebraic system, and makes
    the first slope of each step by a Newton solve of its own.
    """
    c = record_at(context, CONTEXT)
    at = context + TAKEN
    _write(F, at)
    floats(integers(at, 1)[0], c.unknowns)[:] = 0.0
    _unwrite(F, at)
    return 0


@c_function(POINTER, types.float64, POINTER, POINTER, types.float64, POINTER, POINTER, POINTER)
def residual_jacobian(  # noqa: PLR0913, PLR0917 - PETSc's signature
    ts: int, t: float, U: int, Udot: int, shift: float, A: int, B: int, context: int
) -> int:
    """shift - J, J made anew when `matrix_due` says so; a B nobody touched keeps its factors in PETSc."""
    c = record_at(context, CONTEXT)
    n, at = c.unknowns, context + TAKEN
    taken = integers(at, 1)
    _content(B, at)
    untouched = c.matrix == B and c.content == taken[0]
    if c.matrix_due == UP_TO_DATE and c.shift == shift and untouched:
        return 0
    J = floats(c.jacobian, n * n).reshape(n, n)
    if c.matrix_due == AT_ITERATE:
        _read(U, at)
        jacobian(floats(taken[0], n), J, _parameters(c), _element(c))
        _unread(U, at)
    elif c.matrix_due == AT_BASE:
        jacobian(floats(c.base, n), J, _parameters(c), _element(c))
    _dense(B, at)
    M = floats(taken[0], n * n).reshape(n, n)
    M[:, :] = -J
    for i in range(n):
        M[i, i] += shift
    _undense(B, at)
    c.matrix = B
    _content(B, context + CONTENT)
    c.matrix_due, c.shift = UP_TO_DATE, shift
    c.factorisations += 1
    return 0


class Workspace:
    """The memory behind the callbacks of one TS; the rod in it may be changed, the mesh may not."""

    def __init__(self, mesh: Mesh) -> None:
        n = mesh.unknowns
        self.base, self._jacobian = np.zeros(n), np.zeros((n, n))
        self._mesh = mesh  # PETSc's callbacks read its arrays by address: they must live as long
        self.context = np.zeros((), CONTEXT)
        self.context["order"], self.context["unknowns"] = mesh.order, n
        arrays = mesh.element._asdict() | {"jacobian": self._jacobian, "base": self.base}
        for name, array in arrays.items():
            self.context[name] = array.ctypes.data
        self.context["matrix_due"] = AT_BASE

    def prepare(self, beam: Beam, error: float, floor: float) -> None:
        """Takes the rod, and the error of a stage (rms) at which Newton's method stops, or may stagnate."""
        root = beam.mesh.unknowns**0.5
        values = beam.parameters._asdict() | {
            "matrix_due": AT_BASE,
            "shift": 0.0,
            "last_step": 0.0,
            "contraction": 1.0,
            "small_error": error * root,
            "rounding": floor * root,
            "growing": 0,
        }
        for name, value in values.items():
            self.context[name] = value

    def attach(self, ts: "PETSc.TS", matrix: "PETSc.Mat") -> None:
        """Gives the TS, whose type is set, its functions."""
        context, B = self.context.ctypes.data, matrix.handle
        if ts.getType() == "arkimex":
            call("TSSetRHSFunction", ts.handle, 0, no_explicit_part.address, context)
        call("TSSetIFunction", ts.handle, 0, residual.address, context)
        call("TSSetIJacobian", ts.handle, B, B, residual_jacobian.address, context)
        call("SNESSetConvergenceTest", ts.getSNES().handle, newton_test.address, context, 0)
