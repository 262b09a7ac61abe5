"""Layout of the task phase_diagram: rows (lines of constant second parameter), and stability boundaries that
are followed from row to row."""

from typing import Any

from ...model.parameters import PARAMETERS, TRANSVERSE_PARAMETER_NAMES, parameter_names_except
from .bautin_points import bautin_curve_variables, criticality_variables
from .branch import SPECIAL_KINDS, followed_range_variables
from .detached_branches import DETACHED_ROW_VARIABLE, DETACHED_ROW_VARIABLES_BY_NAME, LOST_CURVE_ENDS_VARIABLE
from .fold_curve_extrema import UNLOCATED_EXTREMA_VARIABLE, fold_curve_extremum_variables
from .rod_properties import with_certified_long_name
from .spectrum import UNSTABLE_COUNT_VARIABLE
from .thresholds import CROSSING_LIST_REUSE_RULE, search_variables
from .variables import (
    ANGULAR_UNIT,
    NEW_SOLVE_RULE,
    NO_NEW_SOLVE_RULE,
    Layout,
    Variable,
    along_dimension,
    curve_end_variables,
    integer_variable,
    real_variable,
    word_variable,
)

STABILITY_CLASS_NAMES = ("monotone", "oscillatory", "flutter", "undecided", "crushed")
STABILITY_CLASSES = ((-1, "missing"), *enumerate(STABILITY_CLASS_NAMES))
"""(stored number, word) for each behaviour of the straight rod at a point of a phase diagram."""
BOUNDARY_CURVE_END_REASONS = {
    "none": "not an end of the curve",
    "edge": "the curve leaves the diagram",
    "crushed": "the rod is crushed beyond",
    "closed": "the curve returns to its first point",
    "not_followed": "no further point was found",
    "list_full": "the curve has the maximum number of points",
}
"""Meaning of every reason why a boundary curve ends. Keys: names of the reasons; the file stores the position
of the name in this table, from 0."""
BOUNDARY_CURVE_KINDS = ((0, "double"), (1, "hopf"))
"""(stored number, word) for boundary curves: of double real eigenvalues, where oscillations set in or end, or
of Hopf points."""
STABLE_STATE_NAMES = ("neither_known", "straight", "cycle", "both", "undecided", "crushed")
STABLE_STATES = ((-1, "missing"), *enumerate(STABLE_STATE_NAMES))
"""(stored number, word) for each set of stable states of the rod at a point of a phase diagram with
cycles."""
CYCLE_SPECIAL_DIMENSION = "cycle_special"
"""Name of the dimension of the special points on the branches of cycles of one row, that is, of one value of
the second parameter."""
MAX_CYCLE_SPECIAL_POINTS = 64
"""Maximum number of special points stored for one row of the diagram; the variable cycle_special_count
contains the number of all special points."""
CYCLE_CURVE_END_REASONS = {
    "none": "not an end of the curve",
    "edge": "the curve leaves the diagram",
    "crushed": "F comes within a relative distance of 1e-3 of k1",
    "hopf": "the amplitude of the cycles vanishes: for folds at a generalised Hopf point, Re c = 0; for "
    "torus points where two Hopf points meet",
    "left_the_model": "h1 reaches 0 somewhere on the cycle",
    "resonance": "the two multipliers meet on the real axis",
    "closed": "the curve returns to its first point",
    "not_followed": "no further point was found",
}
"""Meaning of every reason why a curve of folds of cycles, or of torus points, ends. Keys: names of the
reasons; the file stores the position of the name in this table, from 0."""
REUSE_RULES_OF_INCREASED_OPTIONS = dict.fromkeys(("certify", "cycles"), NEW_SOLVE_RULE) | {
    "crossings": CROSSING_LIST_REUSE_RULE,
    "curves": NO_NEW_SOLVE_RULE,
}


def plane_and_value_counts(config: dict[str, Any]) -> tuple[tuple[str, str], dict[str, int]]:
    """Returns ((line parameter, row parameter), number of values of each by name) for a resolved config. The
    line parameter varies along each row of the diagram; the row parameter differs between rows."""
    axes = config["parameters"]
    names = (name for name in TRANSVERSE_PARAMETER_NAMES if name in axes)
    value_counts = {name: len(axes[name].get("values", ())) or axes[name]["num"] for name in names}
    line_parameter, row_parameter = (name for name, size in value_counts.items() if size > 1)
    return (line_parameter, row_parameter), value_counts


