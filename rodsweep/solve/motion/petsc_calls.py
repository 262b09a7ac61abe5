"""Declarations of functions of PETSc (Vec, TS, SNES, KSP) and of the C library for calls from compiled code.

PETSc's functions return an error code, and exist in PETSc 3.18 and later.
"""

import ctypes
from typing import Any

from llvmlite import binding
from numba import types
from numba.core import typing

from ..backend.petsc_c_functions import ADDRESS_TYPE, PETSC_INT_TYPE, PETSC_LIBRARY

PETSC_ENUM_TYPE = types.int32


def _petsc_function(name: str, *arguments: Any) -> Any:
    """The libpetsc function `int name(arguments)` for compiled code. Compiled code that calls a function of
    this type can be cached on disk; code that calls a ctypes function cannot."""
    return _external_function(name, typing.signature(types.int32, *arguments))


def _external_function(name: str, signature: Any) -> Any:
    """The C function `name` for compiled code. signature: numba's signature of the function."""
    binding.add_symbol(name, ctypes.cast(getattr(PETSC_LIBRARY, name), ctypes.c_void_p).value)
    return types.ExternalFunction(name, signature)


get_dense_array = _petsc_function("MatDenseGetArray", ADDRESS_TYPE, ADDRESS_TYPE)
restore_dense_array = _petsc_function("MatDenseRestoreArray", ADDRESS_TYPE, ADDRESS_TYPE)
object_state_counter_of = _petsc_function("PetscObjectStateGet", ADDRESS_TYPE, ADDRESS_TYPE)
get_array_for_reading = _petsc_function("VecGetArrayRead", ADDRESS_TYPE, ADDRESS_TYPE)
restore_array_after_reading = _petsc_function("VecRestoreArrayRead", ADDRESS_TYPE, ADDRESS_TYPE)
get_array_for_writing = _petsc_function("VecGetArray", ADDRESS_TYPE, ADDRESS_TYPE)
restore_array_after_writing = _petsc_function("VecRestoreArray", ADDRESS_TYPE, ADDRESS_TYPE)

time_of = _petsc_function("TSGetTime", ADDRESS_TYPE, ADDRESS_TYPE)
time_step_of = _petsc_function("TSGetTimeStep", ADDRESS_TYPE, ADDRESS_TYPE)
solution_of = _petsc_function("TSGetSolution", ADDRESS_TYPE, ADDRESS_TYPE)
context_of_ts = _petsc_function("TSGetApplicationContext", ADDRESS_TYPE, ADDRESS_TYPE)

set_ts_converged_reason = _petsc_function("TSSetConvergedReason", ADDRESS_TYPE, PETSC_ENUM_TYPE)

context_of_snes = _petsc_function("SNESShellGetContext", ADDRESS_TYPE, ADDRESS_TYPE)
stage_residual = _petsc_function("SNESTSFormFunction", ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE)
stage_jacobian = _petsc_function(
    "SNESTSFormJacobian", ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE
)
right_hand_side_of = _petsc_function("SNESGetRhs", ADDRESS_TYPE, ADDRESS_TYPE)
set_snes_converged_reason = _petsc_function("SNESSetConvergedReason", ADDRESS_TYPE, PETSC_ENUM_TYPE)
set_iteration_number = _petsc_function("SNESSetIterationNumber", ADDRESS_TYPE, PETSC_INT_TYPE)

solve_linear_system = _petsc_function("KSPSolve", ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE)

reallocate_memory = _external_function("realloc", typing.signature(ADDRESS_TYPE, ADDRESS_TYPE, ADDRESS_TYPE))
free_memory = _external_function("free", typing.signature(types.void, ADDRESS_TYPE))
