"""The config as a JSON schema, from which editors complete keys and mark mistakes while one writes.

Made of the models of the tasks, with the sentences that stand below their keys, and of what `json_conditions`
says of keys together. What only a whole config tells (F < k1, sorted lists) is not in it; `rodsweep check`
says that.
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
"""What editors know best."""
BOUNDS = {"ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum"}
"""How JSON schemas call bounds that pydantic leaves as they are, where a validator of ours stands first."""


def json_schema() -> dict[str, Any]:
    """The schema of a config of any task."""
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
    """The models of the sections that a config has, and of those in them."""
    for field in config.model_fields.values():
        kind = model_of(field)
        if isinstance(kind, type) and issubclass(kind, Strict) and not issubclass(kind, Axis):
            yield kind
            yield from sections_of(kind)


def meanings_of(section: type[BaseModel]) -> dict[str, str]:
    """The docstring below every key of a section, those of the sections it is made from included."""
    found: dict[str, str] = {}
    for kind in reversed(section.__mro__):
        if not (issubclass(kind, BaseModel) and kind.__module__.startswith("rodsweep.")):
            continue
        try:
            source = inspect.getsource(kind)
        except OSError:  # made of the table of parameters
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
    """Gives the keys of a section their sentences, instead of titles that repeat the key."""
    parameters = {name: f"{p.long_name}, in {p.unit}" for name, p in PARAMETERS.items()}
    meanings = parameters | meanings_of(section)
    for name, key in schema["properties"].items():
        key.pop("title", None)
        if name in meanings:
            key["description"] = meanings[name]
