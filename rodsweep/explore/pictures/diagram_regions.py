"""Regions of the stability diagram of the page: areas of equal numbers of unstable modes, bounded by the
stored curves of Hopf points and by the crushing load as in the figures of `rodsweep plot`."""

from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...post.figures.phase_diagram import CURVE_END_CRUSHING_RATIO
from ...post.figures.stability.regions import PIXEL_COUNT, ClassifiedPoints, DrawnPlane, pixel_classes
from ..solving.diagrams import CRUSHED_CODE, UNKNOWN_CODE

PIXELS_PER_ROW = 2
"""Number of rows of pixels that are drawn as one row. The number of rows is then about the height of a
picture of the page, in pixels."""


class RegionTable(NamedTuple):
    """Numbers of unstable modes in narrow rows of cells. column_edges: edges of the columns, (columns + 1,).
    row_edges: edges of the rows, (rows + 1,). counts: numbers of unstable modes, (rows, columns)."""

    column_edges: Array
    row_edges: Array
    counts: Array


def region_table(answer: dict[str, Any]) -> RegionTable | None:
    """Regions of the answer `answer` to the request "diagram", in its units. None if the answer has no curve
    of Hopf points, or fewer than two finite positive values of the second parameter."""
    x = answer["x"]
    y = answer["y"]
    hopf_curves = [curve for curve in answer["curves"] if curve.kind == "hopf"]
    if not hopf_curves or len(y) < 2 or not (np.isfinite(y) & (y > 0)).all():
        return None
    # The axis of the loads is linear, and the axis of the second parameter logarithmic, for any values.
    plane = DrawnPlane(np.linspace(x[0], x[-1], 3), np.linspace(np.log(y[0]), np.log(y[-1]), 3))
    columns, rows = np.meshgrid(x, np.log(y))
    counts = np.asarray(answer["unstable_count"])
    is_counted = counts != CRUSHED_CODE
    computed = ClassifiedPoints(
        plane.fractions_of_axes(columns[is_counted], rows[is_counted]), counts[is_counted]
    )
    row_positions = plane.fractions_of_axes(answer["between_x"], np.log(answer["between_y"]))
    row_points = ClassifiedPoints(row_positions, np.asarray(answer["between_count"]))
    curves = [plane.fractions_of_axes(curve.x, np.log(curve.y)) for curve in hopf_curves]
    ratio = _crushing_ratio(plane, np.log(y), answer["crushing_load"])
    pixels = pixel_classes(computed, row_points, curves, ratio > CURVE_END_CRUSHING_RATIO, UNKNOWN_CODE)
    pixels = np.where(ratio < 1, pixels, CRUSHED_CODE)
    column_edges = np.linspace(x[0], x[-1], PIXEL_COUNT + 1)
    row_edges = np.geomspace(y[0], y[-1], PIXEL_COUNT // PIXELS_PER_ROW + 1)
    return RegionTable(column_edges, row_edges, pixels[PIXELS_PER_ROW // 2 :: PIXELS_PER_ROW])


def _crushing_ratio(plane: DrawnPlane, logs: Array, load: Array) -> Array:
    """Load divided by the crushing load (zero stretch), at every pixel, (PIXEL_COUNT, PIXEL_COUNT). logs:
    logarithms of the second parameter, (rows,). load: crushing load of each row, infinite on no row or on all
    rows, (rows,)."""
    if np.isinf(load).all():
        return np.zeros((PIXEL_COUNT, PIXEL_COUNT))
    # With two logarithmic axes the crushing load is a straight line over k1, and over the taper.
    crushing = np.exp(np.interp(plane.pixel_centres(plane.y), logs, np.log(load)))
    return np.asarray(plane.pixel_centres(plane.x) / crushing[:, None])
