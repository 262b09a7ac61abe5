"""What the file of each task holds: its variables, and `layout_of`, which finds them from a config."""

from typing import Any

from .limit_cycle import limit_cycle_layout
from .variables import MESH, MISSING, PARAMETER_NAMES, SECONDS, STATUS, Layout, Variable, real, whole

CROSSING_KINDS = (
    "none",
    "onset",
    "hopf",
    "hopf_reverse",
    "restabilization",
    "real_again",
    "real_leads",
    "pair_leads",
)
"""What happens at a crossing; the place in this list is what the file stores."""
CLASSES = (
    (-1, "missing"),
    (0, "monotone"),
    (1, "oscillatory"),
    (2, "flutter"),
    (3, "undecided"),
    (4, "crushed"),
)
"""What the rod does at a point of a phase diagram."""


def complex_pair(name: str, units: str, long_name: str) -> tuple[Variable, Variable]:
    """Real and imaginary part of a field of every mode."""
    return (
        real(f"{name}_real", units, f"real part of {long_name}", "mode", "u"),
        real(f"{name}_imag", units, f"imaginary part of {long_name}", "mode", "u"),
    )


UNSTABLE_COUNT = whole("unstable_count", "number of modes with positive growth rate; -1: not known")
EACH_MODE = (
    real("growth_rate", "1/tau2", "real part of the transverse eigenvalue", "mode"),
    real("frequency", "1/tau2", "imaginary part of the transverse eigenvalue", "mode"),
    real(
        "error_estimate",
        "1/tau2",
        "modulus of the Newton correction D/D' of the characteristic determinant at the eigenvalue",
        "mode",
    ),
)
EACH_POINT = (
    UNSTABLE_COUNT,
    Variable(
        "certified", "|i1", 0, "1", "1 where the winding number of D proves that no leading mode is missing"
    ),
    *MESH,
    SECONDS,
    STATUS,
)
VECTORS = (
    *complex_pair("Y", "1", "the eigenmode's deflection, scaled to Y(1) = 1"),
    *complex_pair("Theta", "1", "the eigenmode's angle, scaled as Y"),
)


def spectrum_layout(modes: int, vector_nodes: int) -> Layout:
    """The layout of the task spectrum; vectors only where vector_nodes > 0."""
    vectors = VECTORS if vector_nodes else ()
    extents = {"mode": modes} | ({"u": vector_nodes} if vector_nodes else {})
    return Layout(EACH_MODE + vectors + EACH_POINT, extents)


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


def modes_layout(modes: int, nodes: int, growth: bool) -> Layout:
    """The layout of the task modes."""
    variables = (*EACH_MODE, *MODE_FIELDS, *MODE_NUMBERS, *(GROWTH if growth else ()), *EACH_POINT)
    return Layout(variables, {"mode": modes, "u": nodes})


def crossings(at: str, units: str, what: str) -> tuple[Variable, ...]:
    """The crossings met along a line; `at` names the variable that says where, and `what` the quantity."""
    kinds = tuple(enumerate(CROSSING_KINDS))
    return (
        whole("crossing_count", "number of crossings found, stored or not"),
        real(at, units, f"{what} at the crossing", "crossing"),
        Variable("crossing_kind", "|i1", 0, "1", "what changes at the crossing", ("crossing",), kinds),
        real("crossing_frequency", "1/tau2", "frequency of the modes that cross", "crossing"),
        real("crossing_growth_rate", "1/tau2", "growth rate of the modes that cross", "crossing"),
        real("crossing_error", units, f"estimate of the absolute error of {at}", "crossing"),
        whole("unstable_after", "number of modes with positive growth rate beyond the crossing", "crossing"),
    )


def searched(units: str, what: str) -> tuple[Variable, ...]:
    """How far the search along a line can be trusted, and what it cost."""
    undecided = f"of a range of {what} in which it is undecided whether a window opens and closes"
    return (
        real("open_from", units, f"start {undecided}"),
        real("open_to", units, f"end {undecided}"),
        Variable("certified", "|i1", 0, "1", "1 where it is proved that no crossing is missing"),
        whole("boxes", "evaluations of D over a box"),
        whole("solves", "eigenproblems solved"),
        SECONDS,
        STATUS,
    )


