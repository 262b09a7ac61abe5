"""Branches of cycles for the page: parts of constant stability, and special points."""

from typing import Any

import numpy as np

from ...arrays import Array
from ...post.branch_curves import RodBranches, stability_runs

BranchPiece = tuple[Array, Array, int]
"""(F, largest y of the tip, stability) of a part of a branch; F and y: (vertices,). Stability: 1 stable, 0
unstable, -1 unknown."""


def drawn_branches(rod: RodBranches, stop: float) -> dict[str, Any]:
    """Variables of the answer "branch" for a rod, by name.

    pieces: parts of the branches of cycles, and of the straight rod from F = 0 to `stop`, see `BranchPiece`.
    special: (F, y, kind, period) of each special point except ends of branches.
    """
    pieces: list[BranchPiece] = [
        (curve.at[run], curve.y[run], stable)
        for curve in rod.curves
        for run, stable in stability_runs(curve.stable)
    ]
    straight = rod.straight_pieces((0.0, stop))
    pieces += [(np.array([low, high]), np.zeros(2), stable) for low, high, stable in straight]
    special = [(p.at, p.tip_y_max, p.kind, p.period) for curve in rod.curves for p in curve.special]
    return {"pieces": pieces, "special": [each for each in special if each[2] != "end"]}
