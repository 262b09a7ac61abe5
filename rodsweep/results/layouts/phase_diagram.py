"""What the file of the task phase_diagram holds: its rows, and the boundaries followed through them."""

from typing import Any

from ...model.parameters import LINEAR_PARAMETERS, PARAMETERS, all_but
from .branch import SPECIAL_KINDS
from .criticality import LANDAU, SLOPE, side
from .spectrum import UNSTABLE_COUNT
from .thresholds import CROSSINGS, search_variables
from .variables import ANEW, ANGULAR, BESIDE, MISSING, Layout, Variable, real, whole

CLASSES = (
    (-1, "missing"),
    (0, "monotone"),
    (1, "oscillatory"),
    (2, "flutter"),
    (3, "undecided"),
    (4, "crushed"),
)
"""What the rod does at a point of a phase diagram."""
BAUTIN_ENDS = ("none", "range_end", "plane_edge", "not_found", "list_full", "closed")
"""Why a curve of generalised Hopf points ends; the place in this list is what the file stores."""
CURVE_KINDS = ((0, "double"), (1, "hopf"))
"""What lies on a curve: double real eigenvalues, where oscillations set in or end, or Hopf points."""

STABLE_STATES = (
    (-1, "missing"),
    (0, "neither_known"),
    (1, "straight"),
    (2, "cycle"),
    (3, "both"),
    (4, "undecided"),
    (5, "crushed"),
)
"""Which states of the rod are stable at a point of a phase diagram with cycles."""
CYCLE_SPECIAL, MOST_SPECIAL = "cycle_special", 64
"""Dimension of the special points of a row's branches, and how many are kept."""

CYCLE_CURVE_ENDS = {
    "none": "the curve goes on",
    "edge": "it leaves the diagram",
    "crushed": "F comes within 1e-3 of k1, relative",
    "hopf": "the cycles vanish: of folds at a generalised Hopf point, Re c = 0, of torus points where two "
    "Hopf points meet",
    "left_the_model": "h1 reaches 0 somewhere on the cycle",
    "resonance": "the two multipliers meet on the real axis",
    "closed": "it comes back to its first point",
    "not_followed": "no further point was found",
}
"""Where a curve of folds of cycles or torus points ends; the place in this list is what the file stores."""

INCREASES = {"crossings": CROSSINGS, "certify": ANEW, "curves": BESIDE, "cycles": ANEW}


def plane_of(config: dict[str, Any]) -> tuple[tuple[str, str], dict[str, int]]:
    """((parameter along a row, parameter across the rows), number of values of every parameter)."""
    axes = config["parameters"]
    sizes = {name: len(axes[name].get("values", ())) or axes[name]["num"] for name in LINEAR_PARAMETERS}
    line, row = (name for name, size in sizes.items() if size > 1)
    return (line, row), sizes


