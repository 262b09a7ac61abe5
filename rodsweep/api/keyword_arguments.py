"""Conversion of the keyword arguments of a call into a config tree, and of the tree into a validated job."""

import os
from collections.abc import Collection, Mapping
from enum import Enum
from pathlib import Path
from typing import Any, TypedDict, TypeVar

import numpy as np

from ..config.arm.section import ArmConfig
from ..config.base_config import Config
from ..config.document.call_argument_errors import refusing_wrong_arguments, unknown_argument_error
from ..config.document.reading import validated_config, with_file_contents
from ..config.document.refusals import similar_keys
from ..config.material import MaterialConfig
from ..config.tasks import CONFIG_CLASSES_BY_TASK
from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.arm.drag import DRAG_ESTIMATE_NAMES
from ..model.arm.quantities import LOAD_NAME_BY_RELATIVE_LOAD, LOAD_NAMES
from ..model.material.rod_material import DEFAULT_MATERIAL
from ..solve.solve_lock import defer_signals
from ..tasks.running.job import Job, job_of_config, machine_memory

AnyArm = TypeVar("AnyArm", bound=SlenderArm)
"""Type variable for the class of an arm, for functions that return an arm of the class of their argument."""
ARM_KEY_DEFAULTS = {
    "drag": DRAG_ESTIMATE_NAMES[0],
    "law": DEFAULT_MATERIAL.law,
    "section": DEFAULT_MATERIAL.section,
}
"""Default values of drag, law and section. A key of an arm with its default value is not written into the
config tree."""
ConfigTree = dict[str, Any]
"""Config tree: keys and values as read from a YAML config."""


def config_tree(task: str, keywords: Mapping[str, Any]) -> ConfigTree:
    """Config tree of a task from keyword arguments: every key is put into its section of the config.

    A misspelt key is put into the section with the most similar key, so that validation suggests this key. A
    complete section may be given as a mapping. Raises InputError for a masked value, and for a key that is
    not similar to any known key, or given twice.
    """
    task = keyword_value_of_yaml_types("task", task)
    tree: ConfigTree = {"task": task}
    if not isinstance(task, str) or task not in CONFIG_CLASSES_BY_TASK:
        return tree
    sections = _allowed_keys_by_section(task)
    for keyword, value in keywords.items():
        name = value_of_yaml_types(keyword)
        if name in sections and isinstance(value, Mapping):
            for key, entry in keyword_value_of_yaml_types(name, dict(value)).items():
                _add_key(tree.setdefault(name, {}), key, entry)
            continue
        section = _best_matching_section(name, sections)
        values_of_section = tree.setdefault(section, {}) if section else tree
        _add_key(
            values_of_section,
            name,
            keyword_value_of_yaml_types(f"{section}.{name}" if section else name, value),
        )
    _replace_arm_by_quantities(task, tree)
    return tree


def _add_key(section: dict[str, Any], key: str, value: Any) -> None:
    """Adds a key to a section of a config tree. Raises InputError if the section has the key already."""
    if key in section:
        raise InputError(f"{key} is given twice, as an argument and in a mapping; give it once")
    section[key] = value


def _replace_arm_by_quantities(task: str, tree: ConfigTree) -> None:
    """Replaces an `rs.Arm` in the tree by its quantities, in place. The load is included only if the task
    takes a load."""
    parameters = tree.get("parameters", {})
    arm = parameters.get("arm")
    if isinstance(arm, SlenderArm):
        has_load = "F" in CONFIG_CLASSES_BY_TASK[task].rod_parameters_used(tree.get(task, {}))
        omitted = (*LOAD_NAME_BY_RELATIVE_LOAD, "load_kind", *(() if has_load else LOAD_NAMES))
        names = [name for name in ArmConfig.model_fields if name not in omitted]
        complete_arm = with_load_in_si(arm) if has_load else arm
        quantities = {name: getattr(complete_arm, name) for name in names}
        if not has_load and arm.load_name == "force":  # loads at thresholds have the unit of the arm's load
            quantities["load_kind"] = arm.load_name
        given = {name: value for name, value in quantities.items() if value is not None}
        written = {
            quantity_name: quantity
            for quantity_name, quantity in given.items()
            if quantity_name not in ARM_KEY_DEFAULTS or quantity != ARM_KEY_DEFAULTS[quantity_name]
        }
        parameters["arm"] = {name: value_of_yaml_types(value) for name, value in written.items()}


def with_load_in_si(arm: AnyArm) -> AnyArm:
    """The arm with its load in SI units. For a load relative to flutter, the flutter threshold is computed
    first."""
    if arm.load_over_flutter is None:
        return arm
    from ..verdict.planes import arm_with_absolute_load

    return arm_with_absolute_load(arm)


@defer_signals
def job_of_tree(tree: ConfigTree) -> Job:
    """The validated job of a config tree; InputError, as on the command line, for bad input.

    Raises InputError also if the results do not fit into memory.
    """
    config = validated_config(with_file_contents(tree, Path()))
    job = job_of_config(Path(config.task), config, tree)
    size = job.points.count * job.layout.bytes_per_point
    if size > machine_memory():
        raise InputError(
            f"the results of {job.points.count:.6g} points take {size / 1e9:.3g} GB, more than the "
            f"{machine_memory() / 1e9:.3g} GB of memory of this machine; `rodsweep run` writes them into a "
            "file"
        )
    return job


