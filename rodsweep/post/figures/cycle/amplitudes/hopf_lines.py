"""The lines of Hopf points over two parameters, from the growth rates and Hopf points that a file holds."""

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from .....arrays import Array
from .....results.file.view import View
from .....sweep.points.lines import ParameterLine
from ....hopf_points import Located, StoredChanges
from ...style import is_logarithmic
from ..point_map import PointMap, in_its_scale


def hopf_lines(points: PointMap, view: View) -> list[Array]:
    """The contours on which the leading growth rate is 0, each of shape (2, n): x, y.

    Rows are linear between their points and zeros, and between rows the growth rate is linear in the scale of
    y: so a contour passes through the Hopf points of every row, which the task has located.
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
    contours = Figure().subplots().contour(refined, y, np.ma.masked_invalid(rows), levels=[0.0])
    lines = (line for line in contours.allsegs[0] if len(line) > 1)
    return [np.array([x_back(line[:, 0]), y_back(line[:, 1])]) for line in lines]


def _hopf_points(points: PointMap, view: View) -> Iterator[Array]:
    """The Hopf points of every row of a map, each row's of shape (n,)."""
    name, other = points.names
    stored = StoredChanges(view, name)
    for value, at in zip(points.y, points.at, strict=True):
        row = ParameterLine(name, points.shared | {other: float(value)}, points.x, at)
        located = (change for change in stored.on(row) if isinstance(change, Located))
        yield np.array([change.position for change in located if change.is_hopf])
