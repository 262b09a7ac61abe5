"""Distinction between curves of Hopf points that bound the region of stable straight rods, and curves of Hopf
points of further modes. line_parameter: parameter that varies along a row. row_parameter: parameter that is
constant on a row."""

import numpy as np

from ..arrays import Array
from ..results.file.view import ResultView
from ..results.layouts.thresholds import CROSSING_KINDS
from .located_thresholds import STABILITY_CHANGES


def is_stability_boundary_by_curve(
    view: ResultView, line_parameter: str, row_parameter: str
) -> dict[int, bool]:
    """For each curve of Hopf points, by number: whether the curve bounds the region of stable rods.

    A curve bounds the region if it is, for some change of stability on a row, the nearest curve along the
    row.
    """
    variables = view.variables
    numbers = np.unique(variables["curve_number"][variables["curve_kind"] == 1]).astype(int).tolist()
    is_bound = dict.fromkeys(numbers, False)
    row_values = view.point_columns[row_parameter]
    kinds, counts, positions = map(view.by_point, ("crossing_kind", "unstable_after", "crossing_at"))
    masks = ((number, variables["curve_number"] == number) for number in numbers)
    paths = {
        number: (variables[f"curve_{line_parameter}"][mask], variables[f"curve_{row_parameter}"][mask])
        for number, mask in masks
    }
    for index, i in zip(*np.nonzero(np.isfinite(positions)), strict=True):
        kind = CROSSING_KINDS[int(kinds[index, i])]
        if numbers and (kind, int(counts[index, i])) in STABILITY_CHANGES and np.isfinite(row_values[index]):
            position = float(positions[index, i]), float(row_values[index])
            distances = {
                path_number: _distance_along_row(x, y, *position) for path_number, (x, y) in paths.items()
            }
            is_bound[min(distances, key=distances.__getitem__)] = True
    return is_bound


def _distance_along_row(x: Array, y: Array, position: float, height: float) -> float:
    """Distance, along the row y = `height`, between x = `position` and a curve; inf if the curve does not
    cross the row. x, y: vertices of the curve, (n,)."""
    low = np.minimum(y[:-1], y[1:])
    high = np.maximum(y[:-1], y[1:])
    segments = np.flatnonzero((low <= height) & (height <= high))
    if not len(segments):
        return float("inf")
    height_increments = np.where(y[segments + 1] != y[segments], y[segments + 1] - y[segments], 1.0)
    crossings = x[segments] + (height - y[segments]) / height_increments * (x[segments + 1] - x[segments])
    return float(np.abs(crossings - position).min())
