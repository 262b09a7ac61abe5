"""Cycles on branches that no Hopf point of a diagram's row leads to, in `rodsweep show`."""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...results.file.view import ResultView
from ...results.layouts.detached_branches import CURVES_LOST_BEYOND, DETACHED_ROW_NAME
from ...wording import count_of_total
from ..plane_curves import PlaneParameters
from .number_texts import axis_values_text

MAX_RELATIVE_CURVE_DISTANCE = 0.01
"""Largest distance of a special point of a row from the two points of a curve between which the curve meets
the row, divided by the length of the row."""


def detached_branch_lines(view: ResultView, parameters: PlaneParameters) -> list[str]:
    """Lines about the rows with cycles on detached branches, and about curves lost beyond the range."""
    lost = lost_fold_curve_lines(view)
    if DETACHED_ROW_NAME not in view.variables:
        return lost
    row_indices = view.variables[DETACHED_ROW_NAME] - 1
    rows_text = count_of_total(len(row_indices), view.variables["status"].size, "row")
    values_text = axis_values_text(view.point_columns[parameters.row][row_indices])
    return [
        f"branches that no Hopf point of their row leads to: on {rows_text}, {parameters.row} = "
        f"{values_text}; they were followed from the crossings of curves of folds or torus points with the "
        "rows, and the stable states include their cycles",
        *lost,
    ]


def lost_fold_curve_lines(view: ResultView) -> list[str]:
    """List with a line about curves of folds that were lost beyond the range; empty if there are none."""
    if CURVES_LOST_BEYOND.name not in view.variables:
        return []
    count = int(view.variables[CURVES_LOST_BEYOND.name])
    return [
        f"ends of curves of folds lost beyond the range: {count}; rows whose branches are found only from "
        "these curves lack these cycles among the stable states"
    ]


def rows_missing_curve_point_lines(
    view: ResultView, parameters: PlaneParameters, indices: NDArray[np.intp]
) -> list[str]:
    """Lines about completed rows that a curve of folds or torus points crosses although no branch of the row
    has this special point. indices: indices of the points of the curve, (points,)."""
    variables = view.variables
    if len(indices) < 2:
        return []
    kind = int(variables["cycle_curve_kind"][indices[0]])
    kinds, specials = map(view.by_point, ("cycle_special_kind", f"cycle_special_{parameters.line}"))
    tolerance = MAX_RELATIVE_CURVE_DISTANCE * float(np.ptp(variables[parameters.line]))
    points = np.stack([variables[f"cycle_curve_{name}"][indices] for name in parameters[::-1]], axis=-1)
    lines = []
    for number, ((x, y), (next_x, next_y)) in enumerate(pairwise(points)):
        for index, value in enumerate(view.point_columns[parameters.row]):
            if view.status_names[index] != "ok":
                continue
            # A row through a point of the curve belongs to the piece before this point.
            if (value == x and number > 0) or (x - value) * (next_x - value) > 0:
                continue
            low, high = sorted((y, next_y))
            on_row = specials[index][kinds[index] == kind]
            if not ((on_row >= low - tolerance) & (on_row <= high + tolerance)).any():
                lines.append(
                    f"this curve crosses the row {parameters.row} = {value:g} between {parameters.line} = "
                    f"{low:.6g} and {high:.6g}, but no branch of this row was found there: the stable states "
                    "of the row do not include the cycles there"
                )
    return list(dict.fromkeys(lines))