def sweep_wide_variables(config: dict[str, Any], is_grid: bool) -> tuple[Variable, ...]:
    """Variables computed from all rows of a phase diagram together: all variables of curves and of
    criticality, even if the config does not request them, and variables of Bautin curves along the parameters
    in `phase_diagram.bautin_along`. is_grid: not used."""
    (line, row), _ = plane_and_value_counts(config)
    variables = boundary_curve_variables(line, row) | criticality_variables(line, row)
    variables |= fold_curve_extremum_variables(line, row)
    variables |= {
        variable.name: variable for variable in (UNLOCATED_EXTREMA_VARIABLE, LOST_CURVE_ENDS_VARIABLE)
    }
    variables |= cycle_curve_variables(line, row) | DETACHED_ROW_VARIABLES_BY_NAME
    for third in config["phase_diagram"].get("bautin_along") or ():
        variables |= bautin_curve_variables(line, row, third)
    return tuple(variables.values())


def layout(config: dict[str, Any]) -> Layout:
    """Layout of the result file of the task phase_diagram, for a resolved config. Each point is a row, that
    is, a line of values of one parameter."""
    options = config["phase_diagram"]
    (line, _), sizes = plane_and_value_counts(config)
    variables: tuple[Variable, ...] = (
        word_variable("class", "behaviour of the rod", STABILITY_CLASSES, line),
        integer_variable("unstable_count", UNSTABLE_COUNT_VARIABLE.long_name, line),
        *search_variables(line, "crossing_at"),
    )
    extents = {line: sizes[line], "crossing": options["crossings"]}
    if options["cycles"]:
        variables += cycle_row_variables(line)
        extents[CYCLE_SPECIAL_DIMENSION] = MAX_CYCLE_SPECIAL_POINTS
    variables = with_certified_long_name(variables, config, "crossings")
    changed = DETACHED_ROW_VARIABLE if options["cycles"] else ""
    return Layout(variables, extents, parameter_names_except(line), (), options["curves"], changed)


def cycle_row_variables(line_parameter: str) -> tuple[Variable, ...]:
    """Variables of one row of the diagram for `phase_diagram.cycles`: stable states, and special points of
    branches of cycles. line_parameter: name of the parameter that varies along a row."""
    unit = PARAMETERS[line_parameter].unit
    place_clause = "at the special point"
    absolute_error_meaning = "estimate of the absolute error of cycle_special_"
    relative_error_meaning = "estimate of the relative error of cycle_special_"
    return (
        word_variable("stable_states", "stable states of the rod", STABLE_STATES, line_parameter),
        integer_variable(
            "cycle_special_count", "number of special points of the branches of the row, stored or not"
        ),
        *followed_range_variables(line_parameter, "cycle_"),
        *along_dimension(
            CYCLE_SPECIAL_DIMENSION,
            word_variable("cycle_special_kind", "kind of the special point of a branch", SPECIAL_KINDS),
            real_variable(f"cycle_special_{line_parameter}", unit, f"{line_parameter} {place_clause}"),
            real_variable("cycle_special_error", unit, f"{absolute_error_meaning}{line_parameter}"),
            real_variable("cycle_special_period", "tau2", f"period of the cycle {place_clause}"),
            real_variable(
                "cycle_special_tip_y_max", "L", f"largest y of the tip {place_clause}; 0 at a Hopf point"
            ),
            real_variable("cycle_special_period_error", "1", f"{relative_error_meaning}period"),
            real_variable("cycle_special_tip_y_max_error", "1", f"{relative_error_meaning}tip_y_max"),
        ),
    )


