"""Variables of a phase diagram on extrema along curves of folds of cycles: points at which the parameter that
differs between rows (the row parameter) is largest or smallest on the curve."""

from ...model.parameters import PARAMETERS
from .variables import Variable, along_dimension, integer_variable, real_variable

UNLOCATED_EXTREMA_VARIABLE = integer_variable(
    "cycle_extrema_unlocated",
    "number of extrema of the row parameter along curves of folds that could not be located",
)
"""Number of extrema of the parameter that differs between rows, along curves of folds, that could not be
located; a file without such extrema does not have this variable."""


def fold_curve_extremum_variables(line_parameter: str, row_parameter: str) -> dict[str, Variable]:
    """Variables, by name, of the points on curves of folds of cycles at which the parameter `row_parameter`,
    which differs between rows, is extremal; a file without such points does not have them. line_parameter:
    parameter along the rows."""
    units = {name: PARAMETERS[name].unit for name in (line_parameter, row_parameter)}
    error_meaning = "estimate of the absolute error of cycle_extremum_"
    variables = along_dimension(
        "cycle_extremum",
        integer_variable("cycle_extremum_curve", "number of the curve of folds on which the extremum lies"),
        *(
            real_variable(f"cycle_extremum_{name}", units[name], f"{name} where {row_parameter} is extremal")
            for name in units
        ),
        *(
            real_variable(f"cycle_extremum_{name}_error", units[name], f"{error_meaning}{name}")
            for name in units
        ),
    )
    return {variable.name: variable for variable in variables}
