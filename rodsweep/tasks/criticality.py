"""The task criticality: the normal form of every Hopf point of every rod."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..config.task.criticality import CriticalityConfig
from ..results.layouts.criticality import NORMAL_FORM_VARIABLES, VARIABLES_ABSENT_FROM_HOPF_SEARCH
from ..results.layouts.variables import outcome_values, value_lists
from ..sweep.cost_estimate import CostEstimate
from ..sweep.search_cost import criticality_cost
from .base_classes import HopfPointTask
from .check_rows import point_count_text_with_clause, search_end_below_crushing_clause
from .protocol import CheckRow, Solver
from .thresholds import crossing_values

if TYPE_CHECKING:
    from ..solve.hopf.criticality import Criticality


@dataclass(frozen=True, slots=True)
class CriticalityTask(HopfPointTask):
    """The task criticality: Hopf points of every rod and their normal forms."""

    config: CriticalityConfig
    """The config, with the section `criticality`."""

    def headline_of_check(self) -> str:
        F_max = self.config.criticality.F_max
        return point_count_text_with_clause(
            self.points, f"searched from F = 0 to {F_max:g}{search_end_below_crushing_clause(self.config)}"
        )

    def rows_on_requested_results(self) -> list[CheckRow]:
        max_thresholds = self.config.criticality.crossings
        return [
            self.AXIAL_DRAG_ROW,
            ("Hopf points and their normal forms", True, f"at most {max_thresholds} are stored for each rod"),
            ("cycles", False, "only to third order in the amplitude; task: limit_cycle computes cycles"),
        ]

    def cost(self) -> CostEstimate:
        is_varying = not self.config.is_uniform_and_linear
        options = self.config.criticality
        return criticality_cost(self.points, options.F_max, options.certify, is_varying)

    def solver(self) -> Solver:
        from ..solve.changes.thresholds import ThresholdsRequest
        from ..solve.hopf.criticality import solve_criticality, warm_up
        from ..solve.hopf.status import CriticalityStatus

        options = self.config.criticality
        request = ThresholdsRequest(options.F_max, self.config.accuracy, options.certify, options.crossings)
        return Solver(
            possible_statuses=tuple(CriticalityStatus),
            warm_up=warm_up,
            solve=lambda index: solve_criticality(self.points.rod(index), request),
            file_values_of_outcome=lambda index, result: criticality_values(result, options.crossings),
        )


def criticality_values(result: "Criticality", max_crossings: int) -> dict[str, Any]:
    """Variables of the file for the Hopf points of a rod; max_crossings: length of the list of Hopf
    points."""
    search = crossing_values(result, max_crossings, "F", "crossing_F")
    for name in VARIABLES_ABSENT_FROM_HOPF_SEARCH:
        del search[name]
    pairs = zip(result.coefficients, result.search_result.thresholds, strict=False)
    rows = [outcome_values(NORMAL_FORM_VARIABLES, *pair, prefix="crossing_") for pair in pairs]
    ends = {"F_end": result.end, "unstable_at_end": result.search_result.unstable_at_end}
    return search | ends | value_lists(NORMAL_FORM_VARIABLES, rows, max_crossings)
