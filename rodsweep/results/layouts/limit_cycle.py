"""Layout of the task limit_cycle: the cycle at each point, and Hopf points located between neighbouring
points."""

from collections.abc import Collection
from typing import Any

import numpy as np

from ...model.parameters import (
    NON_OPTIONAL_LINEAR_PARAMETER_NAMES,
    NONLINEAR_ROD_PARAMETER_NAMES,
    PARAMETERS,
    TRANSVERSE_PARAMETER_NAMES,
)
from .rod_properties import has_uniform_linear_rods, optional_parameters_in, with_long_name
from .thresholds import CROSSING_KINDS
from .variables import (
    ANGULAR_UNIT,
    MESH_VARIABLES,
    NEW_SOLVE_RULE,
    SECONDS_VARIABLE,
    STATUS_VARIABLE,
    UNKNOWN_COUNT_LONG_NAME_SUFFIX,
    Layout,
    ReuseRule,
    Variable,
    along_dimension,
    integer_variable,
    real_variable,
    word_variable,
)

LEAST_STRETCH_VARIABLE = real_variable(
    "least_stretch",
    "1",
    "smallest stretch h1 over a period at the nodes and times of the solution, and where it is 0.2 or "
    "less also between them; the model holds while it is positive",
)
POWER_UNIT = "k3/(L tau2)"
"""Dimensionless unit of a power."""
STORED_MULTIPLIER_COUNT = 6
"""Number of stored nontrivial Floquet multipliers, the solver's `MULTIPLIER_LIST_SETTINGS.length`; NaN stands
for a missing multiplier, or for a modulus below `MULTIPLIER_LIST_SETTINGS.min_modulus`."""
STATUS_NAMES_WITH_CYCLE = ("cycle", "unstable")
"""Names of the statuses of points with a limit cycle, stable or unstable."""
SECOND_STABLE_STATES = ((-1, "not_known"), (0, "none_known"), (1, "straight"), (2, "cycle_possible"))
"""(stored number, word) for each second stable state of the rod, besides the state that the solve reached."""
CYCLE_VARIABLES = (
    real_variable("period", "tau2", "period of the limit cycle"),
    real_variable("frequency", ANGULAR_UNIT, "angular frequency of the limit cycle, 2 pi/period"),
    real_variable("linear_growth_rate", "1/tau2", "real part of the leading eigenvalue of the straight rod"),
    real_variable(
        "linear_frequency",
        ANGULAR_UNIT,
        "angular frequency of the leading mode of the straight rod, imaginary part of the eigenvalue",
    ),
    word_variable(
        "second_state",
        "second stable state, besides the state in which the point ended; straight: the straight rod is "
        "stable as well; cycle_possible: the straight rod is stable, and the Hopf point at subcritical_F is "
        "subcritical",
        SECOND_STABLE_STATES,
    ),
    real_variable(
        "subcritical_F", "k3/L^2", "force of the subcritical Hopf point whose unstable cycles exist at F"
    ),
    real_variable("tip_x_min", "L", "smallest x of the tip over a period"),
    real_variable("tip_x_max", "L", "largest x of the tip over a period"),
    real_variable("tip_y_max", "L", "largest deflection y of the tip over a period"),
    real_variable("tip_theta_max", "rad", "largest |theta|, theta: the angle of the tip, over a period"),
    real_variable("period_error", "1", "estimate of the relative error of period"),
    real_variable("amplitude_error", "1", "estimate of the relative error of tip_y_max"),
    real_variable(
        "extrema_error", "1", "estimate of the error of the tip's other extrema, in units of tip_y_max"
    ),
    real_variable("harmonic_amplitude", "L", "amplitude of a harmonic of the tip's deflection y", "harmonic"),
    real_variable("injection_mean", POWER_UNIT, "power of the follower force, mean over a period"),
    real_variable(
        "injection_rms", POWER_UNIT, "power of the follower force, root mean square of its fluctuation"
    ),
    real_variable("dissipation_mean", POWER_UNIT, "power lost to the fluid, mean over a period"),
    real_variable(
        "dissipation_rms", POWER_UNIT, "power lost to the fluid, root mean square of its fluctuation"
    ),
    real_variable(
        "energy_imbalance", "1", "relative difference of energy injected and dissipated over a period"
    ),
    real_variable("multiplier", "1", "modulus of the largest nontrivial Floquet multiplier"),
    real_variable("multiplier_error", "1", "estimate of the absolute error of multiplier"),
    real_variable("trivial_multiplier_error", "1", "distance of the trivial Floquet multiplier from 1"),
    *along_dimension(
        "multiplier_number",
        real_variable(
            "multiplier_real", "1", "real part of a nontrivial Floquet multiplier, by descending modulus"
        ),
        real_variable("multiplier_imag", "1", "imaginary part of a nontrivial Floquet multiplier"),
    ),
    real_variable(
        "modulation_ratio",
        "1",
        "frequency of the modulation of a motion on a torus, divided by the frequency of its oscillation; "
        "from the integrated motion, to about three digits",
    ),
    LEAST_STRETCH_VARIABLE,
    integer_variable("periods", "number of returns to the Poincare section during the time integration"),
    *MESH_VARIABLES,
    SECONDS_VARIABLE,
    STATUS_VARIABLE,
)
PERIOD_TAU1_VARIABLE = real_variable(
    "period_tau1", "tau1", "period of the limit cycle in units of tau1: period k2/gamma3"
)
TIP_UNITS = {"x": "L", "y": "L", "theta": "rad"}
"""Units of the position and the angle of the tip."""
TIP_VARIABLES = tuple(
    real_variable(f"tip_{n}", unit, f"{n} of the tip", "sample") for n, unit in TIP_UNITS.items()
)
ENERGY_VARIABLES = (
    real_variable("energy", "k3/L", "elastic energy", "sample"),
    real_variable("injection", POWER_UNIT, "power of the follower force", "sample"),
    real_variable("dissipation", POWER_UNIT, "power lost to the fluid", "sample"),
)
SHAPE_VARIABLES = tuple(
    real_variable(f"shape_{name}", units, f"{name} along the rod", "shape", "u")
    for name, units in TIP_UNITS.items()
)
TRANSIENT_VARIABLES = along_dimension(
    "transient",
    real_variable("transient_time", "tau2", "time since the start of the motion"),
    *(
        real_variable(f"transient_{n}", unit, f"{n} of the tip during the transient")
        for n, unit in TIP_UNITS.items()
    ),
)
HOPF_DIMENSION = "hopf"
"""Name of the dimension of the Hopf points that were found along lines of points; the points of a line differ
in one parameter only."""
HOPF_CROSSING_KINDS = ("none", "hopf", "hopf_reverse", "restabilization")
"""Names of the kinds of crossings at which a pair of eigenvalues crosses the imaginary axis."""


