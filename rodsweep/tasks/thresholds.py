"""The task thresholds: forces at which the number of unstable modes or the kind of the leading mode
changes."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..config.task.thresholds import ThresholdsConfig
from ..results.layouts.thresholds import CROSSING_KINDS, crossing_variables
from ..results.layouts.variables import outcome_values, value_lists
from ..sweep.cost_estimate import CostEstimate
from ..sweep.search_cost import thresholds_cost
from .base_classes import CertifiedTask
from .check_rows import point_count_text_with_clause, search_end_below_crushing_clause
from .protocol import CheckRow, Solver

if TYPE_CHECKING:
    from ..solve.changes.thresholds import Thresholds
    from ..solve.hopf.criticality import Criticality

RATE_NAME_BY_FIRST_CROSSING_KIND = {
    "onset": "growth_rate",
    "hopf": "frequency",
    "restabilization": "frequency",
}
"""Kinds of crossings whose first crossing is stored as a threshold; the value is the quantity stored in
addition to F."""


@dataclass(frozen=True, slots=True)
class ThresholdsTask(CertifiedTask):
    """The task thresholds: for every rod the first crossing of each kind, and up to `crossings` crossings,
    for F from 0 to `F_max`."""

    config: ThresholdsConfig
    """The config, with the section `thresholds`."""

    uncertified_risk: ClassVar[str] = "crossings may be missed"
    """Consequence of a missing certificate, as `check` prints it."""
    modes_counted_per: ClassVar[str] = "line"
    """The certificate counts the modes of some of the rods that differ only in F."""

    def headline_of_check(self) -> str:
        end_text = f"{self.config.thresholds.F_max:g}{search_end_below_crushing_clause(self.config)}"
        return point_count_text_with_clause(self.points, f"searched from F = 0 to {end_text}")

    def rows_on_requested_results(self) -> list[CheckRow]:
        max_thresholds = self.config.thresholds.crossings
        return [
            ("onset, Hopf points, restabilization", True, "task: thresholds"),
            ("all other crossings", True, f"at most {max_thresholds} are stored for each point"),
        ]

    def cost(self) -> CostEstimate:
        is_varying = not self.config.is_uniform_and_linear
        options = self.config.thresholds
        return thresholds_cost(self.points, options.F_max, options.certify, is_varying)

    def solver(self) -> Solver:
        from ..solve.changes.status import ThresholdStatus
        from ..solve.changes.thresholds import ThresholdsRequest, solve_thresholds, warm_up

        options = self.config.thresholds
        request = ThresholdsRequest(options.F_max, self.config.accuracy, options.certify, options.crossings)
        return Solver(
            possible_statuses=tuple(ThresholdStatus),
            warm_up=warm_up,
            solve=lambda index: solve_thresholds(self.points.rod(index), request),
            file_values_of_outcome=lambda index, result: threshold_values(result, options.crossings),
        )


def threshold_values(result: "Thresholds", max_crossings: int) -> dict[str, Any]:
    """Variables of the file for the thresholds of a rod; max_crossings: length of the list of crossings."""
    values = {"F_end": result.end, "unstable_at_end": result.search_result.unstable_at_end}
    for kind, rate_name in RATE_NAME_BY_FIRST_CROSSING_KIND.items():
        kind_index = CROSSING_KINDS.index(kind)
        first_crossing = next(
            (crossing for crossing in result.thresholds if crossing.kind == kind_index), None
        )
        for name, attribute in ((f"F_{kind}", "value"), (f"{kind}_{rate_name}", rate_name)):
            values[name] = getattr(first_crossing, attribute, np.nan)
    return values | crossing_values(result, max_crossings, "F", "crossing_F")


def crossing_values(
    result: "Thresholds | Criticality", max_crossings: int, line_parameter: str, position_name: str
) -> dict[str, Any]:
    """Variables of the file for a search for crossings along the parameter `line_parameter`.

    max_crossings: length of the list of crossings. position_name: name of the variable with the parameter
    value at a crossing."""
    search_result = result.search_result
    variables = crossing_variables(line_parameter, position_name)
    thresholds = search_result.thresholds
    names = {position_name: "value"}
    rows = [outcome_values(variables, threshold, prefix="crossing_", names=names) for threshold in thresholds]
    is_failed = result.status == type(result.status).failed
    return value_lists(variables, rows, max_crossings) | {
        "crossing_count": -1 if is_failed else len(thresholds),
        "open_from": search_result.range_of_further_crossings[0],
        "open_to": search_result.range_of_further_crossings[1],
        "certified": search_result.is_proved,
        "boxes": search_result.determinant_evaluation_count,
        "solves": search_result.eigenvalue_solve_count,
        "seconds": result.seconds,
        "status": int(result.status),
    }
