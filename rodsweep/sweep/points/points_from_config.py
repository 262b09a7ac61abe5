"""Points of a sweep from a config; parameter values outside the model are refused."""

import math
from collections.abc import Iterable
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, list_of
from ...config.arm.axes import MAX_ARM_GRID_POINTS
from ...config.arm.status import CRUSHED, SLENDER
from ...config.base_config import Config
from ...errors import InputError
from ...model.arm.refusals import CRUSHED_FORCE_RATIO
from ...model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ...model.parameters import FORCE_AND_STRETCH_STIFFNESS, PARAMETERS, Range
from ...model.rod import Rod
from .arm_grid import grid_of_arms
from .csv_points import read_points
from .flutter_forces import (
    FlutterForceByRod,
    flutter_force_of_rod,
    rods_needing_flutter_force,
    smallest_flutter_force_of_arm,
)
from .points import Points


def parameter_grid_size(config: Config) -> int:
    """Number of points of a grid of parameters, without computing the values on the axes; 0 for a list or a
    grid over an arm's quantities."""
    if config.parameters.is_list or config.parameters.arm_axes:
        return 0
    return math.prod(config.parameters.axes[name].size for name in config.parameter_names)


def points_of(config: Config, directory: Path, flutter_forces: FlutterForceByRod | None = None) -> Points:
    """Points of the sweep that a config describes; raises InputError for a parameter value outside the model,
    and for an invalid file of points. directory: folder to which a relative file name refers. flutter_forces:
    flutter forces of all rods of `rods_for_flutter_forces`; if None, this function computes the forces."""
    parameters = config.parameters
    for name, value in parameters.constant_parameters.items():
        require_in_range(PARAMETERS[name].allowed_range, name, (value,))
    if parameters.points is not None:
        columns = read_points(directory / parameters.points, config.parameter_names, config.rod_material)
        return Points(config.parameter_names, columns, is_grid=False)
    axes = {name: axis.array() for name, axis in parameters.axes.items()}
    if parameters.arm is not None and parameters.arm_axes:
        for name, column in axes.items():
            require_in_range(PARAMETERS[name].allowed_range, name, column)
        try:
            forces = flutter_forces or {
                rod: flutter_force_of_rod(rod) for rod in rods_for_flutter_forces(config)
            }
            # The forces are solved once for all points, or were solved on several ranks before.
            find_flutter_force = partial(
                smallest_flutter_force_of_arm, flutter_forces=forces, material=config.stated_rod_material
            )
            return grid_of_arms(
                parameters.arm, axes, config.parameter_names, find_flutter_force, config.rod_material
            )
        except ValueError as error:
            raise InputError(str(error)) from None
    columns_by_name = {name: axes[name] for name in config.parameter_names}
    validity_codes = (
        None
        if parameters.arm is None
        else _status_codes_if_some_crushed(columns_by_name, config.rod_material)
    )
    refuse_invalid_axes(axes, config.allows_crushed_rods or validity_codes is not None, config.rod_material)
    return Points(
        config.parameter_names,
        tuple(columns_by_name.values()),
        is_grid=True,
        validity_codes=validity_codes,
    )


def _status_codes_if_some_crushed(axes: dict[str, Array], material: RodMaterial) -> NDArray[np.int8] | None:
    """Status codes CRUSHED or SLENDER, (points,), of a grid of parameters in which the load crushes some
    rods. None if all rods or no rods are crushed, for a grid without F or k1, and for grids of more than
    MAX_ARM_GRID_POINTS points. axes: values of each parameter, (n,)."""
    count = math.prod(map(len, axes.values()))
    if not set(FORCE_AND_STRETCH_STIFFNESS) <= axes.keys() or count > MAX_ARM_GRID_POINTS:
        return None
    columns = {
        name: axes[name].reshape([-1 if axis_name == name else 1 for axis_name in axes]) for name in axes
    }
    ratios = material.crushing_forces_over_k1(columns.get("taper", np.ones(1)))
    # The usual case, without an array for all points.
    if axes["F"].max() < axes["k1"].min() * ratios.min():
        return None
    shape = tuple(map(len, axes.values()))
    is_crushed = np.broadcast_to(CRUSHED_FORCE_RATIO * columns["k1"] * ratios <= columns["F"], shape).ravel()
    # A grid of crushed rods only is refused elsewhere, with a message.
    return None if is_crushed.all() else np.where(is_crushed, CRUSHED, SLENDER).astype(np.int8)


