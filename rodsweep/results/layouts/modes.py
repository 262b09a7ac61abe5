"""What the file of the task modes holds."""

from typing import Any

from .spectrum import EACH_MODE, EACH_POINT, VECTORS, complex_pair
from .variables import ANEW, Layout, real

MODE_FIELDS = (
    *VECTORS,
    *complex_pair("h2", "1", "the eigenmode's shear strain h2 = Y' - nu Theta, scaled as Y"),
    *complex_pair("Pi", "1/L", "the eigenmode's bending strain Pi = Theta', scaled as Y"),
    *complex_pair("adjoint_Y", "1", "the adjoint mode's deflection, scaled to adjoint_Y(1) = 1"),
    *complex_pair("adjoint_Theta", "1", "the adjoint mode's angle, scaled as adjoint_Y"),
)
MODE_NUMBERS = (
    real("mode_error", "1", "largest error of the mode's fields, each in units of its largest value", "mode"),
    real("pairing_real", "1", "real part of the product of the adjoint mode and the mode", "mode"),
    real("pairing_imag", "1", "imaginary part of the product of the adjoint mode and the mode", "mode"),
    real("condition", "1", "condition number of the eigenvalue in the norm of the dissipation", "mode"),
    real("condition_error", "1", "relative error of condition", "mode"),
)
GROWTH = (
    real("numerical_abscissa", "1/tau2", "largest initial growth rate of any perturbation"),
    real("abscissa_error", "1/tau2", "absolute error of numerical_abscissa"),
    real("transient_growth", "1", "largest amplification of any perturbation; inf for an unstable rod"),
    real("transient_time", "tau2", "time at which transient_growth is reached"),
    real("growth_error", "1", "relative error of transient_growth"),
)

INCREASES = {"modes": ANEW, "nodes": ANEW, "growth": ANEW, "certify": ANEW}


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for; what non-normality does only where asked for."""
    options = config["modes"]
    growth = GROWTH if options["growth"] else ()
    variables = EACH_MODE + MODE_FIELDS + MODE_NUMBERS + growth + EACH_POINT
    return Layout(variables, {"mode": options["modes"], "u": options["nodes"]})
