"""Compiled code and libpetsc: C functions made by numba, C functions of PETSc for compiled code, memory by
address.

The module has no knowledge of the rod.
"""

import ctypes
from collections.abc import Callable
from functools import partial
from typing import Any

import numba
import numpy as np
from llvmlite import binding
from numba import types
from numba.core import typing
from numba.extending import intrinsic

from ...model.compiled.compilation import c_callback, compiled
from .petsc import PETSc

CALLED = (
    "VecGetArrayRead",
    "VecRestoreArrayRead",
    "VecGetArray",
    "VecRestoreArray",
    "MatDenseGetArray",
    "MatDenseRestoreArray",
    "PetscObjectStateGet",
)
"""Functions of PETSc that compiled code calls."""
LIBRARY = ctypes.CDLL(PETSc.__file__)  # a module's symbols include those of the libraries it is linked to
for _name in CALLED:
    binding.add_symbol(_name, ctypes.cast(getattr(LIBRARY, _name), ctypes.c_void_p).value)

POINTER = types.intp
INT = types.int32 if PETSc.IntType == np.int32 else types.int64


def c_function(*arguments: Any) -> Callable[[Callable], Any]:
    """Compiles a function with these argument types for calls from C; the C function returns an error
    code."""
    return partial(c_callback, signature=types.int32(*arguments))


def petsc_function(name: str) -> Any:
    """The function int name(object, array*) of libpetsc for compiled code; unlike a ctypes function it can be
    cached.
    """
    return types.ExternalFunction(name, typing.signature(types.int32, POINTER, POINTER))


@intrinsic
def pointer(context: Any, address: Any) -> Any:
    """An integer converted into a pointer."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.inttoptr(arguments[0], context.get_value_type(types.voidptr))

    return types.voidptr(address), generate


@compiled
def floats(address: int, size: int) -> Any:
    return numba.carray(pointer(address), (size,), np.float64)


@compiled
def floats_in(address: int, shape: Any) -> Any:
    """`floats` with the shape of a tuple; a separate `reshape` takes as long as the rate of a rod with ten
    nodes."""
    return numba.carray(pointer(address), shape, np.float64)


@compiled
def integers(address: int, size: int) -> Any:
    return numba.carray(pointer(address), (size,), np.int64)


@compiled
def record_at(address: int, dtype: Any) -> Any:
    """The record with fields `dtype` at an address; an assignment to a field writes to the memory at this
    address."""
    return numba.carray(pointer(address), (1,), dtype)[0]


def call(name: str, *arguments: int) -> None:
    """Calls a function of libpetsc that takes only pointers; raises RuntimeError on failure."""
    if getattr(LIBRARY, name)(*map(ctypes.c_void_p, arguments)):
        raise RuntimeError(f"the PETSc function {name} failed")
