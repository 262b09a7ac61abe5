"""Curves of a phase diagram in `rodsweep show`: folds, ends, and generalised Hopf points. line_parameter:
parameter that varies along a row. row_parameter: parameter that is constant on a row."""

import numpy as np

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.phase_diagram import BAUTIN_ENDS, CURVE_ENDS, CYCLE_CURVE_ENDS
from ...wording import counted, is_or_are
from .criticality import CRITICALITY_WORDS
from .curve_extrema import fold_curve_extremum_lines
from .detached_branches import detached_branch_lines, rows_missing_curve_point_lines
from .number_texts import error_text, number_with_error, span_text

CYCLE_CHANGE_WORDS = {
    "fold": "folds of cycles",
    "torus": "torus points of cycles",
    "symmetry_breaking": "symmetry breakings of cycles",
    "left_the_model": "cycles that crush a section of the rod",
}
"""Phrase for the special points of cycles on rows and on curves, by kind."""
CURVE_END_WORDS = {
    "none": "not an end",
    "edge": "edge of the diagram",
    "crushed": "a force that almost crushes the rod",
    "hopf": "Hopf point, where the cycles vanish",
    "left_the_model": "cycles that crush a section of the rod",
    "resonance": "the two multipliers become real",
    "closed": "closed curve",
    "not_followed": "no further point found",
}
"""Phrase for the reason for which a curve of folds or torus points of cycles ends."""
BAUTIN_END_WORDS = {
    "none": "not an end",
    "range_end": "the end of the range",
    "plane_edge": "the edge of the diagram",
    "not_found": "a point beyond which no further point was found",
    "list_full": "the maximum number of points",
    "closed": "its first point",
}
"""Phrase for the reason for which a curve of generalised Hopf points ends."""
END_SUFFIXES = ("start", "end")
"""Suffixes of the variables with the reasons for which a curve ends, at its first and at its last point."""


def diagram_curve_lines(view: ResultView, line_parameter: str, row_parameter: str) -> list[str]:
    """Lines about folds, generalised Hopf points and their curves, and curves of folds and torus points of
    cycles."""
    variables = view.variables
    lines = curve_fold_lines(view, line_parameter, row_parameter)
    if "curve_criticality" in variables:
        lines += bautin_lines(view, line_parameter, row_parameter)
    if "bautin_along_curve" in variables:
        lines += bautin_curve_lines(view)
    if "cycle_curve_number" in variables:
        lines += cycle_curve_lines(view, line_parameter, row_parameter)
    return lines


def cycle_curve_lines(view: ResultView, line_parameter: str, row_parameter: str) -> list[str]:
    """Lines about the curves of folds and torus points of cycles, with the reasons for their ends."""
    variables = view.variables
    lines = []
    for number in np.unique(variables["cycle_curve_number"]):
        indices = np.flatnonzero(variables["cycle_curve_number"] == number)
        noun = CYCLE_CHANGE_WORDS[SPECIAL_KINDS[int(variables["cycle_curve_kind"][indices[0]])]]
        line_values = variables[f"cycle_curve_{line_parameter}"]
        ends_text = " to ".join(
            f"{row_parameter} = {variables[f'cycle_curve_{row_parameter}'][i]:.9g}, {line_parameter} = "
            f"{number_with_error(line_values[i], variables['cycle_curve_error'][i])} "
            f"({CURVE_END_WORDS[tuple(CYCLE_CURVE_ENDS)[int(variables[f'cycle_curve_{suffix}'][i])]]})"
            for suffix, i in zip(END_SUFFIXES, indices[[0, -1]], strict=True)
        )
        error_of_curve = error_text(float(variables["cycle_curve_error"][indices].max()))
        points_text = counted(len(indices), "point")
        lines.append(
            f"curve of {noun}: from {ends_text}; {points_text}, largest error of {line_parameter} "
            f"{error_of_curve}"
        )
        lines += rows_missing_curve_point_lines(view, line_parameter, row_parameter, indices)
    return (
        lines
        + fold_curve_extremum_lines(view, line_parameter, row_parameter)
        + detached_branch_lines(view, row_parameter)
    )


def curve_count_lines(view: ResultView, line_parameter: str) -> list[str]:
    """Sentences on the numbers of curves by kind, their largest distance from the points located on rows,
    along the parameter `line_parameter` and as a fraction of its range, and the number of points on no
    curve."""
    variables = view.variables
    hopf_count = len(np.unique(variables["curve_number"][variables["curve_kind"] == 1]))
    double_count = len(np.unique(variables["curve_number"])) - hopf_count
    distance_text = error_text(float(variables["curve_agreement"]))
    agreement_text = (
        f"the crossings located on rows lie within {distance_text} of the range of {line_parameter} from the "
        "curves; "
    )
    agreement_text *= hopf_count + double_count > 0
    lines = []
    if hopf_count or double_count or variables["curves_untraced"]:
        lines.append(
            f"curves: {hopf_count} of Hopf points, {double_count} of double eigenvalues; {agreement_text}"
            f"{_on_no_curve_clause(int(variables['curves_untraced']), 'crossing')}"
        )
    if "cycle_curve_number" in variables and (
        len(variables["cycle_curve_number"]) or variables["cycle_curves_untraced"]
    ):
        curve_count = len(np.unique(variables["cycle_curve_number"]))
        distance_text = error_text(float(variables["cycle_curve_agreement"]))
        agreement_text = (
            f"the points located on rows lie within {distance_text} of the range of {line_parameter} from "
            "the curves; "
        )
        agreement_text *= curve_count > 0
        untraced_clause = _on_no_curve_clause(int(variables["cycle_curves_untraced"]), "fold or torus point")
        lines.append(
            f"curves of folds and torus points of cycles: {curve_count}; {agreement_text}{untraced_clause}"
        )
    return lines


