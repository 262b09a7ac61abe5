"""Extrema of the row parameter along the curves of folds of a phase diagram, as variables of the file."""

from typing import TYPE_CHECKING

import numpy as np

from ...results.layouts.curve_extrema import curve_extremum_variables
from ...results.layouts.variables import FilledVariable

if TYPE_CHECKING:
    from ...solve.branch.special.special_curves import SpecialPointCurve
    from ...solve.continuation.curve_search import TracedCurves


def curve_extremum_values(
    traced: "TracedCurves[SpecialPointCurve]", plane: tuple[str, str]
) -> list[FilledVariable]:
    """Variables of the extrema of the row parameter along the curves `traced`; [] if there are none. plane:
    (parameter along a row, parameter that differs between rows)."""
    rows = [
        (number, point.parameter_value, point.row_value, point.error, point.row_extremum_error)
        for number, curve in enumerate(traced.curves, 1)
        for point in curve.points
        if point.row_extremum_error
    ]
    variables = curve_extremum_variables(*plane).values() if rows else ()
    return [
        (variable, np.array(column))
        for variable, column in zip(variables, zip(*rows, strict=True), strict=True)
    ]
