"""Modes of the straight rod in `rodsweep show`: stability, non-normality, and accuracy."""

from dataclasses import replace

import numpy as np

from ...results.file.view import ResultView
from ...wording import count_of_total, counted
from .errors import absolute_errors, known_range_text
from .number_texts import NONE_TEXT, span_text
from .spectrum import spectrum_summary
from .summary_lines import SummaryLines


def modes_summary(view: ResultView, computed: np.ndarray) -> SummaryLines:
    """Summary of modes. computed: mask of the computed points, of the shape of the points."""
    summary = spectrum_summary(view, computed)
    reliability = [*summary.reliability]
    errors = view.variables["mode_error"][computed]
    if np.isfinite(errors).any():
        text = f"error of the modes, relative: worst {np.nanmax(errors):.1e}"
        if unknown_count := int((~np.isfinite(errors)).any(axis=-1).sum()):
            text += f"; not known at {count_of_total(unknown_count, len(errors), 'point')}"
        reliability.append(text)
    answer = [*summary.answer, *transient_growth_lines(view, computed)]
    return replace(summary, answer=answer, reliability=reliability)


def transient_growth_lines(view: ResultView, computed: np.ndarray) -> list[str]:
    """Lines about the condition of the leading eigenvalue, the numerical abscissa and the transient growth;
    fewer if no growth is stored. computed: mask of the computed points, of the shape of the points."""
    variables = view.variables
    condition = variables["condition"][computed][:, 0]
    condition_errors = absolute_errors(variables, "condition")[computed][:, 0]
    lines = [f"condition number of the leading eigenvalue: {span_text(condition, condition_errors)}"]
    if "transient_growth" not in variables:
        return lines
    growth = variables["transient_growth"][computed]
    lines.append(f"numerical abscissa: {known_range_text(variables, 'numerical_abscissa', computed)} 1/tau2")
    if np.isfinite(growth).any():
        finite = computed & np.isfinite(variables["transient_growth"])
        names = ("transient_growth", "transient_time")
        growth_text, time_text = (known_range_text(variables, name, finite) for name in names)
        time_clause = "" if time_text == NONE_TEXT else f", at t = {time_text} tau2"
        lines.append(f"largest transient growth: {growth_text} times{time_clause}")
    if np.isinf(growth).any():
        points_text = counted(int(np.isinf(growth).sum()), "point")
        lines.append(f"growth without bound at {points_text}: a mode is unstable")
    return lines
