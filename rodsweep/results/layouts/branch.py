"""Layout of the task branch: the cycles of all branches of a rod, and their special points."""

from typing import Any

from ...model.parameters import NONLINEAR_ROD_PARAMETER_NAMES, PARAMETERS, parameter_names_except
from .limit_cycle import LEAST_STRETCH_VARIABLE
from .rod_properties import with_certified_long_name
from .variables import (
    NEW_SOLVE_RULE,
    SECONDS_VARIABLE,
    STATUS_VARIABLE,
    Layout,
    ReuseRule,
    Variable,
    along_dimension,
    boolean_variable,
    integer_variable,
    real_variable,
    word_variable,
)

CYCLE_DIMENSION = "branch_point"
"""Name of the dimension of the cycles of all branches."""
SPECIAL_DIMENSION = "special"
"""Name of the dimension of the special points of all branches."""
SPECIAL_POINT_MEANINGS = {
    "none": "unused entry: the list is longer than the number of special points",
    "hopf": "Hopf point: a branch of cycles begins or ends at the straight rod",
    "fold": "the branch turns back in the parameter; a multiplier is 1",
    "torus": "a complex pair of multipliers crosses the unit circle; a motion with two frequencies begins",
    "symmetry_breaking": "a multiplier is 1; a branch of cycles without the mirror symmetry begins or ends",
    "left_the_model": "h1 reaches 0 somewhere on the cycle, where the model ends",
    "end": "the branch ends here for the reason in special_reason",
    "period_doubling": "a multiplier of a cycle without the symmetry is -1; cycles of twice the period begin",
}
"""Meaning of every kind of special point. Keys: names of the kinds; the file stores the position of the name
in this table, from 0."""
SPECIAL_KINDS = tuple(SPECIAL_POINT_MEANINGS)
"""Names of the kinds of special points, in the order of their stored numbers."""
END_REASONS = ("none", "range_end", "crushed", "no_cycle_found", "list_full")
"""Names of the reasons why a branch ends at a special point of the kind `end`, in the order of their stored
numbers."""
ERROR_VARIABLES = (
    ("period_error", "the relative error of period"),
    ("amplitude_error", "the relative error of tip_y_max"),
    ("extrema_error", "the error of the tip's other extrema, in units of tip_y_max"),
    ("multiplier_error", "the absolute error of multiplier"),
)
"""(name of a variable with an error estimate of a cycle, its meaning); errors at a fixed parameter value."""


def branch_cycle_variables(parameter_name: str) -> tuple[Variable, ...]:
    """Variables of the cycles on all branches, branch by branch. parameter_name: parameter along which the
    branches are followed."""
    unit = PARAMETERS[parameter_name].unit
    return along_dimension(
        CYCLE_DIMENSION,
        integer_variable("branch", "number of the branch, from 1"),
        real_variable(f"branch_{parameter_name}", unit, f"{parameter_name} of the cycle"),
        real_variable(
            f"branch_{parameter_name}_error",
            "1",
            f"estimate of the relative error of branch_{parameter_name}, for a fixed deflection at t = 0",
        ),
        real_variable("period", "tau2", "period of the cycle"),
        real_variable("tip_y_max", "L", "largest y of the tip"),
        real_variable(
            "tip_y_min", "L", "smallest y of the tip; -tip_y_max for a cycle with the mirror symmetry"
        ),
        real_variable("tip_x_min", "L", "smallest x of the tip"),
        real_variable("tip_x_max", "L", "largest x of the tip"),
        real_variable("tip_theta_max", "rad", "largest |theta|, theta: the angle of the tip, over a period"),
        LEAST_STRETCH_VARIABLE,
        real_variable("multiplier", "1", "modulus of the largest nontrivial Floquet multiplier"),
        integer_variable(
            "unstable_multipliers",
            "number of nontrivial Floquet multipliers outside the unit circle; 0: stable; -1: undecided "
            "within error",
        ),
        *(
            real_variable(name, "1", f"estimate of {error_noun}, at branch_{parameter_name}")
            for name, error_noun in ERROR_VARIABLES
        ),
    )


