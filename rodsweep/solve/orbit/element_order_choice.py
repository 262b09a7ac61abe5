"""Choice of the order of each element from the coefficients of a nearby orbit: a short or stiff segment of
an arm needs a lower order than a long or soft one."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...arrays import Array
from ...determinant.exponents import EXPONENT_SETTINGS
from ...model.compiled.kernel_constants import KernelConstants
from .coefficient_tails import largest_coefficients_of_elements
from .orbit import Orbit
from .orbit_mesh import OrbitMesh, mesh_of_orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class RodElementOrderRatioSettings(KernelConstants):
    """Settings for the orders of the elements of a mesh relative to the largest order."""

    min_element_order: int = 4
    """Smallest order of an element that is chosen from the Legendre coefficients of an orbit."""
    min_element_order_ratio: float = 0.2
    """Smallest order of an element, divided by the largest order of the mesh. Elements of short and stiff
    segments reach 0.25."""
    rounding_steps_of_ratio_per_unit: int = 64
    """Ratios are rounded up to multiples of 1/`rounding_steps_of_ratio_per_unit`. Multiplied by any allowed
    order of a mesh, this step is less than one order."""
    max_neglected_coefficient_ratio: float = 1 / 3
    """Where the order of an element is reduced, its largest neglected coefficient is at most this fraction of
    the largest neglected coefficient of the elements of the largest order. Errors are quadratic in the
    coefficients: the largest error of twelve meshes of three arms grew by half at most, and mostly did not
    grow."""
    field_ranges: ClassVar = {
        "min_element_order_ratio": (0.0, 1.0),
        "max_neglected_coefficient_ratio": (0.0, 1.0),
    }
    """Exclusive bounds (lower, upper) of settings by name, as in `KernelConstants`."""


ROD_ELEMENT_ORDER_RATIO_SETTINGS = RodElementOrderRatioSettings()


def element_order_ratios(orbit: Orbit, order: int, max_tail: float) -> tuple[float, ...]:
    """For each element, the order that it needs, divided by the largest of these orders; at least
    `min_element_order_ratio`; () if all ratios are 1, or for a single element.

    order: largest order, with which the Legendre coefficients in space are expected to fall to `max_tail`
    times the largest coefficient.
    """
    coefficients = _relative_coefficients(orbit)
    if len(coefficients) == 1:
        return ()
    orders = np.array([_needed_order(c, max_tail, order) for c in coefficients])
    settings = ROD_ELEMENT_ORDER_RATIO_SETTINGS
    orders = np.maximum(orders, settings.min_element_order)
    ratios = np.maximum(orders / max(orders), settings.min_element_order_ratio)
    ratios = (
        np.ceil(settings.rounding_steps_of_ratio_per_unit * ratios)
        / settings.rounding_steps_of_ratio_per_unit
    )
    return () if min(ratios) == 1 else tuple(ratios.tolist())


def without_excess_orders(mesh: OrbitMesh, orbit: Orbit) -> OrbitMesh:
    """`mesh` with lower orders of some elements: their neglected coefficients are still at most
    `max_neglected_coefficient_ratio` times those of the elements of the largest order. Such elements exist
    because a change of the largest order changes all orders in proportion, and coefficients of short or stiff
    segments fall faster. Coefficients are those of the solved `orbit`. Returns `mesh` itself if all its
    orders are equal, if the mesh of the orbit has other edges or order ratios, or if its largest order is
    less than the order of `mesh` plus 2."""
    solved_mesh = mesh_of_orbit(orbit)
    if (
        not mesh.order_ratios
        or not mesh.has_same_edges_and_order_ratios(solved_mesh)
        or mesh.order + 2 > solved_mesh.order
    ):
        return mesh
    coefficients = _relative_coefficients(orbit)
    max_neglected = ROD_ELEMENT_ORDER_RATIO_SETTINGS.max_neglected_coefficient_ratio * max(
        c[p + 1 : p + 3].max() for c, p in zip(coefficients, mesh.orders, strict=True) if p == mesh.order
    )
    orders = []
    for c, p in zip(coefficients, mesh.orders, strict=True):
        order = p
        while (
            ROD_ELEMENT_ORDER_RATIO_SETTINGS.min_element_order < order < min(mesh.order, len(c) - 1)
            and c[order : order + 2].max() <= max_neglected
        ):
            order -= 1
        orders.append(order)
    return mesh if tuple(orders) == mesh.orders else mesh.with_orders(orders)


def _relative_coefficients(orbit: Orbit) -> list[Array]:
    """Largest moduli over n1, n2 and m3 of the Legendre coefficients in space of each element, (p + 1,) each,
    p: order of the element. Each field is first divided by its largest coefficient along the rod."""
    coefficients = largest_coefficients_of_elements(orbit)
    scale = np.max([c.max(axis=1) for c in coefficients], axis=0)
    scale = np.maximum(scale, EXPONENT_SETTINGS.min_divisor)
    return [(c / scale[:, None]).max(axis=0) for c in coefficients]


def _needed_order(c: Array, max_tail: float, order: int) -> int:
    """Lowest order at which the coefficient of an element and the coefficient of the next order are at most
    `max_tail`; `order` if there is none. Two orders are tested, because one coefficient may vanish by parity.
    c: moduli of the coefficients of orders 0 to p, (p + 1,)."""
    small_indices = np.flatnonzero(np.maximum(c[:-1], c[1:]) <= max_tail)
    return int(small_indices[0]) if len(small_indices) else order
