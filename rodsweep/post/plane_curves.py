"""The two parameters of the plane of a phase diagram in a result file, the curves in the plane, and the
curves of Hopf points that bound the region of stable straight rods."""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..model.parameters import NON_OPTIONAL_LINEAR_PARAMETERS
from ..results.file.view import ResultView
from ..results.layouts.thresholds import CROSSING_KINDS
from .located_thresholds import STABILITY_CHANGES


class PlaneParameters(NamedTuple):
    """Names of the parameters of a phase diagram. line: parameter that varies along a row. row: parameter
    that is constant on a row."""

    line: str
    row: str


def plane_parameters(view: ResultView) -> PlaneParameters:
    """Names of the parameters of a phase diagram."""
    line = next(name for name in NON_OPTIONAL_LINEAR_PARAMETERS if name not in view.parameters)
    row = next((name for name in view.parameters if len(view.parameter_values[name]) > 1), view.parameters[0])
    return PlaneParameters(line, row)


def curve_paths(
    view: ResultView, parameters: PlaneParameters, prefix: str, kind: int | None = None
) -> dict[int, Array]:
    """Points of each curve of a phase diagram, (n, 2), by number of the curve. prefix: "curve" for boundary
    curves, "cycle_curve" for curves of special points of cycles. kind: code of the kind of the curves; None:
    all kinds."""
    variables = view.variables
    numbers = variables[f"{prefix}_number"]
    chosen_numbers = numbers if kind is None else numbers[variables[f"{prefix}_kind"] == kind]
    points = np.stack([variables[f"{prefix}_{name}"] for name in parameters], axis=-1)
    return {number: points[numbers == number] for number in np.unique(chosen_numbers).tolist()}


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
