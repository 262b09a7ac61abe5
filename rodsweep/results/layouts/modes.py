"""Layout of the task modes: eigenvalues, modes, adjoint modes, condition numbers and transient growth."""

from typing import Any

from .spectrum import EIGENVECTOR_VARIABLES, MODE_VARIABLES, POINT_VARIABLES, complex_pair
from .variables import NEW_SOLVE_RULE, Layout, along_dimension, real

MODE_FIELD_VARIABLES = (
    *EIGENVECTOR_VARIABLES,
    *complex_pair("h2", "1", "the eigenmode's shear strain h2 = Y' - nu Theta, with the scale of Y"),
    *complex_pair("Pi", "1/L", "the eigenmode's bending strain Pi = Theta', with the scale of Y"),
    *complex_pair("adjoint_Y", "1", "the adjoint mode's deflection, scaled to adjoint_Y(1) = 1"),
    *complex_pair("adjoint_Theta", "1", "the adjoint mode's angle, with the scale of adjoint_Y"),
)
MODE_SCALAR_VARIABLES = along_dimension(
    "mode",
    real(
        "mode_error",
        "1",
        "largest error of the mode's fields, each relative to the largest value of its field",
    ),
    real("pairing_real", "1", "real part of the product of the adjoint mode and the mode"),
    real("pairing_imag", "1", "imaginary part of the product of the adjoint mode and the mode"),
    real("condition", "1", "condition number of the eigenvalue in the norm of the dissipation"),
    real("condition_error", "1", "relative error of condition"),
)
GROWTH_VARIABLES = (
    real("numerical_abscissa", "1/tau2", "largest initial growth rate of any perturbation"),
    real("abscissa_error", "1/tau2", "absolute error of numerical_abscissa"),
    real("transient_growth", "1", "largest amplification of any perturbation; inf for an unstable rod"),
    real("transient_time", "tau2", "time at which transient_growth is reached"),
    real("growth_error", "1", "relative error of transient_growth"),
)
OPTION_EXTENSION_RULES = dict.fromkeys(("modes", "nodes", "growth", "certify"), NEW_SOLVE_RULE)


def layout(config: dict[str, Any]) -> Layout:
    """Layout of the result file of the task modes, for a resolved config; transient growth only if the config
    asks for it."""
    options = config["modes"]
    growth = GROWTH_VARIABLES if options["growth"] else ()
    variables = MODE_VARIABLES + MODE_FIELD_VARIABLES + MODE_SCALAR_VARIABLES + growth + POINT_VARIABLES
    return Layout(variables, {"mode": options["modes"], "u": options["nodes"]})
