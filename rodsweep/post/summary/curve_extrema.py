"""Extrema of the row parameter along curves of folds of cycles, in `rodsweep show`."""

from ...results.file.view import ResultView
from ...results.layouts.curve_extrema import EXTREMA_UNLOCATED
from .number_texts import number_with_error


def curve_extremum_lines(view: ResultView, line_parameter: str, row_parameter: str) -> list[str]:
    """Lines about the points of curves of folds of cycles at which the row parameter is extremal. line:
    parameter that varies along a row. row_parameter: parameter that is constant on a row."""
    v = view.variables
    lines = []
    if EXTREMA_UNLOCATED.name in v:
        lines.append(
            f"extrema of {row_parameter} along curves of folds of cycles that could not be located: "
            f"{int(v[EXTREMA_UNLOCATED.name])}; closed branches of cycles may be missing on rows beside them"
        )
    if "cycle_extremum_curve" not in v:
        return lines
    for i in range(len(v["cycle_extremum_curve"])):
        place = ", ".join(
            f"{name} = "
            + number_with_error(v[f"cycle_extremum_{name}"][i], v[f"cycle_extremum_{name}_error"][i])
            for name in (row_parameter, line_parameter)
        )
        lines.append(
            f"extremum of {row_parameter} along curve {v['cycle_extremum_curve'][i]} of folds of cycles: "
            f"{place}; a "
            "closed branch of cycles shrinks to one cycle there, or two branches exchange their parts"
        )
    return lines
