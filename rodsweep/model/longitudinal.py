"""Longitudinal eigenvalues of the straight rod in closed form.

Longitudinal and transverse modes are decoupled (Sec. VI).
"""

import numpy as np

from ..arrays import Array


def longitudinal_eigenvalues(k1: float, gamma1: float, mode_count: int) -> Array:
    """Longitudinal eigenvalues -(k1/gamma1) (pi (n - 1/2))^2, n = 1..mode_count, in 1/tau2, (n,). Raises
    ValueError for an inextensible rod (k1 = inf), which has no longitudinal motion."""
    if np.isinf(k1):
        raise ValueError("an inextensible rod (k1 = inf) has no longitudinal modes")
    n = np.arange(1, mode_count + 1, dtype=np.float64)
    return -(k1 / gamma1) * (np.pi * (n - 0.5)) ** 2
