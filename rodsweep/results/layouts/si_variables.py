"""Variables in the file of an arm, in addition to the variables of a rod: quantities, and results in SI
units.

A variable such as `period`, in tau2, has the SI variable `period_si`, in s; `frequency`, in rad/tau2, has
`frequency_hz`, in cycles per second. The quantities of the arm, and the derived units tau2, force_scale and
pressure_scale, are coordinates: single numbers, or arrays along a parameter or `point`.
"""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...config.arm.axes import FILE_AXIS_OF_QUANTITY, grid_axis_names
from ...config.arm.quantities import typed_unit
from ...config.arm.section import ArmConfig
from ...config.parameters_section import ParametersSection
from ...config.tasks import makes_diagram
from ...model.arm.drag import DRAG_ESTIMATE_NAMES
from ...model.arm.neglected import Validity
from ...model.arm.quantities import ARM_FILE_VARIABLES, UNITS_AND_EXAMPLES
from ...model.parameters import PARAMETERS
from ...sweep.points.points import Points
from .dimensions import UNIT_AND_LONG_NAME_OF_DIMENSION
from .si_units import (
    FORCE_SI_UNIT_BY_LOAD,
    HERTZ,
    NO_SI_UNIT,
    SI_UNIT_BY_DIMENSIONLESS_UNIT,
    SIUnit,
    load_kind_of,
)
from .variables import FilledVariable, Layout, Variable, real_variable, word_variable

SI_SUFFIX = "_si"
"""Suffix of the name of a variable in SI units."""
HERTZ_SUFFIX = "_hz"
"""Suffix of the name of a frequency in Hz."""
LOAD_KIND_BY_SI_UNIT = {each.unit: load for load, each in FORCE_SI_UNIT_BY_LOAD.items()}
"""Name of the load, "pressure" or "force", by its SI unit."""
HERTZ_NAMES_OF_THRESHOLDS = {
    f"{event}_frequency": f"frequency_{event}_hz" for event in ("hopf", "restabilization")
}
"""Name of the variable in Hz, by name of the variable for the angular frequency at a threshold."""
FORCE_VARIABLES_OF_BRANCHES = ("special_at", "special_error")
"""Names of variables of the task branch that are forces for an arm: its branches are followed along F
only."""
DIMENSIONS_STORED_IN_SI = ((), ("mode",), ("crossing",), ("branch_point",), ("special",))
"""Extra dimensions of variables that are stored in SI units too; longer tables are stored dimensionless
only."""
NEGLECTED_EFFECTS = (
    "inertia_of_the_arm",
    "inertia_of_the_fluid",
    "compression",
    "weight",
    "Reynolds_number",
    "flattening_of_the_wall",
    "extension",
)
"""Effects that the model neglects, named as in `rodsweep.model.arm.neglected` with underscores for blanks;
`extension` stands for the effect `compression` of an arm under a pull, F < 0."""
UNKNOWN_VALIDITY_NUMBER = -1
"""Value of model_applies where the solver may have missed an unstable mode or a cycle."""
VALIDITY_VARIABLES = (
    word_variable(
        "model_applies",
        "whether the model applies to the arm, judged by the effects that it neglects",
        ((UNKNOWN_VALIDITY_NUMBER, "not_known"), *((int(each), each.name) for each in Validity)),
    ),
    word_variable(
        "neglected_effect",
        "largest effect that the model neglects, relative to the limit of each effect",
        ((-1, "none"), *enumerate(NEGLECTED_EFFECTS)),
    ),
    real_variable(
        "neglected_excess",
        "1",
        "size of neglected_effect, in units of the limit beyond which the model does not apply",
    ),
)
"""Variables on the validity of the model for an arm."""


def with_si_variables(layout: Layout, config: Mapping[str, Any]) -> Layout:
    """The layout with the SI and validity variables and the axes of an arm; unchanged without an arm."""
    if config.get("parameters", {}).get("arm") is None:
        return layout
    variables = (*layout.variables, *si_variables_of(layout, config).values(), *VALIDITY_VARIABLES)
    return replace(layout, variables=variables, arm_axes=arm_axis_names(config))


