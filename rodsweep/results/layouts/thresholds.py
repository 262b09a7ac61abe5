"""What the file of the task thresholds holds."""

from typing import Any

from ...model.parameters import PARAMETERS, all_but
from .crossings import search_variables
from .variables import Layout, real, whole

FORCE = PARAMETERS["F"].unit
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


def layout(config: dict[str, Any]) -> Layout:
    """The layout that a resolved config asks for."""
    variables = THRESHOLDS + search_variables("F", "crossing_F")
    return Layout(variables, {"crossing": config["thresholds"]["crossings"]}, all_but("F"))
