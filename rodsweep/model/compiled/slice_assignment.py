"""Compiled assignments of an array to a slice, `a[i] = b`, with a fixed message if the shapes differ.

numba's own message contains both shapes. Every compiled function with such an assignment would therefore
contain code that converts numbers to text. The compilation of this code took a third of the installation
time.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

from numba.core.extending import overload

SHAPE_MISMATCH_MESSAGE = "cannot assign an array to a slice of another shape"
"""Message of the ValueError that compiled code raises."""


def refuse_shape_mismatch(source: tuple[int, ...], target: tuple[int, ...]) -> None:
    """Raises ValueError: an array of the shape `source` does not fit into a slice of the shape `target`."""
    raise ValueError(SHAPE_MISMATCH_MESSAGE)


@cache
def install_shape_mismatch_message() -> None:
    """Makes numba use the fixed message in all later compilations; this function imports the compiler.
    Releases of numba with a fixed message are not changed."""
    from numba.np import arrayobj

    if hasattr(arrayobj, "raise_with_shape_context"):
        overload(refuse_shape_mismatch)(_refusal_overload)
        arrayobj.raise_with_shape_context = refuse_shape_mismatch


def _refusal_overload(source: Any, target: Any) -> Callable[[Any, Any], None]:
    def refusal(source: Any, target: Any) -> None:
        raise ValueError(SHAPE_MISMATCH_MESSAGE)

    return refusal
