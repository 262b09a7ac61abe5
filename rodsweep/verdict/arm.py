"""An arm and its verdict: what a Python session and the command line ask of it."""

import textwrap
from dataclasses import dataclass
from functools import cached_property

from ..config.arguments import in_sentences
from ..model.arm import SlenderArm
from .checks import Check, checks_of
from .flutter import FlutterRange, flutter_range
from .sentences import verdict_sentences
from .table import NumberRow, number_rows

WIDTH = 80
"""Columns of a line of a report."""
OVER_DRAG = "In brackets: the range over drag, which is known by factors only."
NUMBERS_BEGIN = 18
"""Column of the numbers, behind their names."""


EXAMPLE = 'rs.Arm(length="10 cm", radius="5 mm", young="100 kPa", viscosity="1.4 Pa s", pressure="2 kPa")'


@dataclass(frozen=True, slots=True)
class ArmReport:
    """All that is said of an arm; as text, the same without colours."""

    rows: tuple[NumberRow, ...]
    verdict: tuple[str, ...]
    checks: tuple[Check, ...]

    def __str__(self) -> str:
        """Verdict, numbers and checks, in lines of at most 80 columns."""
        checks = [folded(check.told) for check in self.checks]
        return "\n".join([*map(folded, self.verdict), "", *self.table(), OVER_DRAG, "", *checks])

    def table(self) -> list[str]:
        """Every number in a line, and below it its formula and its source."""
        lines, place = [], " " * NUMBERS_BEGIN
        for name, value, formula, source in self.rows:
            lines += [f"{name:{NUMBERS_BEGIN}}{value}", folded(f"{formula}; {source}", place, place + "  ")]
        return lines


def folded(text: str, first: str = "", further: str = "  ") -> str:
    """A text in lines of at most 80 columns, with what they begin with."""
    return textwrap.fill(text, WIDTH, initial_indent=first, subsequent_indent=further)


@dataclass(frozen=True, kw_only=True, init=False)
class Arm(SlenderArm):
    """An arm that tells when it flutters. Asking for that starts PETSc; the rest does not.

    Quantities are text with a unit, pint's, or numbers in SI. Raises InputError for what is no slender arm.
    """

    __init__ = in_sentences(EXAMPLE)(SlenderArm.__init__)

    @cached_property
    def flutter(self) -> FlutterRange:
        """Where it flutters and how fast, over the range of its drag."""
        return flutter_range(self)

    def report(self) -> ArmReport:
        """Numbers with formulas and sources, verdict, and what the model leaves out."""
        found = self.flutter
        return ArmReport(
            tuple(number_rows(self)), tuple(verdict_sentences(self, found)), tuple(checks_of(self, found))
        )