def beside_points(config: dict[str, Any], is_grid: bool) -> tuple[Variable, ...]:
    """Variables of the file that all rows together give, whatever the options ask of them."""
    (line, row), _ = plane_of(config)
    variables = curve_variables(line, row) | criticality_variables(line, row)
    variables |= cycle_curve_variables(line, row)
    for third in config["phase_diagram"].get("bautin_along") or ():
        variables |= bautin_curve_variables(line, row, third)
    return tuple(variables.values())


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for: rows, each a line of values of one parameter."""
    options = config["phase_diagram"]
    (line, _), sizes = plane_of(config)
    variables: tuple[Variable, ...] = (
        Variable("class", "|i1", MISSING, "1", "what the rod does", (line,), CLASSES),
        whole("unstable_count", UNSTABLE_COUNT.long_name, line),
        *search_variables(line, "crossing_at"),
    )
    extents = {line: sizes[line], "crossing": options["crossings"]}
    if options["cycles"]:
        variables += cycle_variables(line)
        extents[CYCLE_SPECIAL] = MOST_SPECIAL
    return Layout(variables, extents, all_but(line), needs_all_points=options["curves"])


def cycle_variables(line: str) -> tuple[Variable, ...]:
    """What `phase_diagram.cycles` adds to every row: its stable states and special points of its cycles."""
    unit, kinds = PARAMETERS[line].unit, tuple(enumerate(SPECIAL_KINDS))
    what, along = "what happens on a branch of cycles there", (CYCLE_SPECIAL,)
    at, error = f"{line} at the special point", f"estimate of the absolute error of cycle_special_{line}"
    return (
        Variable("stable_states", "|i1", MISSING, "1", "which states are stable", (line,), STABLE_STATES),
        whole("cycle_special_count", "special points of the branches of the row, stored or not"),
        Variable("cycle_special_kind", "|i1", 0, "1", what, along, kinds),
        real(f"cycle_special_{line}", unit, at, CYCLE_SPECIAL),
        real("cycle_special_error", unit, error, CYCLE_SPECIAL),
        real("cycle_special_period", "tau2", "period of the cycle there", CYCLE_SPECIAL),
        real("cycle_special_tip_y_max", "L", "largest y of the tip there; 0 at a Hopf point", CYCLE_SPECIAL),
    )


def cycle_curve_variables(line: str, row: str) -> dict[str, Variable]:
    """What `phase_diagram.cycles` adds when all rows are done, by name: curves of folds and torus points."""
    along, kinds = "cycle_curve_point", tuple(enumerate(SPECIAL_KINDS))
    force = PARAMETERS[line].unit
    what, end = "what happens to the cycles on the curve: fold or torus", "why the curve ends at the point"
    error = f"estimate of the absolute error of cycle_curve_{line} on the curve"
    variables = (
        whole("cycle_curve_number", "number of the curve of special points of cycles, from 1", along),
        Variable("cycle_curve_kind", "|i1", 0, "1", what, (along,), kinds),
        real(f"cycle_curve_{line}", force, f"{line} on the curve", along),
        real(f"cycle_curve_{row}", PARAMETERS[row].unit, f"{row} on the curve", along),
        real("cycle_curve_error", force, error, along),
        real("cycle_curve_period", "tau2", "period of the cycle on the curve", along),
        real("cycle_curve_tip_y_max", "L", "largest y of the tip; 0 where the cycles vanish", along),
        Variable("cycle_curve_end", "|i1", 0, "1", end, (along,), tuple(enumerate(CYCLE_CURVE_ENDS))),
        real("cycle_curve_agreement", "1", f"largest distance of a fold or torus point of a row from its "
             f"curve, in units of the axis of {line}"),
        whole("cycle_curves_untraced", "folds and torus points of rows through which no curve was followed"),
    )  # fmt: skip
    return {variable.name: variable for variable in variables}


def curve_variables(line: str, row: str) -> dict[str, Variable]:
    """What is added to a phase diagram when all rows are done, by name: its boundaries and their folds."""
    along = (line, row)
    kind = "what lies on the curve: a double real eigenvalue, or a Hopf point"
    units, force = {name: PARAMETERS[name].unit for name in along}, PARAMETERS["F"].unit
    error = "estimate of the error of fold_"
    variables = (
        whole("curve_number", "number of the curve, from 1", "curve_point"),
        Variable("curve_kind", "|i1", 0, "1", kind, ("curve_point",), CURVE_KINDS),
        *(real(f"curve_{name}", units[name], f"{name} on the curve", "curve_point") for name in along),
        real("curve_frequency", ANGULAR, "angular frequency of the modes on the curve", "curve_point"),
        real("curve_growth_rate", "1/tau2", "growth rate of the modes on the curve", "curve_point"),
        whole("fold_curve", "number of the curve on which the fold lies", "fold"),
        Variable("fold_kind", "|i1", 0, "1", kind, ("fold",), CURVE_KINDS),
        Variable(
            "fold_of", "|i1", 0, "1", "parameter that is extremal on the curve at the fold", ("fold",),
            tuple(enumerate(along)),
        ),
        *(real(f"fold_{name}", units[name], f"{name} at the fold", "fold") for name in along),
        *(real(f"fold_{name}_error", units[name], f"{error}{name}", "fold") for name in along),
        real("fold_frequency", ANGULAR, "angular frequency of the modes at the fold", "fold"),
        real("fold_growth_rate", "1/tau2", "growth rate of the modes at the fold", "fold"),
        real("curve_agreement", "1", f"largest distance of a crossing on a row from its curve, over {line}"),
        whole("curves_untraced", "crossings on rows through which no curve could be followed"),
        real("filament_F_hopf", force, "F at which the filament (k1, k2 = inf, gamma3 = 0) flutters, Fc"),
        real("partial_beam_k1", force, "4 Fc: k1 at the fold of the partial beam (k2 = inf, gamma3 = 0)"),
        real("partial_beam_F", force, "2 Fc: F at the fold of the partial beam"),
    )  # fmt: skip
    return {variable.name: variable for variable in variables}


def criticality_variables(line: str, row: str) -> dict[str, Variable]:
    """What `phase_diagram.criticality` adds, by name: the sign of Re c on Hopf curves, and its zeros."""
    along = (line, row)
    units = {name: PARAMETERS[name].unit for name in along}
    error = "estimate of the error of bautin_"
    variables = (
        side("curve_criticality", "Re c", "curve_point"),
        real("curve_gamma1", PARAMETERS["gamma1"].unit, "axial drag of curve_criticality and bautin_*"),
        whole("bautin_curve", "number of the curve on which the generalised Hopf point lies", "bautin"),
        whole("bautin_curve_point", "curve_point, from 1, behind which it lies on the curve", "bautin"),
        *(real(f"bautin_{name}", units[name], f"{name} where Re c = 0", "bautin") for name in along),
        *(real(f"bautin_{name}_error", units[name], f"{error}{name}", "bautin") for name in along),
        real("bautin_frequency", ANGULAR, "angular frequency of the pair there", "bautin"),
        real("bautin_growth_slope_real", SLOPE, "d(growth rate)/dF of the pair there", "bautin"),
        real("bautin_growth_slope_imag", SLOPE, "d(frequency)/dF of the pair there", "bautin"),
        real("bautin_landau_imag", LANDAU, "imaginary part of the Landau coefficient c there", "bautin"),
        whole("bautin_unlocated", "changes of sign along Hopf curves whose place could not be found"),
    )
    return {variable.name: variable for variable in variables}


def bautin_curve_variables(line: str, row: str, third: str) -> dict[str, Variable]:
    """What `phase_diagram.bautin_along` adds, by name: generalised Hopf points as curves over a third one."""
    names, at = (line, row, third), "bautin_step"
    unit = {name: PARAMETERS[name].unit for name in names}
    error = "estimate of the error of bautin_along_"
    why = "at the first and last point of a curve why it ends there"
    variables = (
        whole("bautin_along_curve", "number of the curve of generalised Hopf points, from 1", at),
        *(real(f"bautin_along_{name}", unit[name], f"{name} where Re c = 0", at) for name in names),
        *(real(f"bautin_along_{name}_error", unit[name], f"{error}{name}", at) for name in names),
        real("bautin_along_frequency", ANGULAR, "angular frequency of the pair there", at),
        real("bautin_along_landau_imag", LANDAU, "imaginary part of the Landau coefficient c there", at),
        Variable("bautin_along_end", "|i1", 0, "1", why, (at,), tuple(enumerate(BAUTIN_ENDS))),
    )
    return {variable.name: variable for variable in variables}
