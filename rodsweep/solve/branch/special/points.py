"""Special points of a branch: folds, torus points, symmetry breakings, period doublings.

Each is a sign change of a test function between two cycles. Fold: derivative of the parameter along the
branch. Torus point: modulus of a complex pair of multipliers minus 1. Symmetry breaking: a multiplier of half
a period and the reflection, plus 1. Period doubling of an asymmetric cycle: a multiplier of the whole period,
plus 1. The number of multipliers outside the unit circle must change accordingly.
"""

from collections.abc import Callable

import numpy as np

from ...point import Unsolvable
from ..arc import ArcPoint, arc_between
from .locating import located, through_minus_one
from .point import LOCATING, SpecialKind, SpecialPoint

Step = Callable[[ArcPoint, float], ArcPoint]
"""Returns the cycle at an arc length from a given cycle; raises Unsolvable."""


def unstable_multipliers(point: ArcPoint) -> int:
    """Number of multipliers outside the unit circle."""
    return int((np.abs(point.partial_multipliers) > 1).sum())


def changes_between(start: ArcPoint, end: ArcPoint) -> tuple[list[SpecialKind], bool]:
    """(kinds of special points between two cycles, whether they account for the change of the
    multipliers)."""
    found = []
    if start.rises * end.rises < 0:
        found.append(SpecialKind.fold)
    # Two multipliers may pass -1 together or meet there; an odd difference needs a crossing.
    if (_beyond_minus_one(start) - _beyond_minus_one(end)) % 2:
        found.append(through_minus_one(start.orbit))
    change = abs(unstable_multipliers(end) - unstable_multipliers(start))
    # Beside a fold a multiplier is 1 within its error, and may be counted on either side.
    slack = 1 if _near_one(start) or _near_one(end) else 0
    if not found and change - slack > 1:
        return [SpecialKind.torus], change == 2 and all(map(_has_pair, (start, end)))
    return found, len(found) <= 1 and abs(change - len(found)) <= slack


def _beyond_minus_one(point: ArcPoint) -> int:
    """Number of real multipliers below -1."""
    h = point.partial_multipliers
    return int(((h.real < -1) & (np.abs(h.imag) <= LOCATING.real_multiplier * np.abs(h))).sum())


def _near_one(point: ArcPoint) -> bool:
    return bool((np.abs(point.partial_multipliers - 1) < LOCATING.near_one).any())


def _has_pair(point: ArcPoint) -> bool:
    h = point.partial_multipliers
    return bool((np.abs(h.imag) > LOCATING.real_multiplier * np.abs(h)).any())


def special_points(
    start: ArcPoint,
    end: ArcPoint,
    step: Step,
    accuracy: float,
    depth: int = 0,
) -> tuple[list[SpecialPoint], bool]:
    """(special points between two cycles, in order, whether they account for the change of the multipliers).

    accuracy: accuracy of the branch. The step is halved if several changes lie within it, or if a special
    point is not located: near crushing a prediction over the whole step may leave the model.
    """
    kinds, explained = changes_between(start, end)
    points = [located(kind, start, end, accuracy) for kind in kinds] if explained else []
    if depth < LOCATING.max_halvings and (not explained or any(point.message for point in points)):
        try:
            # Half the step parts special points that are too close to be told apart by counts.
            middle = step(start, arc_between(start, end) / 2)
        except Unsolvable:
            pass
        else:
            first, first_explained = special_points(start, middle, step, accuracy, depth + 1)
            second, second_explained = special_points(middle, end, step, accuracy, depth + 1)
            return first + second, first_explained and second_explained
    return points or [located(kind, start, end, accuracy) for kind in kinds], explained
