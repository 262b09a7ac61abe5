"""How `rodsweep show` writes a range of numbers."""

import numpy as np


def span(values: np.ndarray) -> str:
    """The range of the finite values, of any shape, as words; "none" where there are none."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return "none"
    low, high = finite.min(), finite.max()
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
