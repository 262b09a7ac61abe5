"""Extrema of the row parameter along the curves of folds of a phase diagram, as variables of the file."""

from math import isnan
from typing import TYPE_CHECKING

import numpy as np

from ...results.layouts.fold_curve_extrema import EXTREMA_UNLOCATED, fold_curve_extremum_variables
from ...results.layouts.variables import FilledVariable

if TYPE_CHECKING:
    from ...solve.branch.special.special_curves import SpecialPointCurve
    from ...solve.continuation.curve_search import TracedCurves


def fold_curve_extremum_values(
    traced: "TracedCurves[SpecialPointCurve]", plane: tuple[str, str]
) -> list[FilledVariable]:
    """Variables of the extrema of the row parameter along the curves `traced`, located or not; [] if there
    are none. plane: (parameter along a row, parameter that differs between rows)."""
    rows = [
        (number, point.parameter_value, point.row_value, point.error, point.row_extremum_error)
        for number, curve in enumerate(traced.curves, 1)
        for point in curve.points
        if point.row_extremum_error > 0
    ]
    variables = fold_curve_extremum_variables(*plane).values() if rows else ()
    columns = zip(variables, zip(*rows, strict=True), strict=True)
    filled = [(variable, np.array(column)) for variable, column in columns]
    points = (point for curve in traced.curves for point in curve.points)
    unlocated_count = sum(isnan(point.row_extremum_error) for point in points)
    return filled + ([(EXTREMA_UNLOCATED, np.array(unlocated_count))] if unlocated_count else [])
