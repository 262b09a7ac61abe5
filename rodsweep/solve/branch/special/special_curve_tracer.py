"""Curves through the folds and torus points of cycles on all rows of a phase diagram. Each curve is followed
once, as two half curves from a special point of a row; each half curve is a work item."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from ....determinant.parameter_plane import PlaneAxis
from ...continuation.curves_through_seeds import CurveTracingState, TracedCurves, trace_all_curves
from ...orbit.matrix.workspace import NewtonWorkspace
from .curve_ends import SPECIAL_CURVE_END_SETTINGS, are_identical_curves, leaves_range_along_rows
from .curve_problem import SpecialCurveProblem
from .half_curve import trace_half_curve
from .row_crossing import RowCrossing
from .special_curves import (
    CURVE_IDENTITY_SETTINGS,
    CurveEndReason,
    HalfCurveArrays,
    SpecialPointCurve,
    TracedHalfCurve,
)
from .special_point import RowSpecialPoint, SpecialPoint, SpecialPointKind

FOLLOWED_KIND_NOUNS = {SpecialPointKind.fold: "folds", SpecialPointKind.torus: "torus points"}
"""Kinds of special points that are followed as curves, with the plural noun for messages."""


@dataclass(frozen=True, slots=True)
class SpecialCurveTracer:
    """Curves through all folds and torus points on the rows of a parameter plane, traced as half curves. A
    row has the rods that differ only in the parameter of `axis_along_row`; the row parameter, of
    `row_parameter_axis`, differs between rows. special_points: points through which curves are traced. From
    special point i, half curve (work item) `first_item_number` + 2 i leads to larger values of the row
    parameter, half curve `first_item_number` + 2 i + 1 to smaller values."""

    done_item_phrase: ClassVar[str] = "piece of curves of folds and torus points followed"
    progress_noun: ClassVar[str] = "pieces of curves"
    """Plural noun for the half curves in the progress display."""

    axis_along_row: PlaneAxis
    row_parameter_axis: PlaneAxis
    special_points: Sequence[RowSpecialPoint]
    values_of_rows_with_known_branches: Mapping[int, float] = field(default_factory=dict)
    """Value of the row parameter on each row whose branches of cycles are all known, by index of the row."""
    special_points_not_to_trace: Sequence[RowSpecialPoint] = ()
    """Special points of the rows from which no curve is traced, but which may lie on a traced curve."""
    branch_starts_by_row: Mapping[int, tuple[SpecialPoint, ...]] = field(default_factory=dict)
    """Special points from which branches of a row are followed in addition to its branches from Hopf points,
    by index of the row."""
    first_item_number: int = 0

    @property
    def end_item_number(self) -> int:
        """First item number after the half curves of this tracer: `first_item_number` plus their number."""
        return self.first_item_number + 2 * len(self.special_points)

    def items_to_solve(self, results: Mapping[int, HalfCurveArrays]) -> list[int]:
        """Numbers of the half curves needed now, then of half curves that may be needed later; empty if all
        curves are complete. results: results of half curves, by number."""
        needed_items: list[int] = []
        possible_later_items: list[int] = []
        for curves, search in self._tracing_states_by_kind(results):
            needed_items += search.missing_items
            possible_later_items += curves.possible_later_items(search)
        # Possible items keep ranks busy that would wait; they are never worth a stage of their own.
        items = needed_items + possible_later_items if needed_items else []
        return [self.first_item_number + item for item in items]

    def unexplained_crossings(self, results: Mapping[int, HalfCurveArrays]) -> list[RowCrossing]:
        """Crossings of a traced curve with a row whose branches are all known, although none of these
        branches has a special point there; valid if `items_to_solve(results)` is empty."""
        return [
            crossing
            for _, search in self._tracing_states_by_kind(results)
            for traced in search.curves
            for crossing in traced.crossings
        ]

    def point_of_each_curve_leaving_range(
        self, results: Mapping[int, HalfCurveArrays]
    ) -> list[RowSpecialPoint]:
        """One of `special_points` on each curve that leaves the range of the parameter along the rows; valid
        if `items_to_solve(results)` is empty."""
        return [
            # Any point of the curve would do; the smallest index makes the choice the same in each run.
            self.special_points[min(traced.distances_along_row)]
            for _, search in self._tracing_states_by_kind(results)
            for traced in search.curves
            if traced.distances_along_row and leaves_range_along_rows(traced.curve, self.axis_along_row)
        ]

    def curves(self, results: Mapping[int, HalfCurveArrays]) -> TracedCurves[SpecialPointCurve]:
        """All curves, from the results of the half curves; valid if `items_to_solve(results)` is empty."""
        traced_searches = [search.traced_curves for _, search in self._tracing_states_by_kind(results)]
        curves = tuple(traced.curve for traced_search in traced_searches for traced in traced_search.curves)
        return TracedCurves(
            curves,
            max(traced_search.max_seed_distance_per_row_length for traced_search in traced_searches),
            sum(traced_search.untraced_seed_count for traced_search in traced_searches),
        )

    def _tracing_states_by_kind(
        self, results: Mapping[int, HalfCurveArrays]
    ) -> "Iterator[tuple[_CurvesOfKind, CurveTracingState[_TracedCurve]]]":
        """Yields (curves of one kind, state of the search for them), for folds and for torus points."""
        # Numbers run through all stages, but the seeds of this stage are counted from 0.
        own_results = {number - self.first_item_number: result for number, result in results.items()}
        max_distance = CURVE_IDENTITY_SETTINGS.max_distance_from_curve_per_row_length
        for kind in FOLLOWED_KIND_NOUNS:
            curves = _CurvesOfKind(kind, self, own_results)
            seeds = (i for i, point in enumerate(self.special_points) if point.kind == kind)
            yield curves, trace_all_curves(curves, seeds, max_distance)

    def solve(
        self, item: int, located: Callable[[int], Iterable[SpecialPoint]], workspace: NewtonWorkspace
    ) -> HalfCurveArrays:
        """The arrays of half curve number `item`, see `TracedHalfCurve.arrays`. located: function from the
        index of a row to the special points of the row, with their cycles. workspace: memory of matrices."""
        index, is_backward = divmod(item - self.first_item_number, 2)
        point = self.special_points[index]
        axes = self.axis_along_row, self.row_parameter_axis
        problem = SpecialCurveProblem(point.kind, *axes, workspace, -1.0 if is_backward else 1.0)
        special_points = (*self.special_points, *self.special_points_not_to_trace)
        return trace_half_curve(
            problem, point, located(point.row_index), special_points, self.values_of_rows_with_known_branches
        ).arrays()

    def row_index_of_item(self, item: int) -> int:
        """Index of the row on which half curve number `item` starts."""
        return self.special_points[(item - self.first_item_number) // 2].row_index

    def branch_starts_of_row(self, row: int) -> tuple[SpecialPoint, ...]:
        """Special points of `branch_starts_by_row` for the row with the index `row`."""
        return self.branch_starts_by_row.get(row, ())

    def item_label(self, item: int) -> str:
        """Text for half curve `item` in the progress display: kind of curve, starting row, direction."""
        index, is_backward = divmod(item - self.first_item_number, 2)
        point = self.special_points[index]
        start = f"{self.row_parameter_axis.parameter_name} = {point.row_parameter_value:.5g}"
        direction = "smaller" if is_backward else "larger"
        return f"curve of {FOLLOWED_KIND_NOUNS[point.kind]} from {start} to {direction} values"


@dataclass(frozen=True, slots=True)
class _TracedCurve:
    """A curve joined from two half curves. distances_along_row: distance from the curve to each special point
    near it, as a fraction of the row, by index of the point. crossings: as in `unexplained_crossings`."""

    curve: SpecialPointCurve
    """The curve, joined from its two halves."""
    distances_along_row: Mapping[int, float]
    crossings: tuple[RowCrossing, ...]


@dataclass(frozen=True, slots=True)
class _CurvesOfKind:
    """The curves of folds, or of torus points, as argument of `trace_all_curves`. tracer: plane and special
    points. results: arrays of solved half curves, by number from 0."""

    kind: SpecialPointKind
    tracer: SpecialCurveTracer
    results: Mapping[int, HalfCurveArrays]

    def next_seed(self, untraced: Sequence[int]) -> int:
        """The middle one of the special points `untraced`, ordered by the row parameter: the two halves of
        its curve then have similar lengths."""
        return sorted(untraced, key=self._sort_key)[len(untraced) // 2]

    def missing_work_items(self, seed: int) -> list[int]:
        """Numbers of the unsolved half curves of the curve through special point `seed`; [] if none."""
        forward_item = 2 * seed
        backward_item = 2 * seed + 1
        # Both halves are asked for at once, because the second is needed unless the first closes.
        if forward_item not in self.results:
            return [item for item in (forward_item, backward_item) if item not in self.results]
        half = TracedHalfCurve.from_arrays(self.results[forward_item]).half_curve
        # A closed curve has no second half; if the first half failed, the second is not needed.
        needs_backward = half is not None and half.end_reason is not CurveEndReason.closed
        return [backward_item] if needs_backward and backward_item not in self.results else []

    def possible_later_items(self, search: "CurveTracingState[_TracedCurve]") -> list[int]:
        """Numbers of half curves that may be needed later: half curves from special points that lie on no
        traced curve, on rows from which a half curve in `search.missing_items` starts."""
        rows = {self.tracer.special_points[item // 2].row_parameter_value for item in search.missing_items}
        # On these rows the cycles are solved again for the needed half curves anyway.
        candidates = sorted(
            (i for i in search.untried_seeds if self.tracer.special_points[i].row_parameter_value in rows),
            key=self._sort_key,
        )
        return [item for i in candidates for item in self.missing_work_items(i)]

    def curve(self, seed: int) -> _TracedCurve | None:
        """The curve through special point `seed`, joined from two halves; None if a half was not followed."""
        forward = TracedHalfCurve.from_arrays(self.results[2 * seed])
        if forward.half_curve is None:
            return None
        is_closed = forward.half_curve.end_reason is CurveEndReason.closed
        backward = (
            TracedHalfCurve(None) if is_closed else TracedHalfCurve.from_arrays(self.results[2 * seed + 1])
        )
        # Half a curve would look like a curve that ends on a row.
        if backward.half_curve is None and not is_closed:
            return None
        curve = SpecialPointCurve.joined(self.kind, forward.half_curve, backward.half_curve)
        distances = dict(forward.distances_along_row)
        for i, distance in backward.distances_along_row.items():
            distances[i] = min(distance, distances.get(i, math.inf))
        return _TracedCurve(curve, distances, forward.crossings + backward.crossings)

    def distance_along_row(self, curve: _TracedCurve, seed: int) -> float:
        """Distance along the row from special point `seed` to a curve, as a fraction of the row. inf if the
        point is not near; 0 if it lies on the straight extrapolation of the curve to a Hopf point."""
        distance = curve.distances_along_row.get(seed, math.inf)
        is_off_curve = distance > CURVE_IDENTITY_SETTINGS.max_distance_from_curve_per_row_length
        # Between its last cycle and the Hopf point a curve is extrapolated: no cycle is solved there.
        point = self.tracer.special_points[seed]
        return 0.0 if is_off_curve and self._lies_on_extrapolation(curve.curve, point) else distance

    def are_identical(self, first: _TracedCurve, second: _TracedCurve) -> bool:
        """Whether two curves are identical: their ends coincide within a tolerance."""
        return are_identical_curves(first.curve, second.curve, self.tracer.axis_along_row)

    def _sort_key(self, i: int) -> tuple[float, float]:
        """Sort key of special point i: (value of the row parameter, value of the parameter along the row)."""
        point = self.tracer.special_points[i]
        return point.row_parameter_value, point.parameter_value

    def _lies_on_extrapolation(self, curve: SpecialPointCurve, special_point: RowSpecialPoint) -> bool:
        """Whether a special point lies on the straight line from a curve's last cycle to a Hopf point."""
        # Larger cycles lie on the part of the curve that was solved.
        if special_point.tip_y_max >= SPECIAL_CURVE_END_SETTINGS.min_amplitude:
            return False
        x_axis = self.tracer.axis_along_row
        y_axis = self.tracer.row_parameter_axis
        max_distance = CURVE_IDENTITY_SETTINGS.max_last_chord_distance_per_row_length
        for end, last_point in zip(curve.hopf_ends, (curve.points[0], curve.points[-1]), strict=True):
            if end is None:
                continue
            x = x_axis.scaled_coordinate(end.parameter_value)
            y = y_axis.scaled_coordinate(end.row_parameter_value)
            # On the straight chord from the Hopf point to the last cycle.
            height = y_axis.scaled_coordinate(special_point.row_parameter_value) - y
            fraction = height / (last_point.row_coordinate - y)
            chord = x + fraction * (x_axis.scaled_coordinate(last_point.parameter_value) - x)
            distance = abs(chord - x_axis.scaled_coordinate(special_point.parameter_value))
            if 0 <= fraction <= 1 and distance <= max_distance:
                return True
        return False
