"""All branches of a rod: from Hopf points, from symmetry breakings, and through known special points that no
Hopf point leads to. A branch is followed only once, also if it has two starting points."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from ...solve_progress import solve_part
from ..point_outcome import FAILURES, cause_of
from ..unsolvable import Unsolvable
from .branch_continuation import follow_asymmetric_branch, follow_branch
from .branch_curve import BranchCurve
from .branch_limits import BranchLimits
from .computing_time import fractions_before_branches
from .detached_branch import follow_detached_branch, lies_on_any
from .special.special_point import SpecialKind, SpecialPoint
from .symmetry_breaking import SymmetryBreaking, symmetry_breakings_in


@dataclass(slots=True, eq=False)
class BranchSearch:
    """Search for the branches of a rod along the parameter `name`. limits: limits of all branches; its
    `max_cycles` is the maximum number of cycles on all branches together."""

    limits: BranchLimits
    name: str
    curves: list[BranchCurve] = field(default_factory=list)
    """Branches followed so far."""
    failures: list[str] = field(default_factory=list)
    """Messages on known special points through which no branch was followed."""
    followed_breakings: list[SymmetryBreaking] = field(default_factory=list)
    """Symmetry breakings at which a followed branch of asymmetric cycles starts or ends."""

    def follow_all(self, starts: Iterable[SpecialPoint]) -> None:
        """Follows all branches. starts: known special points, as for `follow_through`."""
        self.follow_from_hopf_points()
        self.follow_from_symmetry_breakings()
        self.follow_through(starts)

    def _limits_left(self) -> BranchLimits:
        cycles_left = self.limits.max_cycles - sum(len(curve.points) for curve in self.curves)
        return replace(self.limits, max_cycles=cycles_left)

    def follow_from_hopf_points(self) -> None:
        """Follows the branches from all Hopf points; a branch between two Hopf points only once."""
        count = len(self.limits.hopfs)
        fractions = fractions_before_branches(
            [hopf.parameter_coordinate for hopf in self.limits.hopfs], self.limits.coordinate_range
        )
        for number in range(count):
            if any(curve.end_hopf == number for curve in self.curves):
                continue
            with solve_part(
                f"branch from Hopf point {number + 1} of {count}", (fractions[number], fractions[number + 1])
            ):
                self.curves.append(follow_branch(number, self._limits_left()))

    def follow_from_symmetry_breakings(self) -> None:
        """Follows the branches of asymmetric cycles from all symmetry breakings on the branches so far; a
        branch between two symmetry breakings only once."""
        breakings = symmetry_breakings_in([curve.special_points for curve in self.curves])
        for index, breaking in enumerate(breakings):
            if breaking in self.followed_breakings:
                continue
            with solve_part(f"branch {len(self.curves) + 1}, of asymmetric cycles"):
                limits = replace(self._limits_left(), breakings=breakings)
                curve = follow_asymmetric_branch(index, self.name, limits)
            self.followed_breakings += filter(None, [breaking, curve.end_breaking])
            self.curves.append(curve)

    def follow_through(self, starts: Iterable[SpecialPoint]) -> None:
        """Follows the branches through the special points `starts` that lie on no branch so far, and the
        branches of asymmetric cycles from symmetry breakings on these branches."""
        for start in starts:
            if lies_on_any(start, self.curves):
                continue
            place = f"{_WORDS[start.kind]} at {self.name} = {start.at:.9g}"
            with solve_part(f"branch {len(self.curves) + 1}, through the {place}"):
                try:
                    self._follow_detached(start)
                except FAILURES as error:
                    self.failures.append(f"no branch is followed through the {place}: {cause_of(error)}")
            self.follow_from_symmetry_breakings()

    def _follow_detached(self, start: SpecialPoint) -> None:
        """Appends the branch through `start`, unless it is a branch that was followed before: the crossing is
        then an artefact of the mesh of its curve, as beyond the end of a curve of folds at a symmetry
        breaking, where a mesh rounds off the corner between two branches. Raises Unsolvable if no branch
        passes `start`."""
        breakings = symmetry_breakings_in([curve.special_points for curve in self.curves])
        limits = replace(self._limits_left(), breakings=breakings)
        if limits.max_cycles < 1:
            raise Unsolvable("the branches of the rod have the maximum number of cycles")
        curve = follow_detached_branch(start, self.name, limits)
        # At an end of the range two branches may agree within tolerances; elsewhere they do not.
        inner = (point for point in curve.special_points if point.kind != SpecialKind.end)
        if any(lies_on_any(point, self.curves) for point in inner):
            return
        if not lies_on_any(start, [curve]):
            raise Unsolvable("the branch found does not pass this point")
        self.followed_breakings += filter(None, [curve.start_breaking, curve.end_breaking])
        self.curves.append(curve)


_WORDS = {SpecialKind.fold: "fold", SpecialKind.torus: "torus point"}
"""Nouns for the special points through which branches are followed."""
