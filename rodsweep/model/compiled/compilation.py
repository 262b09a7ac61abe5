"""Compilation of formulas by numba, cached on disk if a directory is writable.

Adaptive loops evaluate the formulas for one argument at a time, for which the overhead of NumPy would
dominate. Arguments of compiled functions are floats, complex numbers, arrays and NamedTuples.
"""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numba
from numba.core.ccallback import CFunc

from .cache import KernelCache, cache_directories

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """The function `function`, compiled by numba in nopython mode at its first call. Real division by zero
    gives inf or nan; complex division by zero raises ZeroDivisionError."""
    return _compiled(function, fastmath=False)


def compiled_with_reordered_sums(function: Callable[P, R]) -> Callable[P, R]:
    """The function `function`, compiled as by `compiled`, but with sums in any order. The code is five times
    as fast.

    Infinities and nan behave as usual. The function is always inlined in its callers. With a shared copy,
    results would depend on the caller that a process loads first, because copies differ in the order of sums.
    """
    return _compiled(function, fastmath={"reassoc", "contract", "nsz"}, forceinline=True)


def c_callback(function: Callable, signature: Any) -> Any:
    """A callback for C code: `function`, compiled at once for numba's signature `signature`. The attribute
    `address` of the callback is the C function pointer."""
    # An exception could not pass through C: division by zero gives inf or nan, which the caller tests.
    options = {"error_model": "numpy"}
    callback: Any = CFunc(
        function, numba.core.sigutils.normalize_signature(signature), locals={}, options=options
    )
    # The key names the calling convention, as the same function may be compiled as a kernel too.
    callback._cache = KernelCache(function, {"signature": "C", **options}, cache_directories())
    callback.compile()
    return callback


def _compiled(function: Callable[P, R], **options: Any) -> Callable[P, R]:
    # Python's error model would add a test for zero to each division, and prevent vector instructions.
    dispatcher: Any = numba.njit(error_model="numpy", **options)(function)
    if not numba.config.DISABLE_JIT:
        # Set directly, because numba has no public way to choose the files of its cache.
        dispatcher._cache = KernelCache(function, dispatcher.targetoptions, cache_directories())
    return dispatcher
