"""Where a branch changes: folds, torus points, broken symmetry, doubled periods.

Between two cycles of a branch a number changes its sign: at a fold how fast the parameter grows along the
branch; at a torus point the modulus of a complex pair of multipliers less 1; where the symmetry breaks the
multiplier of half a period and the reflection plus 1, and the same of a whole period where a cycle without
symmetry doubles its period. The multipliers outside the circle must change as these points say.
"""

from collections.abc import Callable

import numpy as np

from ...point import Unsolvable
from ..arc import ArcPoint, arc_between
from .locating import REAL, located, through_minus_one
from .point import SpecialKind, SpecialPoint

NEAR_ONE = 3e-3
"""Distance of a multiplier from 1 within which rounding may put it on the other side; a fold has two."""
MOST_HALVINGS = 7
"""Of a step between two cycles in which more than one thing happens, or a special point is not located."""

Step = Callable[[ArcPoint, float], ArcPoint]
"""The point at a length from another one; raises Unsolvable."""


def unstable_returns(point: ArcPoint) -> int:
    """How many multipliers lie outside the circle."""
    return int((np.abs(point.returns) > 1).sum())


def changes_between(here: ArcPoint, there: ArcPoint) -> tuple[list[SpecialKind], bool]:
    """(what happens between two cycles of a branch, whether that explains the multipliers that change)."""
    found = []
    if here.rises * there.rises < 0:
        found.append(SpecialKind.fold)
    if (_beyond_minus_one(here) - _beyond_minus_one(there)) % 2:
        found.append(through_minus_one(here.orbit))
    change = abs(unstable_returns(there) - unstable_returns(here))
    slack = 1 if _near_one(here) or _near_one(there) else 0
    if not found and change - slack > 1:
        return [SpecialKind.torus], change == 2 and all(map(_has_pair, (here, there)))
    return found, len(found) <= 1 and abs(change - len(found)) <= slack


def _beyond_minus_one(point: ArcPoint) -> int:
    """Real multipliers below -1."""
    h = point.returns
    return int(((h.real < -1) & (np.abs(h.imag) <= REAL * np.abs(h))).sum())


def _near_one(point: ArcPoint) -> bool:
    return bool((np.abs(point.returns - 1) < NEAR_ONE).any())


def _has_pair(point: ArcPoint) -> bool:
    h = point.returns
    return bool((np.abs(h.imag) > REAL * np.abs(h)).any())


def special_points(
    here: ArcPoint,
    there: ArcPoint,
    step: Step,
    accuracy: float,
    depth: int = 0,
) -> tuple[list[SpecialPoint], bool]:
    """(the special points between two cycles, whether they explain all), in their order along the branch.

    accuracy: of the branch. The step between the cycles is halved where more than one thing happens, or where
    a special point is not located: close to crushing a prediction over the whole step may leave the model.
    """
    kinds, explained = changes_between(here, there)
    points = [located(kind, here, there, accuracy) for kind in kinds] if explained else []
    if depth < MOST_HALVINGS and (not explained or any(point.message for point in points)):
        try:
            middle = step(here, arc_between(here, there) / 2)
        except Unsolvable:
            pass
        else:
            first, first_explained = special_points(here, middle, step, accuracy, depth + 1)
            second, second_explained = special_points(middle, there, step, accuracy, depth + 1)
            return first + second, first_explained and second_explained
    return points or [located(kind, here, there, accuracy) for kind in kinds], explained
