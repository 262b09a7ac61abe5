"""Declarations of functions of PETSc (Vec, TS, SNES, KSP) and of the C library for calls from compiled code.

PETSc's functions return an error code, and exist in PETSc 3.18 and later.
"""

import ctypes
from typing import Any

from llvmlite import binding
from numba import types
from numba.core import typing

from ..backend.c_functions import INT, LIBRARY, POINTER

ENUM = types.int32


def _external(name: str, *arguments: Any) -> Any:
    """The libpetsc function `int name(arguments)` for compiled code. Compiled code that calls a function of
    this type can be cached on disk; code that calls a ctypes function cannot.
    """
    return _found(name, typing.signature(types.int32, *arguments))


def _found(name: str, signature: Any) -> Any:
    binding.add_symbol(name, ctypes.cast(getattr(LIBRARY, name), ctypes.c_void_p).value)
    return types.ExternalFunction(name, signature)


read_array = _external("VecGetArrayRead", POINTER, POINTER)
release_read = _external("VecRestoreArrayRead", POINTER, POINTER)
write_array = _external("VecGetArray", POINTER, POINTER)
release_write = _external("VecRestoreArray", POINTER, POINTER)

time_of = _external("TSGetTime", POINTER, POINTER)
step_of = _external("TSGetTimeStep", POINTER, POINTER)
solution_of = _external("TSGetSolution", POINTER, POINTER)
context_of_ts = _external("TSGetApplicationContext", POINTER, POINTER)

set_ts_reason = _external("TSSetConvergedReason", POINTER, ENUM)

context_of_snes = _external("SNESShellGetContext", POINTER, POINTER)
stage_residual = _external("SNESTSFormFunction", POINTER, POINTER, POINTER, POINTER)
stage_matrix = _external("SNESTSFormJacobian", POINTER, POINTER, POINTER, POINTER, POINTER)
right_side_of = _external("SNESGetRhs", POINTER, POINTER)
set_reason = _external("SNESSetConvergedReason", POINTER, ENUM)
set_iterations = _external("SNESSetIterationNumber", POINTER, INT)

solve_linear = _external("KSPSolve", POINTER, POINTER, POINTER)

resized_memory = _found("realloc", typing.signature(POINTER, POINTER, POINTER))
free_memory = _found("free", typing.signature(types.void, POINTER))
