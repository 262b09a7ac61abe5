"""Compiled assignments of an array to a slice, `a[i] = b`, with a fixed message if the shapes differ.

numba's own message states both shapes. Every compiled function with such an assignment would contain code
that writes numbers as text. Compiling this code took a third of the time of the installation.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

from numba.core.extending import overload

OTHER_SHAPE = "cannot assign an array to a slice of another shape"
"""Message of the ValueError that compiled code raises."""


def refuse_other_shape(source: tuple[int, ...], target: tuple[int, ...]) -> None:
    """Raises ValueError: an array of the shape `source` does not fit into a slice of the shape `target`."""
    raise ValueError(OTHER_SHAPE)


@cache
def shorten_message() -> None:
    """Replaces the message in all functions that numba compiles from now on; it imports the compiler.

    Releases of numba whose message is fixed stay as they are.
    """
    from numba.np import arrayobj

    if hasattr(arrayobj, "raise_with_shape_context"):
        overload(refuse_other_shape)(_compiled_refusal)
        arrayobj.raise_with_shape_context = refuse_other_shape


def _compiled_refusal(source: Any, target: Any) -> Callable[[Any, Any], None]:
    def refusal(source: Any, target: Any) -> None:
        raise ValueError(OTHER_SHAPE)

    return refusal
