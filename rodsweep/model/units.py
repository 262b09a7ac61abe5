"""Conversion of quantities like "10 cm" or "1.4 Pa s" to SI. Only this module imports pint, at first use."""

import math
import re
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import EnvironmentIncomplete, InputError

if TYPE_CHECKING:
    from pint import UnitRegistry

GivenQuantity = float | str
"""A quantity as the user writes it: a text with a unit, or a number in SI units."""
NUMBER_AND_UNIT_PATTERN = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*", re.ASCII)
"""Pattern of a number and a unit, like "10 cm". The unit may be empty."""
UNIT_TOKEN_PATTERN = re.compile(r"[A-Za-zµμ]+|(?:\^|\*\*)?-?[1-4](?!\d)|[²³⁴]|[\s*/]")
"""Pattern of one token of a unit: a name, an exponent, a product or quotient sign. Only sequences of tokens
are passed to pint, which would evaluate any other text and might never return."""
POWER_OF_POWER_PATTERN = re.compile(r"[\d²³⁴]\s*(?:\*\*|\^)")
"""Pattern of the start of a power of a power, like 2**2**2, which pint would evaluate."""
MAX_UNIT_LENGTH = 40
"""Maximum number of characters of a unit. Longer units are refused."""
MAX_SHOWN_LENGTH = 60
"""Maximum number of characters of a quantity in a message. Longer texts are cut."""
CONVERSION_CACHE_SIZE = 1000
"""Maximum number of cached conversion factors. A config has about ten different units."""
COMMON_UNITS = ("cm", "mm", "kPa", "MPa", "GPa", "Pa s", "mPa s", "kPa s", "mN", "kg/m^3", "g/cm^3", "mbar")
"""Units that are suggested if the user's text differs from the unit only in blanks or capital letters."""
UNSIGNED_NUMBER_PATTERN = r"\s*((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,2})?)"
"""Pattern of the number, 0 or above, in a load relative to flutter; with two digits of exponent it cannot
overflow."""
MULTIPLE_OF_FLUTTER_PATTERN = re.compile(
    UNSIGNED_NUMBER_PATTERN + r"\s*(%?)\s*(?:of|times)\s+flutter\s*", re.ASCII
)
"""Pattern of a load as a multiple of the flutter threshold, "1.2 of flutter" or "120 % of flutter"."""
INTENDED_RELATIVE_LOAD_PATTERN = re.compile(r"%?\s*(of|times|above|below)\b|.*flutter", re.ASCII)
"""Pattern of the unit of a text that is meant as a load relative to flutter, such as "of fluter"."""
PERCENT_FROM_FLUTTER_PATTERN = re.compile(
    UNSIGNED_NUMBER_PATTERN + r"\s*%\s*(above|below)\s+flutter\s*", re.ASCII
)
"""Pattern of a load as a distance from the flutter threshold, "20 % above flutter"."""

LOAD_UNITS = ("Pa", "N")
"""SI units of the loads that can be given relative to flutter."""
KINEMATIC_VISCOSITY_MESSAGE = "is a kinematic viscosity; multiply it by the density of the fluid"
"""End of the message on a viscosity in units of length^2/time."""


@cache
def unit_registry() -> "UnitRegistry":
    """pint's registry of units, loaded at first use. Raises EnvironmentIncomplete without pint."""
    try:
        from pint import UnitRegistry
    except ModuleNotFoundError:
        raise EnvironmentIncomplete("units need pint: pip install pint") from None
    return UnitRegistry()


def split_quantity(text: str) -> tuple[float, str]:
    """Returns (number, unit) of a text like "10 cm"; (nan, "") for a text that does not start with a number.
    In the unit, "." and "·", as in "Pa·s", are replaced by "*". The unit may be "", and is not checked."""
    match = NUMBER_AND_UNIT_PATTERN.fullmatch(text)
    if not match:
        return math.nan, ""
    return float(match[1]), match[2].replace("·", "*").replace(".", "*")


def quantity_in_si(name: str, quantity: GivenQuantity, si_unit: str, example: str) -> float:
    """Value, in the SI unit `si_unit`, of the quantity `name`, which the user wrote as `quantity`. example: a
    valid text, for messages. Raises InputError, beginning with the name, for an invalid quantity."""
    allowed_text = f"a number with a unit, as in '{example}'"
    shown_text = _shortened_text(quantity)
    if not isinstance(quantity, str):
        value = _number_in_si(name, quantity, si_unit, allowed_text)
    else:
        number, unit_text = split_quantity(quantity)
        if math.isnan(number):
            raise InputError(f"{name} = '{shown_text}' is not {allowed_text}")
        if not unit_text:
            raise InputError(f"{name} = '{shown_text}' has no unit; write {allowed_text}")
        value = number * conversion_factor(f"{name} = '{shown_text}'", unit_text, si_unit, allowed_text)
    if not math.isfinite(value):
        raise InputError(f"{name} = '{shown_text}' is not a finite number")
    return value


def _shortened_text(quantity: Any) -> str:
    """The quantity as text on one line for a message, cut to MAX_SHOWN_LENGTH characters."""
    try:
        text = " ".join(str(quantity).split())
    except ValueError:  # an integer of thousands of digits
        return "an integer too large to be shown"
    return text if len(text) <= MAX_SHOWN_LENGTH else f"{text[: MAX_SHOWN_LENGTH - 3]}..."


