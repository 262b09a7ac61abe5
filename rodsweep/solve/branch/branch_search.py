"""All branches of a rod: from Hopf points, from symmetry breakings, through known special points to which no
Hopf point leads, and branches that enter the range from beyond. A branch with two starting points is followed
only once."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

from ...model.parameters import PARAMETERS
from ...solve_progress import solve_part
from ..point_outcome import FAILURE_EXCEPTIONS, cause_of
from ..unsolvable import Unsolvable
from .branch_continuation import (
    follow_asymmetric_branch,
    follow_branch_from_hopf_point,
    follow_from_range_end,
)
from .branch_curve import BranchCurve, RangeEndPassage
from .branch_limits import BranchLimits
from .computing_time import time_fractions_before_branches
from .detached_branch import complete_branch_through, lies_on_a_branch
from .region_beyond_range import RegionBeyondRange
from .special.special_point import SpecialPoint, SpecialPointKind
from .symmetry_breaking import SymmetryBreaking, symmetry_breakings_in


@dataclass(slots=True, eq=False)
class BranchSearch:
    """Search for the branches of a rod along the parameter `parameter_name`. limits: limits of all branches;
    their `max_cycles` is the maximum number of cycles on all branches together."""

    limits: BranchLimits
    parameter_name: str
    regions: Sequence[RegionBeyondRange] = ()
    """Regions beyond the range in which branches are followed."""
    curves: list[BranchCurve] = field(default_factory=list)
    """Branches followed so far."""
    failures: list[str] = field(default_factory=list)
    """Messages on known special points through which no branch was followed."""
    followed_breakings: list[SymmetryBreaking] = field(default_factory=list)
    """Symmetry breakings at which a followed branch of asymmetric cycles starts or ends."""
    followed_passages: list[RangeEndPassage] = field(default_factory=list)
    """Places at the ends of the range from which a branch was followed beyond the range, or to which a branch
    was followed from there."""

    @property
    def followed_range(self) -> tuple[float, float]:
        """Smallest and largest value of the parameter up to which branches are followed."""
        coordinates = [
            *self.limits.coordinate_range,
            *(region.end_of_followed_part for region in self.regions),
        ]
        values = [PARAMETERS[self.parameter_name].value(coordinate) for coordinate in coordinates]
        return min(values), max(values)

    @property
    def folds_beyond_range(self) -> list[SpecialPoint]:
        """Folds of the branches followed beyond the range."""
        return [
            fold for region in self.regions for fold in region.folds if region.contains_special_point(fold)
        ]

    def __post_init__(self) -> None:
        hopfs = [hopf for region in self.regions for hopf in region.region_limits.hopfs]
        # A branch within the range may end at a Hopf point just beyond its end.
        self.limits = replace(self.limits, hopfs_beyond_range=hopfs)

    def follow_all(self, starts: Iterable[SpecialPoint]) -> None:
        """Follows the branches within the range, then those from beyond the range, then those through the
        special points `starts`."""
        self.follow_from_hopf_points()
        self.follow_from_symmetry_breakings()
        self.follow_from_beyond_into_range()
        # Before the given starts, which may lie on the same branches.
        self.follow_through_special_points(self._folds_within_range_from_beyond())
        self.follow_through_special_points(starts)
        self._add_messages_on_shared_range_ends()

    def follow_from_beyond_into_range(self) -> None:
        """Follows branches from the range into `regions`, and branches from `regions` into the range."""
        for region in self.regions:
            # The work allowed beyond the range depends on the work that the branches within took.
            region.set_work_limit()
        self.follow_beyond_range()
        for region in self.regions:
            for entry in region.range_entries_from_hopf_points():
                self._follow_branch_into_range(entry, region)
        self._follow_from_breakings_beyond_range()
        self.follow_beyond_range()

    def _add_messages_on_shared_range_ends(self) -> None:
        """Adds a message for every two branches that leave the range at the same cycle: a step led from one
        branch to another, which nearly touches it."""
        ends = [(i, place) for i, curve in enumerate(self.curves, 1) for place in _passages_of(curve)]
        for (i, place), (j, other) in combinations(ends, 2):
            if i != j and place.has_same_cycle_as(other):
                value = PARAMETERS[self.parameter_name].value(
                    self.limits.coordinate_range[place.range_end_index]
                )
                same = f"branches {i} and {j} have the same cycle at {self.parameter_name} = {value:.9g}"
                self.failures.append(f"{same}: two branches nearly touch")

    def _limits_of_next_branch(self) -> BranchLimits:
        """Limits of the next branch, with the symmetry breakings found so far."""
        cycles_left = self.limits.max_cycles - sum(len(curve.stored_cycles) for curve in self.curves)
        breakings = symmetry_breakings_in([curve.special_points for curve in self.curves])
        return replace(self.limits, max_cycles=cycles_left, breakings=breakings)

    def follow_from_hopf_points(self) -> None:
        """Follows the branches from all Hopf points; a branch between two Hopf points only once."""
        hopf_count = len(self.limits.hopfs)
        progress_fractions = time_fractions_before_branches(
            [hopf.parameter_coordinate for hopf in self.limits.hopfs], self.limits.coordinate_range
        )
        for hopf_index in range(hopf_count):
            # The branch was followed from its other end already.
            if any(curve.end_hopf_index == hopf_index for curve in self.curves):
                continue
            with solve_part(
                f"branch from Hopf point {hopf_index + 1} of {hopf_count}",
                (progress_fractions[hopf_index], progress_fractions[hopf_index + 1]),
            ):
                self.curves.append(follow_branch_from_hopf_point(hopf_index, self._limits_of_next_branch()))

    def follow_from_symmetry_breakings(self) -> None:
        """Follows the branches of asymmetric cycles from all symmetry breakings found so far; a branch
        between two symmetry breakings only once."""
        for index, breaking in enumerate(self._limits_of_next_branch().breakings):
            if breaking in self.followed_breakings:
                continue
            with solve_part(f"branch {len(self.curves) + 1}, of asymmetric cycles"):
                # A branch of asymmetric cycles adds no symmetry breaking, so the indices stay.
                curve = follow_asymmetric_branch(index, self.parameter_name, self._limits_of_next_branch())
            self.followed_breakings += filter(None, [breaking, curve.end_breaking])
            self.curves.append(curve)

    def _folds_within_range_from_beyond(self) -> list[SpecialPoint]:
        """Folds inside the range between successive cycles beyond it, on branches followed there."""
        low, high = self.limits.coordinate_range
        coordinate = PARAMETERS[self.parameter_name].coordinate
        folds = (fold for region in self.regions for fold in region.folds)
        return [fold for fold in folds if low < coordinate(fold.parameter_value) < high]

    def follow_through_special_points(self, starts: Iterable[SpecialPoint]) -> None:
        """Follows the branches through the special points `starts` that lie on no known branch, and the
        branches of asymmetric cycles from symmetry breakings on these branches."""
        for start in starts:
            # Tested for each start anew, as the branch of one start may pass the next.
            if lies_on_a_branch(start, self.curves):
                continue
            place = (
                f"{_SPECIAL_POINT_NOUNS[start.kind]} at {self.parameter_name} = {start.parameter_value:.9g}"
            )
            with solve_part(f"branch {len(self.curves) + 1}, through the {place}"):
                try:
                    self._follow_detached(start)
                except FAILURE_EXCEPTIONS as error:
                    self.failures.append(f"no branch is followed through the {place}: {cause_of(error)}")
            self.follow_beyond_range()

    def follow_beyond_range(self) -> None:
        """Follows the branches that leave the range, beyond its ends; where a branch enters the range again,
        it continues as a further branch. Then follows the branches from symmetry breakings on these further
        branches."""
        # The list grows inside the loop: a branch that enters may leave again.
        while unfollowed := [
            place for place in self._range_end_passages() if place not in self.followed_passages
        ]:
            passage = unfollowed[0]
            self.followed_passages.append(passage)
            for region in self.regions:
                entry = (
                    region.range_entry_after(passage)
                    if region.range_end_index == passage.range_end_index
                    else None
                )
                if entry is not None:
                    self._follow_branch_into_range(entry, region, passage)
            self._follow_from_breakings_beyond_range()
            self.follow_from_symmetry_breakings()

    def _follow_from_breakings_beyond_range(self) -> None:
        """Follows branches of asymmetric cycles from symmetry breakings beyond the range into the range."""
        for region in self.regions:
            for entry in region.range_entries_from_symmetry_breakings():
                self._follow_branch_into_range(entry, region)

    def _range_end_passages(self) -> Iterator[RangeEndPassage]:
        """Places at which the branches followed so far leave or enter the range."""
        return (place for curve in self.curves for place in _passages_of(curve))

    def _follow_branch_into_range(
        self, entry: RangeEndPassage, region: RegionBeyondRange, left_at: RangeEndPassage | None = None
    ) -> None:
        """Appends the branch that enters the range at `entry`, unless a branch followed before leaves the
        range there. region: region from which the branch comes. left_at: place at which the branch left the
        range before."""
        known_passages = [p for p in self._range_end_passages() if p is not left_at and p.is_same_as(entry)]
        # The branch that leaves there leads to this entry, so it need not be followed in the other direction.
        self.followed_passages += known_passages
        limits = self._limits_of_next_branch()
        if known_passages:
            return
        if limits.max_cycles < 1:
            # A branch that enters was found but not followed, so nothing beyond counts as searched.
            region.shorten_followed_part(region.range_end_coordinate)
            return
        with solve_part(f"branch {len(self.curves) + 1}, from beyond the range"):
            curve = follow_from_range_end(entry, limits)
        self.followed_breakings += filter(None, [curve.end_breaking])
        self.curves.append(curve)
        self.followed_passages.append(entry)

    def _follow_detached(self, start: SpecialPoint) -> None:
        """Appends the branch through `start`, or its parts that enter the range if `start` lies beyond it.
        Raises Unsolvable if no branch passes `start`."""
        regions = [region for region in self.regions if region.contains_special_point(start)]
        if not regions:
            self._follow_detached_within_range(start)
        for region in regions:
            for entry in region.range_entries_through(start):
                self._follow_branch_into_range(entry, region)

    def _follow_detached_within_range(self, start: SpecialPoint) -> None:
        """Appends the branch found at `start`, unless this branch was followed before: `start` is then an
        artefact of the mesh of its curve of special points, for example beyond the end of a curve of folds at
        a symmetry breaking, where a mesh rounds off the corner between two branches. Raises Unsolvable as
        `complete_branch_through` does, and if the branches already have the maximum number of cycles."""
        limits = self._limits_of_next_branch()
        if limits.max_cycles < 1:
            raise Unsolvable("the branches of the rod have the maximum number of cycles; shorten the range")
        curve = complete_branch_through(start, self.parameter_name, limits, self._is_branch_known)
        if curve is not None:
            self.followed_breakings += filter(None, [curve.start_breaking, curve.end_breaking])
            self.curves.append(curve)

    def _is_branch_known(self, curve: BranchCurve) -> bool:
        """Whether the branch `curve` has a special point of a branch that was followed before."""
        # At an end of the range two branches may agree within tolerances; elsewhere they do not.
        inner_points = (point for point in curve.special_points if point.kind != SpecialPointKind.end)
        return any(lies_on_a_branch(point, self.curves) for point in inner_points)


def _passages_of(curve: BranchCurve) -> list[RangeEndPassage]:
    """Places at which a branch enters or leaves the range."""
    return [place for place in (curve.start_passage, curve.end_passage) if place is not None]


_SPECIAL_POINT_NOUNS = {SpecialPointKind.fold: "fold", SpecialPointKind.torus: "torus point"}
"""Nouns for the special points through which branches are followed."""
