"""Report on an arm: warnings, verdict, table of numbers with formulas, and checks of neglected effects."""

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape

from ..model.arm.arm import SlenderArm
from ..model.arm.neglected import Validity
from .checks import Check, checks_of
from .load_texts import LoadFormatter
from .number_rows import NumberRow, number_rows
from .planes import planes_of, with_absolute_load
from .sentences import verdict_sentences
from .validity_assessment import ValidityAssessment

BRACKETS_NOTE = "In brackets: the range over drag, which is known only up to a factor."
"""Sentence below the table of numbers, which explains the values in brackets."""
NAME_COLUMN_WIDTH = 18
"""Width of the table's first column (names of the numbers), in characters."""
LINE_WIDTH = 80
"""Width of a wrapped line, in characters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmReport:
    """Report on an arm: text for a terminal by `styled_paragraphs` and `str`, HTML in a notebook."""

    validity: Validity
    """Whether the model applies to the arm, at the flutter threshold and under the load."""
    warnings: tuple[Check, ...]
    """Checks that make the verdict doubtful; the report shows these checks above the verdict."""
    verdict: tuple[str, ...]
    """Sentences of the verdict; the first is the headline."""
    rows: tuple[NumberRow, ...]
    """Rows of the table of numbers."""
    checks: tuple[Check, ...]
    """Checks of neglected effects that are not among `warnings`."""

    def __str__(self) -> str:
        return "\n".join(line for line, _ in self.styled_paragraphs())

    __repr__ = __str__

    def styled_paragraphs(self) -> Iterator[tuple[str, str]]:
        """Yields (text, style) of paragraphs, wrapped at 80 columns; style: "warning", "headline" or ""."""
        for check in self.warnings:
            yield _wrapped(check.text), "warning"
        for number, sentence in enumerate(self.verdict):
            yield _wrapped(sentence), "" if number else "headline"
        yield "", ""
        for name, value, formula, source in self.rows:
            indent = " " * NAME_COLUMN_WIDTH
            yield f"{name:{NAME_COLUMN_WIDTH}}{value}", ""
            yield _wrapped(f"{formula}; {source}", indent, indent + "  "), ""
        yield BRACKETS_NOTE, ""
        yield "", ""
        for check in self.checks:
            yield _wrapped(check.text), "" if check.is_negligible else "warning"

    def _repr_html_(self) -> str:
        warnings = "".join(f"<p>{escape(check.text)}</p>" for check in self.warnings)
        headline, *others = map(escape, self.verdict)
        verdict = f"<p><b>{headline}</b> {' '.join(others)}</p>"
        header_row = "".join(f"<th>{name}</th>" for name in ("quantity", "value", "formula", "source"))
        rows = "".join(f"<tr>{_html_cells(row)}</tr>" for row in self.rows)
        table = f"<table><tr>{header_row}</tr>{rows}</table>"
        checks = "".join(f"<li>{escape(check.text)}</li>" for check in self.checks)
        return f"{warnings}{verdict}{table}<p>{BRACKETS_NOTE}</p><ul>{checks}</ul>"


def _html_cells(row: NumberRow) -> str:
    """The cells of a row of the table, as HTML."""
    return "".join(f"<td>{escape(cell)}</td>" for cell in row)


def arm_report(arm: SlenderArm) -> ArmReport:
    """Solves for the thresholds of an arm and returns the report. Raises InputError if the load is given
    relative to the flutter load and the arm does not flutter."""
    planes = with_absolute_load(planes_of(arm))
    first_plane = planes.first_to_flutter
    assessment = ValidityAssessment(first_plane.arm, first_plane.thresholds)
    checks = checks_of(assessment)
    # If the model does not apply at all, the verdict says so itself, and a doubt adds nothing.
    is_applicable = assessment.validity_at_flutter_and_load < Validity.does_not_apply
    doubtful_checks = tuple(
        check
        for check in checks
        if is_applicable and check.can_change_verdict and check.validity == Validity.doubtful
    )
    headline, *others = verdict_sentences(planes, assessment)
    if arm.load_over_flutter is not None:
        load = str(getattr(arm, str(arm.load_name))).strip()
        # The reader typed a multiple of flutter, so the absolute load has to be stated once.
        others.insert(0, f"{LoadFormatter(first_plane.arm).typed_text} is {load} with the likeliest drag.")
    return ArmReport(
        validity=assessment.validity_at_flutter_and_load,
        warnings=doubtful_checks,
        verdict=(headline, *others),
        rows=tuple(number_rows(first_plane)),
        checks=tuple(check for check in checks if check not in doubtful_checks),
    )


def _wrapped(text: str, first_indent: str = "", other_indent: str = "  ") -> str:
    """`text` wrapped to LINE_WIDTH. first_indent, other_indent: indents of the first and of all other
    lines."""
    return textwrap.fill(text, LINE_WIDTH, initial_indent=first_indent, subsequent_indent=other_indent)
