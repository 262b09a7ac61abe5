"""Lines of Hopf points over two parameters, from the growth rates and Hopf points in a file."""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from .....arrays import Array
from .....results.file.view import View
from .....sweep.points.lines import ParameterLine
from ....hopf_points import LocatedChange, StoredChanges
from ...style import is_logarithmic
from ..point_map import PointMap, in_its_scale


def hopf_lines(points: PointMap, view: View) -> list[Array]:
    """Contours of zero leading growth rate, each of shape (2, n): x, y.

    The growth rate is interpolated linearly along each row, between points and Hopf points, and between rows
    in the scale of y. A contour therefore passes through the located Hopf points of every row.
    """
    (x, x_back), (y, y_back) = (in_its_scale(values) for values in (points.x, points.y))
    to_scale = np.log if is_logarithmic(points.x) else np.asarray
    growth = view.variables["linear_growth_rate"].ravel()[points.at]
    zeros = [to_scale(places) for places in _hopf_points(points, view)]
    refined = np.unique(np.concatenate([x, *zeros]))
    rows = []
    for row, own in zip(growth, zeros, strict=True):
        nodes, first = np.unique(np.concatenate([x, own]), return_index=True)
        rows.append(np.interp(refined, nodes, np.concatenate([row, np.zeros_like(own)])[first]))
    if not np.nanmin(rows) < 0 < np.nanmax(rows):
        return []
    # This figure is never drawn; matplotlib only computes the contours.
    contours = Figure().subplots().contour(refined, y, np.ma.masked_invalid(rows), levels=[0.0])
    lines = (line for line in contours.allsegs[0] if len(line) > 1)
    return [np.array([x_back(line[:, 0]), y_back(line[:, 1])]) for line in lines]


def _hopf_points(points: PointMap, view: View) -> Iterator[Array]:
    """Yields the Hopf points of each row of a map, (n,)."""
    name, other = points.names
    stored = StoredChanges(view, name)
    for value, at in zip(points.y, points.at, strict=True):
        row = ParameterLine(name, points.shared | {other: float(value)}, points.x, at)
        located = (change for change in stored.on(row) if isinstance(change, LocatedChange))
        yield np.array([change.position for change in located if change.is_hopf])
