"""Quantities of an arm in a config: a value, a list or a range, with units, converted to SI units."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from ...arrays import list_of
from ...errors import InputError, short_repr
from ...model.arm.drag import ALL_DRAG_ESTIMATES_NAME, DRAG_ESTIMATE_NAMES
from ...model.arm.quantities import LOAD_NAME_BY_RELATIVE_LOAD, UNITS_AND_EXAMPLES
from ...model.units import load_over_flutter, quantity_in_si, split_quantity, value_in_unit
from ..axis import AXIS_SCHEMA, RANGE_ENDS, Axis, as_axis
from ..values import as_float


def quantity_axis(value: Any, validation: ValidationInfo) -> Axis:
    """The `Axis`, in SI units, from a quantity, or a list or range of quantities, as the user wrote it;
    ValueError otherwise."""
    name = str(validation.field_name)
    if isinstance(value, Axis):
        return value
    return _axis_in_si(name, value).model_copy(update={"written": value})


def _axis_in_si(name: str, value: Any) -> Axis:
    if isinstance(value, dict):
        ends = {end: _si_number(name, value[end]) for end in RANGE_ENDS if end in value}
        try:
            return as_axis(value | ends)
        except ValueError as error:
            hint = _missing_unit_remark(name, value) if ends.get("start", 0) >= ends.get("stop", 1) else ""
            raise ValueError(f"{error}{hint}") from None
    if isinstance(value, list | tuple):
        return as_axis([_si_number(name, entry) for entry in value])
    return as_axis(_si_number(name, value))


def _missing_unit_remark(name: str, span: dict[str, Any]) -> str:
    """Remark for error messages if only start or only stop of a range has a unit, else ""."""
    unitless = [end for end in RANGE_ENDS if end in span and not isinstance(span[end], str)]
    if len(unitless) != 1 or not all(end in span for end in RANGE_ENDS):
        return ""
    unit = UNITS_AND_EXAMPLES[name][0]
    return f" in {unit}; {unitless[0]} has no unit, so it is in {unit}"


def _si_number(name: str, value: Any) -> float:
    """Number in SI units from `value`, a number or a text with a unit; ValueError for other values."""
    if not isinstance(value, str):
        return as_float(value)
    try:
        return quantity_in_si(f"parameters.arm.{name}", value, *UNITS_AND_EXAMPLES[name])
    except InputError as error:
        raise ValueError(str(error)) from None


def with_load_over_flutter(section: Mapping[str, Any]) -> dict[str, Any]:
    """Keys and values of an arm, in which a load given as a multiple of the flutter load, like `pressure:
    "1.2 of flutter"`, becomes a number under a key like `pressure_over_flutter`.

    section: keys and values from the config. Raises ValueError if only some values of the load are relative,
    or if both `pressure` and `pressure_over_flutter` (or both force keys) are given.
    """
    result = dict(section)
    for name, load in LOAD_NAME_BY_RELATIVE_LOAD.items():
        values = _values_as_written(section.get(load))
        ratios = [None if value is None else load_over_flutter(value) for value in values]
        if all(ratio is None for ratio in ratios):
            continue
        if None in ratios:
            raise ValueError(
                f"parameters.arm.{load} = {short_repr(section[load])} has relative and absolute values; "
                "write all values like '1.2 of flutter', or all as absolute loads"
            )
        if section.get(name) is not None:
            keys = f"parameters.arm.{load} and parameters.arm.{name}"
            raise ValueError(f"{keys} are both given; give one of them")
        is_range = isinstance(section[load], Mapping)
        result[name] = {**section[load], **dict(zip(RANGE_ENDS, ratios, strict=True))} if is_range else ratios
        del result[load]
    return result


def drag_axis(value: Any) -> Axis:
    """Axis of indices into DRAG_ESTIMATE_NAMES, from a drag's name, a list of names, or "range"; ValueError
    otherwise."""
    if isinstance(value, Axis):
        return value
    names = value if isinstance(value, list | tuple) else [value]
    if value == ALL_DRAG_ESTIMATES_NAME:
        names = list(DRAG_ESTIMATE_NAMES)
    if not names or not all(isinstance(name, str) and name in DRAG_ESTIMATE_NAMES for name in names):
        raise ValueError(
            f"{short_repr(value)} is not a drag; write {ALL_DRAG_ESTIMATES_NAME}, one of the names "
            f"{', '.join(DRAG_ESTIMATE_NAMES)}, or a list of these names"
        )
    if len(set(names)) < len(names):
        raise ValueError(f"{short_repr(value)} names a drag twice; list each name once")
    return Axis(
        values=tuple(float(index) for index in sorted({DRAG_ESTIMATE_NAMES.index(name) for name in names}))
    )


def drag_estimate_names_of_indices(indices: list[float]) -> list[str]:
    """Names of the drag estimates with the given `indices` in DRAG_ESTIMATE_NAMES; all indices are whole
    numbers."""
    return [DRAG_ESTIMATE_NAMES[int(index)] for index in indices]


def typed_unit(name: str, axis: Axis) -> str:
    """First unit that the user typed for the values of an axis of the quantity `name`; the SI unit if no unit
    was typed."""
    units = [split_quantity(value)[1] for value in _values_as_written(axis.written) if isinstance(value, str)]
    return next(filter(None, units), UNITS_AND_EXAMPLES[name][0])


def quantities_as_typed(quantities: Mapping[str, Axis]) -> str:
    """Text with names, values and typed units of an arm's quantities, like "length 10 cm, radius 5 mm".

    A remark at the end names the quantities that were given without a unit; the value 0 needs no unit.
    """
    typed = []
    unitless = []
    for name, axis in quantities.items():
        end_values = list_of(axis.array()[[0, -1]])
        if name == "drag":
            drag_list = drag_estimate_names_of_indices(list_of(axis.array()))
            has_all = len(drag_list) == len(DRAG_ESTIMATE_NAMES)
            typed.append(f"drag {ALL_DRAG_ESTIMATES_NAME if has_all else ' and '.join(drag_list)}")
            continue
        unit = typed_unit(name, axis) if name in UNITS_AND_EXAMPLES else ""
        texts = [
            f"{value_in_unit(end, unit, UNITS_AND_EXAMPLES[name][0]) if unit else end:.6g}"
            for end in end_values
        ]
        typed.append(f"{name} {' to '.join(dict.fromkeys(texts))} {unit}".rstrip())
        written_values = _values_as_written(axis.written)
        if unit and not all(isinstance(written, str) or written == 0 for written in written_values):
            unitless.append(name)
    hint = f" ({' and '.join(unitless)} without a unit: SI)" if unitless else ""
    return f"{', '.join(typed)}{hint}".replace("_", " ")


def _values_as_written(written: Any) -> list[Any]:
    """List of the values in `written`, a quantity as the user wrote it; for a range, [start, stop]."""
    if isinstance(written, Mapping):
        return [written.get(end) for end in RANGE_ENDS]
    return list(written) if isinstance(written, list | tuple) else [written]


def _quantity_schema() -> dict[str, Any]:
    """JSON schema of the values that `quantity_axis` accepts: axes of numbers or of texts with a unit."""
    item: dict[str, Any] = {"anyOf": [{"type": "number"}, {"type": "string"}]}
    *_, values, span = AXIS_SCHEMA["anyOf"]
    properties = span["properties"]
    ends = {end: {"description": properties[end]["description"], **item} for end in RANGE_ENDS}
    quantity_range = span | {"properties": properties | ends}
    return {"anyOf": [*item["anyOf"], values | {"items": item}, quantity_range]}


DRAG_LIST_SCHEMA = {"type": "array", "items": {"enum": list(DRAG_ESTIMATE_NAMES)}, "minItems": 1}
"""JSON schema of a list of names of drag estimates."""
DRAG_SCHEMA = {"anyOf": [{"enum": [ALL_DRAG_ESTIMATES_NAME, *DRAG_ESTIMATE_NAMES]}, DRAG_LIST_SCHEMA]}
QuantityAxis = Annotated[Axis, BeforeValidator(quantity_axis), WithJsonSchema(_quantity_schema())]
DragAxis = Annotated[Axis, BeforeValidator(drag_axis), WithJsonSchema(DRAG_SCHEMA)]
