"""`rodsweep schema`: what editors are told of a config is what the command takes."""

import json
import math

import pytest
from conftest import ROOT
from faults import small

from rodsweep.config import load_config
from rodsweep.config.json_schema import json_schema
from rodsweep.config.parsing import parse
from rodsweep.config.tasks import CONFIGS
from rodsweep.errors import InputError

PROSE = {"$schema", "definitions", "title", "description", "default", "additionalProperties"}
KINDS = {"number": float | int, "integer": int, "string": str, "boolean": bool, "object": dict, "array": list}
KEYWORDS = {
    "type": (object, lambda value, kind, _: is_of(kind, value)),
    "enum": (object, lambda value, words, _: value in words),
    "const": (object, lambda value, word, _: value == word),
    "minimum": (float | int, lambda value, bound, _: value >= bound),
    "maximum": (float | int, lambda value, bound, _: value <= bound),
    "exclusiveMinimum": (float | int, lambda value, bound, _: value > bound),
    "exclusiveMaximum": (float | int, lambda value, bound, _: value < bound),
    "minItems": (list, lambda value, bound, _: len(value) >= bound),
    "maxLength": (str, lambda value, bound, _: len(value) <= bound),
    "required": (dict, lambda value, keys, _: all(key in value for key in keys)),
    "anyOf": (object, lambda value, kinds, whole: any(fits(value, kind, whole) for kind in kinds)),
    "oneOf": (object, lambda value, kinds, whole: sum(fits(value, kind, whole) for kind in kinds) == 1),
    "items": (list, lambda value, kind, whole: all(fits(item, kind, whole) for item in value)),
    "$ref": (object, lambda value, name, whole: fits(value, whole["definitions"][name.split("/")[2]], whole)),
    "properties": (
        dict,
        lambda value, keys, whole: all(fits(value[k], kind, whole) for k, kind in keys.items() if k in value),
    ),
}
"""What values each keyword of a JSON schema is about, and what it asks of them; of a given whole schema."""


def is_of(kind, value):
    """Whether a value is of a kind of JSON schemas, in which true is no number."""
    if kind == "null":
        return value is None
    return isinstance(value, KINDS[kind]) and (kind == "boolean") == isinstance(value, bool)


def fits(value, schema, whole):
    """Whether a value is as a JSON schema says; a keyword that is not known here raises KeyError."""
    closed = schema.get("additionalProperties") is False and isinstance(value, dict)
    if closed and not value.keys() <= schema["properties"].keys():
        return False
    asked = {keyword: says for keyword, says in schema.items() if keyword not in PROSE}
    rules = ((*KEYWORDS[keyword], says) for keyword, says in asked.items())
    return all(good(value, says, whole) for kind, good, says in rules if isinstance(value, kind))


def fits_schema(text):
    whole = json_schema()
    return fits(parse(text, "here"), whole, whole)


@pytest.mark.parametrize("path", sorted((ROOT / "configs").glob("*.yaml")), ids=lambda path: path.stem)
def test_every_config_fits(path):
    assert fits_schema(path.read_text())


@pytest.mark.parametrize("name", small.CONFIGS)
def test_configs_of_the_tests_fit(name):
    assert fits_schema(small.CONFIGS[name])


SPECTRUM = "task: spectrum\nparameters: {{F: {F}, k1: 200, k2: {k2}, gamma3: 0}}\n{more}"


@pytest.mark.parametrize(
    ("changed", "good"),
    [
        ({}, True),
        ({"F": "30.5"}, True),
        ({"F": "[1, 2.0, 3e1]"}, True),
        ({"k2": "[100, .inf]"}, True),
        ({"k2": "inf"}, True),
        ({"F": "{start: 0, stop: 9, num: 10}"}, True),
        ({"k2": "{start: 1, stop: 1e4, num: 5, spacing: log}"}, True),
        ({"more": "accuracy: 1.0e-8\nspectrum: {modes: 6, vectors: true, nodes: 17}"}, True),
        ({"F": "{start: 0, stop: 9}"}, False),
        ({"F": "{start: 0, stop: 9, num: 10, step: 1}"}, False),
        ({"F": "{values: [1, 2]}"}, False),
        ({"F": "thirty"}, False),
        ({"F": "true"}, False),
        ({"F": "[]"}, False),
        ({"k2": "{start: 1, stop: 9, num: 0}"}, False),
        ({"k2": "{start: 1, stop: 9, num: 3, spacing: cubic}"}, False),
        ({"more": "accuracy: 1.0e-15"}, False),
        ({"more": "accuracy: high"}, False),
        ({"more": "spectrum: {modes: 0}"}, False),
        ({"more": "spectrum: {mode: 3}"}, False),
        ({"more": "spectrum: {modes: 2.5}"}, False),
        ({"more": "thresholds: {F_max: 100}"}, False),
    ],
)
def test_schema_and_command_agree(tmp_path, changed, good):
    text = SPECTRUM.format(**{"F": "30", "k2": "100", "more": ""} | changed)
    path = tmp_path / "c.yaml"
    path.write_text(text)
    assert fits_schema(text) == good
    if good:
        load_config(path)
    else:
        with pytest.raises(InputError):
            load_config(path)


def test_every_key_has_its_sentence():
    whole = json_schema()
    silent = [
        f"{place}.{name}"
        for place, section in [
            *whole["definitions"].items(),
            *((s["description"], s) for s in whole["oneOf"]),
        ]
        for name, key in section.get("properties", {}).items()
        if "description" not in key and name not in {"task", "parameters", *CONFIGS}
    ]
    assert silent == []


def test_the_command_prints_it(command):
    done = command("schema")
    assert done.returncode == 0
    assert json.loads(done.stdout, parse_constant=math.nan) == json_schema()
