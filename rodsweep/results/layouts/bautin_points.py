"""Layout of the generalised Hopf (Bautin) points of a phase diagram, where Re c = 0 on a Hopf curve, and of
their curves along a third parameter."""

from ...model.parameters import PARAMETERS
from .criticality import GROWTH_SLOPE_UNIT, LANDAU_UNIT, criticality_variable
from .variables import (
    ANGULAR_UNIT,
    Variable,
    along_dimension,
    curve_end_variables,
    integer_variable,
    real_variable,
)

BAUTIN_CURVE_END_REASONS = ("none", "range_end", "plane_edge", "not_found", "list_full", "closed")
"""Names of the reasons why a curve of generalised Hopf points ends; the file stores the position in this
list."""


def criticality_variables(line_parameter: str, row_parameter: str) -> dict[str, Variable]:
    """Variables, by name, that `phase_diagram.criticality` stores: sign of Re c along Hopf curves, and zeros
    of Re c (c: Landau coefficient). line_parameter, row_parameter: names of the parameters of the diagram."""
    units = {name: PARAMETERS[name].unit for name in (line_parameter, row_parameter)}
    axial_drag_meaning = "axial drag of curve_criticality and bautin_*"
    frequency_meaning = "angular frequency of the pair at the generalised Hopf point"
    point_meaning = "number, from 1, of the curve_point before the generalised Hopf point"
    unlocated_meaning = "number of sign changes of Re c along Hopf curves that could not be located"
    error_meaning = "estimate of the error of bautin_"
    variables = (
        *along_dimension("curve_point", criticality_variable("curve_criticality", "Re c")),
        real_variable("curve_gamma1", PARAMETERS["gamma1"].unit, axial_drag_meaning),
        *along_dimension(
            "bautin",
            integer_variable("bautin_curve", "number of the curve on which the generalised Hopf point lies"),
            integer_variable("bautin_curve_point", point_meaning),
            *(real_variable(f"bautin_{name}", units[name], f"{name} where Re c = 0") for name in units),
            *(real_variable(f"bautin_{name}_error", units[name], f"{error_meaning}{name}") for name in units),
            real_variable("bautin_frequency", ANGULAR_UNIT, frequency_meaning),
            real_variable("bautin_growth_slope_real", GROWTH_SLOPE_UNIT, "d(growth rate)/dF of the pair"),
            real_variable(
                "bautin_growth_slope_imag", GROWTH_SLOPE_UNIT, "d(angular frequency)/dF of the pair"
            ),
            real_variable("bautin_landau_imag", LANDAU_UNIT, "imaginary part of the Landau coefficient c"),
        ),
        integer_variable("bautin_unlocated", unlocated_meaning),
    )
    return {variable.name: variable for variable in variables}


def bautin_curve_variables(line_parameter: str, row_parameter: str, third: str) -> dict[str, Variable]:
    """Variables of the curves of generalised Hopf points, by name, for `phase_diagram.bautin_along`. The
    curves run through the space of three parameters with the names line_parameter, row_parameter and
    third."""
    units = {name: PARAMETERS[name].unit for name in (line_parameter, row_parameter, third)}
    prefix = "bautin_along"
    error_meaning = f"estimate of the error of {prefix}_"
    variables = along_dimension(
        "bautin_step",
        integer_variable(f"{prefix}_curve", "number of the curve of generalised Hopf points, from 1"),
        *(real_variable(f"{prefix}_{name}", units[name], f"{name} where Re c = 0") for name in units),
        *(real_variable(f"{prefix}_{name}_error", units[name], f"{error_meaning}{name}") for name in units),
        real_variable(f"{prefix}_frequency", ANGULAR_UNIT, "angular frequency of the pair"),
        real_variable(f"{prefix}_landau_imag", LANDAU_UNIT, "imaginary part of the Landau coefficient c"),
        *curve_end_variables(prefix, BAUTIN_CURVE_END_REASONS),
    )
    return {variable.name: variable for variable in variables}
