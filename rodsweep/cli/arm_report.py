"""The command `arm`: prints the numbers and the verdict of an arm in SI units."""

import re
from typing import Any

from rich.console import Console

from ..errors import InputError
from ..model.arm.quantities import UNITS_AND_EXAMPLES

PARAGRAPH_STYLES = {"headline": "bold", "warning": "yellow"}
"""Text styles of the printed lines, by kind of line."""


def print_arm_report(typed_values: dict[str, str | None], poisson: float, segments: tuple[str, ...]) -> None:
    """Prints the report on an arm.

    typed_values: values of the options by name of the quantity or law, None if not given. Raises InputError
    for invalid quantities, with the names of the options in the message.
    """
    from ..model.arm.arm import SlenderArm
    from ..verdict.arm import arm_report

    quantities: dict[str, Any] = {name: text for name, text in typed_values.items() if text is not None}
    try:
        report = arm_report(SlenderArm(**quantities, poisson=poisson, segments=segments or None))
    except InputError as error:
        raise InputError(with_option_names(str(error))) from None
    console = Console(highlight=False, soft_wrap=True)
    for line, kind in report.styled_paragraphs():
        console.print(line, markup=False, style=PARAGRAPH_STYLES.get(kind, ""))


QUANTITY_NAME_PATTERN = "|".join((*UNITS_AND_EXAMPLES, "segments"))
"""Regular expression of all names of quantities."""
QUANTITY_NAME_IN_SENTENCE_PATTERN = re.compile(
    rf"^({QUANTITY_NAME_PATTERN})"
    rf"|(?:(?<= and )|(?<=, with )|(?<= is not below ))({QUANTITY_NAME_PATTERN})(?= = | are )"
)
"""Regular expression that finds the name of a quantity in an error message: at its beginning, or between "
and ", ", " or " is not below " and " = " or " are "."""
SEGMENT_NUMBER_PREFIX = "segments, number "
"""Beginning of a message about one segment."""


def with_option_names(sentence: str) -> str:
    """The error message `sentence`, with names of options such as --tip-radius in place of names of
    quantities."""
    # Quantities inside a segment are not options, so only "segments" itself is one there.
    replacements = 1 if sentence.startswith(SEGMENT_NUMBER_PREFIX) else 0
    text = QUANTITY_NAME_IN_SENTENCE_PATTERN.sub(
        lambda match: "--" + match[0].replace("_", "-"), sentence, count=replacements
    )
    text = text.replace("--segments", "--segment")
    return text if text.startswith("--") else f"--{text}"
