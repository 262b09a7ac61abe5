"""Variables of a phase diagram on the extrema of the row parameter along curves of folds of cycles."""

from ...model.parameters import PARAMETERS
from .variables import Variable, along_dimension, integer, real

EXTREMA_UNLOCATED = integer(
    "cycle_extrema_unlocated",
    "number of extrema of the row parameter along curves of folds that could not be located",
)
"""A file without such extrema does not have this variable."""


def fold_curve_extremum_variables(line_parameter: str, row_parameter: str) -> dict[str, Variable]:
    """Variables, by name, of the extrema of the row parameter `row_parameter` along curves of folds of
    cycles; a file without extrema does not have them. line_parameter: parameter along the rows."""
    units = {name: PARAMETERS[name].unit for name in (line_parameter, row_parameter)}
    error_meaning = "estimate of the absolute error of cycle_extremum_"
    variables = along_dimension(
        "cycle_extremum",
        integer("cycle_extremum_curve", "number of the curve of folds on which the extremum lies"),
        *(
            real(f"cycle_extremum_{name}", units[name], f"{name} where {row_parameter} is extremal")
            for name in units
        ),
        *(real(f"cycle_extremum_{name}_error", units[name], f"{error_meaning}{name}") for name in units),
    )
    return {variable.name: variable for variable in variables}