FORCE = PARAMETER_NAMES["F"][0]
THRESHOLDS = (
    real("F_onset", FORCE, "smallest F at which two real leading eigenvalues meet and become a pair"),
    real("onset_growth_rate", "1/tau2", "growth rate of the double eigenvalue at F_onset"),
    real("F_hopf", FORCE, "smallest F at which a pair becomes unstable"),
    real("hopf_frequency", "1/tau2", "frequency of the pair at F_hopf"),
    real("F_restabilization", FORCE, "smallest F at which the last unstable pair becomes stable again"),
    real("restabilization_frequency", "1/tau2", "frequency of the pair at F_restabilization"),
    real("F_end", FORCE, "F up to which was searched"),
    whole("unstable_at_end", "number of modes with positive growth rate at F_end; -1: not known"),
)


def thresholds_layout(most: int) -> Layout:
    """The layout of the task thresholds, for at most `most` crossings of a point."""
    variables = THRESHOLDS + crossings("crossing_F", FORCE, "F") + searched(FORCE, "F")
    return Layout(variables, {"crossing": most}, ("k1", "k2", "gamma3"))


def phase_diagram_layout(line: str, extent: int, most: int) -> Layout:
    """The layout of the task phase_diagram: rows, each a line of `extent` values of the parameter `line`."""
    units = PARAMETER_NAMES[line][0]
    variables = (
        Variable("class", "|i1", MISSING, "1", "what the rod does", (line,), CLASSES),
        whole("unstable_count", UNSTABLE_COUNT.long_name, line),
        *crossings("crossing_at", units, line),
        *searched(units, line),
    )
    rows = tuple(name for name in PARAMETER_NAMES if name != line)
    return Layout(variables, {line: extent, "crossing": most}, rows)


CURVE_KINDS = ((0, "double"), (1, "hopf"))
"""What lies on a curve: double real eigenvalues, where oscillations set in or end, or Hopf points."""


def curve_variables(line: str, row: str) -> dict[str, Variable]:
    """What is added to a phase diagram when all rows are done, by name: its boundaries and their folds."""
    along = (line, row)
    kind = "what lies on the curve: a double real eigenvalue, or a Hopf point"
    variables = (
        whole("curve_number", "number of the curve, from 1", "curve_point"),
        Variable("curve_kind", "|i1", 0, "1", kind, ("curve_point",), CURVE_KINDS),
        *(real(f"curve_{n}", PARAMETER_NAMES[n][0], f"{n} on the curve", "curve_point") for n in along),
        real("curve_frequency", "1/tau2", "frequency of the modes on the curve", "curve_point"),
        real("curve_growth_rate", "1/tau2", "growth rate of the modes on the curve", "curve_point"),
        whole("fold_curve", "number of the curve on which the fold lies", "fold"),
        Variable("fold_kind", "|i1", 0, "1", kind, ("fold",), CURVE_KINDS),
        Variable(
            "fold_of", "|i1", 0, "1", "parameter that is extremal on the curve at the fold", ("fold",),
            tuple(enumerate(along)),
        ),
        *(real(f"fold_{n}", PARAMETER_NAMES[n][0], f"{n} at the fold", "fold") for n in along),
        *(
            real(f"fold_{n}_error", PARAMETER_NAMES[n][0], f"estimate of the error of fold_{n}", "fold")
            for n in along
        ),
        real("fold_frequency", "1/tau2", "frequency of the modes at the fold", "fold"),
        real("fold_growth_rate", "1/tau2", "growth rate of the modes at the fold", "fold"),
        real("curve_agreement", "1", f"largest distance of a crossing on a row from its curve, over {line}"),
        whole("curves_untraced", "crossings on rows through which no curve could be followed"),
        real("filament_F_hopf", FORCE, "F at which the filament (k1, k2 = inf, gamma3 = 0) flutters, Fc"),
        real("partial_beam_k1", FORCE, "4 Fc: k1 at the fold of the partial beam (k2 = inf, gamma3 = 0)"),
        real("partial_beam_F", FORCE, "2 Fc: F at the fold of the partial beam"),
    )  # fmt: skip
    return {variable.name: variable for variable in variables}


def layout_of(config: dict[str, Any]) -> Layout:
    """The layout that the resolved config of any task asks for."""
    task = config["task"]
    options = config[task]
    if task == "spectrum":
        return spectrum_layout(options["modes"], options["nodes"] if options["vectors"] else 0)
    if task == "modes":
        return modes_layout(options["modes"], options["nodes"], options["growth"])
    if task == "thresholds":
        return thresholds_layout(options["crossings"])
    if task == "phase_diagram":
        axes = config["parameters"]
        sizes = {n: len(axes[n].get("values", ())) or axes[n]["num"] for n in PARAMETER_NAMES}
        line = next(name for name, size in sizes.items() if size > 1)
        return phase_diagram_layout(line, sizes[line], options["crossings"])
    if task == "limit_cycle":
        return limit_cycle_layout(options)
    raise KeyError(f"unknown task {task}")
