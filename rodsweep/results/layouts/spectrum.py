"""Layout of the task spectrum: leading eigenvalues and, on request, eigenmodes.

The task modes shares the variables.
"""

from dataclasses import replace
from typing import Any

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES, PARAMETERS
from .rod_properties import has_estimated_counts, has_linear_law, has_uniform_linear_rods, with_long_name
from .thresholds import CROSSING_KINDS
from .variables import (
    ANGULAR_UNIT,
    MESH_VARIABLES,
    NEW_SOLVE_RULE,
    NO_NEW_SOLVE_RULE,
    SECONDS_VARIABLE,
    STATUS_VARIABLE,
    Layout,
    Variable,
    boolean_variable,
    integer_variable,
    real_variable,
    word_variable,
)


def real_and_imaginary_variables(name: str, units: str, long_name: str) -> tuple[Variable, Variable]:
    """Variables for the real and the imaginary part of a complex field of every mode, along the rod. units,
    long_name: unit and long name of the field."""
    return (
        real_variable(f"{name}_real", units, f"real part of {long_name}", "mode", "u"),
        real_variable(f"{name}_imag", units, f"imaginary part of {long_name}", "mode", "u"),
    )


UNSTABLE_COUNT_VARIABLE = integer_variable(
    "unstable_count", "number of modes with positive growth rate; -1: not known"
)
MODE_VARIABLES = (
    real_variable("growth_rate", "1/tau2", "real part of the transverse eigenvalue", "mode"),
    real_variable(
        "frequency", ANGULAR_UNIT, "angular frequency of the mode, imaginary part of the eigenvalue", "mode"
    ),
    real_variable(
        "error_estimate",
        "1/tau2",
        "modulus of the Newton correction D/D' of the characteristic determinant at the eigenvalue",
        "mode",
    ),
)
CERTIFIED_VARIABLE = boolean_variable(
    "certified", "whether the winding number of D proves the list of leading modes complete"
)
CERTIFIED_LONG_NAME_OF_ESTIMATES = (
    "whether D right of the spectrum, or the winding number of D, proves the list of leading modes "
    "complete; for arms that vary along their length the proof is partly an estimate"
)
"""Long name of the variable `certified` in a file of arms that vary along their length."""
POINT_VARIABLES = (
    UNSTABLE_COUNT_VARIABLE,
    CERTIFIED_VARIABLE,
    *MESH_VARIABLES,
    SECONDS_VARIABLE,
    STATUS_VARIABLE,
)
SHARED_TIME_LONG_NAME = "time spent on the point; for points solved together, an equal share of their time"
NO_MESH_LONG_NAME_SUFFIX = "; 0: eigenvalues continued from a neighbouring point"
FOLLOWED_MESH_VARIABLES = (
    replace(v, long_name=v.long_name + NO_MESH_LONG_NAME_SUFFIX) for v in MESH_VARIABLES
)
FOLLOWED_SECONDS_VARIABLE = replace(SECONDS_VARIABLE, long_name=SHARED_TIME_LONG_NAME)
FOLLOWED_POINT_VARIABLES = (
    UNSTABLE_COUNT_VARIABLE,
    CERTIFIED_VARIABLE,
    *FOLLOWED_MESH_VARIABLES,
    FOLLOWED_SECONDS_VARIABLE,
    STATUS_VARIABLE,
)
"""Variables of a point of the task spectrum, whose eigenvalues may be followed from a neighbouring point."""
EIGENVECTOR_VARIABLES = (
    *real_and_imaginary_variables("Y", "1", "the eigenmode's deflection, scaled to Y(1) = 1"),
    *real_and_imaginary_variables("Theta", "1", "the eigenmode's angle, with the scale of Y"),
)


