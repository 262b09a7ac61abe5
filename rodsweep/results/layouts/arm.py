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

from ...arrays import Array
from ...config.arm import ArmSection
from ...config.arm_axes import ALONG, names_over
from ...config.axes import Axes
from ...config.quantities import typed_unit
from ...config.tasks import makes_diagram
from ...model.arm import QUANTITIES, UNITS
from ...model.drag import DRAGS
from ...model.neglected import Validity
from ...model.parameters import PARAMETERS
from ...sweep.grid import Points
from .variables import ANGULAR, DIMENSIONS, Filled, Layout, Variable, real

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
LOAD_OF_UNIT = {unit: load for load, (unit, *_) in FORCES.items()}
FREQUENCIES_OF_EVENTS = {
    f"{event}_frequency": f"frequency_{event}_hz" for event in ("hopf", "restabilization")
}
"""Names in Hz of the frequencies at thresholds, as `pressure_hopf` is that of F_hopf."""
OF_BRANCHES = ("special_at", "special_error")
"""Forces along the branches of an arm, which are followed in nothing else."""
WITHIN = ((), ("mode",), ("crossing",), ("branch_point",), ("special",))
"""Dimensions beside the points of what is told in SI units too; longer tables are not stored twice."""
UNITS_OF_ARMS = {
    "tau2": ("s", "unit of time, gamma2 L^4/k3"),
    "force_scale": ("N", "unit of force, k3/L^2"),
    "pressure_scale": ("Pa", "pressure on the tip's cross section that makes F = 1, k3/(L^2 A)"),
}
"""Units that an arm makes, beside its quantities."""
_DESCRIBED = {name: (each.unit, each.meaning) for name, each in QUANTITIES.items()} | UNITS_OF_ARMS
QUANTITY_UNITS = {name: unit for name, (unit, _) in _DESCRIBED.items()}
MEANINGS = {name: meaning for name, (_, meaning) in _DESCRIBED.items()}
"""SI unit of each quantity, and what it is."""

EFFECTS = ("inertia_of_the_arm", "inertia_of_the_fluid", "compression", "weight", "Reynolds_number")
"""What the model leaves out, as `rodsweep.model.neglected` names it but for the blanks."""
VALIDITY = (
    Variable(
        "model_applies",
        "|i1",
        -1,
        "1",
        "whether the model applies to the arm, by all that it leaves out",
        flags=((-1, "not_known"), *((int(each), each.name) for each in Validity)),
    ),
    Variable(
        "neglected_effect",
        "|i1",
        -1,
        "1",
        "what the model leaves out that is largest, in units of its limit",
        flags=((-1, "none"), *enumerate(EFFECTS)),
    ),
    real(
        "neglected_excess",
        "1",
        "how large that is, in units of the limit beyond which the model does not apply",
    ),
)


def with_si(layout: Layout, config: Mapping[str, Any]) -> Layout:
    """The layout with what a resolved config that has an arm stores in SI units too."""
    if config.get("parameters", {}).get("arm") is None:
        return layout
    variables = (*layout.variables, *twins_of(layout, config).values(), *VALIDITY)
    return replace(layout, variables=variables, over=over_of(config))


def twins_of(layout: Layout, config: Mapping[str, Any]) -> dict[str, Variable]:
    """What is stored in SI units too of a rod's layout, by the name of its variable there, for a config."""
    as_force = any(name in config["parameters"]["arm"] for name in ("force", "force_over_flutter"))
    units = ((variable, _unit_of(variable, as_force)[0]) for variable in layout.variables)
    return {
        v.name: real(twin_of(v.name, unit), unit, _meaning(v, unit), *v.extra) for v, unit in units if unit
    }


def twin_of(name: str, unit: str) -> str:
    """The name under which a variable stands in an SI unit; F becomes the load that it is told in."""
    if name in FREQUENCIES_OF_EVENTS:
        return FREQUENCIES_OF_EVENTS[name]
    words = name.split("_")
    if unit in LOAD_OF_UNIT and "F" in words:
        return "_".join(LOAD_OF_UNIT[unit] if word == "F" else word for word in words)
    return name + (OF_HERTZ if unit == HERTZ else SUFFIX)


