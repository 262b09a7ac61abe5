"""Modes of the straight rod in `rodsweep show`: stability, non-normality, and accuracy."""

import numpy as np

from ...results.file.view import View
from ...wording import count_of_total, counted
from .errors import absolute_errors, known_range_text
from .number_texts import NONE_TEXT, span_text
from .spectrum import (
    eigenvalue_table,
    error_lines,
    leading_lines,
    stability_line,
    stable_line,
    threshold_lines,
    unknowns_lines,
    unstable_count_line,
)
from .summary_lines import SummaryLines


def modes_summary(view: View, done: np.ndarray) -> SummaryLines:
    """Summary of modes. done: mask of the computed points, of the shape of the points."""
    unknowns = unknowns_lines(view, done)
    if done.size == 1:
        answer = [unstable_count_line(view)]
        reliability = []
        details = unknowns
        arm_sentences = list[str]()
    else:
        lines, how, arm_sentences = threshold_lines(view)
        answer = [stable_line(view, done), *lines]
        reliability = [*error_lines(view, done), stability_line(view, done), *how]
        details = [*leading_lines(view, done), *unknowns]
    errors = view.variables["mode_error"][done]
    if np.isfinite(errors).any():
        unknown = int((~np.isfinite(errors)).any(axis=-1).sum())
        where = f"; not known at {count_of_total(unknown, len(errors), 'point')}" if unknown else ""
        reliability.append(f"error of the modes, relative: worst {np.nanmax(errors):.1e}{where}")
    numbers = eigenvalue_table(view) if done.size == 1 else None
    return SummaryLines([*answer, *growth_lines(view, done)], reliability, details, arm_sentences, numbers)


def growth_lines(view: View, done: np.ndarray) -> list[str]:
    """Lines about the condition of the leading eigenvalue, the numerical abscissa and the transient growth;
    fewer if no growth is stored. done: mask of the computed points, of the shape of the points.
    """
    v = view.variables
    condition = v["condition"][done][:, 0]
    error = absolute_errors(v, "condition")[done][:, 0]
    lines = [f"condition number of the leading eigenvalue: {span_text(condition, error)}"]
    if "transient_growth" not in v:
        return lines
    growth = v["transient_growth"][done]
    lines.append(f"numerical abscissa: {known_range_text(v, 'numerical_abscissa', done)} 1/tau2")
    if np.isfinite(growth).any():
        finite = done & np.isfinite(v["transient_growth"])
        most, when = (known_range_text(v, f"transient_{name}", finite) for name in ("growth", "time"))
        at = "" if when == NONE_TEXT else f", at t = {when} tau2"
        lines.append(f"largest transient growth: {most} times{at}")
    if np.isinf(growth).any():
        points = counted(int(np.isinf(growth).sum()), "point")
        lines.append(f"growth without bound at {points}: a mode is unstable")
    return lines
