"""Declarations of functions of PETSc (Vec, TS, SNES, KSP) and of the C library for calls from compiled code.

PETSc's functions return an error code, and exist in PETSc 3.18 and later.
"""

import ctypes
from typing import Any

from llvmlite import binding
from numba import types
from numba.core import typing

from ..backend.c_functions import INT, PETSC_LIBRARY, POINTER

PETSC_ENUM = types.int32


def _int_function(name: str, *arguments: Any) -> Any:
    """The libpetsc function `int name(arguments)` for compiled code. Compiled code that calls a function of
    this type can be cached on disk; code that calls a ctypes function cannot."""
    return _compiled_symbol(name, typing.signature(types.int32, *arguments))


def _compiled_symbol(name: str, signature: Any) -> Any:
    """The C function `name` for compiled code. signature: numba's signature of the function."""
    binding.add_symbol(name, ctypes.cast(getattr(PETSC_LIBRARY, name), ctypes.c_void_p).value)
    return types.ExternalFunction(name, signature)


get_dense_array = _int_function("MatDenseGetArray", POINTER, POINTER)
restore_dense_array = _int_function("MatDenseRestoreArray", POINTER, POINTER)
object_state_of = _int_function("PetscObjectStateGet", POINTER, POINTER)
get_array_for_reading = _int_function("VecGetArrayRead", POINTER, POINTER)
restore_array_after_reading = _int_function("VecRestoreArrayRead", POINTER, POINTER)
get_array_for_writing = _int_function("VecGetArray", POINTER, POINTER)
restore_array_after_writing = _int_function("VecRestoreArray", POINTER, POINTER)

time_of = _int_function("TSGetTime", POINTER, POINTER)
time_step_of = _int_function("TSGetTimeStep", POINTER, POINTER)
solution_of = _int_function("TSGetSolution", POINTER, POINTER)
context_of_ts = _int_function("TSGetApplicationContext", POINTER, POINTER)

set_ts_reason = _int_function("TSSetConvergedReason", POINTER, PETSC_ENUM)

context_of_snes = _int_function("SNESShellGetContext", POINTER, POINTER)
stage_residual = _int_function("SNESTSFormFunction", POINTER, POINTER, POINTER, POINTER)
stage_jacobian = _int_function("SNESTSFormJacobian", POINTER, POINTER, POINTER, POINTER, POINTER)
right_side_of = _int_function("SNESGetRhs", POINTER, POINTER)
set_snes_reason = _int_function("SNESSetConvergedReason", POINTER, PETSC_ENUM)
set_iteration_number = _int_function("SNESSetIterationNumber", POINTER, INT)

solve_linear = _int_function("KSPSolve", POINTER, POINTER, POINTER)

reallocate_memory = _compiled_symbol("realloc", typing.signature(POINTER, POINTER, POINTER))
free_memory = _compiled_symbol("free", typing.signature(types.void, POINTER))
