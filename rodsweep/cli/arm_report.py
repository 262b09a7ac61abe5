"""The command `arm`: prints the numbers and the verdict of an arm in SI units."""

import re
from typing import Any

from rich.console import Console

from ..errors import InputError
from ..model.arm.quantities import UNITS

STYLES = {"headline": "bold", "warning": "yellow"}
"""Styles of the printed lines by their kind."""


def describe_arm(given: dict[str, str | None], poisson: float, segments: tuple[str, ...]) -> None:
    """Prints the report on an arm of these quantities and law; InputError names the option."""
    from ..model.arm.arm import SlenderArm
    from ..verdict.arm import arm_report

    quantities: dict[str, Any] = {name: text for name, text in given.items() if text is not None}
    try:
        report = arm_report(SlenderArm(**quantities, poisson=poisson, segments=segments or None))
    except InputError as error:
        raise InputError(as_options(str(error))) from None
    console = Console(highlight=False, soft_wrap=True)
    for line, kind in report.lines():
        console.print(line, markup=False, style=STYLES.get(kind, ""))


NAMES = "|".join((*UNITS, "segments"))
QUANTITY_IN_SENTENCE = re.compile(rf"^({NAMES})|(?<= and )({NAMES})(?= = | are )")
"""A quantity at the beginning of a sentence, or the second of two that are given."""


def as_options(sentence: str) -> str:
    """A sentence in which names of quantities are replaced by names of options."""
    named = QUANTITY_IN_SENTENCE.sub(lambda match: "--" + match[0].replace("_", "-"), sentence)
    named = named.replace("--segments", "--segment")
    return named if named.startswith("--") else f"--{named}"
