"""A branch as stored in the result file: parameter, period, amplitude, errors and multiplier of each cycle,
and special points."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...model.floquet import min_unstable_multiplier_count
from ..cycle.accuracy.cycle_errors import CycleErrors
from ..cycle.accuracy.settings import REFINEMENT_SETTINGS
from ..orbit.measures import CycleMeasures
from .arc_length_step import BranchCycle
from .special.special_point import SPECIAL_POINT_SETTINGS, SpecialPoint
from .start.hopf_point import HopfBranchStart
from .symmetry_breaking import SymmetryBreaking


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredBranchCycle:
    """Stored quantities of one cycle of a branch. measures: period, extrema, harmonics and powers."""

    parameter_value: float
    """Value of the continuation parameter."""
    parameter_value_error: float
    """Relative difference of `parameter_value` from the parameter value of the exact cycle with the same
    deflection."""
    measures: CycleMeasures
    errors: CycleErrors
    """Errors relative to the exact cycle at the same value of the parameter."""
    multiplier: float
    """Modulus of the largest nontrivial Floquet multiplier."""
    unstable_count: int
    """Number of nontrivial Floquet multipliers outside the unit circle; -1 if the modulus of one of these
    multipliers is 1 within its error."""

    @classmethod
    def from_cycle(cls, point: BranchCycle, accuracy: float) -> "StoredBranchCycle":
        """The stored quantities of the cycle `point`. accuracy: relative accuracy to which the cycle was
        solved."""
        cycle = point.cycle
        least_count, largest_count = unstable_count_bounds(point)
        return cls(
            parameter_value=getattr(point.orbit.form.rod, point.scale.parameter_name),
            parameter_value_error=point.calibration.parameter_error(accuracy),
            measures=cycle.measures,
            errors=cycle.errors,
            multiplier=cycle.largest_multiplier_modulus,
            unstable_count=least_count if least_count == largest_count else -1,
        )

    @property
    def min_unstable_multiplier_count(self) -> int:
        """Lower bound on the number of nontrivial multipliers outside the unit circle: 0 if the cycle is
        stable, -1 if its stability is unknown."""
        return min_unstable_multiplier_count(
            self.unstable_count, self.multiplier, self.errors.multiplier_error
        )


def unstable_count_bounds(point: BranchCycle) -> tuple[int, int]:
    """Smallest and largest possible number of nontrivial multipliers of the cycle `point` outside the unit
    circle, within their errors."""
    modulus_excess = np.abs(point.cycle.multipliers) - 1
    error = _multiplier_modulus_error(point)
    return int((modulus_excess > error).sum()), int((modulus_excess >= -error).sum())


def _multiplier_modulus_error(point: BranchCycle) -> float:
    """Error of the modulus of a multiplier of the cycle `point` near the unit circle: relative error of the
    largest multiplier, plus a multiple of the error of the trivial multiplier, whose exact value is 1."""
    cycle = point.cycle
    relative_error = cycle.errors.multiplier_error / max(cycle.largest_multiplier_modulus, 1.0)
    # The trivial multiplier is exactly 1: its distance from 1 shows the effect of the mesh.
    return (
        relative_error
        + REFINEMENT_SETTINGS.multiplier_error_per_matrix_distance * cycle.trivial_multiplier_error
    )


@dataclass(frozen=True, slots=True, eq=False)
class RangeEndPassage:
    """Place where a branch leaves or enters the parameter range. cycle: the cycle there, with the tangent
    along which the branch is followed. range_end_index: 0 at the smallest coordinate of the range, 1 at the
    largest. accuracy: relative accuracy of the branch."""

    cycle: BranchCycle
    range_end_index: int
    accuracy: float
    hopf_beyond_range_end: HopfBranchStart | None = None
    """Hopf point just beyond the end of the range where the branch ends, or None. With such a Hopf point,
    `cycle` is the cycle of the branch within the range that is nearest to its end."""
    normal_form_end_point: SpecialPoint | None = None
    """The cycle at the end of the range, computed from the normal form of `hopf_beyond_range_end`; None
    without `hopf_beyond_range_end`."""

    def is_same_as(self, other: "RangeEndPassage") -> bool:
        """Whether this passage and the passage `other`, of another branch, are at the same cycle or at mirror
        images, whichever way the branches pass: the end of the range, the period and the largest |y| of the
        tip agree within their errors."""
        if self.range_end_index != other.range_end_index:
            return False
        # Small cycles near a Hopf point have uncertain heights, whereas the Hopf point is known.
        if self.hopf_beyond_range_end is not None and other.hopf_beyond_range_end is not None:
            return self.hopf_beyond_range_end is other.hopf_beyond_range_end
        (period, period_error, height, height_error) = self._period_and_largest_tip_y_with_errors
        (other_period, other_period_error, other_height, other_height_error) = (
            other._period_and_largest_tip_y_with_errors
        )
        factor = SPECIAL_POINT_SETTINGS.error_safety_factor
        return abs(period / other_period - 1) <= factor * (period_error + other_period_error) and abs(
            height / other_height - 1
        ) <= factor * (height_error + other_height_error)

    def has_same_cycle_as(self, other: "RangeEndPassage") -> bool:
        """Whether this place and `other` have the same cycle, with the same number of multipliers outside the
        unit circle: the number differs between the two cycles beside a fold, however near they are."""
        counts = [unstable_count_bounds(passage.cycle) for passage in (self, other)]
        is_certain = all(least == largest for least, largest in counts)
        return is_certain and counts[0] == counts[1] and self.is_same_as(other)

    @property
    def _period_and_largest_tip_y_with_errors(self) -> tuple[float, float, float, float]:
        """(period, its relative error, largest |y| of the tip, its relative error) at the end of the
        range."""
        point = self.normal_form_end_point
        if point is not None:
            return point.period, point.period_error, point.tip_y_max, point.tip_y_max_error
        measures = self.cycle.cycle.measures
        errors = self.cycle.cycle.errors
        # Mirror images exchange the largest and the smallest y.
        height = max(measures.tip_y_max, -measures.tip_y_min)
        return measures.period, errors.period_error, height, errors.amplitude_error


@dataclass(frozen=True, slots=True)
class BranchEnd:
    """The end of a branch. special_point: last special point of the branch. range_end_passage: place where
    the branch leaves the range; None if it has another end. Other fields: see the fields of `BranchCurve`."""

    special_point: SpecialPoint
    is_complete: bool
    end_hopf_index: int = -1
    end_breaking: SymmetryBreaking | None = None
    reached_max_cycles: bool = False
    is_closed: bool = False
    range_end_passage: RangeEndPassage | None = None


@dataclass(kw_only=True, slots=True)
class BranchCurve:
    """A branch: cycles and special points, both lists in order along the branch."""

    start_hopf_index: int
    """Index in `BranchLimits.hopfs` of the Hopf point where the branch starts, -1 if it starts elsewhere."""
    stored_cycles: list[StoredBranchCycle] = field(default_factory=list)
    special_points: list[SpecialPoint] = field(default_factory=list)
    """Special points in order along the branch; once the branch has ended, the last one is the end of the
    branch."""
    end_hopf_index: int = -1
    """Index in `BranchLimits.hopfs` of the Hopf point where the branch ends; -1 if the branch has another
    end."""
    start_breaking: SymmetryBreaking | None = None
    """Symmetry breaking where an asymmetric branch starts; None if the branch starts elsewhere."""
    end_breaking: SymmetryBreaking | None = None
    """Symmetry breaking where an asymmetric branch ends; None if the branch has another end."""
    is_complete: bool = False
    """Whether the branch was followed to a true end: Hopf point, symmetry breaking, end of the range, or end
    of the model."""
    reached_max_cycles: bool = False
    """Whether the continuation stopped at the maximum number of cycles."""
    is_closed: bool = False
    """Whether the branch is closed: its last special point is its first special point, located again."""
    are_unit_circle_crossings_explained: bool = True
    """Whether special points explain every multiplier that crosses the unit circle along the branch."""
    start_passage: RangeEndPassage | None = None
    """Place at an end of the range where the branch starts; None if it starts elsewhere."""
    end_passage: RangeEndPassage | None = None
    """Place where the branch leaves the range; None if it has another end."""

    def add_special_point(self, special: SpecialPoint) -> None:
        """Appends a special point that lies beyond the current last cycle, and sets its
        `index_of_cycle_before`."""
        self.special_points.append(replace(special, index_of_cycle_before=len(self.stored_cycles) - 1))

    def add_special_points(self, special_points: Sequence[SpecialPoint], are_complete: bool) -> None:
        """Appends the special points `special_points`, which lie between the current last cycle and the next
        cycle. are_complete: whether these points explain every multiplier that crosses the unit circle
        there."""
        for special in special_points:
            self.add_special_point(special)
        self.are_unit_circle_crossings_explained &= are_complete

    def remove_last_cycles(self, count: int) -> None:
        """Removes the last `count` cycles, and the special points beyond the first of these cycles."""
        del self.stored_cycles[-count:]
        self.special_points[:] = [
            point for point in self.special_points if point.index_of_cycle_before < len(self.stored_cycles)
        ]

    def append_end(self, end: BranchEnd) -> None:
        """Appends the end of the branch as its last special point, and sets the fields for the end of the
        branch."""
        self.add_special_point(end.special_point)
        self.is_complete = end.is_complete
        self.reached_max_cycles = end.reached_max_cycles
        self.is_closed = end.is_closed
        self.end_hopf_index = end.end_hopf_index
        self.end_breaking = end.end_breaking
        self.end_passage = end.range_end_passage

    def index_of_first_special_point(self, special_points: Sequence[SpecialPoint]) -> int:
        """Index in `special_points` of the first special point of this branch, -1 if `special_points` does
        not have it or if this point is not located. The branch is closed if it returns to this point."""
        # An unlocated point has only the values of a cycle beside it.
        own_points = [point for point in self.special_points[:1] if not point.message]
        located = [(i, point) for i, point in enumerate(special_points) if not point.message]
        return next(
            (i for i, point in located for own_point in own_points if own_point.is_same_as(point)), -1
        )

    def joined_with_forward_branch(self, forward: "BranchCurve") -> "BranchCurve":
        """This branch, reversed, continued by the branch `forward`; both start at the same cycle, in opposite
        directions."""
        cycle_count = len(self.stored_cycles)
        backward_points = [
            # Reversed, the cycle before a point is the cycle that was behind it.
            replace(point, index_of_cycle_before=cycle_count - 2 - point.index_of_cycle_before)
            for point in reversed(self.special_points)
        ]
        forward_points = [
            # One cycle belongs to both parts, and is counted once.
            replace(point, index_of_cycle_before=point.index_of_cycle_before + cycle_count - 1)
            for point in forward.special_points
        ]
        return BranchCurve(
            start_hopf_index=self.end_hopf_index,
            start_breaking=self.end_breaking,
            # The first cycle, common to both directions, is taken from `forward`.
            stored_cycles=[*self.stored_cycles[:0:-1], *forward.stored_cycles],
            special_points=[*backward_points, *forward_points],
            end_hopf_index=forward.end_hopf_index,
            end_breaking=forward.end_breaking,
            start_passage=self.end_passage,
            end_passage=forward.end_passage,
            is_complete=self.is_complete and forward.is_complete,
            reached_max_cycles=self.reached_max_cycles or forward.reached_max_cycles,
            are_unit_circle_crossings_explained=self.are_unit_circle_crossings_explained
            and forward.are_unit_circle_crossings_explained,
        )
