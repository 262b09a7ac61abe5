"""The values of one parameter in a config: a number, a list or a range, and their JSON schema."""

from itertools import pairwise
from math import inf
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from ..arrays import Array
from ..errors import short_repr
from .values import Number, StrictConfigSection, as_float

MAX_AXIS_VALUES = 1_000_000_000
"""Maximum number of values on an axis; a range with more values is refused."""
RANGE_ENDS = ("start", "stop")
"""Keys of the ends of a range."""
NUMBER_SCHEMA: dict[str, Any] = {"anyOf": [{"type": "number"}, {"enum": ["inf", "+inf", "-inf"]}]}
"""JSON schema of one value on an axis: a number, or a text for infinity."""
COUNT_SCHEMA = {"type": "integer", "minimum": 1, "maximum": MAX_AXIS_VALUES, "description": "how many"}
"""JSON schema of the number of values of a range."""
AXIS_SCHEMA: dict[str, Any] = {
    "description": "a number, a list in increasing order, or a range",
    "anyOf": [
        *NUMBER_SCHEMA["anyOf"],
        {"type": "array", "items": NUMBER_SCHEMA, "minItems": 1},
        {
            "type": "object",
            "properties": {
                "start": {"type": "number", "description": "the first value"},
                "stop": {"type": "number", "description": "the last value"},
                "num": COUNT_SCHEMA,
                "spacing": {"enum": ["linear", "log"], "default": "linear"},
            },
            "required": [*RANGE_ENDS, "num"],
            "additionalProperties": False,
        },
    ],
}
"""JSON schema of the values that `as_axis` accepts."""
QUANTITY_ROUNDING_DIGITS = 15
"""Number of significant digits to which quantities in SI units are rounded: unit conversion changes the
16th."""


class Axis(StrictConfigSection):
    """Values of a parameter: a number, a list, or `num` values from start to stop."""

    @classmethod
    def __get_pydantic_json_schema__(cls, *_: Any) -> dict[str, Any]:
        """JSON schema of the values that a user writes (a number, a list or a range), not of this class."""
        return AXIS_SCHEMA

    values: tuple[Number, ...] | None = None
    start: float = 0.0
    stop: float = 0.0
    num: int = 0
    spacing: Literal["linear", "log"] = "linear"
    """Spacing of the values of a range: linear, or log for equal ratios."""
    factor: Annotated[float, Field(exclude=True)] = 1.0
    """Factor by which all values of a range are multiplied, such as F divided by the pressure in Pa."""
    written: Annotated[Any, Field(exclude=True)] = None
    """The values of an arm's quantity as the user wrote them, with or without units; None for all other
    axes."""

    @property
    def size(self) -> int:
        return self.num if self.values is None else len(self.values)

    @property
    def is_logarithmic(self) -> bool:
        """Whether the axis has log spacing, or is a list of positive values whose finite values span more
        than a decade."""
        if self.values is None:
            return self.spacing == "log"
        finite = [value for value in self.values if value < inf]
        return bool(finite) and 0 < 10 * finite[0] < finite[-1]

    @property
    def json_value(self) -> dict[str, Any]:
        """The axis as JSON-compatible keys and values, with `factor` applied to start and stop of a range."""
        axis = self.model_dump(mode="json", exclude_none=True)
        range_ends = {} if self.values is not None else {"start": self.start, "stop": self.stop}
        return axis | {name: self.factor * value for name, value in range_ends.items()}

    def scaled(self, scale: float) -> "Axis":
        """A copy of the axis with all values multiplied by `scale`."""
        if self.values is not None:
            return Axis(values=tuple(scale * value for value in self.values))
        # The ends stay unscaled, so that a longer range contains exactly the same values.
        return self.model_copy(update={"factor": scale * self.factor})

    def array(self) -> Array:
        """Values of the axis in increasing order, (size,); for an arm's quantity rounded to
        QUANTITY_ROUNDING_DIGITS digits."""
        if self.values is not None:
            values = np.array(self.values)
        elif self.spacing == "log":
            values = self.factor * np.geomspace(self.start, self.stop, self.num, dtype=np.float64)
        else:
            values = self.factor * np.linspace(self.start, self.stop, self.num, dtype=np.float64)
        if self.written is None:
            return values
        # Rounded, so that 10 cm between 4 cm and 12 cm is 0.1 m, as a user would type, and not 0.099999...
        return np.array([float(f"{value:.{QUANTITY_ROUNDING_DIGITS}g}") for value in values.tolist()])


def as_axis(value: Any) -> Axis:
    """The `Axis` of a number, a list or a mapping {start, stop, num, spacing}; ValueError otherwise."""
    if isinstance(value, Axis):
        return value
    if isinstance(value, dict):
        return _axis_from_range(value)
    if not isinstance(value, list | tuple):
        return Axis(values=(as_float(value),))
    if not value:
        raise ValueError("the list is empty; give at least one number")
    numbers = tuple(as_float(entry) for entry in value)
    if any(high <= low for low, high in pairwise(numbers)):
        text = short_repr(value)
        raise ValueError(f"{text} is not sorted; list the numbers in increasing order, each once")
    return Axis(values=numbers)


def _axis_from_range(value: dict) -> Axis:
    allowed = (*RANGE_ENDS, "num", "spacing")
    for key in value:
        if key not in allowed:
            raise ValueError(f"unknown key {short_repr(key)} in a range; its keys are {', '.join(allowed)}")
    for key in allowed[:3]:
        if value.get(key) is None:
            raise ValueError(f"a range needs start, stop and num, and {key} is missing")
    start = as_float(value["start"])
    stop = as_float(value["stop"])
    num = value["num"]
    if isinstance(num, float) and num.is_integer():  # such as 1e3
        num = int(num)
    spacing = value.get("spacing", "linear")
    if spacing not in ("linear", "log"):
        given_text = "has no value; it is" if spacing is None else f"= {short_repr(spacing)} is neither"
        conjunction = "or" if spacing is None else "nor"
        raise ValueError(f"spacing {given_text} linear {conjunction} log")
    if isinstance(num, bool) or not isinstance(num, int) or not 1 <= num <= MAX_AXIS_VALUES:
        raise ValueError(f"num = {short_repr(num)} is not a whole number from 1 to {MAX_AXIS_VALUES}")
    if abs(start) == inf or abs(stop) == inf:
        raise ValueError("start and stop of a range must be finite; put inf in a list")
    if num == 1 and start != stop:
        raise ValueError(f"num = 1 makes one value, but start = {start:g} and stop = {stop:g} differ")
    if num > 1 and not start < stop:
        raise ValueError(f"start = {start:g} and stop = {stop:g} do not make {num} increasing values")
    if num > 1 and (stop - start) / num <= 4e-16 * max(abs(start), abs(stop)) or stop - start == inf:
        raise ValueError(
            f"floating-point numbers cannot hold {num} values from {start!r} to {stop!r}; use fewer values "
            "or another range"
        )
    if spacing == "log" and start <= 0:
        raise ValueError(f"log spacing needs start above 0, not {start:g}")
    return Axis(start=start, stop=stop, num=num, spacing=spacing)


def axis_from_resolved(axis_dict: dict[str, Any]) -> Axis:
    """The `Axis` from its keys and values in a resolved config; ValueError or TypeError if invalid."""
    values = axis_dict.get("values")
    return Axis(**axis_dict | ({} if values is None else {"values": tuple(map(as_float, values))}))


ParameterAxis = Annotated[Axis, BeforeValidator(as_axis)]
