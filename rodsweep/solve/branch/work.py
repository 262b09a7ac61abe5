"""Progress along a branch: the fraction of its work that is done, for a display only.

Cycles lie dense near the Hopf point, and the mesh is finer far from it. Measured on branches along F of ten
random rods: at a distance d from the Hopf point, of D in all, a fraction (d/D)^0.75 of the time had passed,
within a factor of two from a tenth of D on. Times of the branches of one rod were proportional to sqrt(D).
"""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkSettings:
    """Exponents of the display of progress, fitted to the measured times above."""

    within_a_branch: float = 0.75
    """Exponent of the distance in the time spent along one branch."""
    among_branches: float = 0.5
    """Exponent of the whole distance in the times of several branches of a rod."""


BRANCH_WORK = WorkSettings()


Range = tuple[float, float]
"""The lowest and highest coordinate of the parameter."""


def share_done(born: float, at: float, aim: float) -> float:
    """Fraction of a branch's work that is done at a coordinate, for a branch from `born` to `aim`."""
    way = (at - born) / (aim - born) if aim != born else 1.0
    return min(max(way, 0.0), 1.0) ** BRANCH_WORK.within_a_branch


def shares_of_branches(born: Sequence[float], ends: Range) -> list[float]:
    """Fractions of the whole work that are done before each branch and at the end, (branches + 1,)."""
    works = [max(abs(end - at) for end in ends) ** BRANCH_WORK.among_branches for at in born]
    done = [sum(works[:number]) for number in range(len(works) + 1)]
    return [work / done[-1] if done[-1] else 1.0 for work in done]
