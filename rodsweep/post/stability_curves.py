"""Distinction between curves of Hopf points that bound the region of stable straight rods, and curves of Hopf
points of further modes."""

import numpy as np

from ..arrays import Array
from ..results.file.view import ResultView
from ..results.layouts.thresholds import CROSSING_KINDS
from .located_thresholds import STABILITY_CHANGES
from .plane_curves import PlaneParameters, curve_paths


def is_stability_boundary_by_curve(view: ResultView, parameters: PlaneParameters) -> dict[int, bool]:
    """For each curve of Hopf points, by number: whether the curve bounds the region of stable rods.

    A curve bounds the region if it is, for some change of stability on a row, the nearest curve along the
    row.
    """
    paths = curve_paths(view, parameters, "curve", kind=1)
    is_bound = dict.fromkeys(paths, False)
    row_values = view.point_columns[parameters.row]
    kinds, counts, positions = map(view.by_point, ("crossing_kind", "unstable_after", "crossing_at"))
    for index, i in zip(*np.nonzero(np.isfinite(positions)), strict=True):
        kind = CROSSING_KINDS[int(kinds[index, i])]
        if paths and (kind, int(counts[index, i])) in STABILITY_CHANGES and np.isfinite(row_values[index]):
            position = float(positions[index, i]), float(row_values[index])
            distances = {
                path_number: _distance_along_row(path, *position) for path_number, path in paths.items()
            }
            is_bound[min(distances, key=distances.__getitem__)] = True
    return is_bound


def _distance_along_row(path: Array, position: float, height: float) -> float:
    """Distance, along the row y = `height`, between x = `position` and a curve; inf if the curve does not
    cross the row. path: vertices (x, y) of the curve, (n, 2)."""
    x, y = path.T
    low = np.minimum(y[:-1], y[1:])
    high = np.maximum(y[:-1], y[1:])
    segments = np.flatnonzero((low <= height) & (height <= high))
    if not len(segments):
        return float("inf")
    height_increments = np.where(y[segments + 1] != y[segments], y[segments + 1] - y[segments], 1.0)
    crossings = x[segments] + (height - y[segments]) / height_increments * (x[segments + 1] - x[segments])
    return float(np.abs(crossings - position).min())
