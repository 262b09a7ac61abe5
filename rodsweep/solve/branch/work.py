"""How far a branch is: the share of its work that is done, for a display; no result depends on it.

Cycles lie dense near the Hopf point, and far from it the mesh is finer. Branches along F of ten random rods
reached a distance d from the Hopf point, of D in all, after a share (d/D)^0.75 of their time, within a factor
of two from a tenth of it on. The times of the branches of one rod were as sqrt(D).
"""

from collections.abc import Sequence

WITHIN_A_BRANCH, AMONG_BRANCHES = 0.75, 0.5
"""The two exponents."""

Range = tuple[float, float]
"""The lowest and highest coordinate of the parameter."""


def share_done(born: float, at: float, aim: float) -> float:
    """Share of a branch's work that is done at a coordinate, if it leads from where it is born to its aim."""
    way = (at - born) / (aim - born) if aim != born else 1.0
    return min(max(way, 0.0), 1.0) ** WITHIN_A_BRANCH


def shares_of_branches(born: Sequence[float], ends: Range) -> list[float]:
    """Shares of the work on all branches: before each of them, and at the end, (branches + 1,)."""
    works = [max(abs(end - at) for end in ends) ** AMONG_BRANCHES for at in born]
    done = [sum(works[:number]) for number in range(len(works) + 1)]
    return [work / done[-1] if done[-1] else 1.0 for work in done]
