"""Computation of the curves of a phase diagram from the results of all its rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ...model.parameters import FORCE_AND_STRETCH_STIFFNESS
from ...model.rod import Rod
from ...results.file.view import ResultView
from ..protocol import NamedArrays, SweepWideResult
from .boundary_curves import boundary_curves, criticality_along, generalised_hopf_curves
from .curve_variables import (
    boundary_curve_values,
    criticality_and_bautin_values,
    fold_and_torus_curve_values,
    fold_curve_extremum_values,
    unstored_special_point_count,
    with_ends_on_hopf_curves,
)
from .detached_branches import (
    COMPLETE_ROW_STATUS,
    detached_branch_values,
    lost_curve_end_count_values,
    named_arrays_of_solved_row,
    row_message,
    rows_changed_when_solved_again,
    rows_with_branches_across_limits,
    special_points_of_row,
    special_points_of_rows,
)

if TYPE_CHECKING:
    from ...determinant.parameter_plane import ParameterPlane
    from ...solve.branch.coexistence import CoexistenceRow
    from ...solve.branch.special.detached_rows import DiagramStage, DiagramStages
    from ...solve.branch.special.folds_beyond_range import FoldsBeyondRange
    from ...solve.branch.special.special_curve_tracer import SpecialCurveTracer
    from ...solve.branch.special.special_point import SpecialPoint
    from ...solve.orbit.matrix.workspace import NewtonWorkspace
    from ..phase_diagram import PhaseDiagramTask

RowAndStartingPointCount = tuple[int, int]
"""(number of a row of the diagram, number of special points, besides Hopf points, at which its branches
start)."""
MAX_CACHED_ROWS = 200
"""Maximum number of rows of the diagram whose special points are cached in a process: the cycles of a row
take up to a megabyte. Special points of further rows are computed again, with equal results."""


@dataclass(slots=True, eq=False)
class DiagramCurveSolver:
    """Computes the curves of a phase diagram after its rows are solved.

    The curves are boundaries of stability with their criticality, curves of generalised Hopf points, and
    curves of folds and torus points of cycles. Only the last kind of curves, which takes most of the time, is
    divided among the ranks, into half curves."""

    task: "PhaseDiagramTask"
    """The task of the diagram, with its config and the solver of its rows."""
    workspace: "NewtonWorkspace"
    """Buffers of Newton's matrices in this process."""
    special_points_by_row: "dict[RowAndStartingPointCount, tuple[SpecialPoint, ...]]" = field(
        default_factory=dict
    )
    """Special points of cycles on rows of the diagram solved in this process."""

    def cache_special_points_of_row(self, number: int, row: "CoexistenceRow") -> "CoexistenceRow":
        """Returns `row`, the branches of a row of the diagram, after caching its special points if fewer than
        MAX_CACHED_ROWS rows are cached. number: number of the row."""
        if len(self.special_points_by_row) < MAX_CACHED_ROWS:
            self.special_points_by_row[number, 0] = row.special_points + row.folds_beyond_range
        return row

    def cached_branch_starts(
        self, items: "DiagramStage", item_numbers: Sequence[int]
    ) -> "dict[RowAndStartingPointCount, Any]":
        """Special points cached on this rank for the rows of the diagram on which the half curves numbered
        `item_numbers` start. items: half curves, or rows to be solved again, which need no special points."""
        from ...solve.branch.special.detached_rows import RowsWithDetachedBranches

        if isinstance(items, RowsWithDetachedBranches):
            return {}
        keys = {
            (row, len(items.branch_starts_of_row(row))) for row in map(items.row_index_of_item, item_numbers)
        }
        return {key: self.special_points_by_row[key] for key in keys if key in self.special_points_by_row}

    def cache_starts(self, starts: "Mapping[RowAndStartingPointCount, Any]") -> None:
        """Caches the special points `starts` of rows of the diagram that were solved on other ranks."""
        self.special_points_by_row.update(starts)

    def work_items(self, view: ResultView, results: Mapping[int, NamedArrays]) -> "DiagramStage | None":
        """The current stage of the search for curves of folds and torus points of cycles; None if these
        curves are not requested, or if fewer than two rows of the diagram have a finite row parameter.

        view: the result file with all rows. results: results of the half curves and rows solved so far, by
        number of the work item."""
        stages = self._stages(view)
        return stages.stages(results)[-1] if stages is not None else None

    def _stages(self, view: ResultView) -> "DiagramStages | None":
        """All stages of the search for curves of folds and torus points; None as for `work_items`."""
        from ...determinant.parameter_plane import PlaneAxis
        from ...solve.branch.regions_beyond_range import extended_range
        from ...solve.branch.special.detached_rows import DiagramStages
        from ...solve.branch.special.special_curve_tracer import SpecialCurveTracer

        plane = self.plane if self.task.config.phase_diagram.cycles else None
        if plane is None:
            return None
        line_parameter, row_parameter = self.task.config.plane_parameters
        row_values = self.task.points.columns_by_name[row_parameter]
        complete = np.flatnonzero(view.has_status(COMPLETE_ROW_STATUS).ravel() & np.isfinite(row_values))
        tracer = SpecialCurveTracer(
            *plane.axes,
            special_points_of_rows(view, line_parameter, row_values),
            {int(number): float(row_values[number]) for number in complete},
        )
        low, high = self._limits_along_row
        return DiagramStages(
            tracer,
            lambda number, values: special_points_of_row(values, line_parameter, number, row_values[number]),
            PlaneAxis(line_parameter, *extended_range(line_parameter, low, high)),
            rows_with_branches_across_limits(
                view, line_parameter, tracer.values_of_rows_with_known_branches, (low, high)
            ),
        )

    @property
    def _limits_along_row(self) -> tuple[float, float]:
        """Smallest and largest value of the parameter that varies along a row of the diagram."""
        values = self.task.values_along_row
        return float(values.min()), float(values.max())

    def solve_item(self, items: "DiagramStage", item: int) -> dict[str, np.ndarray]:
        """Result of the work item number `item`. For a half curve: arrays with the shapes of
        `TracedHalfCurve`. For a row of the diagram that is solved again: its variables, and its message as
        bytes."""
        from ...determinant.arm.determinant import forget_arm_determinants
        from ...solve.branch.special.detached_rows import RowsWithDetachedBranches
        from ...solve.branch.special.folds_beyond_range import FoldsBeyondRange

        forget_arm_determinants()  # made for the rows, which differ between ranks
        if isinstance(items, FoldsBeyondRange):
            return items.solve(item, partial(self._special_points, items), self._limits_along_row)
        if not isinstance(items, RowsWithDetachedBranches):
            return items.solve(item, partial(self._special_points, items), self.workspace)
        row_index = items.row_index_of_item(item)
        starts = items.branch_starts_of_row(row_index)
        row = self.task.solve_coexistence_row(row_index, self.workspace, starts)
        self.special_points_by_row[row_index, len(starts)] = row.special_points + row.folds_beyond_range
        return named_arrays_of_solved_row(row, self.task.coexistence_row_values(row))

    def empty_result(self, items: "DiagramStage") -> dict[str, np.ndarray]:
        """Result that stands for a failed work item: a half curve without points, arrays of shape (0, ...),
        or no variables of a row of the diagram, which then stays unchanged."""
        from ...solve.branch.special.special_curve_tracer import SpecialCurveTracer
        from ...solve.branch.special.special_curves import TracedHalfCurve

        return TracedHalfCurve(None).arrays() if isinstance(items, SpecialCurveTracer) else {}

    def result(self, view: ResultView, results: Mapping[int, NamedArrays]) -> SweepWideResult:
        """All curves as variables of the file, and the rows of the diagram that change because curves reveal
        further branches; both empty without a `plane`. view: the file with all rows. results: results of all
        half curves and rows by number of the work item, as from `solve_item`."""
        from ...determinant.arm.determinant import forget_arm_determinants

        forget_arm_determinants()
        plane = self.plane
        if plane is None:
            return SweepWideResult(())
        line_parameter, row_parameter = self.task.config.plane_parameters
        plane_names = (line_parameter, row_parameter)
        options = self.task.config.phase_diagram
        traced = boundary_curves(plane, view, self.task.points.columns_by_name[row_parameter])
        limit = {}
        if plane_names == FORCE_AND_STRETCH_STIFFNESS and self.task.config.is_uniform_and_linear:
            # The fold of the Hopf curve in the partial beam limit (Sec. VIII).
            from ...solve.changes.thresholds import filament_flutter_force

            Fc = filament_flutter_force()
            limit = {"filament_F_hopf": Fc, "partial_beam_k1": 4 * Fc, "partial_beam_F": 2 * Fc}
        variables = boundary_curve_values(traced, plane_names, **limit)
        accuracy = self.task.config.accuracy
        needs_criticality = options.criticality or options.cycles
        criticalities = criticality_along(plane, traced, accuracy) if needs_criticality else []
        if options.criticality:
            variables += criticality_and_bautin_values(criticalities, plane_names, self.task.config.gamma1)
        if options.bautin_name_and_axis is not None:
            variables += generalised_hopf_curves(plane, criticalities, options.bautin_name_and_axis, accuracy)
        stages = self._stages(view)
        if stages is None:
            return SweepWideResult(variables)
        unstored = unstored_special_point_count(view, self._is_row_parameter_finite)
        curves = with_ends_on_hopf_curves(stages.curves(results), plane, criticalities, unstored)
        changed = rows_changed_when_solved_again(view, stages.variables_of_rows_solved_again(results))
        variables += [
            *fold_and_torus_curve_values(curves, plane_names),
            *fold_curve_extremum_values(curves, plane_names),
        ]
        variables += detached_branch_values(view, changed)
        variables += lost_curve_end_count_values(stages.count_of_curves_lost_beyond_range(results))
        messages = {number: row_message(result) for number, result in changed.items()}
        return SweepWideResult(variables, changed, messages)

    @property
    def _is_row_parameter_finite(self) -> np.ndarray:
        """Whether the value of the row parameter is finite, for each row of the diagram, (rows,)."""
        return np.isfinite(self.task.points.columns_by_name[self.task.config.plane_parameters[1]])

    @property
    def plane(self) -> "ParameterPlane | None":
        """Plane of the diagram's two parameters; None if fewer than two rows have a finite value of the row
        parameter."""
        from ...determinant.parameter_plane import ParameterPlane, PlaneAxis

        line_parameter, row_parameter = self.task.config.plane_parameters
        finite = self.task.points.columns_by_name[row_parameter][self._is_row_parameter_finite]
        if len(finite) < 2:
            return None
        axes = self.task.config.parameters.axes
        # A rod of the plane must be valid: take the corner of the grid that is farthest from crushing.
        not_crushed: dict[str, Any] = {
            name: float(axis.array()[-1 if name in ("k1", "taper") else 0]) for name, axis in axes.items()
        }
        abscissa, ordinate = (
            PlaneAxis(name, float(values[0]), float(values[-1]), axes[name].is_logarithmic)
            for name, values in ((line_parameter, self.task.values_along_row), (row_parameter, finite))
        )
        rod = Rod(**not_crushed, gamma1=self.task.config.gamma1, material=self.task.config.rod_material)
        return ParameterPlane(rod, (abscissa, ordinate))

    def _special_points(
        self, items: "SpecialCurveTracer | FoldsBeyondRange", number: int
    ) -> "tuple[SpecialPoint, ...]":
        """Special points of the branches of the row number `number` of the diagram, within the range and
        beyond; () if the row's rod is crushed. items: half curves that start at these points, or rows."""
        from ...solve.branch.coexistence import row_branches, special_points_of

        starts = items.branch_starts_of_row(number)
        if (number, len(starts)) not in self.special_points_by_row:
            rod = self.task.rod_of_row(number)
            if rod is None:
                return ()
            branches = row_branches(rod, self.task.row_request(), self.workspace, starts)
            return special_points_of(branches) + branches.folds_beyond_range
        return self.special_points_by_row[number, len(starts)]
