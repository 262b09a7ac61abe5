"""Array types for annotations; shapes are in the docstrings."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""NumPy array of floating-point numbers, of any shape."""
Complex = NDArray[np.complex128]
"""NumPy array of complex numbers, of any shape."""
COMPLEX_NAN = complex(np.nan, np.nan)
"""Unknown complex number. In `nan + 0j` only the real part would be unknown."""
