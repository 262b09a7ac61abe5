"""Equations of the rod as C functions that PETSc calls without Python.

numba compiles the functions (`cfunc`) and ctypes registers them in libpetsc: through Python, a Newton
iteration of 5 us would take 200 us. PETSc passes each function one pointer, to a record of type
`callback_context.CONTEXT_DTYPE`. The memory of this record belongs to a `CallbackWorkspace`, which must
outlive the TS.

The equation is dz/dt - f(z) = 0, fully implicit. An additive splitting is slower: even if the full Jacobian
of the step is implicit and only the remainder explicit, k1 Pi^2 forces 500 to 1500 steps per period.
"""

from collections.abc import Mapping

import numpy as np
from numba import types

from ...discretization.elements.mesh import Mesh
from ...discretization.explicit_system import ExplicitSystem
from ...discretization.state_layout import plane_layout
from ...discretization.stress.rates import write_rate, write_rate_jacobian
from ..backend.petsc import PETSc
from ..backend.petsc_c_functions import (
    ADDRESS_TYPE,
    call_petsc,
    doubles_at,
    integers_at,
    petsc_callback,
    record_at,
)
from .callback_context import (
    AT_BASE,
    AT_ITERATE,
    CONTEXT_DTYPE,
    MATRIX_STATE_OFFSET,
    MAX_STORED_STAGES,
    OUTPUTS_OFFSET,
    PETSC_HANDLE_FIELDS,
    UP_TO_DATE,
    matrices_of,
    rod_arrays_by_field,
    rod_of,
    sqrt_compliance_of,
)
from .petsc_calls import (
    get_array_for_reading,
    get_array_for_writing,
    get_dense_array,
    object_state_counter_of,
    restore_array_after_reading,
    restore_array_after_writing,
    restore_dense_array,
)
from .stage_newton import solve_stage, test_newton_convergence
from .stage_predictor import STAGE_PREDICTOR_SETTINGS, begin_step, extrapolation_points_of
from .step_record import pop_stored_steps


@petsc_callback(ADDRESS_TYPE, types.float64, ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE)
def residual(ts: int, t: float, U: int, Udot: int, R: int, context: int) -> int:
    """PETSc's implicit function R = Udot - f(U), or R = Udot if the context field `without_rate` is set. U,
    Udot, R: handles of vectors. context: address of the context record."""
    c = record_at(context, CONTEXT_DTYPE)
    n = c.unknowns
    scratch = context + OUTPUTS_OFFSET
    outputs = integers_at(scratch, 3)
    get_array_for_reading(U, scratch)
    get_array_for_reading(Udot, scratch + 8)
    get_array_for_writing(R, scratch + 16)
    out = doubles_at(outputs[2], n)
    dot = doubles_at(outputs[1], n)
    c.time = t
    if c.without_rate:
        out[:] = dot
    else:
        write_rate(doubles_at(outputs[0], n), out, sqrt_compliance_of(c), rod_of(c), matrices_of(c))
        for i in range(n):
            out[i] = dot[i] - out[i]
    restore_array_after_reading(U, scratch)
    restore_array_after_reading(Udot, scratch + 8)
    restore_array_after_writing(R, scratch + 16)
    return 0


@petsc_callback(ADDRESS_TYPE, types.float64, ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE)
def zero_explicit_part(ts: int, t: float, U: int, F: int, context: int) -> int:
    """PETSc's explicit right-hand side F = 0: all of f is implicit. Without this function, PETSc from 3.20 on
    treats the rod as a differential-algebraic system, with an additional Newton solve in each step."""
    c = record_at(context, CONTEXT_DTYPE)
    scratch = context + OUTPUTS_OFFSET
    get_array_for_writing(F, scratch)
    doubles_at(integers_at(scratch, 1)[0], c.unknowns)[:] = 0.0
    restore_array_after_writing(F, scratch)
    return 0


@petsc_callback(
    ADDRESS_TYPE,
    types.float64,
    ADDRESS_TYPE,
    ADDRESS_TYPE,
    types.float64,
    ADDRESS_TYPE,
    ADDRESS_TYPE,
    ADDRESS_TYPE,
)
def residual_jacobian(  # noqa: PLR0913, PLR0917 - PETSc's signature
    ts: int, t: float, U: int, Udot: int, shift: float, A: int, B: int, context: int
) -> int:
    """PETSc's matrix B = shift I - J, with J = df/dU at the state selected by `matrix_due` in the context.
    PETSc keeps the LU factors of an unchanged B."""
    c = record_at(context, CONTEXT_DTYPE)
    n = c.unknowns
    scratch = context + OUTPUTS_OFFSET
    outputs = integers_at(scratch, 1)
    object_state_counter_of(B, scratch)
    # PETSc may have scaled the matrix in place; its state counter shows every change.
    is_unchanged = c.last_matrix == B and c.matrix_state == outputs[0]
    if c.matrix_due == UP_TO_DATE and c.shift == shift and is_unchanged:
        return 0
    J = doubles_at(c.jacobian, n * n).reshape(n, n)
    # The Jacobian is the expensive part; if only the shift is new, the Jacobian is reused.
    if c.matrix_due == AT_ITERATE:
        get_array_for_reading(U, scratch)
        write_rate_jacobian(doubles_at(outputs[0], n), J, sqrt_compliance_of(c), rod_of(c), matrices_of(c))
        restore_array_after_reading(U, scratch)
    elif c.matrix_due == AT_BASE:
        write_rate_jacobian(doubles_at(c.base, n), J, sqrt_compliance_of(c), rod_of(c), matrices_of(c))
    get_dense_array(B, scratch)
    M = doubles_at(outputs[0], n * n).reshape(n, n)
    M[:, :] = -J
    for i in range(n):
        M[i, i] += shift
    restore_dense_array(B, scratch)
    c.last_matrix = B
    object_state_counter_of(B, context + MATRIX_STATE_OFFSET)
    c.matrix_due = UP_TO_DATE
    c.shift = shift
    c.factorisations += 1
    return 0


