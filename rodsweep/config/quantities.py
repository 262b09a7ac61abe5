"""What a quantity of an arm may be in a config: one value, a list or a range, with units; in SI then."""

from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from ..errors import InputError
from ..model.arm import LOADS, UNITS, share_of_flutter
from ..model.units import in_si, split
from .values import AXIS_SCHEMA, Axis, as_axis, as_number


def as_quantities(value: Any, info: ValidationInfo) -> Axis:
    """A quantity, a list or a range of quantities as an Axis in SI units; ValueError otherwise."""
    name = str(info.field_name)
    if isinstance(value, Axis):
        return value
    return _axis_in_si(name, value).model_copy(update={"written": value})


def _axis_in_si(name: str, value: Any) -> Axis:
    if isinstance(value, dict):
        ends = {end: _read(name, value[end]) for end in ("start", "stop") if end in value}
        try:
            return as_axis(value | ends)
        except ValueError as error:
            remark = _without_unit(name, value) if ends.get("start", 0) >= ends.get("stop", 1) else ""
            raise ValueError(f"{error}{remark}") from None
    if isinstance(value, list | tuple):
        return as_axis([_read(name, each) for each in value])
    return as_axis(_read(name, value))


def _without_unit(name: str, span: dict[str, Any]) -> str:
    """A remark on a range of which one end has a unit and the other has none; else empty."""
    ends = [end for end in ("start", "stop") if end in span]
    bare = [end for end in ends if not isinstance(span[end], str)]
    unit = UNITS[name][0]
    return f" in {unit}; {bare[0]} has no unit, so it is in {unit}" if len(bare) == 1 < len(ends) else ""


def _read(name: str, value: Any) -> float:
    """A quantity in SI units; ValueError where it is none."""
    if not isinstance(value, str):
        return as_number(value)
    if name in LOADS and share_of_flutter(value) is not None:
        raise ValueError(
            f"parameters.arm.{name} = '{value}' is relative to flutter, which a config does not know; write "
            "the load that `rodsweep arm` says it is; rs.sweep(TASK, arm=rs.Arm(...)) takes a relative one"
        )
    try:
        return in_si(f"parameters.arm.{name}", value, *UNITS[name])
    except InputError as error:
        raise ValueError(str(error)) from None


def typed_unit(name: str, axis: Axis) -> str:
    """The unit in which a quantity was typed, the first of several; the SI unit where it was none."""
    written = axis.written
    if isinstance(written, dict):
        written = [written.get("start"), written.get("stop")]
    each = written if isinstance(written, list | tuple) else [written]
    units = [split(value)[1] for value in each if isinstance(value, str)]
    return next(filter(None, units), UNITS[name][0])


def _schema() -> dict[str, Any]:
    """What `as_quantities` takes, as a JSON schema: an axis whose numbers may be text with a unit."""
    each: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
    *_, values, span = AXIS_SCHEMA["anyOf"]
    ends = {end: {"description": span["properties"][end]["description"], **each} for end in ("start", "stop")}
    return {
        "anyOf": [
            *each["anyOf"],
            values | {"items": each},
            span | {"properties": span["properties"] | ends},
        ]
    }


Quantities = Annotated[Axis, BeforeValidator(as_quantities), WithJsonSchema(_schema())]
