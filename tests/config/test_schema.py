"""`rodsweep schema`: what editors are told of a config is what the command takes."""

import json
import math
import re
from functools import cache

import pytest
from conftest import ROOT
from faults import small

from rodsweep.config import read_config
from rodsweep.config.document.parsing import parsed_yaml
from rodsweep.config.json_schema import json_schema
from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.errors import InputError
from rodsweep.tasks.running.job import job_of_config

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
    "maxItems": (list, lambda value, bound, _: len(value) <= bound),
    "minLength": (str, lambda value, bound, _: len(value) >= bound),
    "maxLength": (str, lambda value, bound, _: len(value) <= bound),
    "required": (dict, lambda value, keys, _: all(key in value for key in keys)),
    "allOf": (object, lambda value, kinds, whole: all(fits(value, kind, whole) for kind in kinds)),
    "not": (object, lambda value, kind, whole: not fits(value, kind, whole)),
    "pattern": (str, lambda value, pattern, _: re.search(pattern, value) is not None),
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


@cache
def whole_schema():
    return json_schema()


def fits_schema(text):
    whole = whole_schema()
    return fits(parsed_yaml(text, "here"), whole, whole)


ARM = "length: 10 cm, young: 100 kPa, viscosity: 1.4 Pa s"
ROUND = f"{ARM}, radius: 5 mm"
CAST = (
    "viscosity: 1.4 Pa s, segments: ['4 cm: radius 5 mm, young 80 kPa', "
    "{length: 6 cm, radius: 4 mm, young: 9.0e4}]"
)
TOGETHER = [
    ("spectrum", f"arm: {{{ROUND}, pressure: 2 kPa}}", True),
    ("spectrum", f"arm: {{{ROUND}, pressure: -2 kPa}}", True),
    ("spectrum", f"arm: {{{ROUND}, pressure: 120 % of flutter, drag: range}}", True),
    (
        "spectrum",
        f"arm: {{{ROUND}, force: [0.9 of flutter, 20% above flutter], drag: [most]}}",
        True,
    ),
    ("spectrum", f"arm: {{{ROUND}, pressure_over_flutter: [0.9, 1.2], drag: most}}", True),
    ("spectrum", f"arm: {{{ROUND}, force: [0.1, 0.2 N]}}", True),
    ("spectrum", f"arm: {{{ROUND}, pressure: {{start: 0, stop: 2 kPa, num: 3}}, force: null}}", True),
    ("spectrum", f"arm: {{{ARM}, width: 8 mm, height: .9cm, poisson: [0.3, 0.5], force: 0}}", True),
    ("spectrum", f"arm: {{{ROUND}}}, F: [1, 2]", True),
    ("spectrum", "F: 3, k1: .inf, k2: +inf, gamma3: 0, points: null", True),
    ("spectrum", "F: -3, k1: [10, inf], k2: {start: 1, stop: 10, num: 3, spacing: log}, gamma3: 0.0", True),
    ("thresholds", f"arm: {{{ROUND}}}", True),
    ("thresholds", f"arm: {{{ROUND}, tip_radius: [3 mm, 5 mm], law: neo_hookean, section: swelling}}", True),
    ("thresholds", f"arm: {{{CAST}, law: neo_hookean}}", True),
    ("thresholds", f"arm: {{{CAST}, length: 10 cm, young: [1 kPa, 2 kPa]}}", True),
    ("thresholds", "arm: {viscosity: 1 Pa s, segments: '10 cm: radius 5 mm, young 1 kPa'}", True),
    ("thresholds", f"arm: {{{CAST}, radius: 5 mm}}", False),
    ("thresholds", f"arm: {{{CAST}, tip_radius: 5 mm}}", False),
    ("thresholds", "arm: {viscosity: 1 Pa s, segments: []}", False),
    ("thresholds", "arm: {viscosity: 1 Pa s, young: 9 kPa, segments: [10 cm]}", False),
    ("thresholds", "arm: {viscosity: 1 Pa s, young: 9 kPa, segments: [{length: 9 cm, radios: 5 mm}]}", False),
    ("thresholds", f"arm: {{{ROUND}, tip_radius: 0}}", False),
    ("thresholds", f"arm: {{{ROUND}, tip_radius: 3 mm, inner_radius: 1 mm}}", False),
    ("thresholds", f"arm: {{{ARM}, width: 5 mm, height: 5 mm, tip_radius: 3 mm}}", False),
    ("thresholds", f"arm: {{{ROUND}, law: hooke}}", False),
    ("thresholds", f"arm: {{{ROUND.replace('length: 10 cm, ', '')}}}", False),
    ("thresholds", f"arm: {{{ROUND}, fluid_density: 1260, density_difference: -160 kg/m^3}}", True),
    ("limit_cycle", f"arm: {{{ROUND}, pressure: 3 kPa}}, gamma1: [1, 2]", True),
    ("limit_cycle", "F: 3, k1: 200, k2: 100, gamma3: 0", True),
    ("branch", "k1: 200, k2: 100, gamma3: 0", True),
    ("phase_diagram", "F: [1, 2], k1: [200, 300], k2: 100, gamma3: 0", True),
    ("spectrum", f"arm: {{{ROUND}}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: 2 kPa, drag: some}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: 2 kPa, drag: 3}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: 2 kPa, pressure_over_flutter: 1.2}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure_over_flutter: -1.2}}", False),
    ("thresholds", f"arm: {{{ROUND}, pressure_over_flutter: 1.2}}", False),
    ("thresholds", f"arm: {{{ROUND}, fluid_density: -1260}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: null}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: 2 kPa, force: 1 N}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: 2 kPa}}, F: 3", False),
    ("spectrum", f"arm: {{{ARM}, pressure: 2 kPa}}", False),
    ("spectrum", f"arm: {{{ARM}, width: 5 mm, pressure: 2 kPa}}", False),
    ("spectrum", f"arm: {{{ROUND}, width: 5 mm, height: 5 mm, pressure: 2 kPa}}", False),
    ("spectrum", f"arm: {{{ROUND.replace('5 mm', '-5 mm')}, pressure: 2 kPa}}", False),
    ("spectrum", f"arm: {{{ROUND.replace('5 mm', '0')}, pressure: 2 kPa}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: '2'}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: [[2 kPa]]}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: 2 kPa, poisson: 0.6}}", False),
    ("spectrum", f"arm: {{{ROUND}, presure: 2 kPa}}", False),
    ("spectrum", f"arm: {{{ROUND}, pressure: 2 kPa}}, points: a.csv", False),
    ("spectrum", "points: a.csv, F: 3", False),
    ("spectrum", "F: 3, k1: 200, k2: 100, gamma3: 0, columns: [taper]", False),
    ("spectrum", "F: 3, k1: 200, k2: 100", False),
    ("spectrum", "F: 3, k1: -200, k2: 100, gamma3: 0", False),
    ("spectrum", "F: 3, k1: [0, 200], k2: 100, gamma3: 0", False),
    ("spectrum", "F: 3, k1: -inf, k2: 100, gamma3: 0", False),
    ("spectrum", "F: inf, k1: 200, k2: 100, gamma3: 0", False),
    ("spectrum", "F: 3, k1: 200, k2: {start: 0, stop: 9, num: 3}, gamma3: 0", False),
    ("spectrum", "F: 3, k1: 200, k2: 100, gamma3: -1", False),
    ("limit_cycle", "F: 3, k1: 200, k2: 100, gamma3: 0, gamma1: 0", False),
    ("thresholds", f"arm: {{{ROUND}, pressure: 2 kPa}}", False),
    ("thresholds", "F: 3, k1: 200, k2: 100, gamma3: 0", False),
    ("phase_diagram", "points: a.csv", False),
]
"""(task, parameters, whether they are allowed), of keys that depend on each other and of bounds."""


