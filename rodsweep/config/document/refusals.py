"""Error messages of a config: each is a sentence with the key, the value, and the allowed values or the most
similar key."""

from collections.abc import Sequence
from math import isinf
from types import NoneType, UnionType
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ...errors import short_repr
from ...model.arm.quantities import radius_name_of_diameter
from ...model.parameters import PARAMETERS
from ...wording import enumeration
from ..base_config import Config
from ..values import printable_name

MAX_KEY_LENGTH = 100
"""Maximum number of characters of a key in a message; longer keys are shortened."""
LETTERS_PER_TYPING_ERROR = 3
"""A known key is suggested if it differs from the unknown key by at most one typing error per this number of
letters."""
MAX_SUGGESTIONS = 4
"""Maximum number of suggested keys. If more keys are equally similar, all known keys are listed instead."""
MIN_SUBSTRING_LENGTH = 4
"""Minimum number of letters of a substring that identifies a key, such as `density` for `fluid_density`."""


def message_of_problem(config: type[Config], problem: Any) -> str:
    """Message for an error of pydantic: a sentence with key, value and allowed values. problem: one item of
    `ValidationError.errors()`."""
    location = tuple(part for part in problem["loc"] if isinstance(part, str))
    number_texts = [f", number {part + 1}" for part in problem["loc"] if isinstance(part, int)]
    key = dotted_key(location) + "".join(number_texts)
    kind = problem["type"]
    value = problem["input"]
    if kind == "extra_forbidden":
        fields = _section_class(config, location[:-1]).model_fields
        names = [
            *(name for name in PARAMETERS if name in fields),
            *(name for name in fields if name not in PARAMETERS),
        ]
        sections = keys_in_other_sections(config, location)
        hint = f"did you mean {sections[0]}?" if sections else unknown_key_hint(location[-1], names)
        return f"unknown key {key}; {hint}"
    if kind == "missing":
        return f"{key} is missing"
    if kind == "value_error":
        text = str(problem["ctx"]["error"])
        return f"{key}: {text}" if key and not text.startswith(key) else text
    if kind == "invalid_key":
        return f"{short_repr(value)} is not a key; keys are words"
    key_alone = location[-1] if location else ""
    field = None if number_texts else _section_class(config, location[:-1]).model_fields.get(key_alone)
    allowed = allowed_values_text(field) if field else problem["msg"].removeprefix("Input should be ")
    given_text = "has no value" if value is None else f"= {short_repr(value)} is not allowed"
    return f"{key} {given_text}; it should be {allowed}"


def unknown_key_hint(key: str, allowed: Sequence[str], start_kind: str = "known keys are") -> str:
    """Hint for an unknown key: "did you mean ...?" with similar keys, or a list of all known keys, `allowed`.
    start_kind: beginning of the list. For a diameter, the hint is to give the radius."""
    if radius := radius_name_of_diameter(key, allowed):
        return f"give {radius}, half of it"
    if similar := similar_keys(key, allowed):
        return f"did you mean {enumeration(tuple(similar), 'or')}?"
    return f"{start_kind} {', '.join(allowed)}"


def similar_keys(key: str, allowed: Sequence[str]) -> list[str]:
    """The known keys, from `allowed`, that are most similar to an unknown key, in the given order; empty if
    no key is similar, or if more than MAX_SUGGESTIONS keys are equally similar.

    A known key is similar if the unknown key differs only in capitals and underscores, is the beginning of
    the known key, is any part of the known key with at least MIN_SUBSTRING_LENGTH letters, or has at most one
    typing error in LETTERS_PER_TYPING_ERROR letters.
    """
    plain_key = _without_case_and_underscores(key)
    counts = {name: _typing_error_count(plain_key, _without_case_and_underscores(name)) for name in allowed}
    fewest = min((count for count in counts.values() if count is not None), default=0)
    nearest_ones = [name for name in allowed if counts[name] == fewest]
    return nearest_ones if key and len(nearest_ones) <= MAX_SUGGESTIONS else []


def _without_case_and_underscores(key: str) -> str:
    return key.lower().replace("_", "")


