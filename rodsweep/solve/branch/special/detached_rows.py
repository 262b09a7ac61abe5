"""Search for all curves of folds and torus points of a phase diagram, and for the branches to which only
these curves lead, in stages.

A stage traces curves through special points (`SpecialCurveTracer`), or solves rows again, each with the
points at which curves cross it without a special point of its own (`RowsWithDetachedBranches`). The next
stage follows from the results of all stages so far: rows after curves, and curves through the new special
points of rows. At the end, curves that leave the range, and curves through folds beyond it
(`FoldsBeyondRange`), are followed beyond the range, where they may cross further rows.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

from ....arrays import Array
from ....determinant.parameter_plane import PlaneAxis
from ...continuation.curves_through_seeds import TracedCurves
from .curve_ends import are_identical_curves
from .folds_beyond_range import FoldsBeyondRange, RowWorkItems
from .row_crossing import RowCrossing
from .special_curve_tracer import SpecialCurveTracer
from .special_curves import CurveEndReason, SpecialPointCurve
from .special_point import RowSpecialPoint, SpecialPoint

MAX_STAGES_OF_CURVES_OR_ROWS = 8
"""Maximum number of stages of a diagram: stages of curves and stages of rows alternate, and each finds fewer
branches than the stage before. `show` names the rows with cycles that this search does not reach."""
WorkItemResults = Mapping[int, dict[str, Array]]
"""Results of work items, by number; of a row: its variables by name, empty if the row failed."""
SpecialPointsOfRowFunction = Callable[[int, dict[str, Array]], list[RowSpecialPoint]]
"""Function from (index of a row, its variables by name) to the folds and torus points of the row."""


@dataclass(frozen=True, slots=True)
class RowsWithDetachedBranches(RowWorkItems):
    """Diagram rows that are solved again, because a curve of folds or torus points crosses the row where no
    branch has such a point. unexplained_crossings: all such crossings known so far, by index of the row."""

    done_item_phrase: ClassVar[str] = (
        "row solved again with branches found from curves of folds and torus points"
    )
    """Phrase for one row and the work done on it, for the report at the end of a run."""
    item_label_prefix: ClassVar[str] = "detached branches"
    """Text before the row parameter in the progress display."""

    unexplained_crossings: Mapping[int, tuple[RowCrossing, ...]]

    def branch_starts_of_row(self, row: int) -> tuple[SpecialPoint, ...]:
        """Special points from which branches of the row with the index `row` are followed."""
        return tuple(crossing.special_point for crossing in self.unexplained_crossings[row])


DiagramStage = SpecialCurveTracer | RowsWithDetachedBranches | FoldsBeyondRange


@dataclass(frozen=True, slots=True)
class DiagramStages:
    """The stages of the search of the module docstring, for one diagram. first_stage: traces the curves from
    the points of all rows. special_points_of_row: a `SpecialPointsOfRowFunction`. axis_extended_beyond_range:
    axis of the parameter along the rows, extended as far as branches are followed beyond the range; None if
    curves end at the range. values_of_rows_leaving_range: row parameter of each row with a branch that leaves
    or enters the range."""

    first_stage: SpecialCurveTracer
    special_points_of_row: SpecialPointsOfRowFunction
    axis_extended_beyond_range: PlaneAxis | None = None
    values_of_rows_leaving_range: Mapping[int, float] = field(default_factory=dict)

    def stages(self, results: WorkItemResults) -> list[DiagramStage]:
        """All stages that follow from the results of work items; only the last stage may be incomplete."""
        stages: list[DiagramStage] = [self.first_stage]
        while len(stages) < MAX_STAGES_OF_CURVES_OR_ROWS and not stages[-1].items_to_solve(results):
            next_stage = self._stage_after(stages, results)
            if next_stage is None:
                break
            stages.append(next_stage)
        return stages

    def _stage_after(self, stages: Sequence[DiagramStage], results: WorkItemResults) -> DiagramStage | None:
        """The stage after complete `stages`; None if nothing is left to do."""
        last_stage = stages[-1]
        if isinstance(last_stage, FoldsBeyondRange):
            return self._tracer_beyond_range(stages, last_stage, results)
        if isinstance(last_stage, SpecialCurveTracer):
            return _rows_crossed_by_curves(last_stage, stages, results) or self._stage_of_folds_beyond_range(
                stages, results
            )
        new_points = self._new_special_points(stages, last_stage, results)
        if not new_points:
            return self._stage_of_folds_beyond_range(stages, results)
        known_points = (*self.first_stage.special_points, *self._points_of_repeated_rows(stages, results))
        rows = last_stage.unexplained_crossings
        # The tracer joins both lists, so a point in both would be counted twice.
        known_points = tuple(point for point in known_points if point not in new_points)
        return replace(
            self.first_stage,
            first_item_number=last_stage.end_item_number,
            special_points=new_points,
            special_points_not_to_trace=known_points,
            branch_starts_by_row={row: last_stage.branch_starts_of_row(row) for row in rows},
        )

    def _stage_of_folds_beyond_range(
        self, stages: Sequence[DiagramStage], results: WorkItemResults
    ) -> FoldsBeyondRange | None:
        """The stage, after complete `stages`, in which branches are followed beyond the range to their folds;
        None if `stages` contains it already, or if neither a branch nor a curve leaves the range."""
        if self.axis_extended_beyond_range is None or any(
            isinstance(stage, FoldsBeyondRange) for stage in stages
        ):
            return None
        if not self.values_of_rows_leaving_range and not self.first_stage.point_of_each_curve_leaving_range(
            results
        ):
            return None
        return FoldsBeyondRange(
            stages[-1].end_item_number,
            self.first_stage.row_parameter_axis.parameter_name,
            self.values_of_rows_leaving_range,
        )

    def _tracer_beyond_range(
        self, stages: Sequence[DiagramStage], folds_beyond: FoldsBeyondRange, results: WorkItemResults
    ) -> SpecialCurveTracer | None:
        """Curves within and beyond the range through the folds of `folds_beyond`, and through a special point
        of each curve that leaves the range; None if there are none."""
        assert self.axis_extended_beyond_range is not None
        # Special points of rows solved again are known only with the starts of their stage.
        points = folds_beyond.special_points(results) + self.first_stage.point_of_each_curve_leaving_range(
            results
        )
        if not points:
            return None
        known_points = (*self.first_stage.special_points, *self._points_of_repeated_rows(stages, results))
        return replace(
            self.first_stage,
            axis_along_row=self.axis_extended_beyond_range,
            first_item_number=folds_beyond.end_item_number,
            special_points=points,
            special_points_not_to_trace=tuple(point for point in known_points if point not in points),
        )

    def _points_of_repeated_rows(
        self, stages: Sequence[DiagramStage], results: WorkItemResults
    ) -> list[RowSpecialPoint]:
        """Special points of all rows that were solved again."""
        return [
            point
            for row, values in _rows_solved_again(stages, results).items()
            for point in self.special_points_of_row(row, values)
        ]

    def _new_special_points(
        self,
        stages: Sequence[DiagramStage],
        detached_rows: RowsWithDetachedBranches,
        results: WorkItemResults,
    ) -> list[RowSpecialPoint]:
        """Special points of the rows of `detached_rows` that lie on no curve traced so far."""
        points_by_row: dict[int, list[RowSpecialPoint | SpecialPoint]] = {}
        for stage in stages:
            if isinstance(stage, SpecialCurveTracer):
                for point in stage.special_points:
                    points_by_row.setdefault(point.row_index, []).append(point)
        for row, crossings in detached_rows.unexplained_crossings.items():
            points_by_row.setdefault(row, []).extend(crossing.special_point for crossing in crossings)
        return [
            point
            for point in self._points_of_repeated_rows([detached_rows], results)
            if not any(point.is_same_as(other) for other in points_by_row.get(point.row_index, ()))
        ]

    def variables_of_rows_solved_again(self, results: WorkItemResults) -> dict[int, dict[str, Array]]:
        """Variables of all rows that were solved again, (...,) each, by index of the row."""
        return _rows_solved_again(self.stages(results), results)

    def count_of_curves_lost_beyond_range(self, results: WorkItemResults) -> int:
        """Number of ends at which curves could not be continued while they were followed beyond the range,
        where they may lead to further rows, plus the number of special points from which no such curve could
        be followed; valid if the last stage is complete. results: arrays, (...,) each, by name and item."""
        count = 0
        for stage in self.stages(results):
            if (
                isinstance(stage, SpecialCurveTracer)
                and stage.axis_along_row != self.first_stage.axis_along_row
            ):
                traced = stage.curves(results)
                ends = [end for curve in traced.curves for end in curve.end_reasons]
                count += ends.count(CurveEndReason.not_followed) + traced.untraced_seed_count
        return count

    def curves(self, results: WorkItemResults) -> TracedCurves[SpecialPointCurve]:
        """The curves of all stages, each only once; valid if the last stage is complete."""
        curves: list[SpecialPointCurve] = []
        stages = self.stages(results)
        # Curves that are followed beyond the range only lead to rows; within it they are known.
        traced_stages = [
            stage.curves(results)
            for stage in stages
            if isinstance(stage, SpecialCurveTracer)
            and stage.axis_along_row == self.first_stage.axis_along_row
        ]
        for curve in (curve for stage_curves in traced_stages for curve in stage_curves.curves):
            if not any(
                are_identical_curves(curve, other, self.first_stage.axis_along_row) for other in curves
            ):
                curves.append(curve)
        return TracedCurves(
            tuple(curves),
            max(stage_curves.max_seed_distance_per_row_length for stage_curves in traced_stages),
            sum(stage_curves.untraced_seed_count for stage_curves in traced_stages),
        )


def _rows_solved_again(
    stages: Sequence[DiagramStage], results: WorkItemResults
) -> dict[int, dict[str, Array]]:
    """Variables of all rows that were solved again, by index of the row: the last result without failure."""
    variables_by_row: dict[int, dict[str, Array]] = {}
    for stage in stages:
        if isinstance(stage, RowsWithDetachedBranches):
            # A row that failed has an empty result, and keeps the variables of its earlier stage.
            items = (
                item for item in range(stage.first_item_number, stage.end_item_number) if results.get(item)
            )
            variables_by_row |= {stage.row_index_of_item(item): results[item] for item in items}
    return dict(sorted(variables_by_row.items()))


def _rows_crossed_by_curves(
    tracer: SpecialCurveTracer, stages: Sequence[DiagramStage], results: WorkItemResults
) -> RowsWithDetachedBranches | None:
    """The rows that curves of `tracer` cross without a special point there; None if no such crossing is
    new."""
    known_crossings: dict[int, tuple[RowCrossing, ...]] = {}
    for stage in stages:
        known_crossings |= stage.unexplained_crossings if isinstance(stage, RowsWithDetachedBranches) else {}
    new_crossings: dict[int, tuple[RowCrossing, ...]] = {}
    for crossing in tracer.unexplained_crossings(results):
        row = crossing.row_index
        # A row solved again starts from all points known so far, because its result replaces the earlier one.
        row_crossings = new_crossings.get(row) or known_crossings.get(row, ())
        if not any(crossing.special_point.is_same_as(other.special_point) for other in row_crossings):
            new_crossings[row] = (*row_crossings, crossing)
    if not new_crossings:
        return None
    row_values = {row: tracer.values_of_rows_with_known_branches[row] for row in new_crossings}
    return RowsWithDetachedBranches(
        tracer.end_item_number, tracer.row_parameter_axis.parameter_name, row_values, new_crossings
    )
