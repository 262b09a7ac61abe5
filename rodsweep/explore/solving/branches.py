"""Branches of cycles as the page draws them: pieces of equal stability, and special points."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...post.branch_curves import StoredBranch
from .diagrams import Dataset, words_of

Piece = tuple[Array, Array, int]
"""F and y, (vertices,) each, and stability: 1, 0, or -1 where it is not known."""


def drawn_branches(curves: Sequence[StoredBranch]) -> dict[str, Any]:
    """pieces: of all branches. special: (F, y, kind, period) of each special point but ends."""
    pieces = [piece for curve in curves for piece in pieces_of(curve.at, curve.y, curve.stable)]
    special = [(p.at, p.tip_y_max, p.kind, p.period) for curve in curves for p in curve.special]
    return {"pieces": pieces, "special": [each for each in special if each[2] != "end"]}


def pieces_of(at: Array, y: Array, stable: NDArray[np.integer]) -> list[Piece]:
    """Pieces of equal stability of a curve through (n,) vertices; stable: (n - 1,)."""
    starts = [0, *(i for i in range(1, len(stable)) if stable[i] != stable[i - 1]), len(stable)]
    return [
        (at[a : b + 1], y[a : b + 1], int(stable[a])) for a, b in pairwise(starts) if b > a
    ]  # fmt: skip


def straight_pieces(data: Dataset, stop: float) -> list[Piece]:
    """The straight state from F = 0 to `stop`, in pieces between Hopf points: F and y of shape (2,).

    data: results of a single rod.
    """
    hopf = words_of(data["special_kind"]) == "hopf"
    at = data["special_at"].values[hopf]
    order = np.argsort(at)
    after = data["special_unstable_after"].values[hopf][order]
    counts = [int(data["unstable_at_start"]), *map(int, after)]
    ends = [0.0, *at[order], stop]
    return [
        (np.array(piece), np.zeros(2), -1 if count < 0 else int(count == 0))
        for piece, count in zip(pairwise(ends), counts, strict=True)
    ]