def si_variables_of(layout: Layout, config: Mapping[str, Any]) -> dict[str, Variable]:
    """SI variables for the variables of a layout and a resolved config, by name of the dimensionless
    variable."""
    is_force = load_kind_of(config["parameters"]["arm"]) == "force"
    units = ((variable, _stored_si_unit(variable, is_force).unit) for variable in layout.variables)
    return {
        stored_variable.name: real_variable(
            si_name_of(stored_variable.name, si_unit),
            si_unit,
            _si_long_name(stored_variable, si_unit),
            *stored_variable.extra_dimensions,
        )
        for stored_variable, si_unit in units
        if si_unit
    }


def si_name_of(name: str, unit: str) -> str:
    """Name of the variable in the SI unit `unit` for the variable `name`; F becomes "pressure" or "force"."""
    if name in HERTZ_NAMES_OF_THRESHOLDS:
        return HERTZ_NAMES_OF_THRESHOLDS[name]
    parts = name.split("_")
    if unit in LOAD_KIND_BY_SI_UNIT and "F" in parts:
        return "_".join(LOAD_KIND_BY_SI_UNIT[unit] if word == "F" else word for word in parts)
    return name + (HERTZ_SUFFIX if unit == HERTZ else SI_SUFFIX)


def _si_long_name(variable: Variable, unit: str) -> str:
    """Long name of the SI variable of a dimensionless variable: its long name, followed by "in SI units"; if
    `unit` is HERTZ, without "angular" and the clause after the first comma, followed by "in cycles per
    second"."""
    if unit != HERTZ:
        return f"{variable.long_name}; in SI units"
    # The clause after the comma defines the angular frequency.
    noun = variable.long_name.removeprefix("angular ").partition(",")[0]
    return f"{noun}; in cycles per second"


def _stored_si_unit(variable: Variable, is_force: bool) -> SIUnit:
    """SI unit in which a variable is also stored, or NO_SI_UNIT. is_force: as in `si_unit_of`."""
    return (
        si_unit_of(variable, is_force) if variable.extra_dimensions in DIMENSIONS_STORED_IN_SI else NO_SI_UNIT
    )


def si_unit_of(variable: Variable, is_force: bool) -> SIUnit:
    """SI unit of a dimensionless variable, or NO_SI_UNIT; is_force: whether the arm's load is a force."""
    if variable.dtype != "<f8":
        return NO_SI_UNIT
    if variable.units == PARAMETERS["F"].unit and (
        "F" in variable.name.split("_") or variable.name in FORCE_VARIABLES_OF_BRANCHES
    ):
        return FORCE_SI_UNIT_BY_LOAD["force" if is_force else "pressure"]
    return SI_UNIT_BY_DIMENSIONLESS_UNIT.get(variable.units, NO_SI_UNIT)


def si_variable_and_values(
    variable: Variable, values: Array, quantities: Mapping[str, Array], is_force: bool
) -> tuple[Variable, Array]:
    """Returns (SI variable, its values, (n,)) for a dimensionless variable with the values `values`, (n,).
    quantities: the arm's quantities by name, () or (n,) each. is_force: whether the arm's load is a force."""
    si = si_unit_of(variable, is_force)
    converted = real_variable(si_name_of(variable.name, si.unit), si.unit, _si_long_name(variable, si.unit))
    return converted, values * si.scale(quantities)


def arm_axis_names(config: Mapping[str, Any]) -> tuple[str, ...]:
    """Names of the axes of a grid over an arm's quantities in a resolved config; else empty."""
    parameters = config["parameters"]
    axes = parameters["arm"] | {name: axis for name, axis in parameters.items() if name in PARAMETERS}
    ranges = {name: axis for name, axis in axes.items() if isinstance(axis, Mapping)}
    sizes = {name: len(axis.get("values") or ()) or int(axis["num"]) for name, axis in ranges.items()}
    return grid_axis_names(sizes, makes_diagram(config["task"]))


