"""Extrema of the row parameter along curves of folds of cycles, in `rodsweep show`."""

from ...results.file.view import ResultView
from ...results.layouts.curve_extrema import EXTREMA_UNLOCATED
from .number_texts import number_with_error


def fold_curve_extremum_lines(view: ResultView, line_parameter: str, row_parameter: str) -> list[str]:
    """Lines about the points of curves of folds of cycles at which the row parameter is extremal.
    line_parameter: parameter that varies along a row. row_parameter: parameter that is constant on a row."""
    variables = view.variables
    lines = []
    if EXTREMA_UNLOCATED.name in variables:
        lines.append(
            f"extrema of {row_parameter} along curves of folds of cycles that could not be located: "
            f"{int(variables[EXTREMA_UNLOCATED.name])}; closed branches of cycles may be missing on rows "
            "beside them"
        )
    if "cycle_extremum_curve" not in variables:
        return lines
    for i in range(len(variables["cycle_extremum_curve"])):
        place_text = ", ".join(
            f"{name} = "
            + number_with_error(
                variables[f"cycle_extremum_{name}"][i], variables[f"cycle_extremum_{name}_error"][i]
            )
            for name in (row_parameter, line_parameter)
        )
        lines.append(
            f"extremum of {row_parameter} along curve {variables['cycle_extremum_curve'][i]} of folds of "
            f"cycles: {place_text}; a closed branch of cycles shrinks to one cycle there, or two branches "
            "exchange their parts"
        )
    return lines