class CallbackWorkspace:
    """Arrays and context record used by the callbacks of one TS, for one mesh and any rod."""

    def __init__(self, mesh: Mesh) -> None:
        n = plane_layout(mesh.node_count).unknown_count
        self.base = np.zeros(n)
        self._mesh = mesh  # the callbacks read the mesh's arrays by address, so the mesh must stay alive
        self._arrays = mesh.node_matrices._asdict() | {
            "base": self.base,
            "jacobian": np.zeros((n, n)),
            "times": np.zeros(2 * MAX_STORED_STAGES),
            "states": np.zeros((2 * MAX_STORED_STAGES, n)),
            "points": extrapolation_points_of(""),
            "constant": np.zeros(n),
            "rates": np.zeros(n),
        }
        self._vectors = [PETSc.Vec().createSeq(n, comm=PETSc.COMM_SELF) for _ in range(2)]
        self.context = np.zeros((), CONTEXT_DTYPE)
        self._set_context_fields({"nodes": mesh.node_count + 1, "unknowns": n, "matrix_due": AT_BASE})
        self._set_context_fields({name: array.ctypes.data for name, array in self._arrays.items()})

    def _set_context_fields(self, values: Mapping[str, float]) -> None:
        """Sets fields of the context record; values: new values by name of the field."""
        for name, value in values.items():
            self.context[name] = value

    def set_rod_and_tolerances(self, system: ExplicitSystem, tolerance: float, rounding_size: float) -> None:
        """Sets the rod and the two tolerances of Newton's method, both rms values over the unknowns of a
        stage. tolerance: Newton's method stops when the estimated error of a stage is at most this.
        rounding_size: if the Newton steps stagnate below this size, the stagnation is attributed to rounding
        errors."""
        self._rod_arrays = rod_arrays_by_field(system)  # the callbacks read these arrays by address as well
        self._set_context_fields({name: array.ctypes.data for name, array in self._rod_arrays.items()})
        self._set_context_fields(
            {"components": len(self._rod_arrays["tip_stress"]), "law": system.nodal_rod.law_number}
        )
        self._set_context_fields({"jump_count": len(system.nodal_rod.jump_nodes)})
        # Steps are measured as 2-norms, errors as rms.
        norm_per_rms = system.layout.unknown_count**0.5
        initial_values = {
            "matrix_due": AT_BASE,
            "shift": 0.0,
            "last_step": 0.0,
            "contraction": 1.0,
            "measured": 0,
        }
        self._set_context_fields(initial_values | dict.fromkeys(("growing", "stages", "steps", "left"), 0))
        self._set_context_fields(
            {"small_error": tolerance * norm_per_rms, "rounding": rounding_size * norm_per_rms}
        )
        # Frees steps that an interrupted run has left.
        pop_stored_steps(self.context)

    def set_extrapolation_points(self, arkimex_type: str) -> None:
        """Sets, for each stage of the ARKIMEX type `arkimex_type`, the earlier stages from which it is
        extrapolated; none if `EXTRAPOLATION_POINTS` does not contain the type."""
        self._arrays["points"][:] = extrapolation_points_of(arkimex_type)

    def register_callbacks(self, ts: "PETSc.TS", matrix: "PETSc.Mat") -> None:
        """Registers the callbacks in `ts`, whose options must already be set. matrix: the matrix in which
        PETSc stores the Jacobian of a stage."""
        context = self.context.ctypes.data
        B = matrix.handle
        snes = ts.getSNES()
        if ts.getType() == "arkimex":
            # Without an explicit part PETSc 3.20 and newer would treat the problem as a DAE, with a separate
            # computation of the first slope.
            call_petsc("TSSetRHSFunction", ts.handle, 0, zero_explicit_part.address, context)
            self.set_extrapolation_points(ts.getARKIMEXType())
            self.context["middle"] = STAGE_PREDICTOR_SETTINGS.matrix_time_fraction
        call_petsc("TSSetIFunction", ts.handle, 0, residual.address, context)
        call_petsc("TSSetIJacobian", ts.handle, B, B, residual_jacobian.address, context)
        call_petsc("TSSetApplicationContext", ts.handle, context)
        call_petsc("TSSetPreStep", ts.handle, begin_step.address)
        if snes.getType() == "shell":
            self._register_stage_solver(ts, snes, matrix)
        else:
            call_petsc("SNESSetConvergenceTest", snes.handle, test_newton_convergence.address, context, 0)

    def _register_stage_solver(self, ts: "PETSc.TS", snes: "PETSc.SNES", matrix: "PETSc.Mat") -> None:
        """Registers `solve_stage` as the method of `snes`, a SNES of type shell."""
        ksp = snes.getKSP()
        ksp.setOperators(matrix)
        petsc_objects = ts, matrix, ksp, *self._vectors
        self._set_context_fields(
            {name: entry.handle for name, entry in zip(PETSC_HANDLE_FIELDS, petsc_objects, strict=True)}
        )
        self.context["most_iterations"] = snes.getTolerances()[3]
        call_petsc("SNESShellSetContext", snes.handle, self.context.ctypes.data)
        call_petsc("SNESShellSetSolve", snes.handle, solve_stage.address)

    def destroy(self) -> None:
        """Frees the stored steps and the PETSc vectors."""
        pop_stored_steps(self.context)
        for vector in self._vectors:
            vector.destroy()
