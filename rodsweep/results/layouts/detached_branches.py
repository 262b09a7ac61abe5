"""Variables of a phase diagram on the rows with branches of cycles that no Hopf point of the row leads to."""

from .variables import along_dimension, integer_variable

DETACHED_ROW_VARIABLE = "cycle_detached_row"
"""Name of the variable with the numbers of the rows that have detached branches of cycles."""
DETACHED_ROW_VARIABLES = along_dimension(
    "cycle_detached",
    integer_variable(
        DETACHED_ROW_VARIABLE, "number, from 1, of a row with branches that no Hopf point leads to"
    ),
    integer_variable("cycle_detached_count", "number of special points on these branches of the row"),
)
DETACHED_ROW_VARIABLES_BY_NAME = {variable.name: variable for variable in DETACHED_ROW_VARIABLES}
"""Variables, by name, of the rows whose stable states contain cycles on branches that were found only because
a curve of folds or torus points crosses the row; a file without such rows does not have them."""
LOST_CURVE_ENDS_VARIABLE = integer_variable(
    "cycle_curves_lost_beyond",
    "number of ends of curves of folds that were lost beyond the range",
)
"""Number of ends of curves of folds that were lost beyond the range. A row whose detached branches are found
only from a lost part of a curve lacks the cycles on these branches. A file without lost ends does not have
this variable."""
