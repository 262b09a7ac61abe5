"""Reads a YAML file with --set overrides into a Config; every error is one sentence with the key.

The contents of the files that a config names become keys of the config before validation.
"""

import csv
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError
from ruamel.yaml import YAML

from ...errors import InputError, short_repr
from ...model.parameters import OPTIONAL_PARAMETER_NAMES
from ...wording import enumeration
from ..arm.quantities import drag_estimate_names_of_indices
from ..arm.section import ArmConfig
from ..axis import Axis, axis_from_resolved
from ..base_config import Config
from ..material import with_profile_read
from ..tasks import CONFIG_CLASSES_BY_TASK, makes_diagram
from ..values import printable_name
from .parsing import MAX_KEY_DEPTH, parsed_yaml, read_config_text
from .refusals import MAX_KEY_LENGTH, dotted_key, message_of_problem, similar_keys

EQUAL_AXIS_VALUES_TOLERANCE = 1e-12
"""Two values of an axis with at most this relative difference are equal within rounding."""
MAX_CSV_HEADER_LENGTH = 10_000
"""Maximum number of characters of a CSV file's header. `read_points` refuses a file with a longer first
line."""


def read_config(path: Path, overrides: tuple[str, ...] = ()) -> tuple[Config, str]:
    """Returns (config, YAML text).

    Raises InputError for any error in the file. overrides: texts "a.b=value" of --set, which change keys; the
    YAML text lists the overrides as comments.
    """
    text = read_config_text(path)
    name = printable_name(path)
    tree = parsed_yaml(text, name)
    if not isinstance(tree, dict):
        problem = "is empty" if tree is None else f"is {short_repr(tree)}, not a mapping of keys to values"
        raise InputError(f"{name}: the config {problem}; give task and parameters")
    for override in overrides:
        _apply_override(tree, override)
        text += f"\n# --set {override}"
    try:
        return validated_config(with_file_contents(tree, path.parent)), text
    except InputError as error:
        raise InputError(f"{name}: {error}") from None


def validated_config(tree: dict[str, Any]) -> Config:
    """Config from `tree`, nested dicts of keys and values; InputError, which states the first error, if
    invalid."""
    config = CONFIG_CLASSES_BY_TASK[_task_name(tree)]
    try:
        return config.model_validate(tree)
    except ValidationError as error:
        problems = sorted(error.errors(include_url=False), key=lambda problem: problem["type"] == "missing")
        further_count = len(problems) - 1
        count_text = f" (and {further_count} more error{'s' * (further_count > 1)})" if further_count else ""
        raise InputError(f"{message_of_problem(config, problems[0])}{count_text}") from None


def resolved_config(config: Config) -> dict[str, Any]:
    """The resolved config, as JSON values: with all defaults and with the axes computed from an arm; inf
    becomes "inf"."""
    tree = config.model_dump(mode="json", exclude_none=True)
    if config.parameters.arm is not None:
        tree["parameters"] |= {name: axis.json_value for name, axis in config.parameters.axes.items()}
    return tree


def config_from_resolved(config_dict: dict[str, Any]) -> Config:
    """The config from a resolved config that `resolved_config` returned; ValueError if this version of
    rodsweep does not accept the config."""
    try:
        task = config_dict["task"]
        section: Any = CONFIG_CLASSES_BY_TASK[task].model_fields[task].annotation
        fields = section.model_fields
        parameters = _with_axis_objects(config_dict["parameters"])
        if "arm" in parameters:
            values = parameters | {"arm": _with_axis_objects(parameters["arm"])}
            parameters = _without_arm_axes(values, makes_diagram(task))
        # An option that is not used must not be given, but every resolved config has its default.
        given = {
            option: value
            for option, value in config_dict[task].items()
            if option not in fields or value != fields[option].default
        }
        options = {
            name: _with_axis_objects(value) if isinstance(value, dict) else value
            for name, value in given.items()
        }
        return validated_config(config_dict | {"parameters": parameters, task: options})
    except (InputError, LookupError, TypeError, AttributeError) as error:
        raise ValueError(f"its config is not valid in this version of rodsweep: {error}") from None


def _with_axis_objects(section: dict[str, Any]) -> dict[str, Any]:
    """Keys and values of a section of a resolved config, with axes as `Axis` objects."""
    return {
        name: axis_from_resolved(value) if name != "arm" and isinstance(value, dict) else value
        for name, value in section.items()
    }


def _without_arm_axes(parameters: dict[str, Any], in_diagram: bool) -> dict[str, Any]:
    """Keys and values of `parameters` without the axes that `resolved_config` added from the arm. in_diagram:
    whether the task is a phase diagram."""
    arm = ArmConfig.model_validate(parameters["arm"])
    dimensionless = arm.dimensionless_axes() if in_diagram or arm.is_parameter_grid else {}

    def follows_from_arm(name: str, value: Any) -> bool:
        axis = dimensionless.get(name)
        if axis is None or not isinstance(value, Axis) or axis.size != value.size:
            return False
        return np.allclose(value.array(), axis.array(), rtol=EQUAL_AXIS_VALUES_TOLERANCE, atol=0)

    return {name: value for name, value in parameters.items() if not follows_from_arm(name, value)}


