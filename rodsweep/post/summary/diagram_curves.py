"""Curves of a phase diagram in `rodsweep show`: folds, ends, and generalised Hopf points."""

import numpy as np

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETERS
from ...results.file.view import ResultView
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.fold_curve_extrema import EXTREMA_UNLOCATED
from ...results.layouts.phase_diagram import BAUTIN_ENDS, CURVE_ENDS, CYCLE_CURVE_ENDS
from ...wording import counted, is_or_are
from ..plane_curves import PlaneParameters
from .criticality import CRITICALITY_WORDS
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


def diagram_curve_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about folds, generalised Hopf points and their curves, and curves of folds and torus points of
    cycles."""
    variables = view.variables
    lines = curve_fold_lines(view, parameters)
    if "curve_criticality" in variables:
        lines += bautin_lines(view, parameters)
    if "bautin_along_curve" in variables:
        lines += bautin_curve_lines(view)
    if "cycle_curve_number" in variables:
        lines += cycle_curve_lines(view, parameters)
    return lines


def cycle_curve_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about the curves of folds and torus points of cycles, with the reasons for their ends."""
    variables = view.variables
    line, row = parameters
    lines = []
    for number in np.unique(variables["cycle_curve_number"]):
        indices = np.flatnonzero(variables["cycle_curve_number"] == number)
        noun = CYCLE_CHANGE_WORDS[SPECIAL_KINDS[int(variables["cycle_curve_kind"][indices[0]])]]
        line_values, row_values = (variables[f"cycle_curve_{name}"] for name in parameters)
        ends_text = " to ".join(
            f"{row} = {row_values[i]:.9g}, {line} = "
            f"{number_with_error(line_values[i], variables['cycle_curve_error'][i])} "
            f"({CURVE_END_WORDS[tuple(CYCLE_CURVE_ENDS)[int(variables[f'cycle_curve_{suffix}'][i])]]})"
            for suffix, i in zip(END_SUFFIXES, indices[[0, -1]], strict=True)
        )
        error_of_curve = error_text(float(variables["cycle_curve_error"][indices].max()))
        points_text = counted(len(indices), "point")
        lines.append(
            f"curve of {noun}: from {ends_text}; {points_text}, largest error of {line} {error_of_curve}"
        )
        lines += rows_missing_curve_point_lines(view, parameters, indices)
    lines += fold_curve_extremum_lines(view, parameters)
    return lines + detached_branch_lines(view, parameters)


def fold_curve_extremum_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about the points of curves of folds of cycles at which the row parameter is extremal."""
    variables = view.variables
    lines = []
    if EXTREMA_UNLOCATED.name in variables:
        lines.append(
            f"extrema of {parameters.row} along curves of folds of cycles that could not be located: "
            f"{int(variables[EXTREMA_UNLOCATED.name])}; closed branches of cycles may be missing on rows "
            "beside them"
        )
    if "cycle_extremum_curve" not in variables:
        return lines
    for i in range(len(variables["cycle_extremum_curve"])):
        place_text = _position_text(view, "cycle_extremum", i, parameters)
        lines.append(
            f"extremum of {parameters.row} along curve {variables['cycle_extremum_curve'][i]} of folds of "
            f"cycles: {place_text}; a closed branch of cycles shrinks to one cycle there, or two branches "
            "exchange their parts"
        )
    return lines


def curve_count_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Sentences on the numbers of curves by kind, their largest distance from the points located on rows,
    along the rows and as a fraction of its range, and the number of points on no
    curve."""
    variables = view.variables
    hopf_count = len(np.unique(variables["curve_number"][variables["curve_kind"] == 1]))
    double_count = len(np.unique(variables["curve_number"])) - hopf_count
    lines = []
    if hopf_count or double_count or variables["curves_untraced"]:
        agreement_text = _agreement_clause("crossings", variables["curve_agreement"], parameters.line)
        agreement_text *= hopf_count + double_count > 0
        lines.append(
            f"curves: {hopf_count} of Hopf points, {double_count} of double eigenvalues; {agreement_text}"
            f"{_on_no_curve_clause(int(variables['curves_untraced']), 'crossing')}"
        )
    if "cycle_curve_number" in variables and (
        len(variables["cycle_curve_number"]) or variables["cycle_curves_untraced"]
    ):
        curve_count = len(np.unique(variables["cycle_curve_number"]))
        agreement_text = _agreement_clause("points", variables["cycle_curve_agreement"], parameters.line)
        agreement_text *= curve_count > 0
        untraced_clause = _on_no_curve_clause(int(variables["cycle_curves_untraced"]), "fold or torus point")
        lines.append(
            f"curves of folds and torus points of cycles: {curve_count}; {agreement_text}{untraced_clause}"
        )
    return lines


