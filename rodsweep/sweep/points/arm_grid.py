"""Grid over the quantities of an arm: each point has its own rod, or the status code of the reason why the
rod model does not apply."""

from collections.abc import Callable, Mapping, Sequence
from operator import attrgetter, methodcaller
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...config.arm.section import ArmConfig
from ...config.arm.status import CRUSHED, FLUTTER_UNKNOWN, NO_FLUTTER, SLENDER, ArmOutsideModel
from ...model.arm.arm import SlenderArm
from ...model.arm.quantities import ARM_SCALES, LOAD_NAME_BY_RELATIVE_LOAD, LOAD_SCALE_NAME_BY_LOAD
from ...model.arm.refusals import CRUSHED_FORCE_RATIO
from ...model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES, parameter_names_except
from .flutter_forces import FlutterForce
from .points import Points

FlutterForceFinder = Callable[[SlenderArm, float | None], FlutterForce]
"""Function from (arm, taper that replaces the arm's taper or None) to the force of first flutter."""
FlutterForceArray = NDArray[np.object_]
"""Array of `FlutterForce` objects, (arms, 1, combinations), for all combinations of values of the parameters
that replace the arm's parameters."""
ARM_PARAMETER_NAMES = parameter_names_except("F", NONLINEAR_ROD_PARAMETER_NAMES)
"""Names of the parameters that follow from the quantities of an arm without its load, except the taper."""
NO_FORCE = FlutterForce(np.nan)
"""Force (nan) of an arm without load, or of an arm to which the rod model does not apply."""


def grid_of_arms(
    arm_config: ArmConfig,
    given_parameters: Mapping[str, Array],
    names: tuple[str, ...],
    find_force: FlutterForceFinder,
    material: RodMaterial = DEFAULT_MATERIAL,
) -> Points:
    """Points of a grid over an arm's quantities, and over the parameters in `given_parameters` that have
    several values.

    given_parameters: values, (n,), of the parameters that replace the arm's parameters, by name. names: the
    parameters of the task. find_force: finds the force of first flutter of an arm, for relative loads.
    material: constitutive law and profile of all arms. Raises ValueError if the rod model applies to no
    point.
    """
    arms, statuses = zip(*(_arm_and_status(arm_config, v) for v in arm_config.values_of_arms()), strict=True)
    # The load is an axis of its own, as all loads on one arm share its search for flutter.
    loads = arm_config.quantity_axes[arm_config.load_key].array() if arm_config.load_key else np.zeros(1)
    grid = dict(zip(given_parameters, np.meshgrid(*given_parameters.values(), indexing="ij"), strict=True))
    shape = (len(arms), len(loads), next(iter(grid.values())).size if grid else 1)
    own_names = (*ARM_PARAMETER_NAMES, *arm_config.cone_parameter_names)
    table = {name: _quantity_of_arms(arms, methodcaller("parameter", name)) for name in own_names}
    units = {name: _quantity_of_arms(arms, attrgetter(name)) for name in ARM_SCALES}
    forces = _F_of_unit_load_on_arms(arm_config, arms, grid.get("taper"), find_force)
    unit_load_F = np.vectorize(attrgetter("F"), otypes=[float])(forces)
    # A copy, because a broadcast array cannot be written.
    codes = np.broadcast_to(_array_along(0, statuses), shape).copy()
    if arm_config.load_key in LOAD_NAME_BY_RELATIVE_LOAD:
        codes = _with_flutter_codes(codes, unit_load_F)
    if arm_config.load_name:
        # An arm that does not flutter has no load relative to flutter.
        table["F"] = np.where(np.isinf(unit_load_F), np.nan, unit_load_F) * _array_along(1, loads)
        if arm_config.load_key in LOAD_NAME_BY_RELATIVE_LOAD:
            units[arm_config.load_name] = table["F"] * units[LOAD_SCALE_NAME_BY_LOAD[arm_config.load_name]]
    table |= {name: _array_along(2, column.ravel()) for name, column in grid.items()}
    materials = tuple(arm.material if arm else DEFAULT_MATERIAL for arm in arms if arm_config.is_nonuniform)
    if "F" in table:
        ratios = material.crushing_forces_over_k1(table.get("taper", np.ones(1)))
        if materials:
            ratios = _quantity_of_arms(arms, lambda arm: arm.crushing_force / arm.k1)
        is_crushed = np.broadcast_to(table["F"] >= CRUSHED_FORCE_RATIO * table["k1"] * ratios, shape)
        # A reason found earlier stays: a crushing force means nothing for an arm outside the model.
        codes[(codes == SLENDER) & is_crushed] = CRUSHED
    if (codes != SLENDER).all():
        _refuse_grid_without_rods(arm_config, given_parameters, bool((codes == NO_FLUTTER).any()), forces)
    axes = {name: arm_config.quantity_axes[name].array() for name in arm_config.varying_quantities}
    values = axes | {name: column for name, column in given_parameters.items() if len(column) > 1}
    columns = tuple(np.broadcast_to(table[name], shape).ravel() for name in names)
    units = {name: np.broadcast_to(column, shape).ravel() for name, column in units.items()}
    failures = _flutter_search_failures(codes, forces)
    validity_codes = codes.astype(np.int8).ravel()
    return Points(names, columns, False, values, units, DEFAULT_MATERIAL, materials, validity_codes, failures)


