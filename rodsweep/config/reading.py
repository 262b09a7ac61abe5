"""From a YAML file and --set overrides to a Config; every refusal is one sentence that names the key."""

import difflib
import json
from math import isinf
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.events import AliasEvent

from ..errors import InputError
from .schema import Config, words
from .tasks import CONFIGS
from .values import overflows, short

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
    return json.loads(json.dumps(_without_infinities(config.model_dump(exclude_none=True)), default=str))


def _without_infinities(value: Any) -> Any:
    """The value with every infinite number, at any depth, as the text that a config would have."""
    if isinstance(value, dict):
        return {key: _without_infinities(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_without_infinities(item) for item in value]
    return str(value) if isinstance(value, float) and isinf(value) else value


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
            if overflows(getattr(event, "value", "")):
                raise InputError(f"{where}: {short(event.value)} is too large for a floating-point number")
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
    config = CONFIGS[_task(tree, where)]
    try:
        return config.model_validate(tree)
    except ValidationError as error:
        problems = error.errors(include_url=False)
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise InputError(f"{where}: {_sentence(config, problems[0])}{more}") from None


def _task(tree: dict, where: str) -> str:
    """The task that the config names; InputError if it is none, or if a section belongs to another."""
    known = words(tuple(CONFIGS), "or")
    if "task" not in tree:
        raise InputError(f"{where}: task is missing; it should be {known}")
    task = tree["task"]
    if not isinstance(task, str) or task not in CONFIGS:
        raise InputError(f"{where}: task = {short(task)} is not allowed; it should be {known}")
    for name in CONFIGS:
        if name in tree and name != task:
            raise InputError(f"{where}: {name} is given but the task is {task}; remove it")
    return task


def _sentence(config: type[Config], problem: Any) -> str:
    """One pydantic problem as a sentence: which key, which value, what is allowed."""
    location = tuple(str(part) for part in problem["loc"])
    key = ".".join(location)
    kind, value = problem["type"], problem["input"]
    if kind == "extra_forbidden":
        known = list(_section(config, location[:-1]).model_fields)
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
    field = _section(config, location[:-1]).model_fields.get(location[-1])
    allowed = what_is_allowed(field) if field else problem["msg"]
    return f"{key} = {short(value)} is not allowed; it should be {allowed}"


def _section(config: type[Config], location: tuple[str, ...]) -> type[BaseModel]:
    """The section of a config at a place."""
    section: type[BaseModel] = config
    for name in location:
        kind = section.model_fields[name].annotation
        if not (isinstance(kind, type) and issubclass(kind, BaseModel)):
            break
        section = kind
    return section


def what_is_allowed(field: FieldInfo) -> str:
    """What the user may write for a key, as a phrase made of its type and bounds."""
    kind = field.annotation
    bound = {
        name: getattr(part, name)
        for part in field.metadata
        for name in ("ge", "gt", "le", "lt", "max_length")
        if hasattr(part, name)
    }
    if field.description:
        return field.description
    if kind is bool:
        return "true or false"
    if kind is str:
        return f"text of at most {bound['max_length']} characters"
    if kind is int or kind is float:
        number = "a whole number" if kind is int else "a number"
        if "gt" in bound:
            return f"a finite number above {bound['gt']:g}"
        return f"{number} from {bound['ge']:g} to {bound['le']:g}"
    return "a mapping of keys to values"
