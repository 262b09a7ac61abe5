"""Choice of the order of each element from the coefficients of a nearby orbit: a short or stiff segment of
an arm needs a lower order than a long or soft one."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...arrays import Array
from ...determinant.exponents import EXPONENT_SETTINGS
from ...model.compiled.kernel_constants import KernelConstants
from .orbit import Orbit
from .tails import coefficients_of_elements


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderRatioSettings(KernelConstants):
    """Settings for the orders of the elements of a mesh relative to the largest order."""

    min_order: int = 4
    """Smallest order of an element that is chosen from coefficients."""
    min_ratio: float = 0.2
    """Smallest order of an element, divided by the largest order of the mesh. Elements of short and stiff
    segments reach 0.25."""
    ratios_per_unit: int = 64
    """Ratios are rounded up to multiples of 1 over this number, which is less than one order at every allowed
    order."""
    field_ranges: ClassVar = {"min_ratio": (0.0, 1.0)}


ORDER_RATIO_SETTINGS = OrderRatioSettings()


def element_order_ratios(orbit: Orbit, order: int, max_tail: float) -> tuple[float, ...]:
    """Ratio of the order that each element needs to the largest order, at least `min_ratio`; () if all are 1.

    order: largest order, with which the Legendre coefficients in space are expected to fall to `max_tail`
    times the largest coefficient.
    """
    coefficients = coefficients_of_elements(orbit)
    if len(coefficients) == 1:
        return ()
    largest_coefficients = np.max([c.max(axis=1) for c in coefficients], axis=0)
    largest_coefficients = np.maximum(largest_coefficients, EXPONENT_SETTINGS.min_divisor)
    orders = np.array(
        [
            _needed_order((c / largest_coefficients[:, None]).max(axis=0), max_tail, order)
            for c in coefficients
        ]
    )
    settings = ORDER_RATIO_SETTINGS
    orders = np.maximum(orders, settings.min_order)
    ratios = np.maximum(orders / max(orders), settings.min_ratio)
    ratios = np.ceil(settings.ratios_per_unit * ratios) / settings.ratios_per_unit
    return () if min(ratios) == 1 else tuple(ratios.tolist())


def _needed_order(c: Array, max_tail: float, order: int) -> int:
    """Lowest order of an element whose coefficient, and that of the next order, is at most `max_tail`; not
    above `order`. Two orders are tested, because one coefficient may vanish by parity. c: moduli of the
    coefficients of orders 0 to p, (p + 1,)."""
    small_indices = np.flatnonzero(np.maximum(c[:-1], c[1:]) <= max_tail)
    return int(small_indices[0]) if len(small_indices) else order
