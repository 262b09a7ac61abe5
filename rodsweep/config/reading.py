"""From a YAML file and --set overrides to a Config; every refusal is one sentence that names the key."""

import difflib
import json
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.events import AliasEvent

from ..errors import InputError
from .schema import Config, Parameters, SpectrumOptions, short

LARGEST_FILE = 1_000_000
DEEPEST = 20


def load_config(path: Path, overrides: tuple[str, ...] = ()) -> tuple[Config, str]:
    """(config, its YAML text with the overrides listed); raises InputError for anything amiss."""
    text = read_text(path)
    tree = _parse(text, str(path))
    if not isinstance(tree, dict):
        raise InputError(f"{path}: the config is {short(tree)}, not a mapping of keys to values")
    for override in overrides:
        _override(tree, override)
        text += f"\n# --set {override}"
    return _validated(tree, str(path)), text


def canonical(config: Config) -> dict[str, Any]:
    """The config with all defaults filled in, as JSON-compatible values; inf becomes "inf"."""
    return json.loads(
        json.dumps(config.model_dump(exclude_none=True), default=str).replace("Infinity", '"inf"')
    )


def read_text(path: Path) -> str:
    """The text of a small UTF-8 file; InputError if it cannot be had."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from error
    if len(data) > LARGEST_FILE:
        raise InputError(f"{path} is larger than {LARGEST_FILE} bytes, which no config is")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{path} is not UTF-8 text") from None


def _parse(text: str, where: str) -> Any:
    """YAML 1.2 without tags, aliases or duplicate keys."""
    yaml = YAML(typ="safe", pure=True)
    if any(line.startswith("%") for line in text.splitlines()):
        raise InputError(f"{where}: directives (%...) are not allowed in a config")
    try:
        depth = 0
        for event in yaml.parse(text):
            if isinstance(event, AliasEvent):
                raise InputError(f"{where}: aliases (*{event.anchor}) are not allowed in a config")
            if getattr(event, "tag", None):
                raise InputError(f"{where}: tags ({event.tag}) are not allowed in a config")
            name = type(event).__name__
            depth += name.endswith("StartEvent") - name.endswith("EndEvent")
            if depth > DEEPEST:
                raise InputError(f"{where}: nested deeper than any config is")
        return YAML(typ="safe", pure=True).load(text)
    except YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        problem = " ".join(str(getattr(error, "problem", None) or error).split())
        place = f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise InputError(f"{where}{place}: not valid YAML: {problem[:200]}") from None
    except (ValueError, RecursionError, OverflowError) as error:
        raise InputError(f"{where}: not valid YAML: {str(error)[:200]}") from None


def _override(tree: dict, override: str) -> None:
    """Applies one `--set a.b=value` to the parsed tree; the value is YAML."""
    key, equals, value = override.partition("=")
    path = key.strip().split(".")
    if not equals or not all(path):
        raise InputError(f"--set {override}: write it as key=value, for example parameters.F.num=50")
    node = tree
    for i, name in enumerate(path[:-1]):
        node = node.setdefault(name, {})
        if not isinstance(node, dict):
            parent = ".".join(path[: i + 1])
            raise InputError(f"--set {override}: {parent} is {short(node)}, which has no key {path[i + 1]}")
    node[path[-1]] = _parse(value, f"--set {override}")


def _validated(tree: dict, where: str) -> Config:
    try:
        return Config.model_validate(tree)
    except ValidationError as error:
        problems = error.errors(include_url=False)
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise InputError(f"{where}: {_sentence(problems[0])}{more}") from None


SECTIONS: dict[tuple[str, ...], type[BaseModel]] = {
    (): Config,
    ("parameters",): Parameters,
    ("spectrum",): SpectrumOptions,
}


WHAT_IS_ALLOWED = {
    "title": "text of at most 200 characters",
    "task": "spectrum",
    "parameters": "a mapping of keys to values",
    "parameters.points": "the name of a CSV file",
    "spectrum": "a mapping of keys to values",
    "spectrum.modes": "a whole number from 1 to 100",
    "spectrum.nodes": "a whole number from 3 to 513",
    "spectrum.certify": "true or false",
    "spectrum.vectors": "true or false",
    "spectrum.longitudinal": "true or false",
    "accuracy": "a number from 1e-13 to 1e-2",
}
"""What the user may write, for the keys whose refusal pydantic words in its own terms."""


def _sentence(problem: Any) -> str:
    """One pydantic problem as a sentence: which key, which value, what is allowed."""
    location = tuple(str(part) for part in problem["loc"])
    key = ".".join(location)
    kind, value = problem["type"], problem["input"]
    if kind == "extra_forbidden":
        known = list(SECTIONS.get(location[:-1], Config).model_fields)
        close = difflib.get_close_matches(location[-1], known, n=1, cutoff=0.5)
        hint = f"did you mean {close[0]}?" if close else f"known keys are {', '.join(known)}"
        return f"unknown key {key}; {hint}"
    if kind == "missing":
        return f"{key} is missing"
    if kind == "value_error":
        text = str(problem["ctx"]["error"])
        return f"{key}: {text}" if key and not text.startswith(key) else text
    if kind == "invalid_key":
        return f"{short(value)} is not a key; keys are words"
    allowed = WHAT_IS_ALLOWED.get(key, problem["msg"])
    return f"{key} = {short(value)} is not allowed; it should be {allowed}"
