"""What the file of the task spectrum holds: leading eigenvalues and their modes, as that of modes does."""

from math import nan
from typing import Any

from ...model.parameters import LINEAR_PARAMETERS, PARAMETERS
from .thresholds import CROSSING_KINDS
from .variables import ANEW, ANGULAR, BESIDE, MESH, SECONDS, STATUS, Layout, Variable, real, truth, whole


def complex_pair(name: str, units: str, long_name: str) -> tuple[Variable, Variable]:
    """Real and imaginary part of a field of every mode."""
    return (
        real(f"{name}_real", units, f"real part of {long_name}", "mode", "u"),
        real(f"{name}_imag", units, f"imaginary part of {long_name}", "mode", "u"),
    )


UNSTABLE_COUNT = whole("unstable_count", "number of modes with positive growth rate; -1: not known")
EACH_MODE = (
    real("growth_rate", "1/tau2", "real part of the transverse eigenvalue", "mode"),
    real("frequency", ANGULAR, "angular frequency of the mode, imaginary part of its eigenvalue", "mode"),
    real(
        "error_estimate",
        "1/tau2",
        "modulus of the Newton correction D/D' of the characteristic determinant at the eigenvalue",
        "mode",
    ),
)
CERTIFIED = truth("certified", "whether the winding number of D proves that no leading mode is missing")
EACH_POINT = (UNSTABLE_COUNT, CERTIFIED, *MESH, SECONDS, STATUS)
EACH_FOLLOWED_POINT = (
    UNSTABLE_COUNT,
    CERTIFIED,
    Variable("elements", "<i2", 0, "1", "spectral elements used; 0: followed"),
    Variable("order", "<i2", 0, "1", "polynomial order used; 0: followed"),
    Variable("seconds", "<f4", nan, "s", "time spent on the point, or its share of that of neighbours"),
    STATUS,
)
"""Of the task spectrum, whose points may be followed along a grid."""
VECTORS = (
    *complex_pair("Y", "1", "the eigenmode's deflection, scaled to Y(1) = 1"),
    *complex_pair("Theta", "1", "the eigenmode's angle, scaled as Y"),
)


def longitudinal(gamma1: float, *along: str) -> Variable:
    """The longitudinal rates, which depend on k1 only; along: k1, or all points where k1 is no axis."""
    return real(
        "longitudinal_rate",
        "1/tau2",
        f"longitudinal eigenvalue, real, for gamma1 = {gamma1:g}",
        *along,
        "mode",
    )


CHANGE = "change"
"""Dimension of the changes of the straight rod between the points of a file, on lines over F."""
FORCE_CHANGES = (
    Variable(
        "change_kind",
        "|i1",
        0,
        "1",
        "what changes there as F grows",
        (CHANGE,),
        tuple((CROSSING_KINDS.index(kind), kind) for kind in ("none", "onset", "hopf", "restabilization")),
    ),
    *(real(f"change_{p}", PARAMETERS[p].unit, f"{p} at the change", CHANGE) for p in LINEAR_PARAMETERS),
    real("change_error", "1", "estimate of the relative error of change_F", CHANGE),
    real("change_growth_rate", "1/tau2", "growth rate of the modes that change", CHANGE),
    real("change_frequency", ANGULAR, "angular frequency of the modes that change", CHANGE),
)
"""Where rods start to oscillate, become unstable or stable again: located once all points are there."""

INCREASES = {
    "modes": ANEW,
    "method": ANEW,
    "certify": ANEW,
    "vectors": ANEW,
    "nodes": ANEW,
    "follow": ANEW,
    "longitudinal": BESIDE,
}


def beside_points(config: dict[str, Any], is_grid: bool) -> tuple[Variable, ...]:
    """Variables of the file that are no variables of a point."""
    gamma1 = config["parameters"].get("gamma1")
    rates = () if gamma1 is None else (longitudinal(float(gamma1), "k1" if is_grid else "point"),)
    return (*rates, *FORCE_CHANGES)


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for; vectors only where asked for."""
    options = config["spectrum"]
    extents = {"mode": options["modes"]}
    if not options["vectors"]:
        return Layout(EACH_MODE + EACH_FOLLOWED_POINT, extents)
    return Layout(EACH_MODE + VECTORS + EACH_FOLLOWED_POINT, extents | {"u": options["nodes"]})
