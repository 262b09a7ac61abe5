"""JSON schema of a config, for editors that complete keys and mark mistakes.

The schema is made from the models of the tasks, the docstrings of the keys, and conditions on combinations of
keys: required keys, exclusive keys, ranges of values. A key with the value null is treated as not given, as
by the command. Conditions on the whole config (F < k1, sorted lists) are not in the schema; `rodsweep check`
tests them.
"""

import ast
import inspect
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from copy import deepcopy
from itertools import combinations
from math import isfinite
from typing import Any

from pydantic import BaseModel

from ..model.arm.quantities import (
    GIVEN_QUANTITIES,
    LOAD_NAME_BY_RELATIVE_LOAD,
    LOAD_NAMES,
    SECTION_SIZE_NAMES,
)
from ..model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES, PARAMETERS
from .arm.axes import LOAD_KEYS, NON_LOAD_KEYS
from .axis import Axis
from .document.refusals import value_type_of_key
from .tasks import CONFIG_CLASSES_BY_TASK
from .values import StrictConfigSection

Schema = dict[str, Any]
QUANTITY_TEXT_PATTERN = r"^\s*{sign}(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*[A-Za-z\u00b5\u03bc{percent}]"
"""Template of a regular expression for a number followed by the beginning of a unit."""
BOUNDS_OF_ARM: dict[str, Schema] = {
    **{
        name: {"exclusiveMinimum": 0}
        for name in NON_LOAD_KEYS
        if not GIVEN_QUANTITIES[name].may_be_nonpositive
    },
    "poisson": {"exclusiveMinimum": -1, "maximum": 0.5},
    **{name: {"minimum": 0} for name in LOAD_NAME_BY_RELATIVE_LOAD},
}
"""Bounds of each quantity of an arm, as JSON schema keywords, by name of the quantity."""
SCHEMA_DIALECT_URL = "http://json-schema.org/draft-07/schema#"
"""Address of draft 7 of JSON schema, which most editors support."""
BOUND_KEYWORDS = {"ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum"}
"""JSON schema keyword by pydantic's name of a bound. pydantic does not convert the bounds of values that pass
through a validator function."""


def json_schema() -> dict[str, Any]:
    """JSON schema of a config of any task."""
    definitions: dict[str, Any] = {}
    tasks = []
    for config in CONFIG_CLASSES_BY_TASK.values():
        schema = config.model_json_schema(ref_template="#/definitions/{model}")
        definitions |= schema.pop("$defs", {})
        _describe_keys(schema, config)
        for section in section_classes(config):
            _describe_keys(definitions[section.__name__], section)
        if not config.parameters_depend_on_options:
            condition = points_condition(config.rod_parameters_used({}), lists=not config.needs_several_rods)
            schema["properties"]["parameters"] = {"allOf": [schema["properties"]["parameters"], condition]}
        tasks.append(schema)
    for section in definitions.values():
        add_parameter_bounds(section.get("properties", {}), definitions["Axis"])
    add_arm_conditions(definitions["ArmConfig"], definitions["Axis"])
    complete_schema = {"oneOf": tasks, "definitions": definitions}
    for node in iterate_subschemas(complete_schema):
        for ours, theirs in BOUND_KEYWORDS.items():
            if ours in node:
                bound = node.pop(ours)
                if isfinite(bound):
                    node[theirs] = bound
    return {"$schema": SCHEMA_DIALECT_URL, "title": "A config of rodsweep", **complete_schema}


def section_classes(config: type[BaseModel]) -> Iterator[type[BaseModel]]:
    """Yields the classes of the sections of a config, including nested sections."""
    for key_field in config.model_fields.values():
        value_type = value_type_of_key(key_field)
        if (
            isinstance(value_type, type)
            and issubclass(value_type, StrictConfigSection)
            and not issubclass(value_type, Axis)
        ):
            yield value_type
            yield from section_classes(value_type)


def key_docstrings(section: type[BaseModel]) -> dict[str, str]:
    """Docstring of every key of a section, by key, including keys of base classes."""
    docstrings: dict[str, str] = {}
    for base_class in reversed(section.__mro__):
        if not (issubclass(base_class, BaseModel) and base_class.__module__.startswith("rodsweep.")):
            continue
        try:
            source = inspect.getsource(base_class)
        except OSError:  # a class without source, created from the table of parameters
            continue
        body = ast.parse(textwrap.dedent(source)).body[0]
        assert isinstance(body, ast.ClassDef)
        for key, docstring_node in zip(body.body, body.body[1:], strict=False):
            if not (isinstance(key, ast.AnnAssign) and isinstance(key.target, ast.Name)):
                continue
            if isinstance(docstring_node, ast.Expr) and isinstance(docstring_node.value, ast.Constant):
                docstrings[key.target.id] = inspect.cleandoc(str(docstring_node.value.value))
    return docstrings


def _describe_keys(schema: dict[str, Any], section: type[BaseModel]) -> None:
    """Adds the docstrings of the keys of `section` as descriptions to `schema`, in place; removes pydantic's
    titles."""
    parameters = {
        name: f"{parameter.long_name}, in {parameter.unit}" for name, parameter in PARAMETERS.items()
    }
    meanings = parameters | key_docstrings(section)
    for name, key in schema["properties"].items():
        key.pop("title", None)
        if name in meanings:
            key["description"] = meanings[name]


def key_given_condition(name: str) -> Schema:
    """JSON schema of the condition that the key `name` is present and not null."""
    return {"required": [name], "properties": {name: {"not": {"type": "null"}}}}


