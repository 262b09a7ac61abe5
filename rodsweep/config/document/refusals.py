"""What is wrong with a config as one sentence: which key, which value, what is allowed, what was meant."""

from collections.abc import Sequence
from math import isinf
from types import NoneType, UnionType
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ...model.parameters import PARAMETERS
from ..axes import words
from ..schema import Config
from ..values import named, short

KEY_SHOWN = 100
"""Characters of a key that a sentence has room for."""
LETTERS_A_SLIP = 3
"""Letters of a key that are needed for each that is wrong, so that the rest says which was meant."""
MOST_MEANT = 4
"""Keys that an unknown one may mean; where it may mean more, all that there are say as much."""
LONG_PART = 4
"""Letters of a part of a key from which it says which was meant, as `density` of `fluid_density`."""


def sentence_of(config: type[Config], problem: Any) -> str:
    """One pydantic problem as a sentence: which key, which value, what is allowed."""
    location = tuple(str(part) for part in problem["loc"])
    key = dotted(location)
    kind, value = problem["type"], problem["input"]
    if kind == "extra_forbidden":
        fields = _section(config, location[:-1]).model_fields
        known = [
            *(name for name in PARAMETERS if name in fields),
            *(n for n in fields if n not in PARAMETERS),
        ]
        elsewhere = places_of(config, location)
        hint = f"did you mean {elsewhere[0]}?" if elsewhere else hint_of(location[-1], known)
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


def hint_of(key: str, known: Sequence[str], there_are: str = "known keys are") -> str:
    """What is said of an unknown key: which it may mean, or which there are."""
    close = nearest(key, known)
    return f"did you mean {words(tuple(close), 'or')}?" if close else f"{there_are} {', '.join(known)}"


def nearest(key: str, known: Sequence[str]) -> list[str]:
    """The known keys that an unknown one may mean, the nearest ones, in their order; none if none is near.

    Near is the same but for capitals and underscores, a beginning or a long part of it, or a slip of the pen
    in every third letter at most.
    """
    near = [(slips, name) for name in known if (slips := _slips(_plain(key), _plain(name))) is not None]
    least = min((slips for slips, _ in near), default=0)
    nearest_ones = [name for slips, name in near if slips == least]
    return nearest_ones if key and len(nearest_ones) <= MOST_MEANT else []


def _plain(key: str) -> str:
    return key.lower().replace("_", "")


def _slips(key: str, name: str) -> float | None:
    """Letters by which a key differs from a name, half of one where it is a part of it; None where far."""
    if key == name:
        return 0
    if name.startswith(key) or (len(key) >= LONG_PART and key in name):
        return 0.5
    distance = _edits(key, name)
    return distance if LETTERS_A_SLIP * distance <= max(len(key), len(name)) else None


def _edits(a: str, b: str) -> int:
    """Letters to put in, take out, change or swap with the next to make b of a."""
    rows = [list(range(len(b) + 1))]
    for i, letter in enumerate(a, 1):
        row = [i]
        for j, other in enumerate(b, 1):
            least = min(rows[-1][j] + 1, row[-1] + 1, rows[-1][j - 1] + (letter != other))
            if i > 1 and j > 1 and (letter, a[i - 2]) == (b[j - 2], other):
                least = min(least, rows[-2][j - 2] + 1)
            row.append(least)
        rows.append(row)
    return rows[-1][-1]


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
