"""Curves of a phase diagram in `rodsweep show`: folds, ends, and generalised Hopf points."""

from collections.abc import Mapping

import numpy as np

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from ...results.file.view import ResultView
from ...results.layouts.bautin_points import BAUTIN_CURVE_END_REASONS
from ...results.layouts.phase_diagram import BOUNDARY_CURVE_END_REASONS
from ...wording import counted, is_or_are
from ..plane_curves import PlaneParameters
from .criticality import CRITICALITY_WORDS
from .cycle_curves import cycle_curve_lines, plane_position_text
from .number_texts import error_text, value_range_text

BOUNDARY_CURVE_NOUNS = ("double eigenvalues", "Hopf points")
"""Noun for the points of a boundary curve, by stored number of the kind of the curve."""
BAUTIN_END_WORDS = {
    "none": "not an end",
    "range_end": "the end of the range",
    "plane_edge": "the edge of the diagram",
    "not_found": "a point beyond which no further point was found",
    "list_full": "the maximum number of points",
    "closed": "its first point",
}
"""Phrase for the reason why a curve of generalised Hopf points ends, by stored word."""
INCOMPLETE_CURVE_ENDS = ("not_followed", "list_full")
"""Reasons for which a boundary curve is incomplete."""


def diagram_curve_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about folds, generalised Hopf points and their curves, and curves of folds and torus points of
    cycles."""
    variables = view.variables
    lines = _curve_fold_lines(view, parameters)
    if "curve_criticality" in variables:
        lines += _bautin_lines(view, parameters)
    if "bautin_along_curve" in variables:
        lines += _bautin_curve_lines(variables)
    if "cycle_curve_number" in variables:
        lines += cycle_curve_lines(view, parameters)
    return lines


def curve_count_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Sentences on the numbers of curves by kind, on the number of points on no curve, and on the largest
    distance of the points located on rows from the curves. The distance is measured along the row and printed
    as a fraction of the row's range."""
    variables = view.variables
    numbers = variables["curve_number"]
    hopf_count = len(np.unique(numbers[variables["curve_kind"] == 1]))
    curve_count = len(np.unique(numbers))
    subjects = {
        "curve": f"curves: {hopf_count} of Hopf points, {curve_count - hopf_count} of double eigenvalues",
        "cycle_curve": "curves of folds and torus points of cycles: {}",
    }
    nouns = {"curve": ("crossings", "crossing"), "cycle_curve": ("points", "fold or torus point")}
    lines = []
    for prefix, subject in subjects.items():
        if f"{prefix}_number" not in variables:
            continue
        count = len(np.unique(variables[f"{prefix}_number"]))
        on_no_curve = int(variables[f"{prefix}s_untraced"])
        plural_noun, noun = nouns[prefix]
        clauses = [subject.format(count)]
        if count:
            distance_text = error_text(float(variables[f"{prefix}_agreement"]))
            range_text = f"{distance_text} of the range of {parameters.line_parameter}"
            clauses.append(f"the {plural_noun} located on rows lie within {range_text} from the curves")
        if on_no_curve:
            clauses.append(f"{counted(on_no_curve, noun)} {is_or_are(on_no_curve)} on no curve")
        else:
            clauses.append(f"every {noun} is on a curve")
        lines += ["; ".join(clauses)] if count or on_no_curve else []
    return lines


def incomplete_curve_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about incomplete boundary curves: curves that could not be followed further, or for which the
    list was full."""
    variables = view.variables
    lines = []
    for end in INCOMPLETE_CURVE_ENDS:
        reason = list(BOUNDARY_CURVE_END_REASONS).index(end)
        for i in np.flatnonzero((variables["curve_start"] == reason) | (variables["curve_end"] == reason)):
            place = ", ".join(f"{name} = {variables[f'curve_{name}'][i]:.6g}" for name in parameters[::-1])
            number, noun = variables["curve_number"][i], BOUNDARY_CURVE_NOUNS[variables["curve_kind"][i]]
            lines.append(
                f"curve {int(number)}, of {noun}, is incomplete: it stops at {place}: "
                f"{BOUNDARY_CURVE_END_REASONS[end]}"
            )
    return lines


def _curve_fold_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about folds of the boundary curves, where one parameter is extremal along the curve. Also, if
    stored, a line about the fold of the Hopf curve in the partial beam limit (k2 = inf, gamma3 = 0) of the
    paper's Sec. VIII."""
    variables = view.variables
    lines = []
    for i, (kind, name) in enumerate(zip(variables["fold_kind"], variables["fold_of"], strict=True)):
        subject = (
            f"fold of the curve of {BOUNDARY_CURVE_NOUNS[kind]}, where {parameters[int(name)]} is extremal"
        )
        lines.append(f"{subject}: {plane_position_text(view, 'fold', i, parameters)}")
    if "partial_beam_k1" in variables:
        k1, F = (float(variables[f"partial_beam_{name}"]) for name in ("k1", "F"))
        lines.append(
            f"partial beam limit: the Hopf curve folds at k1 = 4 Fc = {k1:.13g}, F = 2 Fc = {F:.13g}"
        )
    return lines


def criticality_lines(view: ResultView) -> list[str]:
    """List with a line on gamma1 and on the numbers of points of the Hopf curves by criticality, including
    undecided and unknown."""
    variables = view.variables
    criticality = variables["curve_criticality"][variables["curve_kind"] == 1]
    masks = {word: np.sign(criticality) == sign for sign, word in CRITICALITY_WORDS.items()}
    masks["without a normal form"] = np.isnan(criticality)
    counts = ", ".join(f"{int(mask.sum())} {word}" for word, mask in masks.items() if mask.any()) or "none"
    points_text = f"of {counted(len(criticality), 'point')} of the Hopf curves {counts}"
    return [f"criticality, gamma1 = {float(variables['curve_gamma1']):g}: {points_text}"]


def _bautin_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about generalised Hopf points, and on the number of changes of criticality that were not
    located."""
    lines = [
        f"generalised Hopf point (Re c = 0) on curve {int(curve)}: "
        f"{plane_position_text(view, 'bautin', i, parameters)}"
        for i, curve in enumerate(view.variables["bautin_curve"])
    ]
    if unlocated := int(view.variables["bautin_unlocated"]):
        lines.append(f"{counted(unlocated, 'change')} of criticality along Hopf curves could not be located")
    return lines


def _bautin_curve_lines(variables: Mapping[str, np.ndarray]) -> list[str]:
    """Lines about curves of generalised Hopf points along a third parameter, with the reasons for their
    ends."""
    numbers = variables["bautin_along_curve"]
    names = [name for name in NON_OPTIONAL_LINEAR_PARAMETER_NAMES if f"bautin_along_{name}" in variables]
    lines = []
    for number in np.unique(numbers):
        mask = numbers == number
        spans = ", ".join(
            f"{name} = {value_range_text(variables[f'bautin_along_{name}'][mask])}" for name in names
        )
        start, end = (
            BAUTIN_END_WORDS[BAUTIN_CURVE_END_REASONS[int(variables[f"bautin_along_{side}"][mask].max())]]
            for side in ("start", "end")
        )
        ends_text = f"both ends lie at {start}" if start == end else f"it begins at {start} and ends at {end}"
        points_text = counted(int(mask.sum()), "point")
        lines.append(f"curve {int(number)} of generalised Hopf points: {points_text}, {spans}; {ends_text}")
    return lines