def _quantity_of_arms(arms: Sequence[SlenderArm | None], quantity: Callable[[SlenderArm], float]) -> Array:
    """Values of `quantity` for all arms, (arms, 1, 1); nan for None, an arm outside the rod model."""
    return _array_along(0, [quantity(arm) if arm else np.nan for arm in arms])


def _arm_and_status(arm_config: ArmConfig, values: Mapping[str, float]) -> tuple[SlenderArm | None, int]:
    """Returns (arm without load, status code). The arm is None if the rod model does not apply. values:
    quantities of the arm in SI units, by name."""
    try:
        return arm_config.arm_of(values), SLENDER
    except ArmOutsideModel as error:
        return None, error.status


def _F_of_unit_load_on_arms(
    arm_config: ArmConfig,
    arms: Sequence[SlenderArm | None],
    tapers: Array | None,
    find_force: FlutterForceFinder,
) -> FlutterForceArray:
    """Dimensionless F of a unit load (see `_F_of_unit_load_on_arm`), (arms, 1, n). tapers: n values that
    replace the arms' taper; n = 1 without replacement if None, or if the load is not relative to flutter."""
    given_tapers = (
        [None]
        if tapers is None or arm_config.load_key not in LOAD_NAME_BY_RELATIVE_LOAD
        else tapers.ravel().tolist()
    )
    forces = np.empty((len(arms), 1, len(given_tapers)), object)
    for i, arm in enumerate(arms):
        # Each taper is searched once, although it occurs in many combinations.
        force_by_taper = {
            taper: _F_of_unit_load_on_arm(arm_config, arm, taper, find_force) for taper in set(given_tapers)
        }
        forces[i, 0] = [force_by_taper[taper] for taper in given_tapers]
    return forces


def _F_of_unit_load_on_arm(
    arm_config: ArmConfig, arm: SlenderArm | None, taper: float | None, find_force: FlutterForceFinder
) -> FlutterForce:
    """Dimensionless force F of a unit load on an arm; NO_FORCE if `arm` is None or has no load. The unit load
    is 1 Pa or 1 N; for a load relative to flutter, the load at first flutter. taper: replaces the arm's taper
    unless None."""
    if arm is None or not arm_config.load_name:
        return NO_FORCE
    if arm_config.load_key in LOAD_NAME_BY_RELATIVE_LOAD:
        return find_force(arm, taper)
    return FlutterForce(1.0 / getattr(arm, LOAD_SCALE_NAME_BY_LOAD[arm_config.load_name]))


def _with_flutter_codes(status_codes: Array, flutter_F: Array) -> Array:
    """Status codes `status_codes`, with NO_FLUTTER and FLUTTER_UNKNOWN where a relative load has no value.
    flutter_F: F at flutter; inf without flutter, nan if unknown. The shapes broadcast to (arms, loads, n)."""
    rod_codes = np.where(
        np.isinf(flutter_F), NO_FLUTTER, np.where(np.isnan(flutter_F), FLUTTER_UNKNOWN, SLENDER)
    )
    result: Array = np.where(status_codes == SLENDER, rod_codes, status_codes)
    return result


def _flutter_search_failures(status_codes: Array, forces: FlutterForceArray) -> dict[int, str]:
    """Reasons why the search for flutter failed, by flat index of the point. status_codes: (arms, loads,
    combinations of replaced parameters). forces: result of `_F_of_unit_load_on_arms`."""
    force_of_points = np.broadcast_to(forces, status_codes.shape).ravel()
    return {
        int(index): force_of_points[index].failure
        for index in np.flatnonzero(status_codes == FLUTTER_UNKNOWN)
    }


def _refuse_grid_without_rods(
    arm_config: ArmConfig,
    given_parameters: Mapping[str, Array],
    has_arm_without_flutter: bool,
    forces: FlutterForceArray,
) -> None:
    """Raises ValueError with the reason why the rod model applies to no point. given_parameters: values,
    (n,), of the parameters that replace the arm's parameters, by name. has_arm_without_flutter: whether some
    arm does not flutter. forces: result of `_F_of_unit_load_on_arms`."""
    # The first arm is made once more, because its own message is better than a general one.
    arm_config.arm_of(arm_config.first_si_values, with_load=True)
    for force in forces.ravel():
        if force.failure:
            raise ValueError(f"parameters.arm.{arm_config.load_name}: {force.failure}")
    if has_arm_without_flutter:
        raise ValueError(
            f"parameters.arm.{arm_config.load_name} is relative to flutter, but with the likeliest drag no "
            "arm flutters; give an absolute load"
        )
    k1 = float(given_parameters["k1"][0])
    raise ValueError(
        f"parameters.k1 = {k1:.15g} is below every F, so the rod is crushed; lower the load or raise k1"
    )


def _array_along(dimension: int, values: Any) -> Array:
    """`values`, (n,), as a 3-D array, along dimension 0 (arms), 1 (loads) or 2 (replaced parameters)."""
    return np.asarray(values).reshape([-1 if i == dimension else 1 for i in range(3)])
