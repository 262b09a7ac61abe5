"""Connects compiled code with libpetsc: C callbacks compiled by numba, PETSc's functions for compiled code,
and arrays at memory addresses.

The module contains nothing about the rod.
"""

import ctypes
from collections.abc import Callable
from functools import partial
from typing import Any

import numba
import numpy as np
from numba import types
from numba.extending import intrinsic

from ...model.compiled.compilation import c_callback, compiled
from .petsc import PETSc

PETSC_LIBRARY = ctypes.CDLL(
    PETSc.__file__
)  # a module's symbols include those of the libraries it is linked to
ADDRESS_TYPE = types.intp
"""numba type of a memory address or of the handle of a PETSc object."""
PETSC_INT_TYPE = types.int32 if PETSc.IntType == np.int32 else types.int64
"""numba type of PetscInt, an integer argument of PETSc's functions."""


def petsc_callback(*arguments: Any) -> Callable[[Callable], Any]:
    """Decorator that compiles a function for calls from C. arguments: numba types of the function's
    arguments. The function must return PETSc's error code, 0 for success."""
    return partial(c_callback, signature=types.int32(*arguments))


@intrinsic
def as_void_pointer(context: Any, address: Any) -> Any:
    """Converts the integer `address` to a void pointer, in compiled code."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(types.voidptr))

    return types.voidptr(address), generate


@compiled
def doubles_at(address: int, size: int) -> Any:
    """View of the doubles at the memory address `address`, (size,)."""
    return numba.carray(as_void_pointer(address), (size,), np.float64)


@compiled
def double_array_at(address: int, shape: Any) -> Any:
    """View of the doubles at the memory address `address`, of the given `shape`. `doubles_at(...).reshape`
    would take as long as one evaluation of the rod's equations with ten nodes."""
    return numba.carray(as_void_pointer(address), shape, np.float64)


@compiled
def integers_at(address: int, size: int) -> Any:
    """View of the 64-bit integers at the memory address `address`, (size,)."""
    return numba.carray(as_void_pointer(address), (size,), np.int64)


@compiled
def record_at(address: int, dtype: Any) -> Any:
    """The record of NumPy type `dtype` at the address `address`; assignments write to this memory."""
    return numba.carray(as_void_pointer(address), (1,), dtype)[0]


def call_petsc(name: str, *arguments: int) -> None:
    """Calls the libpetsc function `name` with pointers `arguments`; raises RuntimeError for an error code."""
    if getattr(PETSC_LIBRARY, name)(*map(ctypes.c_void_p, arguments)):
        raise RuntimeError(f"the PETSc function {name} failed")
