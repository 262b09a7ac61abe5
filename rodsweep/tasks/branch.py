"""The task branch: branches of cycles of every rod, followed in a parameter from all Hopf points."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..config.task.branch import BranchConfig
from ..results.layouts.branch import branch_cycle_variables, special_point_variables
from ..results.layouts.variables import outcome_values, value_lists
from ..sweep.branch_cost import branches_cost
from ..sweep.cost_estimate import CostEstimate
from .base_classes import HopfPointTask
from .check_rows import point_count_text_with_clause, search_end_below_crushing_clause
from .protocol import CheckRow, Solver

if TYPE_CHECKING:
    from ..solve.branch.branch_curve import BranchCurve, StoredBranchCycle
    from ..solve.branch.branches import BranchesOfRod
    from ..solve.branch.special.special_point import SpecialPoint
    from ..solve.changes.threshold_kinds import Threshold


@dataclass(frozen=True, slots=True)
class BranchTask(HopfPointTask):
    """The task branch: branches of cycles of every rod, with their special points."""

    config: BranchConfig
    """The config, with the section `branch`."""

    def headline_of_check(self) -> str:
        options = self.config.branch
        parameter = options.along
        crushing_text = search_end_below_crushing_clause(self.config) * (options.along == "F")
        range_text = f"from {options.start:g} to {options.stop:g}"
        return point_count_text_with_clause(
            self.points, f"followed in {parameter} {range_text}{crushing_text}"
        )

    def rows_on_requested_results(self) -> list[CheckRow]:
        options = self.config.branch
        lengths_text = f"{options.cycles} cycles and {options.special} special points"
        limit_sentence = f"at most {lengths_text} of a rod are stored"
        return [
            self.AXIAL_DRAG_ROW,
            ("branches born at Hopf points", True, limit_sentence),
            ("unstable cycles", True, "with all their Floquet multipliers"),
            ("branches without mirror symmetry", True, "from the symmetry breakings on those branches"),
            ("branches of twice the period, tori", False, "only the points where they begin are found"),
            ("cycles on other branches", False, "task: limit_cycle finds stable cycles from a motion"),
        ]

    def searched_range_ends(self) -> dict[str, np.ndarray]:
        """Smallest and largest value of the followed parameter, (2,), by its name."""
        options = self.config.branch
        return {options.along: np.array([options.start, options.stop])}

    def cost(self) -> CostEstimate:
        options = self.config.branch
        limits = (options.start, options.stop)
        return branches_cost(self.points, options.along, limits, self.config.accuracy)

    def solver(self) -> Solver:
        from ..solve.branch.branch_limits import BranchRequest
        from ..solve.branch.branches import solve_branches, warm_up
        from ..solve.branch.status import BranchStatus
        from ..solve.orbit.matrix.workspace import NewtonWorkspace

        options = self.config.branch
        workspace = NewtonWorkspace()
        request = BranchRequest(**options.model_dump(), accuracy=self.config.accuracy)
        lengths = options.along, options.cycles, options.special
        return Solver(
            possible_statuses=tuple(BranchStatus),
            warm_up=warm_up,
            solve=lambda index: solve_branches(self.points.rod(index), request, workspace),
            file_values_of_outcome=lambda index, result: branch_values(result, *lengths),
        )


def branch_values(
    result: "BranchesOfRod", parameter_name: str, point_count: int, special_count: int
) -> dict[str, Any]:
    """Variables of the file for all branches of a rod.

    parameter_name: parameter along the branches. point_count: length of the list of cycles. special_count:
    length of the list of special points.
    """
    numbered = [
        (number, point) for number, curve in enumerate(result.curves, 1) for point in curve.stored_cycles
    ]
    cycles = [_cycle_values(point, parameter_name) | {"branch": number} for number, point in numbered]
    crossing_by_value = {crossing.value: crossing for crossing in result.crossings}
    second_branches = second_branch_by_symmetry_breaking(result.curves)
    specials = []
    first_cycle_index = 0  # index of the first cycle of the branch
    for number, curve in enumerate(result.curves, 1):
        for index, special_point in enumerate(curve.special_points):
            crossing = crossing_by_value.get(special_point.parameter_value)
            others_here = {
                "special_branch": number,
                "special_meets": second_branches.get((number, index), -1),
            }
            specials.append(_special_point_values(special_point, first_cycle_index, crossing) | others_here)
        first_cycle_index += len(curve.stored_cycles)
    is_complete = result.status.name != "failed"
    counts = {"hopf": len(result.crossings), "branch": len(result.curves), "point": len(cycles)}
    counts["special"] = len(specials)
    values: dict[str, Any] = {f"{name}_count": count if is_complete else -1 for name, count in counts.items()}
    values |= {
        "unstable_at_start": result.unstable_modes_at_start,
        "certified": result.are_crossings_proved_complete,
    }
    values["followed_from"], values["followed_to"] = result.followed_range
    values |= value_lists(branch_cycle_variables(parameter_name), cycles, point_count)
    values |= value_lists(special_point_variables(parameter_name), specials, special_count)
    return values | {"seconds": result.seconds, "status": result.status}


def second_branch_by_symmetry_breaking(curves: "Sequence[BranchCurve]") -> dict[tuple[int, int], int]:
    """For every symmetry breaking on a branch, the number of the second branch that begins or ends there.

    Keys: (number of the branch, from 1; index of the symmetry breaking among the branch's special points).
    """
    numbers = {}
    for number, curve in enumerate(curves, 1):
        ends = (curve.start_breaking, 0), (curve.end_breaking, len(curve.special_points) - 1)
        for breaking, index in ends:
            if breaking is not None:
                numbers[number, index] = breaking.branch_number
                numbers[breaking.branch_number, breaking.special_point_index] = number
    return numbers


def _cycle_values(point: "StoredBranchCycle", parameter_name: str) -> dict[str, Any]:
    """A cycle of a branch as variables of the file."""
    attribute_names = {
        f"branch_{parameter_name}": "parameter_value",
        f"branch_{parameter_name}_error": "parameter_value_error",
        "unstable_multipliers": "unstable_count",
    }
    variables = [variable for variable in branch_cycle_variables(parameter_name) if variable.name != "branch"]
    return outcome_values(variables, point, point.measures, point.errors, names=attribute_names)


SPECIAL_POINT_FIELD_BY_VARIABLE = {
    "special_at": "parameter_value",
    "special_amplitude_coefficient_error": "relative_amplitude_coefficient_error",
}
"""Field of `SpecialPoint` by name of the variable, where the two names differ."""


def _special_point_values(
    point: "SpecialPoint", first_cycle_index: int, crossing: "Threshold | None"
) -> dict[str, Any]:
    """Variables of the file for one special point. first_cycle_index: index, among all cycles of the rod, of
    the first cycle of the point's branch. crossing: crossing of the straight rod at the point, None if the
    point is not a Hopf point."""
    number = first_cycle_index + point.index_of_cycle_before + 1
    values = {
        "special_point": number if point.index_of_cycle_before >= 0 else 0,
        "special_reason": int(point.end_reason or 0),
        "special_unstable_after": crossing.unstable_after if crossing else -1,
    }
    given_names = {*values, "special_branch", "special_meets"}
    variables = [variable for variable in special_point_variables("F") if variable.name not in given_names]
    return values | outcome_values(variables, point, prefix="special_", names=SPECIAL_POINT_FIELD_BY_VARIABLE)
