"""Rods made from lists of numbers."""

from rodsweep.model.parameters import PARAMETERS
from rodsweep.model.rod import Rod


def rod_of(*numbers: float, **others: float) -> Rod:
    """The rod with parameters in the order of the table; those left out have their defaults."""
    return Rod(**dict(zip(PARAMETERS, numbers, strict=False)), **others)
