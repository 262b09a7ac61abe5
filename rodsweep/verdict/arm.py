"""An arm and its verdict: what a Python session and the command line ask of it."""

from dataclasses import dataclass
from functools import cached_property

from ..model.arm import SlenderArm
from .checks import Check, checks_of
from .flutter import FlutterRange, flutter_range
from .sentences import verdict_sentences
from .table import NumberRow, number_rows


@dataclass(frozen=True, slots=True)
class ArmReport:
    """All that is said of an arm; as text, the same without colours."""

    rows: tuple[NumberRow, ...]
    verdict: tuple[str, ...]
    checks: tuple[Check, ...]

    def __str__(self) -> str:
        """Verdict, numbers and checks, one a line."""
        widths = [max(len(row[i]) for row in self.rows) for i in range(4)]
        rows = ["  ".join(f"{row[i]:<{widths[i]}}" for i in range(4)).rstrip() for row in self.rows]
        checks = [("" if check.fine else "warning: ") + check.sentence for check in self.checks]
        return "\n".join([*self.verdict, "", *rows, "", *checks])


@dataclass(frozen=True, kw_only=True)
class Arm(SlenderArm):
    """An arm that tells when it flutters. Asking for that starts PETSc; the rest does not."""

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
