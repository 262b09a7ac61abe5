"""Model of the computing time along a branch, for a progress display only.

Cycles are dense near the Hopf point, and the mesh is finer far from the Hopf point. On branches along F of
ten random rods, with the length D in F, a fraction (d/D)^0.75 of the time had passed at the distance d from
the Hopf point, within a factor of two for d > D/10. Times of the branches of one rod were proportional to
sqrt(D).
"""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchWorkSettings:
    """Exponents of the model of the computing time, fitted to measured times."""

    distance_exponent: float = 0.75
    """Exponent of the distance d/D from the Hopf point in the fraction of the time of one branch."""
    length_exponent: float = 0.5
    """Exponent of the length D of a branch in its total time."""


BRANCH_WORK = BranchWorkSettings()


ParameterRange = tuple[float, float]
"""Lowest and highest coordinate of the continuation parameter."""


def fraction_done(born: float, at: float, aim: float) -> float:
    """Fraction of the computing time of a branch that has passed at the parameter coordinate `at`, for a
    branch from `born` to `aim`."""
    way = (at - born) / (aim - born) if aim != born else 1.0
    return min(max(way, 0.0), 1.0) ** BRANCH_WORK.distance_exponent


def fractions_before_branches(born: Sequence[float], ends: ParameterRange) -> list[float]:
    """Fractions of the total computing time of all branches before each branch, and 1 at the end,
    (branches + 1,).

    born: parameter coordinates of the Hopf points where the branches start. ends: range of the parameter
    coordinate.
    """
    works = [max(abs(end - at) for end in ends) ** BRANCH_WORK.length_exponent for at in born]
    done = [sum(works[:number]) for number in range(len(works) + 1)]
    return [work / done[-1] if done[-1] else 1.0 for work in done]