def rods_for_flutter_forces(config: Config) -> list[Rod]:
    """The distinct rods whose flutter forces the points of a config need; InputError for an invalid arm."""
    taper_axis = config.parameters.given_axes.get("taper")
    if taper_axis is None:
        return rods_needing_flutter_force(config.parameters.arm, config.stated_rod_material)
    require_in_range(PARAMETERS["taper"].allowed_range, "taper", taper_axis.array())
    return rods_needing_flutter_force(
        config.parameters.arm, config.stated_rod_material, list_of(taper_axis.array())
    )


def require_in_range(
    allowed: Range, name: str, values: Iterable[float], place: str = "", reason: str = ""
) -> None:
    """Raises InputError for the first of `values` outside the range `allowed` of the parameter `name`.
    place, reason: phrases inserted into the message after the value and at the end."""
    invalid_value = allowed.first_outside(values)
    if invalid_value is not None:
        allowed_text = allowed.description_for_rejected(invalid_value)
        raise InputError(
            f"parameters.{name} = {invalid_value:g} is not allowed{place}; it must be {allowed_text}{reason}"
        )


def refuse_invalid_axes(
    axes: dict[str, Array], allows_crushed_rods: bool = False, material: RodMaterial = DEFAULT_MATERIAL
) -> None:
    """Raises InputError if a value on an axis is outside the range of its parameter, or if rods are crushed.
    axes: values, (n,), by name of the parameter. allows_crushed_rods: whether some rods, but not all rods, of
    the grid may be crushed. material: constitutive law and profile of the rods."""
    for name, column in axes.items():
        require_in_range(PARAMETERS[name].allowed_range, name, column)
    if not set(FORCE_AND_STRETCH_STIFFNESS) <= axes.keys():
        return
    tapers = axes.get("taper", np.ones(1))
    try:
        material.refuse_extreme_load(axes["F"], float(axes["k1"].min()), float(tapers.min()))
    except ValueError as error:
        raise InputError(f"parameters.{error}") from None
    crushing_forces = material.crushing_forces_over_k1(tapers)
    if (crushing_forces == 1).all():
        _refuse_crushed(axes["F"], axes["k1"], allows_crushed_rods)
    elif allows_crushed_rods and axes["F"].min() >= axes["k1"].max() * crushing_forces.max():
        raise InputError(
            f"parameters.F starts at {axes['F'].min():.15g}, but the weakest section of all arms is crushed "
            f"at {axes['k1'].max() * crushing_forces.max():.15g}; F must start below"
        )
    elif not allows_crushed_rods and axes["F"].max() >= axes["k1"].min() * crushing_forces.min():
        raise InputError(
            f"parameters.F reaches {axes['F'].max():.15g}, but the weakest section of the arms is crushed at "
            f"{axes['k1'].min() * crushing_forces.min():.15g}; F must stay below"
        )


def _refuse_crushed(F: Array, k1: Array, allows_crushed_rods: bool) -> None:
    """Raises InputError if any rod of a grid is crushed or, with `allows_crushed_rods`, if all rods are
    crushed. F, k1: values on the axes, (n,). allows_crushed_rods: whether some rods may be crushed."""
    if allows_crushed_rods and F.min() >= k1.max():
        raise InputError(
            f"parameters.F starts at {F.min():.15g} and parameters.k1 ends at {k1.max():.15g}; the rod is "
            "crushed where F >= k1, which is everywhere here"
        )
    if not allows_crushed_rods and F.max() >= k1.min():
        raise InputError(
            f"parameters.F reaches {F.max():.15g} and parameters.k1 starts at {k1.min():.15g}; F must stay "
            "below every k1, because the rod is crushed at F = k1"
        )
