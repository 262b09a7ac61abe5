"""A region of the continuation parameter beyond one end of the range, in which branches are followed but not
stored.

A branch may leave the range, turn back at a fold beyond its end, and enter the range again; and the branch of
a Hopf point beyond the end may enter the range. Both are followed up to the place where they enter the range.
Of special points in the region only folds are located. A fold changes the number of multipliers outside the
unit circle by one: a branch that moves away from the range is followed only if it has one, and may come back
stable.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from math import isnan

from ...determinant.parameter_path import ParameterPath
from ...solve_progress import solve_part
from ..changes.thresholds_along_path import ThresholdSearchResult, find_axis_crossings
from ..point_outcome import FAILURES
from ..unsolvable import Unsolvable, WorkLimitReached
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, cycle_at_length
from .branch_continuation import follow_from_cycle, index_of_passed_range_end
from .branch_curve import BranchCurve, RangePassage, unstable_count_bounds
from .branch_limits import BranchLimits
from .branch_request import WORK_UNIT
from .detached_branch import follow_detached_branch, lies_on_any, turned_back
from .special.special_point import SpecialKind, SpecialPoint
from .start.first_cycle import first_cycle
from .start.hopf_point import HopfBranchStart, accuracy_near_hopf_points, hopf_branch_start


@dataclass(frozen=True, slots=True, kw_only=True)
class BeyondRangeSettings:
    """Settings for the continuation of branches beyond the range."""

    relative_extent: float = 0.5
    """Branches are followed up to (1 + this number) times the largest coordinate of the range and down to its
    smallest coordinate divided by (1 + this number); along F down to 0, because there is no cycle without
    force."""
    max_cycles: int = 200
    """Maximum number of cycles on all branches beyond one end of the range."""
    work_ratio: float = 1.0
    """Limit of the work beyond one end of the range, divided by the work on the branches within the range."""
    min_work_limit: float = 100.0
    """Smallest limit of the work beyond one end of the range, in `WORK_UNIT`: some seconds, ten times the
    work on a usual branch. A range without a Hopf point has no branches of its own."""


BEYOND_RANGE_SETTINGS = BeyondRangeSettings()


@dataclass(slots=True, eq=False)
class RegionBeyond:
    """The region beyond one end of the range of the continuation parameter.

    path: all rods that differ only in this parameter. index: 0 below the smallest coordinate of the range, 1
    above the largest. range_limits: limits of the branches within the range. limits: limits of the branches
    in the region; their range is the region."""

    path: ParameterPath
    index: int
    range_limits: BranchLimits
    limits: BranchLimits
    remaining_work: float = field(init=False)
    """Work that may still be done in the region, in multiplications."""
    followed_to: float = field(init=False)
    """Coordinate in the region up to which branches are followed: a branch that enters the range but was not
    found passes this coordinate."""
    folds: list[SpecialPoint] = field(default_factory=list)
    """Located folds of the branches followed in the region."""
    _ended_hopfs: set[int] = field(default_factory=set)
    """Indices of the Hopf points of the region at which a followed branch ends."""

    def __post_init__(self) -> None:
        self.followed_to = self.limits.coordinate_range[self.index]
        settings = BEYOND_RANGE_SETTINGS
        work_limit = settings.work_ratio * self.limits.workspace.work
        self.remaining_work = max(work_limit, WORK_UNIT * settings.min_work_limit)
        self._add_hopf_points()

    @property
    def range_end(self) -> float:
        """Coordinate of the end of the range at which the region begins."""
        return self.limits.coordinate_range[1 - self.index]

    def stop_at(self, coordinate: float) -> None:
        """Moves `followed_to` to `coordinate` if this is closer to the range, but not into the range."""
        nearer, farther = (min, max) if self.index == 1 else (max, min)
        self.followed_to = farther(self.range_end, nearer(self.followed_to, coordinate))

    def entry_after(self, passage: RangePassage) -> RangePassage | None:
        """The place where a branch that leaves the range at `passage` enters it again; None if the branch
        ends, leaves the region at its other end, or cannot come back stable."""
        min_count, max_count = unstable_count_bounds(passage.cycle)
        if not min_count <= 1 <= max_count:
            return None
        with solve_part(f"a branch beyond {self.path.text_at(self.range_end)}"), self._limited_work():
            start = self._with_step_into_region(passage)
            if start is not None:
                return self._entry(BranchCurve(start_hopf=-1), start, passage.accuracy)
        return None

    def entries_from_hopf_points(self) -> Iterator[RangePassage]:
        """Yields the places where branches from the Hopf points of the region enter the range. Hopf points
        at which a followed branch ends are omitted."""
        for number, hopf in enumerate(self.limits.hopfs):
            if number in self._ended_hopfs:
                continue
            place = self.path.text_at(hopf.parameter_coordinate)
            entry = None
            with solve_part(f"branch from the Hopf point at {place}"), self._limited_work():
                entry = self._entry_from_hopf_point(number, hopf)
            if entry is not None:
                yield entry

    def _with_step_into_region(self, passage: RangePassage) -> BranchCycle | None:
        """The cycle of `passage`, with a next step that ends in the region although a fold may follow
        closely. Returns None and closes the region if even the shortest step does not end there."""
        start = passage.cycle
        length = start.next_arc_length
        while length >= ARC_STEP_CONTROL.min_length:
            try:
                end = cycle_at_length(start, length, passage.accuracy)
                if index_of_passed_range_end(end, self.limits.coordinate_range) != 1 - self.index:
                    return replace(start, next_arc_length=length)
            except WorkLimitReached:
                break
            except Unsolvable:
                pass  # the step is too long for the prediction
            length /= 2
        self.stop_at(self.range_end)
        return None

    def _entry_from_hopf_point(self, number: int, hopf: HopfBranchStart) -> RangePassage | None:
        """The place where the branch from the Hopf point `hopf` with the index `number` enters the range."""
        accuracy = accuracy_near_hopf_points([hopf], self.limits.accuracy)
        moves_away = hopf.direction == (-1 if self.index == 0 else 1)
        # The straight rod loses stability by pairs: without the multiplier that is 1 at the Hopf point, which
        # lies outside the unit circle where Re c > 0, the number of unstable multipliers is even.
        if moves_away and hopf.coefficients.landau.real < 0:
            return None
        try:
            first = first_cycle(hopf, accuracy, self.limits.workspace)
        except FAILURES:
            self.stop_at(hopf.parameter_coordinate)
            return None
        if moves_away and unstable_count_bounds(first)[0] > 1:
            return None
        if index_of_passed_range_end(first, self.limits.coordinate_range) != 1 - self.index:
            return self._entry(BranchCurve(start_hopf=number), first, accuracy)
        # The first cycle already lies within the range.
        limits = replace(self.range_limits, accuracy=accuracy, locates_special_points=False)
        passage = follow_from_cycle(BranchCurve(start_hopf=-1), turned_back(first), limits).end_passage
        if passage is None or passage.index != self.index:
            self.stop_at(hopf.parameter_coordinate)
            return None
        return replace(passage, cycle=turned_back(passage.cycle))

    def _entry(self, curve: BranchCurve, first_cycle: BranchCycle, accuracy: float) -> RangePassage | None:
        """Follows the branch `curve` from its first cycle `first_cycle` in the region; returns the place
        where it enters the range, or None."""
        curve = follow_from_cycle(curve, first_cycle, replace(self.limits, accuracy=accuracy))
        self.limits = replace(self.limits, max_cycles=self.limits.max_cycles - len(curve.points))
        self._add_folds(curve)
        if curve.end_hopf >= 0:
            self._ended_hopfs.add(curve.end_hopf)
        if not curve.complete:
            # The part of the branch that is not followed begins at its last cycle.
            self.stop_at(self.path.coordinate(curve.points[-1].parameter_value))
        passage = curve.end_passage
        return None if passage is None or passage.index == self.index else replace(passage, index=self.index)

    def entries_through(self, start: SpecialPoint) -> list[RangePassage]:
        """The places where the branch through the special point `start` in the region enters the range.
        Empty if the branch is known. Raises Unsolvable if no branch is found, or if it is not followed to its
        ends."""
        workspace = self.limits.workspace
        initial_work = workspace.work
        try:
            with workspace.further_limit(self.remaining_work):
                curve = follow_detached_branch(start, self.path.name, self.limits)
        finally:
            self.remaining_work -= workspace.work - initial_work
        if any(lies_on_any(fold, [curve]) for fold in self.folds):
            return []
        if start.kind == SpecialKind.fold and not lies_on_any(start, [curve]):
            raise Unsolvable("the branch found does not pass this point")
        if not curve.complete:
            raise Unsolvable("the branch is not followed to its ends")
        self.limits = replace(self.limits, max_cycles=self.limits.max_cycles - len(curve.points))
        self._add_folds(curve)
        passages = (curve.start_passage, curve.end_passage)
        return [replace(p, index=self.index) for p in passages if p is not None and p.index != self.index]

    def has(self, start: SpecialPoint) -> bool:
        """Whether the special point `start` lies in the region, beyond the end of the range."""
        low, high = self.limits.coordinate_range
        return low < self.path.coordinate(start.parameter_value) < high

    def _add_folds(self, curve: BranchCurve) -> None:
        # The last special point of a closed branch is its first one, located again.
        points = curve.special_points[: -1 if curve.closed else None]
        self.folds += [point for point in points if point.kind == SpecialKind.fold and not point.message]

    @contextmanager
    def _limited_work(self) -> Iterator[None]:
        """Counts the work of the `with` block, and limits it to `remaining_work`. A failure
        in the block is caught, and closes the region."""
        workspace = self.limits.workspace
        initial_work = workspace.work
        try:
            with workspace.further_limit(self.remaining_work):
                yield
        except FAILURES:
            self.stop_at(self.range_end)
        finally:
            self.remaining_work -= workspace.work - initial_work

    def _add_hopf_points(self) -> None:
        """Finds the Hopf points of the region and their normal forms."""
        low, high = sorted(map(self.path.parameter.value, self.limits.coordinate_range))
        try:
            search = find_axis_crossings(self.path, low, high, certify=False)
        except FAILURES:
            self.stop_at(self.range_end)
            return
        self._stop_where_search_is_incomplete(search)
        hopfs = []
        for crossing in search.thresholds:
            others = (hopf.crossing for hopf in self.range_limits.hopfs)  # the Hopf points within the range
            if any(abs(crossing.value - other.value) <= crossing.error + other.error for other in others):
                continue
            try:
                unit = self.limits.min_coordinate_unit
                hopfs.append(hopf_branch_start(self.path, crossing, self.limits.keeps_omega, unit))
            except FAILURES:
                self.stop_at(self.path.coordinate(crossing.value))
        self.limits = replace(self.limits, hopfs=hopfs)

    def _stop_where_search_is_incomplete(self, search: ThresholdSearchResult) -> None:
        """Moves `followed_to` to the place beyond which `search` may lack Hopf points."""
        if search.ended_early:
            # The search begins at the smallest coordinate.
            end = max(map(self.path.coordinate, search.searched_interval))
            self.stop_at(end if self.index == 1 else self.range_end)
        if not isnan(search.open_range[0]):
            unsearched = [self.path.coordinate(value) for value in search.open_range]
            self.stop_at(min(unsearched) if self.index == 1 else max(unsearched))
