"""What the file of the task thresholds holds, and of crossings along a line that of phase_diagram too."""

from typing import Any

from ...model.parameters import PARAMETERS, all_but
from .variables import ANEW, ANGULAR, SECONDS, STATUS, Increase, Layout, Variable, real, truth, whole

FORCE = PARAMETERS["F"].unit
THRESHOLDS = (
    real("F_onset", FORCE, "smallest F at which two real leading eigenvalues meet and become a pair"),
    real("onset_growth_rate", "1/tau2", "growth rate of the double eigenvalue at F_onset"),
    real("F_hopf", FORCE, "smallest F at which a pair becomes unstable"),
    real("hopf_frequency", ANGULAR, "angular frequency of the pair at F_hopf"),
    real("F_restabilization", FORCE, "smallest F at which the last unstable pair becomes stable again"),
    real("restabilization_frequency", ANGULAR, "angular frequency of the pair at F_restabilization"),
    real("F_end", FORCE, "F up to which was searched"),
    whole("unstable_at_end", "number of modes with positive growth rate at F_end; -1: not known"),
)

CROSSING_MEANINGS = {
    "none": "no crossing: the list is longer than what was found",
    "onset": "two real leading eigenvalues meet and become a pair: oscillations set in",
    "hopf": "a pair becomes unstable",
    "hopf_reverse": "an unstable pair becomes stable, and others stay unstable",
    "restabilization": "the last unstable pair becomes stable",
    "real_again": "the leading pair meets on the real axis and becomes two real eigenvalues",
    "real_leads": "a real eigenvalue overtakes the leading pair, without meeting it",
    "pair_leads": "a pair overtakes the leading real eigenvalue, without meeting it",
}
"""What happens at a crossing, as the parameter grows."""
CROSSING_KINDS = tuple(CROSSING_MEANINGS)
"""What happens at a crossing; the place in this list is what the file stores."""


def crossing_variables(line: str, at: str) -> tuple[Variable, ...]:
    """The crossings along `line`; `at` names the variable of their places."""
    units, kinds = PARAMETERS[line].unit, tuple(enumerate(CROSSING_KINDS))
    return (
        real(at, units, f"{line} at the crossing", "crossing"),
        Variable("crossing_kind", "|i1", 0, "1", "what changes at the crossing", ("crossing",), kinds),
        real("crossing_frequency", ANGULAR, "angular frequency of the modes that cross", "crossing"),
        real("crossing_growth_rate", "1/tau2", "growth rate of the modes that cross", "crossing"),
        real("crossing_error", units, f"estimate of the absolute error of {at}", "crossing"),
        whole("unstable_after", "number of modes with positive growth rate beyond the crossing", "crossing"),
    )


def search_variables(line: str, at: str) -> tuple[Variable, ...]:
    """What a search along `line` found, how sure that is and what it cost; `at` names a crossing's place."""
    units = PARAMETERS[line].unit
    undecided = f"of a range of {line} in which it is undecided whether a window opens and closes"
    return (
        whole("crossing_count", "number of crossings found, stored or not"),
        *crossing_variables(line, at),
        real("open_from", units, f"start {undecided}"),
        real("open_to", units, f"end {undecided}"),
        truth("certified", "whether it is proved that no crossing is missing"),
        whole("boxes", "evaluations of D over a box"),
        whole("solves", "eigenproblems solved"),
        SECONDS,
        STATUS,
    )


CROSSINGS = Increase(lambda records, before: records["crossing_count"] <= before)
"""A list of crossings that has room for all that were found needs no longer one."""
INCREASES = {"crossings": CROSSINGS, "certify": ANEW}


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for."""
    variables = THRESHOLDS + search_variables("F", "crossing_F")
    return Layout(variables, {"crossing": config["thresholds"]["crossings"]}, all_but("F"))
