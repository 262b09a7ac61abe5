"""A region of the parameter beyond one end of the range, in which branches are followed but not stored.

A branch may leave the range, turn back at a fold beyond its end, and enter the range again; and the branch of
a Hopf point beyond the end may enter the range. Both are followed up to the place where they enter the range.
Folds and symmetry breakings in the region are located, and branches of asymmetric cycles are followed too. A
fold changes the number of multipliers outside the unit circle by one: a branch that moves away from the range
is followed only if it may have one such multiplier, because it can then come back stable.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from ...determinant.parameter_path import ParameterPath
from ...solve_progress import solve_part
from ..point_outcome import FAILURE_EXCEPTIONS
from ..unsolvable import Unsolvable
from .arc_length_step import BranchCycle
from .branch_continuation import follow_asymmetric_branch, follow_from_cycle
from .branch_curve import BranchCurve, RangeEndPassage, unstable_count_bounds
from .branch_limits import MULTIPLICATIONS_PER_WORK_UNIT, BranchLimits
from .detached_branch import complete_branch_through, cycle_in_opposite_branch_direction, lies_on_a_branch
from .range_end import cycle_with_step_into_range, index_of_passed_range_end
from .settings import BEYOND_RANGE_SETTINGS
from .special.special_point import SpecialPoint, SpecialPointKind
from .start.first_cycle import first_cycle
from .start.hopf_point import HopfBranchStart, accuracy_near_hopf_points
from .symmetry_breaking import SymmetryBreaking, symmetry_breakings_in


@dataclass(slots=True, eq=False)
class RegionBeyondRange:
    """The region beyond one end of the range of the continuation parameter. path: all rods that differ only
    in this parameter. range_end_index: 0 below the smallest coordinate of the range, 1 above the largest.
    range_limits: limits of the branches within the range. region_limits: limits of the branches in the
    region; their range is the region."""

    path: ParameterPath
    range_end_index: int
    range_limits: BranchLimits
    region_limits: BranchLimits
    remaining_work: float = field(init=False)
    """Work that may still be done in the region, in multiplications."""
    end_of_followed_part: float = field(init=False)
    """Coordinate in the region up to which branches are followed: a branch that enters the range but was not
    found passes this coordinate."""
    folds: list[SpecialPoint] = field(default_factory=list)
    """Located folds of the branches followed in the region."""
    breakings: list[SymmetryBreaking] = field(default_factory=list)
    """Located symmetry breakings of the branches followed in the region."""
    _followed_breakings: list[SymmetryBreaking] = field(default_factory=list)
    """Symmetry breakings of the region at which a followed branch of asymmetric cycles begins or ends."""
    _hopf_indices_of_branch_ends: set[int] = field(default_factory=set)
    """Indices of the Hopf points of the region at which a followed branch ends."""

    def __post_init__(self) -> None:
        self.end_of_followed_part = self.region_limits.coordinate_range[self.range_end_index]
        self.remaining_work = 0.0
        self.range_limits = replace(self.range_limits, hopfs_beyond_range=self.region_limits.hopfs)

    def set_work_limit(self) -> None:
        """Sets `remaining_work`, the limit of the work in the region; called after the branches within the
        range are followed."""
        settings = BEYOND_RANGE_SETTINGS
        work_limit = settings.work_limit_per_work_within_range * self.region_limits.workspace.work
        self.remaining_work = max(work_limit, MULTIPLICATIONS_PER_WORK_UNIT * settings.min_work_limit)

    @property
    def range_end_coordinate(self) -> float:
        """Coordinate of the continuation parameter at the end of the range where the region begins."""
        return self.region_limits.coordinate_range[1 - self.range_end_index]

    def shorten_followed_part(self, coordinate: float) -> None:
        """Moves `end_of_followed_part` to `coordinate` if this is closer to the range; at most to the end of
        the range."""
        nearer, farther = (min, max) if self.range_end_index == 1 else (max, min)
        end = nearer(self.end_of_followed_part, coordinate)
        self.end_of_followed_part = farther(self.range_end_coordinate, end)

    def range_entry_after(self, passage: RangeEndPassage) -> RangeEndPassage | None:
        """The place where a branch that leaves the range at `passage` enters it again; None if the branch
        ends, leaves the region at its other end, or cannot come back stable."""
        if passage.hopf_beyond_range_end is not None:
            self._hopf_indices_of_branch_ends |= {
                i for i, hopf in enumerate(self.region_limits.hopfs) if hopf is passage.hopf_beyond_range_end
            }
            return None
        min_count, max_count = unstable_count_bounds(passage.cycle)
        if not min_count <= 1 <= max_count:
            return None
        place = self.path.text_at(self.range_end_coordinate)
        with solve_part(f"a branch beyond {place}"), self._within_remaining_work():
            region = self.region_limits.coordinate_range
            end_index = 1 - self.range_end_index
            start = cycle_with_step_into_range(passage.cycle, region, end_index, passage.accuracy)
            if start is not None:
                return self._follow_to_range_entry(BranchCurve(start_hopf_index=-1), start, passage.accuracy)
            self.shorten_followed_part(self.range_end_coordinate)
        return None

    def range_entries_from_hopf_points(self) -> Iterator[RangeEndPassage]:
        """Yields the places where branches from the Hopf points of the region enter the range. Hopf points
        at which a followed branch ends are omitted."""
        for index, hopf in enumerate(self.region_limits.hopfs):
            if index in self._hopf_indices_of_branch_ends:
                continue
            place = self.path.text_at(hopf.parameter_coordinate)
            entry = None
            with solve_part(f"branch from the Hopf point at {place}"), self._within_remaining_work():
                entry = self._range_entry_from_hopf_point(index, hopf)
            if entry is not None:
                yield entry

    def range_entries_from_symmetry_breakings(self) -> Iterator[RangeEndPassage]:
        """Yields the places where branches of asymmetric cycles, from symmetry breakings of the region, enter
        the range. Symmetry breakings at which a followed branch begins or ends are omitted."""
        if self.breakings and not self._followed_breakings:
            work_limit = MULTIPLICATIONS_PER_WORK_UNIT * BEYOND_RANGE_SETTINGS.min_asymmetric_work_limit
            self.remaining_work = max(self.remaining_work, work_limit)
        while unfollowed := [item for item in self.breakings if item not in self._followed_breakings]:
            breaking = unfollowed[0]
            self._followed_breakings.append(breaking)
            place = self.path.text_at(self.path.coordinate(breaking.special_point.parameter_value))
            entry = None
            with solve_part(f"branch from the symmetry breaking at {place}"), self._within_remaining_work():
                limits = replace(self.region_limits, breakings=self.breakings)
                index = self.breakings.index(breaking)
                curve = follow_asymmetric_branch(index, self.path.parameter_name, limits)
                entry = self._range_entry_of(curve)
            if entry is not None:
                yield entry

    def _range_entry_from_hopf_point(self, index: int, hopf: HopfBranchStart) -> RangeEndPassage | None:
        """The place where the branch from the Hopf point `hopf`, with the index `index`, enters the range;
        None if the branch does not enter it, or if it moves away from the range and cannot come back
        stable."""
        accuracy = accuracy_near_hopf_points([hopf], self.region_limits.accuracy)
        moves_away = hopf.parameter_direction == (-1 if self.range_end_index == 0 else 1)
        # The straight rod loses stability by pairs: without the multiplier that is 1 at the Hopf point, which
        # lies outside the unit circle where Re c > 0, the number of unstable multipliers is even.
        if moves_away and hopf.normal_form_coefficients.landau.real < 0:
            return None
        try:
            first = first_cycle(hopf, accuracy, self.region_limits.workspace, self.region_limits.all_hopfs)
        except FAILURE_EXCEPTIONS:
            self.shorten_followed_part(hopf.parameter_coordinate)
            return None
        if moves_away and unstable_count_bounds(first)[0] > 1:
            return None
        if index_of_passed_range_end(first, self.region_limits.coordinate_range) != 1 - self.range_end_index:
            return self._follow_to_range_entry(BranchCurve(start_hopf_index=index), first, accuracy)
        # The first cycle already lies within the range.
        limits = replace(self.range_limits, accuracy=accuracy, locates_special_points=False)
        start = cycle_in_opposite_branch_direction(first)
        passage = follow_from_cycle(BranchCurve(start_hopf_index=-1), start, limits).end_passage
        if passage is None or passage.range_end_index != self.range_end_index:
            self.shorten_followed_part(hopf.parameter_coordinate)
            return None
        ends_at_hopf = passage.hopf_beyond_range_end is not None
        cycle = first if ends_at_hopf else cycle_in_opposite_branch_direction(passage.cycle)
        return replace(passage, cycle=cycle)

    def _follow_to_range_entry(
        self, curve: BranchCurve, first_cycle: BranchCycle, accuracy: float
    ) -> RangeEndPassage | None:
        """The place where the branch `curve`, followed from its first cycle `first_cycle`, enters the range,
        or None."""
        limits = replace(self.region_limits, accuracy=accuracy, breakings=self.breakings)
        return self._range_entry_of(follow_from_cycle(curve, first_cycle, limits))

    def _range_entry_of(self, curve: BranchCurve) -> RangeEndPassage | None:
        """Records the branch `curve`; returns the place where it enters the range, or None."""
        self._record_branch(curve)
        if curve.end_hopf_index >= 0:
            self._hopf_indices_of_branch_ends.add(curve.end_hopf_index)
        if curve.end_breaking is not None:
            self._followed_breakings.append(curve.end_breaking)
        if not curve.is_complete or not curve.stored_cycles:
            # The part of the branch that is not followed begins at its last cycle.
            self.shorten_followed_part(self.path.coordinate(curve.special_points[-1].parameter_value))
            return None
        return self._range_entry_at(curve.end_passage)

    def _range_entry_at(self, passage: RangeEndPassage | None) -> RangeEndPassage | None:
        """The place where a branch that leaves the region at `passage` enters the range, or None."""
        if passage is None or passage.range_end_index == self.range_end_index:
            return None
        # A branch that ends at a Hopf point just within the range is followed from this point.
        if passage.hopf_beyond_range_end is not None:
            return None
        return replace(passage, range_end_index=self.range_end_index)

    def range_entries_through(self, start: SpecialPoint) -> list[RangeEndPassage]:
        """The places where the branch through the special point `start` in the region enters the range; empty
        if the branch is known. Raises Unsolvable if no branch is found, or if it is not followed to its
        ends."""
        workspace = self.region_limits.workspace
        initial_work = workspace.work
        try:
            with workspace.further_work_limit(self.remaining_work):
                curve = complete_branch_through(
                    start, self.path.parameter_name, self.region_limits, self._is_branch_known
                )
        finally:
            self.remaining_work -= workspace.work - initial_work
        if curve is None:
            return []
        if not curve.is_complete:
            raise Unsolvable("the branch was not followed to both ends, so it may enter the range unseen")
        self._record_branch(curve)
        entries = map(self._range_entry_at, (curve.start_passage, curve.end_passage))
        return [entry for entry in entries if entry is not None]

    def _is_branch_known(self, curve: BranchCurve) -> bool:
        """Whether the branch `curve` has a fold of a branch that was followed before in the region."""
        return any(lies_on_a_branch(fold, [curve]) for fold in self.folds)

    def contains_special_point(self, start: SpecialPoint) -> bool:
        """Whether the special point `start` lies in the region, beyond the end of the range."""
        low, high = self.region_limits.coordinate_range
        return low < self.path.coordinate(start.parameter_value) < high

    def _record_branch(self, curve: BranchCurve) -> None:
        """Counts the cycles of the branch `curve` of the region, and records its folds and symmetry
        breakings."""
        limits = self.region_limits
        self.region_limits = replace(limits, max_cycles=limits.max_cycles - len(curve.stored_cycles))
        # The last special point of a closed branch is its first one, located again.
        special_points = curve.special_points[: -1 if curve.is_closed else None]
        points = [point for point in special_points if not point.message]
        self.folds += [point for point in points if point.kind == SpecialPointKind.fold]
        self.breakings += [
            item
            for item in symmetry_breakings_in([points])
            if not any(item.special_point.is_same_as(other.special_point) for other in self.breakings)
        ]

    @contextmanager
    def _within_remaining_work(self) -> Iterator[None]:
        """Counts the work of the `with` block, and limits it to `remaining_work`. A failure in the block is
        caught, and ends the search in the region."""
        workspace = self.region_limits.workspace
        initial_work = workspace.work
        try:
            with workspace.further_work_limit(self.remaining_work):
                yield
        except FAILURE_EXCEPTIONS:
            self.shorten_followed_part(self.range_end_coordinate)
        finally:
            self.remaining_work -= workspace.work - initial_work
