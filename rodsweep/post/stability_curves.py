"""Which curves of a phase diagram bound the stable rods: at all others further modes begin to grow."""

import numpy as np

from ..arrays import Array
from ..results.file.view import View
from ..results.layouts.thresholds import CROSSING_KINDS
from .hopf_points import STABILITY_CHANGES


def bounds_stability(view: View, line: str, row: str) -> dict[int, bool]:
    """Of every curve of Hopf points, by its number, whether changes of stability of the rows lie on it.

    A change belongs to the curve that passes nearest to it along its row, in units of the axis.
    """
    v = view.variables
    numbers = np.unique(v["curve_number"][v["curve_kind"] == 1]).astype(int).tolist()
    found = dict.fromkeys(numbers, False)
    rows = view.point_columns[row]
    kinds, after, at = map(view.by_point, ("crossing_kind", "unstable_after", "crossing_at"))
    paths = {
        number: (
            v[f"curve_{line}"][v["curve_number"] == number],
            v[f"curve_{row}"][v["curve_number"] == number],
        )
        for number in numbers
    }
    for place, i in zip(*np.nonzero(np.isfinite(at)), strict=True):
        kind = CROSSING_KINDS[int(kinds[place, i])]
        if numbers and (kind, int(after[place, i])) in STABILITY_CHANGES and np.isfinite(rows[place]):
            here = float(at[place, i]), float(rows[place])
            away = {n: _distance(x, y, *here) for n, (x, y) in paths.items()}
            found[min(away, key=away.__getitem__)] = True
    return found


def _distance(x: Array, y: Array, at: float, height: float) -> float:
    """How far along a row at a height a place lies from a curve with the vertices x, y, (n,)."""
    low, high = np.minimum(y[:-1], y[1:]), np.maximum(y[:-1], y[1:])
    pieces = np.flatnonzero((low <= height) & (height <= high))
    if not len(pieces):
        return float("inf")
    rise = np.where(y[pieces + 1] != y[pieces], y[pieces + 1] - y[pieces], 1.0)
    meets = x[pieces] + (height - y[pieces]) / rise * (x[pieces + 1] - x[pieces])
    return float(np.abs(meets - at).min())