def longitudinal_eigenvalue_variables(
    gamma1: float, *dimensions: str, is_closed_form: bool = True
) -> tuple[Variable, ...]:
    """Variables of the longitudinal eigenvalues, with an error estimate unless the eigenvalues have a closed
    form (`is_closed_form`). gamma1: axial drag of all rods. dimensions: dimensions of the parameters on which
    the eigenvalues depend, or the dimension of all points."""
    meaning = f"longitudinal eigenvalue, real, for gamma1 = {gamma1:g}"
    rate = real_variable("longitudinal_rate", "1/tau2", meaning, *dimensions, "mode")
    error_meaning = "estimate of the relative error of longitudinal_rate"
    return (
        (rate,)
        if is_closed_form
        else (rate, real_variable("longitudinal_error", "1", error_meaning, *dimensions, "mode"))
    )


def longitudinal_parameter_names(is_closed_form: bool, linear: bool) -> tuple[str, ...]:
    """Names of the parameters, besides gamma1, on which the longitudinal eigenvalues depend.

    is_closed_form: whether every arm is uniform and of linear material. linear: whether the material is
    linear, so that the eigenvalues do not depend on F.
    """
    if is_closed_form:
        return ("k1",)
    arm_parameters = ("k1", "taper")
    return arm_parameters if linear else ("F", *arm_parameters)


FORCE_THRESHOLD_DIMENSION = "change"
"""Name of the dimension of the thresholds of the straight rod on lines of points along F."""
FORCE_THRESHOLD_VARIABLES = (
    word_variable(
        "change_kind",
        "kind of the change as F grows",
        ((CROSSING_KINDS.index(kind), kind) for kind in ("none", "onset", "hopf", "restabilization")),
        FORCE_THRESHOLD_DIMENSION,
    ),
    *(
        real_variable(f"change_{p}", PARAMETERS[p].unit, f"{p} at the change", FORCE_THRESHOLD_DIMENSION)
        for p in NON_OPTIONAL_LINEAR_PARAMETER_NAMES
    ),
    real_variable(
        "change_error", "1", "estimate of the relative error of change_F", FORCE_THRESHOLD_DIMENSION
    ),
    real_variable(
        "change_growth_rate", "1/tau2", "growth rate of the modes that change", FORCE_THRESHOLD_DIMENSION
    ),
    real_variable(
        "change_frequency",
        ANGULAR_UNIT,
        "angular frequency of the modes that change",
        FORCE_THRESHOLD_DIMENSION,
    ),
)
"""Variables, computed after the last point, of the forces at which the straight rod starts to oscillate,
becomes unstable, or becomes stable again."""
OPTIONS_THAT_NEED_NEW_SOLVE = ("modes", "certify", "vectors", "nodes", "follow")
REUSE_RULES_OF_INCREASED_OPTIONS = dict.fromkeys(OPTIONS_THAT_NEED_NEW_SOLVE, NEW_SOLVE_RULE) | {
    "longitudinal": NO_NEW_SOLVE_RULE
}


def sweep_wide_variables(config: dict[str, Any], is_grid: bool) -> tuple[Variable, ...]:
    """Variables of a file of the task spectrum that belong to all points together, for a resolved config.
    is_grid: whether the points are a grid."""
    gamma1 = config["parameters"].get("gamma1")
    if gamma1 is None:
        return FORCE_THRESHOLD_VARIABLES
    is_closed_form = has_uniform_linear_rods(config)
    names = longitudinal_parameter_names(is_closed_form, has_linear_law(config))
    dimensions = [name for name in names if name in config["parameters"]] if is_grid else ["point"]
    return (
        *longitudinal_eigenvalue_variables(float(gamma1), *dimensions, is_closed_form=is_closed_form),
        *FORCE_THRESHOLD_VARIABLES,
    )


def layout(config: dict[str, Any]) -> Layout:
    """Layout of the result file of the task spectrum, for a resolved config; eigenmodes only if the config
    asks for them."""
    options = config["spectrum"]
    each_point: tuple[Variable, ...] = FOLLOWED_POINT_VARIABLES
    extents = {"mode": options["modes"]}
    if has_estimated_counts(config):
        each_point = with_long_name(each_point, CERTIFIED_VARIABLE.name, CERTIFIED_LONG_NAME_OF_ESTIMATES)
    if not options["vectors"]:
        return Layout(MODE_VARIABLES + each_point, extents)
    return Layout(MODE_VARIABLES + EIGENVECTOR_VARIABLES + each_point, extents | {"u": options["nodes"]})
