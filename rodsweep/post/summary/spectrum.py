"""Spectra of the straight rod in `rodsweep show`: stability, accuracy, and cost."""

import numpy as np

from ...results.file.view import ResultView
from ...results.layouts.rods import estimates_counts, has_standard_rods
from ...results.layouts.variables import ANGULAR_UNIT
from ...wording import count_of_total, counted
from ..located_thresholds import StoredThresholds
from .number_texts import number_and_error, span_text
from .stability import rod_and_arm_stability_lines
from .summary_lines import SummaryLines, TextTable, in_brackets, region_text

LOCATION_EXPLANATION = (
    "located where the leading eigenvalue changes between two forces of the file: F** by a zero of the "
    "characteristic determinant D(i eta; F), F* by a double zero of D; `task: thresholds` proves that none "
    "is missing"
)
"""Explanation of the method by which the forces in `threshold_lines` are located."""
NOT_LOCATED_NOTE = "known only to lie between two forces of the file; `task: thresholds` locates them"
"""Explanation for arms that are not uniform or not of linear material: the forces are bracketed, not
located."""
PROOF_WORDS = {True: "proved by a winding number", False: "not proved"}
"""Phrase that says whether the number of unstable modes is proved, for a file with one point."""


def spectrum_summary(view: ResultView, computed: np.ndarray) -> SummaryLines:
    """Summary of spectra. computed: mask of the computed points, of the shape of the points."""
    if computed.size == 1:
        numbers = eigenvalue_table(view)
        return SummaryLines(
            [single_point_unstable_count_line(view)], [], unknowns_lines(view, computed), numbers=numbers
        )
    lines, location_note, arm_sentences = threshold_lines(view)
    reliability = [
        *eigenvalue_error_lines(view, computed),
        max_unstable_count_and_proof_line(view, computed),
        *location_note,
    ]
    details = [*leading_eigenvalue_lines(view, computed), *unknowns_lines(view, computed)]
    return SummaryLines(
        [stable_point_count_line(view, computed), *lines], reliability, details, arm_sentences
    )


def stable_point_count_line(view: ResultView, computed: np.ndarray) -> str:
    """Line on the numbers of points at which the straight rod is stable, unstable, or of unknown stability.
    computed: mask of the computed points, of the shape of the points."""
    unstable = view.variables["unstable_count"]
    masks = {"stable": unstable == 0, "unstable": unstable > 0, "not known": unstable < 0}
    masks_by_word = {word: computed & mask for word, mask in masks.items() if (computed & mask).any()}
    points_text = counted(int(computed.sum()), "point")
    if len(masks_by_word) == 1:
        return f"straight rod: {next(iter(masks_by_word))} at all {points_text}"
    regions = {word: in_brackets(region_text(view, mask)) for word, mask in masks_by_word.items()}
    counts = (f"{word} at {int(mask.sum())}{regions[word]}" for word, mask in masks_by_word.items())
    return f"straight rod, of {points_text}: {', '.join(counts)}"


def leading_eigenvalue_lines(view: ResultView, computed: np.ndarray) -> list[str]:
    """List with a line on the leading eigenvalues; empty if none is known. computed: mask of the computed
    points, of the shape of the points."""
    variables = view.variables
    if not np.isfinite(variables["growth_rate"][computed][:, 0]).any():
        return []
    errors = variables["error_estimate"][computed][:, 0]
    rate, frequency = (
        span_text(variables[name][computed][:, 0], errors) for name in ("growth_rate", "frequency")
    )
    return [f"leading growth rate {rate} 1/tau2, frequency {frequency} rad/tau2"]


def threshold_lines(view: ResultView) -> tuple[list[str], list[str], list[str]]:
    """Returns (lines about thresholds along F, line on the method of location, lines in an arm's units);
    empty lists if F does not vary."""
    lines, arm_sentences = rod_and_arm_stability_lines(view, "F", StoredThresholds(view, "F").thresholds_on)
    location_note = LOCATION_EXPLANATION if has_standard_rods(view.config) else NOT_LOCATED_NOTE
    return lines, [f"thresholds: {location_note}"] if lines else [], arm_sentences


def eigenvalue_table(view: ResultView) -> TextTable | None:
    """Table of the eigenvalues at the only point of a file, with errors; None if no eigenvalue is stored."""
    columns = (view.variables[name].ravel() for name in ("growth_rate", "frequency", "error_estimate"))
    rows = [
        (str(number), *number_and_error(growth, error), *number_and_error(frequency, error))
        for number, (growth, frequency, error) in enumerate(zip(*columns, strict=True), 1)
        if np.isfinite(growth)
    ]
    headings = ("mode", "growth rate\n1/tau2", "+-", f"frequency\n{ANGULAR_UNIT}", "+-")
    return TextTable(headings, tuple(rows)) if rows else None


def single_point_unstable_count_line(view: ResultView) -> str:
    """Line on the number of unstable modes at the only point of a file."""
    variables = view.variables
    unstable = int(variables["unstable_count"].max())
    proof = PROOF_WORDS[bool(variables["certified"].all())]
    if variables["certified"].all() and estimates_counts(view.config):
        proof = "proved by D or counted by its winding number, with some bounds estimated"
    return f"unstable modes: {unstable}, {proof}" if unstable >= 0 else "unstable modes: not known"


def eigenvalue_error_lines(view: ResultView, computed: np.ndarray) -> list[str]:
    """List with a line on the errors of the eigenvalues; empty if no error is known. computed: mask of the
    computed points, of the shape of the points."""
    variables = view.variables
    moduli = np.hypot(variables["growth_rate"][computed], variables["frequency"][computed])
    relative = variables["error_estimate"][computed] / moduli
    if not np.isfinite(relative).any():
        return []
    worst, median = (f"{statistic(relative):.1e}" for statistic in (np.nanmax, np.nanmedian))
    return [f"relative error of the eigenvalues: at most {worst}, median {median}"]


def unknowns_lines(view: ResultView, computed: np.ndarray) -> list[str]:
    """List with a line on the number of unknowns per point, and on the number of points without a mesh.
    computed: mask of the computed points, of the shape of the points."""
    variables = view.variables
    unknowns = 3 * variables["elements"][computed].astype(int) * variables["order"][computed]
    if (followed := int((unknowns == 0).sum())) == unknowns.size:
        return ["no mesh was needed: eigenvalues were continued from a neighbouring point, or not found"]
    text = f"unknowns of the mesh per point: {span_text(unknowns[unknowns > 0])}"
    if followed:
        text += f"; none at {counted(followed, 'point')}, continued from a neighbouring point or failed"
    return [text]


def max_unstable_count_and_proof_line(view: ResultView, computed: np.ndarray) -> str:
    """Line with three numbers: the largest number of unstable modes at a point; the number of points at which
    the number of unstable modes is proved or, for rods that vary along their length, confirmed by an
    estimate; the number of points at which it is unknown. computed: mask of the computed points, of the shape
    of the points."""
    unstable = view.variables["unstable_count"][computed]
    point_count = int(computed.sum())
    if (unstable < 0).all():
        return "number of unstable modes: not known at any point"
    certified = int(view.variables["certified"][computed].sum())
    certainty_text = "confirmed by an estimate" if estimates_counts(view.config) else "proved"
    text = f"largest number of unstable modes: {int(unstable.max())}; the number is {certainty_text} at "
    text += count_of_total(certified, point_count, "point")
    unknown_count = int((unstable < 0).sum())
    return text + (f", not known at {unknown_count}" if unknown_count else "")