def cycle_curve_variables(line_parameter: str, row_parameter: str) -> dict[str, Variable]:
    """Variables, by name, of the curves of folds of cycles and torus points, for `phase_diagram.cycles`.
    line_parameter, row_parameter: names of the parameters that vary along the rows of the diagram and from
    row to row."""
    units = {name: PARAMETERS[name].unit for name in (line_parameter, row_parameter)}
    unit = units[line_parameter]
    kind_meaning = "kind of the special points on the curve, fold or torus"
    error_meaning = f"estimate of the absolute error of cycle_curve_{line_parameter} on the curve"
    agreement_meaning = (
        f"largest distance of a fold or torus point of a row from its curve along {line_parameter}, as a "
        f"fraction of the range of {line_parameter}"
    )
    variables = (
        *along_dimension(
            "cycle_curve_point",
            integer_variable("cycle_curve_number", "number of the curve of special points of cycles, from 1"),
            word_variable("cycle_curve_kind", kind_meaning, SPECIAL_KINDS),
            *(real_variable(f"cycle_curve_{name}", units[name], f"{name} on the curve") for name in units),
            real_variable("cycle_curve_error", unit, error_meaning),
            real_variable("cycle_curve_period", "tau2", "period of the cycle on the curve"),
            real_variable(
                "cycle_curve_tip_y_max", "L", "largest y of the tip; 0 where the amplitude vanishes"
            ),
            *curve_end_variables("cycle_curve", CYCLE_CURVE_END_REASONS),
        ),
        real_variable("cycle_curve_agreement", "1", agreement_meaning),
        integer_variable("cycle_curves_untraced", "number of folds and torus points of rows without a curve"),
    )
    return {variable.name: variable for variable in variables}


def boundary_curve_variables(line_parameter: str, row_parameter: str) -> dict[str, Variable]:
    """Variables, by name, of the boundary curves of a phase diagram, their folds, their agreement with the
    rows, and reference values of filament and partial beam. line_parameter, row_parameter: names of the
    parameters that vary along the rows and from row to row."""
    kind_meaning = "kind of the points on the curve, double real eigenvalues or Hopf points"
    fold_parameter_meaning = "parameter that reverses its direction along the curve at the fold"
    filament_meaning = "Fc: F at which the filament (k1, k2 = inf, gamma3 = 0) flutters"
    beam_meaning = "4 Fc: k1 at the fold of the partial beam (k2 = inf, gamma3 = 0)"
    units = {name: PARAMETERS[name].unit for name in (line_parameter, row_parameter)}
    force = PARAMETERS["F"].unit
    error_meaning = "estimate of the error of fold_"
    agreement_meaning = (
        f"largest distance of a crossing from its curve along {line_parameter}, as a fraction of the range "
        f"of {line_parameter}"
    )
    variables = (
        *along_dimension(
            "curve_point",
            integer_variable("curve_number", "number of the curve, from 1"),
            word_variable("curve_kind", kind_meaning, BOUNDARY_CURVE_KINDS),
            *(real_variable(f"curve_{name}", units[name], f"{name} on the curve") for name in units),
            real_variable("curve_frequency", ANGULAR_UNIT, "angular frequency of the modes on the curve"),
            real_variable("curve_growth_rate", "1/tau2", "growth rate of the modes on the curve"),
            *curve_end_variables("curve", BOUNDARY_CURVE_END_REASONS),
        ),
        *along_dimension(
            "fold",
            integer_variable("fold_curve", "number of the curve on which the fold lies"),
            word_variable("fold_kind", kind_meaning, BOUNDARY_CURVE_KINDS),
            word_variable("fold_of", fold_parameter_meaning, units),
            *(real_variable(f"fold_{name}", units[name], f"{name} at the fold") for name in units),
            *(real_variable(f"fold_{name}_error", units[name], f"{error_meaning}{name}") for name in units),
            real_variable("fold_frequency", ANGULAR_UNIT, "angular frequency of the modes at the fold"),
            real_variable("fold_growth_rate", "1/tau2", "growth rate of the modes at the fold"),
        ),
        real_variable("curve_agreement", "1", agreement_meaning),
        integer_variable("curves_untraced", "number of crossings on rows without a curve"),
        real_variable("filament_F_hopf", force, filament_meaning),
        real_variable("partial_beam_k1", force, beam_meaning),
        real_variable("partial_beam_F", force, "2 Fc: F at the fold of the partial beam"),
    )
    return {variable.name: variable for variable in variables}
