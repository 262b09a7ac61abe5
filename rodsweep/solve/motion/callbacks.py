"""The rod's equations as C functions that PETSc calls without passing through Python.

numba compiles them (`cfunc`), ctypes hands them to libpetsc: with Python between, a Newton iteration of 5 us
takes 200. PETSc gives each of them one pointer, to the record `context.CONTEXT`; the memory behind it belongs
to a `Workspace`, which must outlive the TS.

The form is dz/dt - f(z) = 0, all of it implicit. An additive split does not pay: with the whole Jacobian of
the step implicit and only the rest explicit, the axial tension k1 Pi^2 still forces 500 to 1500 steps a
period.
"""

from collections.abc import Mapping

import numpy as np
from numba import types

from ...discretization.beam import Beam
from ...discretization.elements.mesh import Mesh
from ...discretization.state_layout import plane_layout
from ...discretization.stress.rates import rate, rate_jacobian
from ..backend.c_functions import POINTER, c_function, call, floats, integers, petsc_function, record_at
from ..backend.petsc import PETSc
from .context import (
    AT_BASE,
    AT_ITERATE,
    CONTENT,
    CONTEXT,
    HANDLES,
    MOST_STAGES,
    TAKEN,
    UP_TO_DATE,
    arrays_of,
    matrices_of,
    rod_of,
    roots_of,
)
from .petsc_calls import read_array, unread_array, unwrite_array, write_array
from .predictor import begin_step, points_of
from .stage_newton import newton_test, solve_stage
from .step_record import take_steps

MIDDLE = 0.5
"""Where in a step its matrix is made; methods of one stage have it at the start."""
_dense, _undense = petsc_function("MatDenseGetArray"), petsc_function("MatDenseRestoreArray")
_content = petsc_function("PetscObjectStateGet")


@c_function(POINTER, types.float64, POINTER, POINTER, POINTER, POINTER)
def residual(ts: int, t: float, U: int, Udot: int, R: int, context: int) -> int:
    """R = Udot - f(U), or Udot alone."""
    c = record_at(context, CONTEXT)
    n, at = c.unknowns, context + TAKEN
    taken = integers(at, 3)
    read_array(U, at)
    read_array(Udot, at + 8)
    write_array(R, at + 16)
    out, dot = floats(taken[2], n), floats(taken[1], n)
    c.time = t
    if c.without_rate:
        out[:] = dot
    else:
        rate(floats(taken[0], n), out, roots_of(c), rod_of(c), matrices_of(c))
        for i in range(n):
            out[i] = dot[i] - out[i]
    unread_array(U, at)
    unread_array(Udot, at + 8)
    unwrite_array(R, at + 16)
    return 0


@c_function(POINTER, types.float64, POINTER, POINTER, POINTER)
def no_explicit_part(ts: int, t: float, U: int, F: int, context: int) -> int:
    """F = 0: all of f is implicit.

    Without a right-hand side PETSc from 3.20 on takes the rod for a differential-algebraic system, and makes
    the first slope of each step by a Newton solve of its own.
    """
    c = record_at(context, CONTEXT)
    at = context + TAKEN
    write_array(F, at)
    floats(integers(at, 1)[0], c.unknowns)[:] = 0.0
    unwrite_array(F, at)
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
    untouched = c.made == B and c.content == taken[0]
    if c.matrix_due == UP_TO_DATE and c.shift == shift and untouched:
        return 0
    J = floats(c.jacobian, n * n).reshape(n, n)
    if c.matrix_due == AT_ITERATE:
        read_array(U, at)
        rate_jacobian(floats(taken[0], n), J, roots_of(c), rod_of(c), matrices_of(c))
        unread_array(U, at)
    elif c.matrix_due == AT_BASE:
        rate_jacobian(floats(c.base, n), J, roots_of(c), rod_of(c), matrices_of(c))
    _dense(B, at)
    M = floats(taken[0], n * n).reshape(n, n)
    M[:, :] = -J
    for i in range(n):
        M[i, i] += shift
    _undense(B, at)
    c.made = B
    _content(B, context + CONTENT)
    c.matrix_due, c.shift = UP_TO_DATE, shift
    c.factorisations += 1
    return 0


