"""Detection of special points of a branch: folds, torus points, symmetry breakings, period doublings.

A special point lies between two cycles at which its test function has opposite signs. The test functions are,
for a fold: derivative of the parameter with respect to arc length; for a torus point: modulus of a complex
pair of multipliers minus 1; for a symmetry breaking: multiplier of the half-period map composed with the
reflection, plus 1; for a period doubling of an asymmetric cycle: multiplier over the period, plus 1. The
special points found must explain the change of the number of multipliers outside the unit circle.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ....arrays import Array
from ...cycle.accuracy.settings import REFINEMENT_SETTINGS
from ...unsolvable import Unsolvable
from ..arc_length_step import BranchCycle, arc_length_between
from .locating import kind_at_multiplier_minus_one, special_point_between
from .special_point import SPECIAL_POINT_SETTINGS, SpecialPoint, SpecialPointKind

CycleAtArcLength = Callable[[BranchCycle, float], BranchCycle]
"""Function of a cycle and an arc length that returns the cycle at this arc length ahead; raises
Unsolvable."""


def unstable_multiplier_count(point: BranchCycle) -> int:
    """Number of nontrivial multipliers of the cycle `point` outside the unit circle. The multipliers are over
    half a period for a symmetric cycle, otherwise over a period."""
    return int((np.abs(point.multipliers_over_solved_time_interval) > 1).sum())


class DetectedKinds(NamedTuple):
    """Kinds of the special points between two cycles. explain_unstable_count_change: whether these kinds
    explain the change of the number of multipliers outside the unit circle."""

    kinds: list[SpecialPointKind]
    explain_unstable_count_change: bool


def special_kinds_between(start: BranchCycle, end: BranchCycle) -> DetectedKinds:
    """Kinds of the special points between the successive cycles `start` and `end`, from the parameter's
    change of direction and from the multipliers of the two cycles."""
    kinds = []
    # A fold is where the parameter turns; a multiplier near 1 is too uncertain to show it.
    if start.parameter_per_arc_length * end.parameter_per_arc_length < 0:
        kinds.append(SpecialPointKind.fold)
    # Two multipliers may pass -1 together or become a pair near -1; an odd difference needs a crossing.
    if (_count_of_multipliers_below_minus_one(start) - _count_of_multipliers_below_minus_one(end)) % 2:
        kinds.append(kind_at_multiplier_minus_one(start.orbit))
    count_change = abs(unstable_multiplier_count(end) - unstable_multiplier_count(start))
    # Near a fold a multiplier is 1 within its error; the counts at `start` and `end` may be wrong by one.
    count_tolerance = 1 if _has_multiplier_near_one(start) or _has_multiplier_near_one(end) else 0
    # A pair changes the count by two; one more or less may be a multiplier near 1.
    if not kinds and count_change - count_tolerance > 1:
        # Two real multipliers that cross together also change the count by two, but are not a torus point.
        is_pair = count_change == 2 and all(map(_has_complex_pair, (start, end)))
        return DetectedKinds([SpecialPointKind.torus], is_pair)
    # With two kinds in one step the changes may cancel, so the step is halved instead.
    return DetectedKinds(kinds, len(kinds) <= 1 and abs(count_change - len(kinds)) <= count_tolerance)


def fold_and_breaking_kinds_between(start: BranchCycle, end: BranchCycle) -> list[SpecialPointKind]:
    """The kinds fold and symmetry breaking, if such a special point lies between the cycles `start` and
    `end`: at a fold the branch turns back, at a symmetry breaking further branches may begin."""
    # Torus points are left out: no branch of cycles begins at one, and the branch does not turn.
    kinds = (
        [SpecialPointKind.fold] if start.parameter_per_arc_length * end.parameter_per_arc_length < 0 else []
    )
    if (
        start.orbit.is_symmetric
        and (_count_of_multipliers_below_minus_one(start) - _count_of_multipliers_below_minus_one(end)) % 2
    ):
        kinds.append(SpecialPointKind.symmetry_breaking)
    return kinds


def _count_of_multipliers_below_minus_one(point: BranchCycle) -> int:
    """Number of real multipliers of the cycle `point` that are less than -1. The multipliers are over the
    solved time interval, as in `_count_of_multipliers_above_one`."""
    return int((_real_multipliers(point) < -1).sum())


def _real_multipliers(point: BranchCycle) -> Array:
    """The real multipliers of the cycle `point`, (multipliers,), over half a period for a symmetric cycle,
    otherwise over a period."""
    h = point.multipliers_over_solved_time_interval
    # Eigenvalue solvers return a real double multiplier as a pair with a tiny imaginary part.
    return h.real[np.abs(h.imag) <= SPECIAL_POINT_SETTINGS.real_multiplier_tolerance * np.abs(h)]


def _has_multiplier_near_one(point: BranchCycle) -> bool:
    return bool(
        (
            np.abs(point.multipliers_over_solved_time_interval - 1)
            < SPECIAL_POINT_SETTINGS.max_undecided_multiplier_minus_one
        ).any()
    )


def _has_complex_pair(point: BranchCycle) -> bool:
    h = point.multipliers_over_solved_time_interval
    return bool((np.abs(h.imag) > SPECIAL_POINT_SETTINGS.real_multiplier_tolerance * np.abs(h)).any())


def lie_on_one_branch(start: BranchCycle, end: BranchCycle) -> bool:
    """Whether the successive cycles `start` and `end` can lie on one smooth branch; False if the step has
    jumped to a second branch, which nearly touches the branch of `start`.

    Along a branch the derivative of the parameter with respect to arc length, divided by the product of 1 - m
    over the nontrivial multipliers m, is finite and not 0: numerator and denominator both vanish at a fold.
    The quotient changes its sign only where two branches meet. If a multiplier is 1 within its error, the
    sign is uncertain: then neither a fold nor a changed multiplier, or a small prediction error of `end`, is
    required.
    """
    has_fold = start.parameter_per_arc_length * end.parameter_per_arc_length < 0
    change = _count_of_multipliers_above_one(start) - _count_of_multipliers_above_one(end)
    # Each fold moves one multiplier through 1, and a smooth branch has no other reason for an odd change.
    if not any(map(_has_multiplier_indistinct_from_trivial, (start, end))):
        return change % 2 == int(has_fold)
    is_unchanged = not has_fold and change % 2 == 0
    return is_unchanged or end.prediction_error <= SPECIAL_POINT_SETTINGS.max_prediction_error_without_fold


def _has_multiplier_indistinct_from_trivial(point: BranchCycle) -> bool:
    """Whether a nontrivial multiplier of the cycle `point` equals the trivial multiplier within the error of
    its mesh."""
    error = REFINEMENT_SETTINGS.multiplier_error_per_matrix_distance * point.cycle.trivial_multiplier_error
    return bool((np.abs(point.multipliers_over_solved_time_interval - 1) <= error).any())


def _count_of_multipliers_above_one(point: BranchCycle) -> int:
    """Number of real multipliers of the cycle `point` that are larger than 1. The multipliers are over the
    solved time interval: half a period for a symmetric cycle, otherwise a period."""
    return int((_real_multipliers(point) > 1).sum())


def special_points_and_completeness(
    start: BranchCycle,
    end: BranchCycle,
    cycle_at: CycleAtArcLength,
    accuracy: float,
    halvings: int = 0,
) -> tuple[list[SpecialPoint], bool]:
    """Returns (points, are_complete): special points between the cycles `start` and `end`, in order, and
    whether these points explain the change of the number of multipliers outside the unit circle.

    cycle_at: function that solves a cycle at an arc length between the two cycles. accuracy: relative
    accuracy of the branch. halvings: number of halvings of the step so far. The step is halved if the
    multipliers show several special points, or if a special point cannot be located: near crushing, for
    example, the prediction over the whole step may have a stretch h1 <= 0.
    """
    kinds, are_complete = special_kinds_between(start, end)
    points = [special_point_between(kind, start, end, accuracy) for kind in kinds] if are_complete else []
    if halvings < SPECIAL_POINT_SETTINGS.max_step_halvings and (
        not are_complete or any(point.message for point in points)
    ):
        try:
            # Halving separates special points whose changes of the number of multipliers cancel or add up.
            middle = cycle_at(start, arc_length_between(start, end) / 2)
        except Unsolvable:
            pass
        else:
            first_points, first_complete = special_points_and_completeness(
                start, middle, cycle_at, accuracy, halvings + 1
            )
            second_points, second_complete = special_points_and_completeness(
                middle, end, cycle_at, accuracy, halvings + 1
            )
            return first_points + second_points, first_complete and second_complete
    # Halving has ended, so points that do not explain the counts are stored too, marked as incomplete.
    return points or [special_point_between(kind, start, end, accuracy) for kind in kinds], are_complete
