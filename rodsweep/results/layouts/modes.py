"""Layout of the task modes: eigenvalues, modes, adjoint modes, condition numbers and transient growth."""

from typing import Any

from .spectrum import EIGENVECTOR_VARIABLES, MODE_VARIABLES, POINT_VARIABLES, real_and_imaginary_variables
from .variables import NEW_SOLVE_RULE, Layout, along_dimension, real_variable

MODE_FIELD_VARIABLES = (
    *EIGENVECTOR_VARIABLES,
    *real_and_imaginary_variables(
        "h2", "1", "the eigenmode's shear strain h2 = Y' - nu Theta, with the scale of Y"
    ),
    *real_and_imaginary_variables(
        "Pi", "1/L", "the eigenmode's bending strain Pi = Theta', with the scale of Y"
    ),
    *real_and_imaginary_variables(
        "adjoint_Y", "1", "the adjoint mode's deflection, scaled to adjoint_Y(1) = 1"
    ),
    *real_and_imaginary_variables(
        "adjoint_Theta", "1", "the adjoint mode's angle, with the scale of adjoint_Y"
    ),
)
MODE_SCALAR_VARIABLES = along_dimension(
    "mode",
    real_variable(
        "mode_error",
        "1",
        "largest error of the mode's fields, each relative to the largest value of its field",
    ),
    real_variable("pairing_real", "1", "real part of the product of the adjoint mode and the mode"),
    real_variable("pairing_imag", "1", "imaginary part of the product of the adjoint mode and the mode"),
    real_variable("condition", "1", "condition number of the eigenvalue in the norm of the dissipation"),
    real_variable("condition_error", "1", "relative error of condition"),
)
GROWTH_VARIABLES = (
    real_variable("numerical_abscissa", "1/tau2", "largest initial growth rate of any perturbation"),
    real_variable("abscissa_error", "1/tau2", "absolute error of numerical_abscissa"),
    real_variable(
        "transient_growth", "1", "largest amplification of any perturbation; inf for an unstable rod"
    ),
    real_variable("transient_time", "tau2", "time at which transient_growth is reached"),
    real_variable("growth_error", "1", "relative error of transient_growth"),
)
REUSE_RULES_OF_INCREASED_OPTIONS = dict.fromkeys(("modes", "nodes", "growth", "certify"), NEW_SOLVE_RULE)


def layout(config: dict[str, Any]) -> Layout:
    """Layout of the result file of the task modes, for a resolved config; transient growth only if the config
    asks for it."""
    options = config["modes"]
    growth = GROWTH_VARIABLES if options["growth"] else ()
    variables = MODE_VARIABLES + MODE_FIELD_VARIABLES + MODE_SCALAR_VARIABLES + growth + POINT_VARIABLES
    return Layout(variables, {"mode": options["modes"], "u": options["nodes"]})
