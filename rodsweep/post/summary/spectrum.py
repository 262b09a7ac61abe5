"""Spectra of the straight rod in `rodsweep show`: stability, accuracy, and cost."""

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.rod_properties import has_estimated_counts, has_uniform_linear_rods
from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import count_of_total, counted
from ..located_thresholds import StoredThresholds
from .number_texts import value_range_text
from .selection import PointSelection, counts_and_ranges_text
from .stability import rod_and_arm_stability_lines
from .summary_lines import SummaryLines, TextTable, number_table

THRESHOLD_LOCATION_EXPLANATION = (
    "located where the leading eigenvalue changes between two forces of the file: F** by a zero of the "
    "characteristic determinant D(i eta; F), F* by a double zero of D; `task: thresholds` proves that none "
    "is missing"
)
"""Explanation of the method by which thresholds along F are located."""
BRACKETED_THRESHOLDS_NOTE = (
    "known only to lie between two forces of the file; `task: thresholds` locates them"
)
"""Explanation for arms that are not uniform or not of linear material: the forces are bracketed, not
located."""
UNSTABLE_COUNT_PROOF_WORDS = {True: "proved by a winding number", False: "not proved"}
"""Phrase that says whether the number of unstable modes is proved, for a file with one point."""
UNSTABLE_COUNT_CONFIRMED_WORDS = "proved by D or counted by its winding number, with some bounds estimated"
"""Phrase for a confirmed number of unstable modes of a rod that varies along its length."""


def spectrum_summary(points: PointSelection) -> SummaryLines:
    """Summary of spectra at the computed points."""
    view = points.view
    if points.mask.size == 1:
        answer = [single_point_unstable_count_line(view)]
        return SummaryLines(answer, [], [mesh_line(points)], numbers_table=eigenvalue_table(view))
    thresholds_on = StoredThresholds(view, "F").thresholds_on_line
    threshold_lines, arm_sentences = rod_and_arm_stability_lines(view, "F", thresholds_on)
    reliability = [*eigenvalue_error_lines(points), largest_unstable_count_line(points)]
    if threshold_lines:
        note = (
            THRESHOLD_LOCATION_EXPLANATION
            if has_uniform_linear_rods(view.config)
            else BRACKETED_THRESHOLDS_NOTE
        )
        reliability.append(f"thresholds: {note}")
    details = [mesh_line(points)]
    if np.isfinite(points.values("growth_rate")[:, 0]).any():
        rates = "leading growth rate {first growth_rate} 1/tau2, frequency {first frequency} rad/tau2"
        details.insert(0, points.sentence_with_ranges(rates))
    return SummaryLines(
        [stability_counts_line(points), *threshold_lines], reliability, details, arm_sentences
    )


def stability_counts_line(points: PointSelection) -> str:
    """Line on the numbers of points at which the straight rod is stable, unstable, or of unknown
    stability."""
    unstable = points.variables["unstable_count"]
    parts = points.parts_by_word(
        {"stable": unstable == 0, "unstable": unstable > 0, "not known": unstable < 0}
    )
    points_text = counted(points.count, "point")
    if len(parts) == 1:
        return f"straight rod: {next(iter(parts))} at all {points_text}"
    return f"straight rod, of {points_text}: {counts_and_ranges_text(parts)}"


def eigenvalue_table(view: ResultView) -> TextTable | None:
    """Table of the eigenvalues at the only point of a file, with errors; None if no eigenvalue is stored."""
    growth, frequency, errors = (
        view.variables[name].ravel() for name in ("growth_rate", "frequency", "error_estimate")
    )
    stored = np.flatnonzero(np.isfinite(growth))
    return number_table(
        ("mode", [str(index + 1) for index in stored], None),
        ("growth rate\n1/tau2", growth[stored], errors[stored]),
        (f"frequency\n{ANGULAR_UNIT}", frequency[stored], errors[stored]),
    )


def single_point_unstable_count_line(view: ResultView) -> str:
    """Line on the number of unstable modes at the only point of a file."""
    unstable_count = int(view.variables["unstable_count"].max())
    if unstable_count < 0:
        return "unstable modes: not known"
    proof = UNSTABLE_COUNT_PROOF_WORDS[bool(view.variables["certified"].all())]
    if view.variables["certified"].all() and has_estimated_counts(view.config):
        proof = UNSTABLE_COUNT_CONFIRMED_WORDS
    return f"unstable modes: {unstable_count}, {proof}"


def eigenvalue_error_lines(points: PointSelection) -> list[str]:
    """List with a line on the errors of the eigenvalues; empty if no error is known."""
    moduli = np.hypot(points.values("growth_rate"), points.values("frequency"))
    relative = points.values("error_estimate") / moduli
    if not np.isfinite(relative).any():
        return []
    worst, median = np.nanmax(relative), np.nanmedian(relative)
    return [f"relative error of the eigenvalues: at most {worst:.1e}, median {median:.1e}"]


def mesh_line(points: PointSelection) -> str:
    """Line on the number of unknowns per point, and on the number of points without a mesh."""
    unknowns = 3 * points.values("elements").astype(int) * points.values("order")
    meshless_count = int((unknowns == 0).sum())
    if meshless_count == unknowns.size:
        return "no mesh is stored: eigenvalues were continued from a neighbouring point, or not found"
    text = f"unknowns of the mesh per point: {value_range_text(unknowns[unknowns > 0])}"
    if meshless_count:
        text += f"; none at {counted(meshless_count, 'point')}, continued from a neighbouring point or failed"
    return text


def largest_unstable_count_line(points: PointSelection) -> str:
    """Line on the largest number of unstable modes, and on the numbers of points at which the number of
    unstable modes is proved (for rods that vary along their length: confirmed by an estimate), or unknown."""
    unstable = points.values("unstable_count")
    unknown_count = int((unstable < 0).sum())
    if unknown_count == points.count:
        return "number of unstable modes: not known at any point"
    certainty_text = "confirmed by an estimate" if has_estimated_counts(points.view.config) else "proved"
    points_text = count_of_total(points.values("certified").sum(), points.count, "point")
    unknown_text = f", not known at {unknown_count}" if unknown_count else ""
    return (
        f"largest number of unstable modes: {int(unstable.max())}; the number is {certainty_text} at "
        f"{points_text}{unknown_text}"
    )