def _meaning(variable: Variable, unit: str) -> str:
    """What a variable in an SI unit is: a frequency is no longer angular there."""
    if unit != HERTZ:
        return f"{variable.long_name}; in SI units"
    words = variable.long_name.removeprefix("angular ").partition(",")[0]  # what follows is angular
    return f"{words}; in cycles per second"


def _unit_of(variable: Variable, as_force: bool) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """The SI unit of a variable, what to multiply and to divide by; an empty unit where it is told once."""
    return any_unit_of(variable, as_force) if variable.extra in WITHIN else ("", (), ())


def any_unit_of(variable: Variable, as_force: bool) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """The same of variables that the file tells once too; an empty unit where there is no SI unit."""
    if variable.dtype != "<f8":
        return "", (), ()
    if variable.units == PARAMETERS["F"].unit and (
        "F" in variable.name.split("_") or variable.name in OF_BRANCHES
    ):
        return FORCES["force" if as_force else "pressure"]
    return OF_TIME_AND_LENGTH.get(variable.units, ("", (), ()))


def converted(variable: Variable, values: Array, quantities: Mapping[str, Array]) -> tuple[Variable, Array]:
    """A variable and its values, (n,), in the SI unit that `any_unit_of` says.

    quantities: those of the arm, each of shape () or (n,).
    """
    unit, factors, divisors = any_unit_of(variable, "force" in quantities)
    up, down = (np.prod([quantities[name] for name in names], axis=0) for names in (factors, divisors))
    scale = up / (2 * np.pi * down if unit == HERTZ else down)
    return real(twin_of(variable.name, unit), unit, _meaning(variable, unit)), values * scale


def over_of(config: Mapping[str, Any]) -> tuple[str, ...]:
    """The axes of the grid over an arm's quantities that a resolved config asks for; none for others."""
    parameters = config["parameters"]
    axes = parameters["arm"] | {name: axis for name, axis in parameters.items() if name in PARAMETERS}
    sizes = {name: _size(axis) for name, axis in axes.items() if isinstance(axis, Mapping)}
    return names_over(sizes, makes_diagram(config["task"]))


def _size(axis: Mapping[str, Any]) -> int:
    """How many values a resolved axis has."""
    return len(axis["values"]) if axis.get("values") is not None else int(axis["num"])


def quantities_of(parameters: Axes, points: Points) -> tuple[Filled, ...]:
    """What a file of a config's arm has beside the axes of a grid of parameters; nothing without arm.

    Of a grid over the arm's quantities these are the first, and every parameter on that grid.
    """
    arm = parameters.arm
    if arm is None:
        return ()
    if not points.over:
        return tuple(
            _filled(arm, name, values, (ALONG[name],) if np.ndim(values) else ())
            for name, values in arm.grid_quantities().items()
        )
    numbers = {name: axis.array()[0] for name, axis in arm.given.items() if name not in points.over}
    own = points.units | {name: column for name, column in points.by_name.items() if name not in points.over}
    return (
        *(_filled(arm, name, values, (name,)) for name, values in points.over.items()),
        *(_filled(arm, name, value, ()) for name, value in numbers.items()),
        *(
            _filled(arm, name, column.reshape(points.shape), tuple(points.over))
            for name, column in own.items()
        ),
    )


def _filled(arm: ArmSection, name: str, values: Any, dimensions: tuple[str, ...]) -> Filled:
    """A quantity or a parameter with its values along dimensions."""
    units, meaning = DIMENSIONS[name] if name in PARAMETERS else (QUANTITY_UNITS[name], MEANINGS[name])
    variable = real(name, units, meaning, *dimensions)
    if name in UNITS and getattr(arm, name) is not None:
        variable = replace(variable, typed=typed_unit(name, getattr(arm, name)))
    if name == "drag":
        variable = replace(variable, dtype="|i1", fill=-1, flags=tuple(enumerate(DRAGS)))
    return variable, np.asarray(values, variable.dtype)


def at_points(quantities: Iterable[Filled], points: Points) -> dict[str, NDArray[Any]]:
    """Quantities by name, those along a grid over them at every point, shape (points,)."""
    if not points.over:
        return {variable.name: values for variable, values in quantities}
    dimensions, found = tuple(points.over), {}
    for variable, values in quantities:
        place = [slice(None) if name in variable.extra else None for name in dimensions]
        whole = np.broadcast_to(values[tuple(place)], points.shape).ravel() if variable.extra else values
        found[variable.name] = whole
    return found


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
