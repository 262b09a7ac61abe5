"""Distinction between curves of Hopf points that bound the region of stable straight rods, and curves of Hopf
points of further modes.
"""

import numpy as np

from ..arrays import Array
from ..results.file.view import View
from ..results.layouts.thresholds import CROSSING_KINDS
from .located_thresholds import STABILITY_CHANGES


def curves_bounding_stability(view: View, line: str, row: str) -> dict[int, bool]:
    """For each curve of Hopf points, by number: whether the curve bounds the region of stable rods.

    A curve bounds the region if it is, for some change of stability on a row, the nearest curve along the
    row. line: parameter along a row. row: parameter constant on a row.
    """
    v = view.variables
    numbers = np.unique(v["curve_number"][v["curve_kind"] == 1]).astype(int).tolist()
    found = dict.fromkeys(numbers, False)
    rows = view.point_columns[row]
    kinds, after, at = map(view.by_point, ("crossing_kind", "unstable_after", "crossing_at"))
    on = {number: v["curve_number"] == number for number in numbers}
    paths = {number: (v[f"curve_{line}"][own], v[f"curve_{row}"][own]) for number, own in on.items()}
    for index, i in zip(*np.nonzero(np.isfinite(at)), strict=True):
        kind = CROSSING_KINDS[int(kinds[index, i])]
        if numbers and (kind, int(after[index, i])) in STABILITY_CHANGES and np.isfinite(rows[index]):
            position = float(at[index, i]), float(rows[index])
            distances = {n: _distance_along_row(x, y, *position) for n, (x, y) in paths.items()}
            found[min(distances, key=distances.__getitem__)] = True
    return found


def _distance_along_row(x: Array, y: Array, at: float, height: float) -> float:
    """Distance, along the row y = `height`, between x = `at` and a curve; inf if the curve does not cross the
    row. x, y: vertices of the curve, (n,).
    """
    low = np.minimum(y[:-1], y[1:])
    high = np.maximum(y[:-1], y[1:])
    pieces = np.flatnonzero((low <= height) & (height <= high))
    if not len(pieces):
        return float("inf")
    rise = np.where(y[pieces + 1] != y[pieces], y[pieces + 1] - y[pieces], 1.0)
    crossings = x[pieces] + (height - y[pieces]) / rise * (x[pieces + 1] - x[pieces])
    return float(np.abs(crossings - at).min())
