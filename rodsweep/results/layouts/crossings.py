"""Crossings met along a line in one parameter, as the files of thresholds and phase_diagram hold them."""

from ...model.parameters import PARAMETERS
from .variables import SECONDS, STATUS, Variable, real, whole

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


def search_variables(line: str, at: str) -> tuple[Variable, ...]:
    """What a search along the parameter `line` found, how far it can be trusted, and what it cost.

    `at` is the name of the variable that says where a crossing is.
    """
    units = PARAMETERS[line].unit
    undecided = f"of a range of {line} in which it is undecided whether a window opens and closes"
    kinds = tuple(enumerate(CROSSING_KINDS))
    return (
        whole("crossing_count", "number of crossings found, stored or not"),
        real(at, units, f"{line} at the crossing", "crossing"),
        Variable("crossing_kind", "|i1", 0, "1", "what changes at the crossing", ("crossing",), kinds),
        real("crossing_frequency", "1/tau2", "frequency of the modes that cross", "crossing"),
        real("crossing_growth_rate", "1/tau2", "growth rate of the modes that cross", "crossing"),
        real("crossing_error", units, f"estimate of the absolute error of {at}", "crossing"),
        whole("unstable_after", "number of modes with positive growth rate beyond the crossing", "crossing"),
        real("open_from", units, f"start {undecided}"),
        real("open_to", units, f"end {undecided}"),
        Variable("certified", "|i1", 0, "1", "1 where it is proved that no crossing is missing"),
        whole("boxes", "evaluations of D over a box"),
        whole("solves", "eigenproblems solved"),
        SECONDS,
        STATUS,
    )