def _agreement_clause(noun: str, distance: np.ndarray, line_parameter: str) -> str:
    """Clause on the largest distance of the points located on rows from the curves, as a fraction of the
    range of the parameter along the rows. noun: noun for the points."""
    range_text = f"{error_text(float(distance))} of the range of {line_parameter}"
    return f"the {noun} located on rows lie within {range_text} from the curves; "


def incomplete_curve_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about incomplete boundary curves: curves that could not be followed further, or for which the
    list was full."""
    variables = view.variables
    lines = []
    for end in ("not_followed", "list_full"):
        reason = list(CURVE_ENDS).index(end)
        for i in np.flatnonzero((variables["curve_start"] == reason) | (variables["curve_end"] == reason)):
            noun = "Hopf points" if variables["curve_kind"][i] else "double eigenvalues"
            position_text = ", ".join(
                f"{name} = {variables[f'curve_{name}'][i]:.6g}" for name in parameters[::-1]
            )
            curve_text = f"curve {int(variables['curve_number'][i])}, of {noun}"
            lines.append(f"{curve_text}, is incomplete: it stops at {position_text}: {CURVE_ENDS[end]}")
    return lines


def _on_no_curve_clause(point_count: int, noun: str) -> str:
    """Clause on the number `point_count` of points located on rows that lie on no curve."""
    none_text = f"every {noun} is on a curve"
    return f"{counted(point_count, noun)} {is_or_are(point_count)} on no curve" if point_count else none_text


def curve_fold_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about folds of curves, and about the fold in the partial beam limit of the paper's Sec. VIII."""
    variables = view.variables
    lines = []
    for i, (kind, name) in enumerate(zip(variables["fold_kind"], variables["fold_of"], strict=True)):
        noun = "Hopf points" if kind else "double eigenvalues"
        position_text = _position_text(view, "fold", i, parameters)
        lines.append(
            f"fold of the curve of {noun}, where {parameters[int(name)]} is extremal: {position_text}"
        )
    if "partial_beam_k1" in variables:
        lines.append(
            "partial beam limit: the Hopf curve folds at k1 = 4 Fc = "
            f"{float(variables['partial_beam_k1']):.13g}, "
            f"F = 2 Fc = {float(variables['partial_beam_F']):.13g}"
        )
    return lines


def _position_text(view: ResultView, prefix: str, i: int, parameters: PlaneParameters) -> str:
    """Position of the i-th fold, generalised Hopf point or extremum as text, with errors. prefix: prefix of
    the variables, "fold", "bautin" or "cycle_extremum"."""
    variables = view.variables
    return ", ".join(
        f"{name} = "
        f"{number_with_error(variables[f'{prefix}_{name}'][i], variables[f'{prefix}_{name}_error'][i])}"
        for name in parameters[::-1]
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


def bautin_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about generalised Hopf points, and on the number of changes of criticality that were not
    located."""
    variables = view.variables
    lines = [
        f"generalised Hopf point (Re c = 0) on curve {int(variables['bautin_curve'][i])}: "
        + _position_text(view, "bautin", i, parameters)
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
