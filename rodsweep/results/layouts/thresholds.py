"""Layout of the task thresholds, and variables of the crossings along one parameter, which other tasks use as
well."""

from typing import Any

from ...model.parameters import PARAMETERS, parameter_names_except
from .rod_properties import with_certified_long_name
from .variables import (
    ANGULAR_UNIT,
    NEW_SOLVE_RULE,
    SECONDS_VARIABLE,
    STATUS_VARIABLE,
    Layout,
    ReuseRule,
    Variable,
    boolean_variable,
    integer_variable,
    real_variable,
    word_variable,
)

FORCE_UNIT = PARAMETERS["F"].unit
SEARCH_END_VARIABLES = (
    real_variable("F_end", FORCE_UNIT, "largest F of the search"),
    integer_variable("unstable_at_end", "number of modes with positive growth rate at F_end; -1: not known"),
)
THRESHOLD_VARIABLES = (
    real_variable(
        "F_onset", FORCE_UNIT, "smallest F at which two real leading eigenvalues merge into a complex pair"
    ),
    real_variable("onset_growth_rate", "1/tau2", "growth rate of the double eigenvalue at F_onset"),
    real_variable("F_hopf", FORCE_UNIT, "smallest F at which a pair becomes unstable"),
    real_variable("hopf_frequency", ANGULAR_UNIT, "angular frequency of the pair at F_hopf"),
    real_variable(
        "F_restabilization", FORCE_UNIT, "smallest F at which the last unstable pair becomes stable again"
    ),
    real_variable(
        "restabilization_frequency", ANGULAR_UNIT, "angular frequency of the pair at F_restabilization"
    ),
    *SEARCH_END_VARIABLES,
)
CROSSING_MEANINGS = {
    "none": "unused entry: the list is longer than the number of crossings",
    "onset": "two real leading eigenvalues merge into a complex pair: oscillations set in",
    "hopf": "a pair becomes unstable",
    "hopf_reverse": "an unstable pair becomes stable, and other modes stay unstable",
    "restabilization": "the last unstable pair becomes stable",
    "real_again": "the leading pair meets on the real axis and splits into two real eigenvalues",
    "real_leads": "a real eigenvalue overtakes the leading pair in growth rate",
    "pair_leads": "a complex pair overtakes the leading real eigenvalue in growth rate",
}
"""Meaning of every kind of crossing, as the parameter grows, by word."""
CROSSING_KINDS = tuple(CROSSING_MEANINGS)
"""Names of the kinds of crossings; the file stores a kind as its index in this tuple."""
HOPF_CROSSING_CODES = tuple(map(CROSSING_KINDS.index, ("hopf", "hopf_reverse", "restabilization")))
"""Stored numbers of the kinds of crossings that are Hopf points, at which the stability of the straight rod
may change."""


def crossing_variables(line_parameter: str, position_name: str) -> tuple[Variable, ...]:
    """Variables of the crossings along the parameter `line_parameter`. position_name: name of the variable
    with the value of this parameter at a crossing."""
    units = PARAMETERS[line_parameter].unit
    return (
        real_variable(position_name, units, f"{line_parameter} at the crossing", "crossing"),
        word_variable("crossing_kind", "kind of the crossing", CROSSING_KINDS, "crossing"),
        real_variable(
            "crossing_frequency", ANGULAR_UNIT, "angular frequency of the modes that cross", "crossing"
        ),
        real_variable("crossing_growth_rate", "1/tau2", "growth rate of the modes that cross", "crossing"),
        real_variable(
            "crossing_error", units, f"estimate of the absolute error of {position_name}", "crossing"
        ),
        integer_variable(
            "unstable_after", "number of modes with positive growth rate beyond the crossing", "crossing"
        ),
    )


def search_variables(line_parameter: str, position_name: str) -> tuple[Variable, ...]:
    """Variables of a search for crossings along the parameter `line_parameter`; position_name: name of the
    variable with the value of this parameter at a crossing."""
    units = PARAMETERS[line_parameter].unit
    undecided = (
        f"of a range of {line_parameter} that may contain a window of flutter too narrow to be resolved"
    )
    return (
        integer_variable("crossing_count", "number of crossings found, stored or not"),
        *crossing_variables(line_parameter, position_name),
        real_variable("open_from", units, f"start {undecided}"),
        real_variable("open_to", units, f"end {undecided}"),
        boolean_variable(
            "certified", "whether the list of crossings is proved complete in the searched range"
        ),
        integer_variable("boxes", "number of evaluations of D over a box"),
        integer_variable("solves", "number of eigenproblems solved"),
        SECONDS_VARIABLE,
        STATUS_VARIABLE,
    )


CROSSING_LIST_REUSE_RULE = ReuseRule(lambda records, before: records["crossing_count"] <= before)
"""Rule by which a run with a larger maximum number of stored crossings reuses earlier results: a list that
has at most the earlier maximum number of crossings is complete."""
REUSE_RULES_OF_INCREASED_OPTIONS = {"crossings": CROSSING_LIST_REUSE_RULE, "certify": NEW_SOLVE_RULE}


def layout(config: dict[str, Any]) -> Layout:
    """Layout of the result file of the task thresholds, for a resolved config."""
    variables = with_certified_long_name(
        THRESHOLD_VARIABLES + search_variables("F", "crossing_F"), config, "crossings"
    )
    return Layout(variables, {"crossing": config["thresholds"]["crossings"]}, parameter_names_except("F"))
