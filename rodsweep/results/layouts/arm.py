"""What the file of an arm holds beside that of a rod: its quantities, and results in SI units too.

A variable such as `period`, in tau2, has `period_si`, in s; `frequency`, in rad/tau2, has `frequency_hz`, in
cycles per second. The quantities of the arm, and the units tau2,
force_scale and pressure_scale that they make, are coordinates: numbers, or along a parameter or `point`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...config.arm import AXIS_OF
from ...config.axes import Axes
from ...model.arm import UNITS
from ...model.parameters import PARAMETERS
from .variables import ANGULAR, Filled, Layout, Variable, real

SUFFIX, OF_HERTZ = "_si", "_hz"
HERTZ = "Hz"
"""Cycles per second: what is counted on the bench. A radian a second is told nowhere."""
OF_TIME_AND_LENGTH = {
    "tau2": ("s", ("tau2",), ()),
    "1/tau2": ("1/s", (), ("tau2",)),
    ANGULAR: (HERTZ, (), ("tau2",)),
    "L": ("m", ("length",), ()),
    "k3/L": ("J", ("force_scale", "length"), ()),
    "k3/(L tau2)": ("W", ("force_scale", "length"), ("tau2",)),
}
"""Dimensionless units in SI: the unit, and which quantities one is a product of, and divided by; a
frequency in Hz by a turn of 2 pi too."""
FORCES = {
    "pressure": ("Pa", ("pressure_scale",), ()),
    "force": ("N", ("force_scale",), ()),
}
"""What a follower force is told in: as the load of the arm is given, a pressure where none is."""
OF_BRANCHES = ("branch_F", "special_at", "special_error")
"""Forces along the branches of an arm, which are followed in nothing else."""
WITHIN = ((), ("mode",), ("crossing",), ("branch_point",), ("special",))
"""Dimensions beside the points of what is told in SI units too; longer tables are not stored twice."""
MEANINGS = {
    "length": "length of the arm",
    "radius": "radius of the arm's circular section",
    "inner_radius": "radius of the bore of the arm, closed at its tip",
    "width": "width of the arm's section, across the plane of motion",
    "height": "height of the arm's section, in the plane of motion",
    "young": "Young's modulus of the arm",
    "poisson": "Poisson's ratio of the arm",
    "viscosity": "viscosity of the fluid",
    "pressure": "pressure on the tip's cross section",
    "force": "follower force at the tip",
    "tau2": "unit of time, gamma2 L^4/k3, with the likeliest drag",
    "force_scale": "unit of force, k3/L^2",
    "pressure_scale": "pressure on the tip's cross section that makes F = 1, k3/(L^2 A)",
}
"""What each quantity is."""
QUANTITY_UNITS = {name: unit for name, (unit, _) in UNITS.items()} | {
    "poisson": "1",
    "tau2": "s",
    "force_scale": "N",
    "pressure_scale": "Pa",
}


def with_si(layout: Layout, config: Mapping[str, Any]) -> Layout:
    """The layout with what a resolved config that has an arm stores in SI units too."""
    if config.get("parameters", {}).get("arm") is None:
        return layout
    return replace(layout, variables=(*layout.variables, *twins_of(layout, config)))


def twins_of(layout: Layout, config: Mapping[str, Any]) -> list[Variable]:
    """What is stored in SI units too of a rod's layout, for a resolved config that has an arm."""
    as_force = "force" in config["parameters"]["arm"]
    units = ((variable, _unit_of(variable, as_force)[0]) for variable in layout.variables)
    return [real(twin_of(v.name, unit), unit, _meaning(v, unit), *v.extra) for v, unit in units if unit]


def twin_of(name: str, unit: str) -> str:
    """The name under which a variable stands in an SI unit."""
    return name + (OF_HERTZ if unit == HERTZ else SUFFIX)


def _meaning(variable: Variable, unit: str) -> str:
    """What a variable in an SI unit is: a frequency is no longer angular there."""
    words = variable.long_name.removeprefix("angular ") if unit == HERTZ else variable.long_name
    return f"{words}; in {'cycles per second' if unit == HERTZ else 'SI units'}"


def _unit_of(variable: Variable, as_force: bool) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """The SI unit of a variable, what to multiply and to divide by; an empty unit where it is told once."""
    if variable.dtype != "<f8" or variable.extra not in WITHIN:
        return "", (), ()
    if variable.units == PARAMETERS["F"].unit and ("F_" in variable.name or variable.name in OF_BRANCHES):
        return FORCES["force" if as_force else "pressure"]
    return OF_TIME_AND_LENGTH.get(variable.units, ("", (), ()))


def quantities_of(parameters: Axes, is_grid: bool) -> tuple[Filled, ...]:
    """The quantities of a config's arm as coordinates; none where it has no arm."""
    if parameters.arm is None:
        return ()
    beside = {name: axis.array() for name, axis in parameters.given_axes.items()}
    found = []
    for name, values in parameters.arm.quantities(beside).items():
        dimension = AXIS_OF.get(name, "") if is_grid else "point"
        extra = (dimension,) if np.ndim(values) else ()
        found.append((real(name, QUANTITY_UNITS[name], MEANINGS[name], *extra), np.asarray(values)))
    return tuple(found)


def in_si(
    record: Mapping[str, Any],
    index: int | NDArray[np.int64],
    layout: Layout,
    quantities: Mapping[str, NDArray[Any]],
) -> dict[str, Any]:
    """The variables of a point, or of several, that are told in SI units too.

    index: of the point, or (n,), with the variables (n, ...) then; quantities: those of the arm, each of
    shape () or (points,).
    """
    values = {}
    for variable in layout.variables:
        unit, factors, divisors = _unit_of(variable, "force" in quantities)
        if unit:
            value = np.asarray(record[variable.name])
            up, down = (_product(quantities, names, index) for names in (factors, divisors))
            scale = up / (2 * np.pi * down if unit == HERTZ else down)
            values[twin_of(variable.name, unit)] = value * scale.reshape(
                scale.shape + (1,) * (value.ndim - scale.ndim)
            )
    return values


def _product(
    quantities: Mapping[str, NDArray[Any]], names: Iterable[str], index: int | NDArray[np.int64]
) -> NDArray[Any]:
    """The product of quantities at a point, shape (), or at several, (n,), or () where they share it."""
    product = np.array(1.0)
    for name in names:
        values = np.asarray(quantities[name])
        product = product * np.asarray(values[index] if values.ndim else values)
    return product
