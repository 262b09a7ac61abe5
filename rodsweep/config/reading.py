"""From a YAML file and --set overrides to a Config; every refusal is one sentence that names the key."""

import difflib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from ..errors import InputError
from .axes import words
from .parsing import DEEPEST, parse, read_text
from .schema import Config
from .tasks import CONFIGS
from .values import named, short

KEY_SHOWN = 100
"""Characters of a key that a sentence has room for."""
CLOSE = 0.5
"""How alike an unknown key must be to a known one for that to be meant."""


def load_config(path: Path, overrides: tuple[str, ...] = ()) -> tuple[Config, str]:
    """(config, its YAML text with the overrides listed); raises InputError for anything amiss."""
    text, where = read_text(path), named(path)
    tree = parse(text, where)
    if not isinstance(tree, dict):
        raise InputError(f"{where}: the config is {short(tree)}, not a mapping of keys to values")
    for override in overrides:
        _override(tree, override)
        text += f"\n# --set {override}"
    return _validated(tree, where), text


def canonical(config: Config) -> dict[str, Any]:
    """The config with all defaults filled in, as JSON-compatible values; inf becomes "inf"."""
    return config.model_dump(mode="json", exclude_none=True)


def _override(tree: dict, override: str) -> None:
    """Applies one `--set a.b=value` to the parsed tree; the value is YAML."""
    where = named(f"--set {override}", KEY_SHOWN)
    if not override.isprintable():
        raise InputError(f"{where} has characters that cannot be printed")
    key, equals, value = override.partition("=")
    path = key.strip().split(".")
    if not equals or not all(path):
        raise InputError(f"{where}: write it as key=value, for example parameters.F.num=50")
    if len(path) > DEEPEST:
        raise InputError(f"{where}: nested deeper than any config is")
    node = tree
    for i, name in enumerate(path[:-1]):
        node = node.setdefault(name, {})
        if not isinstance(node, dict):
            parent, rest = _dotted(path[: i + 1]), _dotted(path[i + 1 :])
            raise InputError(f"{where}: {parent} is {short(node)}, which has no key {rest}")
    node[path[-1]] = parse(value, where)


def _validated(tree: dict, where: str) -> Config:
    config = CONFIGS[_task(tree, where)]
    try:
        return config.model_validate(tree)
    except ValidationError as error:
        problems = sorted(error.errors(include_url=False), key=lambda problem: problem["type"] == "missing")
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise InputError(f"{where}: {_sentence(config, problems[0])}{more}") from None


def _task(tree: dict, where: str) -> str:
    """The task that the config names; InputError if it is none, or if a section belongs to another."""
    known = words(tuple(CONFIGS), "or")
    if "task" not in tree:
        others = [name for name in tree if isinstance(name, str) and name not in Config.model_fields]
        close = difflib.get_close_matches("task", others, n=1, cutoff=CLOSE)
        problem = f"unknown key {_dotted(close)}; did you mean task?" if close else "task is missing;"
        raise InputError(f"{where}: {problem} it should be {known}")
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
    key = _dotted(location)
    kind, value = problem["type"], problem["input"]
    if kind == "extra_forbidden":
        known = list(_section(config, location[:-1]).model_fields)
        close = difflib.get_close_matches(location[-1], known, n=1, cutoff=CLOSE)
        hint = f"did you mean {close[0]}?" if close else f"known keys are {', '.join(known)}"
        return f"unknown key {key}; {hint}"
    if kind == "missing":
        return f"{key} is missing"
    if kind == "value_error":
        text = str(problem["ctx"]["error"])
        return f"{key}: {text}" if key and not text.startswith(key) else text
    if kind == "invalid_key":
        return f"{short(value)} is not a key; keys are words"
    field = _section(config, location[:-1]).model_fields.get("".join(location[-1:]))
    allowed = what_is_allowed(field) if field else problem["msg"]
    return f"{key} = {short(value)} is not allowed; it should be {allowed}"


def _dotted(location: Sequence[str]) -> str:
    """A place in the config as the user writes it in --set."""
    return named(".".join(location), KEY_SHOWN)


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
    if get_origin(kind) is Literal:
        return words(get_args(kind), "or")
    if kind is bool:
        return "true or false"
    if kind is str:
        return f"text of at most {bound['max_length']} characters"
    if kind is int or kind is float:
        number = "a whole number" if kind is int else "a number"
        span = f"{number} from {bound['ge']:g} to {bound['le']:g}" if "ge" in bound else ""
        return span or f"a finite number above {bound['gt']:g}"
    return "a mapping of keys to values"
