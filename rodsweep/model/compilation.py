"""How scalar formulas are compiled: numba, cached on disk where the disk allows it.

The formulas are evaluated point by point inside adaptive loops, where NumPy would spend its time
on calls. The compiled functions take floats and complex numbers and no objects of ours.
"""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numba

P = ParamSpec("P")
R = TypeVar("R")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """`function` compiled by numba in nopython mode.

    Real division by zero gives inf or nan, complex division by zero raises ZeroDivisionError.
    """
    try:
        return numba.njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # numba finds no directory that it may write its cache to
        return numba.njit(error_model="numpy")(function)
