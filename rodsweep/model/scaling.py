"""Loads, stiffnesses and drags of the equations, from the values of the parameters.

A parameter may scale others, as the table says; nu is the axial stretch of the straight rod under its force.
"""

from collections.abc import Mapping
from math import inf
from typing import Any

import numpy as np

from .parameters import SCALINGS


def scaled(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Loads, stiffnesses and drags by name: each value in `values` times the parameters that scale it."""
    if not SCALINGS:
        return values
    own = dict(values)
    for factor, of in SCALINGS:
        own[of] = own[of] * values[factor]
    return own


def compression_factor(F: Any, k1: Any) -> Any:
    """nu = 1 - F/k1 without cancellation for F close to k1; floats or arrays."""
    if isinstance(k1, np.ndarray):
        with np.errstate(invalid="ignore"):  # inf/inf where k1 = inf
            return np.where(np.isinf(k1), 1.0, (k1 - F) / k1)
    return (k1 - F) / k1 if k1 < inf else 1.0