def tree_yaml(tree: dict[str, Any]) -> str:
    """YAML text of a config file from nested dicts of keys and values."""
    text = StringIO()
    yaml = YAML()
    yaml.default_flow_style = None  # lists of numbers on one line
    yaml.dump(tree, text)
    return text.getvalue()


def config_yaml(config: Config) -> str:
    """YAML text of a config, with only the keys that differ from their defaults."""
    values = config.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    axes = {name: _config_notation(value) for name, value in values["parameters"].items()}
    options = values.get(config.task, {})
    for name, axes_of_option in options.items():
        if isinstance(axes_of_option, dict):
            options[name] = {key: _config_notation(axis) for key, axis in axes_of_option.items()}
    task_section = {config.task: options} if options else {}
    return tree_yaml({"task": config.task} | values | {"parameters": axes} | task_section)


def _config_notation(axis: Any) -> Any:
    """An axis in the notation of a config file (a number, a list or a range); for an arm, a mapping of the
    quantities to this notation. Other values are returned unchanged. axis: value of a key of a resolved
    config."""
    if not isinstance(axis, dict):
        return axis
    if "length" in axis:
        drag_entry = (
            {"drag": drag_estimate_names_of_indices(axis["drag"]["values"])} if "drag" in axis else {}
        )
        return {name: _config_notation(value) for name, value in axis.items()} | drag_entry
    values = axis.get("values", axis)
    return values[0] if isinstance(values, list) and len(values) == 1 else values


def _apply_override(tree: dict, override: str) -> None:
    """Sets a key of the parsed config `tree`, in place. override: text "a.b=value" of one --set, with a YAML
    value. Raises InputError if the override is invalid."""
    override_text = printable_name(f"--set {override}", MAX_KEY_LENGTH)
    if not override.isprintable():
        raise InputError(f"{override_text} has characters that cannot be printed")
    key, separator, value = override.partition("=")
    path = key.strip().split(".")
    if not separator or not all(path):
        raise InputError(f"{override_text}: write it as key=value, for example parameters.F.num=50")
    if len(path) > MAX_KEY_DEPTH:
        raise InputError(
            f"{override_text}: keys are nested more than {MAX_KEY_DEPTH} levels deep, the limit for a config"
        )
    node = tree
    for depth, name in enumerate(path[:-1]):
        node = node.setdefault(name, {})
        if not isinstance(node, dict):
            parent = dotted_key(path[: depth + 1])
            inner_key = dotted_key(path[depth + 1 :])
            raise InputError(f"{override_text}: {parent} is {short_repr(node)}, which has no key {inner_key}")
    node[path[-1]] = parsed_yaml(value, override_text)


def _task_name(tree: dict) -> str:
    """Name of the task of a parsed config; InputError for an unknown task or a section of another task."""
    tasks_text = enumeration(tuple(CONFIG_CLASSES_BY_TASK), "or")
    if "task" not in tree:
        other_names = [name for name in tree if isinstance(name, str) and name not in Config.model_fields]
        if similar := similar_keys("task", other_names):
            key = dotted_key(similar)
            raise InputError(f"unknown key {key}; did you mean task? Its value should be {tasks_text}")
        raise InputError(f"task is missing; it should be {tasks_text}")
    task = tree["task"]
    if not isinstance(task, str) or task not in CONFIG_CLASSES_BY_TASK:
        given_text = "has no value" if task is None else f"= {short_repr(task)} is not allowed"
        raise InputError(f"task {given_text}; it should be {tasks_text}")
    for name in CONFIG_CLASSES_BY_TASK:
        if name in tree and name != task:
            section: Any = CONFIG_CLASSES_BY_TASK[task].model_fields[task].annotation
            if not isinstance(tree[name], dict) and name in section.model_fields:  # both, as modes
                raise InputError(f"unknown key {name}; did you mean {task}.{name}?")
            raise InputError(f"{name} is given but the task is {task}; remove it")
    return task


def with_file_contents(tree: Any, directory: Path) -> Any:
    """The parsed config `tree`, with the profile read from its file. If `parameters.columns` is not given, it
    lists the optional parameters in the header of the file of points.

    directory: folder of relative file names. Raises InputError if the file of the profile is not a table of
    numbers.
    """
    return _with_optional_columns(with_profile_read(tree, directory), directory)


def _with_optional_columns(tree: Any, directory: Path) -> Any:
    """The parsed config `tree`, with `parameters.columns` added if the file of points has optional
    parameters."""
    parameters = tree.get("parameters") if isinstance(tree, dict) else None
    if not isinstance(parameters, dict) or not isinstance(parameters.get("points"), str):
        return tree
    if parameters.get("columns") is not None:
        return tree
    header = _header_names(directory / parameters["points"])
    columns = [name for name in OPTIONAL_PARAMETER_NAMES if name in header]
    return tree | {"parameters": parameters | {"columns": columns}} if columns else tree


def _header_names(path: Path) -> list[str]:
    """Names in the first line of a CSV file; empty for an unreadable file, which `read_points` refuses."""
    try:
        if not path.is_file():
            return []
        with path.open(newline="", encoding="utf-8-sig") as file:
            line = file.readline(MAX_CSV_HEADER_LENGTH)
        return [cell.strip() for cell in next(csv.reader([line]), [])]
    except (OSError, ValueError, csv.Error):
        return []
