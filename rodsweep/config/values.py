"""Values in a config, numbers and texts, and the base class of its sections, without keys and physics."""

from math import isinf, isnan
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, PlainSerializer

from ..errors import short_repr


class StrictConfigSection(BaseModel):
    """Base class of a config's sections: unknown keys are refused, types are not converted, values are
    frozen."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def as_float(value: Any) -> float:
    """Float from a YAML number or from the texts inf, +inf and -inf; ValueError for nan and for all other
    values."""
    if isinstance(value, str) and value.strip().lower() in ("inf", "+inf", "-inf"):
        return float(value)
    if value is None:
        raise ValueError("a value is missing; give a number")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{short_repr(value)} is not a number")
    try:
        number = float(value)
    except OverflowError:
        raise ValueError(f"{short_repr(value)} is too large for a floating-point number") from None
    if isnan(number):
        raise ValueError("nan is not allowed; give a number")
    return number


def overflows_float(text: str) -> bool:
    """Whether a text is a decimal number that is too large for a float, such as 1e400."""
    try:
        return any(c.isdigit() for c in text) and isinf(float(text))
    except ValueError:
        return False


def cell_number(cell: str) -> float:
    """Float from the text in a cell of a CSV file; ValueError for nan, and for a text that is no number."""
    if "_" in cell or not cell.isascii() or overflows_float(cell):
        raise ValueError
    return as_float(float(cell))


def printable_name(name: object, max_length: int = 200) -> str:
    """The name as text for a message, or `repr` of the text if the text is not printable; shortened in the
    middle to at most `max_length` characters."""
    text = str(name)
    if not text.isprintable():
        text = repr(text)
    return text if len(text) <= max_length else f"{text[: max_length // 2]}...{text[3 - max_length // 2 :]}"


def printable(text: str) -> str:
    """The text with every control character escaped, for example as `\\x1b`; line breaks stay."""
    return "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in text)


def require_printable_text(value: Any) -> Any:
    """The value unchanged; ValueError for a text with control characters or lone surrogates."""
    if isinstance(value, str) and not all(c.isprintable() or c == " " for c in value):
        raise ValueError(f"{short_repr(value)} has characters that cannot be printed")
    return value


Text = Annotated[str, BeforeValidator(require_printable_text)]
Number = Annotated[
    float,
    BeforeValidator(as_float),
    PlainSerializer(lambda number: str(number) if isinf(number) else number, when_used="json"),
]
"""Type of a number in a config: a float. JSON stores infinite numbers as text."""