def arm_variables(parameters: ParametersSection, points: Points) -> tuple[FilledVariable, ...]:
    """(variable, values) of each quantity and unit of a config's arm; empty if the config has no arm.

    For a grid over quantities: the axes, constant quantities, then units and parameters at every grid point.
    """
    arm = parameters.arm
    if arm is None:
        return ()
    if not points.arm_axes:
        quantities = arm.quantity_values_on_grid()
        along = {
            n: (FILE_AXIS_OF_QUANTITY[n],) if np.ndim(quantity_values) else ()
            for n, quantity_values in quantities.items()
        }
        return tuple(_si_variable_and_values(arm, n, values, along[n]) for n, values in quantities.items())
    axes = points.arm_axes
    numbers = {name: axis.array()[0] for name, axis in arm.quantity_axes.items() if name not in axes}
    columns = points.arm_units | {n: column for n, column in points.columns_by_name.items() if n not in axes}
    shape = points.shape
    return (
        *(_si_variable_and_values(arm, name, values, (name,)) for name, values in axes.items()),
        *(_si_variable_and_values(arm, name, value, ()) for name, value in numbers.items()),
        *(
            _si_variable_and_values(arm, n, column.reshape(shape), tuple(axes))
            for n, column in columns.items()
        ),
    )


def _si_variable_and_values(
    arm: ArmConfig, name: str, values: Any, dimensions: tuple[str, ...]
) -> FilledVariable:
    """(variable, values) of the arm's quantity or parameter `name`, along the given dimensions."""
    units, meaning = (
        UNIT_AND_LONG_NAME_OF_DIMENSION[name] if name in PARAMETERS else ARM_FILE_VARIABLES[name][:2]
    )
    variable = real_variable(name, units, meaning, *dimensions)
    if name in UNITS_AND_EXAMPLES and getattr(arm, name) is not None:
        variable = replace(variable, typed_unit=typed_unit(name, getattr(arm, name)))
    if name == "drag":
        variable = replace(variable, dtype="|i1", fill_value=-1, flags=tuple(enumerate(DRAG_ESTIMATE_NAMES)))
    return variable, np.asarray(values, variable.dtype)


def quantities_at_points(quantities: Iterable[FilledVariable], points: Points) -> dict[str, NDArray[Any]]:
    """Values of an arm's quantities by name. For a grid over quantities: a value for every point, (points,),
    or () for a quantity that does not vary."""
    if not points.arm_axes:
        return {variable.name: values for variable, values in quantities}
    dimensions = tuple(points.arm_axes)
    result = {}
    for variable, values in quantities:
        index = tuple(slice(None) if name in variable.extra_dimensions else None for name in dimensions)
        is_axis = bool(variable.extra_dimensions)
        result[variable.name] = np.broadcast_to(values[index], points.shape).ravel() if is_axis else values
    return result


def si_values(
    record: Mapping[str, Any],
    index: int | NDArray[np.int64],
    layout: Layout,
    quantities: Mapping[str, NDArray[Any]],
    is_force: bool,
) -> dict[str, Any]:
    """Values of the SI variables, by name, of one point or of n points.

    record: dimensionless variables by name, of one point, or (n, ...). index: flat index of the point, or
    (n,). quantities: the arm's quantities by name, () or (points,) each. is_force: whether the arm's load is
    a force."""
    values = {}
    for variable in layout.variables:
        si_unit = _stored_si_unit(variable, is_force)
        if si_unit.unit:
            needed = {name: quantities[name] for name in (*si_unit.factors, *si_unit.divisors)}
            at_index = {name: array[index] if np.ndim(array) else array for name, array in needed.items()}
            value = np.asarray(record[variable.name])
            scale = si_unit.scale(at_index)
            shape = scale.shape + (1,) * (value.ndim - scale.ndim)
            values[si_name_of(variable.name, si_unit.unit)] = value * scale.reshape(shape)
    return values
