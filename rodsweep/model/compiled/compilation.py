"""How scalar formulas are compiled: numba, cached on disk where the disk allows it.

The formulas are evaluated point by point inside adaptive loops, where NumPy would spend its time
on calls. The compiled functions take floats and complex numbers and no objects of ours.
"""

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba
from numba.core.ccallback import CFunc

from .cache import KernelCache

P = ParamSpec("P")
R = TypeVar("R")

PACKAGE = Path(__file__).parents[2]


def cache_directories() -> list[Path]:
    """Directories of compiled code: NUMBA_CACHE_DIR, or the package and, if it is read-only, ~/.cache."""
    if place := os.environ.get("NUMBA_CACHE_DIR"):
        return [Path(place) / "rodsweep"]
    caches = [PACKAGE / "__pycache__"]
    if place := os.environ.get("XDG_CACHE_HOME"):
        caches.append(Path(place) / "rodsweep")
    else:
        with suppress(RuntimeError):  # this user has no home
            caches.append(Path.home() / ".cache" / "rodsweep")
    return [cache / "compiled" for cache in caches]


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """`function` compiled by numba in nopython mode.

    Real division by zero gives inf or nan, complex division by zero raises ZeroDivisionError.
    """
    return _compiled(function, fastmath=False)


def compiled_for_vectors(function: Callable[P, R]) -> Callable[P, R]:
    """As `compiled`, with sums that may be added in any order, as a BLAS does: five times as fast.

    Infinities and nan are kept. Each function that calls it has its own copy inside: of copies beside it,
    which add in other orders, a process would take the one that it happened to load first.
    """
    return _compiled(function, fastmath={"reassoc", "contract", "nsz"}, forceinline=True)


def c_callback(function: Callable, signature: Any) -> Any:
    """`function` compiled at once into one that C can call; its `address` is a C function pointer."""
    callback: Any = CFunc(function, numba.core.sigutils.normalize_signature(signature), locals={}, options={})
    callback._cache = KernelCache(function, {"signature": "C"}, cache_directories())
    callback.compile()
    return callback


def _compiled(function: Callable[P, R], **options: Any) -> Callable[P, R]:
    dispatcher: Any = numba.njit(error_model="numpy", **options)(function)
    if not numba.config.DISABLE_JIT:
        dispatcher._cache = KernelCache(function, dispatcher.targetoptions, cache_directories())
    return dispatcher
