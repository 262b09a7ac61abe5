"""The types of arrays, as annotations name them; what their shapes are, docstrings say."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Floating-point numbers."""
Complex = NDArray[np.complex128]
"""Complex numbers."""
