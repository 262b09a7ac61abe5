"""Array types for annotations; shapes are in the docstrings."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating]
"""NumPy array of floating-point numbers, of any shape."""
Complex = NDArray[np.complexfloating]
"""NumPy array of complex numbers, of any shape."""
COMPLEX_NAN = complex(np.nan, np.nan)
"""Unknown complex number. In `nan + 0j` only the real part would be unknown."""


def list_of(values: NDArray) -> list[Any]:
    """Elements of an array, (n,) or (n, ..., m), as Python's numbers, in nested lists if the array has
    several axes.

    In NumPy 2 the type of `tolist` is a union over the numbers of axes, which annotations leave open.
    """
    return values.tolist()
