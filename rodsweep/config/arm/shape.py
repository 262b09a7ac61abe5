"""Shape and material of an arm in a config: segments, taper, constitutive law, and the resulting
`RodMaterial`."""

from collections.abc import Iterator
from contextlib import suppress
from itertools import product
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from ...arrays import list_of
from ...errors import InputError
from ...model.arm.segments import (
    EXAMPLE_SEGMENT,
    MAX_SEGMENTS,
    SEGMENT_KEYS,
    segment_texts,
    segments_from_texts,
)
from ...model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ...model.units import unit_of, value_in_unit
from .status import ArmOutsideModel

if TYPE_CHECKING:
    from .section import ArmConfig

MATERIAL_KEYS = ("segments", "law", "section")
"""Keys of an arm that correspond to the config section `material` of a dimensionless rod."""
NONUNIFORM_ARM_KEYS = ("tip_radius", "segments")
"""Keys of an arm that varies along its length."""
RUBBER_POISSON = 0.5
"""Poisson's ratio of incompressible rubber. A swelling section requires this ratio."""


def as_segments(value: Any) -> tuple[str, ...] | None:
    """Segments of a config value as texts; None if the value is None. Raises ValueError for an invalid list
    of segments."""
    if value is None:
        return None
    try:
        return segment_texts(value)
    except InputError as error:
        raise ValueError(f"parameters.arm.{error}") from None


def with_length(section: dict[str, Any]) -> dict[str, Any]:
    """The keys and values `section` of an arm; if segments are given without `length`, their total length is
    added."""
    if section.get("segments") is None or section.get("length") is not None:
        return section
    segment_texts = as_segments(section["segments"]) or ()
    unit = unit_of(segment_texts[0].partition(":")[0], "m")
    total = sum(segment.length for segment in segments_from_texts(segment_texts))
    return section | {"length": f"{value_in_unit(total, unit, 'm'):.15g} {unit}"}


def material_of(arm: "ArmConfig") -> RodMaterial:
    """Constitutive law of all arms, with the profile of the first arm to which the rod model applies; without
    a profile if there is no such arm.

    Raises ValueError if the law does not allow the section, or if the arms of a grid of parameters have
    different profiles.
    """
    try:
        uniform_material = RodMaterial(
            arm.law or DEFAULT_MATERIAL.law, arm.section or DEFAULT_MATERIAL.section
        )
    except ValueError as error:
        raise ValueError(f"parameters.arm.{error}") from None
    if all(getattr(arm, name) is None for name in NONUNIFORM_ARM_KEYS):
        return uniform_material
    if arm.is_parameter_grid and len(set(materials_of(arm))) > 1:
        raise ValueError(
            f"parameters.arm.{arm.varying_quantities[0]} has several values, and the ratios between "
            "the segments would differ from value to value; give one value"
        )
    return next(materials_of(arm), uniform_material)


def materials_of(arm: "ArmConfig") -> Iterator[RodMaterial]:
    """Yields the constitutive law and profile of every arm to which the rod model applies."""
    for values in arm.values_of_arms():
        with suppress(ArmOutsideModel):
            yield arm.arm_of(values).material


def tapers_of(arm: "ArmConfig") -> set[float]:
    """All ratios of tip radius to base radius of the arms of a config section; {1.0} if no tip radius or no
    base radius is given."""
    if arm.tip_radius is None or arm.radius is None:
        return {1.0}
    radius_pairs = product(list_of(arm.tip_radius.array()), list_of(arm.radius.array()))
    return {tip_value / base_value for tip_value, base_value in radius_pairs}


def refuse_misused_shape(arm: "ArmConfig", given_parameters: dict[str, Any]) -> None:
    """Raises ValueError if an arm with segments has several lengths, or if `taper` is given for a cone or for
    segments. given_parameters: parameters in the config, by name."""
    if arm.segments is not None and "length" in arm.varying_quantities:
        problem = "parameters.arm.length has several values, but the segments fix the length"
        raise ValueError(f"{problem}; leave it out")
    for name in NONUNIFORM_ARM_KEYS:
        if getattr(arm, name) is not None and "taper" in given_parameters:
            raise ValueError(f"parameters.arm.{name} and parameters.taper are both given; give one of them")


def refuse_compressible(arm: "ArmConfig", section: str) -> None:
    """Raises ValueError if the cross-section `section` is "swelling" but a Poisson's ratio of the arm is not
    0.5."""
    ratios = [] if arm.poisson is None else list_of(arm.poisson.array())
    wrong = next((ratio for ratio in ratios if ratio != RUBBER_POISSON), None)
    if section == "swelling" and wrong is not None:
        raise ValueError(
            f"parameters.arm.poisson = {wrong:g} contradicts section = swelling, which keeps the volume of "
            f"rubber; it must be {RUBBER_POISSON:g}, or section = fixed"
        )


_QUANTITY_SCHEMA = {"anyOf": [{"type": "number"}, {"type": "string"}]}
_SEGMENT_SCHEMAS: list[dict[str, Any]] = [
    {"type": "string", "pattern": r"^[^:]+:.*radius"},
    {
        "type": "object",
        "properties": dict.fromkeys(SEGMENT_KEYS, _QUANTITY_SCHEMA),
        "required": ["length", "radius"],
        "additionalProperties": False,
    },
]
_SEGMENT_LIST_SCHEMA = {"type": "array", "items": {"anyOf": _SEGMENT_SCHEMAS}, "minItems": 1}
_SEGMENTS_SCHEMA = [_SEGMENT_LIST_SCHEMA | {"maxItems": MAX_SEGMENTS}, *_SEGMENT_SCHEMAS, {"type": "null"}]
Segments = Annotated[
    tuple[str, ...] | None, BeforeValidator(as_segments), WithJsonSchema({"anyOf": _SEGMENTS_SCHEMA})
]
ALLOWED_SEGMENTS_TEXT = (
    f"a list of segments, each as '{EXAMPLE_SEGMENT}' or a mapping of {', '.join(SEGMENT_KEYS)}"
)
"""Phrase for messages that describes the allowed values of the key `segments`."""