class Workspace:
    """The memory behind the callbacks of one TS; the rod in it may be changed, the mesh may not."""

    def __init__(self, mesh: Mesh) -> None:
        n = plane_layout(mesh.nodes).unknowns
        self.base = np.zeros(n)
        self._mesh = mesh  # PETSc's callbacks read its arrays by address: they must live as long
        self._arrays = mesh.matrices._asdict() | {
            "base": self.base,
            "jacobian": np.zeros((n, n)),
            "times": np.zeros(2 * MOST_STAGES),
            "states": np.zeros((2 * MOST_STAGES, n)),
            "points": points_of(""),
            "constant": np.zeros(n),
            "rates": np.zeros(n),
        }
        self._vectors = [PETSc.Vec().createSeq(n, comm=PETSc.COMM_SELF) for _ in range(2)]
        self.context = np.zeros((), CONTEXT)
        self._set({"nodes": mesh.nodes + 1, "unknowns": n, "matrix_due": AT_BASE})
        self._set({name: array.ctypes.data for name, array in self._arrays.items()})

    def _set(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            self.context[name] = value

    def prepare(self, beam: Beam, error: float, floor: float) -> None:
        """Takes the rod, and the error of a stage (rms) at which Newton's method stops, or may stagnate."""
        self._rod = arrays_of(beam)  # these, too, are read by address
        self._set({name: array.ctypes.data for name, array in self._rod.items()})
        self._set({"components": len(self._rod["tip_stress"])})
        root, rest = beam.layout.unknowns**0.5, np.zeros(beam.layout.unknowns)
        straight, pressed = beam.least_stretch(rest), beam.least_stretch(rest - 1)
        fresh = {"matrix_due": AT_BASE, "shift": 0.0, "last_step": 0.0, "contraction": 1.0, "measured": 0}
        self._set(fresh | dict.fromkeys(("growing", "stages", "steps", "left"), 0))
        self._set({"small_error": error * root, "rounding": floor * root})
        self.context["crushed"] = straight / (pressed - straight)  # h1 is affine in z1
        take_steps(self.context)

    def predict_as(self, variant: str) -> None:
        """Stages are extrapolated as is best for this variant of ARKIMEX, or not at all if it is unknown."""
        self._arrays["points"][:] = points_of(variant)

    def attach(self, ts: "PETSc.TS", matrix: "PETSc.Mat") -> None:
        """Gives the TS, whose options are set, its functions."""
        context, B, snes = self.context.ctypes.data, matrix.handle, ts.getSNES()
        if ts.getType() == "arkimex":
            call("TSSetRHSFunction", ts.handle, 0, no_explicit_part.address, context)
            self.predict_as(ts.getARKIMEXType())
            self.context["middle"] = MIDDLE
        call("TSSetIFunction", ts.handle, 0, residual.address, context)
        call("TSSetIJacobian", ts.handle, B, B, residual_jacobian.address, context)
        call("TSSetApplicationContext", ts.handle, context)
        call("TSSetPreStep", ts.handle, begin_step.address)
        if snes.getType() == "shell":
            self._solve_stages_of(ts, snes, matrix)
        else:
            call("SNESSetConvergenceTest", snes.handle, newton_test.address, context, 0)

    def _solve_stages_of(self, ts: "PETSc.TS", snes: "PETSc.SNES", matrix: "PETSc.Mat") -> None:
        ksp = snes.getKSP()
        ksp.setOperators(matrix)
        made = ts, matrix, ksp, *self._vectors
        self._set({name: made.handle for name, made in zip(HANDLES, made, strict=True)})
        self.context["most_iterations"] = snes.getTolerances()[3]
        call("SNESShellSetContext", snes.handle, self.context.ctypes.data)
        call("SNESShellSetSolve", snes.handle, solve_stage.address)

    def destroy(self) -> None:
        """Gives memory and PETSc objects back."""
        take_steps(self.context)
        for vector in self._vectors:
            vector.destroy()