@pytest.mark.parametrize(("task", "parameters", "good"), TOGETHER)
def test_schema_and_check_agree_on_keys_together_and_on_bounds(tmp_path, task, parameters, good):
    more = "branch: {start: 0, stop: 9}" if task == "branch" else ""
    text = f"task: {task}\nparameters: {{{parameters}}}\n{more}"
    (tmp_path / "c.yaml").write_text(text)
    assert fits_schema(text) == good
    if good:
        job_of_config(tmp_path / "c.yaml", *read_config(tmp_path / "c.yaml"))
    else:
        with pytest.raises(InputError):
            job_of_config(tmp_path / "c.yaml", *read_config(tmp_path / "c.yaml"))


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
        read_config(path)
    else:
        with pytest.raises(InputError):
            read_config(path)


def test_every_key_has_its_sentence():
    whole = json_schema()
    silent = [
        f"{place}.{name}"
        for place, section in [
            *whole["definitions"].items(),
            *((s["description"], s) for s in whole["oneOf"]),
        ]
        for name, key in section.get("properties", {}).items()
        if "description" not in key and name not in {"task", "parameters", *CONFIG_CLASSES_BY_TASK}
    ]
    assert silent == []


def test_the_command_prints_it(command):
    done = command("schema")
    assert done.returncode == 0
    assert json.loads(done.stdout, parse_constant=math.nan) == json_schema()
