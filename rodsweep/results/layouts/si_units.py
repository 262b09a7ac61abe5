"""SI units of the results of an arm, and the kind of load, pressure or force, in which forces are stored."""

from collections.abc import Mapping
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...config.arm.axes import LOAD_KEYS
from ...model.arm.quantities import (
    LOAD_NAME_BY_RELATIVE_LOAD,
    LOAD_NAMES,
    LOAD_SCALE_NAME_BY_LOAD,
    UNITS_AND_EXAMPLES,
)
from .variables import ANGULAR_UNIT

HERTZ = "Hz"
"""Unit of frequencies, cycles per second, as experiments count them. Radians per second are not used."""


class SIUnit(NamedTuple):
    """SI unit of a result. The unit of its dimensionless value is the product of the arm's quantities in
    `factors` divided by the product of the quantities in `divisors`.

    Dimensionless frequencies are angular; the conversion to Hz contains 2 pi.
    """

    unit: str = ""
    factors: tuple[str, ...] = ()
    divisors: tuple[str, ...] = ()

    def scale(self, quantities: Mapping[str, Any]) -> NDArray[Any]:
        """Factor from dimensionless values to values in `unit`, () or (n,). quantities: quantities of the
        arm by name, in SI units, () or (n,) each."""
        numerator = prod(quantities[name] for name in self.factors)
        denominator = prod(quantities[name] for name in self.divisors)
        return np.asarray(numerator / (2 * np.pi * denominator if self.unit == HERTZ else denominator))


NO_SI_UNIT = SIUnit()
"""Used for variables that are not stored in SI units."""
SI_UNIT_BY_DIMENSIONLESS_UNIT = {
    "tau2": SIUnit("s", ("tau2",)),
    "1/tau2": SIUnit("1/s", (), ("tau2",)),
    ANGULAR_UNIT: SIUnit(HERTZ, (), ("tau2",)),
    "L": SIUnit("m", ("length",)),
    "k3/L": SIUnit("J", ("force_scale", "length")),
    "k3/(L tau2)": SIUnit("W", ("force_scale", "length"), ("tau2",)),
}
"""SI units of the dimensionless units of time, length, energy and power."""
FORCE_SI_UNIT_BY_LOAD = {
    load: SIUnit(UNITS_AND_EXAMPLES[load][0], (LOAD_SCALE_NAME_BY_LOAD[load],)) for load in LOAD_NAMES
}
"""SI unit in which the follower force is stored, by name of the arm's load, "pressure" or "force"."""


def load_kind_of(arm: Mapping[str, Any]) -> str:
    """Kind of the loads in the results of an arm: "force" or "pressure"."""
    load = next((LOAD_NAME_BY_RELATIVE_LOAD.get(name, name) for name in arm if name in LOAD_KEYS), "pressure")
    return str(arm.get("load_kind") or load)
