"""The task phase_diagram: stability of the straight rod, and stable cycles, over two parameters."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..config.task.phase_diagram import PhaseDiagramConfig
from ..model.rod import Crushed, Rod
from ..results.layouts.phase_diagram import MAX_CYCLE_SPECIAL_POINTS
from ..sweep.branch_cost import branches_cost
from ..sweep.cost_estimate import CostEstimate, sampled_points_with_rod
from ..sweep.search_cost import (
    MAX_SAMPLED_ROWS,
    diagram_cost,
    extra_seconds_of_soft_searches,
    pulled_rows_seconds_and_doubt,
)
from .base_classes import CertifiedTask
from .diagram.curve_variables import row_cycle_values
from .diagram.diagram_curve_search import DiagramCurveSolver
from .protocol import CheckRow, Solver
from .thresholds import crossing_values

if TYPE_CHECKING:
    from ..solve.branch.coexistence import CoexistenceRow
    from ..solve.branch.special.special_point import SpecialPoint
    from ..solve.changes.diagram.rows import DiagramRow, RowRequest
    from ..solve.orbit.matrix.workspace import NewtonWorkspace


WORK_NOT_IN_COST_ESTIMATE_TEXT = (
    "branches beyond the range, curves of folds and torus points, and rows that such a curve shows to have a "
    "detached branch"
)
"""Work of a diagram with cycles that the cost estimate omits, because it is known only after the rows are
solved. It can take most of the time of a small diagram: in a diagram of three rows with a detached branch 30
s, the rows 2 s."""


@dataclass(frozen=True, slots=True)
class PhaseDiagramTask(CertifiedTask):
    """The task phase_diagram. A point of the task is a row: a line of rods along the first parameter."""

    config: PhaseDiagramConfig
    """The config, with the section `phase_diagram`."""

    uncertified_risk: ClassVar[str] = "crossings may be missed"
    """Consequence of a missing certificate, as `check` prints it."""
    modes_counted_per: ClassVar[str] = "line"
    """For each line of points, here a row, a certificate counts the unstable modes at some of its rods."""

    @property
    def values_along_row(self) -> np.ndarray:
        """Values of the parameter that varies along every row, (values,)."""
        return self.config.parameters.axes[self.config.plane_parameters[0]].array()

    def coordinates(self) -> dict[str, np.ndarray]:
        """Values of the parameter that varies along every row, (values,), by its name."""
        return {self.config.plane_parameters[0]: self.values_along_row}

    def headline_of_check(self) -> str:
        line_parameter, row_parameter = self.config.plane_parameters
        return (
            f"{self.points.count} rows, one for each {row_parameter}, of {len(self.values_along_row)} "
            f"values of {line_parameter} each"
        )

    def rows_on_requested_results(self) -> list[CheckRow]:
        options = self.config.phase_diagram
        curves_text = "followed from row to row" if options.curves else "phase_diagram.curves: false"
        criticality_text = "phase_diagram.criticality adds it"
        if options.criticality:
            criticality_text = (
                f"gamma1 = {self.config.gamma1:g}; some 10 ms per point of a Hopf curve, after the rows"
            )
        cycles_text = "phase_diagram.cycles adds it"
        if options.cycles:
            cycles_text = (
                f"gamma1 = {self.config.gamma1:g}, accuracy {options.cycle_accuracy:g}; cycles on branches "
                "from the Hopf points of each row"
            )
            if options.curves:
                cycles_text += ", and on the detached branches that the fold and torus curves cross"
        return [
            ("monotone, oscillatory, flutter", True, "task: phase_diagram"),
            ("crossings along each row", True, f"at most {options.crossings} are stored for each row"),
            ("boundaries as curves", options.curves, curves_text),
            ("criticality of Hopf curves", options.criticality, criticality_text),
            (
                "curves of generalised Hopf points",
                options.bautin_name_and_axis is not None,
                f"over {options.bautin_name_and_axis[0]}"
                if options.bautin_name_and_axis
                else "phase_diagram.bautin_along adds them",
            ),
            ("stable states, with cycles", options.cycles, cycles_text),
        ]

    def searched_range_ends(self) -> dict[str, np.ndarray]:
        """First and last value of the parameter that varies along the rows, (2,), by its name."""
        return {self.config.plane_parameters[0]: self.values_along_row[[0, -1]]}

    def rows_of_check(self) -> list[CheckRow]:
        """Rows of the table of `rodsweep check`: those of a linear task and, if cycles are requested, a row
        on the nonlinear motion."""
        linear = CertifiedTask.rows_of_check(self)
        if not self.config.phase_diagram.cycles:
            return linear
        nonlinear = ("nonlinear motion", True, "of the cycles; in the plane, geometrically exact")
        return [*linear[:-1], nonlinear, ("gravity, inertia", False, "not part of the model")]

    def cost(self) -> CostEstimate:
        options = self.config.phase_diagram
        is_varying = not self.config.is_uniform_and_linear
        requested = options.certify, is_varying, options.curves, options.criticality
        rows_cost = diagram_cost(self.points.count, *requested)
        line_range = (float(self.values_along_row[0]), float(self.values_along_row[-1]))
        if self.config.plane_parameters[0] == "F":
            rows_cost = self._cost_with_soft_and_pulled_rows(rows_cost, is_varying)
        if not options.cycles:
            return rows_cost
        branches = branches_cost(
            self.points, self.config.plane_parameters[0], line_range, options.cycle_accuracy
        )
        return replace(
            branches,
            seconds=rows_cost.seconds + branches.seconds,
            underestimated_rods=branches.underestimated_rods or rows_cost.underestimated_rods,
            uncounted_work=WORK_NOT_IN_COST_ESTIMATE_TEXT,
        )

    def _cost_with_soft_and_pulled_rows(self, rows_cost: CostEstimate, is_varying: bool) -> CostEstimate:
        """The cost `rows_cost` of rows along F, increased by the time of rows of rods that are soft in
        stretch or shear, and of rows that begin at a pulling force F < 0."""
        soft = extra_seconds_of_soft_searches(self.points, float(self.values_along_row[-1]), is_varying)
        sampled_rows = sampled_points_with_rod(self.points, MAX_SAMPLED_ROWS)
        rods = [rod for row in sampled_rows if (rod := self.rod_of_row(int(row)))]
        pulled, doubt = pulled_rows_seconds_and_doubt(rods, self.values_along_row, self.points.count)
        return replace(rows_cost, seconds=rows_cost.seconds + soft + pulled, underestimated_rods=doubt)

    def solver(self) -> Solver:
        from ..solve.changes.status import ThresholdStatus
        from ..solve.changes.thresholds import warm_up
        from ..solve.orbit.matrix.workspace import NewtonWorkspace

        options = self.config.phase_diagram
        workspace = NewtonWorkspace()
        curves = DiagramCurveSolver(self, workspace)
        row_solver = Solver(
            possible_statuses=tuple(ThresholdStatus),
            warm_up=warm_up,
            solve=self.solve_straight_row,
            file_values_of_outcome=lambda index, result: self.straight_row_values(result),
            sweep_wide_solver=curves if options.curves else None,
        )
        if not options.cycles:
            return row_solver
        from ..solve.branch.branches import warm_up as warm_up_branches
        from ..solve.branch.status import CoexistenceStatus

        return replace(
            row_solver,
            possible_statuses=tuple(CoexistenceStatus),
            warm_up=warm_up_branches,
            solve=lambda index: curves.cache_special_points_of_row(
                index, self.solve_coexistence_row(index, workspace)
            ),
            file_values_of_outcome=lambda index, result: self.coexistence_row_values(result),
        )

    def solve_straight_row(self, index: int) -> "DiagramRow":
        """Solves a row without cycles. index: flat index of the row."""
        from ..solve.changes.diagram.rows import crushed_row, solve_row

        rod = self.rod_of_row(index)
        return solve_row(rod, self.row_request()) if rod else crushed_row(self.values_along_row)

    def solve_coexistence_row(
        self, index: int, workspace: "NewtonWorkspace", starts: "Sequence[SpecialPoint]" = ()
    ) -> "CoexistenceRow":
        """Solves a row with cycles. index: flat index of the row. workspace: memory of Newton's matrices.
        starts: special points from which further branches are followed."""
        from ..solve.branch.coexistence import crushed_coexistence_row, solve_coexistence

        rod = self.rod_of_row(index)
        if rod is None:
            return crushed_coexistence_row(self.values_along_row)
        return solve_coexistence(rod, self.row_request(), workspace, starts)

    def straight_row_values(self, result: "DiagramRow") -> dict[str, Any]:
        """Variables of the file, by name, for a row of a diagram in which cycles were not requested."""
        request = self.row_request()
        return row_values(result, request.parameter_name, request.max_thresholds)

    def coexistence_row_values(self, result: "CoexistenceRow") -> dict[str, Any]:
        """Variables of the file, by name, for a row of a diagram in which cycles were requested."""
        cycles = row_cycle_values(result, self.row_request().parameter_name)
        return self.straight_row_values(result.straight_rod_row) | cycles

    def rod_of_row(self, index: int) -> Rod | None:
        """The rod of the row with the index `index`, in which the parameter that varies along the row has its
        neutral value, such as F = 0 or k1 = inf; None if the force crushes this rod."""
        try:
            return self.points.rod(index, gamma1=self.config.gamma1)
        except Crushed:
            return None

    def row_request(self) -> "RowRequest":
        """The settings with which every row is solved."""
        from ..solve.changes.diagram.rows import RowRequest

        options = self.config.phase_diagram
        return RowRequest(
            parameter_name=self.config.plane_parameters[0],
            parameter_values=self.values_along_row,
            accuracy=self.config.accuracy,
            certify=options.certify,
            max_thresholds=options.crossings,
            cycle_accuracy=options.cycle_accuracy,
            max_special_points=MAX_CYCLE_SPECIAL_POINTS,
        )


def row_values(result: "DiagramRow", line_parameter: str, max_crossings: int) -> dict[str, Any]:
    """Variables of the file for one row. line_parameter: parameter that varies along the row. max_crossings:
    length of the list of crossings.
    """
    classes = {"class": result.stability_class, "unstable_count": result.unstable_count}
    changes = crossing_values(result.thresholds, max_crossings, line_parameter, "crossing_at")
    certified = result.thresholds.search_result.is_proved_to_the_end
    return classes | changes | {"certified": certified, "seconds": result.seconds}
