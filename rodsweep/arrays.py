"""Array types for annotations; shapes are in the docstrings."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Floating-point numbers."""
Complex = NDArray[np.complex128]
"""Complex numbers."""
