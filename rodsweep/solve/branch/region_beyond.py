"""A region of the parameter beyond one end of the range, in which branches are followed but not stored.

A branch may leave the range, turn back at a fold beyond its end, and enter the range again; and the branch of
a Hopf point beyond the end may enter the range. Both are followed up to the place where they enter the range.
Folds and symmetry breakings in the region are located, and branches of asymmetric cycles are followed too. A
fold changes the number of multipliers outside the unit circle by one: a branch that moves away from the range
is followed only if it has one, and may come back stable.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from ...determinant.parameter_path import ParameterPath
from ...solve_progress import solve_part
from ..point_outcome import FAILURES
from ..unsolvable import Unsolvable, WorkLimitReached
from .arc_length_step import ARC_STEP_CONTROL, BranchCycle, cycle_at_length
from .branch_continuation import follow_asymmetric_branch, follow_from_cycle
from .branch_curve import BranchCurve, RangePassage, unstable_count_bounds
from .branch_limits import WORK_UNIT, BranchLimits
from .detached_branch import complete_branch_through, lies_on_a_branch, reversed_cycle
from .range_end import index_of_passed_range_end
from .settings import BEYOND_RANGE_SETTINGS
from .special.special_point import SpecialKind, SpecialPoint
from .start.first_cycle import first_cycle
from .start.hopf_point import HopfBranchStart, accuracy_near_hopf_points
from .symmetry_breaking import SymmetryBreaking, symmetry_breakings_in


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
    breakings: list[SymmetryBreaking] = field(default_factory=list)
    """Located symmetry breakings of the branches followed in the region."""
    _followed_breakings: list[SymmetryBreaking] = field(default_factory=list)
    _ended_hopfs: set[int] = field(default_factory=set)
    """Indices of the Hopf points of the region at which a followed branch ends."""

    def __post_init__(self) -> None:
        self.followed_to = self.limits.coordinate_range[self.index]
        self.remaining_work = 0.0
        self.range_limits = replace(self.range_limits, hopfs_beyond=self.limits.hopfs)

    def begin(self) -> None:
        """Sets the limit of the work in the region, after the branches within the range are followed."""
        settings = BEYOND_RANGE_SETTINGS
        work_limit = settings.work_ratio * self.limits.workspace.work
        self.remaining_work = max(work_limit, WORK_UNIT * settings.min_work_limit)

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
        if passage.hopf is not None:
            self._ended_hopfs |= {i for i, hopf in enumerate(self.limits.hopfs) if hopf is passage.hopf}
            return None
        min_count, max_count = unstable_count_bounds(passage.cycle)
        if not min_count <= 1 <= max_count:
            return None
        with solve_part(f"a branch beyond {self.path.text_at(self.range_end)}"), self._limited_work():
            start = self._with_step_into_region(passage)
            if start is not None:
                return self._follow(BranchCurve(start_hopf=-1), start, passage.accuracy)
        return None

    def entries_from_hopf_points(self) -> Iterator[RangePassage]:
        """Yields the places where branches from the Hopf points of the region enter the range. Hopf points
        at which a followed branch ends are omitted."""
        for index, hopf in enumerate(self.limits.hopfs):
            if index in self._ended_hopfs:
                continue
            place = self.path.text_at(hopf.parameter_coordinate)
            entry = None
            with solve_part(f"branch from the Hopf point at {place}"), self._limited_work():
                entry = self._entry_from_hopf_point(index, hopf)
            if entry is not None:
                yield entry

    def entries_from_symmetry_breakings(self) -> Iterator[RangePassage]:
        """Yields the places where branches of asymmetric cycles, from symmetry breakings of the region, enter
        the range. Symmetry breakings at which a followed branch begins or ends are omitted."""
        if self.breakings and not self._followed_breakings:
            work_limit = WORK_UNIT * BEYOND_RANGE_SETTINGS.min_asymmetric_work_limit
            self.remaining_work = max(self.remaining_work, work_limit)
        while unfollowed := [item for item in self.breakings if item not in self._followed_breakings]:
            breaking = unfollowed[0]
            self._followed_breakings.append(breaking)
            place = self.path.text_at(self.path.coordinate(breaking.special_point.parameter_value))
            entry = None
            with solve_part(f"branch from the symmetry breaking at {place}"), self._limited_work():
                limits = replace(self.limits, breakings=self.breakings)
                index = self.breakings.index(breaking)
                curve = follow_asymmetric_branch(index, self.path.name, limits)
                entry = self._entry_of(curve)
            if entry is not None:
                yield entry

    def _with_step_into_region(self, passage: RangePassage) -> BranchCycle | None:
        """The cycle of `passage`, with a next step that ends in the region although a fold may follow. If the
        shortest step does not end there, returns None, and the region is not searched further."""
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

    def _entry_from_hopf_point(self, index: int, hopf: HopfBranchStart) -> RangePassage | None:
        """The place where the branch from the Hopf point `hopf`, of index `index`, enters the range."""
        accuracy = accuracy_near_hopf_points([hopf], self.limits.accuracy)
        moves_away = hopf.direction == (-1 if self.index == 0 else 1)
        # The straight rod loses stability by pairs: without the multiplier that is 1 at the Hopf point, which
        # lies outside the unit circle where Re c > 0, the number of unstable multipliers is even.
        if moves_away and hopf.coefficients.landau.real < 0:
            return None
        try:
            first = first_cycle(hopf, accuracy, self.limits.workspace, self.limits.all_hopfs)
        except FAILURES:
            self.stop_at(hopf.parameter_coordinate)
            return None
        if moves_away and unstable_count_bounds(first)[0] > 1:
            return None
        if index_of_passed_range_end(first, self.limits.coordinate_range) != 1 - self.index:
            return self._follow(BranchCurve(start_hopf=index), first, accuracy)
        # The first cycle already lies within the range.
        limits = replace(self.range_limits, accuracy=accuracy, locates_special_points=False)
        passage = follow_from_cycle(BranchCurve(start_hopf=-1), reversed_cycle(first), limits).end_passage
        if passage is None or passage.index != self.index:
            self.stop_at(hopf.parameter_coordinate)
            return None
        return replace(passage, cycle=reversed_cycle(passage.cycle) if passage.hopf is None else first)

    def _follow(self, curve: BranchCurve, first_cycle: BranchCycle, accuracy: float) -> RangePassage | None:
        """Follows the branch `curve` from its first cycle `first_cycle` in the region; returns the place
        where it enters the range, or None."""
        limits = replace(self.limits, accuracy=accuracy, breakings=self.breakings)
        return self._entry_of(follow_from_cycle(curve, first_cycle, limits))

    def _entry_of(self, curve: BranchCurve) -> RangePassage | None:
        """The place where the branch `curve`, followed to its end in the region, enters the range, or
        None."""
        self.limits = replace(self.limits, max_cycles=self.limits.max_cycles - len(curve.points))
        self._add_special_points(curve)
        if curve.end_hopf >= 0:
            self._ended_hopfs.add(curve.end_hopf)
        if curve.end_breaking is not None:
            self._followed_breakings.append(curve.end_breaking)
        if not curve.complete or not curve.points:
            # The part of the branch that is not followed begins at its last cycle.
            self.stop_at(self.path.coordinate(curve.special_points[-1].parameter_value))
            return None
        passage = curve.end_passage
        # A branch that ends at a Hopf point just within the range is followed from this point.
        if passage is None or passage.index == self.index or passage.hopf is not None:
            return None
        return replace(passage, index=self.index)

    def entries_through(self, start: SpecialPoint) -> list[RangePassage]:
        """The places where the branch through the special point `start` in the region enters the range; empty
        if the branch is known. Raises Unsolvable if no branch is found, or if it is not followed to its
        ends."""
        workspace = self.limits.workspace
        initial_work = workspace.work
        try:
            with workspace.further_limit(self.remaining_work):
                curve = complete_branch_through(start, self.path.name, self.limits, self._is_known)
        finally:
            self.remaining_work -= workspace.work - initial_work
        if curve is None:
            return []
        if not curve.complete:
            raise Unsolvable("the branch was not followed to both ends, so it may enter the range unseen")
        self.limits = replace(self.limits, max_cycles=self.limits.max_cycles - len(curve.points))
        self._add_special_points(curve)
        passages = (curve.start_passage, curve.end_passage)
        return [
            replace(passage, index=self.index)
            for passage in passages
            if passage is not None and passage.index != self.index and passage.hopf is None
        ]

    def _is_known(self, curve: BranchCurve) -> bool:
        """Whether a branch has a fold of a branch that was followed before in the region."""
        return any(lies_on_a_branch(fold, [curve]) for fold in self.folds)

    def has(self, start: SpecialPoint) -> bool:
        """Whether the special point `start` lies in the region, beyond the end of the range."""
        low, high = self.limits.coordinate_range
        return low < self.path.coordinate(start.parameter_value) < high

    def _add_special_points(self, curve: BranchCurve) -> None:
        # The last special point of a closed branch is its first one, located again.
        points = [
            point for point in curve.special_points[: -1 if curve.closed else None] if not point.message
        ]
        self.folds += [point for point in points if point.kind == SpecialKind.fold]
        self.breakings += [
            item
            for item in symmetry_breakings_in([points])
            if not any(item.special_point.is_same_as(other.special_point) for other in self.breakings)
        ]

    @contextmanager
    def _limited_work(self) -> Iterator[None]:
        """Counts the work of the `with` block, and limits it to `remaining_work`. A failure in the block is
        caught, and ends the search in the region."""
        workspace = self.limits.workspace
        initial_work = workspace.work
        try:
            with workspace.further_limit(self.remaining_work):
                yield
        except FAILURES:
            self.stop_at(self.range_end)
        finally:
            self.remaining_work -= workspace.work - initial_work