def incomplete_curve_lines(view: ResultView, line_parameter: str, row_parameter: str) -> list[str]:
    """Lines about incomplete boundary curves: curves that could not be followed further, or for which the
    list was full."""
    variables = view.variables
    lines = []
    for end in ("not_followed", "list_full"):
        reason = list(CURVE_ENDS).index(end)
        for i in np.flatnonzero((variables["curve_start"] == reason) | (variables["curve_end"] == reason)):
            noun = "Hopf points" if variables["curve_kind"][i] else "double eigenvalues"
            position_text = ", ".join(
                f"{name} = {variables[f'curve_{name}'][i]:.6g}" for name in (row_parameter, line_parameter)
            )
            curve_text = f"curve {int(variables['curve_number'][i])}, of {noun}"
            lines.append(f"{curve_text}, is incomplete: it stops at {position_text}: {CURVE_ENDS[end]}")
    return lines


def _on_no_curve_clause(point_count: int, noun: str) -> str:
    """Clause on the number `point_count` of points located on rows that lie on no curve."""
    none_text = f"every {noun} is on a curve"
    return f"{counted(point_count, noun)} {is_or_are(point_count)} on no curve" if point_count else none_text


def curve_fold_lines(view: ResultView, line_parameter: str, row_parameter: str) -> list[str]:
    """Lines about folds of curves, and about the fold in the partial beam limit of the paper's Sec. VIII."""
    variables = view.variables
    lines = []
    for i, (kind, name) in enumerate(zip(variables["fold_kind"], variables["fold_of"], strict=True)):
        noun = "Hopf points" if kind else "double eigenvalues"
        position_text = _position_text(view, "fold", i, (row_parameter, line_parameter))
        lines.append(
            f"fold of the curve of {noun}, where {(line_parameter, row_parameter)[int(name)]} is extremal: "
            f"{position_text}"
        )
    if "partial_beam_k1" in variables:
        lines.append(
            "partial beam limit: the Hopf curve folds at k1 = 4 Fc = "
            f"{float(variables['partial_beam_k1']):.13g}, "
            f"F = 2 Fc = {float(variables['partial_beam_F']):.13g}"
        )
    return lines


def _position_text(view: ResultView, prefix: str, i: int, names: tuple[str, str]) -> str:
    """Position of the i-th fold or generalised Hopf point as text, with errors. prefix: prefix of the
    variables, "fold" or "bautin"."""
    variables = view.variables
    return ", ".join(
        f"{name} = "
        f"{number_with_error(variables[f'{prefix}_{name}'][i], variables[f'{prefix}_{name}_error'][i])}"
        for name in names
    )


def criticality_lines(view: ResultView) -> list[str]:
    """List with a line on gamma1 and on the numbers of points of the Hopf curves by criticality, including
    undecided and unknown."""
    variables = view.variables
    criticality = variables["curve_criticality"][variables["curve_kind"] == 1]
    masks_by_word = {word: np.sign(criticality) == sign for sign, word in CRITICALITY_WORDS.items()}
    masks_by_word["without a normal form"] = np.isnan(criticality)
    counts = [f"{int(mask.sum())} {word}" for word, mask in masks_by_word.items() if mask.any()]
    curves_text = f"of {counted(len(criticality), 'point')} of the Hopf curves {', '.join(counts) or 'none'}"
    return [f"criticality, gamma1 = {float(variables['curve_gamma1']):g}: {curves_text}"]


def bautin_lines(view: ResultView, line_parameter: str, row_parameter: str) -> list[str]:
    """Lines about generalised Hopf points, and on the number of changes of criticality that were not
    located."""
    variables = view.variables
    lines = [
        f"generalised Hopf point (Re c = 0) on curve {int(variables['bautin_curve'][i])}: "
        + _position_text(view, "bautin", i, (row_parameter, line_parameter))
        for i in range(len(variables["bautin_curve"]))
    ]
    if unlocated := int(variables["bautin_unlocated"]):
        lines.append(f"{counted(unlocated, 'change')} of criticality along Hopf curves could not be located")
    return lines


def bautin_curve_lines(view: ResultView) -> list[str]:
    """Lines about curves of generalised Hopf points along a third parameter, with the reasons for their
    ends."""
    variables = view.variables
    lines = []
    names = [name for name in NON_OPTIONAL_LINEAR_PARAMETERS if f"bautin_along_{name}" in variables]
    for number in np.unique(variables["bautin_along_curve"]):
        mask = variables["bautin_along_curve"] == number
        span = ", ".join(f"{name} = {span_text(variables[f'bautin_along_{name}'][mask])}" for name in names)
        start, end = (
            BAUTIN_END_WORDS[BAUTIN_ENDS[int(variables[f"bautin_along_{suffix}"][mask].max())]]
            for suffix in END_SUFFIXES
        )
        lines.append(
            f"curve {int(number)} of generalised Hopf points: {counted(int(mask.sum()), 'point')}, {span}; "
            + (f"both ends lie at {start}" if start == end else f"it begins at {start} and ends at {end}")
        )
    return lines
