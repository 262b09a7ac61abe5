"""Products of small dense matrices in compiled code, by SciPy's BLAS.

At 50 unknowns dgemm is four times as fast as loops, and ten times as fast as factorisation and substitution
by the same library. Therefore `solve.orbit.matrix.elimination` uses products where possible.
"""

from typing import Any

import numpy as np
from llvmlite import binding
from numba import types
from numba.core import typing
from numba.extending import get_cython_function_address

from ...arrays import Array
from ...model.compiled.compilation import compiled

_ADDRESS_TYPE = types.intp
binding.add_symbol("rodsweep_dgemm", get_cython_function_address("scipy.linalg.cython_blas", "dgemm"))
# By name, not by address, so that the compiled code can be cached.
_dgemm = types.ExternalFunction("rodsweep_dgemm", typing.signature(types.void, *[_ADDRESS_TYPE] * 13))


@compiled
def matrix_product(a: Any, b: Any, c: Any, extents: Any, factors: Array) -> None:
    """Matrix product C = factors[0] A B + factors[1] C by dgemm, written to C, for matrices stored by rows.

    a, b, c: memory addresses of the first entries of A, B and C. extents: int32 (m, n, k, lda, ldb, ldc) for
    A (m, k), B (k, n) and C (m, n); lda, ldb, ldc: distances between the rows of A, B and C in memory, in
    entries.
    """
    letter_N = np.full(1, 78, np.uint8)  # "N"
    no_transpose = letter_N.ctypes.data
    e = extents.ctypes.data
    f = factors.ctypes.data
    # BLAS stores matrices by columns, so it is called for C^T = B^T A^T.
    _dgemm(no_transpose, no_transpose, e + 4, e, e + 8, f, b, e + 16, a, e + 12, f + 8, c, e + 20)


@compiled
def square_matrix_product(A: Array, B: Array, C: Array, factor: float, factor_of_C: float) -> None:
    """Matrix product C = factor A B + factor_of_C C, written to C; all (n, n) and contiguous."""
    n = len(A)
    extents = np.full(6, n, np.int32)
    factors = np.array([factor, factor_of_C])
    matrix_product(A.ctypes.data, B.ctypes.data, C.ctypes.data, extents, factors)
