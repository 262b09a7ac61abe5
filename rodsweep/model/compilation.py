"""How scalar formulas are compiled: numba, cached on disk where the disk allows it.

The formulas are evaluated point by point inside adaptive loops, where NumPy would spend its time
on calls. The compiled functions take floats and complex numbers and no objects of ours.

A compiled function contains those of other modules that it calls, and numba does not notice when one of
these changes. So the cache has a directory for each content of the modules that may hold formulas.
"""

import os
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numba

P = ParamSpec("P")
R = TypeVar("R")

PACKAGE = Path(__file__).parents[1]
COMPILED_IN = ("model", "determinant", "discretization", "solve")


def cache_directory() -> Path:
    """Where numba keeps what it compiled from the present sources; NUMBA_CACHE_DIR moves it."""
    digest = sha256()
    for module in sorted(path for name in COMPILED_IN for path in (PACKAGE / name).rglob("*.py")):
        digest.update(module.read_bytes())
    place = os.environ.get("NUMBA_CACHE_DIR")
    if place is None:
        beside = os.access(PACKAGE, os.W_OK)
        home = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
        place = str(PACKAGE / "__pycache__" if beside else home / "rodsweep")
    return Path(place) / f"compiled-{digest.hexdigest()[:16]}"


numba.config.CACHE_DIR = str(cache_directory())


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


def _compiled(function: Callable[P, R], **options: Any) -> Callable[P, R]:
    try:
        return numba.njit(cache=True, error_model="numpy", **options)(function)
    except (RuntimeError, OSError):  # there is no directory that may be written
        return numba.njit(error_model="numpy", **options)(function)
