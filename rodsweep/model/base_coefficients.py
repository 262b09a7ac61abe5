"""The rod's force, stiffnesses and drags at the base, from the values of the parameters.

A parameter may multiply stiffnesses or drags, as `PARAMETERS` states in the field `scaled_coefficient_names`.
"""

from collections.abc import Mapping
from math import inf
from typing import Any

import numpy as np

from .parameters import SCALING_AND_SCALED_NAMES


def stiffnesses_and_drags_at_base(values: Mapping[str, Any]) -> Mapping[str, Any]:
    """Force, stiffnesses and drags at the base, by name, from the parameter values by name. A result is the
    value of the parameter of the same name, times the values of all parameters that multiply this parameter
    (`Parameter.scaled_coefficient_names`). All other values, such as the taper, are passed on unchanged."""
    if not SCALING_AND_SCALED_NAMES:
        return values
    base_values = dict(values)
    for factor_name, scaled_name in SCALING_AND_SCALED_NAMES:
        base_values[scaled_name] = base_values[scaled_name] * values[factor_name]
    return base_values


def stretch_of_straight_rod(F: Any, k1: Any) -> Any:
    """Stretch nu = 1 - F/k1 of the straight rod of linear material, for floats or arrays (...,). The formula
    has no cancellation for F near k1. nu = 1 for k1 = inf."""
    if isinstance(k1, np.ndarray):
        with np.errstate(invalid="ignore"):  # inf/inf where k1 = inf
            return np.where(np.isinf(k1), 1.0, (k1 - F) / k1)
    # The difference k1 - F of two floats close together is exact, unlike 1 - F/k1.
    return (k1 - F) / k1 if k1 < inf else 1.0
