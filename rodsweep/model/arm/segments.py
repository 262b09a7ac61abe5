"""Segments of an arm as users write them, "4 cm: radius 6 mm, young 80 kPa", and as numbers in SI."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from ...errors import InputError, short_repr
from ..units import GivenQuantity
from .quantities import UNITS_AND_EXAMPLES, arm_quantity_in_si, quoted_quantity, radius_name_of_diameter
from .section import BoreTooWide, Circle, Tube

SEGMENT_KEYS = ("length", "radius", "inner_radius", "young")
"""Names of the quantities of a segment. The default of `young` is Young's modulus of the arm."""
EXAMPLE_SEGMENT = "4 cm: radius 6 mm, young 80 kPa"
"""Text of a valid segment, for messages."""
SEGMENT_QUANTITY_PATTERN = re.compile(r"\s*([A-Za-z][A-Za-z_ -]*?)\s*=?\s*([+-]?[\d.].*?)\s*")
"""Pattern of name and value of one quantity in the text of a segment, like "radius 6 mm"."""
MAX_SEGMENTS = 100
"""Maximum number of segments of an arm; more segments are refused. Each needs an element of the mesh."""

WrittenSegment = Mapping[str, GivenQuantity]
"""Quantities of a segment by name, as the user wrote them."""


class ArmSegment(NamedTuple):
    """A uniform segment of an arm, in SI units. young: None if the segment has Young's modulus of the arm."""

    length: float
    """Length of the segment, in m."""
    section: Circle | Tube
    """Cross-section of the segment."""
    young: float | None


def segment_texts(segments: Any) -> tuple[str, ...]:
    """Texts of all segments of an arm, the input of `segments_from_texts`. segments: the user's value of
    `segments`. Raises InputError, beginning with "segments", for an invalid segment."""
    if isinstance(segments, str | Mapping):
        segments = [segments]
    if hasattr(segments, "tolist"):  # an array of texts
        segments = segments.tolist()
    if isinstance(segments, Sequence) and not segments:
        raise InputError(f"segments has no segment; write each segment as in '{EXAMPLE_SEGMENT}'")
    if not isinstance(segments, Sequence):
        raise InputError(
            f"segments = {short_repr(segments)} is not a list; write each segment as in '{EXAMPLE_SEGMENT}'"
        )
    if len(segments) > MAX_SEGMENTS:
        raise InputError(f"segments: {len(segments)} are given; give at most {MAX_SEGMENTS}")
    written_segments = [
        quantities_of_written_segment(number, segment) for number, segment in enumerate(segments, 1)
    ]
    for number, quantities in enumerate(written_segments, 1):
        _segment_in_si(number, quantities)
    return tuple(map(_segment_text, written_segments))


def segments_from_texts(texts: Sequence[str]) -> tuple[ArmSegment, ...]:
    """Segments in SI units. texts: result of `segment_texts`."""
    return tuple(
        _segment_in_si(number, quantities_of_written_segment(number, text))
        for number, text in enumerate(texts, 1)
    )


def quantities_of_written_segment(segment_number: int, segment: Any) -> WrittenSegment:
    """Quantities of a segment. segment: a text or a mapping. Raises InputError for an invalid text, and for
    an unknown or a missing key. segment_number: position of the segment, counted from 1 at the base, for
    messages."""
    start = f"segments, number {segment_number}"
    quantities = dict(_quantities_by_name(start, segment))
    for name in quantities:
        if name not in SEGMENT_KEYS:
            radius = radius_name_of_diameter(name, SEGMENT_KEYS)
            advice = f"give {radius}, half of it" if radius else f"a segment has {', '.join(SEGMENT_KEYS)}"
            raise InputError(f"{start}: unknown key {name}; {advice}")
    for name in ("length", "radius"):
        if quantities.get(name) is None:
            raise InputError(f"{start}: {name} is missing; write a segment as in '{EXAMPLE_SEGMENT}'")
    return {name: quantities[name] for name in SEGMENT_KEYS if quantities.get(name) is not None}


def _quantities_by_name(start: str, segment: Any) -> Mapping[str, GivenQuantity]:
    """Quantities of a segment by name. segment: a mapping or a text. Raises InputError, beginning with
    `start`, for any other value and for an invalid text."""
    if isinstance(segment, Mapping):
        return {str(name): value for name, value in segment.items()}
    length, colon, parts = segment.partition(":") if isinstance(segment, str) else ("", "", "")
    if not colon:
        given_text = " has no value" if segment is None else f": {short_repr(segment)} is not a segment"
        raise InputError(f"{start}{given_text}; write a segment as in '{EXAMPLE_SEGMENT}'")
    quantities: dict[str, GivenQuantity] = {"length": length.strip()}
    for part in parts.split(","):
        match = SEGMENT_QUANTITY_PATTERN.fullmatch(part)
        if match is None:
            raise InputError(
                f"{start}: {short_repr(part.strip())} is not a quantity; write a segment as in "
                f"'{EXAMPLE_SEGMENT}'"
            )
        name = match[1].replace("-", "_").replace(" ", "_")
        if name in quantities:
            raise InputError(f"{start}: {name} is given twice; give it once")
        quantities[name] = match[2]
    return quantities


def _segment_in_si(segment_number: int, quantities: WrittenSegment) -> ArmSegment:
    """The segment in SI units. segment_number: its position, for messages. Raises InputError for a value
    out of range, and BoreTooWide if the bore is too wide."""
    start = f"segments, number {segment_number}"
    try:
        length, radius, inner_radius, young = (
            arm_quantity_in_si(name, quantities.get(name)) for name in SEGMENT_KEYS
        )
    except InputError as error:
        raise InputError(f"{start}: {error}") from None
    if "inner_radius" not in quantities:
        return ArmSegment(length, Circle(radius), young if "young" in quantities else None)
    if inner_radius >= radius:
        bore, outer = (quoted_quantity(name, quantities[name]) for name in ("inner_radius", "radius"))
        raise BoreTooWide(f"{start}: {bore} is not below {outer}")
    return ArmSegment(length, Tube(radius, inner_radius), young if "young" in quantities else None)


def _segment_text(quantities: WrittenSegment) -> str:
    """The segment as a text that `quantities_of_written_segment` accepts."""
    texts = {
        name: value.strip()
        if isinstance(value, str)
        else f"{arm_quantity_in_si(name, value)!r} {UNITS_AND_EXAMPLES[name][0]}"
        for name, value in quantities.items()
    }
    length = texts.pop("length")
    return f"{length}: {', '.join(f'{name} {text}' for name, text in texts.items())}"
