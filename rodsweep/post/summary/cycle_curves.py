"""Curves of folds and torus points of cycles in the plane of a phase diagram, and cycles on branches that no
Hopf point of a row leads to, in `rodsweep show`."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...results.file.view import ResultView
from ...results.layouts.branch import SPECIAL_KINDS
from ...results.layouts.detached_branches import DETACHED_ROW_VARIABLE, LOST_CURVE_ENDS_VARIABLE
from ...results.layouts.fold_curve_extrema import UNLOCATED_EXTREMA_VARIABLE
from ...results.layouts.phase_diagram import CYCLE_CURVE_END_REASONS
from ...wording import count_of_total, counted
from ..plane_curves import PlaneParameters
from .number_texts import axis_values_text, error_text, number_with_error_text

SPECIAL_POINT_WORDS_BY_KIND = {
    "fold": "folds of cycles",
    "torus": "torus points of cycles",
    "symmetry_breaking": "symmetry breakings of cycles",
    "left_the_model": "cycles that crush a section of the rod",
}
"""Phrase for the special points of cycles on rows and on curves, by kind."""
CYCLE_CURVE_END_WORDS = {
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
MAX_CURVE_DISTANCE_OVER_ROW_LENGTH = 0.01
"""Where a curve crosses a row between two points of the curve, a special point of the row belongs to the
curve if it lies between these two points, or outside their interval by at most this fraction of the row's
length."""


def plane_position_text(view: ResultView, prefix: str, i: int, parameters: PlaneParameters) -> str:
    """Position of the i-th fold, generalised Hopf point or extremum in the plane as text, with errors.
    prefix: prefix of the variables, "fold", "bautin" or "cycle_extremum"."""
    numbers = (
        (name, view.variables[f"{prefix}_{name}"][i], view.variables[f"{prefix}_{name}_error"][i])
        for name in parameters[::-1]
    )
    return ", ".join(f"{name} = {number_with_error_text(value, error)}" for name, value, error in numbers)


def cycle_curve_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about the curves of folds and torus points of cycles, with the reasons for their ends."""
    variables = view.variables
    line, row = parameters
    errors = variables["cycle_curve_error"]
    lines = []
    for number in np.unique(variables["cycle_curve_number"]):
        indices = np.flatnonzero(variables["cycle_curve_number"] == number)
        noun = SPECIAL_POINT_WORDS_BY_KIND[SPECIAL_KINDS[int(variables["cycle_curve_kind"][indices[0]])]]
        ends = []
        for i, side in ((indices[0], "start"), (indices[-1], "end")):
            reason = tuple(CYCLE_CURVE_END_REASONS)[int(variables[f"cycle_curve_{side}"][i])]
            line_text = number_with_error_text(variables[f"cycle_curve_{line}"][i], errors[i])
            row_text = f"{row} = {variables[f'cycle_curve_{row}'][i]:.9g}"
            ends.append(f"{row_text}, {line} = {line_text} ({CYCLE_CURVE_END_WORDS[reason]})")
        lines.append(
            f"curve of {noun}: from {' to '.join(ends)}; {counted(len(indices), 'point')}, largest error of "
            f"{line} {error_text(float(errors[indices].max()))}"
        )
        lines += _rows_missing_curve_point_lines(view, parameters, indices)
    return [*lines, *fold_curve_extremum_lines(view, parameters), *detached_branch_lines(view, parameters)]


def fold_curve_extremum_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about the points of curves of folds of cycles at which the row parameter (constant on a row) is
    extremal."""
    variables = view.variables
    lines = []
    if UNLOCATED_EXTREMA_VARIABLE.name in variables:
        lines.append(
            f"extrema of {parameters.row_parameter} along curves of folds of cycles that could not be "
            f"located: {int(variables[UNLOCATED_EXTREMA_VARIABLE.name])}; closed branches of cycles may be "
            "missing on rows beside them"
        )
    if "cycle_extremum_curve" not in variables:
        return lines
    for i, curve in enumerate(variables["cycle_extremum_curve"]):
        lines.append(
            f"extremum of {parameters.row_parameter} along curve {curve} of folds of cycles: "
            f"{plane_position_text(view, 'cycle_extremum', i, parameters)}; a closed branch of cycles "
            "shrinks to one cycle there, or two branches exchange their parts"
        )
    return lines


def detached_branch_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about the rows with cycles on branches to which no Hopf point of the row leads, and about curves
    of folds whose continuation failed beyond the range of the parameter along the rows."""
    variables = view.variables
    lines = []
    if DETACHED_ROW_VARIABLE in variables:
        row_indices = variables[DETACHED_ROW_VARIABLE] - 1
        rows_text = count_of_total(len(row_indices), variables["status"].size, "row")
        values_text = axis_values_text(view.point_columns[parameters.row_parameter][row_indices])
        lines.append(
            f"branches that no Hopf point of their row leads to: on {rows_text}, {parameters.row_parameter} "
            f"= {values_text}; they were followed from the crossings of curves of folds or torus points with "
            "the rows, and the stable states include their cycles"
        )
    if LOST_CURVE_ENDS_VARIABLE.name in variables:
        lines.append(
            "ends of curves of folds lost beyond the range: "
            f"{int(variables[LOST_CURVE_ENDS_VARIABLE.name])}; rows whose branches are found only from these "
            "curves lack these cycles among the stable states"
        )
    return lines


def _rows_missing_curve_point_lines(
    view: ResultView, parameters: PlaneParameters, indices: NDArray[np.intp]
) -> list[str]:
    """Lines about completed rows that a curve of folds or torus points crosses although no branch of the row
    has this special point. indices: indices of the points of the curve, (points,)."""
    variables = view.variables
    if len(indices) < 2:
        return []
    kind = int(variables["cycle_curve_kind"][indices[0]])
    kinds, specials = map(
        view.flattened_by_point, ("cycle_special_kind", f"cycle_special_{parameters.line_parameter}")
    )
    tolerance = MAX_CURVE_DISTANCE_OVER_ROW_LENGTH * float(np.ptp(variables[parameters.line_parameter]))
    points = np.stack([variables[f"cycle_curve_{name}"][indices] for name in parameters[::-1]], axis=-1)
    lines = []
    for number, ((x, y), (next_x, next_y)) in enumerate(pairwise(points)):
        low, high = sorted((y, next_y))
        for index, value in enumerate(view.point_columns[parameters.row_parameter]):
            # A row through a point of the curve belongs to the piece before this point.
            is_crossed = (x - value) * (next_x - value) <= 0 and not (value == x and number > 0)
            on_row = specials[index][kinds[index] == kind]
            has_point = ((on_row >= low - tolerance) & (on_row <= high + tolerance)).any()
            if is_crossed and not has_point and view.status_names[index] == "ok":
                lines.append(
                    f"this curve crosses the row {parameters.row_parameter} = {value:g} between "
                    f"{parameters.line_parameter} = {low:.6g} and {high:.6g}, but no branch of this row was "
                    "found there: the stable states of the row do not include the cycles there"
                )
    return list(dict.fromkeys(lines))
