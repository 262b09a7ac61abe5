"""What the file of the task limit_cycle holds."""

from typing import Any

import numpy as np

from ...model.parameters import LINEAR_PARAMETERS, NONLINEAR_PARAMETERS, PARAMETERS
from .thresholds import CROSSING_KINDS
from .variables import ANEW, ANGULAR, MESH, SECONDS, STATUS, Increase, Layout, Variable, real, whole, word

POWER = "k3/(L tau2)"
STORED_MULTIPLIERS = 6
"""Floquet multipliers, without the trivial one, whose modulus is above 1e-6; NaN where there are fewer."""
SECOND_STATES = ((-1, "not_told"), (0, "none_known"), (1, "straight"), (2, "cycle_possible"))
"""What is known of a stable state beside the one in which a point ended."""
CYCLE = (
    real("period", "tau2", "period of the limit cycle"),
    real("frequency", ANGULAR, "angular frequency of the limit cycle, 2 pi/period"),
    real("linear_growth_rate", "1/tau2", "real part of the leading eigenvalue of the straight rod"),
    real(
        "linear_frequency",
        ANGULAR,
        "angular frequency of the leading mode of the straight rod, imaginary part of its eigenvalue",
    ),
    word(
        "second_state",
        "a stable state beside the one in which the point ended: straight, the straight rod is stable too; "
        "cycle_possible, the straight rod is stable and the Hopf point at subcritical_F is subcritical",
        SECOND_STATES,
    ),
    real(
        "subcritical_F", "k3/L^2", "force of the subcritical Hopf point whose unstable cycles lie at this F"
    ),
    real("tip_x_min", "L", "smallest x of the tip over a period"),
    real("tip_x_max", "L", "largest x of the tip over a period"),
    real("tip_y_max", "L", "largest deflection y of the tip over a period"),
    real("tip_theta_max", "rad", "largest angle of the tip over a period"),
    real("period_error", "1", "estimate of the relative error of period"),
    real("amplitude_error", "1", "estimate of the relative error of tip_y_max"),
    real("extrema_error", "1", "estimate of the error of the tip's other extrema, in units of tip_y_max"),
    real("harmonic_amplitude", "L", "amplitude of a harmonic of the tip's deflection y", "harmonic"),
    real("injection_mean", POWER, "power of the follower force, mean over a period"),
    real("injection_rms", POWER, "power of the follower force, root mean square of its fluctuation"),
    real("dissipation_mean", POWER, "power lost to the fluid, mean over a period"),
    real("dissipation_rms", POWER, "power lost to the fluid, root mean square of its fluctuation"),
    real("energy_imbalance", "1", "relative difference of energy injected and dissipated over a period"),
    real("multiplier", "1", "modulus of the largest Floquet multiplier but the one that is 1"),
    real("multiplier_error", "1", "estimate of the absolute error of multiplier"),
    real("trivial_multiplier_error", "1", "distance from 1 of the Floquet multiplier that is 1"),
    real(
        "multiplier_real",
        "1",
        "real part of a Floquet multiplier, by descending modulus",
        "multiplier_number",
    ),
    real("multiplier_imag", "1", "imaginary part of a Floquet multiplier", "multiplier_number"),
    real("least_stretch", "1", "smallest stretch h1 along the rod over a period"),
    whole("periods", "returns to the section that were waited for"),
    *MESH,
    SECONDS,
    STATUS,
)
PERIOD_TAU1 = real("period_tau1", "tau1", "period of the limit cycle in units of tau1, period k2/gamma3")
PLACE = {"x": "L", "y": "L", "theta": "rad"}
TIP = tuple(real(f"tip_{name}", units, f"{name} of the tip", "sample") for name, units in PLACE.items())
ENERGY = (
    real("energy", "k3/L", "elastic energy", "sample"),
    real("injection", POWER, "power of the follower force", "sample"),
    real("dissipation", POWER, "power lost to the fluid", "sample"),
)
SHAPE = tuple(
    real(f"shape_{name}", units, f"{name} along the rod", "shape", "u") for name, units in PLACE.items()
)
TRANSIENT = (
    real("transient_time", "tau2", "time from the start, to where the motion was left", "transient"),
    *(
        real(f"transient_{name}", units, f"{name} of the tip on its way from the start", "transient")
        for name, units in PLACE.items()
    ),
)

HOPF = "hopf"
"""Dimension of the Hopf points that lie on the lines between the points of a file."""
HOPF_ALONG = LINEAR_PARAMETERS
"""Parameters along which Hopf points are searched; gamma1 moves none."""
OF_PAIRS = ("none", "hopf", "hopf_reverse", "restabilization")
"""What changes where a pair crosses the imaginary axis."""
HOPF_POINTS = (
    word(
        "hopf_along",
        "parameter along which the Hopf point was searched, between the points of a line",
        HOPF_ALONG,
        HOPF,
    ),
    word(
        "hopf_kind",
        "what changes at the Hopf point as that parameter grows",
        ((CROSSING_KINDS.index(kind), kind) for kind in OF_PAIRS),
        HOPF,
    ),
    *(real(f"hopf_{name}", PARAMETERS[name].unit, f"{name} at the Hopf point", HOPF) for name in HOPF_ALONG),
    real("hopf_error", "1", "estimate of the relative error of the parameter along which was searched", HOPF),
    real("hopf_frequency", ANGULAR, "angular frequency of the pair that crosses", HOPF),
    real("hopf_frequency_error", ANGULAR, "estimate of the absolute error of hopf_frequency", HOPF),
    whole("hopf_unstable_after", "number of modes with positive growth rate beyond it; -1: not known", HOPF),
    whole("hopf_lines", "lines of points that differ in one of F, k1, k2 and gamma3, which were searched"),
    whole("hopf_lines_proved", "those of them on which it is proved that no Hopf point is missing"),
)
"""Hopf points of the straight rods between the points of a file: known before any of these is solved."""

NO_CYCLE = Increase(lambda records, before: np.isnan(records["period"]))
"""More of a cycle, which a rod that does not beat has none of."""
INCREASES = {
    "harmonics": NO_CYCLE,
    "samples": NO_CYCLE,
    "shapes": NO_CYCLE,
    "nodes": NO_CYCLE,
    "transient": ANEW,
    "time": Increase(NO_CYCLE.has, ("tau2", "tau1")),
}


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for; traces and shapes only where asked for."""
    options = config["limit_cycle"]
    variables: tuple[Variable, ...] = CYCLE
    extents = {"harmonic": options["harmonics"], "multiplier_number": STORED_MULTIPLIERS}
    if options["time"] == "tau1":
        variables += (PERIOD_TAU1,)
    if options["samples"]:
        variables += TIP + ENERGY
        extents |= {"sample": options["samples"]}
    if options["shapes"]:
        variables += SHAPE
        extents |= {"shape": options["shapes"], "u": options["nodes"]}
    if options["transient"]:
        variables += TRANSIENT
        extents |= {"transient": options["transient"]}
    return Layout(variables, extents, NONLINEAR_PARAMETERS)