def validated_point_count(tree: ConfigTree) -> int | None:
    """Number of points of a config tree. Raises InputError for a tree that `job_of_tree` refuses, before any
    rank of a run starts.

    For loads relative to flutter only the config is validated, because the points need a search for flutter,
    which the ranks of the run share; the result is then None.
    """
    arm = validated_config(with_file_contents(tree, Path())).parameters.arm
    if arm is None or arm.load_key not in LOAD_NAME_BY_RELATIVE_LOAD:
        return job_of_tree(tree).points.count
    return None


def _allowed_keys_by_section(task: str) -> dict[str, Collection[str]]:
    """Allowed keys of each section of a task's config, by name of the section; "" is the top level."""
    fields = CONFIG_CLASSES_BY_TASK[task].model_fields
    sections: dict[str, Any] = {name: fields[name].annotation for name in (task, "parameters")}
    sections["material"] = MaterialConfig
    top_keys = [name for name in Config.model_fields if name not in ("task", "parameters", "material")]
    return {name: tuple(section.model_fields) for name, section in sections.items()} | {"": top_keys}


def _best_matching_section(name: str, sections: Mapping[str, Collection[str]]) -> str:
    """Name of the first section with the key `name`, or else with the most similar key. sections: allowed
    keys by name of the section. Raises InputError if no key is similar."""
    section = next((section for section, allowed in sections.items() if name in allowed), None)
    return _best_matching_section(_most_similar_key(name, sections), sections) if section is None else section


def _most_similar_key(name: str, sections: Mapping[str, Collection[str]]) -> str:
    """The allowed key that is most similar to the unknown key `name`. For a quantity of an arm, whose section
    is not in `sections`, the first allowed key may be returned: validation then names the right section.
    Raises InputError with a list of all keys if no key is similar."""
    allowed = [key for keys in sections.values() for key in keys]
    similar = similar_keys(name, allowed)
    if not similar and name not in ArmConfig.model_fields:
        raise unknown_argument_error(name, allowed)
    return similar[0] if similar else allowed[0]


class AxisRange(TypedDict):
    """An axis of a sweep as a range. start, stop: first and last value; for a quantity of an arm, with a
    unit. num: number of values. spacing: "linear" or "log"."""

    start: float | str
    stop: float | str
    num: int
    spacing: str


@refusing_wrong_arguments("rs.linspace(0, 10, num=11)")
def linspace(start: float | str, stop: float | str, num: int) -> AxisRange:
    """An axis of a sweep with `num` equally spaced values from start to stop.

    For a quantity of an arm, start and stop have units, as "2 kPa".
    """
    return _axis_range(start, stop, num, "linear")


@refusing_wrong_arguments("rs.logspace(10, 1e6, num=31)")
def logspace(start: float | str, stop: float | str, num: int) -> AxisRange:
    """An axis of a sweep with `num` values from start to stop in equal ratios.

    start and stop are the end values, as for NumPy's `geomspace`, not exponents.
    """
    return _axis_range(start, stop, num, "log")


def _axis_range(start: float | str, stop: float | str, num: int, spacing: str) -> AxisRange:
    """An axis of a sweep as a range with the keys of an `AxisRange`; InputError for a masked value."""
    for name, value in (("start", start), ("stop", stop), ("num", num)):
        if np.ma.is_masked(value):
            raise InputError(f"{name} is masked, so it is not a number; give a number")
    return {"start": start, "stop": stop, "num": num, "spacing": spacing}


def value_of_yaml_types(value: Any) -> Any:
    """A value in the types of a YAML config. Arrays and tuples become lists. NumPy scalars, also as keys,
    become numbers, booleans or texts of Python, and so do members of an IntEnum or StrEnum. Paths become
    texts.

    A pint quantity becomes a text with its unit, and an array of pint quantities a list of such texts. Raises
    ValueError for masked values.
    """
    if isinstance(value, Enum) and isinstance(value, int | float | str):
        value = value.value
    if isinstance(value, dict):
        return {value_of_yaml_types(key): value_of_yaml_types(item) for key, item in value.items()}
    if isinstance(value, list | tuple | range):
        return [value_of_yaml_types(item) for item in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "to_base_units"):  # a pint quantity; np.asarray would drop its unit
        return _with_unit(value_of_yaml_types(value.magnitude), f"{value.units:~C}")
    if np.ma.is_masked(value):
        raise ValueError("a value of the array is masked, so it is not a number; leave it out")
    if hasattr(value, "__array__"):
        array = np.asarray(value)
        return (array.astype(float) if array.dtype == np.longdouble else array).tolist()
    return value


def keyword_value_of_yaml_types(key: str, value: Any) -> Any:
    """The value of the key `key` in the types of a YAML config; InputError for a masked value."""
    try:
        return value_of_yaml_types(value)
    except ValueError as error:
        raise InputError(f"{key}: {error}") from None


def _with_unit(value: Any, unit: str) -> Any:
    """Text of the number `value` with a unit; for a list, the list of these texts; `value` unchanged if
    `unit` is empty."""
    if isinstance(value, list):
        return [_with_unit(item, unit) for item in value]
    return f"{value!r} {unit}" if unit else value
