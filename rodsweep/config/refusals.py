"""What is wrong with a config as one sentence: which key, which value, what is allowed, what was meant."""

import difflib
from collections.abc import Sequence
from math import isinf
from types import NoneType, UnionType
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from .axes import words
from .schema import Config
from .values import named, short

KEY_SHOWN = 100
"""Characters of a key that a sentence has room for."""
ALIKE = 0.6
"""Least similarity, as difflib measures it, of a misspelt key: gama3 has 0.9 to gamma3, taper 0.5 to arm."""


def sentence_of(config: type[Config], problem: Any) -> str:
    """One pydantic problem as a sentence: which key, which value, what is allowed."""
    location = tuple(str(part) for part in problem["loc"])
    key = dotted(location)
    kind, value = problem["type"], problem["input"]
    if kind == "extra_forbidden":
        known = list(_section(config, location[:-1]).model_fields)
        close = places_of(config, location) or nearest(location[-1], known)
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


def nearest(key: str, known: Sequence[str]) -> list[str]:
    """The known key that an unknown one may mean: but for capitals, the only one that begins so, or alike."""
    low = key.casefold()
    same = [name for name in known if name.casefold() == low]
    begun = [name for name in known if name.casefold().startswith(low)]
    if same or len(begun) == 1:
        return (same or begun)[:1]
    return difflib.get_close_matches(key, known, n=1, cutoff=ALIKE)


def places_of(config: type[Config], location: Sequence[str]) -> list[str]:
    """The places of other sections at which a key is known that is unknown where it stands."""
    task = str(get_args(config.model_fields["task"].annotation)[0])
    found = []
    for section in ((), ("parameters",), (task,), ("parameters", "arm")):
        known = _section(config, section).model_fields
        if location[-1] in known and section != tuple(location[:-1]):
            found.append(dotted((*section, location[-1])))
    return found


def dotted(location: Sequence[str]) -> str:
    """A place in the config as the user writes it in --set."""
    return named(".".join(location), KEY_SHOWN)


def _section(config: type[Config], location: tuple[str, ...]) -> type[BaseModel]:
    """The section of a config at a place."""
    section: type[BaseModel] = config
    for name in location:
        kind = model_of(section.model_fields[name])
        if not (isinstance(kind, type) and issubclass(kind, BaseModel)):
            break
        section = kind
    return section


def model_of(field: FieldInfo) -> Any:
    """The type of a key, without None where it need not be given."""
    kinds = [kind for kind in get_args(field.annotation) if kind is not NoneType]
    return kinds[0] if get_origin(field.annotation) is UnionType and len(kinds) == 1 else field.annotation


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
        return span or ("a finite number" if isinf(bound["gt"]) else f"a finite number above {bound['gt']:g}")
    return "a mapping of keys to values"
