"""Variables of a phase diagram on branches of cycles that no Hopf point of their row leads to (a row: all
points of the diagram with one value of the second parameter)."""

from .variables import along_dimension, integer_variable

DETACHED_ROW_VARIABLE = "cycle_detached_row"
"""Name of the variable with the numbers, from 1, of the rows of the diagram that have branches of cycles to
which no Hopf point leads."""
DETACHED_ROW_VARIABLES = along_dimension(
    "cycle_detached",
    integer_variable(
        DETACHED_ROW_VARIABLE, "number, from 1, of a row with branches that no Hopf point leads to"
    ),
    integer_variable("cycle_detached_count", "number of special points on these branches of the row"),
)
DETACHED_ROW_VARIABLES_BY_NAME = {variable.name: variable for variable in DETACHED_ROW_VARIABLES}
"""Variables, by name, on the rows of the diagram that have branches of cycles found only because a curve of
folds or torus points crosses the row; a file without such rows does not have these variables."""
LOST_CURVE_ENDS_VARIABLE = integer_variable(
    "cycle_curves_lost_beyond",
    "number of ends of curves of folds that were lost beyond the range",
)
"""Variable with the number of ends of fold curves that were lost beyond the range of the diagram. Where only
the lost part of a curve would have led to a branch, the cycles on this branch are missing in the diagram. A
file without lost ends does not have this variable."""