def _typing_error_count(key: str, name: str) -> float | None:
    """Number of typing errors in `key` if `name` was meant, 0.5 for a substring; None if the two are not
    similar."""
    if key == name:
        return 0
    if name.startswith(key) or (len(key) >= MIN_SUBSTRING_LENGTH and key in name):
        return 0.5
    longest = max(len(key), len(name))
    if LETTERS_PER_TYPING_ERROR * abs(len(key) - len(name)) > longest:  # the edit distance is no smaller
        return None
    distance = _edit_distance(key, name)
    return distance if LETTERS_PER_TYPING_ERROR * distance <= longest else None


def _edit_distance(first: str, second: str) -> int:
    """Edit distance of the words `first` and `second`: number of insertions, deletions and changes of a
    letter, and of exchanges of neighbouring letters."""
    distance_rows = [list(range(len(second) + 1))]
    for first_length, letter in enumerate(first, 1):
        distance_row = [first_length]
        for column, second_letter in enumerate(second, 1):
            cost = min(
                distance_rows[-1][column] + 1,
                distance_row[-1] + 1,
                distance_rows[-1][column - 1] + (letter != second_letter),
            )
            if (
                first_length > 1
                and column > 1
                and (letter, first[first_length - 2]) == (second[column - 2], second_letter)
            ):
                cost = min(cost, distance_rows[-2][column - 2] + 1)
            distance_row.append(cost)
        distance_rows.append(distance_row)
    return distance_rows[-1][-1]


def keys_in_other_sections(config: type[Config], location: Sequence[str]) -> list[str]:
    """Full names, like "parameters.F", of the known keys in other sections that have the last name in
    `location`."""
    task = str(get_args(config.model_fields["task"].annotation)[0])
    keys = []
    for section in ((), ("parameters",), (task,), ("material",), ("parameters", "arm")):
        if location[-1] in _section_class(config, section).model_fields and section != tuple(location[:-1]):
            keys.append(dotted_key((*section, location[-1])))
    return keys


def dotted_key(location: Sequence[str]) -> str:
    """Full name of a key, like "parameters.F.num", from the names of its sections and its own name; shortened
    to MAX_KEY_LENGTH characters. location: names of the sections, then the key's own name."""
    return printable_name(".".join(location), MAX_KEY_LENGTH)


def _section_class(config: type[Config], location: tuple[str, ...]) -> type[BaseModel]:
    """Class of the config's section that is reached through the keys in `location`; the last section on the
    way if a key is not a section."""
    section: type[BaseModel] = config
    for name in location:
        value_type = value_type_of_key(section.model_fields[name])
        if not (isinstance(value_type, type) and issubclass(value_type, BaseModel)):
            break
        section = value_type
    return section


def value_type_of_key(field: FieldInfo) -> Any:
    """Type of the values of a config key; for an optional key, the type without None."""
    types = [value_type for value_type in get_args(field.annotation) if value_type is not NoneType]
    return types[0] if get_origin(field.annotation) is UnionType and len(types) == 1 else field.annotation


def allowed_values_text(key_field: FieldInfo) -> str:
    """Phrase that describes the allowed values of a config key: its description, otherwise made from its type
    and bounds."""
    kind = key_field.annotation
    bounds = ("ge", "gt", "le", "lt", "max_length")
    bound = {
        name: getattr(rule, name) for rule in key_field.metadata for name in bounds if hasattr(rule, name)
    }
    if key_field.description:
        return key_field.description
    if get_origin(kind) is Literal:
        return enumeration(get_args(kind), "or")
    if kind is bool:
        return "true or false"
    if kind is str:
        return f"text of at most {bound['max_length']} characters"
    if kind is int or kind is float:
        number_noun = "a whole number" if kind is int else "a number"
        span = f"{number_noun} from {bound['ge']:g} to {bound['le']:g}" if "ge" in bound else ""
        return span or ("a finite number" if isinf(bound["gt"]) else f"a finite number above {bound['gt']:g}")
    return "a mapping of keys to values"