def hopf_point_variables(names: Collection[str]) -> tuple[Variable, ...]:
    """Variables of the Hopf points of the straight rod between neighbouring points of a line, that is, of
    points that differ in one parameter only. names: parameters of the file; for each Hopf point the
    parameters on which transverse motion depends are stored."""
    place_clause = "at the Hopf point"
    parameters = [PARAMETERS[name] for name in TRANSVERSE_PARAMETER_NAMES if name in names]
    kinds = ((CROSSING_KINDS.index(kind), kind) for kind in HOPF_CROSSING_KINDS)
    return (
        *along_dimension(
            HOPF_DIMENSION,
            word_variable(
                "hopf_along",
                "parameter along which the Hopf point was found, between points of a line",
                TRANSVERSE_PARAMETER_NAMES,
            ),
            word_variable(
                "hopf_kind", f"change of stability {place_clause} as the parameter hopf_along grows", kinds
            ),
            *(real_variable(f"hopf_{p.name}", p.unit, f"{p.name} {place_clause}") for p in parameters),
            real_variable(
                "hopf_error",
                "1",
                "estimate of the relative error of the parameter hopf_along at the Hopf point",
            ),
            real_variable("hopf_frequency", ANGULAR_UNIT, "angular frequency of the pair that crosses"),
            real_variable(
                "hopf_frequency_error", ANGULAR_UNIT, "estimate of the absolute error of hopf_frequency"
            ),
            integer_variable(
                "hopf_unstable_after",
                "number of modes with positive growth rate beyond the Hopf point"
                f"{UNKNOWN_COUNT_LONG_NAME_SUFFIX}",
            ),
        ),
        integer_variable(
            "hopf_lines",
            "number of searched lines of points, which differ in one parameter of the straight rod",
        ),
        integer_variable(
            "hopf_lines_proved", "number of searched lines whose list of Hopf points is proved complete"
        ),
    )


NEW_SOLVE_OF_CYCLES_RULE = ReuseRule(lambda records, before: np.isnan(records["period"]))
"""Rule for the options that set the stored data of a cycle: after an increase, every point with a cycle is
solved again."""
REUSE_RULES_OF_INCREASED_OPTIONS = {
    **dict.fromkeys(("harmonics", "samples", "shapes", "nodes"), NEW_SOLVE_OF_CYCLES_RULE),
    "transient": NEW_SOLVE_RULE,
    "time": ReuseRule(NEW_SOLVE_OF_CYCLES_RULE.has_additional_data, ("tau2", "tau1")),
}


def sweep_wide_variables(config: dict[str, Any], is_grid: bool) -> tuple[Variable, ...]:
    """Variables of the Hopf points that are found along all lines of points of the file, for a resolved
    config; the points of a line differ in one parameter only. is_grid: not used."""
    variables = hopf_point_variables((*NON_OPTIONAL_LINEAR_PARAMETER_NAMES, *optional_parameters_in(config)))
    if has_uniform_linear_rods(config):
        return variables
    meaning = "number of searched lines whose list of Hopf points is confirmed by counts of unstable modes"
    return with_long_name(variables, "hopf_lines_proved", meaning)


def layout(config: dict[str, Any]) -> Layout:
    """Layout of the result file of the task limit_cycle, for a resolved config; time series and shapes only
    if the config asks for them."""
    options = config["limit_cycle"]
    variables: tuple[Variable, ...] = CYCLE_VARIABLES
    extents = {"harmonic": options["harmonics"], "multiplier_number": STORED_MULTIPLIER_COUNT}
    if options["time"] == "tau1":
        variables += (PERIOD_TAU1_VARIABLE,)
    if options["samples"]:
        variables += TIP_VARIABLES + ENERGY_VARIABLES
        extents |= {"sample": options["samples"]}
    if options["shapes"]:
        variables += SHAPE_VARIABLES
        extents |= {"shape": options["shapes"], "u": options["nodes"]}
    if options["transient"]:
        variables += TRANSIENT_VARIABLES
        extents |= {"transient": options["transient"]}
    return Layout(variables, extents, NONLINEAR_ROD_PARAMETER_NAMES)