def _number_in_si(name: str, quantity: Any, si_unit: str, allowed_text: str) -> float:
    """Value in the SI unit `si_unit` of `quantity`, a number in SI or a pint quantity. Raises InputError for
    other objects. name, allowed_text: name of the quantity and allowed texts, for messages."""
    if hasattr(quantity, "to_base_units"):
        return _number_in_si(name, quantity.magnitude, si_unit, allowed_text) * conversion_factor(
            f"{name} = '{quantity!s:.60}'", f"{quantity.units:C}", si_unit, allowed_text
        )
    try:
        if isinstance(quantity, list | tuple) or np.ndim(quantity) or np.ma.is_masked(quantity):
            raise TypeError
        number = quantity.item() if hasattr(quantity, "item") else quantity
        # Texts in bytes or arrays have no unit either, so they are refused as all other texts without a unit.
        if isinstance(number, bool | complex | str | bytes):
            raise TypeError
        return float(number)
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            f"{name} = {_shortened_text(quantity)} is not a single quantity; write {allowed_text}, or a "
            f"number in {si_unit}"
        ) from None


def conversion_factor(beginning: str, unit_text: str, si_unit: str, allowed_text: str) -> float:
    """Number by which a value in the unit `unit_text` is multiplied to get the value in `si_unit`.
    beginning, allowed_text: beginning and end of messages. Raises InputError for an unknown unit or another
    dimension."""
    if unit_text.startswith(","):
        raise InputError(f"{beginning} has a decimal comma; write a point")
    if si_unit in LOAD_UNITS and INTENDED_RELATIVE_LOAD_PATTERN.match(unit_text):
        raise InputError(
            f"{beginning} is not a load relative to flutter; write it like '1.2 of flutter' or "
            "'20 % below flutter', with a number of 0 or above"
        )
    if (
        len(unit_text) > MAX_UNIT_LENGTH
        or UNIT_TOKEN_PATTERN.sub("", unit_text)
        or POWER_OF_POWER_PATTERN.search(unit_text)
    ):
        raise InputError(
            f"{beginning} has the unit '{unit_text[:MAX_UNIT_LENGTH]}', "
            f"which is not understood; write {allowed_text}"
        )
    units = unit_registry()
    from pint.errors import PintError

    try:
        return _cached_conversion_factor(unit_text, si_unit)
    except PintError as error:
        is_known_unit = "from" in str(error)  # pint: "Cannot convert from ..." for another dimension
        reason = f"is not measured in {si_unit}" if is_known_unit else f"has the unknown unit '{unit_text}'"
        if is_known_unit and si_unit == "Pa*s" and units.Quantity(1.0, unit_text).check("[length]**2/[time]"):
            reason = KINEMATIC_VISCOSITY_MESSAGE
        raise InputError(
            f"{beginning} {reason}; {_suggestion(unit_text, si_unit)}write {allowed_text}"
        ) from None
    except Exception as error:  # pint's parser raises errors of many types for invalid units
        raise InputError(
            f"{beginning} has the unit '{unit_text}', which is not understood; write {allowed_text}"
        ) from error


@lru_cache(CONVERSION_CACHE_SIZE)
def _cached_conversion_factor(unit_text: str, si_unit: str) -> float:
    """Conversion factor from the unit `unit_text` to `si_unit`, cached; raises the errors of pint."""
    return float(unit_registry().Quantity(1.0, unit_text).to(si_unit).magnitude)


def _suggestion(unit_text: str, si_unit: str) -> str:
    """The text "did you mean 'kPa'? " if `unit_text` differs from a common unit of the dimension of `si_unit`
    only in spaces and in upper and lower case; else ""."""
    plain_text = "".join(unit_text.split()).casefold()
    for common_unit in COMMON_UNITS:
        if "".join(common_unit.split()).casefold() == plain_text and unit_registry()(common_unit).check(
            unit_registry()(si_unit)
        ):
            return f"did you mean '{common_unit}'? "
    return ""


def unit_of(quantity: GivenQuantity, default_unit: str) -> str:
    """The unit in the text of a quantity; `default_unit` for a number or a text without a unit."""
    return (split_quantity(quantity)[1] or default_unit) if isinstance(quantity, str) else default_unit


def value_in_unit(value: float, unit: str, si_unit: str) -> float:
    """Value in `unit` of the quantity that has the value `value` in the SI unit `si_unit`."""
    return value / conversion_factor("", unit, si_unit, "")


def load_over_flutter(text: GivenQuantity) -> float | None:
    """Load divided by the flutter load, from a text like "1.2 of flutter" or "20 % above flutter". None for a
    number, for any other text, and for 100 % or more below flutter."""
    if not isinstance(text, str):
        return None
    if match := MULTIPLE_OF_FLUTTER_PATTERN.fullmatch(text):
        return float(match[1]) / (100.0 if match[2] else 1.0)
    if (match := PERCENT_FROM_FLUTTER_PATTERN.fullmatch(text)) and (
        match[2] == "above" or float(match[1]) < 100
    ):
        return 1.0 + (1.0 if match[2] == "above" else -1.0) * float(match[1]) / 100.0
    return None


def with_si_prefix(value: float, unit: str) -> tuple[float, str]:
    """Returns (factor, prefixed unit) such that `value` in the SI unit `unit` equals factor * value in the
    prefixed unit. The prefix suits the size of the value: with_si_prefix(0.002, "m") is (1000.0, "mm"). For a
    value that is 0, inf or nan, returns (1.0, `unit`)."""
    if not value or not math.isfinite(value):
        return 1.0, unit
    prefixed = unit_registry().Quantity(value, unit).to_compact()
    # Releases of pint use different characters for micro.
    return float(prefixed.magnitude) / value, f"{prefixed.units:~}".replace("\u03bc", "\u00b5")
