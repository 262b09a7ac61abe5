"""Layout of the task criticality: the Hopf points of every rod and their normal forms."""

from math import nan
from typing import Any

from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES, PARAMETERS, parameter_names_except
from .rod_properties import with_certified_long_name
from .thresholds import CROSSING_LIST_REUSE_RULE, SEARCH_END_VARIABLES, search_variables
from .variables import ANGULAR_UNIT, NEW_SOLVE_RULE, Layout, Variable, along_dimension, real_variable

FORCE_UNIT = PARAMETERS["F"].unit
GROWTH_SLOPE_UNIT = "L^2/(k3 tau2)"
"""Unit of the slope dw/dF of an eigenvalue."""
LANDAU_UNIT = "1/(tau2 L^2)"
"""Unit of the Landau coefficient c."""
HOPF_POINT_DIMENSION = "crossing"
VARIABLES_ABSENT_FROM_HOPF_SEARCH = ("crossing_growth_rate", "solves")
"""Names of the variables of a search for crossings that are not stored for a search for Hopf points, where
growth rates are 0."""
CRITICALITY_CODES = ((-1, "supercritical"), (0, "undecided"), (1, "subcritical"))
"""(stored number, word) of each criticality. The number is the sign of Re c; nan is stored for an unknown
c."""


def criticality_variable(name: str, decided_by: str) -> Variable:
    """Variable for the criticality of Hopf points. decided_by: name of the number whose sign is the
    criticality."""
    meaning = (
        "supercritical: cycles exist where the pair is unstable, and are stable unless other modes are "
        "unstable; subcritical: cycles exist where the pair is stable; "
        f"undecided: the sign of {decided_by} is within its error"
    )
    return Variable(name, "<f8", nan, "1", meaning, flags=CRITICALITY_CODES)


NORMAL_FORM_VARIABLES = along_dimension(
    HOPF_POINT_DIMENSION,
    real_variable(
        "crossing_frequency_error", ANGULAR_UNIT, "estimate of the absolute error of crossing_frequency"
    ),
    real_variable("growth_slope_real", GROWTH_SLOPE_UNIT, "d(growth rate)/dF of the pair at the Hopf point"),
    real_variable(
        "growth_slope_imag", GROWTH_SLOPE_UNIT, "d(angular frequency)/dF of the pair at the Hopf point"
    ),
    real_variable("growth_slope_error", "1", "estimate of the relative error of the complex slope dw/dF"),
    real_variable("landau_real", LANDAU_UNIT, "real part of the Landau coefficient c, for tip y = Re Z"),
    real_variable("landau_imag", LANDAU_UNIT, "imaginary part of the Landau coefficient c"),
    real_variable("landau_error", "1", "estimate of the relative error of the complex c"),
    real_variable(
        "amplitude_coefficient",
        "L",
        "coefficient a: to leading order the largest tip y of the cycles is |a| sqrt(|F - F_H|/F_H); "
        "a < 0: cycles at F < F_H",
    ),
    real_variable(
        "amplitude_coefficient_error", "1", "estimate of the relative error of amplitude_coefficient"
    ),
    real_variable(
        "frequency_slope",
        GROWTH_SLOPE_UNIT,
        "coefficient b: to leading order the angular frequency of the cycles is that of the Hopf point "
        "+ b (F - F_H)",
    ),
    real_variable("frequency_slope_error", "1", "estimate of the relative error of frequency_slope"),
    criticality_variable("criticality", "landau_real"),
    Variable("elements", "<i2", 0, "1", "spectral elements used"),
    Variable("order", "<i2", 0, "1", "polynomial order used"),
)
REUSE_RULES_OF_INCREASED_OPTIONS = {"crossings": CROSSING_LIST_REUSE_RULE, "certify": NEW_SOLVE_RULE}


def layout(config: dict[str, Any]) -> Layout:
    """Layout of the result file of the task criticality, for a resolved config."""
    search = [
        variable
        for variable in search_variables("F", "crossing_F")
        if variable.name not in VARIABLES_ABSENT_FROM_HOPF_SEARCH
    ]
    position = [variable.name for variable in search].index("unstable_after") + 1
    variables = (*search[:position], *NORMAL_FORM_VARIABLES, *SEARCH_END_VARIABLES, *search[position:])
    variables = with_certified_long_name(variables, config, "Hopf points")
    extents = {HOPF_POINT_DIMENSION: config["criticality"]["crossings"]}
    return Layout(variables, extents, parameter_names_except("F", NONLINEAR_ROD_PARAMETER_NAMES))
