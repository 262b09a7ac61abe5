"""What the file of the task phase_diagram holds: its rows, and the boundaries followed through them."""

from typing import Any

from ...model.parameters import LINEAR_PARAMETERS, PARAMETERS, all_but
from .criticality import LANDAU, SLOPE
from .spectrum import UNSTABLE_COUNT
from .thresholds import CROSSINGS, search_variables
from .variables import ANEW, BESIDE, MISSING, Layout, Variable, real, whole

CLASSES = (
    (-1, "missing"),
    (0, "monotone"),
    (1, "oscillatory"),
    (2, "flutter"),
    (3, "undecided"),
    (4, "crushed"),
)
"""What the rod does at a point of a phase diagram."""
CURVE_KINDS = ((0, "double"), (1, "hopf"))
"""What lies on a curve: double real eigenvalues, where oscillations set in or end, or Hopf points."""

INCREASES = {"crossings": CROSSINGS, "certify": ANEW, "curves": BESIDE}


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for: rows, each a line of values of one parameter."""
    axes, options = config["parameters"], config["phase_diagram"]
    sizes = {name: len(axes[name].get("values", ())) or axes[name]["num"] for name in LINEAR_PARAMETERS}
    line = next(name for name, size in sizes.items() if size > 1)
    variables = (
        Variable("class", "|i1", MISSING, "1", "what the rod does", (line,), CLASSES),
        whole("unstable_count", UNSTABLE_COUNT.long_name, line),
        *search_variables(line, "crossing_at"),
    )
    extents = {line: sizes[line], "crossing": options["crossings"]}
    return Layout(variables, extents, all_but(line), needs_all_points=options["curves"])


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
        real("curve_frequency", "1/tau2", "frequency of the modes on the curve", "curve_point"),
        real("curve_growth_rate", "1/tau2", "growth rate of the modes on the curve", "curve_point"),
        whole("fold_curve", "number of the curve on which the fold lies", "fold"),
        Variable("fold_kind", "|i1", 0, "1", kind, ("fold",), CURVE_KINDS),
        Variable(
            "fold_of", "|i1", 0, "1", "parameter that is extremal on the curve at the fold", ("fold",),
            tuple(enumerate(along)),
        ),
        *(real(f"fold_{name}", units[name], f"{name} at the fold", "fold") for name in along),
        *(real(f"fold_{name}_error", units[name], f"{error}{name}", "fold") for name in along),
        real("fold_frequency", "1/tau2", "frequency of the modes at the fold", "fold"),
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
        real(
            "curve_criticality",
            "1",
            "-1: supercritical, cycles where the pair grows, stable unless other modes grow; 1: "
            "subcritical; 0: undecided within the error; NaN: no Hopf point, or no normal form there",
            "curve_point",
        ),
        real("curve_gamma1", PARAMETERS["gamma1"].unit, "axial drag of curve_criticality and bautin_*"),
        whole("bautin_curve", "number of the curve on which the generalised Hopf point lies", "bautin"),
        whole("bautin_curve_point", "curve_point, from 0, behind which it lies on the curve", "bautin"),
        *(real(f"bautin_{name}", units[name], f"{name} where Re c = 0", "bautin") for name in along),
        *(real(f"bautin_{name}_error", units[name], f"{error}{name}", "bautin") for name in along),
        real("bautin_frequency", "1/tau2", "frequency of the pair there", "bautin"),
        real("bautin_growth_slope_real", SLOPE, "d(growth rate)/dF of the pair there", "bautin"),
        real("bautin_growth_slope_imag", SLOPE, "d(frequency)/dF of the pair there", "bautin"),
        real("bautin_landau_imag", LANDAU, "imaginary part of the Landau coefficient c there", "bautin"),
        whole("bautin_unlocated", "changes of sign along Hopf curves whose place could not be found"),
    )
    return {variable.name: variable for variable in variables}
