"""Eigenvalues of small dense matrices in compiled code, by SciPy's LAPACK."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from llvmlite import binding
from numba import types
from numba.core import typing
from numba.extending import get_cython_function_address

from ...arrays import Array, Complex
from ...model.compiled.compilation import compiled
from ...model.compiled.kernel_constants import KernelConstants

_ADDRESS_TYPE = types.intp
binding.add_symbol("rodsweep_dgeev", get_cython_function_address("scipy.linalg.cython_lapack", "dgeev"))
# By name, not by address, so that the compiled code can be cached.
_dgeev = types.ExternalFunction("rodsweep_dgeev", typing.signature(types.void, *[_ADDRESS_TYPE] * 14))


@dataclass(frozen=True, slots=True, kw_only=True)
class SmallEigenvalueSettings(KernelConstants):
    """Size of the work array of LAPACK's dgeev."""

    work_array_ratio: int = 12
    """Length of the work array divided by n, for a matrix (n, n): dgeev needs 3, and is faster with more."""
    field_ranges: ClassVar = {"work_array_ratio": (2, math.inf)}
    """Exclusive bounds (lower, upper) of a field, by name of the field."""


SMALL_EIGENVALUE_SETTINGS = SmallEigenvalueSettings()


@compiled
def small_matrix_eigenvalues(A: Array) -> Complex:
    """Eigenvalues, (n,), of a matrix A, (n, n), with finite entries; all nan if LAPACK does not converge."""
    n = len(A)
    a = A.copy()
    parts = np.empty((2, n))
    work = np.empty(SMALL_EIGENVALUE_SETTINGS.work_array_ratio * n)
    extents = np.array([n, len(work), 0], np.int32)
    letter_N = np.full(1, 78, np.uint8)  # "N"
    no_vectors = letter_N.ctypes.data
    e = extents.ctypes.data
    v = parts.ctypes.data
    w = work.ctypes.data
    # LAPACK stores matrices by columns and sees A^T, which has the same eigenvalues.
    _dgeev(no_vectors, no_vectors, e, a.ctypes.data, e, v, v + 8 * n, w, e, w, e, w, e + 4, e + 8)
    values = np.empty(n, np.complex128)
    for i in range(n):
        values[i] = complex(parts[0, i], parts[1, i])
    if extents[2] != 0:
        values[:] = np.nan
    return values
