"""JSON schema of a config, for editors that complete keys and mark mistakes.

The schema is made from the models of the tasks, the docstrings of the keys, and the conditions on
combinations of keys in `conditions`. Conditions on the whole config (F < k1, sorted lists) are not in the
schema; `rodsweep check` tests them.
"""

import ast
import inspect
import textwrap
from collections.abc import Iterator
from math import isfinite
from typing import Any

from pydantic import BaseModel

from ...model.parameters import PARAMETERS
from ..document.refusals import model_of
from ..tasks import CONFIGS
from ..values import Axis, Strict
from .conditions import nodes_of, points_of, restrict_arm, with_bounds

DIALECT = "http://json-schema.org/draft-07/schema#"
"""Draft 7 of JSON schema, which most editors support."""
BOUNDS = {"ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum"}
"""JSON schema's names of bounds, for bounds that pydantic leaves unconverted behind a validator of ours."""


def json_schema() -> dict[str, Any]:
    """JSON schema of a config of any task."""
    definitions: dict[str, Any] = {}
    tasks = []
    for config in CONFIGS.values():
        schema = config.model_json_schema(ref_template="#/definitions/{model}")
        definitions |= schema.pop("$defs", {})
        _describe_keys(schema, config)
        for section in sections_of(config):
            _describe_keys(definitions[section.__name__], section)
        if not config.others_may_be_needed:
            condition = points_of(config.taken_of_a_rod({}), lists=not config.of_several_rods)
            schema["properties"]["parameters"] = {"allOf": [schema["properties"]["parameters"], condition]}
        tasks.append(schema)
    for section in definitions.values():
        with_bounds(section.get("properties", {}), definitions["Axis"])
    restrict_arm(definitions["ArmSection"], definitions["Axis"])
    whole = {"oneOf": tasks, "definitions": definitions}
    for node in nodes_of(whole):
        for ours, theirs in BOUNDS.items():
            if ours in node:
                bound = node.pop(ours)
                if isfinite(bound):
                    node[theirs] = bound
    return {"$schema": DIALECT, "title": "A config of rodsweep", **whole}


def sections_of(config: type[BaseModel]) -> Iterator[type[BaseModel]]:
    """Models of the sections of a config, including nested sections."""
    for field in config.model_fields.values():
        kind = model_of(field)
        if isinstance(kind, type) and issubclass(kind, Strict) and not issubclass(kind, Axis):
            yield kind
            yield from sections_of(kind)


def meanings_of(section: type[BaseModel]) -> dict[str, str]:
    """Docstring of every key of a section, base classes included."""
    found: dict[str, str] = {}
    for kind in reversed(section.__mro__):
        if not (issubclass(kind, BaseModel) and kind.__module__.startswith("rodsweep.")):
            continue
        try:
            source = inspect.getsource(kind)
        except OSError:  # a class without source, created from the table of parameters
            continue
        body = ast.parse(textwrap.dedent(source)).body[0]
        assert isinstance(body, ast.ClassDef)
        for key, below in zip(body.body, body.body[1:], strict=False):
            if not (isinstance(key, ast.AnnAssign) and isinstance(key.target, ast.Name)):
                continue
            if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant):
                found[key.target.id] = inspect.cleandoc(str(below.value.value))
    return found


def _describe_keys(schema: dict[str, Any], section: type[BaseModel]) -> None:
    """Adds the docstrings of the keys as descriptions and removes pydantic's titles, which repeat the key."""
    parameters = {name: f"{p.long_name}, in {p.unit}" for name, p in PARAMETERS.items()}
    meanings = parameters | meanings_of(section)
    for name, key in schema["properties"].items():
        key.pop("title", None)
        if name in meanings:
            key["description"] = meanings[name]
