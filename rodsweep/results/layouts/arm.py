"""What the file of an arm holds beside that of a rod: its quantities, and results in SI units too.

A variable such as `period`, in tau2, has `period_si`, in s; `frequency`, in rad/tau2, has `frequency_hz`, in
cycles per second. The quantities of the arm, and the units tau2,
force_scale and pressure_scale that they make, are coordinates: numbers, or along a parameter or `point`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import prod
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...config.arm.axes import ALONG, names_over
from ...config.arm.quantities import typed_unit
from ...config.arm.section import ArmSection
from ...config.axes import Axes
from ...config.tasks import makes_diagram
from ...model.arm.drag import DRAGS
from ...model.arm.neglected import Validity
from ...model.arm.quantities import ALL_QUANTITIES, LOADS, RELATIVE, SCALE_OF, UNITS
from ...model.parameters import PARAMETERS
from ...sweep.points.points import Points
from .variables import ANGULAR, DIMENSIONS, Filled, Layout, Variable, real, word

SUFFIX, OF_HERTZ = "_si", "_hz"
HERTZ = "Hz"
"""Cycles per second: what is counted on the bench. A radian a second is told nowhere."""


class UnitOfArm(NamedTuple):
    """An SI unit of results: one dimensionless unit is the product of `factors` over that of `divisors`.

    Of a frequency, which is angular without dimension, in turns: in Hz.
    """

    unit: str = ""
    factors: tuple[str, ...] = ()
    divisors: tuple[str, ...] = ()

    def scale(self, quantities: Mapping[str, Any]) -> NDArray[Any]:
        """The dimensionless unit in this one, from quantities of shape () or (n,): of shape () or (n,)."""
        up, down = (prod(quantities[name] for name in names) for names in (self.factors, self.divisors))
        return np.asarray(up / (2 * np.pi * down if self.unit == HERTZ else down))


NO_UNIT = UnitOfArm()
"""Of what has no SI unit."""
OF_TIME_AND_LENGTH = {
    "tau2": UnitOfArm("s", ("tau2",)),
    "1/tau2": UnitOfArm("1/s", (), ("tau2",)),
    ANGULAR: UnitOfArm(HERTZ, (), ("tau2",)),
    "L": UnitOfArm("m", ("length",)),
    "k3/L": UnitOfArm("J", ("force_scale", "length")),
    "k3/(L tau2)": UnitOfArm("W", ("force_scale", "length"), ("tau2",)),
}
"""Dimensionless units in SI."""
FORCES = {load: UnitOfArm(UNITS[load][0], (SCALE_OF[load],)) for load in LOADS}
"""What a follower force is told in: as the load of the arm is given, a pressure where none is."""
LOAD_OF_UNIT = {each.unit: load for load, each in FORCES.items()}
FREQUENCIES_OF_EVENTS = {
    f"{event}_frequency": f"frequency_{event}_hz" for event in ("hopf", "restabilization")
}
"""Names in Hz of the frequencies at thresholds, as `pressure_hopf` is that of F_hopf."""
OF_BRANCHES = ("special_at", "special_error")
"""Forces along the branches of an arm, which are followed in nothing else."""
WITHIN = ((), ("mode",), ("crossing",), ("branch_point",), ("special",))
"""Dimensions beside the points of what is told in SI units too; longer tables are not stored twice."""

EFFECTS = ("inertia_of_the_arm", "inertia_of_the_fluid", "compression", "weight", "Reynolds_number")
"""What the model leaves out, as `rodsweep.model.arm.neglected` names it but for the blanks."""
VALIDITY = (
    word(
        "model_applies",
        "whether the model applies to the arm, by all that it leaves out",
        ((-1, "not_known"), *((int(each), each.name) for each in Validity)),
    ),
    word(
        "neglected_effect",
        "what the model leaves out that is largest, in units of its limit",
        ((-1, "none"), *enumerate(EFFECTS)),
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
    as_force = any(RELATIVE.get(name, name) == "force" for name in config["parameters"]["arm"])
    units = ((variable, _unit_of(variable, as_force).unit) for variable in layout.variables)
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


def _unit_of(variable: Variable, as_force: bool) -> UnitOfArm:
    """The SI unit of a variable; NO_UNIT where it is told once."""
    return any_unit_of(variable, as_force) if variable.extra in WITHIN else NO_UNIT


def any_unit_of(variable: Variable, as_force: bool) -> UnitOfArm:
    """The same of variables that the file tells once too; NO_UNIT where there is no SI unit."""
    if variable.dtype != "<f8":
        return NO_UNIT
    if variable.units == PARAMETERS["F"].unit and (
        "F" in variable.name.split("_") or variable.name in OF_BRANCHES
    ):
        return FORCES["force" if as_force else "pressure"]
    return OF_TIME_AND_LENGTH.get(variable.units, NO_UNIT)


def converted(variable: Variable, values: Array, quantities: Mapping[str, Array]) -> tuple[Variable, Array]:
    """A variable and its values, (n,), in the SI unit that `any_unit_of` says.

    quantities: those of the arm, each of shape () or (n,).
    """
    si = any_unit_of(variable, "force" in quantities)
    told = real(twin_of(variable.name, si.unit), si.unit, _meaning(variable, si.unit))
    return told, values * si.scale(quantities)


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
    units, meaning = DIMENSIONS[name] if name in PARAMETERS else ALL_QUANTITIES[name][:2]
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
    found = {}
    for variable in layout.variables:
        si = _unit_of(variable, "force" in quantities)
        if si.unit:
            used = {name: quantities[name] for name in (*si.factors, *si.divisors)}
            here = {name: array[index] if np.ndim(array) else array for name, array in used.items()}
            value, scale = np.asarray(record[variable.name]), si.scale(here)
            shape = scale.shape + (1,) * (value.ndim - scale.ndim)
            found[twin_of(variable.name, si.unit)] = value * scale.reshape(shape)
    return found