def followed_range_variables(parameter_name: str, prefix: str = "") -> tuple[Variable, Variable]:
    """Variables of the range of the parameter `parameter_name` in which branches are followed. prefix:
    beginning of the variables' names."""
    unit = PARAMETERS[parameter_name].unit
    words = f"{parameter_name} up to which branches are followed beyond the range, if they may enter it again"
    return (
        real_variable(f"{prefix}followed_from", unit, f"smallest {words}"),
        real_variable(f"{prefix}followed_to", unit, f"largest {words}"),
    )


def special_point_variables(parameter_name: str) -> tuple[Variable, ...]:
    """Variables of the special points on all branches. parameter_name: name of the followed parameter."""
    unit = PARAMETERS[parameter_name].unit
    return along_dimension(
        SPECIAL_DIMENSION,
        word_variable("special_kind", "kind of the special point", SPECIAL_KINDS),
        real_variable("special_at", unit, f"{parameter_name} at the special point"),
        real_variable("special_error", unit, "estimate of the absolute error of special_at"),
        real_variable("special_period", "tau2", "period of the cycle at the special point"),
        real_variable(
            "special_tip_y_max", "L", "largest y of the tip at the special point; 0 at a Hopf point"
        ),
        real_variable(
            "special_amplitude_coefficient",
            "L",
            "coefficient a of a Hopf point: the largest y of its cycles is |a| sqrt("
            f"|{parameter_name}/special_at - 1|) to leading order; a < 0: the cycles are at smaller "
            f"{parameter_name}",
        ),
        *(
            real_variable(f"special_{name}_error", "1", f"estimate of the relative error of special_{name}")
            for name in ("period", "tip_y_max", "amplitude_coefficient")
        ),
        integer_variable("special_branch", "number of the branch, from 1"),
        integer_variable(
            "special_point",
            "number, from 1, of the branch_point before the special point; 0: no branch_point is before it",
        ),
        word_variable("special_reason", "reason for the end of the branch", END_REASONS),
        integer_variable(
            "special_meets",
            "at a symmetry breaking: number of the second branch that begins or ends there; -1: no branch",
        ),
        integer_variable(
            "special_unstable_after",
            "at a Hopf point: number of unstable modes of the straight rod beyond it in the parameter",
        ),
    )


def _list_extension_rule(name: str) -> ReuseRule:
    """Rule for the maximum length of a list; the variable `name` is the number of its items. A stored list
    that is not full already has all items."""
    return ReuseRule(lambda records, old: records[name] < old)


REUSE_RULES_OF_INCREASED_OPTIONS = {
    "cycles": _list_extension_rule("point_count"),
    "special": _list_extension_rule("special_count"),
    "certify": NEW_SOLVE_RULE,
}


def layout(config: dict[str, Any]) -> Layout:
    """Layout of the result file of the task branch, for a resolved config."""
    options = config["branch"]
    parameter = options["along"]
    variables = (
        integer_variable("hopf_count", f"number of Hopf points between start and stop of {parameter}"),
        integer_variable(
            "branch_count",
            "number of branches that begin at Hopf points or symmetry breakings, each counted once",
        ),
        integer_variable("point_count", "number of cycles of all branches"),
        integer_variable("special_count", "number of special points of all branches, stored or not"),
        integer_variable(
            "unstable_at_start", "number of unstable modes of the straight rod at start; -1: not known"
        ),
        boolean_variable("certified", "whether the list of Hopf points is proved complete"),
        *followed_range_variables(parameter),
        *branch_cycle_variables(parameter),
        *special_point_variables(parameter),
        SECONDS_VARIABLE,
        STATUS_VARIABLE,
    )
    parameters = parameter_names_except(parameter, NONLINEAR_ROD_PARAMETER_NAMES)
    variables = with_certified_long_name(variables, config, "Hopf points")
    extents = {CYCLE_DIMENSION: options["cycles"], SPECIAL_DIMENSION: options["special"]}
    return Layout(variables, extents, parameters)
