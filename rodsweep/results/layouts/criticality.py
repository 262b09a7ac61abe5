"""What the file of the task criticality holds: the Hopf points of every rod and their normal forms."""

from math import nan
from typing import Any

from ...model.parameters import NONLINEAR_PARAMETERS, PARAMETERS, all_but
from .thresholds import CROSSINGS, search_variables
from .variables import ANEW, ANGULAR, Layout, Variable, real, whole

FORCE = PARAMETERS["F"].unit
SLOPE = "L^2/(k3 tau2)"
LANDAU = "1/(tau2 L^2)"
ALONG = "crossing"
OF_NO_HOPF_POINT = ("crossing_growth_rate", "solves")
"""Variables of a search that a search for Hopf points has not: 0 at all of them."""
SIDES = ((-1, "supercritical"), (0, "undecided"), (1, "subcritical"))
"""On which side of a Hopf point its cycles are; the number is the sign of Re c, NaN where there is no c."""


def side(name: str, decided_by: str, along: str) -> Variable:
    """On which side cycles are born; decided_by: the number whose sign within its error says so."""
    meaning = (
        "on which side cycles are born: supercritical, where the pair grows, and stable unless other modes "
        f"grow; subcritical; undecided, where the sign of {decided_by} is within its error"
    )
    return Variable(name, "<f8", nan, "1", meaning, (along,), SIDES)


NORMAL_FORM = (
    real("crossing_frequency_error", ANGULAR, "estimate of the absolute error of crossing_frequency", ALONG),
    real("growth_slope_real", SLOPE, "d(growth rate)/dF of the pair at the crossing", ALONG),
    real("growth_slope_imag", SLOPE, "d(frequency)/dF of the pair at the crossing", ALONG),
    real("growth_slope_error", "1", "estimate of the error of the complex slope, relative to it", ALONG),
    real("landau_real", LANDAU, "real part of the Landau coefficient c, for the tip's y = Re Z", ALONG),
    real("landau_imag", LANDAU, "imaginary part of the Landau coefficient c", ALONG),
    real("landau_error", "1", "estimate of the error of the complex c, relative to it", ALONG),
    real(
        "amplitude_coefficient",
        "L",
        "a: largest tip y of the cycles near by is |a| sqrt(|F - F_H|/F_H); below 0: cycles at F < F_H",
        ALONG,
    ),
    real(
        "amplitude_coefficient_error",
        "1",
        "estimate of the relative error of amplitude_coefficient",
        ALONG,
    ),
    real(
        "frequency_slope",
        SLOPE,
        "b: frequency of the cycles near by is that of the crossing + b (F - F_H)",
        ALONG,
    ),
    real("frequency_slope_error", "1", "estimate of the relative error of frequency_slope", ALONG),
    side("criticality", "landau_real", ALONG),
    Variable("elements", "<i2", 0, "1", "spectral elements used", (ALONG,)),
    Variable("order", "<i2", 0, "1", "polynomial order used", (ALONG,)),
)

INCREASES = {"crossings": CROSSINGS, "certify": ANEW}


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for."""
    search = [v for v in search_variables("F", "crossing_F") if v.name not in OF_NO_HOPF_POINT]
    names = [v.name for v in search]
    after = names.index("unstable_after") + 1
    ends = (
        real("F_end", FORCE, "F up to which was searched"),
        whole("unstable_at_end", "number of modes with positive growth rate at F_end; -1: not known"),
    )
    variables = (*search[:after], *NORMAL_FORM, *ends, *search[after:])
    parameters = all_but("F", NONLINEAR_PARAMETERS)
    return Layout(variables, {ALONG: config["criticality"]["crossings"]}, parameters)