def no_key_given_condition(names: Iterable[str]) -> Schema:
    """JSON schema of the condition that no key in `names` is given."""
    return {"not": {"anyOf": [key_given_condition(name) for name in names]}}


def all_keys_given_condition(names: Iterable[str], *conditions: Schema) -> Schema:
    """JSON schema of the condition that all keys in `names` are given and all schemas in `conditions` are
    satisfied."""
    return {"allOf": [*map(key_given_condition, names), *conditions]}


def with_axis_bounds(
    schema: Schema, bound: Mapping[str, float], allowed_texts: tuple[str, ...] = ()
) -> Schema:
    """Copy of the JSON schema of an axis, with bounds on every number. bound: bounds, by keyword of JSON
    schema. allowed_texts: allowed spellings of inf."""
    copy = deepcopy(schema)
    for node in iterate_subschemas(copy):
        alternatives = node.get("anyOf", [])
        if any("enum" in kind and "inf" in kind["enum"] for kind in alternatives):
            options = [{"enum": list(allowed_texts)}] if allowed_texts else []
            node["anyOf"] = [
                *(alternative for alternative in alternatives if "inf" not in alternative.get("enum", [])),
                *options,
            ]
        if node.get("type") == "number":
            node.update(bound)
    return copy


def add_parameter_bounds(properties: Schema, axis: Schema) -> None:
    """Adds the bounds of the parameters to the JSON schemas `properties` of a section's keys, in place. axis:
    JSON schema of an axis."""
    for name, parameter in PARAMETERS.items():
        if name in properties:
            alternatives = [
                axis if "$ref" in alternative else alternative for alternative in properties[name]["anyOf"]
            ]
            bounds = (
                parameter.allowed_range.schema_bounds,
                ("inf", "+inf") if parameter.rigid_adjective else (),
            )
            properties[name]["anyOf"] = [
                with_axis_bounds(alternative, *bounds) for alternative in alternatives
            ]


def add_arm_conditions(section: Schema, axis: Schema) -> None:
    """Adds the conditions of an arm to its JSON schema `section`, in place: unit and sign of every quantity,
    exactly one kind of cross-section, and at most one load. axis: JSON schema of an axis."""
    for name, key in section["properties"].items():
        bound = BOUNDS_OF_ARM.get(name, {})
        if "anyOf" in key:
            alternatives = [axis if "$ref" in alternative else alternative for alternative in key["anyOf"]]
            key["anyOf"] = [with_axis_bounds(alternative, bound) for alternative in alternatives]
        if name not in GIVEN_QUANTITIES:
            continue
        sign = "[+]?" if bound else "[+-]?"
        pattern = QUANTITY_TEXT_PATTERN.format(sign=sign, percent="%" if name in LOAD_NAMES else "")
        for node in iterate_subschemas(key):
            if node.get("type") == "string":
                node["pattern"] = pattern
    required = ["length", "young"]
    round_sizes, rectangle_sizes = SECTION_SIZE_NAMES
    circle = all_keys_given_condition(
        [*required, "radius"], no_key_given_condition([*rectangle_sizes, "segments"])
    )
    rectangle = all_keys_given_condition(
        [*required, *rectangle_sizes], no_key_given_condition([*round_sizes, "segments"])
    )
    in_segments = all_keys_given_condition(
        ["segments"], no_key_given_condition([*round_sizes, *rectangle_sizes])
    )
    section["allOf"] = [
        {"oneOf": [circle, rectangle, in_segments]},
        {"not": all_keys_given_condition(["inner_radius", "tip_radius"])},
        *({"not": all_keys_given_condition(pair)} for pair in combinations((*LOAD_KEYS, "load_kind"), 2)),
    ]


def points_condition(parameter_names: Iterable[str], lists: bool) -> Schema:
    """JSON schema of the condition that `parameters` defines points: by axes, an arm, or a file of points.

    parameter_names: parameters that the task needs. lists: whether the task accepts a file of points. If F is
    needed, either the arm has a load or F is given; otherwise both are forbidden.
    """
    axes = tuple(name for name in parameter_names if PARAMETERS[name].default is None)
    loads = [all_keys_given_condition([name]) for name in LOAD_KEYS]
    arm_with_load = {"properties": {"arm": {"anyOf": loads}}}
    unloaded = {"properties": {"arm": no_key_given_condition(LOAD_KEYS)}}
    load = {"oneOf": [key_given_condition("F"), arm_with_load]} if "F" in axes else unloaded
    none_listed = no_key_given_condition(["points", "columns"])
    alternatives = [
        all_keys_given_condition(axes, no_key_given_condition(["arm"]), none_listed),
        all_keys_given_condition(["arm"], none_listed, load),
    ]
    if lists:
        alternatives.append(
            all_keys_given_condition(
                ["points"], no_key_given_condition(["arm", *NON_OPTIONAL_LINEAR_PARAMETER_NAMES])
            )
        )
    return (
        {"anyOf": alternatives} if "F" in axes else {"anyOf": alternatives, **no_key_given_condition(["F"])}
    )


def iterate_subschemas(schema: Any) -> Iterable[Schema]:
    """Yields all mappings within a JSON schema, including the schema itself."""
    if isinstance(schema, dict):
        yield schema
    if isinstance(schema, dict | list):
        for subschema in list(schema.values() if isinstance(schema, dict) else schema):
            yield from iterate_subschemas(subschema)
