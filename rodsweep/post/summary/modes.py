"""Modes of the straight rod in `rodsweep show`: stability, non-normality, and accuracy."""

from dataclasses import replace

import numpy as np

from ...wording import count_of_total, counted
from .number_texts import MISSING_VALUE_TEXT
from .selection import PointSelection
from .spectrum import spectrum_summary
from .summary_lines import SummaryLines


def modes_summary(points: PointSelection) -> SummaryLines:
    """Summary of modes at the computed points."""
    summary = spectrum_summary(points)
    reliability = [*summary.reliability]
    errors = points.values("mode_error")
    if np.isfinite(errors).any():
        text = f"error of the modes, relative: worst {np.nanmax(errors):.1e}"
        if unknown_count := int((~np.isfinite(errors)).any(axis=-1).sum()):
            text += f"; not known at {count_of_total(unknown_count, points.count, 'point')}"
        reliability.append(text)
    answer = [*summary.answer, *transient_growth_lines(points)]
    return replace(summary, answer=answer, reliability=reliability)


def transient_growth_lines(points: PointSelection) -> list[str]:
    """Lines about the condition of the leading eigenvalue, the numerical abscissa and the transient growth;
    fewer if no growth is stored."""
    lines = [points.sentence_with_ranges("condition number of the leading eigenvalue: {first condition}")]
    if "transient_growth" not in points.variables:
        return lines
    lines.append(points.sentence_with_ranges("numerical abscissa: {numerical_abscissa} 1/tau2"))
    growth = points.variables["transient_growth"]
    if (bounded := points.where(np.isfinite(growth))).count:
        template = "largest transient growth: {transient_growth} times, at t = {transient_time} tau2"
        lines.append(
            bounded.sentence_with_ranges(template).removesuffix(f", at t = {MISSING_VALUE_TEXT} tau2")
        )
    if unbounded_count := points.where(np.isinf(growth)).count:
        lines.append(f"growth without bound at {counted(unbounded_count, 'point')}: a mode is unstable")
    return lines
